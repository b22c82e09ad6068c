// Joint accelerations of an arm in O(n) by the operator inverse of the mass matrix (51).
#pragma once

#include <span>
#include <vector>

#include "recursion/sweeps.hpp"

namespace osculate {

/// The true arm. Joint lists run base to tip; base frame, about the tip point. No allocation after
/// construction.
template <Field S>
class ForwardDynamics {
 public:
  explicit ForwardDynamics(const Chain<S>& chain) : builder_(chain), x_(chain.n()) {}

  int n() const { return builder_.n(); }

  void place(const std::vector<JointPosition<S>>& joints) { builder_.place(joints, arm_); }

  /// qdd for joint torques T (friction already subtracted) and the wrench F_ext on the tip.
  void accelerations(std::span<const S> qd, std::span<const S> T, const Vec<Force, S>& F_ext,
                     std::span<S> qdd) {
    for (int k = 1; k <= n(); ++k) x_[k].T0 = T[static_cast<std::size_t>(n() - k)];
    sweep_velocities(arm_, TipFirst<S>{qd.data(), n()}, builder_.a_g(), x_);
    sweep_articulated(arm_, F_ext, x_);
    sweep_accelerations(arm_, builder_.a_g(), x_);
    for (int k = 1; k <= n(); ++k) qdd[static_cast<std::size_t>(n() - k)] = x_[k].thdd;
  }

  const Vec<Motion, S>& tip_velocity() const { return x_[0].V; }
  const Vec<Motion, S>& tip_acceleration() const { return x_[0].alpha; }
  const Mat3<S>& tip_rotation() const { return arm_.R_tip; }
  const Vec3<S>& tip_position() const { return arm_.p_tip; }

  /// Kinetic energy of links and rotors after accelerations(), J.
  S kinetic_energy(std::span<const S> qd) const {
    S twice = S(0);
    for (int k = 1; k <= n(); ++k) {
      const S& rate = qd[static_cast<std::size_t>(n() - k)];
      twice = twice + dot(arm_[k].M * x_[k].V, x_[k].V) + arm_[k].J.d * rate * rate;
    }
    return twice / S(2);
  }

  /// Potential energy, zero when every centre of mass is at the base origin, J.
  S potential_energy() const {
    S U = S(0);
    Vec3<S> O;  // O(k)
    for (int k = n(); k >= 1; --k) {
      O = O + arm_[k].phi.l;
      U = U + dot(builder_.a_g().lin, arm_[k].M.mp + O * arm_[k].M.m);
    }
    return U;
  }

 private:
  ArmBuilder<S> builder_;
  BasicArm<Hinge<S>> arm_;
  Passes<Hinge<S>> x_;
};

}  // namespace osculate
