// Resolved acceleration control: (16) without Omega(0), by solving (8) for the joint accelerations and
// running the Newton-Euler recursions on them. Luh, Walker & Paul (1980), the iterative form of (16) that
// section 2 names. Square tasks only: as many task rows as joint coordinates.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "recursion/task.hpp"

namespace osculate {

/// A x = b for the leading m x m block of A by elimination with row pivoting; nullopt where a pivot is below
/// `floor` times the largest entry of A. A: task rows of J, whose units may differ by row.
template <Ordered S>
std::optional<TaskVector<S>> solve_square(std::array<TaskVector<S>, 6> A, TaskVector<S> b, int m,
                                          const S& floor) {
  using std::abs;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  S largest = S(0);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      if (largest < abs(A[at(i)][at(j)])) largest = abs(A[at(i)][at(j)]);
  for (int j = 0; j < m; ++j) {
    int pivot = j;
    for (int i = j + 1; i < m; ++i)
      if (abs(A[at(pivot)][at(j)]) < abs(A[at(i)][at(j)])) pivot = i;
    if (!(floor * largest < abs(A[at(pivot)][at(j)]))) return std::nullopt;
    std::swap(A[at(pivot)], A[at(j)]);
    std::swap(b[at(pivot)], b[at(j)]);
    for (int i = j + 1; i < m; ++i) {
      const S factor = A[at(i)][at(j)] / A[at(j)][at(j)];
      for (int c = j; c < m; ++c) A[at(i)][at(c)] = A[at(i)][at(c)] - factor * A[at(j)][at(c)];
      b[at(i)] = b[at(i)] - factor * b[at(j)];
    }
  }
  for (int i = m - 1; i >= 0; --i) {
    for (int c = i + 1; c < m; ++c) b[at(i)] = b[at(i)] - A[at(i)][at(c)] * b[at(c)];
    b[at(i)] = b[at(i)] / A[at(i)][at(i)];
  }
  return b;
}

/// The sweeps of resolved acceleration control on one arm, in one frame. Joint lists base to tip; results in
/// the inertial frame, about the tip point. No allocation after construction. Four sweeps and one m x m
/// solve.
template <class H>
class ResolvedAcceleration {
 public:
  using S = typename H::Scalar;

  /// Prepares the constants of the chain: all memory is taken here.
  explicit ResolvedAcceleration(const Chain<S>& chain)
      : builder_(chain),
        order_(chain),
        coordinates_(chain.velocities()),
        arm_(builder_.arm()),
        x_(chain.n()),
        alpha_(static_cast<std::size_t>(chain.n()) + 1),
        ground_(builder_.ground()) {}

  /// Number of links.
  int n() const { return builder_.n(); }
  /// Sets the configuration; joints base to tip.
  void place(const std::vector<JointPosition<S>>& joints) { builder_.place(joints, arm_); }
  /// The base moves as prescribed; call before place. Without this call it is at rest.
  void move_base(const BaseMotion<S>& base) {
    arm_.base = builder_.placement(base);
    ground_ = builder_.ground(base);
  }

  /// Base -> tip: velocities and biases, and with them Jdot qd (46); what a moving base adds is in it.
  void sweep(std::span<const S> qd) {
    ++x_.sweeps;
    const JointList<H> thd{order_, qd};
    auto V = ground_.V;
    auto alpha = ground_.A - ground_.a_g;
    for (int k = n(); k >= 1; --k) {
      velocity_step(arm_[k], arm_[k].hinge, thd[k], V, x_[k]);
      alpha = arm_[k].phi.T() * alpha + x_[k].a;  // phi* a
    }
    velocity_at_tip(arm_[0], V, x_);
    x_.alpha0 = arm_[0].phi.T() * alpha + x_.a0;  // (46)
  }

  /// The joint torques under which the given rows of the tip's acceleration become u (m = number of joint
  /// coordinates). F_ext: known wrench on the tip. False, and T untouched, where the arm is singular: a pivot
  /// of J falls below `floor` times its largest entry.
  bool torques(const TaskVector<S>& u, const TaskRows& rows, const Vec<Force, S>& F_ext, const S& floor,
               std::span<S> T) {
    const int m = coordinates_;
    std::array<TaskVector<S>, 6> J{};
    gather_jacobian(rows, J);
    TaskVector<S> right = u;
    const TaskVector<S> bias = restricted(seeded(Fault::resolved_bias, x_.alpha0), rows);
    for (std::size_t i = 0; i < rows.size(); ++i) right[i] = right[i] - bias[i];
    const auto qdd = solve_square(J, right, m, floor);  // (8)
    if (!qdd) return false;
    const JointList<H> thdd{order_, std::span<const S>(qdd->data(), static_cast<std::size_t>(m))};
    sweep_given_accelerations(thdd);
    sweep_forces(F_ext, thdd, T);
    return true;
  }

  /// After sweep(): rad/s, m/s.
  const Vec<Motion, S>& tip_velocity() const { return x_.V0; }
  /// After place(): tip axes, as columns.
  const Mat3<S>& tip_rotation() const { return arm_.tip.R; }
  /// After place(): tip point, m.
  const Vec3<S>& tip_position() const { return arm_.tip.p; }
  /// Sweeps along the arm so far.
  long sweeps() const { return x_.sweeps; }

 private:
  /// Tip -> base: the rows of J = B* phi* H*, (38).
  void gather_jacobian(const TaskRows& rows, std::array<TaskVector<S>, 6>& J) {
    ++x_.sweeps;
    Shift<S> phi;  // phi(k,0)
    for (int k = 1; k <= n(); ++k) {
      phi.l = phi.l + arm_[k - 1].phi.l;
      const auto [first, count] = order_[k];
      for (int j = 0; j < count; ++j) {
        const Vec<Motion, S> column = phi.T() * unit_motion(arm_[k].hinge, j);
        for (std::size_t i = 0; i < rows.size(); ++i)
          J[i][static_cast<std::size_t>(first + j)] = component(column, rows[i]);
      }
    }
  }
  static Vec<Motion, S> unit_motion(const H& hinge, int j) {
    if constexpr (has_one_axis<H>)
      return hinge.T() * S(1);
    else
      return hinge.axes[j];
  }

  /// Base -> tip: alpha(k) of links that move with qdd on a base that accelerates with A.
  void sweep_given_accelerations(const JointList<H>& thdd) {
    ++x_.sweeps;
    auto alpha = ground_.A;
    for (int k = n(); k >= 1; --k) {
      alpha = arm_[k].phi.T() * alpha + arm_[k].hinge.T() * thdd[k] + x_[k].a;
      alpha_[static_cast<std::size_t>(k)] = alpha;
    }
  }

  /// Tip -> base: interaction forces of (42)-(45), and T = M qdd + C + G.
  void sweep_forces(const Vec<Force, S>& F_ext, const JointList<H>& thdd, std::span<S> T) {
    ++x_.sweeps;
    auto f = -F_ext;
    for (int k = 1; k <= n(); ++k) {
      const auto& [phi, Hk, M, J] = arm_[k];
      const auto& alpha = alpha_[static_cast<std::size_t>(k)];
      f = arm_[k - 1].phi * f + seeded(Fault::resolved_force, M * alpha + x_[k].b);
      set_joint_entry<H>(order_, T, k, Hk * f + seeded(Fault::resolved_armature, J * thdd[k]));
    }
  }

  BasicArmBuilder<H> builder_;
  JointOrder order_;
  int coordinates_;
  BasicArm<H> arm_;
  Passes<H> x_;
  std::vector<Vec<Motion, S>> alpha_;  // of each link
  Ground<S> ground_;
};

}  // namespace osculate
