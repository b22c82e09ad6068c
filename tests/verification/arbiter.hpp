// The arbiter between the recursion and the dense formulas: the same definitions in 113-bit arithmetic, at
// the numbers that both sides were given in double. A difference between the two sides says that one has lost
// digits; the arbiter says which.
#pragma once

#include "reference/true_arm.hpp"
#include "verification/claims.hpp"

namespace osculate::testing {

/// The definitions over Quad at one state; see dense.hpp. `terms` mean something where Omega has full rank.
struct Truth {
  dense::State<Quad> state;
  dense::Mobility<Quad> task;
  dense::TaskTerms<Quad> terms;
};

/// The truth at q and qd (base to tip), exact numbers to the arbiter. Cosines and sines are taken in Quad.
/// Cost: about 1 ms for 7 joints on x86-64, where Quad is software.
inline Truth truth(const Chain<double>& chain, const VectorX<double>& q, const VectorX<double>& qd,
                   const TaskRows& rows) {
  const Chain<Quad> arm = true_arm(chain);
  const VectorX<Quad> angles = q.cast<Quad>();
  const auto joints = positions<Quad>(arm, {angles.data(), static_cast<std::size_t>(angles.size())});
  Truth out;
  out.state = dense::state<Quad>(arm, joints, qd.cast<Quad>());
  out.task = dense::mobility(out.state.tip, out.state.joint, rows);
  out.terms = dense::task_terms(out.task);
  return out;
}

/// What one side answers at a state, in double. Task quantities on the task rows.
struct Answers {
  MatrixX<double> Omega, Lambda;
  VectorX<double> c, g, c_plus_g;
  VectorX<double> T;    // torque for u, with the null-space torque
  VectorX<double> qdd;  // of the plant under Evidence::net_torque
  Matrix3<double> R;
  Vector3<double> p;
  Vector6 velocity, pose_rate;  // of the tip, by two routes
  Vector6 acceleration;         // of the tip, for this side's qdd
};

inline Answers recursive_answers(const Evidence& e) {
  return {e.recursive.Omega(e.rows, e.rows),
          e.recursive.Lambda,
          e.recursive.c,
          e.recursive.g,
          e.recursive.c_plus_g,
          e.T,
          e.qdd,
          e.tip.R,
          e.tip.p,
          e.tip_velocity,
          e.tip_velocity,
          e.tip_acceleration};
}

/// The torque as `assess` forms it: T0 + J^T (Lambda (u - J M^-1 T0) + c + g).
template <Field S>
VectorX<S> dense_torque(const dense::JointSpace<S>& joint, const dense::Mobility<S>& task,
                        const dense::TaskTerms<S>& terms, const VectorX<S>& u, const VectorX<S>& T0) {
  const VectorX<S> t = task.J * dense::solve(dense::factor(joint.M), T0);
  const VectorX<S> F = terms.Lambda * (u - t) + terms.c + terms.g;
  return T0 + task.J.transpose() * F;
}

inline Answers dense_answers(const Evidence& e) {
  const auto& tip = e.plant.tip;
  const VectorX<double> qdd = dense::forward_dynamics(e.plant.joint, tip.J, e.net_torque, e.tip_force);
  return {e.task.Omega,
          e.terms.Lambda,
          e.terms.c,
          e.terms.g,
          e.terms.c + e.terms.g,
          dense_torque(e.model.joint, e.task, e.terms, e.u, e.T0),
          qdd,
          tip.R,
          tip.p,
          tip.tip_velocity,
          e.pose_rate,
          tip.J * qdd + tip.Jdot_qd};
}

/// x - y, taken in Quad and then rounded: exact to eps of the difference, however close the two are.
template <class Wide>
auto defect(const MatrixX<double>& x, const Wide& y) {
  using Plain = Eigen::Matrix<double, Wide::RowsAtCompileTime, Wide::ColsAtCompileTime>;
  return Plain((x.cast<Quad>() - y).template cast<double>());
}

/// Residuals and bounds of one side's answers against the truth, by the very lines of `assess`, so that they
/// are in the same units. `assess` compares answers x with the dense values y; here it is handed y + (x -
/// truth) instead of x. Its scales and condition numbers stay those of the program. Rounding adds at most eps
/// of each scale. The evidence must have full rank, the law in charge and one chain as model and plant.
///
/// Two claims have no answer of their own to compare. Linearization: the tip acceleration of the true arm
/// under this side's torque, against u. Null space: J M^-1 (T - J^T F) in Quad for this side's torque T.
inline Residuals against_truth(const Evidence& e, const Answers& x, const Truth& truth) {
  const Answers y = dense_answers(e);
  const auto& [tip, joint] = truth.state;
  const auto& terms = truth.terms;
  const VectorX<Quad> u = e.u.cast<Quad>(), T0 = e.T0.cast<Quad>(), T = x.T.cast<Quad>();
  const VectorX<Quad> c_plus_g = terms.c + terms.g;
  const dense::Vector6<Quad> push = e.tip_force.cast<Quad>();

  Evidence a = e;
  const MatrixX<double> Omega = y.Omega + defect(x.Omega, truth.task.Omega);
  for (std::size_t i = 0; i < e.rows.size(); ++i)
    for (std::size_t j = 0; j < e.rows.size(); ++j)
      a.recursive.Omega(e.rows[i], e.rows[j]) =
          Omega(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  a.recursive.Lambda = y.Lambda + defect(x.Lambda, terms.Lambda);
  a.recursive.c = y.c + defect(x.c, terms.c);
  a.recursive.g = y.g + defect(x.g, terms.g);
  a.recursive.c_plus_g = y.c_plus_g + defect(x.c_plus_g, c_plus_g);
  a.T = y.T + defect(x.T, dense_torque(joint, truth.task, terms, u, T0));
  const VectorX<Quad> net = e.net_torque.cast<Quad>();
  a.qdd = y.qdd + defect(x.qdd, dense::forward_dynamics(joint, tip.J, net, push));
  a.tip.R = y.R + defect(x.R, tip.R);
  a.tip.p = y.p + defect(x.p, tip.p);
  a.tip_velocity = y.velocity + defect(x.velocity, tip.tip_velocity);
  a.pose_rate = y.velocity + defect(x.pose_rate, tip.tip_velocity);
  const dense::Vector6<Quad> acceleration = tip.J * x.qdd.cast<Quad>() + tip.Jdot_qd;
  a.tip_acceleration = e.plant.tip.J * a.qdd + e.plant.tip.Jdot_qd + defect(x.acceleration, acceleration);
  Residuals out = assess(a);

  Evidence b = e;
  const VectorX<Quad> qdd = dense::forward_dynamics(joint, tip.J, T, push);
  b.tip_acceleration = dense::Vector6<Quad>(tip.J * qdd + tip.Jdot_qd).cast<double>();
  const MatrixX<Quad> Jt = truth.task.J.transpose();
  const VectorX<Quad> extra = T - Jt * (terms.Lambda * u + c_plus_g);
  const VectorX<Quad> rest = truth.task.J * dense::solve(dense::factor(joint.M), extra);
  const VectorX<double> task_force = e.terms.Lambda * e.u + e.terms.c + e.terms.g;
  // J^T (F + Lambda rest) is the torque for which `assess` finds just this rest.
  b.T = e.task.J.transpose() * (task_force + e.terms.Lambda * rest.cast<double>());
  const Residuals of_torque = assess(b);
  for (const Claim claim : {Claim::linearization, Claim::null_space})
    out[index(claim)] = of_torque[index(claim)];
  return out;
}

}  // namespace osculate::testing
