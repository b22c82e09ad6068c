// The four sweeps put together: Omega(0), c(0), g(0), F_c and T at one state, O(n); and the forms with fewer
// sweeps that use values of the sample before (end of sections 4.2 and 5).
#pragma once

#include <span>
#include <vector>

#include "recursion/task.hpp"

namespace osculate {

/// What a sampled controller takes from the sample before, to save sweeps.
enum class Delay {
  none,      // four sweeps
  velocity,  // a, b, a(0): three sweeps
  force,     // F_c: three sweeps
  both,      // two sweeps
};

/// Operational-space dynamics of one arm at one state. Joint lists run base to tip, one entry for each
/// velocity coordinate. Results in the inertial frame (that of a base at rest), about the tip point, also
/// where H works in link frames. No allocation after construction. Cost: place + four sweeps + one
/// factorisation of at most 6 x 6.
template <class H>
class BasicOperationalSpace {
 public:
  using S = typename H::Scalar;

  /// Prepares the constants of the chain: all memory is taken here.
  explicit BasicOperationalSpace(const Chain<S>& chain)
      : builder_(chain), order_(chain), arm_(builder_.arm()), x_(chain.n()), ground_(builder_.ground()) {
    if constexpr (in_link_frames<H>) last_.resize(static_cast<std::size_t>(chain.n()) + 1);
  }

  /// Number of links.
  int n() const { return builder_.n(); }

  /// Sets the configuration.
  void place(const std::vector<JointPosition<S>>& joints) { builder_.place(joints, arm_); }
  /// The same from coordinates, base to tip, where every joint has one axis; in one frame.
  void place(std::span<const S> q) { builder_.place(q, arm_); }
  /// The base moves as prescribed; call before place. Without this call it is at rest in the inertial frame.
  void move_base(const BaseMotion<S>& base) {
    arm_.base = builder_.placement(base);
    ground_ = builder_.ground(base);
  }

  /// Sweeps 1 to 3 with gravity: afterwards right_side() = Omega (c + g) (65), corrected for gravity. T0:
  /// joint torques that will be applied anyway; F_ext: known wrench on the tip, inertial frame, about the tip
  /// point. The right side then is Omega (c + g - F_ext) - J M^-1 T0.
  void sweep(std::span<const S> qd, std::span<const S> T0 = {}, const Vec<Force, S>& F_ext = {}) {
    set_torques(T0);
    inlined<S>([&] { sweep_velocities(arm_, rates(qd), ground_, x_); });
    inlined<S>([&] { sweep_articulated(arm_, x_, ground_, seen(F_ext), x_); });
    inlined<S>([&] { sweep_compliance(arm_, ground_, seen(ground_.a_g), x_); });
  }

  /// sweep(qd) and right_side_of_g() with less to load: returns the right side of Omega(0) g = ... (72). In
  /// one frame only.
  Vec<Motion, S> sweep_with_gravity(std::span<const S> qd) {
    set_torques({});
    inlined<S>([&] { sweep_velocities(arm_, rates(qd), ground_, x_); });
    inlined<S>([&] { sweep_articulated(arm_, x_, ground_, {}, x_); });
    inlined<S>([&] { sweep_compliance_and_gravity(arm_, ground_, x_); });
    return x_.eta_g0;
  }

  /// The same results to rounding, by a sweep of columns instead of sweep 3: fewer instructions for one state
  /// of doubles, more operations. In one frame only.
  void sweep_from_tip(std::span<const S> qd, std::span<const S> T0 = {}, const Vec<Force, S>& F_ext = {}) {
    set_torques(T0);
    inlined<S>([&] { sweep_velocities(arm_, rates(qd), ground_, x_); });
    inlined<S>([&] { sweep_articulated(arm_, x_, ground_, F_ext, x_); });
    inlined<S>([&] { sweep_columns(arm_, ground_, ground_.a_g, x_); });
  }

  /// Sweep 1 alone: tip velocity.
  void sweep_tip_velocity(std::span<const S> qd) {
    inlined<S>([&] { sweep_velocities(arm_, rates(qd), ground_, x_); });
  }

  /// Right side of Omega(0) c = ... (65), without gravity and joint torques; what a moving base adds is in
  /// it. Runs sweeps 1 and 2 again, and of sweep 3 what Omega(0) does not need: that stays as it is.
  Vec<Motion, S> right_side_of_c(std::span<const S> qd) {
    set_torques({});
    Ground<S> weightless = ground_;
    weightless.A = ground_.A - base_axes(ground_.a_g);
    weightless.a_g = {};
    inlined<S>([&] { sweep_velocities(arm_, rates(qd), weightless, x_); });
    inlined<S>([&] { sweep_articulated(arm_, x_, weightless, {}, x_); });
    inlined<S>([&] { sweep_right_side(arm_, weightless, {}, x_); });
    return right_side();
  }

  /// Right side of Omega(0) g = ... (72). After sweep().
  Vec<Motion, S> right_side_of_g() {
    inlined<S>([&] { sweep_gravity(arm_, base_axes(ground_.a_g), x_); });
    return inertial(x_.eta_g0);
  }

  /// Sweep 4: T = J* F + T0, base to tip (39).
  void torques(const Vec<Force, S>& F, std::span<S> T) {
    inlined<S>([&] {
      sweep_torques(arm_, seen(F), x_, [&](int k, const auto& T_of_F) { give_torque(k, T_of_F, T); });
    });
  }

  /// One sample of a controller with delay, in link frames; `finish_sample` must follow. Afterwards Omega,
  /// right_side and the tip are those of this sample, as far as the delay lets them. The first sample is
  /// exact and fills the memory. F_ext enters at the tip, as - Omega(0) F_ext: before sweep 2, where z(0) =
  /// -F_ext stands otherwise, the tip's axes of this sample may not be known.
  void begin_sample(Delay delay, bool extrapolate, std::span<const S> qd, std::span<const S> T0,
                    const Vec<Force, S>& F_ext = {}) {
    static_assert(in_link_frames<H>, "delayed values are kept in link axes");
    set_torques(T0);
    const bool old_velocities = filled_ && (delay == Delay::velocity || delay == Delay::both);
    old_force_ = filled_ && (delay == Delay::force || delay == Delay::both);
    if (!old_velocities) sweep_velocities(arm_, rates(qd), ground_, x_);
    if (old_force_)
      sweep_articulated_and_torques(arm_, ground_, {}, F_, x_);
    else
      inlined<S>([&] { sweep_articulated(arm_, x_, ground_, {}, x_); });
    if (old_velocities)
      sweep_compliance_and_velocities(arm_, rates(qd), ground_, x_);
    else
      inlined<S>([&] { sweep_compliance(arm_, ground_, seen(ground_.a_g), x_); });
    x_.eta0 = x_.eta0 - seeded(Fault::sampled_wrench, x_.Omega0 * seen(F_ext));
    if (delay == Delay::velocity || delay == Delay::both) keep_velocities(extrapolate);
  }

  /// Ends a sample: T = J* F + T0 with F of this sample, or of the one before where the delay says so.
  void finish_sample(bool extrapolate, const Vec<Force, S>& F, std::span<S> T) {
    const Vec<Force, S> F_now = seen(F);
    if (!old_force_) sweep_torques(arm_, F_now, x_);
    for (int k = 1; k <= n(); ++k) give_torque(k, x_[k].T, T);
    F_ = extrapolate && filled_ ? extrapolated(Fault::extrapolated_force, F_now, last_F_) : F_now;
    if (faulty(Fault::force_too_old)) F_ = filled_ ? last_F_ : F_now;
    last_F_ = F_now;
    filled_ = true;
  }

  /// After sweep 1: rad/s, m/s.
  Vec<Motion, S> tip_velocity() const { return inertial(x_.V0); }
  /// Tip axes, as columns. After place(); in link frames after a sweep.
  const Mat3<S>& tip_rotation() const { return tip().R; }
  /// Tip point, m. After place(); in link frames after a sweep.
  const Vec3<S>& tip_position() const { return tip().p; }
  /// Omega(0) = J M^-1 J* (60), after sweep 3: 1/(kg m^2), 1/(kg m), 1/kg.
  decltype(auto) Omega() const {
    if constexpr (in_link_frames<H>)
      return turned(x_.tip.R, x_.Omega0);
    else
      return (x_.Omega0);
  }
  /// Omega(0) (c + g) and what the known torques and wrench add to it, after sweep 3: rad/s^2, m/s^2.
  Vec<Motion, S> right_side() const { return inertial(x_.eta0); }
  /// D(k) of the last sweep, paper numbering 1..n.
  const typename H::JointInertia& articulated_joint_inertia(int k) const { return x_[k].G.D; }
  /// The placed arm.
  const BasicArm<H>& arm() const { return arm_; }
  /// What the sweeps left at its links.
  const Passes<H>& passes() const { return x_; }
  /// Sweeps along the arm so far, forward kinematics of `place` not counted.
  long sweeps() const { return x_.sweeps; }

 private:
  JointList<H> rates(std::span<const S> qd) const { return {order_, qd}; }
  void set_torques(std::span<const S> T0) {
    if (T0.empty() && !has_T0_) return;  // they are zero
    has_T0_ = !T0.empty();
    give_joint_entries<H>(order_, T0, [&](int k, const auto& entry) { x_[k].T0 = entry; });
  }
  void give_torque(int k, const typename H::Coordinate& T_of_F, std::span<S> T) const {
    set_joint_entry<H>(order_, T, k, T_of_F + seeded(Fault::null_space_torque, x_[k].T0));
  }
  const Placement<S>& tip() const { return in_link_frames<H> ? x_.tip : arm_.tip; }
  /// Between the inertial frame and the axes in which the sweeps hold the tip's vectors.
  template <class Space>
  Vec<Space, S> inertial(const Vec<Space, S>& v) const {
    if constexpr (in_link_frames<H>)
      return turned(x_.tip, v);
    else
      return v;
  }
  template <class Space>
  Vec<Space, S> seen(const Vec<Space, S>& v) const {
    if constexpr (in_link_frames<H>)
      return seen_from(x_.tip, v);
    else
      return v;
  }
  Vec<Motion, S> base_axes(const Vec<Motion, S>& v) const {
    if constexpr (in_link_frames<H>)
      return seen_from(arm_.base, v);
    else
      return v;
  }

  /// 2 x(-1) - x(-2)
  template <class Space>
  static Vec<Space, S> extrapolated(Fault fault, const Vec<Space, S>& now, const Vec<Space, S>& last) {
    return now + seeded(fault, now - last);
  }
  /// The biases of this state become those that the next sample uses.
  void keep_velocities(bool extrapolate) {
    Vec<Force, S> none;  // the tip has no b
    for (int k = 0; k <= n(); ++k) {
      auto& [last_a, last_b] = last_[static_cast<std::size_t>(k)];
      Vec<Motion, S>& a = k == 0 ? x_.a0 : x_[k].a;
      Vec<Force, S>& b = k == 0 ? none : x_[k].b;
      const Bias now{a, b};
      if (extrapolate && filled_) {
        a = extrapolated(Fault::extrapolated_velocity, now.a, last_a);
        b = extrapolated(Fault::extrapolated_velocity, now.b, last_b);
      }
      if (faulty(Fault::velocity_too_old) && filled_) a = last_a, b = last_b;
      last_a = now.a, last_b = now.b;
    }
  }

  struct Bias {
    Vec<Motion, S> a;
    Vec<Force, S> b;
  };

  BasicArmBuilder<H> builder_;
  JointOrder order_;
  BasicArm<H> arm_;
  Passes<H> x_;
  Ground<S> ground_;
  bool has_T0_ = true;  // until T0 is set for the first time
  // memory of a sampled controller, link axes
  bool filled_ = false, old_force_ = false;
  std::vector<Bias> last_;
  Vec<Force, S> F_, last_F_;
};
template <Field S>
using OperationalSpace = BasicOperationalSpace<Hinge<S>>;

}  // namespace osculate
