// The oracle: dynamics of an arm from the textbook definitions, cost O(n^3). Homogeneous transforms,
// geometric Jacobians and Newton-Euler at the centres of mass; nothing is shared with the recursions but the
// numbers of Chain. Equation numbers: Kreutz-Delgado, Jain & Rodriguez (1992). Base frame throughout;
// six-vectors angular rows first; joints base to tip; SI units and radians. Field operations only: over exact
// numbers every result is exact.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "model/chain.hpp"
#include "model/pose.hpp"
#include "reference/ldlt.hpp"
#include "scalar/dual.hpp"

namespace osculate::dense {

template <Field S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
template <Field S>
using Jacobian = Eigen::Matrix<S, 6, Eigen::Dynamic>;
template <Field S>
using Positions = std::vector<JointPosition<S>>;

/// A homogeneous transform [R p; 0 1]: x_outer = R x_inner + p.
template <Field S>
struct Transform {
  Matrix3<S> R = Matrix3<S>::Identity();
  Vector3<S> p = Vector3<S>::Zero();  // m

  friend Transform operator*(const Transform& a, const Transform& b) { return {a.R * b.R, a.p + a.R * b.p}; }
};

/// Where one link is, base frame.
template <Field S>
struct LinkPlace {
  JointType type = JointType::revolute;
  Matrix3<S> R;       // link axes
  Vector3<S> axis;    // unit vector of its joint
  Vector3<S> origin;  // m, link frame's origin, on the joint axis
  Vector3<S> com;     // m, centre of mass
};

/// Where everything is, base frame. `links` base to tip.
template <Field S>
struct Places {
  std::vector<LinkPlace<S>> links;
  Transform<S> tip;
};

/// Motion of one point that is fixed in a link: V = J qd, Vd = J qdd + Jdot_qd. Base frame, about the point.
template <Field S>
struct PointMotion {
  Jacobian<S> J;                            // 6 x (joints inboard of the point)           (7)
  Vector6<S> V = Vector6<S>::Zero();        // rad/s, m/s
  Vector6<S> Jdot_qd = Vector6<S>::Zero();  // rad/s^2, m/s^2; ordinary acceleration at qdd = 0    (8)
};

/// Pose and motion of the tip, base frame, about the tip's origin.
template <Field S>
struct Kinematics {
  Matrix3<S> R;             // tip axes
  Vector3<S> p;             // m, tip origin
  Jacobian<S> J;            // 6 x n                                                            (7)
  Vector6<S> tip_velocity;  // J qd: rad/s, m/s                                                 (7)
  Vector6<S> Jdot_qd;       // rad/s^2, m/s^2                                                   (8)
};

/// M(q) qdd + C(q, qd) + G(q) = T + J^T F_ext                                                   (6)
/// Units of row i: N m (revolute) or N (prismatic) per unit of the column's coordinate.
template <Field S>
struct JointSpace {
  MatrixX<S> M;  // n x n, armature on the diagonal
  VectorX<S> C;  // n, centrifugal and Coriolis; no friction
  VectorX<S> G;  // n, = dU/dq
};

/// All that a state defines before a task is chosen.
template <Field S>
struct State {
  Kinematics<S> tip;
  JointSpace<S> joint;
};

/// The chosen task rows (m of the six) and how they yield to force: everything that exists at any rank.
template <Field S>
struct Mobility {
  MatrixX<S> J;         // m x n, the chosen rows
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

/// a~ with a~ x = a x x.
template <Field S>
Matrix3<S> cross_matrix(const Vector3<S>& a) {
  const S o(0);
  Matrix3<S> A;
  A << o, -a[2], a[1],  //
      a[2], o, -a[0],   //
      -a[1], a[0], o;
  return A;
}

/// Pose of a link in its inboard link's frame. The position may be a dual number over the link's scalar.
template <Field N, Field S>
Transform<N> joint_transform(const Link<S>& link, const JointPosition<N>& q) {
  const Matrix3<S> K = cross_matrix(link.axis);
  const Matrix3<S> KK = K * K;
  const Transform<N> origin{link.R_origin.template cast<N>(), link.p_origin.template cast<N>()};
  const Matrix3<N> turn =
      Matrix3<N>::Identity() + q.s * K.template cast<N>() + (N(1) - q.c) * KK.template cast<N>();
  const Vector3<N> slide = q.d * link.axis.template cast<N>();
  return origin * Transform<N>{turn, slide};
}

/// Every joint, centre of mass and the tip, from base to tip. positions.size() == chain.n().
template <Field N, Field S>
Places<N> places(const Chain<S>& chain, const Positions<N>& positions) {
  Places<N> out;
  out.links.reserve(chain.links.size());
  Transform<N> T;
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Link<S>& link = chain.links[i];
    T = T * joint_transform(link, positions[i]);
    out.links.push_back(
        {link.type, T.R, T.R * link.axis.template cast<N>(), T.p, T.p + T.R * link.com.template cast<N>()});
  }
  out.tip = T * Transform<N>{chain.R_tip.template cast<N>(), chain.p_tip.template cast<N>()};
  return out;
}

/// Positions with their rates as derivatives: c' = -s qd, s' = c qd, d' = qd. All sizes chain.n().
template <Field S>
Positions<Dual<S>> moving(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd) {
  Positions<Dual<S>> out;
  out.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto& [c, s, d] = positions[i];
    const S& rate = qd[static_cast<Eigen::Index>(i)];
    if (chain.links[i].type == JointType::revolute)
      out.push_back({Dual<S>(c, -s * rate), Dual<S>(s, c * rate), Dual<S>(d)});
    else
      out.push_back({Dual<S>(c), Dual<S>(s), Dual<S>(d, rate)});
  }
  return out;
}

/// Motion of `point` (base frame, moving with it) that sits on the `joints`-th moving link, counted from the
/// base. The places are those of `moving`, so the derivative of V = J qd at constant qd is Jdot qd.
template <Field S>
PointMotion<S> point_motion(const Places<Dual<S>>& at, const VectorX<S>& qd, const Vector3<Dual<S>>& point,
                            int joints) {
  using N = Dual<S>;
  PointMotion<S> out;
  out.J.resize(6, joints);
  Vector6<N> V = Vector6<N>::Zero();
  for (int j = 0; j < joints; ++j) {
    const LinkPlace<N>& link = at.links[static_cast<std::size_t>(j)];
    Vector6<N> column;
    if (link.type == JointType::revolute)
      column << link.axis, link.axis.cross(point - link.origin);
    else
      column << Vector3<N>::Zero(), link.axis;
    out.J.col(j) = values(column);
    V += column * N(qd[j]);
  }
  out.V = values(V);
  out.Jdot_qd = derivatives(V);
  return out;
}

template <Field S>
Kinematics<S> kinematics(const Chain<S>& chain, const Places<Dual<S>>& at, const VectorX<S>& qd) {
  PointMotion<S> tip = point_motion(at, qd, at.tip.p, chain.n());
  return {values(at.tip.R), values(at.tip.p), std::move(tip.J), tip.V, tip.Jdot_qd};
}

template <Field S>
JointSpace<S> joint_space(const Chain<S>& chain, const Places<Dual<S>>& at, const VectorX<S>& qd) {
  const int n = chain.n();
  JointSpace<S> out{MatrixX<S>::Zero(n, n), VectorX<S>::Zero(n), VectorX<S>::Zero(n)};
  for (int i = 0; i < n; ++i) {
    const Link<S>& link = chain.links[static_cast<std::size_t>(i)];
    const LinkPlace<Dual<S>>& place = at.links[static_cast<std::size_t>(i)];
    const PointMotion<S> com = point_motion(at, qd, place.com, i + 1);
    const Matrix3<S> R = values(place.R);
    const Matrix3<S> I = R * link.inertia * R.transpose();
    const auto Jw = com.J.template topRows<3>();
    const auto Jv = com.J.template bottomRows<3>();
    const Vector3<S> w = com.V.template head<3>();
    const Vector3<S> Iw = I * w;
    const Vector3<S> moment = I * com.Jdot_qd.template head<3>() + w.cross(Iw);
    const Vector3<S> force = link.mass * com.Jdot_qd.template tail<3>();
    const Vector3<S> weight = link.mass * chain.gravity;
    const Jacobian<S> momentum = (Jacobian<S>(6, i + 1) << I * Jw, link.mass * Jv).finished();

    out.M.topLeftCorner(i + 1, i + 1) += com.J.transpose() * momentum;
    out.C.head(i + 1) += Jw.transpose() * moment + Jv.transpose() * force;
    out.G.head(i + 1) -= Jv.transpose() * weight;
    out.M(i, i) += link.armature;
  }
  return out;
}

/// Pose and motion of the tip. positions.size() == qd.size() == chain.n().
template <Field S>
Kinematics<S> kinematics(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd) {
  return kinematics(chain, places(chain, moving(chain, positions, qd)), qd);
}

/// M, C and G of (6). positions.size() == qd.size() == chain.n().
template <Field S>
JointSpace<S> joint_space(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd) {
  return joint_space(chain, places(chain, moving(chain, positions, qd)), qd);
}

/// Both, sharing one pass from base to tip. positions.size() == qd.size() == chain.n().
template <Field S>
State<S> state(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd) {
  const Places<Dual<S>> at = places(chain, moving(chain, positions, qd));
  return {kinematics(chain, at, qd), joint_space(chain, at, qd)};
}

/// All six rows: wx wy wz vx vy vz.
inline std::vector<int> all_rows() { return {0, 1, 2, 3, 4, 5}; }

/// Omega and what c and g are made of, for the given rows (distinct, 0..5). Divides by the pivots of M only,
/// so it exists wherever M is positive definite; whether Omega can be inverted is for the caller to find out.
/// Equation (11).
template <Field S>
Mobility<S> mobility(const Kinematics<S>& tip, const JointSpace<S>& joint,
                     const std::vector<int>& rows = all_rows()) {
  Mobility<S> out;
  out.J = tip.J(rows, Eigen::all);
  out.Jdot_qd = tip.Jdot_qd(rows);
  const Ldlt<S> M = factor(joint.M);
  out.Omega = out.J * solve(M, MatrixX<S>(out.J.transpose()));
  out.J_Minv_C = out.J * solve(M, joint.C);
  out.J_Minv_G = out.J * solve(M, joint.G);
  return out;
}

/// Lambda, c and g: equations (12), (14), (15). Omega must have full rank: this only divides, see ldlt.hpp.
template <Field S>
TaskTerms<S> task_terms(const Mobility<S>& task) {
  const Eigen::Index m = task.Omega.rows();
  const Ldlt<S> Omega = factor(task.Omega);
  return {solve(Omega, MatrixX<S>(MatrixX<S>::Identity(m, m))),
          solve(Omega, VectorX<S>(task.J_Minv_C - task.Jdot_qd)), solve(Omega, task.J_Minv_G)};
}

/// F = Lambda u + c + g and T = J^T F: the torque that makes the chosen rows of the tip acceleration equal u
/// (m numbers; rad/s^2, m/s^2). Equations (4) and (16).
template <Field S>
TaskForce<S> task_force(const Mobility<S>& task, const TaskTerms<S>& terms, const VectorX<S>& u) {
  const VectorX<S> F = terms.Lambda * u + terms.c + terms.g;
  return {F, task.J.transpose() * F};
}

/// qdd = M^-1 (T - C - G + J^T F_ext). T: n joint torques with friction already subtracted. F_ext: moment and
/// force on the arm at the tip's origin, base frame. Returns rad/s^2 or m/s^2. Equation (6).
template <Field S>
VectorX<S> forward_dynamics(const JointSpace<S>& joint, const Jacobian<S>& J, const VectorX<S>& T,
                            const Vector6<S>& F_ext = Vector6<S>::Zero()) {
  return solve(factor(joint.M), VectorX<S>(T - joint.C - joint.G + J.transpose() * F_ext));
}

/// 1/2 qd^T M qd in J, armature included.
template <Field S>
S kinetic_energy(const JointSpace<S>& joint, const VectorX<S>& qd) {
  return qd.dot(joint.M * qd) / S(2);
}

/// U = -sum m gravity . r_com in J, zero where all centres of mass lie at the base origin. positions.size()
/// == chain.n().
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

}  // namespace osculate::dense
