// Sine and cosine of many angles at once, without a branch for each.
//
// Error below 1 ulp: at most 0.79 ulp over the angles of tests/scalar/sine_cosine_test.cpp, against
// arithmetic of 113 bits. About 50 instructions for each register of lanes.
//
// An angle is x = n pi/2 + r with n a whole number and |r| <= pi/4. pi/2 is taken in three parts (Cody and
// Waite): two of 37 bits, so that n times each is exact for |n| < 2^16, and one of 53 bits; what is left of
// pi/2 is 5.3e-40. r is kept as a sum high + low. The closest that a double below 10^5 comes to a multiple of
// pi/2 (n > 0) is 2^-60.5, at n = 29: r then still has more than 60 correct bits.
//
// On |r| <= pi/4 the polynomials are those of fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c), whose
// published coefficients are minimax there:
//   sin r = r + r^3 (S1 + .. + S6 r^10)           within 2^-58 relative
//   cos r = 1 - r^2/2 + r^4 (C1 + .. + C6 r^10)   within 2^-58
// sin(high + low) = sin high + low (1 - high^2/2) and cos(high + low) = cos high - low high, to rounding.
//
// Every lane takes the same operations, and no expression leaves the compiler a choice of which product to
// fuse with an addition: a result depends on its own angle only, not on its place, its neighbours or the
// number of lanes. Builds with and without fused multiply-add differ in the last bit.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "scalar/lanes.hpp"

namespace osculate {

/// Above this, rad, and for values that are not finite, the C library answers.
inline constexpr double largest_vector_angle = 1e5;

namespace sine_cosine_detail {

/// Every constant, repeated for each lane.
template <int N>
struct Constants {
  typename LanesOf<N>::Numbers two_over_pi, shifter, part1, part2, part3;
  typename LanesOf<N>::Numbers S1, S2, S3, S4, S5, S6, C1, C2, C3, C4, C5, C6, one, half, largest;
  typename LanesOf<N>::Words sign;  // the sign bit
};
template <int N>
inline constexpr Constants<N> constants = [] {
  const auto all = [](double x) { return typename LanesOf<N>::Numbers{} + x; };
  Constants<N> k{};
  k.two_over_pi = all(0x1.45f306dc9c883p-1);
  k.shifter = all(0x1.8p52);
  k.part1 = all(0x1.921fb54440000p+0), k.part2 = all(0x1.68c234c4c0000p-39),
  k.part3 = all(0x1.98a2e03707345p-77);
  // Those of the sine doubled, which is exact, because they meet r^2 / 2.
  k.S1 = all(2 * -1.66666666666666324348e-01), k.S2 = all(2 * 8.33333333332248946124e-03);
  k.S3 = all(2 * -1.98412698298579493134e-04), k.S4 = all(2 * 2.75573137070700676789e-06);
  k.S5 = all(2 * -2.50507602534068634195e-08), k.S6 = all(2 * 1.58969099521155010221e-10);
  k.C1 = all(4.16666666666666019037e-02), k.C2 = all(-1.38888888888741095749e-03);
  k.C3 = all(2.48015872894767294178e-05), k.C4 = all(-2.75573143513906633035e-07);
  k.C5 = all(2.08757232129817482790e-09), k.C6 = all(-1.13596475577881948265e-11);
  k.one = all(1), k.half = all(0.5), k.largest = all(largest_vector_angle);
  k.sign = typename LanesOf<N>::Words{} + INT64_MIN;
  return k;
}();

/// The constants by an address that the compiler cannot see through. It would else keep all of them in
/// registers that it does not have, at the cost of the arithmetic; so they stay operands in memory.
template <int N>
OSCULATE_INLINE const Constants<N>& constants_in_memory() {
  const Constants<N>* address = &constants<N>;
  asm("" : "+r"(address));
  return *address;
}

/// sine, cosine of N angles of at most largest_vector_angle; anything for other angles. By reference: passing
/// vectors by value has an ABI that depends on the target.
template <int N>
OSCULATE_INLINE void of_lanes(const Constants<N>& k, const typename LanesOf<N>::Numbers& angle,
                              typename LanesOf<N>::Numbers& sine, typename LanesOf<N>::Numbers& cosine) {
  using Numbers = typename LanesOf<N>::Numbers;
  using Words = typename LanesOf<N>::Words;

  // n = the whole number nearest to angle / (pi/2). Adding 1.5 2^52 rounds, and leaves n in the low bits.
  const Numbers shifted = angle * k.two_over_pi + k.shifter;
  const Numbers n = shifted - k.shifter;

  // r = high + low = angle - n pi/2. The first two products are exact, and so is `first`.
  const Numbers first = angle - n * k.part1;
  const Numbers second = first - n * k.part2;
  const Numbers missing = n * k.part3 - ((first - second) - n * k.part2);
  const Numbers high = second - missing;
  const Numbers low = (second - high) - missing;

  const Numbers square = high * high;
  const Numbers half = square * k.half;
  const Numbers s =
      ((((square * k.S6 + k.S5) * square + k.S4) * square + k.S3) * square + k.S2) * square + k.S1;
  const Numbers c =
      ((((square * k.C6 + k.C5) * square + k.C4) * square + k.C3) * square + k.C2) * square + k.C1;
  const Numbers sine_r = high - (half * (low - high * s) - low);
  const Numbers top = k.one - half;
  const Numbers rest = (k.one - top) - half;  // what rounding took from `top`
  const Numbers cosine_r = top + (high * (high * (square * c) - low) + rest);

  // n mod 4: odd exchanges sine and cosine; the sine is negative for 2, 3 and the cosine for 1, 2.
  Words turns;
  std::memcpy(&turns, &shifted, sizeof turns);
  const Words exchanged = -(turns & 1);
  Words sine_bits, cosine_bits;
  std::memcpy(&sine_bits, &sine_r, sizeof sine_bits);
  std::memcpy(&cosine_bits, &cosine_r, sizeof cosine_bits);
  const Words difference = (sine_bits ^ cosine_bits) & exchanged;
  sine_bits ^= difference ^ ((turns << 62) & k.sign);
  cosine_bits ^= difference ^ (((turns + 1) << 62) & k.sign);
  std::memcpy(&sine, &sine_bits, sizeof sine);
  std::memcpy(&cosine, &cosine_bits, sizeof cosine);
}

/// The C library's answer where of_lanes has none.
[[gnu::cold, gnu::noinline]] inline void by_library(const double* angle, double* sine, double* cosine,
                                                    std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (!(std::abs(angle[i]) <= largest_vector_angle))
      sine[i] = std::sin(angle[i]), cosine[i] = std::cos(angle[i]);
}

/// -1 in every lane whose angle of_lanes can take.
template <int N>
OSCULATE_INLINE void mark_ordinary(const Constants<N>& k, const typename LanesOf<N>::Numbers& angle,
                                   typename LanesOf<N>::Words& ordinary) {
  const auto size = (typename LanesOf<N>::Numbers)((typename LanesOf<N>::Words)angle & ~k.sign);
  ordinary &= size <= k.largest;
}
template <int N>
OSCULATE_INLINE bool every_lane(const typename LanesOf<N>::Words& words) {
#ifdef __AVX__
  if constexpr (N == 4) return __builtin_ia32_movmskpd256((LanesOf<4>::Numbers)words) == 15;
#endif
  std::int64_t all = -1;
  for (int i = 0; i < N; ++i) all &= words[i];
  return all != 0;
}

template <int width>
void of_array(const double* angle, double* sine, double* cosine, std::size_t count);
/// Of fewer angles than a register holds.
template <int width>
[[gnu::noinline]] void of_few(const double* angle, double* sine, double* cosine, std::size_t count) {
  std::array<double, width> few{}, few_sines, few_cosines;
  for (std::size_t i = 0; i < count; ++i) few[i] = angle[i];
  of_array<width>(few.data(), few_sines.data(), few_cosines.data(), width);
  for (std::size_t i = 0; i < count; ++i) sine[i] = few_sines[i], cosine[i] = few_cosines[i];
}
/// sine_cosine with registers of `width` lanes.
template <int width>
void of_array(const double* angle, double* sine, double* cosine, std::size_t count) {
  if (count < width) return of_few<width>(angle, sine, cosine, count);
  const Constants<width>& k = constants_in_memory<width>();
  typename LanesOf<width>::Numbers x, s, c;
  typename LanesOf<width>::Words ordinary = {};
  ordinary = ~ordinary;
  for (std::size_t done = 0; done < count; done += width) {
    // The last register goes back as far as it must to be full: some angles are then done twice, alike.
    const std::size_t at = done + width <= count ? done : count - width;
    std::memcpy(&x, angle + at, sizeof x);
    mark_ordinary<width>(k, x, ordinary);
    of_lanes<width>(k, x, s, c);
    std::memcpy(sine + at, &s, sizeof s);
    std::memcpy(cosine + at, &c, sizeof c);
  }
  if (!every_lane<width>(ordinary)) return by_library(angle, sine, cosine, count);
}

}  // namespace sine_cosine_detail

/// sine[i], cosine[i] of angle[i], rad, for `count` angles; below 1 ulp up to largest_vector_angle, the C
/// library's values beyond, and not a number where the angle is not finite. The three arrays must not
/// overlap. The same angle gives the same bits wherever it stands.
inline void sine_cosine(const double* angle, double* sine, double* cosine, std::size_t count) {
  // 4 lanes where 8 would fit: arms have few joints.
  sine_cosine_detail::of_array<(native_lanes < 4 ? native_lanes : 4)>(angle, sine, cosine, count);
}

}  // namespace osculate
