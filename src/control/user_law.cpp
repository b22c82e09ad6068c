// What a law of somebody else's is given, and what is taken from it.
#include <osculate/controller.h>

#include <algorithm>
#include <limits>

#include "control/law.hpp"
#include "control/rotation.hpp"
#include "reference/dense.hpp"

namespace osculate {

namespace {

/// The arrays that a question points to.
struct Given {
  std::vector<std::int32_t> row;
  std::vector<double> u;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> M, J;
  VectorX<double> C, G, Jdot_qd;
};

void copy(const Vector6& from, double* to) { std::copy_n(from.data(), 6, to); }
void copy(const Pose& from, double* position, double* orientation) {
  std::copy_n(from.p.data(), 3, position);
  const Eigen::Vector4d w_first = quaternion(from.R);
  std::copy_n(w_first.data(), 4, orientation);
}

/// The terms of the model, by the definitions: those of the textbook laws.
void add_terms(const Chain<double>& model, const std::vector<JointPosition<double>>& joints,
               const BaseMotion<double>& base, std::span<const double> qd, const TaskRows& rows, Given& given,
               osculate_controller_input& in) {
  const Eigen::Map<const VectorX<double>> rates(qd.data(), static_cast<Eigen::Index>(qd.size()));
  const auto [tip, joint] = dense::state(model, joints, VectorX<double>(rates), base);
  given.M = joint.M;
  given.C = joint.C;
  given.G = joint.G;
  const auto m = static_cast<Eigen::Index>(rows.size());
  given.J.resize(m, rates.size());
  given.Jdot_qd.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    given.J.row(i) = tip.J.row(rows[static_cast<std::size_t>(i)]);
    given.Jdot_qd[i] = tip.Jdot_qd[rows[static_cast<std::size_t>(i)]];
  }
  in.M = given.M.data();
  in.C = given.C.data();
  in.G = given.G.data();
  in.J = given.J.data();
  in.Jdot_qd = given.Jdot_qd.data();
}

}  // namespace

void Controller::user(double t, std::span<const double> qd) {
  Given given;
  given.row.assign(options_.rows.begin(), options_.rows.end());
  for (const int row : options_.rows) given.u.push_back(command_.u[row]);
  if (!has_null_space_) std::fill(T0_.begin(), T0_.end(), 0.0);

  osculate_controller_input in{};
  in.size = sizeof in;
  in.t = t;
  in.positions = model_.positions();
  in.velocities = model_.velocities();
  in.rows = static_cast<std::int32_t>(given.row.size());
  in.tip_force_known = options_.know_tip_force;
  in.row = given.row.data();
  in.q = known_q_.data();
  in.qd = known_qd_.data();
  copy(options_.stiffness, in.stiffness);
  copy(options_.damping, in.damping);
  copy(command_.tip, in.tip_position, in.tip_orientation);
  copy(command_.tip_velocity, in.tip_velocity);
  copy(command_.reference.pose, in.reference_position, in.reference_orientation);
  copy(command_.reference.velocity, in.reference_velocity);
  copy(command_.reference.acceleration, in.reference_acceleration);
  copy({base_.R, base_.p}, in.base_position, in.base_orientation);
  copy(base_.velocity, in.base_velocity);
  copy(base_.acceleration, in.base_acceleration);
  copy(known_tip_force_, in.tip_force);
  in.u = given.u.data();
  in.null_space_torque = T0_.data();
  if (options_.user->law.terms) add_terms(model_, joints_, base_, qd, options_.rows, given, in);

  const UserLawAnswer& answer = user_.torque(in);
  std::copy(answer.torque.begin(), answer.torque.end(), rigid_torque_.begin());
  for (std::size_t i = 0; i < given.u.size(); ++i) command_.u[options_.rows[i]] = answer.u[i];
  if (!has_null_space_)
    std::copy(answer.null_space_torque.begin(), answer.null_space_torque.end(), T0_.begin());
  command_.F.setConstant(std::numeric_limits<double>::quiet_NaN());  // it tells no F_c
}

}  // namespace osculate
