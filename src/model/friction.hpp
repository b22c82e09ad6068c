// Joint friction: viscous plus smooth Coulomb. Stiction is out of scope.
#pragma once

#include <cmath>

namespace osculate {

/// tau = viscous qd + Tc tanh(qd / v_s), Tc = coulomb_positive for qd > 0, coulomb_negative for qd < 0, both
/// >= 0. Units N m (revolute) or N (prismatic). The result opposes motion when subtracted from the joint
/// torque.
struct JointFriction {
  double viscous = 0;           // N m s/rad or N s/m
  double coulomb_positive = 0;  // N m or N
  double coulomb_negative = 0;  // N m or N
  double v_s = 1e-2;            // rad/s or m/s, speed that sets the width of the smoothed step
  bool operator==(const JointFriction&) const = default;
};

inline double friction_torque(const JointFriction& f, double qd) {
  return f.viscous * qd + (qd > 0 ? f.coulomb_positive : f.coulomb_negative) * std::tanh(qd / f.v_s);
}

}  // namespace osculate
