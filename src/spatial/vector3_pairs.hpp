// Three-vectors and 3 x 3 matrices of doubles in registers of two lanes, SSE2 or NEON: the functions of
// vector3.hpp, which includes this file where the build may use no wider ones. A vector is (x, y) and z, the
// latter in both lanes. A matrix is its upper left corner as diagonal (xx, yy) and others (xy, yx), what
// stands beside the corner, (xz, yz), and below it, (zx, zy), and zz: then it is transposed by one swap, and
// its products with vectors and those of two vectors need one swap more.
#pragma once

#include "scalar/lanes.hpp"

namespace osculate {

namespace pairs {

using Pair = double __attribute__((vector_size(16)));
using Words = long long __attribute__((vector_size(16)));
using Halves = int __attribute__((vector_size(16)));  // of words

OSCULATE_INLINE Pair spread(double s) { return Pair{s, s}; }
// Lanes of one register move as halves of words: for those SSE2 has an instruction that keeps its operand.
/// Lane i of p in both lanes.
template <int i>
OSCULATE_INLINE Pair spread(Pair p) {
  return (Pair)__builtin_shufflevector((Halves)p, (Halves)p, 2 * i, 2 * i + 1, 2 * i, 2 * i + 1);
}
OSCULATE_INLINE Pair swapped(Pair p) {
  return (Pair)__builtin_shufflevector((Halves)p, (Halves)p, 2, 3, 0, 1);
}
OSCULATE_INLINE Pair firsts(Pair a, Pair b) { return __builtin_shufflevector(a, b, 0, 2); }
OSCULATE_INLINE Pair seconds(Pair a, Pair b) { return __builtin_shufflevector(a, b, 1, 3); }
/// (a[0], b[1])
OSCULATE_INLINE Pair first_and_second(Pair a, Pair b) { return __builtin_shufflevector(a, b, 0, 3); }
/// a[0] + a[1] in both lanes
OSCULATE_INLINE Pair sum_of(Pair a) { return a + swapped(a); }
OSCULATE_INLINE Pair first_negated(Pair a) { return (Pair)((Words)a ^ (Words)Pair{-0.0, 0.0}); }
OSCULATE_INLINE Pair second_negated(Pair a) { return (Pair)((Words)a ^ (Words)Pair{0.0, -0.0}); }

}  // namespace pairs

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"  // structs without a name
template <>
struct Vec3<double> {
  union {
    struct {
      pairs::Pair xy, zz;
    };
    struct {  // to be read only
      const double x, y, z, z_again;
    };
  };
  OSCULATE_INLINE Vec3() : xy{}, zz{} {}
  OSCULATE_INLINE Vec3(pairs::Pair first, pairs::Pair last) : xy(first), zz(last) {}
  OSCULATE_INLINE Vec3(double x0, double y0, double z0) : xy{x0, y0}, zz{z0, z0} {}
  // Written out, so that a copy is two registers and not its members.
  OSCULATE_INLINE Vec3(const Vec3& o) : xy(o.xy), zz(o.zz) {}
  OSCULATE_INLINE Vec3& operator=(const Vec3& o) {
    xy = o.xy, zz = o.zz;
    return *this;
  }
};
#pragma GCC diagnostic pop

template <>
struct Sym3<double> {  // a matrix without its row; `others` holds xy and yx, equal to rounding
  pairs::Pair diagonal{}, others{}, column{}, zz{};
  Sym3() = default;
  OSCULATE_INLINE Sym3(pairs::Pair d, pairs::Pair o, pairs::Pair c, pairs::Pair corner)
      : diagonal(d), others(o), column(c), zz(corner) {}
  OSCULATE_INLINE Sym3(double xx, double xy, double xz, double yy, double yz, double z)
      : diagonal{xx, yy}, others{xy, xy}, column{xz, yz}, zz{z, z} {}
  OSCULATE_INLINE Sym3(const Sym3& o) : diagonal(o.diagonal), others(o.others), column(o.column), zz(o.zz) {}
  OSCULATE_INLINE Sym3& operator=(const Sym3& o) {
    diagonal = o.diagonal, others = o.others, column = o.column, zz = o.zz;
    return *this;
  }
};

template <>
struct Mat3<double> {
  pairs::Pair diagonal{}, others{}, column{}, row{}, zz{};  // zz twice
  Mat3() = default;
  OSCULATE_INLINE Mat3(pairs::Pair d, pairs::Pair o, pairs::Pair c, pairs::Pair r, pairs::Pair corner)
      : diagonal(d), others(o), column(c), row(r), zz(corner) {}
  OSCULATE_INLINE Mat3(const Vec3<double>& x, const Vec3<double>& y, const Vec3<double>& z)  // rows
      : diagonal(pairs::first_and_second(x.xy, y.xy)),
        others(__builtin_shufflevector(x.xy, y.xy, 1, 2)),
        column(pairs::firsts(x.zz, y.zz)),
        row(z.xy),
        zz(z.zz) {}
  OSCULATE_INLINE Mat3(const Mat3& o)
      : diagonal(o.diagonal), others(o.others), column(o.column), row(o.row), zz(o.zz) {}
  OSCULATE_INLINE Mat3& operator=(const Mat3& o) {
    diagonal = o.diagonal, others = o.others, column = o.column, row = o.row, zz = o.zz;
    return *this;
  }
};

namespace pairs {

using V = Vec3<double>;
using M = Mat3<double>;
using Y = Sym3<double>;

/// What a vector product with l multiplies by.
struct Cross {
  Pair n, m;  // (-y, x), (-z, z) for l
};
OSCULATE_INLINE Cross cross_with(const V& l) { return {first_negated(swapped(l.xy)), first_negated(l.zz)}; }
OSCULATE_INLINE Cross cross_with_negated(const V& l) {
  return {second_negated(swapped(l.xy)), second_negated(l.zz)};
}
/// l x b
OSCULATE_INLINE V operator*(const Cross& l, const V& b) {
  return {l.m * swapped(b.xy) - l.n * b.zz, sum_of(l.n * b.xy)};
}
/// B + l~ A
OSCULATE_INLINE M plus_left_cross(const M& B, const Cross& l, const Y& A) {
  const Pair ends = l.n * A.column;
  return {B.diagonal - ends + l.m * A.others, B.others - l.n * swapped(A.column) + l.m * swapped(A.diagonal),
          B.column - l.n * A.zz + l.m * swapped(A.column), B.row + l.n * A.diagonal + swapped(l.n) * A.others,
          B.zz + sum_of(ends)};
}
/// A - (S l~ + (S l~)^T) / 2
OSCULATE_INLINE Y less_right_cross(const Y& A, const M& S, const Cross& l) {
  const Pair half = spread(0.5), n = l.n * half, m = l.m * half, turned = swapped(n);
  return {A.diagonal - l.n * S.column + l.m * S.others, A.others - sum_of(turned * S.column + m * S.diagonal),
          A.column - n * (S.zz - S.diagonal) + m * swapped(S.row) + turned * S.others,
          A.zz + sum_of(l.n * S.row)};
}

}  // namespace pairs

OSCULATE_INLINE pairs::V operator+(const pairs::V& a, const pairs::V& b) {
  return {a.xy + b.xy, a.zz + b.zz};
}
OSCULATE_INLINE pairs::V operator-(const pairs::V& a, const pairs::V& b) {
  return {a.xy - b.xy, a.zz - b.zz};
}
OSCULATE_INLINE pairs::V operator-(const pairs::V& a) { return {-a.xy, -a.zz}; }
OSCULATE_INLINE pairs::V operator*(const pairs::V& a, double s) {
  const pairs::Pair both = pairs::spread(s);
  return {a.xy * both, a.zz * both};
}
OSCULATE_INLINE double dot(const pairs::V& a, const pairs::V& b) {
  const pairs::Pair t = a.xy * b.xy;
  return t[0] + t[1] + a.z * b.z;
}
OSCULATE_INLINE double dot(const pairs::V& a, const pairs::V& b, const pairs::V& c, const pairs::V& d) {
  const pairs::Pair t = a.xy * b.xy + c.xy * d.xy, z = a.zz * b.zz + c.zz * d.zz;
  return t[0] + t[1] + z[0];
}
OSCULATE_INLINE pairs::V cross(const pairs::V& a, const pairs::V& b) {
  return seeded(Fault::spatial_cross, pairs::cross_with(a) * b);
}

namespace pairs {
struct Multipliers {
  Pair x, y, z;
};
}  // namespace pairs
OSCULATE_INLINE pairs::Multipliers multipliers(const pairs::V& v) {
  return {pairs::spread<0>(v.xy), pairs::spread<1>(v.xy), v.zz};
}

OSCULATE_INLINE std::array<pairs::V, 3> rows_of(const pairs::M& a) {
  using namespace pairs;
  return {V(firsts(a.diagonal, a.others), spread<0>(a.column)),
          V(seconds(a.others, a.diagonal), spread<1>(a.column)), V(a.row, a.zz)};
}
OSCULATE_INLINE pairs::M transpose(const pairs::M& a) {
  return {a.diagonal, pairs::swapped(a.others), a.row, a.column, a.zz};
}
OSCULATE_INLINE pairs::M operator+(const pairs::M& a, const pairs::M& b) {
  return {a.diagonal + b.diagonal, a.others + b.others, a.column + b.column, a.row + b.row, a.zz + b.zz};
}
OSCULATE_INLINE pairs::M operator-(const pairs::M& a, const pairs::M& b) {
  return {a.diagonal - b.diagonal, a.others - b.others, a.column - b.column, a.row - b.row, a.zz - b.zz};
}
OSCULATE_INLINE pairs::M operator-(const pairs::M& a) {
  return {-a.diagonal, -a.others, -a.column, -a.row, -a.zz};
}
OSCULATE_INLINE pairs::M operator*(const pairs::M& a, double s) {
  const pairs::Pair both = pairs::spread(s);
  return {a.diagonal * both, a.others * both, a.column * both, a.row * both, a.zz * both};
}
OSCULATE_INLINE pairs::V operator*(const pairs::M& a, const pairs::V& b) {
  return {a.diagonal * b.xy + a.others * pairs::swapped(b.xy) + a.column * b.zz,
          pairs::sum_of(a.row * b.xy) + a.zz * b.zz};
}
OSCULATE_INLINE pairs::V transposed_times(const pairs::M& a, const pairs::V& b) {
  return {a.diagonal * b.xy + pairs::swapped(a.others * b.xy) + a.row * b.zz,
          pairs::sum_of(a.column * b.xy) + a.zz * b.zz};
}
OSCULATE_INLINE pairs::M operator*(const pairs::M& a, const pairs::M& b) {
  const auto [x, y, z] = rows_of(a);
  return {transposed_times(b, x), transposed_times(b, y), transposed_times(b, z)};
}
OSCULATE_INLINE pairs::M outer(const pairs::V& a, const pairs::V& b) {
  return {a.xy * b.xy, a.xy * pairs::swapped(b.xy), a.xy * b.zz, a.zz * b.xy, a.zz * b.zz};
}

OSCULATE_INLINE pairs::Y operator+(const pairs::Y& a, const pairs::Y& b) {
  return {a.diagonal + b.diagonal, a.others + b.others, a.column + b.column, a.zz + b.zz};
}
OSCULATE_INLINE pairs::Y operator-(const pairs::Y& a, const pairs::Y& b) {
  return {a.diagonal - b.diagonal, a.others - b.others, a.column - b.column, a.zz - b.zz};
}
OSCULATE_INLINE pairs::Y operator-(const pairs::Y& a) { return {-a.diagonal, -a.others, -a.column, -a.zz}; }
OSCULATE_INLINE pairs::Y operator*(const pairs::Y& a, double s) {
  const pairs::Pair both = pairs::spread(s);
  return {a.diagonal * both, a.others * both, a.column * both, a.zz * both};
}
OSCULATE_INLINE pairs::M full(const pairs::Y& a) { return {a.diagonal, a.others, a.column, a.column, a.zz}; }
OSCULATE_INLINE pairs::V operator*(const pairs::Y& a, const pairs::V& b) { return full(a) * b; }
OSCULATE_INLINE pairs::Y upper(const pairs::M& a) {
  return {a.diagonal, pairs::spread<0>(a.others), a.column, a.zz};
}
OSCULATE_INLINE pairs::Y symmetric_outer(const pairs::V& a, const pairs::V& b) {
  return {a.xy * b.xy, a.xy * pairs::swapped(b.xy), a.xy * b.zz, a.zz * b.zz};
}
OSCULATE_INLINE pairs::Y less_outers(const pairs::Y& A, const pairs::V& a, const pairs::V& b,
                                     const pairs::V& c, const pairs::V& d) {
  return A - symmetric_outer(a, b) - symmetric_outer(c, d);
}
OSCULATE_INLINE pairs::Y plus_outer(const pairs::Y& A, const pairs::V& a, const pairs::V& b) {
  return A + symmetric_outer(a, b);
}
OSCULATE_INLINE pairs::Y twice_outer(const pairs::V& a, const pairs::V& b) {
  return symmetric_outer(a, b) + symmetric_outer(b, a);
}
OSCULATE_INLINE pairs::M cross(const pairs::V& l, const pairs::M& a) {
  const auto [x, y, z] = rows_of(a);
  return {z * l.y - y * l.z, x * l.z - z * l.x, y * l.x - x * l.y};
}
OSCULATE_INLINE pairs::M cross(const pairs::M& a, const pairs::V& l) {
  return -transpose(cross(l, transpose(a)));
}
/// B + m~
OSCULATE_INLINE pairs::M plus_skew(const pairs::M& B, const pairs::V& m) {
  const auto [n, z] = pairs::cross_with(m);
  return {B.diagonal, B.others + z, B.column - n, B.row + n, B.zz};
}
/// A + m 1
OSCULATE_INLINE pairs::Y plus_diagonal(const pairs::Y& A, double m) {
  return {A.diagonal + pairs::spread(m), A.others, A.column, A.zz + pairs::spread(m)};
}
OSCULATE_INLINE pairs::M plus_left_cross(const pairs::M& B, const pairs::V& l, const pairs::Y& A) {
  return pairs::plus_left_cross(B, pairs::cross_with(l), A);
}
/// B + A l~ = (B^T - l~ A)^T
OSCULATE_INLINE pairs::M plus_right_cross(const pairs::M& B, const pairs::Y& A, const pairs::V& l) {
  return transpose(pairs::plus_left_cross(transpose(B), pairs::cross_with_negated(l), A));
}
/// A - (C l~ + (B l~)^T) where that is symmetric by construction, C - B being l~ times a symmetric matrix:
/// from the mean of C and B.
OSCULATE_INLINE pairs::Y less_right_cross_sum(const pairs::Y& A, const pairs::M& C, const pairs::M& B,
                                              const pairs::V& l) {
  return pairs::less_right_cross(A, B + C, pairs::cross_with(l));
}
/// A - (l~ C + (l~ B)^T) where that is symmetric by construction, likewise.
OSCULATE_INLINE pairs::Y less_left_cross_sum(const pairs::Y& A, const pairs::M& C, const pairs::M& B,
                                             const pairs::V& l) {
  return pairs::less_right_cross(A, transpose(B + C), pairs::cross_with_negated(l));
}
OSCULATE_INLINE pairs::V product_sum(const pairs::Y& A, const pairs::V& a, const pairs::M& B,
                                     const pairs::V& b) {
  using namespace pairs;
  return {A.diagonal * a.xy + A.column * a.zz + B.diagonal * b.xy + B.column * b.zz +
              A.others * swapped(a.xy) + B.others * swapped(b.xy),
          sum_of(A.column * a.xy + B.row * b.xy) + A.zz * a.zz + B.zz * b.zz};
}
OSCULATE_INLINE pairs::V transposed_product_sum(const pairs::Y& A, const pairs::V& a, const pairs::M& B,
                                                const pairs::V& b) {
  using namespace pairs;
  return {A.diagonal * a.xy + A.column * a.zz + B.diagonal * b.xy + B.row * b.zz +
              swapped(A.others * a.xy + B.others * b.xy),
          sum_of(A.column * a.xy + B.column * b.xy) + A.zz * a.zz + B.zz * b.zz};
}
OSCULATE_INLINE double entry(const pairs::M& a, int i, int j) {
  if (i == 2) return j == 2 ? a.zz[0] : a.row[j];
  return j == 2 ? a.column[i] : i == j ? a.diagonal[i] : a.others[i];
}
OSCULATE_INLINE double entry(const pairs::Y& a, int i, int j) {
  return entry(full(a), i < j ? i : j, i < j ? j : i);
}

OSCULATE_INLINE pairs::M matrix_of(const Axes<double>& e) {
  using namespace pairs;
  return {first_and_second(e.x.xy, e.y.xy), first_and_second(e.y.xy, e.x.xy), e.z.xy, firsts(e.x.zz, e.y.zz),
          e.z.zz};
}

/// Constants that multiply vectors, each in both lanes.
template <>
struct Coefficients<double> {
  pairs::Pair x, y, z;
  Coefficients() = default;
  OSCULATE_INLINE Coefficients(const pairs::V& v) : x(pairs::spread(v.x)), y(pairs::spread(v.y)), z(v.zz) {}
};
OSCULATE_INLINE pairs::V operator*(const Axes<double>& e, const Coefficients<double>& v) {
  return {e.x.xy * v.x + e.y.xy * v.y + e.z.xy * v.z, e.x.zz * v.x + e.y.zz * v.y + e.z.zz * v.z};
}
template <>
struct SymmetricCoefficients<double> {
  Coefficients<double> x, y, z;  // rows
  SymmetricCoefficients() = default;
  OSCULATE_INLINE SymmetricCoefficients(const pairs::Y& a) {
    const auto [row_x, row_y, row_z] = rows_of(full(a));
    x = row_x, y = row_y, z = row_z;
  }
};
/// A symmetric matrix given along the axes.
OSCULATE_INLINE pairs::Y turned(const Axes<double>& e, const SymmetricCoefficients<double>& a) {
  return seeded(Fault::spatial_turn,
                plus_outer(plus_outer(symmetric_outer(e.x, e * a.x), e.y, e * a.y), e.z, e * a.z));
}
/// R A R^T
OSCULATE_INLINE pairs::Y turned(const pairs::M& R, const pairs::Y& a) {
  const auto [x, y, z] = rows_of(transpose(R));
  return turned(Axes<double>{x, y, z}, SymmetricCoefficients<double>(a));
}

}  // namespace osculate
