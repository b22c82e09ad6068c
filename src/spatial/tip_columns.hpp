// Six unit forces on the tip, carried along the arm side by side: X(k) = psi(k,0), column j from unit force j
// in the order (moments x y z; forces x y z). With E(k) = H(k) X(k),
//   Omega(0) = sum over k of E(k)* D(k)^-1 E(k),
// which is B* psi* H* D^-1 H psi B written out: (58) and (60) in one sum.
#pragma once

#include <array>

#include "spatial/hinge.hpp"
#include "spatial/joint.hpp"

namespace osculate {

/// Six numbers, one for each unit force on the tip.
template <Field S>
struct SixRow {
  std::array<S, 6> at{};
  constexpr SixRow() = default;
  constexpr SixRow(const S& a, const S& b, const S& c, const S& d, const S& e, const S& f)
      : at{a, b, c, d, e, f} {}
  constexpr const S& operator[](int i) const { return at[static_cast<std::size_t>(i)]; }
};
/// sum + row s
template <Field S>
constexpr SixRow<S> plus_scaled(SixRow<S> sum, const SixRow<S>& row, const S& s) {
#pragma GCC unroll 6
  for (std::size_t i = 0; i < 6; ++i) sum.at[i] = sum.at[i] + row.at[i] * s;
  return sum;
}
/// sum - row s
template <Field S>
constexpr SixRow<S> less_scaled(SixRow<S> sum, const SixRow<S>& row, const S& s) {
#pragma GCC unroll 6
  for (std::size_t i = 0; i < 6; ++i) sum.at[i] = sum.at[i] - row.at[i] * s;
  return sum;
}

/// Omega(0) while it is summed: a symmetric map Motion <- Force at the tip.
template <Field S>
struct TipMobility {
  std::array<SixRow<S>, 6> row;  // the lower triangle
  constexpr S entry(int i, int j) const {
    return row[static_cast<std::size_t>(i > j ? i : j)][i > j ? j : i];
  }
};
/// sum + a^T b where the whole sum is symmetric by construction
template <Field S>
constexpr TipMobility<S> plus_outer(TipMobility<S> sum, const SixRow<S>& a, const SixRow<S>& b) {
#pragma GCC unroll 6
  for (std::size_t i = 0; i < 6; ++i)
#pragma GCC unroll 6
    for (std::size_t j = 0; j <= i; ++j) sum.row[i].at[j] = sum.row[i].at[j] + a.at[i] * b.at[j];
  return sum;
}

}  // namespace osculate

#if defined(__AVX2__) && defined(__FMA__)
#include "spatial/tip_columns_avx.hpp"
#elif defined(__SSE2__) || defined(__aarch64__)
#include "spatial/tip_columns_pairs.hpp"
#endif

namespace osculate {

template <Field S>
constexpr SixRow<S> operator*(const SixRow<S>& a, const S& s) {
  return plus_scaled(SixRow<S>(), a, s);
}
template <Field S>
constexpr Compliance<S> compliance_of(const TipMobility<S>& a) {
  const auto row = [&](int i) { return Vec3<S>{a.entry(i, 3), a.entry(i, 4), a.entry(i, 5)}; };
  const auto block = [&](int i) {
    return Sym3<S>{a.entry(i, i),         a.entry(i, i + 1),     a.entry(i, i + 2),
                   a.entry(i + 1, i + 1), a.entry(i + 1, i + 2), a.entry(i + 2, i + 2)};
  };
  return {block(0), {row(0), row(1), row(2)}, block(3)};
}

/// A motion of the tip in six numbers.
template <Field S>
constexpr Vec<Motion, S> motion_of(const SixRow<S>& a) {
  return {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}};
}

/// E(k) = H(k) X(k): Torque <- Force on the tip.
template <Field S>
struct HingeRow {
  SixRow<S> row;
  constexpr Star<HingeRow> T() const { return {*this}; }
};
template <Field S>
struct JointRows {
  int m = 0;
  std::array<SixRow<S>, 6> row;
  constexpr Star<JointRows> T() const { return {*this}; }
};

/// X(k), by rows: the six carried forces about O(k).
template <Field S>
struct TipColumns {
  struct Half {
    SixRow<S> x, y, z;
  };
  Half ang, lin;
  constexpr Star<TipColumns> T() const { return {*this}; }
};
/// X(1) = phi(1,0)
template <Field S>
constexpr TipColumns<S> tip_columns(const Shift<S>& phi) {
  const auto& [x, y, z] = std::array<S, 3>{phi.l.x, phi.l.y, phi.l.z};
  const S o(0), i(1);
  return {{{i, o, o, o, -z, y}, {o, i, o, z, o, -x}, {o, o, i, -y, x, o}},
          {{o, o, o, i, o, o}, {o, o, o, o, i, o}, {o, o, o, o, o, i}}};
}
/// sum + v^T X for one half of X
template <Field S>
constexpr SixRow<S> plus_combined(const SixRow<S>& sum, const Vec3<S>& v,
                                  const typename TipColumns<S>::Half& X) {
  const auto& by = multipliers(v);
  return plus_scaled(plus_scaled(plus_scaled(sum, X.x, by.x), X.y, by.y), X.z, by.z);
}
template <Field S>
constexpr SixRow<S> dot(const Vec3<S>& v, const typename TipColumns<S>::Half& X) {
  const auto& by = multipliers(v);
  return plus_scaled(plus_scaled(X.x * by.x, X.y, by.y), X.z, by.z);
}
/// X* V
template <Field S>
constexpr SixRow<S> operator*(const Star<TipColumns<S>>& X, const Vec<Motion, S>& V) {
  return plus_combined(dot(V.ang, X.map.ang), V.lin, X.map.lin);
}
template <Field S>
constexpr SixRow<S> operator+(const SixRow<S>& a, const SixRow<S>& b) {
  return plus_scaled(a, b, S(1));
}
template <Field S>
constexpr SixRow<S> operator-(const SixRow<S>& a, const SixRow<S>& b) {
  return less_scaled(a, b, S(1));
}

template <Field S>
constexpr HingeRow<S> operator*(const Hinge<S>& H, const TipColumns<S>& X) {
  return {dot(H.h, H.turns() ? X.ang : X.lin)};
}
template <Field S>
constexpr JointRows<S> operator*(const Joint<S>& H, const TipColumns<S>& X) {
  JointRows<S> E{H.axes.m, {}};
  for (int i = 0; i < E.m; ++i) E.row[static_cast<std::size_t>(i)] = X.T() * H.axes[i];
  return E;
}

/// X - G E: X - G * E waits for X.
template <Field S, class G, class E>
struct GainRows {
  const G& gain;
  const E& rows;
};
template <Field S>
constexpr GainRows<S, HingeGain<S>, HingeRow<S>> operator*(const HingeGain<S>& G, const HingeRow<S>& E) {
  return {G, E};
}
template <Field S>
constexpr GainRows<S, JointGain<S>, JointRows<S>> operator*(const JointGain<S>& G, const JointRows<S>& E) {
  return {G, E};
}
/// X - g e for one column g of G and one row e of E
template <Field S>
constexpr TipColumns<S> less_outer(const TipColumns<S>& X, const Vec<Force, S>& g, const SixRow<S>& e) {
  const auto half = [&](const typename TipColumns<S>::Half& a, const Vec3<S>& v) ->
      typename TipColumns<S>::Half {
        const auto& by = multipliers(v);
        return {less_scaled(a.x, e, by.x), less_scaled(a.y, e, by.y), less_scaled(a.z, e, by.z)};
      };
  return {half(X.ang, g.ang), half(X.lin, g.lin)};
}
template <Field S>
constexpr TipColumns<S> operator-(const TipColumns<S>& X, const GainRows<S, HingeGain<S>, HingeRow<S>>& GE) {
  return less_outer(X, GE.gain.column, GE.rows.row);
}
template <Field S>
constexpr TipColumns<S> operator-(TipColumns<S> X, const GainRows<S, JointGain<S>, JointRows<S>>& GE) {
  for (int i = 0; i < GE.rows.m; ++i)
    X = less_outer(X, GE.gain.columns[i], GE.rows.row[static_cast<std::size_t>(i)]);
  return X;
}
/// phi X
template <Field S>
constexpr TipColumns<S> operator*(const Shift<S>& phi, const TipColumns<S>& X) {
  const auto& l = multipliers(phi.l);
  const auto& [ang, lin] = X;
  return {{less_scaled(plus_scaled(ang.x, lin.z, l.y), lin.y, l.z),
           less_scaled(plus_scaled(ang.y, lin.x, l.z), lin.z, l.x),
           less_scaled(plus_scaled(ang.z, lin.y, l.x), lin.x, l.y)},
          lin};
}

/// E* tau: what joint torques tau do at the tip.
template <Field S>
constexpr SixRow<S> operator*(const Star<HingeRow<S>>& E, const S& torque) {
  return E.map.row * torque;
}
template <Field S>
constexpr SixRow<S> operator*(const Star<JointRows<S>>& E, const JointVector<S>& torque) {
  SixRow<S> out;
  for (int i = 0; i < E.map.m; ++i) out = plus_scaled(out, E.map.row[static_cast<std::size_t>(i)], torque[i]);
  return out;
}

/// E* D^-1 E: E.T() * D^-1 waits for E, and the product for a sum.
template <class E, class Mobility>
struct RowsMobility {
  const E& rows;
  const Mobility& Dinv;
};
template <Field S>
constexpr RowsMobility<HingeRow<S>, HingeMobility<S>> operator*(const Star<HingeRow<S>>& E,
                                                                const HingeMobility<S>& Dinv) {
  return {E.map, Dinv};
}
template <Field S>
constexpr RowsMobility<JointRows<S>, JointInertia<S>> operator*(const Star<JointRows<S>>& E,
                                                                const JointInertia<S>& Dinv) {
  return {E.map, Dinv};
}
template <class E, class Mobility>
struct RowsSquare {
  const E& rows;
  const Mobility& Dinv;
};
template <class E, class Mobility>
constexpr RowsSquare<E, Mobility> operator*(const RowsMobility<E, Mobility>& left, const E&) {
  return {left.rows, left.Dinv};
}
template <Field S>
constexpr TipMobility<S> operator+(const TipMobility<S>& sum,
                                   const RowsSquare<HingeRow<S>, HingeMobility<S>>& square) {
  return plus_outer(sum, square.rows.row, square.rows.row * square.Dinv.d);
}
template <Field S>
constexpr TipMobility<S> operator+(TipMobility<S> sum,
                                   const RowsSquare<JointRows<S>, JointInertia<S>>& square) {
  const auto& [E, Dinv] = square;
  for (int i = 0; i < E.m; ++i) {
    SixRow<S> DE;
    for (int j = 0; j < E.m; ++j) DE = plus_scaled(DE, E.row[static_cast<std::size_t>(j)], Dinv(i, j));
    sum = plus_outer(sum, E.row[static_cast<std::size_t>(i)], DE);
  }
  return sum;
}

}  // namespace osculate
