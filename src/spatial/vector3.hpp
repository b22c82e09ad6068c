// Three-vectors and 3 x 3 matrices over any Field, as plain structs: no heap, no comparison, no expression
// templates.
#pragma once

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
template <Field S>
constexpr Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return seeded(Fault::spatial_cross,
                Vec3<S>{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x});
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
/// a b^T + b a^T
template <Field S>
constexpr Sym3<S> twice_outer(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.x * b.x + a.x * b.x, a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x,
          a.y * b.y + a.y * b.y, a.y * b.z + a.z * b.y, a.z * b.z + a.z * b.z};
}
/// M - (a b^T + b a^T), entry by entry
template <Field S>
constexpr Sym3<S> less_twice_outer(const Sym3<S>& M, const Vec3<S>& a, const Vec3<S>& b) {
  return {M.xx - (a.x * b.x + a.x * b.x), M.xy - (a.x * b.y + a.y * b.x), M.xz - (a.x * b.z + a.z * b.x),
          M.yy - (a.y * b.y + a.y * b.y), M.yz - (a.y * b.z + a.z * b.y), M.zz - (a.z * b.z + a.z * b.z)};
}
/// a a^T
template <Field S>
constexpr Sym3<S> square(const Vec3<S>& a) {
  return {a.x * a.x, a.x * a.y, a.x * a.z, a.y * a.y, a.y * a.z, a.z * a.z};
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

}  // namespace osculate
