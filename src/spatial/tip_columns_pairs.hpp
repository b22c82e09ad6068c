// Rows of six doubles in three registers of two lanes.
#pragma once

namespace osculate {

template <>
struct SixRow<double> {
  pairs::Pair low{}, middle{}, high{};
  SixRow() = default;
  OSCULATE_INLINE SixRow(pairs::Pair l, pairs::Pair m, pairs::Pair h) : low(l), middle(m), high(h) {}
  OSCULATE_INLINE SixRow(double a, double b, double c, double d, double e, double f)
      : low{a, b}, middle{c, d}, high{e, f} {}
  OSCULATE_INLINE double operator[](int i) const {
    return i < 2 ? low[i] : i < 4 ? middle[i - 2] : high[i - 4];
  }
};
OSCULATE_INLINE SixRow<double> operator+(const SixRow<double>& a, const SixRow<double>& b) {
  return {a.low + b.low, a.middle + b.middle, a.high + b.high};
}
OSCULATE_INLINE SixRow<double> operator-(const SixRow<double>& a, const SixRow<double>& b) {
  return {a.low - b.low, a.middle - b.middle, a.high - b.high};
}
OSCULATE_INLINE SixRow<double> operator*(const SixRow<double>& a, pairs::Pair s) {
  return {a.low * s, a.middle * s, a.high * s};
}
OSCULATE_INLINE SixRow<double> operator*(const SixRow<double>& a, double s) { return a * pairs::spread(s); }
OSCULATE_INLINE SixRow<double> plus_scaled(const SixRow<double>& sum, const SixRow<double>& row,
                                           pairs::Pair s) {
  return sum + row * s;
}
OSCULATE_INLINE SixRow<double> plus_scaled(const SixRow<double>& sum, const SixRow<double>& row, double s) {
  return sum + row * s;
}
OSCULATE_INLINE SixRow<double> less_scaled(const SixRow<double>& sum, const SixRow<double>& row,
                                           pairs::Pair s) {
  return sum - row * s;
}
OSCULATE_INLINE SixRow<double> less_scaled(const SixRow<double>& sum, const SixRow<double>& row, double s) {
  return sum - row * s;
}

template <>
struct TipMobility<double> {
  std::array<pairs::Pair, 6> low{};     // columns 0 and 1 of each row
  std::array<pairs::Pair, 4> middle{};  // columns 2 and 3 of rows 2 to 5
  std::array<pairs::Pair, 2> high{};    // columns 4 and 5 of rows 4 and 5
  OSCULATE_INLINE double entry(int i, int j) const {
    if (i < j) std::swap(i, j);
    const auto row = static_cast<std::size_t>(i);
    return j < 2 ? low[row][j] : j < 4 ? middle[row - 2][j - 2] : high[row - 4][j - 4];
  }
};
OSCULATE_INLINE TipMobility<double> plus_outer(const TipMobility<double>& sum, const SixRow<double>& a,
                                               const SixRow<double>& b) {
  using pairs::Pair, pairs::spread;
  const auto& [low, middle, high] = sum;
  const Pair x = spread<0>(a.low), y = spread<1>(a.low), z = spread<0>(a.middle);
  const Pair u = spread<1>(a.middle), v = spread<0>(a.high), w = spread<1>(a.high);
  return {{low[0] + x * b.low, low[1] + y * b.low, low[2] + z * b.low, low[3] + u * b.low, low[4] + v * b.low,
           low[5] + w * b.low},
          {middle[0] + z * b.middle, middle[1] + u * b.middle, middle[2] + v * b.middle,
           middle[3] + w * b.middle},
          {high[0] + v * b.high, high[1] + w * b.high}};
}

}  // namespace osculate
