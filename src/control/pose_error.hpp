// The pose-tracking law: an error whose second derivative can be prescribed exactly, for any orientation
// error below pi.
#pragma once

#include "control/reference.hpp"

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

/// The pose whose error to the reference is e: R = exp(e_R)^T R_ref, p = p_ref - e_p.
Pose exact_tip(const TipReference& reference, const Vector6& e);

}  // namespace osculate
