// The paper's operators as the full matrices it writes down, 6n x 6n with their zeros, for an arm in a state.
// Built from the geometry and the Newton-Euler quantities of dense.hpp; nothing is shared with the
// recursions. Equation numbers: Kreutz-Delgado, Jain & Rodriguez (1992). Links are numbered as there, 1
// outermost to n innermost, 0 the tip point, n + 1 the base: here alone the order of Chain is reversed.
// Inertial frame, six numbers per link about O(k), angular rows first.
//
// Three things go beyond the paper, and reduce to it where they are absent. A joint may have up to six
// velocities: H(k) then has as many rows. Motors may have inertia Jm (diagonal): D = H P H* + Jm and P gains
// K Jm K*. The base may move as told: a(n) then contains phi*(n+1,n) times its acceleration.
#pragma once

#include <cmath>
#include <concepts>
#include <vector>

#include "reference/dense.hpp"
#include "scalar/rational_product.hpp"

namespace osculate::dense {

/// A matrix that remembers how large the terms were whose sum it is: `size` is |A| for a given matrix, |A|
/// |B| for a product, |A| + |B| for a sum, all by entries. eps times size is the scale of rounding where
/// terms cancel. Kept for floating-point scalars only; empty otherwise.
template <Field S>
struct Operator {
  MatrixX<S> value;
  MatrixX<S> size;

  Operator() = default;
  template <class Derived>
  Operator(const Eigen::MatrixBase<Derived>& v) : value(v) {
    if constexpr (std::floating_point<S>) size = value.cwiseAbs();
  }
  Operator(MatrixX<S> v, MatrixX<S> s) : value(std::move(v)), size(std::move(s)) {}

  Eigen::Index rows() const { return value.rows(); }
  Eigen::Index cols() const { return value.cols(); }
  /// The adjoint, A*.
  Operator T() const { return {value.transpose(), size.transpose()}; }
  Operator block(Eigen::Index i, Eigen::Index j, Eigen::Index r, Eigen::Index c) const {
    if constexpr (std::floating_point<S>) return {value.block(i, j, r, c), size.block(i, j, r, c)};
    return {value.block(i, j, r, c), {}};
  }
};

/// A B.
template <Field S>
MatrixX<S> product(const MatrixX<S>& A, const MatrixX<S>& B) {
  if constexpr (std::same_as<S, Rational>)
    return osculate::product(A, B);
  else
    return A * B;
}

template <Field S>
Operator<S> operator*(const Operator<S>& A, const Operator<S>& B) {
  return {product(A.value, B.value), product(A.size, B.size)};
}
template <Field S>
Operator<S> operator+(const Operator<S>& A, const Operator<S>& B) {
  return {A.value + B.value, A.size + B.size};
}
template <Field S>
Operator<S> operator-(const Operator<S>& A, const Operator<S>& B) {
  return {A.value - B.value, A.size + B.size};
}

/// The identity of the given size.
template <Field S>
Operator<S> one(Eigen::Index n) {
  return MatrixX<S>(MatrixX<S>::Identity(n, n));
}

/// A^-1 of a positive definite A. An error dA of A is one of A^-1 dA A^-1, so the size is that of A^-1 A
/// A^-1.
template <Field S>
Operator<S> inverse(const Operator<S>& A) {
  const Operator<S> inverse = solve(factor(A.value), one<S>(A.rows()).value);
  return {inverse.value, (inverse * A * inverse).size};
}

/// What the definitions of mechanics say, joints tip first like the operators. n links, m joint velocities.
template <Field S>
struct Definitions {
  Operator<S> J;        // 6 x m                                                                  (7)
  Operator<S> M;        // m x m, joint-space mass matrix                                         (6)
  Operator<S> M_inv;    // m x m
  Operator<S> C, G;     // m x 1                                                                  (6)
  Operator<S> Jdot_qd;  // 6 x 1                                                                  (8)
  Operator<S> V;        // 6n x 1, velocities of the links at O(k)
  Operator<S> V_tip;    // 6 x 1
};

/// n links, m joint velocities, joints and links tip first.
template <Field S>
struct Operators {
  int n = 0;
  std::vector<int> row;           // row[k-1]: first of joint k's rows in joint space; row[n] = m
  std::vector<JointType> type;    // type[k-1]
  std::vector<Vector3<S>> O;      // m, O[k] for k = 0 ... n+1
  std::vector<Matrix3<S>> I_com;  // kg m^2, I_com[k-1] about the centre of mass
  std::vector<Vector3<S>> p;      // m, p[k-1], centre of mass from O(k)
  std::vector<S> mass;            // kg, mass[k-1]

  Operator<S> H;      // m x 6n                                                                 (17)
  Operator<S> E_phi;  // 6n x 6n                                                                (18)
  Operator<S> M;      // 6n x 6n, I about O(k)                                                  (20)
  Operator<S> B;      // 6n x 6                                                                 (21)
  Operator<S> E;      // 6 x 6n                                                                 (22)
  Operator<S> phi;    // 6n x 6n                                                                (23)
  Operator<S> P;      // 6n x 6n                                                                (24)
  Operator<S> D;      // m x m                                                                  (25)
  Operator<S> D_inv;  // m x m
  Operator<S> G;      // 6n x m                                                                 (26)
  Operator<S> K;      // 6n x m                                                                 (27)
  Operator<S> E_psi;  // 6n x 6n                                                                (28)
  Operator<S> psi;    // 6n x 6n                                                                (29)
  Operator<S> W;      // 6 x 6n                                                                 (34)
  Operator<S> Omega;  // 6n x 6n                                                                (57)
  Operator<S> Jm;     // m x m, inertia of the motors

  Operator<S> thd;             // m x 1
  Operator<S> V_base, A_base;  // 6 x 1, V(n+1) and its derivative; 0 for a base at rest
  Operator<S> a;               // 6n x 1, accelerations at thdd = 0 less what the inboard link hands on
  Operator<S> a_tip;           // 6 x 1, a(0)
  Operator<S> b;               // 6n x 1, forces at thdd = 0 less M times the acceleration
  Operator<S> a_g;             // 6 x 1, minus the acceleration of free fall
  Definitions<S> dense;

  int m() const { return row.back(); }
  int rows_of(int k) const { return row[static_cast<std::size_t>(k)] - first(k); }
  int first(int k) const { return row[static_cast<std::size_t>(k - 1)]; }
  /// Blocks of operators between link spaces, between joint spaces, and from one to the other.
  Operator<S> link_block(const Operator<S>& A, int i, int j) const {
    return A.block(6 * (i - 1), 6 * (j - 1), 6, 6);
  }
  Operator<S> joint_block(const Operator<S>& A, int k) const {
    return A.block(first(k), first(k), rows_of(k), rows_of(k));
  }
  Operator<S> H_block(int k) const { return H.block(first(k), 6 * (k - 1), rows_of(k), 6); }
  Operator<S> column_block(const Operator<S>& A, int i, int k) const {
    return A.block(6 * (i - 1), first(k), 6, rows_of(k));
  }
};

/// phi(i,j) moves a force from O(j) to O(i): [1 l~; 0 1], l = O(j) - O(i), for any i and j.        (19)
template <Field S>
Operator<S> shift(const Operators<S>& x, int i, int j) {
  MatrixX<S> out = MatrixX<S>::Identity(6, 6);
  const Vector3<S> l = x.O[static_cast<std::size_t>(j)] - x.O[static_cast<std::size_t>(i)];
  out.template topRightCorner<3, 3>() = cross_matrix(l);
  return out;
}

/// psi(i,j) = psi(i,i-1) ... psi(j+1,j) at [i][j], n + 1 >= i >= j >= 0.                            (35)
template <Field S>
std::vector<std::vector<Operator<S>>> articulated_shifts(const Operators<S>& x) {
  std::vector<std::vector<Operator<S>>> psi{{one<S>(6)}};
  for (int i = 1; i <= x.n + 1; ++i) {
    Operator<S> step = shift(x, 1, 0);  // psi(1,0) = phi(1,0)
    if (i > 1) step = i <= x.n ? x.link_block(x.E_psi, i, i - 1) : x.W.block(0, 6 * (x.n - 1), 6, 6);
    std::vector<Operator<S>> row;
    for (const Operator<S>& before : psi.back()) row.push_back(step * before);
    row.push_back(one<S>(6));
    psi.push_back(std::move(row));
  }
  return psi;
}

namespace internal {

/// A block and where its first entry goes.
template <Field S>
struct Piece {
  Eigen::Index row, column;
  Operator<S> block;
};

/// The matrix with the given blocks and zeros elsewhere.
template <Field S>
Operator<S> assembled(Eigen::Index rows, Eigen::Index cols, const std::vector<Piece<S>>& pieces) {
  const MatrixX<S> zero = MatrixX<S>::Zero(rows, cols);
  Operator<S> out(zero);
  for (const auto& [r, c, block] : pieces) {
    out.value.block(r, c, block.rows(), block.cols()) = block.value;
    if constexpr (std::floating_point<S>) out.size.block(r, c, block.rows(), block.cols()) = block.size;
  }
  return out;
}

/// (1 - E)^-1 of a strictly lower block bidiagonal E, by forward substitution.
template <Field S>
MatrixX<S> propagated(const MatrixX<S>& E, int n) {
  MatrixX<S> X = MatrixX<S>::Identity(6 * n, 6 * n);
  for (int k = 1; k < n; ++k)
    X.block(6 * k, 0, 6, 6 * k) =
        product<S>(E.block(6 * k, 6 * (k - 1), 6, 6), X.block(6 * (k - 1), 0, 6, 6 * k));
  return X;
}

/// H, E_phi, M, B, E, Jm, and what they are made of.
template <Field S>
void fill_geometry(const Chain<S>& chain, const Places<Dual<S>>& at, Operators<S>& x) {
  const int n = chain.n(), m = chain.velocities();
  x.n = n;
  x.O.push_back(values(at.tip.p));
  x.row.push_back(0);
  for (int k = 1; k <= n; ++k) {
    const auto link = static_cast<std::size_t>(n - k);
    x.type.push_back(chain.links[link].type);
    x.row.push_back(x.row.back() + velocity_count(x.type.back()));
    x.O.push_back(values(at.links[link].origin));
  }
  x.O.push_back(values(at.base.p));

  MatrixX<S> H = MatrixX<S>::Zero(m, 6 * n), M = MatrixX<S>::Zero(6 * n, 6 * n), E_phi = M;
  MatrixX<S> Jm = MatrixX<S>::Zero(m, m), B = MatrixX<S>::Zero(6 * n, 6), E = MatrixX<S>::Zero(6, 6 * n);
  for (int k = 1; k <= n; ++k) {
    const Link<S>& link = chain.links[static_cast<std::size_t>(n - k)];
    const LinkPlace<Dual<S>>& place = at.links[static_cast<std::size_t>(n - k)];
    const int o = 6 * (k - 1);
    for (int j = 0; j < x.rows_of(k); ++j)
      H.block(x.first(k) + j, o, 1, 6) = values(unit_motion(place, j)).transpose();
    if (one_axis(link.type)) Jm(x.first(k), x.first(k)) = link.armature;

    const Matrix3<S> R = values(place.R);
    x.mass.push_back(link.mass);
    x.I_com.push_back(R * link.inertia * R.transpose());
    x.p.push_back(values(place.com) - x.O[static_cast<std::size_t>(k)]);
    const Matrix3<S> p = cross_matrix(x.p.back());
    M.block(o, o, 3, 3) = x.I_com.back() - link.mass * p * p;
    M.block(o, o + 3, 3, 3) = link.mass * p;
    M.block(o + 3, o, 3, 3) = -link.mass * p;
    M.block(o + 3, o + 3, 3, 3) = link.mass * Matrix3<S>::Identity();
    if (k > 1) E_phi.block(o, o - 6, 6, 6) = shift(x, k, k - 1).value;
  }
  B.topRows(6) = shift(x, 1, 0).value;
  E.rightCols(6) = shift(x, n + 1, n).value;
  x.H = H, x.M = M, x.E_phi = E_phi, x.Jm = Jm, x.B = B, x.E = E;
}

/// P, D, G, K, E_psi and W, which define each other: (24) to (28) link by link; and Omega, (57).
template <Field S>
void fill_articulated(Operators<S>& x) {
  const int n = x.n, m = x.m();
  MatrixX<S> P = x.M.value, Omega = MatrixX<S>::Zero(6 * n, 6 * n);
  MatrixX<S> D = MatrixX<S>::Zero(m, m), K = MatrixX<S>::Zero(6 * n, m);
  std::vector<Piece<S>> G, D_inv, E_psi, W;
  for (int k = 1; k <= n; ++k) {
    const int o = 6 * (k - 1), r = x.first(k), s = x.rows_of(k);
    const MatrixX<S> Hk = x.H_block(k).value;
    const MatrixX<S> Jk = x.joint_block(x.Jm, k).value;
    if (k > 1) {
      const int out = x.first(k - 1), rows = x.rows_of(k - 1);
      const MatrixX<S>&psi = E_psi.back().block.value, moved = K.block(o, out, 6, rows);
      P.block(o, o, 6, 6) += psi * P.block(o - 6, o - 6, 6, 6) * psi.transpose() +
                             moved * x.joint_block(x.Jm, k - 1).value * moved.transpose();
    }
    const MatrixX<S> PH = P.block(o, o, 6, 6) * Hk.transpose();
    const MatrixX<S> Dk = Hk * PH + Jk;
    D.block(r, r, s, s) = Dk;
    const Operator<S> Dk_inv = inverse(Operator<S>(Dk)), gain = Operator<S>(PH) * Dk_inv;
    D_inv.push_back({r, r, Dk_inv});
    G.push_back({o, r, gain});
    const Operator<S> phi = shift(x, k + 1, k), psi = phi * (one<S>(6) - gain * Operator<S>(Hk));
    if (k < n) {
      K.block(o + 6, r, 6, s) = phi.value * gain.value;
      E_psi.push_back({o + 6, o, psi});
    } else {
      W.push_back({0, o, psi});
    }
  }
  x.P = P, x.D = D, x.K = K;
  x.E_psi = assembled(6 * n, 6 * n, E_psi);
  x.W = assembled(6, 6 * n, W);
  x.D_inv = assembled(m, m, D_inv);
  x.G = assembled(6 * n, m, G);
  for (int k = n; k >= 1; --k) {
    const int o = 6 * (k - 1);
    const MatrixX<S> Hk = x.H_block(k).value;
    Omega.block(o, o, 6, 6) = Hk.transpose() * x.joint_block(x.D_inv, k).value * Hk;
    if (k == n) continue;
    const MatrixX<S>& psi = E_psi[static_cast<std::size_t>(k - 1)].block.value;
    Omega.block(o, o, 6, 6) += psi.transpose() * Omega.block(o + 6, o + 6, 6, 6) * psi;
  }
  x.Omega = Omega;
  x.phi = propagated(x.E_phi.value, n);
  x.psi = propagated(x.E_psi.value, n);
}

/// How large the terms are that the velocity and the acceleration of O(k) are sums of: the motions of all
/// joints inboard, and what they do over the whole way from the base. Their sums may cancel to nothing.
template <Field S>
struct MotionSizes {
  MatrixX<S> V, A;  // 6 x 1; empty for exact scalars
  S turning = S(0);
};
template <Field S>
MotionSizes<S> motion_sizes(const Operators<S>& x, const PointMotion<S>& here, const VectorX<S>& qd, int k,
                            const Vector6<S>& base_velocity, const Vector6<S>& base_acceleration) {
  MotionSizes<S> out;
  if constexpr (std::floating_point<S>) {
    out.V = here.J.cwiseAbs() * qd.head(here.J.cols()).cwiseAbs() + base_velocity.cwiseAbs();
    S way(0);  // m
    for (int j = k; j <= x.n; ++j)
      way += (x.O[static_cast<std::size_t>(j)] - x.O[static_cast<std::size_t>(j + 1)]).norm();
    out.turning = out.V.topRows(3).maxCoeff();
    const S moving = out.V.bottomRows(3).maxCoeff() + out.turning * way;
    out.A.resize(6, 1);
    out.A.topRows(3).setConstant(out.turning * out.turning + base_acceleration.head(3).cwiseAbs().maxCoeff());
    out.A.bottomRows(3).setConstant(out.turning * moving + base_acceleration.tail(3).cwiseAbs().maxCoeff() +
                                    base_acceleration.head(3).cwiseAbs().maxCoeff() * way);
  }
  return out;
}

/// V, a, a(0) and b from the motion of the points O(k) and the centres of mass, by dual numbers.
template <Field S>
void fill_motion(const Chain<S>& chain, const Places<Dual<S>>& at, const VectorX<S>& qd, Operators<S>& x) {
  const int n = x.n;
  std::vector<Piece<S>> V, a, b;
  MotionSizes<S> sizes;
  Operator<S> inboard = MatrixX<S>(MatrixX<S>::Zero(6, 1));  // A(n+1); the base's own stays in a(n)
  for (int k = n; k >= 1; --k) {
    const int o = 6 * (k - 1);
    const auto i = static_cast<std::size_t>(k - 1);
    const LinkPlace<Dual<S>>& place = at.links[static_cast<std::size_t>(n - k)];
    const PointMotion<S> here = point_motion(at, qd, place.origin, n - k + 1);
    const PointMotion<S> com = point_motion(at, qd, place.com, n - k + 1);
    sizes = motion_sizes<S>(x, here, qd, k, values(at.base_velocity), derivatives(at.base_velocity));
    const Operator<S> A(MatrixX<S>(here.Jdot_qd), sizes.A);
    V.push_back({o, 0, Operator<S>(MatrixX<S>(here.V), sizes.V)});
    a.push_back({o, 0, A - shift(x, k + 1, k).T() * inboard});
    // Newton and Euler at the centre of mass; the force moved to O(k).
    const Vector3<S> w = com.V.template head<3>();
    const Vector3<S> Iw = x.I_com[i] * w;
    const Vector3<S> force = x.mass[i] * com.Jdot_qd.template tail<3>();
    Vector6<S> total;
    total << x.I_com[i] * com.Jdot_qd.template head<3>() + w.cross(Iw) + x.p[i].cross(force), force;
    b.push_back({o, 0, Operator<S>(total) - x.link_block(x.M, k, k) * A});
    inboard = A;
  }
  const Vector3<S> w = V.back().block.value.topRows(3);
  Vector6<S> a_tip = Vector6<S>::Zero(), a_g = Vector6<S>::Zero();
  a_tip.template tail<3>() = w.cross(w.cross(Vector3<S>(x.O[0] - x.O[1])));
  a_g.template tail<3>() = -chain.gravity;
  x.dense.V = assembled(6 * n, 1, V);
  x.a = assembled(6 * n, 1, a);
  x.b = assembled(6 * n, 1, b);
  x.a_tip = a_tip, x.a_g = a_g;
  if constexpr (std::floating_point<S>)
    x.a_tip.size.bottomRows(3).setConstant(sizes.turning * sizes.turning * (x.O[0] - x.O[1]).norm());
  x.V_base = values(at.base_velocity);
  x.A_base = derivatives(at.base_velocity);
}

}  // namespace internal

/// All operators of an arm in a state, and what they are compared with. positions.size() == chain.n(),
/// qd.size() == chain.velocities(). Divides by the pivots of D(k) and of the joint-space mass matrix only.
template <Field S>
Operators<S> operators(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
                       const BaseMotion<S>& base = {}) {
  const Places<Dual<S>> at = moving_places(chain, positions, qd, base);
  Operators<S> x;
  internal::fill_geometry(chain, at, x);
  internal::fill_articulated(x);
  internal::fill_motion(chain, at, qd, x);

  std::vector<int> order;  // order[i]: place in the base-to-tip order of what is i-th here
  int first = x.m();
  for (int k = 1; k <= x.n; ++k) {
    first -= x.rows_of(k);
    for (int j = 0; j < x.rows_of(k); ++j) order.push_back(first + j);
  }
  const Kinematics<S> tip = kinematics(chain, at, qd);
  const JointSpace<S> joint = joint_space(chain, at, qd);
  x.thd = qd(order);
  x.dense.J = tip.J(Eigen::all, order);
  x.dense.M = joint.M(order, order);
  x.dense.M_inv = inverse(x.dense.M);
  x.dense.C = joint.C(order);
  x.dense.G = joint.G(order);
  x.dense.Jdot_qd = tip.Jdot_qd;
  x.dense.V_tip = tip.tip_velocity;
  return x;
}

// Compiled once: double in operators.cpp, fractions in exact.cpp.
#define OSCULATE_OPERATORS(how, S)                                                             \
  how template Operator<S> operator*(const Operator<S>&, const Operator<S>&);                  \
  how template Operator<S> operator+(const Operator<S>&, const Operator<S>&);                  \
  how template Operator<S> operator-(const Operator<S>&, const Operator<S>&);                  \
  how template Operator<S> one(Eigen::Index);                                                  \
  how template Operator<S> inverse(const Operator<S>&);                                        \
  how template Operator<S> shift(const Operators<S>&, int, int);                               \
  how template std::vector<std::vector<Operator<S>>> articulated_shifts(const Operators<S>&);  \
  how template Operator<S> internal::assembled(Eigen::Index, Eigen::Index,                     \
                                               const std::vector<internal::Piece<S>>&);        \
  how template Operators<S> operators(const Chain<S>&, const Positions<S>&, const VectorX<S>&, \
                                      const BaseMotion<S>&)
OSCULATE_OPERATORS(extern, double);

}  // namespace osculate::dense
