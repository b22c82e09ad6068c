// Packets do in every lane what a double does alone, bit for bit.
#include "scalar/packet.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "scalar/field.hpp"
#include "support/catch.hpp"

namespace osculate::testing::packet_tests {

static_assert(Field<Packet<2>> && Field<Packet<4>> && Field<Packet<8>>);
static_assert(!Ordered<Packet<4>>);
static_assert(sizeof(Packet<2>) == 16 && sizeof(Packet<4>) == 32 && sizeof(Packet<8>) == 64);
static_assert(native_lanes == 2 || native_lanes == 4 || native_lanes == 8);

namespace {

bool same_bits(double x, double y) {
  return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
}

template <int N>
Packet<N> random_packet(std::mt19937_64& random) {
  Packet<N> out;
  for (int i = 0; i < N; ++i) out.set(i, std::uniform_real_distribution<double>(-10, 10)(random));
  return out;
}

}  // namespace

TEMPLATE_TEST_CASE_SIG("every lane rounds as a double does", "", ((int N), N), 2, 4, 8) {
  std::mt19937_64 random(N);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Packet<N> x = random_packet<N>(random), y = random_packet<N>(random);
    const Packet<N> sum = x + y, difference = x - y, product = x * y, quotient = x / y, opposite = -x;
    Packet<N> in_place = x;
    in_place += y;
    in_place -= x;
    in_place *= x;
    in_place /= y;
    for (int i = 0; i < N; ++i) {
      // Through memory, so that the compiler fuses none of them.
      volatile double a = x[i], b = y[i], step;
      CHECK(same_bits(sum[i], a + b));
      CHECK(same_bits(difference[i], a - b));
      CHECK(same_bits(product[i], a * b));
      CHECK(same_bits(quotient[i], a / b));
      CHECK(same_bits(opposite[i], -a));
      step = a + b;
      step = step - a;
      step = step * a;
      step = step / b;
      CHECK(same_bits(in_place[i], step));
    }
  }
}

TEMPLATE_TEST_CASE_SIG("constants fill every lane, and lanes can be set one by one", "", ((int N), N), 2, 4,
                       8) {
  Packet<N> x(0.1);
  for (int i = 0; i < N; ++i) CHECK(x[i] == 0.1);
  x = Packet<N>(3);
  for (int i = 0; i < N; ++i) CHECK(x[i] == 3.0);
  for (int i = 0; i < N; ++i) x.set(i, i);
  const Packet<N> copy = x;
  for (int i = 0; i < N; ++i) CHECK(copy[i] == i);
  CHECK(first_lane(copy) == 0);
  CHECK(same_bits((-Packet<N>(0))[N - 1], -0.0));
}

TEMPLATE_TEST_CASE_SIG("packets go to memory and back in order", "", ((int N), N), 2, 4, 8) {
  double numbers[9] = {-1, 0, 1, 2, 3, 4, 5, 6, 7}, back[9] = {};
  const Packet<N> x = packet_at<N>(numbers + 1);  // where no packet is aligned
  for (int i = 0; i < N; ++i) CHECK(x[i] == i);
  store(x, back + 1);
  for (int i = 0; i <= N; ++i) CHECK(back[i] == (i == 0 ? 0 : numbers[i]));
}

TEMPLATE_TEST_CASE_SIG("sines of packets have the bits of the scalar function", "", ((int N), N), 2, 4, 8) {
  std::mt19937_64 random(N);
  Packet<N> angles[5], sines[5], cosines[5];
  for (Packet<N>& x : angles) x = random_packet<N>(random);
  angles[1].set(N - 1, 1e9);  // for the C library
  angles[2].set(0, std::numeric_limits<double>::quiet_NaN());
  sine_cosine(angles, sines, cosines, 5);
  for (int k = 0; k < 5; ++k)
    for (int i = 0; i < N; ++i) {
      const double angle = angles[k][i];
      double sine, cosine;
      sine_cosine(&angle, &sine, &cosine, 1);
      if (std::isnan(angle)) {
        CHECK(std::isnan(sines[k][i]));
        CHECK(std::isnan(cosines[k][i]));
        continue;
      }
      CHECK(same_bits(sines[k][i], sine));
      CHECK(same_bits(cosines[k][i], cosine));
      CHECK(same_bits(sin(angles[k])[i], sine));
      CHECK(same_bits(cos(angles[k])[i], cosine));
    }
}

TEST_CASE("Eigen multiplies matrices of packets") {
  using Matrix = Eigen::Matrix<Packet<4>, 3, 3>;
  std::mt19937_64 random(3);
  Matrix A, B;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) A(i, j) = random_packet<4>(random), B(i, j) = random_packet<4>(random);
  const Matrix C = A * B;
  for (int lane = 0; lane < 4; ++lane)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += A(i, k)[lane] * B(k, j)[lane];
        CHECK(std::abs(C(i, j)[lane] - sum) <= 3 * 300 * 0x1p-52);  // three products below 100
      }
}

}  // namespace osculate::testing::packet_tests
