// The sines and cosines of scalar/sine_cosine.hpp against 113-bit arithmetic.
#include "scalar/sine_cosine.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "scalar/quad.hpp"
#include "support/catch.hpp"

namespace osculate::testing::sine_cosine_tests {

namespace {

struct SinesCosines {
  std::vector<double> sine, cosine;
};

SinesCosines of(const std::vector<double>& angles) {
  SinesCosines out{std::vector<double>(angles.size()), std::vector<double>(angles.size())};
  sine_cosine(angles.data(), out.sine.data(), out.cosine.data(), angles.size());
  return out;
}

/// |x - exact| in units of the last place of the exact value.
double ulps(double x, const Quad& exact) {
  const double near = std::abs(double(exact));
  const int exponent = std::max(std::ilogb(near), -1022);
  return std::abs(double((Quad(x) - exact) * Quad(std::ldexp(1.0, 52 - exponent))));
}

double worst_ulps(const std::vector<double>& angles) {
  const SinesCosines found = of(angles);
  double worst = 0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const Quad x(angles[i]);
    worst = std::max({worst, ulps(found.sine[i], sin(x)), ulps(found.cosine[i], cos(x))});
  }
  return worst;
}

/// Random angles of every size up to the largest, and the doubles next to multiples of pi/4.
std::vector<double> hard_angles(std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> turn(-4, 4), far(-1e5, 1e5), exponent(-40, 16.6);
  std::uniform_int_distribution<int> multiple(-127000, 127000), steps(-8, 8);
  const Quad quarter = (Quad(0x1.921fb54442d18p+1) + Quad(0x1.1a62633145c07p-53)) / Quad(4);  // pi/4
  const auto beside_a_multiple = [&] {
    double x(quarter * Quad(multiple(random)));
    for (int i = steps(random); i != 0; i += i < 0 ? 1 : -1) x = std::nextafter(x, i < 0 ? -1e9 : 1e9);
    return x;
  };
  std::vector<double> out;
  while (out.size() < count) {
    const double candidates[] = {turn(random), far(random),
                                 std::copysign(std::exp2(exponent(random)), turn(random)),
                                 beside_a_multiple()};
    for (double x : candidates)
      if (std::abs(x) <= largest_vector_angle) out.push_back(x);
  }
  return out;
}

/// Bits, so that -0 and 0 differ and not-a-number equals itself.
bool same_bits(double x, double y) {
  return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
}

}  // namespace

TEST_CASE("sines and cosines are within 0.9 ulp") {
  const double worst = worst_ulps(hard_angles(150'000));
  CAPTURE(worst);
  // The last rounding: 0.5. Near pi/4, where the second term of the sine is largest against the result, it is
  // 0.081 and carries five roundings of 2^-53 of itself, 0.4 of an ulp of 2^-53.
  CHECK(worst < 0.9);
  CHECK(worst > 0.5);  // or else the comparison is not with more digits than a double has
}

TEST_CASE("the doubles nearest to multiples of pi/2 keep every bit") {
  std::vector<double> angles;
  const Quad half_pi = (Quad(0x1.921fb54442d18p+1) + Quad(0x1.1a62633145c07p-53)) / Quad(2);
  for (int n = 1; n <= 63661; ++n) angles.push_back(double(half_pi * Quad(n)));
  angles.push_back(double(half_pi * Quad(29)));  // the closest of all: 2^-60.5
  const double worst = worst_ulps(angles);
  CAPTURE(worst);
  CHECK(worst < 0.9);
}

TEST_CASE("a result depends on its own angle alone") {
  std::vector<double> angles = hard_angles(64);
  const SinesCosines together = of(angles);
  for (std::size_t count = 0; count <= 19; ++count)
    for (std::size_t from = 0; from + count <= angles.size(); from += 5) {
      const SinesCosines apart = of({angles.begin() + from, angles.begin() + from + count});
      for (std::size_t i = 0; i < count; ++i) {
        CHECK(same_bits(apart.sine[i], together.sine[from + i]));
        CHECK(same_bits(apart.cosine[i], together.cosine[from + i]));
      }
    }
}

TEST_CASE("large angles and values that are not finite go to the C library, and only they do") {
  const double infinity = std::numeric_limits<double>::infinity();
  const double odd[] = {1.0000000001e5, -3e5, 1e22, infinity, -infinity, std::nan("")};
  const std::vector<double> ordinary = hard_angles(13);
  const SinesCosines alone = of(ordinary);
  for (double x : odd)
    for (std::size_t place = 0; place < ordinary.size(); ++place) {
      std::vector<double> angles = ordinary;
      angles[place] = x;
      const SinesCosines found = of(angles);
      for (std::size_t i = 0; i < angles.size(); ++i)
        if (i != place) {
          CHECK(same_bits(found.sine[i], alone.sine[i]));
          CHECK(same_bits(found.cosine[i], alone.cosine[i]));
        } else if (std::isfinite(x)) {
          CHECK(same_bits(found.sine[i], std::sin(x)));
          CHECK(same_bits(found.cosine[i], std::cos(x)));
        } else {
          CHECK(std::isnan(found.sine[i]));
          CHECK(std::isnan(found.cosine[i]));
        }
    }
}

TEST_CASE("zero and tiny angles are their own sines") {
  const std::vector<double> angles{0.0, 1e-300, -1e-300, 5e-324, 1e-10};
  const SinesCosines found = of(angles);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    CHECK(same_bits(found.sine[i], angles[i]));
    CHECK(found.cosine[i] == 1);
  }
}

}  // namespace osculate::testing::sine_cosine_tests
