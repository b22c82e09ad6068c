#include "jury/reference_data.hpp"

#include <limits>
#include <map>

#include "model/coordinate_names.hpp"
#include "recursion/forward_dynamics.hpp"
#include "reference/conditioning.hpp"
#include "reference/dense.hpp"
#include "reference/true_arm.hpp"

namespace osculate::jury {

namespace {

using Matrix = MatrixX<Quad>;
using Vector = VectorX<Quad>;
using Joints = std::vector<JointPosition<Quad>>;

std::span<const Quad> span_of(const Vector& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }
std::span<Quad> span_of(Vector& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

template <class Space>
Vector six(const Vec<Space, Quad>& v) {
  Vector out(6);
  for (int i = 0; i < 6; ++i) out[i] = component(v, i);
  return out;
}
Vector chosen(const Vector& x, const TaskRows& rows) { return x(rows); }

Quad largest(const Matrix& A) {
  Quad out(0);
  for (const Quad& x : A.reshaped())
    if (const Quad size = abs(x); size > out) out = size;
  return out;
}

/// Unit quaternion w x y z of a rotation, w >= 0: from the largest of its four squares, so that nothing small
/// divides.
Vector quaternion(const Matrix3<Quad>& R) {
  const Quad one(1), trace = R.trace();
  int at = 0;  // of the largest
  Quad most = one + trace;
  for (int i = 0; i < 3; ++i)
    if (const Quad square = one + R(i, i) + R(i, i) - trace; square > most) most = square, at = i + 1;
  const Quad four = sqrt(most) * Quad(2);  // 4 times that entry
  Vector e(4);
  e[at] = four / Quad(4);
  if (at == 0) {
    for (int i = 0; i < 3; ++i) e[1 + i] = (R((i + 2) % 3, (i + 1) % 3) - R((i + 1) % 3, (i + 2) % 3)) / four;
  } else {
    const int i = at - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    e[0] = (R(k, j) - R(j, k)) / four;
    e[1 + j] = (R(i, j) + R(j, i)) / four;
    e[1 + k] = (R(i, k) + R(k, i)) / four;
  }
  return e[0] < Quad(0) ? Vector(-e) : e;
}

/// What the recursions say at one state, over 113 bits. M, C, G, J and Jdot qd, which they do not form, are
/// asked for by what they do: accelerations under unit torques, torques under unit wrenches.
class Recursions {
 public:
  explicit Recursions(const Chain<Quad>& chain)
      : n_(chain.velocities()), space_(chain), plant_(chain), weightless_(without_gravity(chain)) {}

  void place(const Joints& joints, const Vector& qd) {
    space_.place(joints);
    plant_.place(joints);
    weightless_.place(joints);
    qd_ = qd;
    space_.sweep(span_of(qd_));
  }

  Matrix3<Quad> rotation() const {
    const auto& R = space_.tip_rotation();
    Matrix3<Quad> out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(i, j) = entry(R, i, j);
    return out;
  }
  Vector position() const {
    const auto& p = space_.tip_position();
    return Vector3<Quad>(p.x, p.y, p.z);
  }
  Vector tip_velocity() const { return six(space_.tip_velocity()); }
  Matrix Omega() const {
    Matrix out(6, 6);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) out(i, j) = component(space_.Omega(), i, j);
    return out;
  }
  /// J, row by row: the joint torques of unit wrenches (39). Overwrites torques only.
  Matrix jacobian() {
    Matrix out(6, n_);
    for (int i = 0; i < 6; ++i) {
      Vec<Force, Quad> unit;
      set_component(unit, i, Quad(1));
      out.row(i) = torques(unit).transpose();
    }
    return out;
  }
  Vector torques(const Vec<Force, Quad>& F) {
    Vector out(n_);
    space_.torques(F, span_of(out));
    return out;
  }
  /// Lambda, c, g and F = Lambda u + c + g on the rows, by the recursions' own factor of Omega.
  struct Task {
    Matrix Lambda;
    Vector c, g, F, T;
  };
  Task task(const TaskRows& rows, const Vector& u) {
    const TaskFactor<Quad> factor(space_.Omega(), rows);
    const auto m = static_cast<Eigen::Index>(rows.size());
    const auto solved = [&](const TaskVector<Quad>& right) {
      const TaskVector<Quad> x = factor.solve(right);
      return Vector(Eigen::Map<const Vector>(x.data(), m));
    };
    Task out;
    out.Lambda.resize(m, m);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      TaskVector<Quad> unit{};
      unit[i] = Quad(1);
      out.Lambda.col(static_cast<Eigen::Index>(i)) = solved(unit);
    }
    TaskVector<Quad> right = restricted(space_.right_side(), rows);
    for (std::size_t i = 0; i < rows.size(); ++i) right[i] += u[static_cast<Eigen::Index>(i)];
    out.g = solved(restricted(space_.right_side_of_g(), rows));
    const TaskVector<Quad> F = factor.solve(right);
    out.F = Eigen::Map<const Vector>(F.data(), m);
    out.T = torques(wrench(F, rows));
    out.c = solved(restricted(space_.right_side_of_c(span_of(qd_)), rows));
    return out;
  }

  struct Accelerations {
    Vector qdd, tip;  // of the joints, and of the tip
  };
  Accelerations accelerate(const Vector& tau) { return accelerated(plant_, qd_, tau); }
  /// Without gravity, and at rest where `qd` is zero.
  Vector accelerate_weightless(const Vector& qd, const Vector& tau) {
    return accelerated(weightless_, qd, tau).qdd;
  }
  Vector accelerate_at_rest(const Vector& tau) {
    return accelerated(plant_, Vector(Vector::Zero(n_)), tau).qdd;
  }
  Quad kinetic_energy() { return plant_.kinetic_energy(span_of(qd_)); }
  Quad potential_energy() { return plant_.potential_energy(); }

 private:
  using Plant = BasicForwardDynamics<Joint<Quad>>;
  static Chain<Quad> without_gravity(Chain<Quad> chain) {
    chain.gravity.setZero();
    return chain;
  }
  Accelerations accelerated(Plant& plant, const Vector& qd, const Vector& tau) const {
    Accelerations out{Vector(n_), {}};
    plant.accelerations(span_of(qd), span_of(tau), {}, span_of(out.qdd));
    out.tip = six(plant.tip_acceleration());
    return out;
  }

  Eigen::Index n_;
  BasicOperationalSpace<Joint<Quad>> space_;
  Plant plant_, weightless_;
  Vector qd_;
};

/// Quantities in the order in which they were first put.
class Collector {
 public:
  explicit Collector(ReferenceData& out) : out_(out) {}

  void describe(std::string name, std::vector<std::string> axes, std::string unit, std::string units,
                std::string meaning) {
    place_[name] = out_.quantities.size();
    out_.quantities.push_back(
        {std::move(name), std::move(axes), std::move(unit), std::move(units), std::move(meaning), {}});
  }
  /// Adds a state's numbers, by rows.
  void put(const std::string& name, const Matrix& x) {
    std::vector<double>& values = at(name).values;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      for (Eigen::Index j = 0; j < x.cols(); ++j) values.push_back(static_cast<double>(x(i, j)));
  }
  void put(const std::string& name, const Quad& x) { at(name).values.push_back(static_cast<double>(x)); }
  void put_double(const std::string& name, double x) { at(name).values.push_back(x); }
  void put_missing(const std::string& name, Eigen::Index count) {
    at(name).values.insert(at(name).values.end(), static_cast<std::size_t>(count),
                           std::numeric_limits<double>::quiet_NaN());
  }
  /// The same number by the other formulation; `scale` of the difference: the largest entry of x.
  void compare(const std::string& name, const Matrix& x, const Matrix& y) {
    see(name, largest(Matrix(x - y)), largest(x));
  }
  void put_compared(const std::string& name, const Matrix& x, const Matrix& y) {
    put(name, x);
    compare(name, x, y);
  }
  void see(const std::string& name, const Quad& off, const Quad& scale) {
    const double value = off == Quad(0) ? 0 : static_cast<double>(off / scale);
    Quantity& quantity = at(name);
    // Not-a-number and infinity count as the worst.
    if (!(value <= quantity.difference)) quantity.difference = value;
    if (!(value <= out_.worst)) out_.worst = value, out_.worst_of = name;
  }

 private:
  Quantity& at(const std::string& name) { return out_.quantities[place_.at(name)]; }
  ReferenceData& out_;
  std::map<std::string, std::size_t> place_;
};

void describe_all(Collector& out) {
  const std::string joint = "velocity_coordinate", column = "velocity_coordinate_column", row = "task_row";
  const std::string effort = "effort_unit", rate = "velocity_unit",
                    turning = "N m on angular rows, N on linear";
  out.describe("q", {"position_coordinate"}, "", "position_unit", "joint positions, exact");
  out.describe("qd", {joint}, "", rate, "joint velocities, exact");
  out.describe("u", {row}, "", "rad/s^2 on angular rows, m/s^2 on linear",
               "commanded tip acceleration, exact");
  out.describe("rotation", {"xyz", "tip_axis"}, "1", "", "tip axes as columns, in base axes");
  out.describe("quaternion", {"quaternion_component"}, "1", "", "the same rotation, w >= 0");
  out.describe("position", {"xyz"}, "m", "", "tip point");
  out.describe("tip_velocity", {"spatial"}, "", "rad/s, m/s", "J qd");
  out.describe("J", {"spatial", joint}, "", "spatial_velocity_unit per velocity_unit", "Jacobian of the tip");
  out.describe("Jdot_qd", {"spatial"}, "", "rad/s^2, m/s^2", "tip acceleration at qdd = 0, ordinary");
  out.describe("M", {joint, column}, "", "effort_unit of the row per acceleration_unit of the column",
               "mass matrix, armature on its diagonal");
  out.describe("C", {joint}, "", effort, "centrifugal and Coriolis torques C(q, qd)");
  out.describe("G", {joint}, "", effort, "gravity torques G(q)");
  out.describe("bias", {joint}, "", effort, "C + G");
  out.describe("Omega", {row, "task_row_column"}, "", "per N m and N", "J M^-1 J* on the task rows");
  out.describe("Lambda", {row, "task_row_column"}, "", "N m and N", "inverse of Omega");
  out.describe("c", {row}, "", turning, "Lambda (J M^-1 C - Jdot qd)");
  out.describe("g", {row}, "", turning, "Lambda J M^-1 G");
  out.describe("F", {row}, "", turning, "Lambda u + c + g");
  out.describe("T", {joint}, "", effort, "J* F: the tip then accelerates by u");
  out.describe("tau", {joint}, "", effort, "a torque, exact");
  out.describe("qdd", {joint}, "", "acceleration_unit", "M^-1 (tau - C - G): forward dynamics");
  out.describe("qdd_given", {joint}, "", "acceleration_unit", "an acceleration, exact");
  out.describe("tau_inverse", {joint}, "", effort, "M qdd_given + C + G: inverse dynamics");
  out.describe("kinetic_energy", {}, "J", "", "1/2 qd* M qd");
  out.describe("potential_energy", {}, "J", "",
               "zero where all centres of mass of the chain lie at the base origin");
  out.describe("cond_M", {}, "1", "",
               "condition number of M scaled to unit diagonal, estimated in double precision");
  out.describe("cond_Omega", {}, "1", "",
               "condition number of Omega scaled to unit diagonal, estimated in double precision");
}

void add_state(const Chain<Quad>& chain, const TaskRows& rows, const JointState& at, Recursions& recursive,
               Collector& out, std::vector<int>& ranks) {
  const Vector q = at.q.cast<Quad>(), qd = at.qd.cast<Quad>(), tau = at.tau.cast<Quad>(),
               qdd_given = at.qdd.cast<Quad>(), u = chosen(at.u.cast<Quad>(), rows);
  const Joints joints = positions<Quad>(chain, span_of(q));
  const auto [tip, joint] = dense::state<Quad>(chain, joints, qd);
  const auto& [M, C, G] = joint;
  const auto task = dense::mobility(tip, joint, rows);
  recursive.place(joints, qd);
  const Eigen::Index n = qd.size(), m = u.size();
  const Vector none = Vector::Zero(n);

  out.put("q", q);
  out.put("qd", qd);
  out.put("u", u);
  out.put_compared("rotation", tip.R, recursive.rotation());
  out.put_compared("quaternion", quaternion(tip.R), quaternion(recursive.rotation()));
  out.put_compared("position", tip.p, recursive.position());
  out.put_compared("tip_velocity", tip.tip_velocity, recursive.tip_velocity());
  const auto motion = recursive.accelerate(tau);
  out.put_compared("J", tip.J, recursive.jacobian());
  out.put("Jdot_qd", tip.Jdot_qd);  // a difference of two accelerations there, which both may be larger
  out.see("Jdot_qd", largest(Vector(tip.Jdot_qd - (motion.tip - tip.J * motion.qdd))),
          largest(tip.Jdot_qd) + largest(motion.tip));
  out.put("M", M);
  Matrix one(n, n);  // M times the accelerations under unit torques
  for (Eigen::Index i = 0; i < n; ++i)
    one.col(i) = M * recursive.accelerate_weightless(none, Vector(Vector::Unit(n, i)));
  out.compare("M", Matrix(Matrix::Identity(n, n)), one);
  out.put_compared("C", C, Vector(-(M * recursive.accelerate_weightless(qd, none))));
  out.put_compared("G", G, Vector(-(M * recursive.accelerate_at_rest(none))));
  out.put_compared("bias", C + G, Vector(-(M * recursive.accelerate(none).qdd)));

  const Matrix Omega_recursive = recursive.Omega();
  out.put_compared("Omega", task.Omega, Matrix(Omega_recursive(rows, rows)));
  const MatrixX<double> Omega = task.Omega.cast<double>();
  ranks.push_back(scaled_rank(Omega));
  if (ranks.back() == static_cast<int>(m)) {
    const auto terms = dense::task_terms(task);
    const auto force = dense::task_force(task, terms, u);
    const auto other = recursive.task(rows, u);
    out.put_compared("Lambda", terms.Lambda, other.Lambda);
    out.put_compared("c", terms.c, other.c);
    out.put_compared("g", terms.g, other.g);
    out.put_compared("F", force.F, other.F);
    out.put_compared("T", force.T, other.T);
    out.put_double("cond_Omega", scaled_condition(Omega));
  } else {
    out.put_missing("Lambda", m * m);
    for (const char* name : {"c", "g", "F"}) out.put_missing(name, m);
    out.put_missing("T", n);
    out.put_missing("cond_Omega", 1);
  }

  out.put("tau", tau);
  out.put_compared("qdd", dense::forward_dynamics(joint, tip.J, tau), motion.qdd);
  out.put("qdd_given", qdd_given);
  const Vector tau_inverse = M * qdd_given + C + G;
  out.put("tau_inverse", tau_inverse);
  out.compare("tau_inverse", qdd_given, recursive.accelerate(tau_inverse).qdd);
  const Quad kinetic = dense::kinetic_energy(joint, qd), potential = dense::potential_energy(chain, joints);
  out.put("kinetic_energy", kinetic);
  out.see("kinetic_energy", abs(kinetic - recursive.kinetic_energy()), abs(kinetic));
  out.put("potential_energy", potential);
  out.see("potential_energy", abs(potential - recursive.potential_energy()), abs(potential));
  out.put_double("cond_M", scaled_condition(M.cast<double>()));
}

/// The numbers that stand for the arm, as the exact arm has them, rounded.
std::vector<Constant> constants(const Chain<Quad>& chain) {
  std::vector<Constant> out{
      {"joint_origin_rotation", {"joint", "xyz", "xyz_column"}, "1", "joint axes in inboard link axes", {}},
      {"joint_origin_position", {"joint", "xyz"}, "m", "joint origin in the inboard link's frame", {}},
      {"joint_axis", {"joint", "xyz"}, "1", "joint axis in the joint's frame", {}},
      {"link_mass", {"joint"}, "kg", "mass of the link that the joint carries", {}},
      {"link_center_of_mass", {"joint", "xyz"}, "m", "in the link's frame", {}},
      {"link_inertia", {"joint", "xyz", "xyz_column"}, "kg m^2", "about the centre of mass, link axes", {}},
      {"armature", {"joint"}, "", "reflected motor inertia, kg m^2 or kg", {}},
      {"tip_rotation", {"xyz", "xyz_column"}, "1", "tip axes in the last link's frame", {}},
      {"tip_position", {"xyz"}, "m", "tip point in the last link's frame", {}},
      {"gravity", {"xyz"}, "m/s^2", "acceleration of free fall, base frame", {}}};
  const auto add = [&out](std::size_t which, const Matrix& x) {
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      for (Eigen::Index j = 0; j < x.cols(); ++j) out[which].values.push_back(static_cast<double>(x(i, j)));
  };
  const auto number = [](const Quad& x) { return Matrix(Matrix::Constant(1, 1, x)); };
  for (const Link<Quad>& link : chain.links) {
    add(0, link.R_origin), add(1, link.p_origin), add(2, link.axis), add(3, number(link.mass));
    add(4, link.com), add(5, link.inertia), add(6, number(link.armature));
  }
  add(7, chain.R_tip), add(8, chain.p_tip), add(9, chain.gravity);
  return out;
}

}  // namespace

ReferenceData reference_data(const ArmDescription& arm, const TaskRows& rows,
                             std::vector<JointState> states) {
  const Chain<Quad> chain = true_arm(arm.chain);
  ReferenceData out;
  out.arm = constants(chain);
  Collector collector(out);
  describe_all(collector);
  Recursions recursive(chain);
  for (const JointState& state : states) add_state(chain, rows, state, recursive, collector, out.rank);
  out.states = std::move(states);
  return out;
}

}  // namespace osculate::jury
