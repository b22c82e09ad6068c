// Joint accelerations of an arm in O(n) by the operator inverse of the mass matrix (51).
#pragma once

#include <span>
#include <vector>

#include "recursion/operational_space.hpp"

namespace osculate {

/// The true arm. Joint lists run base to tip, one entry for each velocity coordinate; inertial frame (that of
/// a base at rest), about the tip point. No allocation after construction.
template <class H>
class BasicForwardDynamics {
 public:
  using S = typename H::Scalar;

  /// Prepares the constants of the chain: all memory is taken here.
  explicit BasicForwardDynamics(const Chain<S>& chain)
      : builder_(chain), order_(chain), arm_(builder_.arm()), x_(chain.n()), ground_(builder_.ground()) {}

  /// Number of links.
  int n() const { return builder_.n(); }

  /// Sets the configuration; joints base to tip.
  void place(const std::vector<JointPosition<S>>& joints) {
    leader_ = {};
    builder_.place(joints, arm_);
  }
  /// The same from coordinates, base to tip, where every joint has one axis.
  void place(std::span<const S> q) {
    leader_ = {};
    builder_.place(q, arm_);
  }
  /// The base moves as prescribed; call before place. Without this call it is at rest in the inertial frame.
  void move_base(const BaseMotion<S>& base) {
    arm_.base = builder_.placement(base);
    ground_ = builder_.ground(base);
  }

  /// Instead of place() and move(): takes the placed links (phi, H, M, J) and sweep 1 (V, a, b) of `space`,
  /// an arm of the same chain on a base at rest, until the next place(). Nothing of its sweeps 2 to 4 is
  /// taken. `space` must stay where it is, and as it is, while this object is asked.
  void follow(const BasicOperationalSpace<H>& space) { leader_.space = &space; }

  /// Sweep 1: afterwards the tip's velocity is known.
  void move(std::span<const S> qd) {
    inlined<S>([&] { sweep_velocities(arm_, JointList<H>{order_, qd}, ground_, x_); });
  }

  /// qdd for joint torques T (friction already subtracted) and the wrench F_ext on the tip. After move().
  void accelerations(std::span<const S> T, const Vec<Force, S>& F_ext, std::span<S> qdd) {
    give_joint_entries<H>(order_, T, [&](int k, const auto& entry) { x_[k].T0 = entry; });
    inlined<S>([&] { sweeps_after_velocities(F_ext, qdd); });
  }
  /// Both. qd, T and qdd have one entry for each coordinate.
  void accelerations(std::span<const S> qd, std::span<const S> T, const Vec<Force, S>& F_ext,
                     std::span<S> qdd) {
    const JointList<H> rates{order_, qd}, torques{order_, T};
    inlined<S>([&] {
      sweep_velocities(arm_, rates, ground_, x_, [&](int k, const auto&) { x_[k].T0 = torques[k]; });
      sweeps_after_velocities(F_ext, qdd);
    });
  }

  /// After move(): rad/s, m/s.
  const Vec<Motion, S>& tip_velocity() const { return moved().V0; }
  /// After accelerations(): ordinary acceleration of the tip, zero while it rests; rad/s^2, m/s^2.
  const Vec<Motion, S>& tip_acceleration() const { return x_.alpha0; }
  /// After place(): tip axes, as columns.
  const Mat3<S>& tip_rotation() const { return arm().tip.R; }
  /// After place(): tip point, m.
  const Vec3<S>& tip_position() const { return arm().tip.p; }

  /// Kinetic energy of links and rotors after place(), J. A moving base has the links move with it.
  S kinetic_energy(std::span<const S> qd) const {
    S twice = S(0);
    auto V = ground_.V;
    for (int k = n(); k >= 1; --k) {
      const auto rate = joint_entry<H>(order_, qd, k);
      V = arm()[k].phi.T() * V + arm()[k].hinge.T() * rate;
      twice = twice + dot(arm()[k].M * V, V) + seeded(Fault::rotor_energy, product(rate, arm()[k].J * rate));
    }
    return twice / S(2);
  }

  /// Potential energy, zero when every centre of mass is at the origin of the inertial frame, J.
  S potential_energy() const {
    S U = S(0);
    Vec3<S> O = arm().base.p;  // O(k)
    for (int k = n(); k >= 1; --k) {
      O = O + arm()[k].phi.l;
      U = U + dot(ground_.a_g.lin, arm()[k].M.mp + seeded(Fault::weight, O * arm()[k].M.m));
    }
    return U;
  }

 private:
  /// Sweep 2 and accelerations, after sweep 1, with T0 there.
  void sweeps_after_velocities(const Vec<Force, S>& F_ext, std::span<S> qdd) {
    sweep_articulated(arm(), moved(), {}, F_ext, x_);
    sweep_accelerations(arm(), moved(), ground_, x_,
                        [&](int k, const auto& thdd) { set_joint_entry<H>(order_, qdd, k, thdd); });
  }

  /// Whom follow() named; a copy of this object follows nobody.
  struct Leader {
    const BasicOperationalSpace<H>* space = nullptr;
    Leader() = default;
    Leader(const Leader&) {}
    Leader& operator=(const Leader&) {
      space = nullptr;
      return *this;
    }
  };
  const BasicArm<H>& arm() const { return leader_.space ? leader_.space->arm() : arm_; }
  const Passes<H>& moved() const { return leader_.space ? leader_.space->passes() : x_; }

  static S product(const S& a, const S& b) { return a * b; }
  static S product(const JointVector<S>& a, const JointVector<S>& b) {
    S sum = S(0);
    for (int i = 0; i < a.m; ++i) sum = sum + a[i] * b[i];
    return sum;
  }

  BasicArmBuilder<H> builder_;
  JointOrder order_;
  BasicArm<H> arm_;
  Passes<H> x_;
  Ground<S> ground_;
  Leader leader_;
};
template <Field S>
using ForwardDynamics = BasicForwardDynamics<Hinge<S>>;

}  // namespace osculate
