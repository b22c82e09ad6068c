// What a joint with up to six axes does to spatial vectors: the products of hinge.hpp with H an m x 6 block.
// n counts links, not coordinates: D(k) is m x m, G(k) is 6 x m.
#pragma once

#include <array>

#include "spatial/psi.hpp"

namespace osculate {

/// Joint rates, accelerations or torques of one joint, m <= 6 of them in the order of its coordinates.
template <Field S>
struct JointVector {
  int m = 0;
  std::array<S, 6> at{};
  constexpr S& operator[](int i) { return at[static_cast<std::size_t>(i)]; }
  constexpr const S& operator[](int i) const { return at[static_cast<std::size_t>(i)]; }
  friend constexpr JointVector operator-(JointVector x) {
    for (int i = 0; i < x.m; ++i) x[i] = -x[i];
    return x;
  }
  friend constexpr JointVector operator+(JointVector x, const JointVector& y) {
    for (int i = 0; i < x.m; ++i) x[i] = x[i] + y[i];
    return x;
  }
  friend constexpr JointVector operator-(JointVector x, const JointVector& y) {
    for (int i = 0; i < x.m; ++i) x[i] = x[i] - y[i];
    return x;
  }
};

/// Symmetric m x m: D(k), J(k) and their inverses.
template <Field S>
struct JointInertia {
  int m = 0;
  std::array<std::array<S, 6>, 6> at{};
  constexpr S& operator()(int i, int j) {
    return at[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  constexpr const S& operator()(int i, int j) const {
    return at[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  friend constexpr JointInertia operator+(JointInertia a, const JointInertia& b) {
    for (int i = 0; i < a.m; ++i)
      for (int j = 0; j < a.m; ++j) a(i, j) = a(i, j) + b(i, j);
    return a;
  }
  friend constexpr JointVector<S> operator*(const JointInertia& a, const JointVector<S>& x) {
    JointVector<S> out{a.m, {}};
    for (int i = 0; i < a.m; ++i)
      for (int j = 0; j < a.m; ++j) out[i] = out[i] + a(i, j) * x[j];
    return out;
  }
};

/// L D L^T without pivoting of a positive definite D(k): field operations only. L is unit lower triangular.
template <Field S>
struct JointFactor {
  JointInertia<S> L;
  JointVector<S> pivots;
};
template <Field S>
constexpr JointFactor<S> factored(const JointInertia<S>& D) {
  JointFactor<S> f{{D.m, {}}, {D.m, {}}};
  for (int j = 0; j < D.m; ++j) {
    f.pivots[j] = D(j, j);
    for (int p = 0; p < j; ++p) f.pivots[j] = f.pivots[j] - f.L(j, p) * f.L(j, p) * f.pivots[p];
    for (int i = j + 1; i < D.m; ++i) {
      S t = D(i, j);
      for (int p = 0; p < j; ++p) t = t - f.L(i, p) * f.L(j, p) * f.pivots[p];
      f.L(i, j) = t / f.pivots[j];
    }
  }
  return f;
}
template <Field S>
constexpr JointInertia<S> inverse(const JointInertia<S>& D) {
  const JointFactor<S> f = factored(D);
  JointInertia<S> out{D.m, {}};
  for (int c = 0; c < D.m; ++c) {
    JointVector<S> y{D.m, {}};
    y[c] = S(1);
    for (int i = c + 1; i < D.m; ++i)
      for (int p = c; p < i; ++p) y[i] = y[i] - f.L(i, p) * y[p];
    for (int i = D.m - 1; i >= 0; --i) {
      y[i] = y[i] / f.pivots[i];
      for (int p = i + 1; p < D.m; ++p) y[i] = y[i] - f.L(p, i) * y[p];
    }
    for (int i = 0; i < D.m; ++i) out(i, c) = y[i];
  }
  return out;
}

/// 6 x m, by columns.
template <class Space, Field S>
struct Columns {
  int m = 0;
  std::array<Vec<Space, S>, 6> at{};
  constexpr Vec<Space, S>& operator[](int i) { return at[static_cast<std::size_t>(i)]; }
  constexpr const Vec<Space, S>& operator[](int i) const { return at[static_cast<std::size_t>(i)]; }
  friend constexpr Vec<Space, S> operator*(const Columns& A, const JointVector<S>& x) {
    Vec<Space, S> out;
    for (int i = 0; i < A.m; ++i) out = out + A[i] * x[i];
    return out;
  }
  friend constexpr Columns operator*(const Columns& A, const JointInertia<S>& D) {
    Columns out{A.m, {}};
    for (int i = 0; i < A.m; ++i)
      for (int j = 0; j < A.m; ++j) out[i] = out[i] + A[j] * D(j, i);
    return out;
  }
};
/// A* v: one number for each column.
template <class Space, Field S>
constexpr JointVector<S> transposed_times(const Columns<Space, S>& A, const Vec<typename Space::Dual, S>& v) {
  JointVector<S> out{A.m, {}};
  for (int i = 0; i < A.m; ++i) out[i] = dot(A[i], v);
  return out;
}
/// A B* + B A*
template <class Space, Field S>
constexpr Symmetric<Space, S> twice_outer(const Columns<Space, S>& A, const Columns<Space, S>& B) {
  Symmetric<Space, S> out;
  for (int i = 0; i < A.m; ++i) out = out + twice_outer(A[i], B[i]);
  return out;
}
/// A D A*
template <class Space, Field S>
constexpr Symmetric<Space, S> weighted_square(const Columns<Space, S>& A, const JointInertia<S>& D) {
  const S half = S(1) / S(2);
  Columns<Space, S> AD = A * D;
  for (int i = 0; i < A.m; ++i) AD[i] = AD[i] * half;
  return twice_outer(A, AD);
}

/// G(k), K(k+1,k): Force <- Torque. G(k) keeps the columns P H* that it comes from and, once it is set, D(k).
template <Field S>
struct JointGain {
  Columns<Force, S> columns, PH;
  JointInertia<S> D{};
  constexpr Star<JointGain> T() const { return {*this}; }
};

/// H(k), m x 6. The columns of H* are in the frame of link k (or the one frame of all links).
template <Field S, ShiftMap Phi = osculate::Shift<S>>
struct Joint {
  using Scalar = S;
  using Shift = Phi;
  using Coordinate = JointVector<S>;
  using JointInertia = osculate::JointInertia<S>;
  using JointMobility = osculate::JointInertia<S>;
  using Gain = JointGain<S>;
  Columns<Motion, S> axes;   // H*
  bool second_turns = false; /* universal joint: the second axis turns with the first */
  constexpr Star<Joint> T() const { return {*this}; }
};
/// Nothing to know beforehand but that there is a joint.
struct UnknownKind {
  template <class H>
  constexpr bool holds(const H& joint) const {
    return joint.axes.m > 0;
  }
  template <class H>
  constexpr const H& operator()(const H& joint) const {
    return joint;
  }
};
template <Field S, ShiftMap Phi, class Work>
constexpr void with_known_kind(const Joint<S, Phi>&, const Work& work) {
  work(UnknownKind());
}
template <Field S, ShiftMap Phi>
constexpr Vec<Motion, S> operator*(const Star<Joint<S, Phi>>& H, const JointVector<S>& rate) {
  return H.map.axes * rate;
}
template <Field S, ShiftMap Phi>
constexpr JointVector<S> operator*(const Joint<S, Phi>& H, const Vec<Force, S>& f) {
  return transposed_times(H.axes, f);
}
/// What the rate of H* within the joint adds to (48): the second axis of a universal joint turns about the
/// first. All other joints here have columns fixed in link k+1, or in link k and turning about themselves.
template <Field S, ShiftMap Phi>
constexpr Vec<Motion, S> with_inner_bias(const Joint<S, Phi>& H, const JointVector<S>& rate,
                                         const Vec<Motion, S>& a) {
  if (!H.second_turns) return a;
  const Vec3<S> turn = cross(H.axes[0].ang * rate[0], H.axes[1].ang * rate[1]);
  return {a.ang + turn, a.lin};
}

template <Field S>
struct InertiaTimesJoint {  // P H*
  Columns<Force, S> columns;
};
template <Field S, ShiftMap Phi>
constexpr InertiaTimesJoint<S> operator*(const Inertia<S>& P, const Star<Joint<S, Phi>>& H) {
  const auto& axes = H.map.axes;
  InertiaTimesJoint<S> out{{axes.m, {}}};
  for (int i = 0; i < axes.m; ++i) out.columns[i] = P * axes[i];
  return out;
}
/// H P H*: H * P waits for H.T().
template <Field S, ShiftMap Phi>
struct JointTimesInertia {
  const Joint<S, Phi>& H;
  const Inertia<S>& P;
};
template <Field S, ShiftMap Phi>
constexpr JointTimesInertia<S, Phi> operator*(const Joint<S, Phi>& H, const Inertia<S>& P) {
  return {H, P};
}
template <Field S, ShiftMap Phi>
constexpr JointInertia<S> operator*(const JointTimesInertia<S, Phi>& HP, const Star<Joint<S, Phi>>& H) {
  const Columns<Motion, S>& axes = HP.H.axes;
  const Columns<Force, S> PH = (HP.P * H).columns;
  JointInertia<S> out{axes.m, {}};
  for (int i = 0; i < axes.m; ++i)
    for (int j = 0; j < axes.m; ++j) {
      const S entry = dot(axes[i], PH[j]);
      out(i, j) = i == j ? entry : seeded(Fault::joint_block, entry);
    }
  return out;
}
template <Field S>
constexpr JointGain<S> operator*(const InertiaTimesJoint<S>& PH, const JointInertia<S>& Dinv) {
  return {PH.columns * Dinv, PH.columns, {}};
}
template <ShiftMap Phi, Field S>
constexpr JointGain<S> operator*(const Phi& phi, const JointGain<S>& G) {
  JointGain<S> out{{G.columns.m, {}}, {}, {}};
  for (int i = 0; i < G.columns.m; ++i) out.columns[i] = phi * G.columns[i];
  return out;
}
template <Field S>
constexpr Vec<Force, S> operator*(const JointGain<S>& G, const JointVector<S>& torque) {
  return G.columns * torque;
}
template <Field S>
constexpr JointVector<S> operator*(const Star<JointGain<S>>& G, const Vec<Motion, S>& V) {
  return transposed_times(G.map.columns, V);
}
/// K J K*
template <Field S>
struct JointGainTimesInertia {
  const JointGain<S>& K;
  const JointInertia<S>& J;
};
template <Field S>
constexpr JointGainTimesInertia<S> operator*(const JointGain<S>& K, const JointInertia<S>& J) {
  return {K, J};
}
template <Field S>
constexpr Inertia<S> operator*(const JointGainTimesInertia<S>& KJ, const Star<JointGain<S>>& K) {
  return weighted_square(K.map.columns, KJ.J);
}

/// H* D^-1: Motion <- Torque, and H* D^-1 H: Motion <- Force.
template <Field S, ShiftMap Phi>
struct JointCompliance {
  const Joint<S, Phi>& H;
  JointInertia<S> Dinv;
};
template <Field S, ShiftMap Phi>
constexpr JointCompliance<S, Phi> operator*(const Star<Joint<S, Phi>>& H, const JointInertia<S>& Dinv) {
  return {H.map, Dinv};
}
template <Field S, ShiftMap Phi>
constexpr Vec<Motion, S> operator*(const JointCompliance<S, Phi>& HD, const JointVector<S>& torque) {
  return HD.H.axes * (HD.Dinv * torque);
}
template <Field S, ShiftMap Phi>
constexpr Compliance<S> operator*(const JointCompliance<S, Phi>& HD, const Joint<S, Phi>& H) {
  return weighted_square(H.axes, HD.Dinv);
}

/// (1 - G H) P for G = P H* D^-1 with any D: P - G (H P) - (P H* - G D) G*, symmetric as a whole; see
/// hinge.hpp.
template <Field S, ShiftMap Phi>
constexpr Inertia<S> stripped(Inertia<S> P, const JointGain<S>& G, const Joint<S, Phi>&) {
  const Columns<Force, S> GD = G.columns * G.D;
  for (int i = 0; i < G.columns.m; ++i) {
    P = less_outer(P, G.columns[i], seeded(Fault::joint_strip_inertia, G.PH[i]));
    P = less_outer(P, G.PH[i] - GD[i], G.columns[i]);
  }
  return P;
}
/// (1 - G H)* X (1 - G H) = X - H* (G* X) - (X G) H + H* (G* X G) H.
template <Field S, ShiftMap Phi>
constexpr Compliance<S> stripped(const Compliance<S>& X, const JointGain<S>& G, const Joint<S, Phi>& H) {
  const int m = G.columns.m;
  Columns<Motion, S> XG{m, {}};
  for (int i = 0; i < m; ++i) XG[i] = X * G.columns[i];
  JointInertia<S> GXG{m, {}};
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) GXG(i, j) = dot(XG[i], G.columns[j]);
  return X - seeded(Fault::joint_strip_compliance, twice_outer(H.axes, XG)) + weighted_square(H.axes, GXG);
}

}  // namespace osculate
