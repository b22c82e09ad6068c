#include "control/pose_error.hpp"

namespace osculate {

// With E = R_ref R^T and E. = delta~ E:
//   delta  = omega_ref - E omega                                angular velocity of E, base axes
//   delta  = J_l(e_R) e_R.
//   delta. = omega_ref. - delta x (E omega) - E omega.          since E. omega = delta x (E omega)
//   delta. = J_l(e_R) e_R.. + J_l.(e_R, e_R.) e_R.

void PoseTracking::turn(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity) {
  const Matrix3<double>&A = reference.pose.R, &B = tip.R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) E_(i, j) = A(i, 0) * B(j, 0) + A(i, 1) * B(j, 1) + A(i, 2) * B(j, 2);
    turned_[i] = E_(i, 0) * tip_velocity[0] + E_(i, 1) * tip_velocity[1] + E_(i, 2) * tip_velocity[2];
    delta_[i] = reference.velocity[i] - turned_[i];
  }
}

void PoseTracking::look(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity) {
  turn(reference, tip, tip_velocity);
  const Vector3<double> e_R = log_rotation(E_);
  error_turn_ = RotationVector(e_R);
  const Vector3<double> e_Rd = error_turn_.left_jacobian_inverse(delta_);
  for (int i = 0; i < 3; ++i) {
    error_.e[i] = e_R[i];
    error_.e[3 + i] = reference.pose.p[i] - tip.p[i];
    error_.ed[i] = e_Rd[i];
    error_.ed[3 + i] = reference.velocity[3 + i] - tip_velocity[3 + i];
  }
}

Vector6 PoseTracking::command(const Vector6& acceleration, const Vector6& edd) const {
  const Vector3<double> e_Rd = error_.ed.head<3>(), e_Rdd = edd.head<3>();
  const Vector3<double> deltad = error_turn_.left_jacobian(e_Rdd) + error_turn_.left_jacobian_rate(e_Rd);
  const Vector3<double> carried = delta_.cross(turned_);
  Vector3<double> turning;
  for (int i = 0; i < 3; ++i) turning[i] = acceleration[i] - carried[i] - deltad[i];
  Vector6 u;
  for (int i = 0; i < 3; ++i) {
    u[i] = E_(0, i) * turning[0] + E_(1, i) * turning[1] + E_(2, i) * turning[2];
    u[3 + i] = acceleration[3 + i] - edd[3 + i];
  }
  return u;
}

PoseError pose_error(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity) {
  PoseTracking tracking;
  tracking.look(reference, tip, tip_velocity);
  return tracking.error();
}

Vector6 pose_command(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity,
                     const PoseError& error, const Vector6& edd) {
  PoseTracking tracking;
  tracking.turn(reference, tip, tip_velocity);
  tracking.error_ = error;
  tracking.error_turn_ = RotationVector(error.e.head<3>());
  return tracking.command(reference.acceleration, edd);
}

Pose exact_tip(const TipReference& reference, const Vector6& e) {
  return {exp_rotation(e.head<3>()).transpose() * reference.pose.R, reference.pose.p - e.tail<3>()};
}

}  // namespace osculate
