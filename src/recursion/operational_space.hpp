// The four sweeps put together: Omega(0), c(0), g(0), F_c and T at one state, O(n).
#pragma once

#include <span>
#include <vector>

#include "recursion/task.hpp"

namespace osculate {

/// Operational-space dynamics of one arm at one state. Joint lists run base to tip. Base frame, about the tip
/// point. No allocation after construction. Cost: place + four sweeps + one factorisation of at most 6 x 6.
template <Field S>
class OperationalSpace {
 public:
  explicit OperationalSpace(const Chain<S>& chain) : builder_(chain), x_(chain.n()) {}

  int n() const { return builder_.n(); }

  /// Sets the configuration.
  void place(const std::vector<JointPosition<S>>& joints) { builder_.place(joints, arm_); }

  /// Sweeps 1 to 3 with gravity: afterwards right_side() = Omega (c + g) (65), corrected for gravity. T0:
  /// joint torques that will be applied anyway; the right side then is Omega (c + g) - J M^-1 T0.
  void sweep(std::span<const S> qd, std::span<const S> T0 = {}) {
    set_torques(T0);
    sweep_velocities(arm_, rates(qd), builder_.a_g(), x_);
    sweep_articulated(arm_, {}, x_);
    sweep_compliance(arm_, builder_.a_g(), x_);
  }

  /// Sweep 1 alone: tip velocity.
  void sweep_tip_velocity(std::span<const S> qd) { sweep_velocities(arm_, rates(qd), builder_.a_g(), x_); }

  /// Right side of Omega(0) c = ... (65), without gravity and joint torques. Runs sweeps 1 to 3 again.
  Vec<Motion, S> right_side_of_c(std::span<const S> qd) {
    set_torques({});
    sweep_velocities(arm_, rates(qd), {}, x_);
    sweep_articulated(arm_, {}, x_);
    sweep_compliance(arm_, {}, x_);
    return x_[0].eta;
  }

  /// Right side of Omega(0) g = ... (72). After sweep().
  Vec<Motion, S> right_side_of_g() {
    sweep_gravity(arm_, builder_.a_g(), x_);
    return x_[0].eta_g;
  }

  /// Sweep 4: T = J* F + T0, base to tip (39).
  void torques(const Vec<Force, S>& F, std::span<S> T) {
    sweep_torques(arm_, F, x_);
    for (int k = 1; k <= n(); ++k) T[static_cast<std::size_t>(n() - k)] = x_[k].T + x_[k].T0;
  }

  const Vec<Motion, S>& tip_velocity() const { return x_[0].V; }
  const Mat3<S>& tip_rotation() const { return arm_.R_tip; }
  const Vec3<S>& tip_position() const { return arm_.p_tip; }
  const Compliance<S>& Omega() const { return x_[0].Omega; }
  const Vec<Motion, S>& right_side() const { return x_[0].eta; }
  /// D(k) of the last sweep, paper numbering 1..n.
  const S& articulated_joint_inertia(int k) const { return x_[k].D.d; }

 private:
  TipFirst<S> rates(std::span<const S> qd) const { return {qd.data(), n()}; }
  void set_torques(std::span<const S> T0) {
    for (int k = 1; k <= n(); ++k) x_[k].T0 = T0.empty() ? S(0) : T0[static_cast<std::size_t>(n() - k)];
  }

  ArmBuilder<S> builder_;
  BasicArm<Hinge<S>> arm_;
  Passes<Hinge<S>> x_;
};

}  // namespace osculate
