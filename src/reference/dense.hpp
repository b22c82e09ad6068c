// The oracle: dynamics of an arm from the textbook definitions, cost O(n^3). Homogeneous transforms,
// geometric Jacobians and Newton-Euler at the centres of mass; nothing is shared with the recursions but the
// numbers of Chain. Equation numbers: Kreutz-Delgado, Jain & Rodriguez (1992). Everything is resolved in the
// inertial frame, which is the base frame while the base rests; six-vectors angular rows first; joints base
// to tip; SI units and radians. Field operations only: over exact numbers every result is exact. kinematics()
// and joint_space() are the definitions as they stand, link by link; state() (state.hpp) is the same in
// O(n^2) and the one that runs.
#pragma once

#include "reference/ldlt.hpp"
#include "reference/places.hpp"
#include "reference/state.hpp"

namespace osculate::dense {

/// The chosen task rows (m of the six) and how they yield to force: everything that exists at any rank.
template <Field S>
struct Mobility {
  MatrixX<S> J;         // m x chain.velocities(), the chosen rows
  VectorX<S> Jdot_qd;   // m, the chosen rows
  MatrixX<S> Omega;     // m x m, J M^-1 J^T                                                   (11)
  VectorX<S> J_Minv_C;  // m, J M^-1 C
  VectorX<S> J_Minv_G;  // m, J M^-1 G
};

/// Lambda beta_dot + c + g = F in the chosen rows                                               (2)
template <Field S>
struct TaskTerms {
  MatrixX<S> Lambda;  // m x m, Omega^-1                                                       (12)
  VectorX<S> c;       // m, Lambda (J M^-1 C - Jdot qd); N m, N                                (14)
  VectorX<S> g;       // m, Lambda J M^-1 G; N m, N                                            (15)
};

/// Force on the arm at the tip's origin and the joint torques that stand for it.
template <Field S>
struct TaskForce {
  VectorX<S> F;  // m; N m, N                                                                   (4)
  VectorX<S> T;  // n; N m or N                                                                (16)
};

/// Pose and motion of the tip from the places of the links and their derivatives along qd.
template <Field S>
Kinematics<S> kinematics(const Chain<S>& chain, const Places<Dual<S>>& at, const VectorX<S>& qd) {
  PointMotion<S> tip = point_motion(at, qd, at.tip.p, chain.n());
  return {values(at.tip.R), values(at.tip.p), std::move(tip.J), tip.V, tip.Jdot_qd};
}

/// M, C and G of (6) from the places of the links and their derivatives along qd.
template <Field S>
JointSpace<S> joint_space(const Chain<S>& chain, const Places<Dual<S>>& at, const VectorX<S>& qd) {
  const int m = chain.velocities();
  JointSpace<S> out{MatrixX<S>::Zero(m, m), VectorX<S>::Zero(m), VectorX<S>::Zero(m)};
  for (int i = 0; i < chain.n(); ++i) {
    const Link<S>& link = chain.links[static_cast<std::size_t>(i)];
    const LinkPlace<Dual<S>>& place = at.links[static_cast<std::size_t>(i)];
    const PointMotion<S> com = point_motion(at, qd, place.com, i + 1);
    const Eigen::Index c = com.J.cols();
    const Matrix3<S> R = values(place.R);
    const Matrix3<S> I = R * link.inertia * R.transpose();
    const auto Jw = com.J.template topRows<3>();
    const auto Jv = com.J.template bottomRows<3>();
    const Vector3<S> w = com.V.template head<3>();
    const Vector3<S> Iw = I * w;
    const Vector3<S> moment = I * com.Jdot_qd.template head<3>() + w.cross(Iw);
    const Vector3<S> force = link.mass * com.Jdot_qd.template tail<3>();
    const Vector3<S> weight = link.mass * chain.gravity;
    const Jacobian<S> momentum = (Jacobian<S>(6, c) << I * Jw, link.mass * Jv).finished();

    out.M.topLeftCorner(c, c) += com.J.transpose() * momentum;
    out.C.head(c) += Jw.transpose() * moment + Jv.transpose() * force;
    out.G.head(c) -= Jv.transpose() * weight;
    if (one_axis(link.type)) out.M(c - 1, c - 1) += link.armature;
  }
  return out;
}

/// Pose and motion of the tip. positions.size() == chain.n(), qd.size() == chain.velocities(). On a moving
/// base Jdot_qd is the tip's acceleration at qdd = 0, the base's own acceleration included.
template <Field S>
Kinematics<S> kinematics(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
                         const BaseMotion<S>& base = {}) {
  return kinematics(chain, moving_places(chain, positions, qd, base), qd);
}

/// M, C and G of (6). positions.size() == chain.n(), qd.size() == chain.velocities(). On a moving base C
/// contains the base's velocity and acceleration: (6) holds with the base moving as told.
template <Field S>
JointSpace<S> joint_space(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
                          const BaseMotion<S>& base = {}) {
  return joint_space(chain, moving_places(chain, positions, qd, base), qd);
}

/// All six rows: wx wy wz vx vy vz.
inline std::vector<int> all_rows() { return {0, 1, 2, 3, 4, 5}; }

namespace internal {
/// rows == all_rows()
inline bool in_order(const std::vector<int>& rows) {
  bool all = rows.size() == 6;
  for (int i = 0; all && i < 6; ++i) all = rows[static_cast<std::size_t>(i)] == i;
  return all;
}
}  // namespace internal

/// Omega and what c and g are made of, for the given rows (distinct, 0..5). Divides by the pivots of M only,
/// so it exists wherever M is positive definite; whether Omega can be inverted is for the caller to find out.
/// Equation (11).
template <Field S>
Mobility<S> mobility(const Kinematics<S>& tip, const JointSpace<S>& joint,
                     const std::vector<int>& rows = all_rows()) {
  Jacobian<S> J_Minv;
  Mobility<S> out;
  mobility(tip, joint, factor(joint.M), rows, J_Minv, out);
  return out;
}
/// The same with M factored before; J_Minv becomes J M^-1, all six rows. Both outputs keep their storage.
template <Field S>
void mobility(const Kinematics<S>& tip, const JointSpace<S>& joint, const Ldlt<S>& M,
              const std::vector<int>& rows, Jacobian<S>& J_Minv, Mobility<S>& out) {
  J_Minv = tip.J;
  divide(J_Minv, M);
  Eigen::Matrix<S, 6, 6> Omega;
  Vector6<S> of_C = Vector6<S>::Zero(), of_G = of_C;
  internal::with_size<S>(tip.J.cols(), [&](const auto size) {
    const Eigen::Index n = size;
    for (int j = 0; j < 6; ++j) {
      Vector6<S> column = Vector6<S>::Zero();
#pragma GCC unroll 6
      for (Eigen::Index k = 0; k < n; ++k) column += J_Minv.col(k) * tip.J(j, k);
      Omega.col(j) = column;
    }
#pragma GCC unroll 6
    for (Eigen::Index k = 0; k < n; ++k)
      of_C += J_Minv.col(k) * joint.C[k], of_G += J_Minv.col(k) * joint.G[k];
  });
  if (internal::in_order(rows)) {  // nothing to choose
    out.J = tip.J;
    out.Omega = Omega;
    out.Jdot_qd = tip.Jdot_qd;
    out.J_Minv_C = of_C;
    out.J_Minv_G = of_G;
    return;
  }
  const auto m = static_cast<Eigen::Index>(rows.size());
  out.J.resize(m, tip.J.cols());
  for (Eigen::Index k = 0; k < tip.J.cols(); ++k)
    for (Eigen::Index i = 0; i < m; ++i) out.J(i, k) = tip.J(rows[static_cast<std::size_t>(i)], k);
  out.Omega.resize(m, m);
  for (VectorX<S>* v : {&out.Jdot_qd, &out.J_Minv_C, &out.J_Minv_G}) v->resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < m; ++j) out.Omega(i, j) = Omega(row, rows[static_cast<std::size_t>(j)]);
    out.Jdot_qd[i] = tip.Jdot_qd[row];
    out.J_Minv_C[i] = of_C[row];
    out.J_Minv_G[i] = of_G[row];
  }
}

/// Lambda, c and g: equations (12), (14), (15). Omega must have full rank: this only divides, see ldlt.hpp.
template <Field S>
TaskTerms<S> task_terms(const Mobility<S>& task) {
  TaskTerms<S> out;
  task_terms(task, factor(task.Omega), out);
  return out;
}
/// The same with Omega factored before.
template <Field S>
void task_terms(const Mobility<S>& task, const Ldlt<S>& Omega, TaskTerms<S>& out) {
  inverse(Omega, out.Lambda);
  out.c = task.J_Minv_C - task.Jdot_qd;
  out.g = task.J_Minv_G;
  for (VectorX<S>* v : {&out.c, &out.g}) solve_in_place(Omega, v->data());
}

/// F = Lambda u + c + g and T = J^T F: the torque that makes the chosen rows of the tip acceleration equal u
/// (m numbers; rad/s^2, m/s^2). Equations (4) and (16).
template <Field S>
TaskForce<S> task_force(const Mobility<S>& task, const TaskTerms<S>& terms, const VectorX<S>& u) {
  const VectorX<S> F = terms.Lambda * u + terms.c + terms.g;
  return {F, task.J.transpose() * F};
}

/// qdd = M^-1 (T - C - G + J^T F_ext). T: joint torques with friction already subtracted. F_ext: moment and
/// force on the arm at the tip's origin, base frame. Returns rad/s^2 or m/s^2. Equation (6).
template <Field S>
VectorX<S> forward_dynamics(const JointSpace<S>& joint, const Jacobian<S>& J, const VectorX<S>& T,
                            const Vector6<S>& F_ext = Vector6<S>::Zero()) {
  return solve(factor(joint.M), VectorX<S>(T - joint.C - joint.G + J.transpose() * F_ext));
}

/// 1/2 qd^T M qd in J, armature included; the kinetic energy while the base rests.
template <Field S>
S kinetic_energy(const JointSpace<S>& joint, const VectorX<S>& qd) {
  return qd.dot(joint.M * qd) / S(2);
}

/// U = -sum m gravity . r_com in J, zero where all centres of mass lie at the base origin. The base rests in
/// the inertial frame. positions.size() == chain.n().
template <Field N, Field S>
N potential_energy(const Chain<S>& chain, const Positions<N>& positions) {
  const Places<N> at = places(chain, positions);
  N U(0);
  for (std::size_t i = 0; i < at.links.size(); ++i) {
    const Vector3<S> weight = chain.links[i].mass * chain.gravity;
    U -= weight.template cast<N>().dot(at.links[i].com);
  }
  return U;
}

// In double precision compiled once, in dense.cpp.
#define OSCULATE_DENSE(how)                                                                                \
  how template Ldlt<double> factor(const MatrixX<double>&);                                                \
  how template void factor(const MatrixX<double>&, Ldlt<double>&);                                         \
  how template void inverse(const Ldlt<double>&, MatrixX<double>&);                                        \
  how template void solve_in_place(const Ldlt<double>&, double*);                                          \
  how template MatrixX<double> solve(const Ldlt<double>&, MatrixX<double>);                                \
  how template VectorX<double> solve(const Ldlt<double>&, VectorX<double>);                                \
  how template Places<Dual<double>> moving_places(const Chain<double>&, const Positions<double>&,          \
                                                  const VectorX<double>&, const BaseMotion<double>&);      \
  how template PointMotion<double> point_motion(const Places<Dual<double>>&, const VectorX<double>&,       \
                                                const Vector3<Dual<double>>&, int);                        \
  how template Kinematics<double> kinematics(const Chain<double>&, const Positions<double>&,               \
                                             const VectorX<double>&, const BaseMotion<double>&);           \
  how template JointSpace<double> joint_space(const Chain<double>&, const Positions<double>&,              \
                                              const VectorX<double>&, const BaseMotion<double>&);          \
  how template State<double> state(const Chain<double>&, const Positions<double>&, const VectorX<double>&, \
                                   const BaseMotion<double>&);                                             \
  how template void state(const Chain<double>&, const Positions<double>&, const VectorX<double>&,          \
                          const BaseMotion<double>&, Moving<double>&, State<double>&);                     \
  how template Mobility<double> mobility(const Kinematics<double>&, const JointSpace<double>&,             \
                                         const std::vector<int>&);                                         \
  how template void mobility(const Kinematics<double>&, const JointSpace<double>&, const Ldlt<double>&,    \
                             const std::vector<int>&, Jacobian<double>&, Mobility<double>&);               \
  how template TaskTerms<double> task_terms(const Mobility<double>&);                                      \
  how template void task_terms(const Mobility<double>&, const Ldlt<double>&, TaskTerms<double>&);          \
  how template VectorX<double> forward_dynamics(const JointSpace<double>&, const Jacobian<double>&,        \
                                                const VectorX<double>&, const Vector6<double>&);           \
  how template double potential_energy(const Chain<double>&, const Positions<double>&)
OSCULATE_DENSE(extern);

}  // namespace osculate::dense
