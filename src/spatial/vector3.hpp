// Three-vectors and 3 x 3 matrices over any Field, as plain structs: no heap, no comparison, no expression
// templates. For doubles vector3_avx.hpp has the same functions on AVX registers, where the build allows it,
// and vector3_pairs.hpp on those of two lanes; vector3_packet.hpp has constants for packets. Whoever wants
// the entries of a matrix, whatever it is made of, asks `entry` or `rows_of`.
#pragma once

#include <array>
#include <utility>

#include "scalar/fault.hpp"
#include "scalar/field.hpp"

namespace osculate {

template <Field S>
struct Vec3 {
  S x = S(0), y = S(0), z = S(0);
};

template <Field S>
struct Mat3 {  // by rows
  Vec3<S> x, y, z;
};

template <Field S>
struct Sym3 {  // symmetric
  S xx = S(0), xy = S(0), xz = S(0), yy = S(0), yz = S(0), zz = S(0);
};

template <Field S>
constexpr Vec3<S> operator+(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <Field S>
constexpr Vec3<S> operator-(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <Field S>
constexpr Vec3<S> operator-(const Vec3<S>& a) {
  return {-a.x, -a.y, -a.z};
}
template <Field S>
constexpr Vec3<S> operator*(const Vec3<S>& a, const S& s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <Field S>
constexpr S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// a.b + c.d
template <Field S>
constexpr S dot(const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c, const Vec3<S>& d) {
  return dot(a, b) + dot(c, d);
}
template <Field S>
constexpr Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return seeded(Fault::spatial_cross,
                Vec3<S>{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x});
}
/// sum + a x b
template <Field S>
constexpr Vec3<S> plus_cross(const Vec3<S>& sum, const Vec3<S>& a, const Vec3<S>& b) {
  return sum + cross(a, b);
}
/// Factors for the components of v: the numbers, or each of them in every lane of a register.
template <Field S>
constexpr const Vec3<S>& multipliers(const Vec3<S>& v) {
  return v;
}

template <Field S>
constexpr Mat3<S> operator+(const Mat3<S>& a, const Mat3<S>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <Field S>
constexpr Mat3<S> operator-(const Mat3<S>& a, const Mat3<S>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <Field S>
constexpr Mat3<S> operator-(const Mat3<S>& a) {
  return {-a.x, -a.y, -a.z};
}
template <Field S>
constexpr Mat3<S> operator*(const Mat3<S>& a, const S& s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <Field S>
constexpr Vec3<S> operator*(const Mat3<S>& a, const Vec3<S>& b) {
  return {dot(a.x, b), dot(a.y, b), dot(a.z, b)};
}
template <Field S>
constexpr Mat3<S> transpose(const Mat3<S>& a) {
  return {{a.x.x, a.y.x, a.z.x}, {a.x.y, a.y.y, a.z.y}, {a.x.z, a.y.z, a.z.z}};
}
template <Field S>
constexpr std::array<Vec3<S>, 3> rows_of(const Mat3<S>& a) {
  return {a.x, a.y, a.z};
}
/// transpose(a) b
template <Field S>
constexpr Vec3<S> transposed_times(const Mat3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <Field S>
constexpr Mat3<S> operator*(const Mat3<S>& a, const Mat3<S>& b) {
  return {transposed_times(b, a.x), transposed_times(b, a.y), transposed_times(b, a.z)};
}
/// a b^T
template <Field S>
constexpr Mat3<S> outer(const Vec3<S>& a, const Vec3<S>& b) {
  return {b * a.x, b * a.y, b * a.z};
}

template <Field S>
constexpr Sym3<S> operator+(const Sym3<S>& a, const Sym3<S>& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
template <Field S>
constexpr Sym3<S> operator-(const Sym3<S>& a, const Sym3<S>& b) {
  return {a.xx - b.xx, a.xy - b.xy, a.xz - b.xz, a.yy - b.yy, a.yz - b.yz, a.zz - b.zz};
}
template <Field S>
constexpr Sym3<S> operator-(const Sym3<S>& a) {
  return {-a.xx, -a.xy, -a.xz, -a.yy, -a.yz, -a.zz};
}
template <Field S>
constexpr Sym3<S> operator*(const Sym3<S>& a, const S& s) {
  return {a.xx * s, a.xy * s, a.xz * s, a.yy * s, a.yz * s, a.zz * s};
}
template <Field S>
constexpr Vec3<S> operator*(const Sym3<S>& a, const Vec3<S>& b) {
  return {a.xx * b.x + a.xy * b.y + a.xz * b.z, a.xy * b.x + a.yy * b.y + a.yz * b.z,
          a.xz * b.x + a.yz * b.y + a.zz * b.z};
}
template <Field S>
constexpr Mat3<S> full(const Sym3<S>& a) {
  return {{a.xx, a.xy, a.xz}, {a.xy, a.yy, a.yz}, {a.xz, a.yz, a.zz}};
}
/// The upper triangle of a matrix that is symmetric by construction.
template <Field S>
constexpr Sym3<S> upper(const Mat3<S>& a) {
  return {a.x.x, a.x.y, a.x.z, a.y.y, a.y.z, a.z.z};
}
/// a b^T where that is symmetric by construction
template <Field S>
constexpr Sym3<S> symmetric_outer(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.y, a.y * b.z, a.z * b.z};
}
/// A - (a b^T + c d^T) where that is symmetric by construction
template <Field S>
constexpr Sym3<S> less_outers(const Sym3<S>& A, const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c,
                              const Vec3<S>& d) {
  return {A.xx - a.x * b.x - c.x * d.x, A.xy - a.x * b.y - c.x * d.y, A.xz - a.x * b.z - c.x * d.z,
          A.yy - a.y * b.y - c.y * d.y, A.yz - a.y * b.z - c.y * d.z, A.zz - a.z * b.z - c.z * d.z};
}
/// A - (a b^T + c d^T)
template <Field S>
constexpr Mat3<S> less_outers(const Mat3<S>& A, const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& c,
                              const Vec3<S>& d) {
  return A - outer(a, b) - outer(c, d);
}
/// a a^T
template <Field S>
constexpr Sym3<S> square(const Vec3<S>& a) {
  return symmetric_outer(a, a);
}
/// a b^T + b a^T
template <Field S>
constexpr Sym3<S> twice_outer(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.x * b.x + a.x * b.x, a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x,
          a.y * b.y + a.y * b.y, a.y * b.z + a.z * b.y, a.z * b.z + a.z * b.z};
}
/// l~ A: the vector product of l with every column.
template <Field S>
constexpr Mat3<S> cross(const Vec3<S>& l, const Mat3<S>& a) {
  return {a.z * l.y - a.y * l.z, a.x * l.z - a.z * l.x, a.y * l.x - a.x * l.y};
}
/// A l~
template <Field S>
constexpr Mat3<S> cross(const Mat3<S>& a, const Vec3<S>& l) {
  return {cross(a.x, l), cross(a.y, l), cross(a.z, l)};
}
/// R A R^T
template <Field S>
constexpr Sym3<S> turned(const Mat3<S>& R, const Sym3<S>& a) {
  const Vec3<S> p = a * R.x, q = a * R.y, r = a * R.z;
  return seeded(Fault::spatial_turn,
                Sym3<S>{dot(R.x, p), dot(R.x, q), dot(R.x, r), dot(R.y, q), dot(R.y, r), dot(R.z, r)});
}
/// B + m~
template <Field S>
constexpr Mat3<S> plus_skew(const Mat3<S>& B, const Vec3<S>& m) {
  return {{B.x.x, B.x.y - m.z, B.x.z + m.y},
          {B.y.x + m.z, B.y.y, B.y.z - m.x},
          {B.z.x - m.y, B.z.y + m.x, B.z.z}};
}
/// A + m 1
template <Field S>
constexpr Sym3<S> plus_diagonal(const Sym3<S>& A, const S& m) {
  return {A.xx + m, A.xy, A.xz, A.yy + m, A.yz, A.zz + m};
}
// The sums below are written entry by entry, one product at a time, so that each product and its sum is one
// fused operation where the processor has such.
/// B + l~ A
template <Field S>
constexpr Mat3<S> plus_left_cross(const Mat3<S>& B, const Vec3<S>& l, const Sym3<S>& A) {
  return {
      {B.x.x + l.y * A.xz - l.z * A.xy, B.x.y + l.y * A.yz - l.z * A.yy, B.x.z + l.y * A.zz - l.z * A.yz},
      {B.y.x + l.z * A.xx - l.x * A.xz, B.y.y + l.z * A.xy - l.x * A.yz, B.y.z + l.z * A.xz - l.x * A.zz},
      {B.z.x + l.x * A.xy - l.y * A.xx, B.z.y + l.x * A.yy - l.y * A.xy, B.z.z + l.x * A.yz - l.y * A.xz}};
}
/// B + A l~
template <Field S>
constexpr Mat3<S> plus_right_cross(const Mat3<S>& B, const Sym3<S>& A, const Vec3<S>& l) {
  return {
      {B.x.x + A.xy * l.z - A.xz * l.y, B.x.y + A.xz * l.x - A.xx * l.z, B.x.z + A.xx * l.y - A.xy * l.x},
      {B.y.x + A.yy * l.z - A.yz * l.y, B.y.y + A.yz * l.x - A.xy * l.z, B.y.z + A.xy * l.y - A.yy * l.x},
      {B.z.x + A.yz * l.z - A.zz * l.y, B.z.y + A.zz * l.x - A.xz * l.z, B.z.z + A.xz * l.y - A.yz * l.x}};
}
/// A - (C l~ + (B l~)^T) where that is symmetric by construction
template <Field S>
constexpr Sym3<S> less_right_cross_sum(const Sym3<S>& A, const Mat3<S>& C, const Mat3<S>& B,
                                       const Vec3<S>& l) {
  return {A.xx - C.x.y * l.z + C.x.z * l.y - B.x.y * l.z + B.x.z * l.y,
          A.xy - C.x.z * l.x + C.x.x * l.z - B.y.y * l.z + B.y.z * l.y,
          A.xz - C.x.x * l.y + C.x.y * l.x - B.z.y * l.z + B.z.z * l.y,
          A.yy - C.y.z * l.x + C.y.x * l.z - B.y.z * l.x + B.y.x * l.z,
          A.yz - C.y.x * l.y + C.y.y * l.x - B.z.z * l.x + B.z.x * l.z,
          A.zz - C.z.x * l.y + C.z.y * l.x - B.z.x * l.y + B.z.y * l.x};
}
/// A - (l~ C + (l~ B)^T) where that is symmetric by construction
template <Field S>
constexpr Sym3<S> less_left_cross_sum(const Sym3<S>& A, const Mat3<S>& C, const Mat3<S>& B,
                                      const Vec3<S>& l) {
  return {A.xx - l.y * C.z.x + l.z * C.y.x - l.y * B.z.x + l.z * B.y.x,
          A.xy - l.y * C.z.y + l.z * C.y.y - l.z * B.x.x + l.x * B.z.x,
          A.xz - l.y * C.z.z + l.z * C.y.z - l.x * B.y.x + l.y * B.x.x,
          A.yy - l.z * C.x.y + l.x * C.z.y - l.z * B.x.y + l.x * B.z.y,
          A.yz - l.z * C.x.z + l.x * C.z.z - l.x * B.y.y + l.y * B.x.y,
          A.zz - l.x * C.y.z + l.y * C.x.z - l.x * B.y.z + l.y * B.x.z};
}
/// A a + B b
template <Field S>
constexpr Vec3<S> product_sum(const Sym3<S>& A, const Vec3<S>& a, const Mat3<S>& B, const Vec3<S>& b) {
  return {A.xx * a.x + A.xy * a.y + A.xz * a.z + B.x.x * b.x + B.x.y * b.y + B.x.z * b.z,
          A.xy * a.x + A.yy * a.y + A.yz * a.z + B.y.x * b.x + B.y.y * b.y + B.y.z * b.z,
          A.xz * a.x + A.yz * a.y + A.zz * a.z + B.z.x * b.x + B.z.y * b.y + B.z.z * b.z};
}
/// A a + B^T b
template <Field S>
constexpr Vec3<S> transposed_product_sum(const Sym3<S>& A, const Vec3<S>& a, const Mat3<S>& B,
                                         const Vec3<S>& b) {
  return {A.xx * a.x + A.xy * a.y + A.xz * a.z + B.x.x * b.x + B.y.x * b.y + B.z.x * b.z,
          A.xy * a.x + A.yy * a.y + A.yz * a.z + B.x.y * b.x + B.y.y * b.y + B.z.y * b.z,
          A.xz * a.x + A.yz * a.y + A.zz * a.z + B.x.z * b.x + B.y.z * b.y + B.z.z * b.z};
}
/// A + a b^T where that is symmetric by construction
template <Field S>
constexpr Sym3<S> plus_outer(const Sym3<S>& A, const Vec3<S>& a, const Vec3<S>& b) {
  return {A.xx + a.x * b.x, A.xy + a.x * b.y, A.xz + a.x * b.z,
          A.yy + a.y * b.y, A.yz + a.y * b.z, A.zz + a.z * b.z};
}
/// Entry (i, j) of a symmetric matrix.
template <Field S>
constexpr const S& entry(const Sym3<S>& a, int i, int j) {
  if (i > j) std::swap(i, j);
  return i == 0 ? (j == 0 ? a.xx : j == 1 ? a.xy : a.xz) : i == 1 ? (j == 1 ? a.yy : a.yz) : a.zz;
}
/// Entry (i, j) of a matrix.
template <Field S>
constexpr S entry(const Mat3<S>& a, int i, int j) {
  const Vec3<S>& row = i == 0 ? a.x : i == 1 ? a.y : a.z;
  return j == 0 ? row.x : j == 1 ? row.y : row.z;
}

/// Three axes as the columns of a rotation: of a link, in the inertial frame.
template <Field S>
struct Axes {
  Vec3<S> x, y, z;
};
/// Constants of a body that multiply vectors: components along its axes, and a symmetric matrix along them.
template <Field S>
struct Coefficients {
  S x = S(0), y = S(0), z = S(0);
  constexpr Coefficients() = default;
  constexpr Coefficients(const Vec3<S>& v) : x(v.x), y(v.y), z(v.z) {}
};
template <Field S>
struct SymmetricCoefficients {
  Sym3<S> entries;
  constexpr SymmetricCoefficients() = default;
  constexpr SymmetricCoefficients(const Sym3<S>& a) : entries(a) {}
};
/// The vector with components v along the axes.
template <Field S>
constexpr Vec3<S> operator*(const Axes<S>& e, const Coefficients<S>& v) {
  return e.x * v.x + e.y * v.y + e.z * v.z;
}
/// The axes with the components R along e.
template <Field S>
constexpr Axes<S> operator*(const Axes<S>& e, const std::array<Coefficients<S>, 3>& R) {
  return {e * R[0], e * R[1], e * R[2]};
}
template <Field S>
constexpr Vec3<S> operator*(const Axes<S>& e, const Vec3<S>& v) {
  return e.x * v.x + e.y * v.y + e.z * v.z;
}
/// The axes of a body that is turned by R against e.
template <Field S>
constexpr Axes<S> operator*(const Axes<S>& e, const Axes<S>& R) {
  return {e * R.x, e * R.y, e * R.z};
}
template <Field S>
constexpr Mat3<S> matrix_of(const Axes<S>& e) {
  return transpose(Mat3<S>{e.x, e.y, e.z});
}
template <Field S>
constexpr Axes<S> axes_of(const Mat3<S>& R) {
  const auto [x, y, z] = rows_of(transpose(R));
  return {x, y, z};
}
/// The axes that e turns into the unit vectors.
template <Field S>
constexpr Axes<S> inverse(const Axes<S>& e) {
  const auto [x, y, z] = rows_of(matrix_of(e));
  return {x, y, z};
}
/// A symmetric matrix given along the axes.
template <Field S>
constexpr Sym3<S> turned(const Axes<S>& e, const Sym3<S>& a) {
  const Vec3<S> p = e.x * a.xx + e.y * a.xy + e.z * a.xz;
  const Vec3<S> q = e.x * a.xy + e.y * a.yy + e.z * a.yz;
  const Vec3<S> r = e.x * a.xz + e.y * a.yz + e.z * a.zz;
  return seeded(Fault::spatial_turn, plus_outer(plus_outer(symmetric_outer(e.x, p), e.y, q), e.z, r));
}
template <Field S>
constexpr Sym3<S> turned(const Axes<S>& e, const SymmetricCoefficients<S>& along) {
  return turned(e, along.entries);
}

}  // namespace osculate

#include "spatial/vector3_packet.hpp"
#if defined(__AVX2__) && defined(__FMA__)
#include "spatial/vector3_avx.hpp"
#elif defined(__SSE2__) || defined(__aarch64__)
#include "spatial/vector3_pairs.hpp"
#endif
