// How the commanded tip acceleration u answers to the tip: the derivative of what command.cpp decides, in
// closed form.
#pragma once

#include "control/law.hpp"

namespace osculate {

/// A small change of what the law sees. Inertial frame, about the tip point, angular part first.
struct TipChange {
  Vector6 pose = Vector6::Zero();      // rad, m: R changes by (pose[0..2])~ R, p by pose[3..5]
  Vector6 velocity = Vector6::Zero();  // rad/s, m/s
  Vector6 force = Vector6::Zero();     // N m, N: wrench on the tip, where the law measures it
};

/// The derivative of u at one instant, for pose tracking with rotation vector and Cartesian position,
/// impedance, force control of some rows, or a constant u.
class CommandSlope {
 public:
  /// False for coordinates of one's own and for obstacles.
  static bool exists(const LawOptions& law);

  /// Where the law has just decided `command`, knowing the wrench `tip_force` on the tip. |e_R| < pi.
  CommandSlope(const LawOptions& law, const Command& command, const Vector6& tip_force);

  /// Change of u, rad/s^2, m/s^2; rows that the task does not control are meaningless.
  Vector6 along(const TipChange& tip) const;

 private:
  const LawOptions& law_;
  Matrix3<double> E_;             // R_ref R^T
  RotationVector error_turn_;     // e_R
  Vector3<double> e_, ed_, edd_;  // e_R, its rate and the second derivative that the gains ask for
  Vector3<double> turned_, delta_, turning_;  // E omega, angular velocity of E, E u
  double b_second_, c_second_;                // second derivatives of the coefficients of J_l
  RotationCoefficients f_;

  /// The second derivative of J_l(e_R) along x and y, applied to z.
  Vector3<double> bent_jacobian(const Vector3<double>& x, const Vector3<double>& y,
                                const Vector3<double>& z) const;
};

}  // namespace osculate
