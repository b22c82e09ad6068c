#include "control/linear_response.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::linear_response_tests {

namespace {

using Wide = long double;
using WideMatrix2 = Eigen::Matrix<Wide, 2, 2>;

/// exp(A t) by scaling, 30 terms of the series, and squaring, in long double.
WideMatrix2 transition(Wide k, Wide d, Wide t) {
  WideMatrix2 A;
  A << 0, t, -k * t, -d * t;
  int squarings = 0;
  for (Wide size = A.cwiseAbs().sum(); size > 0.5L; size /= 2) ++squarings;
  A /= std::ldexp(Wide(1), squarings);
  WideMatrix2 term = WideMatrix2::Identity(), out = term;
  for (int i = 1; i < 30; ++i) {
    term = term * A / Wide(i);
    out += term;
  }
  for (int i = 0; i < squarings; ++i) out = out * out;
  return out;
}

/// Compares with the matrix exponential. The bound is built of the terms that are added, each wrong by a few
/// eps, and by eps times the exponent or angle (at most 2 sqrt(k) + d times t) for the rounding of that.
void compare(double k, double d, ErrorState start, double t) {
  INFO("k " << k << ", d " << d << ", e0 " << start.e << ", ed0 " << start.ed << ", t " << t);
  const WideMatrix2 F = transition(k, d, t);
  const auto got = linear_response(k, d, start, t);
  const double alpha = d / 2, frequency = std::sqrt(k), root = std::sqrt(std::abs(alpha * alpha - k));
  const bool real = alpha >= frequency;
  const double rate = real ? (d > 0 ? k / (alpha + root) : 0) : alpha;  // decay of the slower part
  const double h = root > 0 ? std::min(t, (real ? 0.5 : 1.0) / root) : t;
  const double decay = std::exp(-rate * t);
  const double size_e = decay * (std::abs(start.e) + (std::abs(start.ed) + rate * std::abs(start.e)) * h);
  const double size_ed =
      decay * (std::abs(start.ed) * (1 + (real ? rate : alpha) * h) + k * std::abs(start.e) * h);
  // The last term is the error of the comparison itself: squaring doubles the relative error of the
  // exponential.
  const double wide_eps = static_cast<double>(std::numeric_limits<Wide>::epsilon());
  const double turn = real ? rate * t : (alpha + root) * t;
  const double comparison = 10 * wide_eps * (1 + (d + k + 1) * t);
  const double factor = eps * (8 + 2 * turn);
  const double largest =
      static_cast<double>(F.cwiseAbs().maxCoeff()) * (std::abs(start.e) + std::abs(start.ed));
  CHECK(std::abs(static_cast<double>(got.e - (F(0, 0) * start.e + F(0, 1) * start.ed))) <=
        factor * size_e + comparison * largest);
  CHECK(std::abs(static_cast<double>(got.ed - (F(1, 0) * start.e + F(1, 1) * start.ed))) <=
        factor * size_ed + comparison * largest);
}

const std::initializer_list<ErrorState> starts{{1, 0}, {0, 1}, {0.3, -0.7}, {-2, 5}};
const std::initializer_list<double> times{0, 1e-9, 1e-3, 0.1, 0.5, 1, 3, 10};

}  // namespace

TEST_CASE("linear response in every damping regime is the matrix exponential") {
  for (const double k : {0.0, 1e-6, 1.0, 100.0, 400.0})
    for (const double d : {0.0, 1e-6, 0.5, 2.0, 20.0, 50.0})
      for (const auto start : starts)
        for (const double t : times) compare(k, d, start, t);
}

TEST_CASE("linear response loses nothing near critical damping") {
  for (const double d : {20.0, 20.3, 13.1, 17.9}) {  // (d/2)^2 is a number of double for the first only
    const double critical = d * d / 4;
    for (int bits = 1; bits <= 52; ++bits)
      for (const double sign : {-1.0, 1.0})
        for (const auto start : starts)
          for (const double t : times) compare(critical * (1 + sign * std::ldexp(1.0, -bits)), d, start, t);
    for (const auto start : starts)
      for (const double t : times) compare(critical, d, start, t);
  }
}

TEST_CASE("critically damped response has the textbook form") {
  const auto got = linear_response(100, 20, {0.01, 0}, 0.25);
  CHECK(got.e == Approx(0.01 * (1 + 10 * 0.25) * std::exp(-10 * 0.25)).epsilon(8 * eps));
  CHECK(got.ed == Approx(-100 * 0.01 * 0.25 * std::exp(-10 * 0.25)).epsilon(8 * eps));
}

TEST_CASE("without stiffness and damping the error moves on") {
  const auto got = linear_response(0, 0, {1.5, -0.25}, 8);
  CHECK(got.e == 1.5 - 0.25 * 8);
  CHECK(got.ed == -0.25);
}

TEST_CASE("without stiffness the error comes to rest") {
  const auto got = linear_response(0, 4, {1, 2}, 1e300);
  CHECK(got.e == 1.5);
  CHECK(got.ed == 0);
}

TEST_CASE("long times and strong damping stay finite") {
  for (const double t : {1e3, 1e6, 1e12, 1e300}) {
    const auto fast = linear_response(100, 1e4, {1, -3}, t);
    CHECK(fast.e >= 0);  // slow root about -0.01: the error creeps towards zero from one side
    CHECK(fast.e <= std::exp(-0.01 * t));
    CHECK(std::isfinite(fast.ed));
    const auto critical = linear_response(100, 20, {1, -3}, t);
    CHECK(critical.e == 0);
    CHECK(critical.ed == 0);
  }
  // Slow root of k = 1, d = 1e8: -1e-8 (1 + 1e-16), where alpha - sqrt(alpha^2 - k) would give -1.5e-8 or 0.
  CHECK(linear_response(1, 1e8, {1, 0}, 1e8).e == Approx(std::exp(-1.0)).epsilon(8 * eps));
}

TEST_CASE("the start is returned at t = 0, to the bit") {
  for (const double k : {0.0, 99.0, 100.0, 101.0})
    for (const double d : {0.0, 20.0}) {
      const auto got = linear_response(k, d, {0.1, -0.3}, 0);
      CHECK(got.e == 0.1);
      CHECK(got.ed == -0.3);
    }
}

}  // namespace osculate::testing::linear_response_tests
