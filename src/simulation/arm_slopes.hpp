// How the torques and the tip of an arm answer to its joint positions and rates: derivatives of the inverse
// dynamics in closed form, O(n^2).
#pragma once

#include <span>

#include "control/reference.hpp"
#include "recursion/arm.hpp"

namespace osculate {

/// One arm whose joints have one axis each, at one state. Columns and torques base to tip, one for each
/// joint; tip vectors in the inertial frame, about the tip point, angular part first. No allocation after
/// construction.
class ArmSlopes {
 public:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  explicit ArmSlopes(const Chain<double>& chain);

  /// Sets everything below, at this configuration, these rates and accelerations. T = M qdd + h is the torque
  /// that gives them, with nothing at the tip.
  void look(const std::vector<JointPosition<double>>& joints, std::span<const double> qd,
            std::span<const double> qdd, const BaseMotion<double>& base);

  Vector3<double> tip_position;  // m
  Vector6 tip_velocity;          // rad/s, m/s
  MatrixX<double> M;             // kg m^2, kg: mass matrix, armature included
  MatrixX<double> T_q, T_qd;     // dT/dq and dT/dqd at fixed qdd
  Columns J;                     // tip velocity for unit rates, and change of the tip's pose with q
  Columns V_q;                   // of the tip's velocity with q
  Columns A_q, A_qd;             // of the tip's ordinary acceleration, at fixed qdd

  /// out += d(J* F)/dq for a wrench F on the tip, fixed in inertial axes, after look().
  void add_wrench_slopes(const Vector6& F, Eigen::Ref<MatrixX<double>> out) const;

 private:
  BasicArmBuilder<Hinge<double>> builder_;
  Arm<double> arm_;
  Columns V_, A_, w_, y_;         // of each link; w = V x s, y = A x s + V x w
  std::vector<Matrix6> inertia_;  // of each link
};

}  // namespace osculate
