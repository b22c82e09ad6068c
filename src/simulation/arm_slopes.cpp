#include "simulation/arm_slopes.hpp"

#include "control/rotation.hpp"

namespace osculate {

// All motions and forces are about the present tip point, a point at rest. Links and joints 1 .. n count from
// the base; s_j is the axis of joint j as a motion, I_i the inertia of link i; x and x* are the products of a
// motion with a motion and with a force.
//
//   V_i = V_i-1 + s_i qd_i         w_i = V_i x s_i                the rate of s_i
//   A_i = A_i-1 + s_i qdd_i + w_i qd_i                            A_0 holds the weight
//   f_i = I_i A_i + V_i x* I_i V_i,    F_i = sum of f_k, k >= i,      T_i = s_i . F_i
//
// What is outside joint j turns with s_j. For i >= j, with d = d/dq_j,
//   d s_i = s_j x s_i,   d V_i = s_j x (V_i - V_j),   d A_i = s_j x (A_i - A_j) + w_j x (V_i - V_j),
//   d (I_i x) = s_j x* I_i x + I_i (d x - s_j x x),
// so that with the linear map B_i x = I_i (x x V_i) + x x* I_i V_i + V_i x* I_i x
//   d f_i = s_j x* f_i + B_i w_j + I_i y_j,     y_j = A_j x s_j + V_j x w_j
// and since d V_i/dqd_j = s_j, d A_i/dqd_j = s_j x V_i + 2 w_j
//   d f_i/dqd_j = B_i s_j + 2 I_i w_j.
// I and B are summed from the tip. In T_k = s_k . F_k for k >= j the turn of s_k takes away s_j x* F_k.
// Carpentier and Mansard (2018) have the same derivatives.

namespace {

using Matrix6 = ArmSlopes::Matrix6;
using Three = Vector3<double>;

Three eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

Vector6 joined(const Three& angular, const Three& linear) {
  Vector6 out;
  out.head<3>() = angular, out.tail<3>() = linear;
  return out;
}

/// Motion with motion.
Vector6 cross(const Vector6& x, const Vector6& y) {
  const Three w = x.head<3>(), v = x.tail<3>(), a = y.head<3>(), b = y.tail<3>();
  return joined(w.cross(a), w.cross(b) + v.cross(a));
}
/// Motion with force.
Vector6 cross_force(const Vector6& x, const Vector6& f) {
  const Three w = x.head<3>(), v = x.tail<3>(), n = f.head<3>(), l = f.tail<3>();
  return joined(w.cross(n) + v.cross(l), w.cross(l));
}

/// cross(x, y) = motion_matrix(x) y; cross_force(x, f) = - motion_matrix(x)^T f.
Matrix6 motion_matrix(const Vector6& x) {
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = cross_matrix(x.head<3>());
  out.bottomLeftCorner<3, 3>() = cross_matrix(x.tail<3>());
  return out;
}
/// cross_force(x, f) = force_matrix(f) x.
Matrix6 force_matrix(const Vector6& f) {
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = -cross_matrix(f.head<3>());
  out.topRightCorner<3, 3>() = out.bottomLeftCorner<3, 3>() = -cross_matrix(f.tail<3>());
  return out;
}

/// Inertia about a point from which O(k) is at r.
Matrix6 inertia_about(const RigidInertia<double>& M, const Three& r) {
  const Three mp = eigen(M.mp);
  Matrix3<double> I;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) I(i, j) = entry(M.I, std::min(i, j), std::max(i, j));
  const Three moved = mp + M.m * r;
  Matrix6 out;
  out.topLeftCorner<3, 3>() = I - cross_matrix(mp) * cross_matrix(r) - cross_matrix(r) * cross_matrix(moved);
  out.topRightCorner<3, 3>() = cross_matrix(moved);
  out.bottomLeftCorner<3, 3>() = -cross_matrix(moved);
  out.bottomRightCorner<3, 3>() = M.m * Matrix3<double>::Identity();
  return out;
}

}  // namespace

ArmSlopes::ArmSlopes(const Chain<double>& chain) : builder_(chain), arm_(builder_.arm()) {
  const Eigen::Index n = chain.n();
  for (auto* square : {&M, &T_q, &T_qd}) square->setZero(n, n);
  for (auto* columns : {&J, &V_q, &A_q, &A_qd, &V_, &A_, &w_, &y_}) columns->setZero(6, n);
  inertia_.resize(chain.links.size());
}

void ArmSlopes::look(const std::vector<JointPosition<double>>& joints, std::span<const double> qd,
                     std::span<const double> qdd, const BaseMotion<double>& base) {
  const int n = builder_.n();
  arm_.base = builder_.placement(base);
  builder_.place(joints, arm_);
  const Three tip = tip_position = eigen(arm_.tip.p);
  const Three to_tip = tip - base.p, w_base = base.velocity.head<3>(), v_base = base.velocity.tail<3>();
  const Three turning = base.acceleration.head<3>();
  Vector6 V = joined(w_base, v_base + w_base.cross(to_tip));
  Vector6 A = joined(turning, base.acceleration.tail<3>() - w_base.cross(v_base) + turning.cross(to_tip) +
                                  eigen(builder_.a_g().lin));

  Three O = base.p;  // of the joint
  for (int i = 0; i < n; ++i) {
    const auto& [phi, hinge, body, armature] = arm_[n - i];
    O += eigen(phi.l);
    const Three h = eigen(hinge.h), r = O - tip;
    const Vector6 s = hinge.turns() ? joined(h, r.cross(h)) : joined(Three::Zero(), h);
    const double rate = qd[static_cast<std::size_t>(i)];
    V += s * rate;
    const Vector6 w = cross(V, s);
    A += s * qdd[static_cast<std::size_t>(i)] + w * rate;
    J.col(i) = s, V_.col(i) = V, w_.col(i) = w, A_.col(i) = A;
    y_.col(i) = cross(A, s) + cross(V, w);
    inertia_[static_cast<std::size_t>(i)] = inertia_about(body, r);
  }

  Matrix6 I = Matrix6::Zero(), B = Matrix6::Zero();
  Vector6 F = Vector6::Zero();
  for (int j = n - 1; j >= 0; --j) {
    const Matrix6& own = inertia_[static_cast<std::size_t>(j)];
    const Vector6 Vj = V_.col(j), s = J.col(j), w = w_.col(j), y = y_.col(j);
    const Vector6 momentum = own * Vj;
    const Matrix6 V_matrix = motion_matrix(Vj);
    I += own;
    B += force_matrix(momentum) - own * V_matrix - V_matrix.transpose() * own;
    F += own * A_.col(j) + cross_force(Vj, momentum);

    const Vector6 Is = I * s, Bs = B.transpose() * s;  // row j, columns up to j
    const Vector6 of_q = B * w + I * y + cross_force(s, F), of_qd = B * s + 2 * (I * w);  // column j, above
    for (int k = 0; k <= j; ++k) {
      M(j, k) = M(k, j) = Is.dot(J.col(k));
      T_q(j, k) = Bs.dot(w_.col(k)) + Is.dot(y_.col(k));
      T_qd(j, k) = Bs.dot(J.col(k)) + 2 * Is.dot(w_.col(k));
    }
    for (int k = 0; k < j; ++k) {
      T_q(k, j) = of_q.dot(J.col(k));
      T_qd(k, j) = of_qd.dot(J.col(k));
    }
    M(j, j) += arm_[n - j].J.d;
  }

  tip_velocity = V;
  // The tip's ordinary acceleration is that of the motion A and omega x v; the tip point moves by J's linear
  // rows.
  const Three omega = V.head<3>(), v = V.tail<3>(), omega_rate = A.head<3>();
  for (int j = 0; j < n; ++j) {
    const Vector6 s = J.col(j), w = w_.col(j), outer = V - V_.col(j);
    const Three dp = s.tail<3>();
    const Vector6 dV = cross(s, outer), dA = cross(s, Vector6(A - A_.col(j))) + cross(w, outer);
    const Three dv = dV.tail<3>() + omega.cross(dp), domega = dV.head<3>();
    V_q.col(j) = joined(domega, dv);
    A_q.col(j) =
        joined(dA.head<3>(), dA.tail<3>() + omega_rate.cross(dp) + domega.cross(v) + omega.cross(dv));
    const Vector6 by_rate = dV + w;
    A_qd.col(j) = joined(by_rate.head<3>(),
                         by_rate.tail<3>() + Three(s.head<3>()).cross(v) + omega.cross(Three(s.tail<3>())));
  }
}

void ArmSlopes::add_wrench_slopes(const Vector6& F, Eigen::Ref<MatrixX<double>> out) const {
  const Three moment = F.head<3>(), force = F.tail<3>();
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    const Three turn = J.col(j).head<3>(), shift = J.col(j).tail<3>();
    const Vector6 outside = -joined(turn.cross(moment), turn.cross(force));  // F does not turn with s_j
    const Vector6 inside = joined(shift.cross(force), Three::Zero());
    for (Eigen::Index k = 0; k < J.cols(); ++k) out(k, j) += J.col(k).dot(k >= j ? outside : inside);
  }
}

}  // namespace osculate
