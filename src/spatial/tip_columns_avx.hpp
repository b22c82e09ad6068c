// Rows of six doubles in two AVX registers: four lanes, and two with two zeros.
#pragma once

namespace osculate {

template <>
struct SixRow<double> {
  avx::Lanes first{}, last{};
  SixRow() = default;
  OSCULATE_INLINE SixRow(avx::Lanes low, avx::Lanes high) : first(low), last(high) {}
  OSCULATE_INLINE SixRow(double a, double b, double c, double d, double e, double f)
      : first{a, b, c, d}, last{e, f, 0, 0} {}
  OSCULATE_INLINE double operator[](int i) const { return i < 4 ? first[i] : last[i - 4]; }
};
OSCULATE_INLINE SixRow<double> plus_scaled(const SixRow<double>& sum, const SixRow<double>& row, double s) {
  const avx::Lanes all = avx::spread(s);
  return {sum.first + row.first * all, sum.last + row.last * all};
}
OSCULATE_INLINE SixRow<double> less_scaled(const SixRow<double>& sum, const SixRow<double>& row, double s) {
  const avx::Lanes all = avx::spread(s);
  return {sum.first - row.first * all, sum.last - row.last * all};
}
OSCULATE_INLINE SixRow<double> operator*(const SixRow<double>& a, double s) {
  const avx::Lanes all = avx::spread(s);
  return {a.first * all, a.last * all};
}
OSCULATE_INLINE SixRow<double> operator+(const SixRow<double>& a, const SixRow<double>& b) {
  return {a.first + b.first, a.last + b.last};
}
OSCULATE_INLINE SixRow<double> operator-(const SixRow<double>& a, const SixRow<double>& b) {
  return {a.first - b.first, a.last - b.last};
}

template <>
struct TipMobility<double> {
  std::array<avx::Lanes, 6> left{};  // columns 0 to 3 of each row
  avx::Lanes corner{};               // (4,4) (4,5) (5,4) (5,5)
  OSCULATE_INLINE double entry(int i, int j) const {
    if (j >= 4 && i < 4) return left[static_cast<std::size_t>(j)][i];
    return j < 4 ? left[static_cast<std::size_t>(i)][j] : corner[2 * (i - 4) + j - 4];
  }
};
OSCULATE_INLINE TipMobility<double> plus_outer(const TipMobility<double>& sum, const SixRow<double>& a,
                                               const SixRow<double>& b) {
  using avx::spread;
  const auto& row = sum.left;
  return {{row[0] + b.first * spread<0>(a.first), row[1] + b.first * spread<1>(a.first),
           row[2] + b.first * spread<2>(a.first), row[3] + b.first * spread<3>(a.first),
           row[4] + b.first * spread<0>(a.last), row[5] + b.first * spread<1>(a.last)},
          sum.corner + __builtin_shufflevector(a.last, a.last, 0, 0, 1, 1) *
                           __builtin_shufflevector(b.last, b.last, 0, 1, 0, 1)};
}
OSCULATE_INLINE Compliance<double> compliance_of(const TipMobility<double>& a) {
  using avx::three_lanes;
  // Columns 0 to 2 of rows 3 to 5 are the columns of B.
  const avx::Rows B{three_lanes(a.left[3]), three_lanes(a.left[4]), three_lanes(a.left[5])};
  const auto [x, y, z] = avx::transposed(B);
  const avx::V first{a.left[3][3], a.left[4][3], a.left[5][3]};
  const avx::Y A{first, {a.left[4][3], a.corner[0], a.corner[1]}, {a.left[5][3], a.corner[2], a.corner[3]}};
  return {
      {three_lanes(a.left[0]), three_lanes(a.left[1]), three_lanes(a.left[2])}, {x, y, z, B.x, B.y, B.z}, A};
}

}  // namespace osculate
