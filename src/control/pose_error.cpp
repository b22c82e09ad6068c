#include "control/pose_error.hpp"

#include <Eigen/Geometry>

#include "control/rotation.hpp"

namespace osculate {

// With E = R_ref R^T and E. = delta~ E:
//   delta  = omega_ref - E omega                                angular velocity of E, base axes
//   delta  = J_l(e_R) e_R.
//   delta. = omega_ref. - delta x (E omega) - E omega.          since E. omega = delta x (E omega)
//   delta. = J_l(e_R) e_R.. + J_l.(e_R, e_R.) e_R.

PoseError pose_error(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity) {
  const Matrix3<double> E = reference.pose.R * tip.R.transpose();
  const Vector3<double> e_R = log_rotation(E);
  const Vector3<double> delta = reference.velocity.head<3>() - E * tip_velocity.head<3>();
  PoseError out;
  out.e << e_R, reference.pose.p - tip.p;
  out.ed << RotationVector(e_R).left_jacobian_inverse(delta),
      reference.velocity.tail<3>() - tip_velocity.tail<3>();
  return out;
}

Vector6 pose_command(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity,
                     const PoseError& error, const Vector6& edd) {
  const Matrix3<double> E = reference.pose.R * tip.R.transpose();
  const Vector3<double> e_R = error.e.head<3>();
  const Vector3<double> e_Rd = error.ed.head<3>();
  const RotationVector error_turn(e_R);
  const Vector3<double> turned = E * tip_velocity.head<3>();
  const Vector3<double> delta = reference.velocity.head<3>() - turned;
  const Vector3<double> deltad =
      error_turn.left_jacobian(edd.head<3>()) + error_turn.left_jacobian_rate(e_Rd, e_Rd);
  Vector6 u;
  u << E.transpose() * (reference.acceleration.head<3>() - delta.cross(turned) - deltad),
      reference.acceleration.tail<3>() - edd.tail<3>();
  return u;
}

Pose exact_tip(const TipReference& reference, const Vector6& e) {
  return {exp_rotation(e.head<3>()).transpose() * reference.pose.R, reference.pose.p - e.tail<3>()};
}

}  // namespace osculate
