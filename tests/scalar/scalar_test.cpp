// The scalars that are measured with: 113-bit numbers and counted operations.
#include <thread>

#include "model/random_arm.hpp"
#include "scalar/counted.hpp"
#include "scalar/quad.hpp"
#include "support/catch.hpp"

namespace osculate::testing::scalar_tests {
using osculate::Random;

static_assert(Field<Quad> && Ordered<Quad>);
static_assert(Field<Counted> && Ordered<Counted>);
static_assert(!std::is_convertible_v<double, Quad> && !std::is_convertible_v<Quad, double>);

namespace {

/// A number with all of its 113 bits in use: two doubles side by side.
Quad wide(Random& random, double low, double high) {
  return Quad(random.uniform(low, high)) + Quad(0x1p-53) * Quad(random.uniform(-1, 1));
}

Matrix3<Counted> counted_matrix(Random& random) {
  Matrix3<Counted> out;
  for (Counted& x : out.reshaped()) x = Counted(random.uniform(-1, 1));
  return out;
}

}  // namespace

TEST_CASE("a Quad has 113 bits, no fewer and no more") {
  const Quad one(1), ulp(0x1p-112), half_ulp(0x1p-113);
  CHECK(one + ulp != one);
  CHECK((one + ulp) - one == ulp);
  CHECK(one + half_ulp == one);  // ties to even
  CHECK(one + half_ulp * Quad(3) == one + ulp + ulp);
  CHECK(quad_epsilon() == ulp);
  CHECK(Eigen::NumTraits<Quad>::epsilon() == ulp);
}

TEST_CASE("Quad obeys the laws of arithmetic to its rounding, and rounds to nearest") {
  const Quad eps = quad_epsilon();
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Quad x = wide(random, -2, 2), y = wide(random, 1, 2), z = wide(random, -2, 2);
    CHECK(x + y == y + x);
    CHECK(x * y == y * x);
    CHECK(x - x == Quad(0));
    CHECK(-(-x) == x);
    CHECK(x + (-y) == x - y);
    CHECK(x * Quad(1) == x);
    CHECK(y / y == Quad(1));
    // One rounding for each operation: half an ulp of a result below 8 for sums, below 4 for products.
    CHECK(abs((x + y) + z - (x + (y + z))) <= Quad(8) * eps);
    CHECK(abs(x * (y + z) - (x * y + x * z)) <= Quad(16) * eps);
    CHECK(abs(x / y * y - x) <= abs(x) * Quad(2) * eps);
    Quad sum = x;
    sum += y, sum -= z, sum *= y, sum /= z;
    CHECK(sum == (x + y - z) * y / z);
  }
}

TEST_CASE("doubles pass through Quad unchanged, and Quads become the nearest double") {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const double x = random.uniform(-1e3, 1e3);
    CHECK(double(Quad(x)) == x);
    // A product of two doubles has at most 106 bits: exact here, and the rounded product in double.
    const double y = random.uniform(-1e3, 1e3);
    const Quad product = Quad(x) * Quad(y);
    CHECK(double(product) == x * y);
    CHECK(product - Quad(x * y) == Quad(std::fma(x, y, -(x * y))));
  }
  CHECK(double(Quad(1) + Quad(0x1p-112)) == 1.0);
  CHECK(double(Quad(1) / Quad(3)) == 1.0 / 3.0);
}

TEST_CASE("Quads are ordered, and not-a-number is not") {
  CHECK(Quad(1) < Quad(1) + quad_epsilon());
  CHECK(Quad(-2) < Quad(1));
  CHECK(Quad(3) >= Quad(3));
  CHECK(abs(Quad(-3)) == Quad(3));
  CHECK(abs(Quad(3)) == Quad(3));
  const Quad nan = sqrt(Quad(-1));
  CHECK_FALSE(nan == nan);
  CHECK_FALSE(nan < Quad(1));
  CHECK_FALSE(nan >= Quad(1));
  CHECK((nan <=> Quad(1)) == std::partial_ordering::unordered);
}

TEST_CASE("sqrt, sin and cos are good to the last bits of a Quad") {
  const Quad eps = quad_epsilon();
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Quad x = wide(random, 0.1, 4), y = wide(random, -3, 3);
    const Quad root = sqrt(x);
    CHECK(abs(root * root - x) <= Quad(2) * eps * x);
    CHECK(sqrt(y * y * Quad(4)) / Quad(2) >= abs(y) * (Quad(1) - Quad(2) * eps));

    // Each value is good to an ulp (<= eps); the rest counts roundings of numbers up to 1.
    const Quad s = sin(y), c = cos(y);
    CHECK(abs(s * s + c * c - Quad(1)) <= Quad(6) * eps);
    const Quad twice = y + y;  // exact
    CHECK(abs(sin(twice) - Quad(2) * s * c) <= Quad(6) * eps);
    CHECK(abs(cos(twice) - (c * c - s * s)) <= Quad(6) * eps);
    // Agreement with double pins the branch, which the identities leave open.
    CHECK(std::abs(double(s) - std::sin(double(y))) <= 4 * Eigen::NumTraits<double>::epsilon());
    CHECK(std::abs(double(c) - std::cos(double(y))) <= 4 * Eigen::NumTraits<double>::epsilon());
  }
  // sin x against its series where eight terms reach below 2^-120.
  const Quad x(0x1p-6);
  Quad term = x, series = x;
  for (int k = 1; k < 12; ++k) series += term = -term * x * x / Quad(2 * k * (2 * k + 1));
  CHECK(abs(sin(x) - series) <= Quad(2) * eps * x);
}

TEST_CASE("Eigen multiplies Quads without losing bits") {
  // Dekker's product as a 2 x 2 determinant: the terms cancel to 2^-106, below anything a double could hold.
  const double a = 1 + 0x1p-52;
  MatrixX<Quad> A(2, 2), B(2, 2);
  A << Quad(a), Quad(1), Quad(2), Quad(a);
  B << Quad(a), Quad(0), Quad(-(1 + 0x1p-51)), Quad(1);
  const MatrixX<Quad> AB = A * B;
  CHECK(AB(0, 0) == Quad(0x1p-104));
  CHECK(AB(0, 1) == Quad(1));
  CHECK(AB(1, 1) == Quad(a));
  CHECK(AB.cast<double>()(0, 0) == 0x1p-104);

  Random random(4);
  const Matrix3<Quad> R = random.rotation_matrix().cast<Quad>();
  CHECK((R * R.transpose() - Matrix3<Quad>::Identity()).norm() > Quad(0x1p-60));  // rounded in double
  const Vector3<Quad> v(Quad(3), Quad(4), Quad(12));
  CHECK(v.norm() == Quad(13));
  CHECK(v.cwiseAbs().maxCoeff() == Quad(12));
}

TEST_CASE("Counted does the arithmetic of double") {
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const double x = random.uniform(-2, 2), y = random.uniform(1, 2);
    Counted z(x);
    z += Counted(y), z -= Counted(0.5), z *= Counted(y), z /= Counted(3);
    CHECK(double(z) == (x + y - 0.5) * y / 3);
    CHECK(double(-Counted(x)) == -x);
    CHECK(double(abs(Counted(x))) == std::abs(x));
    CHECK(double(sqrt(Counted(y))) == std::sqrt(y));
    CHECK((Counted(x) < Counted(y)) == (x < y));
  }
}

TEST_CASE("operations are counted by kind, inside a scope and nowhere else") {
  const Counted x(2), y(3);
  Tally tally;
  const Counted before = x * y;
  {
    const CountingScope scope(tally);
    const Counted z = -(x * y + x * x - Counted(1)) / sqrt(y) * Counted(2);
    Counted copy = z, fresh;
    fresh = copy;
    CHECK(fresh == z);  // comparing is free
    CHECK(abs(z) > Counted(0));
    copy += x, copy -= y, copy *= x, copy /= y;
  }
  const Counted after = x + y;
  CHECK(before == after + Counted(1));
  CHECK(tally == Tally{4, 4, 1, 2, 1});
  CHECK(tally - Tally{3, 4, 0, 2, 1} == Tally{1, 0, 1, 0, 0});
}

TEST_CASE("scopes nest, and every thread counts for itself") {
  const Counted x(2);
  Tally outer, inner, other;
  {
    const CountingScope first(outer);
    Counted y = x * x;
    {
      const CountingScope second(inner);
      y = x + x;
    }
    y = y / x;
    std::thread([&other, &x] {
      const Counted unseen = x * x;  // no scope in this thread yet
      const CountingScope here(other);
      const Counted seen = unseen - x;
      CHECK(seen == x);
    }).join();
  }
  CHECK(outer == Tally{1, 0, 0, 1, 0});
  CHECK(inner == Tally{0, 1, 0, 0, 0});
  CHECK(other == Tally{0, 1, 0, 0, 0});
}

TEST_CASE("Eigen's products over Counted cost what the formula says") {
  Random random(6);
  const Matrix3<Counted> A = counted_matrix(random), B = counted_matrix(random);
  const Vector3<Counted> v = A.col(0);
  Tally tally;
  Matrix3<Counted> AB;
  Vector3<Counted> Av;
  {
    const CountingScope scope(tally);
    AB = A * B;
    Av = A * v;
  }
  CHECK(tally == Tally{27 + 9, 18 + 6, 0, 0, 0});
  CHECK(AB.cast<double>().isApprox(A.cast<double>() * B.cast<double>()));
  CHECK(Av.cast<double>().isApprox(A.cast<double>() * A.cast<double>().col(0)));
}

}  // namespace osculate::testing::scalar_tests
