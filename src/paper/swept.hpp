// What the recursions leave behind at one state, written out as the columns and block matrices of the paper,
// beside the operators of the reference. Links and joints tip first, inertial frame, angular rows first.
#pragma once

#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/resolved_acceleration.hpp"
#include "reference/identities.hpp"

namespace osculate::paper {

/// One state of one arm, and what is asked of it. Joint lists base to tip; six-vectors angular first.
template <Field S>
struct Question {
  Chain<S> chain;
  std::vector<JointPosition<S>> positions;
  VectorX<S> qd;
  TaskRows rows;              // independent at this state
  VectorX<S> u;               // on the rows: commanded tip acceleration
  VectorX<S> T0, T;           // joint torques: of the null space; on the plant
  dense::Vector6<S> F, push;  // tip forces: for (39); external, on the plant and known to the law
  BaseMotion<S> base;         // for the statements about a moving base; at rest in all others
};

/// A torque that each form of the law gives for the same question; joints tip first.
template <Field S>
struct Torques {
  MatrixX<S> four_sweeps, null_space, known_force, moving_base, link_frames, any_joint;
  MatrixX<S> old_velocity, old_force, two_sweeps;  // delayed forms at a frozen state, third sample
  MatrixX<S> resolved;                             // empty unless the task is square
};

template <Field S>
struct Swept {
  MatrixX<S> V, a, b, z, xi, eta, eta_g;  // 6n x 1; z, xi, eta with a'(n) = a(n) + phi*(n+1,n) a_g
  MatrixX<S> P, E_psi, Omega;             // 6n x 6n
  MatrixX<S> G, K;                        // 6n x m
  MatrixX<S> D;                           // m x m
  MatrixX<S> W;                           // 6 x 6n
  MatrixX<S> V_tip, a_tip, Omega_tip;     // 6 x 1, 6 x 1, 6 x 6
  MatrixX<S> of_c, of_g, of_c_plus_g;     // 6 x 1: Omega(0) c, Omega(0) g, Omega(0) (c + g)
  MatrixX<S> printed_4_3;                 // the last as section 4.3 prints it
  MatrixX<S> T_of_F;                      // m x 1
  MatrixX<S> thdd, tip_acceleration;      // of the plant
  MatrixX<S> kinetic, potential;          // 1 x 1, J
  Torques<S> torque;
  std::array<long, 5> sweeps{};  // exact, old velocities, old force, both, resolved (0: not run)
};

namespace internal {

template <class Space, Field S>
MatrixX<S> column(const Vec<Space, S>& v) {
  MatrixX<S> out(6, 1);
  for (int i = 0; i < 6; ++i) out(i, 0) = component(v, i);
  return out;
}
template <class To, Field S>
MatrixX<S> matrix(const Symmetric<To, S>& a) {
  MatrixX<S> out(6, 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) out(i, j) = component(a, i, j);
  return out;
}
template <Field S>
Vec<Force, S> force(const dense::Vector6<S>& v) {
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}
template <Field S>
MatrixX<S> block(const HingeInertia<S>& D) {
  return MatrixX<S>::Constant(1, 1, D.d);
}
template <Field S>
MatrixX<S> block(const JointInertia<S>& D) {
  MatrixX<S> out(D.m, D.m);
  for (int i = 0; i < D.m; ++i)
    for (int j = 0; j < D.m; ++j) out(i, j) = D(i, j);
  return out;
}
template <Field S>
MatrixX<S> block(const HingeGain<S>& G) {
  return column(G.column);
}
template <Field S>
MatrixX<S> block(const JointGain<S>& G) {
  MatrixX<S> out(6, G.columns.m);
  for (int j = 0; j < G.columns.m; ++j) out.col(j) = column(G.columns[j]);
  return out;
}
/// psi as a matrix: its action on unit forces.
template <class H>
MatrixX<typename H::Scalar> block(const Psi<H>& psi) {
  using S = typename H::Scalar;
  MatrixX<S> out(6, 6);
  for (int j = 0; j < 6; ++j) {
    Vec<Force, S> unit;
    set_component(unit, j, S(1));
    out.col(j) = column(psi * unit);
  }
  return out;
}

/// A base-to-tip list in the order of the operators: joints tip first, the rows of one joint as they are.
template <Field S>
MatrixX<S> tip_first(const JointOrder& order, const std::vector<S>& list) {
  MatrixX<S> out(static_cast<Eigen::Index>(list.size()), 1);
  Eigen::Index to = 0;
  for (std::size_t k = 1; k < order.joint.size(); ++k)
    for (int i = 0; i < order.joint[k].m; ++i)
      out(to++, 0) = list[static_cast<std::size_t>(order.joint[k].first + i)];
  return out;
}

template <Field S>
std::span<const S> span_of(const VectorX<S>& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// F on the task rows for the right side that `space` has found, as a wrench. (4)
template <class Space, Field S>
Vec<Force, S> tip_force(const Space& space, const Question<S>& ask) {
  TaskVector<S> right = restricted(space.right_side(), ask.rows);
  for (std::size_t i = 0; i < ask.rows.size(); ++i) right[i] = right[i] + ask.u[static_cast<Eigen::Index>(i)];
  return wrench(TaskFactor<S>(space.Omega(), ask.rows).solve(right), ask.rows);
}

/// The law in four sweeps, joints tip first.
template <class H, Field S = typename H::Scalar>
MatrixX<S> law(const Question<S>& ask, const VectorX<S>& T0, const Vec<Force, S>& F_ext, bool moving,
               long* sweeps = nullptr) {
  BasicOperationalSpace<H> space(ask.chain);
  if (moving) space.move_base(ask.base);
  space.place(ask.positions);
  space.sweep(span_of(ask.qd), span_of(T0), F_ext);
  std::vector<S> T(static_cast<std::size_t>(ask.qd.size()));
  space.torques(tip_force(space, ask), T);
  if (sweeps) *sweeps = space.sweeps();
  return tip_first(JointOrder(ask.chain), T);
}

/// The delayed law after three samples at one and the same state; sweeps: of the last of them.
template <class H, Field S = typename H::Scalar>
MatrixX<S> frozen(const Question<S>& ask, Delay delay, bool extrapolate, long& sweeps) {
  BasicOperationalSpace<H> space(ask.chain);
  std::vector<S> T(static_cast<std::size_t>(ask.qd.size()));
  for (int sample = 1; sample <= 3; ++sample) {
    const long before = space.sweeps();
    space.place(ask.positions);
    space.begin_sample(delay, extrapolate, span_of(ask.qd), span_of(ask.T0));
    space.finish_sample(extrapolate, tip_force(space, ask), T);
    sweeps = space.sweeps() - before;
  }
  return tip_first(JointOrder(ask.chain), T);
}

template <class H, Field S = typename H::Scalar>
void fill_links(const Question<S>& ask, Swept<S>& out) {
  const int n = ask.chain.n(), m = ask.chain.velocities();
  const BasicArmBuilder<H> builder(ask.chain);
  const JointOrder order(ask.chain);
  const Ground<S> ground = builder.ground();
  BasicArm<H> arm = builder.arm();
  builder.place(ask.positions, arm);
  Passes<H> x(n);
  for (int k = 1; k <= n; ++k) x[k].T0 = joint_entry<H>(order, {}, k);
  for (auto* v : {&out.V, &out.a, &out.b, &out.z, &out.xi, &out.eta, &out.eta_g}) v->setZero(6 * n, 1);
  for (auto* A : {&out.P, &out.E_psi, &out.Omega}) A->setZero(6 * n, 6 * n);
  out.G.setZero(6 * n, m), out.K.setZero(6 * n, m), out.D.setZero(m, m), out.W.setZero(6, 6 * n);
  const auto set = [](MatrixX<S>& to, int k, const auto& v) { to.block(6 * (k - 1), 0, 6, 1) = column(v); };
  const auto set_block = [](MatrixX<S>& to, int k, const auto& A) {
    to.block(6 * (k - 1), 6 * (k - 1), 6, 6) = matrix(A);
  };

  sweep_velocities(arm, JointList<H>{order, span_of(ask.qd)}, ground, x,
                   [&](int k, const auto& V) { set(out.V, k, V); });
  sweep_articulated(arm, x, ground, {}, x, [&](int k, const auto& P, const auto& z) {
    set_block(out.P, k, P);
    set(out.z, k, z);
  });
  sweep_compliance(arm, ground, {}, x);
  out.printed_4_3 = column(x.eta0);
  sweep_compliance(arm, ground, ground.a_g, x,
                   [&](int k, const auto& Omega, const auto& eta, const auto& xi) {
                     set_block(out.Omega, k, Omega);
                     set(out.eta, k, eta);
                     set(out.xi, k, xi);
                   });
  sweep_gravity(arm, ground.a_g, x, [&](int k, const auto& eta) { set(out.eta_g, k, eta); });
  sweep_torques(arm, force(ask.F), x);

  std::vector<S> T(static_cast<std::size_t>(m));
  Eigen::Index first = 0;
  for (int k = 1; k <= n; ++k) {
    const Eigen::Index at = 6 * (k - 1), count = order[k].m;
    set(out.a, k, x[k].a);
    set(out.b, k, x[k].b);
    out.G.block(at, first, 6, count) = block(x[k].G);
    out.D.block(first, first, count, count) = block(x[k].G.D);
    if (k < n) {
      out.K.block(at + 6, first, 6, count) = block(arm[k].phi * x[k].G);
      out.E_psi.block(at + 6, at, 6, 6) = block(psi_of(arm, arm[k].hinge, x, k));
    } else {
      out.W.block(0, at, 6, 6) = block(psi_of(arm, arm[k].hinge, x, k));
    }
    set_joint_entry<H>(order, std::span<S>(T), k, x[k].T);
    first += count;
  }
  out.T_of_F = tip_first(order, T);
  out.V_tip = column(x.V0);
  out.a_tip = column(x.a0);
  out.Omega_tip = matrix(x.Omega0);
  out.of_c_plus_g = column(x.eta0);
  out.of_g = column(x.eta_g0);
  BasicOperationalSpace<H> space(ask.chain);
  space.place(ask.positions);
  out.of_c = column(space.right_side_of_c(span_of(ask.qd)));
}

template <class H, Field S = typename H::Scalar>
void fill_plant(const Question<S>& ask, Swept<S>& out) {
  BasicForwardDynamics<H> plant(ask.chain);
  plant.place(ask.positions);
  std::vector<S> qdd(static_cast<std::size_t>(ask.qd.size()));
  plant.accelerations(span_of(ask.qd), span_of(ask.T), force(ask.push), qdd);
  out.thdd = tip_first(JointOrder(ask.chain), qdd);
  out.tip_acceleration = column(plant.tip_acceleration());
  out.kinetic = MatrixX<S>::Constant(1, 1, plant.kinetic_energy(span_of(ask.qd)));
  out.potential = MatrixX<S>::Constant(1, 1, plant.potential_energy());
}

template <class H, class InLinkFrames, Field S = typename H::Scalar>
void fill_torques(const Question<S>& ask, Swept<S>& out) {
  const VectorX<S> none = VectorX<S>::Zero(ask.qd.size());
  Torques<S>& torque = out.torque;
  torque.four_sweeps = law<H>(ask, none, {}, false, &out.sweeps[0]);
  torque.null_space = law<H>(ask, ask.T0, {}, false);
  torque.known_force = law<H>(ask, none, force(ask.push), false);
  torque.moving_base = law<H>(ask, none, {}, true);
  torque.link_frames = law<InLinkFrames>(ask, ask.T0, {}, false);
  torque.old_velocity = frozen<InLinkFrames>(ask, Delay::velocity, false, out.sweeps[1]);
  torque.old_force = frozen<InLinkFrames>(ask, Delay::force, true, out.sweeps[2]);
  torque.two_sweeps = frozen<InLinkFrames>(ask, Delay::both, true, out.sweeps[3]);
  if (static_cast<Eigen::Index>(ask.rows.size()) != ask.qd.size()) return;
  ResolvedAcceleration<H> resolved(ask.chain);
  resolved.place(ask.positions);
  resolved.sweep(span_of(ask.qd));
  TaskVector<S> u{};
  for (std::size_t i = 0; i < ask.rows.size(); ++i) u[i] = ask.u[static_cast<Eigen::Index>(i)];
  std::vector<S> T(static_cast<std::size_t>(ask.qd.size()));
  if (!resolved.torques(u, ask.rows, {}, S(0), T)) return;
  out.sweeps[4] = resolved.sweeps();
  torque.resolved = tip_first(JointOrder(ask.chain), T);
}

}  // namespace internal

/// Runs every recursion. One-axis chains use the types that a run uses for them; the others Joint.
template <Field S>
Swept<S> swept(const Question<S>& ask) {
  Swept<S> out;
  if (ask.chain.one_axis_joints()) {
    internal::fill_links<Hinge<S>>(ask, out);
    internal::fill_plant<Hinge<S>>(ask, out);
    internal::fill_torques<Hinge<S>, LinkHinge<S>>(ask, out);
  } else {
    internal::fill_links<Joint<S>>(ask, out);
    internal::fill_plant<Joint<S>>(ask, out);
    internal::fill_torques<Joint<S>, LinkJoint<S>>(ask, out);
  }
  out.torque.any_joint = internal::law<Joint<S>>(ask, VectorX<S>(VectorX<S>::Zero(ask.qd.size())), {}, false);
  return out;
}

/// As many task rows as Omega(0) has rank, by adding those whose pivot is above `floor` times the largest
/// diagonal entry among the angular or the linear rows.
template <Ordered S>
TaskRows independent_rows(const Chain<S>& chain, const std::vector<JointPosition<S>>& positions,
                          const VectorX<S>& qd, const S& floor) {
  const auto state = dense::state(chain, positions, qd);
  const MatrixX<S> Omega = dense::mobility(state.tip, state.joint).Omega;
  TaskRows rows;
  for (int row = 0; row < 6; ++row) {
    S largest = S(0);
    for (int i = row - row % 3; i < row - row % 3 + 3; ++i)
      if (largest < Omega(i, i)) largest = Omega(i, i);
    rows.push_back(row);
    const MatrixX<S> chosen = Omega(rows, rows);
    if (!(floor * largest < dense::factor(chosen).D[chosen.rows() - 1])) rows.pop_back();
  }
  return rows;
}

}  // namespace osculate::paper
