// The pose-tracking law: an error whose second derivative can be prescribed exactly, for any orientation
// error below pi.
#pragma once

#include "control/reference.hpp"
#include "control/rotation.hpp"

namespace osculate {

/// Error of the tip and its time derivative. Rows 0..2: e_R = log(R_ref R^T), rad, base axes, |e_R| <= pi;
/// rows 3..5: p_ref - p, m, base axes.
struct PoseError {
  Vector6 e = Vector6::Zero();   // rad, m
  Vector6 ed = Vector6::Zero();  // rad/s, m/s
};

/// Error of a tip with the given pose and velocity (base frame, about the tip point, angular first). `ed` is
/// the exact derivative of `e`, for |e_R| < pi; at pi the sign of e_R jumps. Allocates nothing.
PoseError pose_error(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity);

/// The tip acceleration (rad/s^2, m/s^2; base frame, angular first) under which the second derivative of the
/// error is exactly `edd`. The law e'' + D e' + K e = 0 passes edd = -D ed - K e. Allocates nothing.
Vector6 pose_command(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity,
                     const PoseError& error, const Vector6& edd);

/// The same two for a law, which wants both: what they share is computed once.
class PoseTracking {
 public:
  /// Error at this reference and tip, by pose_error.
  void look(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity);

  const PoseError& error() const { return error_; }
  /// pose_command for that reference and tip; `acceleration` of the reference.
  Vector6 command(const Vector6& acceleration, const Vector6& edd) const;

 private:
  friend Vector6 pose_command(const TipReference&, const Pose&, const Vector6&, const PoseError&,
                              const Vector6&);
  /// Sets E and what follows from it.
  void turn(const TipReference& reference, const Pose& tip, const Vector6& tip_velocity);

  Matrix3<double> E_ = Matrix3<double>::Identity();   // R_ref R^T
  Vector3<double> turned_ = Vector3<double>::Zero();  // E omega, rad/s
  Vector3<double> delta_ = Vector3<double>::Zero();   // angular velocity of E, rad/s, base axes
  RotationVector error_turn_;                         // e_R
  PoseError error_;
};

/// The pose whose error to the reference is e: R = exp(e_R)^T R_ref, p = p_ref - e_p.
Pose exact_tip(const TipReference& reference, const Vector6& e);

}  // namespace osculate
