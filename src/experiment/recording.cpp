#include "experiment/recording.hpp"

#include <cmath>
#include <limits>

#include "control/effective_mass.hpp"
#include "control/rotation.hpp"
#include "control/singular_task.hpp"
#include "experiment/provenance.hpp"
#include "model/coordinate_names.hpp"

namespace osculate {

namespace {

const std::vector<std::string> spatial_labels{"wx", "wy", "wz", "vx", "vy", "vz"};
const std::vector<std::string> xyz_labels{"x", "y", "z"};

std::vector<std::string> halves(const std::string& angular, const std::string& linear) {
  return {angular, angular, angular, linear, linear, linear};
}

bool makes_restart_points(const Experiment& experiment) {
  const double interval = experiment.output.restart_interval;
  return interval > 0 && interval < experiment.duration;
}

Layout make_layout(const Experiment& experiment, const Arms& arms, const std::string& command) {
  Layout layout;
  layout.title = experiment.name;

  const CoordinateNames joint_coordinates = coordinate_names(arms.description.joints);
  std::vector<std::string> rows;
  for (const int row : experiment.controller.rows)
    rows.push_back(spatial_labels[static_cast<std::size_t>(row)]);

  layout.axes = {
      {"time", {}, "s", "time of the recorded instants"},
      {"step", {}, "1", "number of the accepted integrator step"},
      {"joint", joint_coordinates.joints, "", "joints, base to tip"},
      {"position_coordinate", joint_coordinates.positions, "", "joint position coordinates, base to tip"},
      {"velocity_coordinate", joint_coordinates.velocities, "", "joint velocity coordinates, base to tip"},
      {"spatial", spatial_labels, "", "spatial components, angular first, base frame, about the tip point"},
      {"spatial_column", spatial_labels, "", "columns of a spatial matrix"},
      {"xyz", xyz_labels, "", "components in the base frame"},
      {"quaternion", {"w", "x", "y", "z"}, "", "quaternion components"},
      {"task_row", rows, "", "rows that the task controls"},
      {"principal", {"smallest", "middle", "largest"}, "", "principal directions of an ellipsoid"},
  };
  layout.lists = {
      {"position_unit", "position_coordinate", joint_coordinates.position_units, "unit of joint positions"},
      {"velocity_unit", "velocity_coordinate", joint_coordinates.velocity_units, "unit of joint velocities"},
      {"acceleration_unit", "velocity_coordinate", joint_coordinates.acceleration_units,
       "unit of joint accelerations"},
      {"effort_unit", "velocity_coordinate", joint_coordinates.effort_units,
       "unit of joint torques and forces"},
      {"spatial_velocity_unit", "spatial", halves("rad/s", "m/s"), "unit of spatial velocities"},
      {"spatial_acceleration_unit", "spatial", halves("rad/s^2", "m/s^2"), "unit of spatial accelerations"},
      {"spatial_force_unit", "spatial", halves("N m", "N"), "unit of spatial forces"},
      {"spatial_error_unit", "spatial", halves("rad", "m"), "unit of the pose error"},
  };

  const auto along_time = [&layout](const std::string& path, const std::vector<std::string>& more,
                                    const std::string& unit, const std::string& name,
                                    bool may_be_missing = false) {
    std::vector<std::string> axes{"time"};
    axes.insert(axes.end(), more.begin(), more.end());
    layout.variables.push_back({path, axes, unit, name, Kind::real, may_be_missing});
  };
  along_time("trajectory/joint_position", {"position_coordinate"}, "", "joint positions");
  along_time("trajectory/joint_velocity", {"velocity_coordinate"}, "", "joint velocities");
  along_time("trajectory/joint_acceleration", {"velocity_coordinate"}, "",
             "joint accelerations of the plant");
  along_time("trajectory/joint_torque", {"velocity_coordinate"}, "",
             "joint torques applied by the controller");
  along_time("trajectory/tip_position", {"xyz"}, "m", "tip point");
  along_time("trajectory/tip_orientation", {"quaternion"}, "1", "tip axes, sign continuous in time");
  along_time("trajectory/tip_velocity", {"spatial"}, "", "tip velocity");
  along_time("trajectory/tip_acceleration", {"spatial"}, "", "tip acceleration of the plant, ordinary");
  along_time("trajectory/command", {"spatial"}, "", "commanded tip acceleration u", true);
  along_time("trajectory/pose_error", {"spatial"}, "",
             "rotation vector and position error, reference minus tip");
  along_time("trajectory/reference_position", {"xyz"}, "m", "reference of the tip point");
  along_time("trajectory/reference_orientation", {"quaternion"}, "1", "reference of the tip axes");
  along_time("trajectory/reference_velocity", {"spatial"}, "", "reference velocity");
  along_time("trajectory/reference_acceleration", {"spatial"}, "", "reference acceleration");
  if (const auto chart = chart_of(experiment.controller.orientation, experiment.controller.position)) {
    std::vector<std::string> coordinates, units, accelerations;
    for (const CoordinateName& c : chart->names()) {
      coordinates.emplace_back(c.name);
      units.emplace_back(c.unit);
      accelerations.push_back(std::string(c.unit) + "/s^2");
    }
    layout.axes.push_back({"coordinate", coordinates, "", "operational coordinates that the law tracks"});
    layout.lists.push_back({"coordinate_unit", "coordinate", units, "unit of the coordinates"});
    layout.lists.push_back(
        {"coordinate_acceleration_unit", "coordinate", accelerations, "unit of their second derivatives"});
    along_time("trajectory/coordinate", {"coordinate"}, "", "operational coordinates of the tip");
    along_time("trajectory/coordinate_command", {"coordinate"}, "",
               "commanded second derivative of the operational coordinates");
  }
  along_time("trajectory/tip_force", {"spatial"}, "", "wrench of the surroundings on the tip");
  if (experiment.plant.environment) {
    along_time("contact/gap", {}, "m", "distance of the tip from the surface, negative inside");
    along_time("contact/pressure", {}, "N", "normal force of the surface on the tip");
  }
  along_time("operational_space/Omega", {"spatial", "spatial_column"}, "",
             "J M^-1 J*, inverse of Lambda, by recursion");
  along_time("operational_space/Lambda", {"spatial", "spatial_column"}, "",
             "operational-space inertia on the task rows, by recursion", true);
  along_time("operational_space/c", {"spatial"}, "", "operational-space Coriolis and centrifugal force",
             true);
  along_time("operational_space/g", {"spatial"}, "", "operational-space gravity force", true);
  along_time("operational_space/F", {"spatial"}, "", "commanded tip force F_c", true);
  along_time("operational_space/cond_Omega", {}, "1",
             "condition number of Omega on the task rows, scaled to unit diagonal", true);
  along_time(
      "operational_space/sigma_min", {}, "1",
      "smallest eigenvalue of Omega on the task rows, scaled by the mean diagonal entry of each block");
  along_time("operational_space/effective_mass", {"principal"}, "kg", "principal effective masses of the tip",
             true);
  along_time("operational_space/effective_mass_axes", {"principal", "xyz"}, "1", "their unit directions");
  along_time("operational_space/effective_inertia", {"principal"}, "kg m^2",
             "principal effective inertias of the tip", true);
  along_time("operational_space/effective_inertia_axes", {"principal", "xyz"}, "1", "their unit directions");
  along_time("energy/kinetic", {}, "J", "kinetic energy of links and rotors");
  along_time("energy/potential", {}, "J", "potential energy");
  along_time("energy/work", {}, "J", "work of the joint torques since the start");
  along_time("energy/dissipated", {}, "J", "energy lost in joint friction and at a surface since the start");
  along_time("energy/self_motion", {}, "J", "kinetic energy of motion that the tip does not see", true);
  along_time("energy/external_work", {}, "J", "work of the external tip force since the start");

  const auto along_steps = [&layout](const std::string& path, const std::string& unit,
                                     const std::string& name, Kind kind, bool may_be_missing) {
    layout.variables.push_back({path, {"step"}, unit, name, kind, may_be_missing});
  };
  along_steps("step_time", "s", "time at the end of the step", Kind::real, false);
  along_steps("solver/step_size", "s", "step size", Kind::real, false);
  along_steps("solver/order", "1", "order of the method", Kind::integer, false);
  along_steps("solver/rhs_evaluations", "1", "right-hand side evaluations since the start", Kind::integer,
              false);
  along_steps("solver/local_error", "1", "largest estimated local error in units of its tolerance",
              Kind::real, false);
  along_steps("solver/global_error_position", "m", "estimate of the tip position's true error so far",
              Kind::real, true);
  along_steps("solver/global_error_orientation", "rad", "estimate of the tip orientation's true error so far",
              Kind::real, true);
  along_steps("departure/angular_acceleration", "rad/s^2", "length of tip acceleration - u, task rows",
              Kind::real, true);
  along_steps("departure/linear_acceleration", "m/s^2", "length of tip acceleration - u, task rows",
              Kind::real, true);
  along_steps("solver/contact", "1", "1 while the tip is in contact", Kind::small, false);
  along_steps("solver/truncated", "1", "directions that the singularity policy leaves out", Kind::small,
              false);
  for (const auto& claim : claim_table) {
    const std::string path = "verification/" + std::string(claim.id);
    along_steps(path, "1", "residual of the claim " + std::string(claim.id), Kind::real, true);
    along_steps(path + "_bound", "1", "its bound", Kind::real, true);
  }

  if (makes_restart_points(experiment)) add_restart_points(layout);
  layout.texts = provenance(experiment, arms.description.urdf_text, command);
  return layout;
}

double or_missing(double x) { return std::isfinite(x) ? x : missing; }

Compliance<double> compliance(const UpTo6x6& a) {
  const auto block = [&a](int i, int j) -> Mat3<double> {
    return {{a(i, j), a(i, j + 1), a(i, j + 2)},
            {a(i + 1, j), a(i + 1, j + 1), a(i + 1, j + 2)},
            {a(i + 2, j), a(i + 2, j + 1), a(i + 2, j + 2)}};
  };
  const auto symmetric = [&a](int i) -> Sym3<double> {
    return {a(i, i), a(i, i + 1), a(i, i + 2), a(i + 1, i + 1), a(i + 1, i + 2), a(i + 2, i + 2)};
  };
  return {symmetric(0), block(0, 3), symmetric(3)};
}

void push(std::vector<double>& row, std::span<const double> values) {
  row.insert(row.end(), values.begin(), values.end());
}
/// Column by column.
template <class Derived>
void push(std::vector<double>& row, const Eigen::PlainObjectBase<Derived>& values) {
  row.insert(row.end(), values.data(), values.data() + values.size());
}

void push_ellipsoid(std::vector<double>& row, const Ellipsoid& ellipsoid) {
  for (int i = 0; i < 3; ++i) row.push_back(or_missing(ellipsoid.principal[i]));
  push(row, ellipsoid.axes);  // column-major: one axis after the other
}

/// Values on the task rows spread over six, the rest missing.
Vector6 spread(const UpTo6& values, const TaskRows& rows) {
  Vector6 out = Vector6::Constant(missing);
  for (std::size_t i = 0; i < rows.size(); ++i) out[rows[i]] = values[static_cast<Eigen::Index>(i)];
  return out;
}

}  // namespace

Recording::Recording(const std::filesystem::path& file, const Experiment& experiment, const Arms& arms,
                     const std::string& command, bool force)
    : file_(file, make_layout(experiment, arms, command), force),
      rows_(experiment.controller.rows),
      controlled_(experiment.controller.law != Law::free),
      contact_(experiment.plant.environment.has_value()) {}

void Recording::output(const Observation& seen, const TaskRows& rows, const RecursiveTerms& terms) {
  row_.clear();
  row_.push_back(seen.t);
  push(row_, seen.q);
  push(row_, seen.qd);
  push(row_, seen.qdd);
  push(row_, seen.torque);
  const Command& command = seen.command;
  tip_quaternion_ = quaternion(command.tip.R, tip_quaternion_);
  reference_quaternion_ = quaternion(command.reference.pose.R, reference_quaternion_);
  push(row_, command.tip.p);
  push(row_, tip_quaternion_);
  push(row_, command.tip_velocity);
  push(row_, seen.tip_acceleration);
  Vector6 u = Vector6::Constant(missing);
  for (const int i : rows) u[i] = command.u[i];
  push(row_, u);
  push(row_, command.error.e);
  push(row_, command.reference.pose.p);
  push(row_, reference_quaternion_);
  push(row_, command.reference.velocity);
  push(row_, command.reference.acceleration);
  push(row_, command.y);
  push(row_, command.v);
  push(row_, seen.tip_force);
  if (contact_) {
    row_.push_back(seen.touch.gap);
    row_.push_back(seen.touch.normal.dot(seen.touch.wrench.tail<3>()));
  }
  push(row_, terms.Omega);  // symmetric: row-major or column-major alike
  Eigen::Matrix<double, 6, 6> Lambda = Eigen::Matrix<double, 6, 6>::Constant(missing);
  Vector6 c = Vector6::Constant(missing), g = c, F = c;
  if (terms.Lambda.size() > 0) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < rows.size(); ++j)
        Lambda(rows[i], rows[j]) = terms.Lambda(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    c = spread(terms.c, rows);
    g = spread(terms.g, rows);
    for (const int i : rows) F[i] = command.F[i];
  }
  const Eigen::Matrix<double, 6, 6> Lambda_by_rows = Lambda.transpose();
  push(row_, Lambda_by_rows);
  push(row_, c);
  push(row_, g);
  push(row_, F);
  const Compliance<double> Omega = compliance(terms.Omega);
  row_.push_back(or_missing(scaled_condition(MatrixX<double>(terms.Omega(rows, rows)))));
  row_.push_back(SingularTask({}, Omega, rows).eigenvalues()[0]);
  push_ellipsoid(row_, effective_mass(Omega));
  push_ellipsoid(row_, effective_inertia(Omega));
  double self_motion = missing;
  if (terms.Lambda.size() > 0) {
    const UpTo6 V = command.tip_velocity(rows);
    self_motion = seen.kinetic - V.dot(terms.Lambda.lazyProduct(V)) / 2;
  }
  for (const double energy :
       {seen.kinetic, seen.potential, seen.work, seen.dissipated, self_motion, seen.external_work})
    row_.push_back(energy);
  file_.append("time", row_);
}

void Recording::step(const Step& step, const Residuals& residuals) {
  row_.clear();
  row_.push_back(static_cast<double>(step.number));
  const StepInfo& info = step.info;
  double missed[2] = {0, 0};
  for (const int i : rows_) missed[i / 3] += step.missed[i] * step.missed[i];
  for (const double value :
       {info.t, info.h, static_cast<double>(info.order), static_cast<double>(step.rhs_evaluations),
        info.local_error, step.error.known ? step.error.position : missing,
        step.error.known ? step.error.orientation : missing, controlled_ ? std::sqrt(missed[0]) : missing,
        controlled_ ? std::sqrt(missed[1]) : missing, static_cast<double>(step.modes.contact),
        static_cast<double>(step.modes.truncated)})
    row_.push_back(value);
  for (const Residual& r : residuals) {
    row_.push_back(r.applies ? r.value : missing);
    row_.push_back(r.applies ? r.bound : missing);
  }
  file_.append("step", row_);
}

void Recording::go_on_from(const RestartPoint& point) { copy_until(point, file_); }

void Recording::restart_point(double t, const std::vector<double>& memory) {
  append_restart_point(t, memory, file_);
}

void Recording::finish(const RunResult& result) {
  file_.finish(result.status, result.verdict, ending_of(result));
}

}  // namespace osculate
