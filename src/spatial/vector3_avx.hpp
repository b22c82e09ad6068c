// Three-vectors and 3 x 3 matrices of doubles, one AVX register for each three-vector: the functions of
// vector3.hpp, which includes this file where the compiler may use AVX2 and FMA. The fourth lane is zero.
// A symmetric matrix holds its three rows, a matrix its rows and its columns: both are wanted, and a row
// turned into a column costs more than computing it twice.
#pragma once

#include "scalar/lanes.hpp"

namespace osculate {

namespace avx {

using Lanes = double __attribute__((vector_size(32)));
using Words = long long __attribute__((vector_size(32)));

/// Lane i of v in every lane.
template <int i>
OSCULATE_INLINE Lanes spread(Lanes v) {
  return __builtin_shufflevector(v, v, i, i, i, i);
}
OSCULATE_INLINE Lanes spread(double s) { return Lanes{s, s, s, s}; }
/// The first three lanes, and zero. By a mask: of the instructions that do it there is one that valgrind does
/// not know.
OSCULATE_INLINE Lanes three_lanes(Lanes v) { return (Lanes)((Words)v & Words{-1, -1, -1, 0}); }
/// (y, z, x)
OSCULATE_INLINE Lanes rotated(Lanes v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
/// (z, x, y)
OSCULATE_INLINE Lanes rotated_back(Lanes v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); }

}  // namespace avx

template <>
struct Vec3<double> {
  union {
    avx::Lanes v;
    __extension__ struct { double x, y, z, none; };
  };
  OSCULATE_INLINE Vec3() : v{} {}
  OSCULATE_INLINE Vec3(avx::Lanes lanes) : v(lanes) {}
  OSCULATE_INLINE Vec3(double x0, double y0, double z0) : v(avx::three_lanes(avx::Lanes{x0, y0, z0, z0})) {}
  // Written out, so that a copy is one register and not its members.
  OSCULATE_INLINE Vec3(const Vec3& o) : v(o.v) {}
  OSCULATE_INLINE Vec3& operator=(const Vec3& o) {
    v = o.v;
    return *this;
  }
};

template <>
struct Sym3<double> {
  Vec3<double> x, y, z;  // rows
  Sym3() = default;
  OSCULATE_INLINE Sym3(const Vec3<double>& x0, const Vec3<double>& y0, const Vec3<double>& z0)
      : x(x0), y(y0), z(z0) {}
  OSCULATE_INLINE Sym3(double xx, double xy, double xz, double yy, double yz, double zz)
      : x(xx, xy, xz), y(xy, yy, yz), z(xz, yz, zz) {}
};

template <>
struct Mat3<double> {
  Vec3<double> x, y, z;     // rows
  Vec3<double> tx, ty, tz;  // columns
  Mat3() = default;
  OSCULATE_INLINE Mat3(const Vec3<double>& x0, const Vec3<double>& y0, const Vec3<double>& z0)
      : x(x0),
        y(y0),
        z(z0),
        tx(x0.v[0], y0.v[0], z0.v[0]),
        ty(x0.v[1], y0.v[1], z0.v[1]),
        tz(x0.v[2], y0.v[2], z0.v[2]) {}
  OSCULATE_INLINE Mat3(const Vec3<double>& x0, const Vec3<double>& y0, const Vec3<double>& z0,
                       const Vec3<double>& c0, const Vec3<double>& c1, const Vec3<double>& c2)
      : x(x0), y(y0), z(z0), tx(c0), ty(c1), tz(c2) {}
};

namespace avx {

using V = Vec3<double>;
using M = Mat3<double>;
using Y = Sym3<double>;

template <int i>
OSCULATE_INLINE V lane(const V& a) {
  return spread<i>(a.v);
}
/// a x + b y + c z for the lanes (x, y, z) of v.
OSCULATE_INLINE V combined(const V& a, const V& b, const V& c, const V& v) {
  return a.v * spread<0>(v.v) + b.v * spread<1>(v.v) + c.v * spread<2>(v.v);
}
/// row times l~, which is row x l
OSCULATE_INLINE V crossed(const V& row, const V& l) {
  return rotated(row.v * rotated(l.v) - rotated(row.v) * l.v);
}
/// sum + a x b
OSCULATE_INLINE V plus_crossed(const V& sum, const V& a, const V& b) {
  return sum.v + rotated(a.v) * rotated_back(b.v) - rotated_back(a.v) * rotated(b.v);
}
/// From its rows, or from its columns.
struct Rows {
  V x, y, z;
};
OSCULATE_INLINE Rows transposed(const Rows& a) {
  const Lanes low = __builtin_shufflevector(a.x.v, a.y.v, 0, 4, 2, 6);
  const Lanes high = __builtin_shufflevector(a.x.v, a.y.v, 1, 5, 3, 7);
  return {V(__builtin_shufflevector(low, a.z.v, 0, 1, 4, 7)),
          V(__builtin_shufflevector(high, a.z.v, 0, 1, 5, 7)),
          V(__builtin_shufflevector(low, a.z.v, 2, 3, 6, 7))};
}

}  // namespace avx

OSCULATE_INLINE avx::V operator+(const avx::V& a, const avx::V& b) { return a.v + b.v; }
OSCULATE_INLINE avx::V operator-(const avx::V& a, const avx::V& b) { return a.v - b.v; }
OSCULATE_INLINE avx::V operator-(const avx::V& a) { return -a.v; }
OSCULATE_INLINE avx::V operator*(const avx::V& a, double s) { return a.v * avx::spread(s); }
OSCULATE_INLINE double dot(const avx::V& a, const avx::V& b) {
  const avx::Lanes t = a.v * b.v;
  return t[0] + t[1] + t[2];
}
OSCULATE_INLINE double dot(const avx::V& a, const avx::V& b, const avx::V& c, const avx::V& d) {
  const avx::Lanes t = a.v * b.v + c.v * d.v;
  return t[0] + t[1] + t[2];
}
OSCULATE_INLINE avx::V cross(const avx::V& a, const avx::V& b) {
  return seeded(Fault::spatial_cross, avx::crossed(a, b));
}
OSCULATE_INLINE avx::V plus_cross(const avx::V& sum, const avx::V& a, const avx::V& b) {
  return avx::plus_crossed(sum, seeded(Fault::spatial_cross, a), b);
}

OSCULATE_INLINE avx::M operator+(const avx::M& a, const avx::M& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z, a.tx + b.tx, a.ty + b.ty, a.tz + b.tz};
}
OSCULATE_INLINE avx::M operator-(const avx::M& a, const avx::M& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z, a.tx - b.tx, a.ty - b.ty, a.tz - b.tz};
}
OSCULATE_INLINE avx::M operator-(const avx::M& a) { return {-a.x, -a.y, -a.z, -a.tx, -a.ty, -a.tz}; }
OSCULATE_INLINE avx::M operator*(const avx::M& a, double s) {
  return {a.x * s, a.y * s, a.z * s, a.tx * s, a.ty * s, a.tz * s};
}
OSCULATE_INLINE avx::V operator*(const avx::M& a, const avx::V& b) {
  return avx::combined(a.tx, a.ty, a.tz, b);
}
OSCULATE_INLINE avx::V transposed_times(const avx::M& a, const avx::V& b) {
  return avx::combined(a.x, a.y, a.z, b);
}
OSCULATE_INLINE avx::M transpose(const avx::M& a) { return {a.tx, a.ty, a.tz, a.x, a.y, a.z}; }
OSCULATE_INLINE avx::M operator*(const avx::M& a, const avx::M& b) {
  return {transposed_times(b, a.x),
          transposed_times(b, a.y),
          transposed_times(b, a.z),
          a * b.tx,
          a * b.ty,
          a * b.tz};
}
OSCULATE_INLINE avx::M outer(const avx::V& a, const avx::V& b) {
  using avx::lane;
  return {b.v * lane<0>(a).v, b.v * lane<1>(a).v, b.v * lane<2>(a).v,
          a.v * lane<0>(b).v, a.v * lane<1>(b).v, a.v * lane<2>(b).v};
}

OSCULATE_INLINE avx::Y operator+(const avx::Y& a, const avx::Y& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
OSCULATE_INLINE avx::Y operator-(const avx::Y& a, const avx::Y& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
OSCULATE_INLINE avx::Y operator-(const avx::Y& a) { return {-a.x, -a.y, -a.z}; }
OSCULATE_INLINE avx::Y operator*(const avx::Y& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
OSCULATE_INLINE avx::V operator*(const avx::Y& a, const avx::V& b) { return avx::combined(a.x, a.y, a.z, b); }
OSCULATE_INLINE avx::M full(const avx::Y& a) { return {a.x, a.y, a.z, a.x, a.y, a.z}; }
OSCULATE_INLINE avx::Y upper(const avx::M& a) {
  return {a.x.v[0], a.x.v[1], a.x.v[2], a.y.v[1], a.y.v[2], a.z.v[2]};
}
OSCULATE_INLINE avx::Y symmetric_outer(const avx::V& a, const avx::V& b) {
  using avx::lane;
  return {b.v * lane<0>(a).v, b.v * lane<1>(a).v, b.v * lane<2>(a).v};
}
/// A - (a b^T + c d^T) where that is symmetric by construction
OSCULATE_INLINE avx::Y less_outers(const avx::Y& A, const avx::V& a, const avx::V& b, const avx::V& c,
                                   const avx::V& d) {
  using avx::spread;
  return {A.x.v - b.v * spread<0>(a.v) - d.v * spread<0>(c.v),
          A.y.v - b.v * spread<1>(a.v) - d.v * spread<1>(c.v),
          A.z.v - b.v * spread<2>(a.v) - d.v * spread<2>(c.v)};
}
OSCULATE_INLINE avx::M less_outers(const avx::M& A, const avx::V& a, const avx::V& b, const avx::V& c,
                                   const avx::V& d) {
  return A - outer(a, b) - outer(c, d);
}
OSCULATE_INLINE avx::Y square(const avx::V& a) { return symmetric_outer(a, a); }
OSCULATE_INLINE avx::Y twice_outer(const avx::V& a, const avx::V& b) {
  return symmetric_outer(a, b) + symmetric_outer(b, a);
}
OSCULATE_INLINE avx::M cross(const avx::V& l, const avx::M& a) {
  using namespace avx;
  const V lx = lane<0>(l), ly = lane<1>(l), lz = lane<2>(l);
  return {a.z.v * ly.v - a.y.v * lz.v,
          a.x.v * lz.v - a.z.v * lx.v,
          a.y.v * lx.v - a.x.v * ly.v,
          crossed(l, a.tx),
          crossed(l, a.ty),
          crossed(l, a.tz)};
}
OSCULATE_INLINE avx::M cross(const avx::M& a, const avx::V& l) { return -transpose(cross(l, transpose(a))); }
/// R A R^T
OSCULATE_INLINE avx::Y turned(const avx::M& R, const avx::Y& a) {
  const avx::V p = R * a.x, q = R * a.y, r = R * a.z;  // columns of R A
  const auto row = [&](const avx::V& axis) { return avx::combined(p, q, r, axis); };
  return seeded(Fault::spatial_turn, avx::Y(row(R.x), row(R.y), row(R.z)));
}
/// B + m~
OSCULATE_INLINE avx::M plus_skew(const avx::M& B, const avx::V& m) {
  using avx::Lanes;
  // Rows of m~: (0 -z y), (z 0 -x), (-y x 0).
  const Lanes x = __builtin_shufflevector(m.v, m.v, 3, 2, 1, 3), sx{0, -1, 1, 0};
  const Lanes y = __builtin_shufflevector(m.v, m.v, 2, 3, 0, 3), sy{1, 0, -1, 0};
  const Lanes z = __builtin_shufflevector(m.v, m.v, 1, 0, 3, 3), sz{-1, 1, 0, 0};
  return {B.x.v + x * sx, B.y.v + y * sy, B.z.v + z * sz, B.tx.v - x * sx, B.ty.v - y * sy, B.tz.v - z * sz};
}
/// A + m 1
OSCULATE_INLINE avx::Y plus_diagonal(const avx::Y& A, double m) {
  using avx::Lanes;
  const Lanes all = avx::spread(m), x{1, 0, 0, 0}, y{0, 1, 0, 0}, z{0, 0, 1, 0};
  return {A.x.v + all * x, A.y.v + all * y, A.z.v + all * z};
}
/// B + l~ A: its columns from its rows, which costs less than from the columns of B.
OSCULATE_INLINE avx::M plus_left_cross(const avx::M& B, const avx::V& l, const avx::Y& A) {
  using namespace avx;
  const Lanes lx = spread<0>(l.v), ly = spread<1>(l.v), lz = spread<2>(l.v);
  const Rows rows{B.x.v + A.z.v * ly - A.y.v * lz, B.y.v + A.x.v * lz - A.z.v * lx,
                  B.z.v + A.y.v * lx - A.x.v * ly};
  const auto [tx, ty, tz] = transposed(rows);
  return {rows.x, rows.y, rows.z, tx, ty, tz};
}
/// B + A l~: its rows from its columns.
OSCULATE_INLINE avx::M plus_right_cross(const avx::M& B, const avx::Y& A, const avx::V& l) {
  using namespace avx;
  const Lanes lx = spread<0>(l.v), ly = spread<1>(l.v), lz = spread<2>(l.v);
  const Rows columns{B.tx.v + A.y.v * lz - A.z.v * ly, B.ty.v + A.z.v * lx - A.x.v * lz,
                     B.tz.v + A.x.v * ly - A.y.v * lx};
  const auto [x, y, z] = transposed(columns);
  return {x, y, z, columns.x, columns.y, columns.z};
}
/// A - (C l~ + (B l~)^T) where that is symmetric by construction: from the columns of C and the rows of B.
OSCULATE_INLINE avx::Y less_right_cross_sum(const avx::Y& A, const avx::M& C, const avx::M& B,
                                            const avx::V& l) {
  using namespace avx;
  const Lanes lx = spread<0>(l.v), ly = spread<1>(l.v), lz = spread<2>(l.v);
  return {plus_crossed(A.x.v + C.tz.v * ly - C.ty.v * lz, l, B.x),
          plus_crossed(A.y.v + C.tx.v * lz - C.tz.v * lx, l, B.y),
          plus_crossed(A.z.v + C.ty.v * lx - C.tx.v * ly, l, B.z)};
}
/// A - (l~ C + (l~ B)^T) where that is symmetric by construction: from the rows of C and the columns of B.
OSCULATE_INLINE avx::Y less_left_cross_sum(const avx::Y& A, const avx::M& C, const avx::M& B,
                                           const avx::V& l) {
  using namespace avx;
  const Lanes lx = spread<0>(l.v), ly = spread<1>(l.v), lz = spread<2>(l.v);
  return {plus_crossed(A.x.v + C.y.v * lz - C.z.v * ly, B.tx, l),
          plus_crossed(A.y.v + C.z.v * lx - C.x.v * lz, B.ty, l),
          plus_crossed(A.z.v + C.x.v * ly - C.y.v * lx, B.tz, l)};
}
OSCULATE_INLINE avx::V product_sum(const avx::Y& A, const avx::V& a, const avx::M& B, const avx::V& b) {
  using namespace avx;
  return A.x.v * spread<0>(a.v) + A.y.v * spread<1>(a.v) + A.z.v * spread<2>(a.v) + B.tx.v * spread<0>(b.v) +
         B.ty.v * spread<1>(b.v) + B.tz.v * spread<2>(b.v);
}
OSCULATE_INLINE avx::V transposed_product_sum(const avx::Y& A, const avx::V& a, const avx::M& B,
                                              const avx::V& b) {
  using namespace avx;
  return A.x.v * spread<0>(a.v) + A.y.v * spread<1>(a.v) + A.z.v * spread<2>(a.v) + B.x.v * spread<0>(b.v) +
         B.y.v * spread<1>(b.v) + B.z.v * spread<2>(b.v);
}
OSCULATE_INLINE double entry(const avx::Y& a, int i, int j) {
  return i == 0 ? a.x.v[j] : i == 1 ? a.y.v[j] : a.z.v[j];
}

OSCULATE_INLINE avx::M matrix_of(const Axes<double>& e) {
  const auto [x, y, z] = avx::transposed({e.x, e.y, e.z});
  return {x, y, z, e.x, e.y, e.z};
}

/// Constants that multiply vectors, each in every lane.
template <>
struct Coefficients<double> {
  avx::Lanes x, y, z;
  Coefficients() = default;
  OSCULATE_INLINE Coefficients(const avx::V& v)
      : x(avx::spread(v.x)), y(avx::spread(v.y)), z(avx::spread(v.z)) {}
};
OSCULATE_INLINE avx::V operator*(const Axes<double>& e, const Coefficients<double>& v) {
  return e.x.v * v.x + e.y.v * v.y + e.z.v * v.z;
}
template <>
struct SymmetricCoefficients<double> {
  avx::Lanes xx, xy, xz, yy, yz, zz;
  SymmetricCoefficients() = default;
  OSCULATE_INLINE SymmetricCoefficients(const avx::Y& a)
      : xx(avx::spread(a.x.x)),
        xy(avx::spread(a.x.y)),
        xz(avx::spread(a.x.z)),
        yy(avx::spread(a.y.y)),
        yz(avx::spread(a.y.z)),
        zz(avx::spread(a.z.z)) {}
};
/// A symmetric matrix given along the axes.
OSCULATE_INLINE avx::Y turned(const Axes<double>& e, const SymmetricCoefficients<double>& a) {
  using namespace avx;
  const Lanes p = e.x.v * a.xx + e.y.v * a.xy + e.z.v * a.xz;
  const Lanes q = e.x.v * a.xy + e.y.v * a.yy + e.z.v * a.yz;
  const Lanes r = e.x.v * a.xz + e.y.v * a.yz + e.z.v * a.zz;
  const auto row = [&](const Lanes& i, const Lanes& j, const Lanes& k) -> V {
    return e.x.v * i + e.y.v * j + e.z.v * k;
  };
  return seeded(Fault::spatial_turn, Y(row(spread<0>(p), spread<0>(q), spread<0>(r)),
                                       row(spread<1>(p), spread<1>(q), spread<1>(r)),
                                       row(spread<2>(p), spread<2>(q), spread<2>(r))));
}

}  // namespace osculate
