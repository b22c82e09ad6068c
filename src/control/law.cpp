#include "control/law.hpp"

#include <algorithm>
#include <string>

namespace osculate {

namespace {

// A pivot of L D L^T below this fraction of its diagonal entry has lost all but a few bits: rank loss in
// double.
constexpr double pivot_floor = 1e-13;

template <class Space>
Vector6 to_vector6(const Vec<Space, double>& v) {
  Vector6 out;
  out << v.ang.x, v.ang.y, v.ang.z, v.lin.x, v.lin.y, v.lin.z;
  return out;
}

Matrix3<double> to_matrix(const Mat3<double>& m) {
  Matrix3<double> out;
  out << m.x.x, m.x.y, m.x.z, m.y.x, m.y.y, m.y.z, m.z.x, m.z.y, m.z.z;
  return out;
}

Pose tip_of(const OperationalSpace<double>& space) {
  const auto& p = space.tip_position();
  return {to_matrix(space.tip_rotation()), {p.x, p.y, p.z}};
}

constexpr const char* row_names[] = {"wx", "wy", "wz", "vx", "vy", "vz"};

}  // namespace

Controller::Controller(const Chain<double>& model, std::vector<JointFriction> friction,
                       const LawOptions& options, std::shared_ptr<const Path> path, const Pose& initial)
    : model_(model),
      friction_(std::move(friction)),
      options_(options),
      path_(std::move(path)),
      initial_(initial),
      space_(model),
      joints_(model.links.size()),
      T0_(model.links.size(), 0.0),
      rigid_torque_(model.links.size(), 0.0) {}

TaskFactor<double> Controller::factor() const { return {space_.Omega(), options_.rows}; }

int Controller::lost_row(const TaskFactor<double>& Omega) const {
  for (int i = 0; i < Omega.size(); ++i) {
    const int row = options_.rows[static_cast<std::size_t>(i)];
    const double pivot = Omega.pivots()[static_cast<std::size_t>(i)];
    if (!(pivot > pivot_floor * component(space_.Omega(), row, row))) return row;
  }
  return -1;
}

const Command& Controller::torque(double t, std::span<const double> q, std::span<const double> qd,
                                  std::span<double> T) {
  set_positions(model_, q, joints_);
  space_.place(joints_);
  for (std::size_t i = 0; i < T0_.size(); ++i) T0_[i] = -options_.null_space_damping * qd[i];
  space_.sweep(qd, T0_);  // sweeps 1, 2, 3
  command_.tip = tip_of(space_);
  command_.tip_velocity = to_vector6(space_.tip_velocity());
  command_.reference = tip_reference(*path_, initial_, t);
  command_.error = pose_error(command_.reference, command_.tip, command_.tip_velocity);
  if (options_.law == Law::free) {
    command_.u.setZero();
    command_.F.setZero();
    std::fill(T.begin(), T.end(), 0.0);
    std::fill(rigid_torque_.begin(), rigid_torque_.end(), 0.0);
    return command_;
  }
  const auto& [e, ed] = command_.error;
  const Vector6 edd = -options_.damping.cwiseProduct(ed) - options_.stiffness.cwiseProduct(e);
  command_.u = options_.constant_command ? *options_.constant_command
                                         : pose_command(command_.reference, command_.tip,
                                                        command_.tip_velocity, command_.error, edd);

  const TaskFactor<double> Omega = factor();
  if (const int row = lost_row(Omega); row >= 0)
    throw SingularTask("the arm is singular at t = " + std::to_string(t) + " s: task row " + row_names[row] +
                       " depends on the rows before it");
  TaskVector<double> right = restricted(space_.right_side(), options_.rows);
  for (std::size_t i = 0; i < options_.rows.size(); ++i)
    right[i] += seeded(Fault::law_command, command_.u[options_.rows[i]]);
  const Vec<Force, double> F_c =
      wrench(Omega.solve(right), options_.rows);  // (4): one solve on u + right side
  space_.torques(F_c, rigid_torque_);             // sweep 4
  command_.F = to_vector6(F_c);
  for (std::size_t i = 0; i < T.size(); ++i) {
    T[i] = rigid_torque_[i];
    if (options_.compensate_friction && !friction_.empty()) T[i] += friction_torque(friction_[i], qd[i]);
  }
  return command_;
}

RecursiveTerms Controller::terms(std::span<const double> qd) {
  const auto m = static_cast<Eigen::Index>(options_.rows.size());
  const auto as_vector = [m](const TaskVector<double>& v) {
    return VectorX<double>(Eigen::Map<const VectorX<double>>(v.data(), m));
  };
  RecursiveTerms out;
  out.Omega.resize(6, 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) out.Omega(i, j) = component(space_.Omega(), i, j);
  const TaskFactor<double> Omega = factor();
  if (lost_row(Omega) >= 0) return out;
  out.Lambda.resize(m, m);
  for (Eigen::Index j = 0; j < m; ++j) {
    TaskVector<double> unit{};
    unit[static_cast<std::size_t>(j)] = 1;
    out.Lambda.col(j) = as_vector(Omega.solve(unit));
  }
  space_.sweep(qd);  // without T0: right side of c + g alone
  out.c_plus_g = as_vector(Omega.solve(restricted(space_.right_side(), options_.rows)));
  out.g = as_vector(Omega.solve(restricted(space_.right_side_of_g(), options_.rows)));
  out.c = as_vector(Omega.solve(restricted(space_.right_side_of_c(qd), options_.rows)));
  return out;
}

Pose tip_pose(const Chain<double>& chain, std::span<const double> q) {
  OperationalSpace<double> space(chain);
  space.place(positions(chain, q));
  return tip_of(space);
}

}  // namespace osculate
