// The scalars behind the exact and the differentiated runs: Dual and Rational, alone and inside Eigen.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "model/random_arm.hpp"
#include "scalar/dual.hpp"
#include "scalar/rational.hpp"
#include "scalar/rational_product.hpp"
#include "support/catch.hpp"

namespace osculate::testing::numbers_tests {

static_assert(Field<Rational> && Ordered<Rational>);
static_assert(Field<Dual<double>> && !Ordered<Dual<double>>);
static_assert(Field<Dual<Dual<Rational>>>);

namespace {

// x^3 / (1 + x), with first derivative (3 x^2 + 2 x^3) / (1 + x)^2 and second (2 x^3 + 6 x^2 + 6 x) / (1 +
// x)^3.
template <class N>
N f(const N& x) {
  return x * x * x / (N(1) + x);
}

}  // namespace

TEST_CASE("dual numbers carry the derivative of a rational function exactly") {
  const Rational x(2, 3);
  const Rational one(1);
  const auto y = f(Dual<Rational>(x, 1));
  CHECK(y.value == f(x));
  CHECK(y.derivative == (3 * x * x + 2 * x * x * x) / ((one + x) * (one + x)));
}

TEST_CASE("nested dual numbers carry the second derivative exactly") {
  using D = Dual<Rational>;
  const Rational x(2, 3);
  const Rational one(1);
  const auto y = f(Dual<D>(D(x, 1), D(1)));
  CHECK(y.value.derivative == y.derivative.value);
  CHECK(y.derivative.derivative == (2 * x * x * x + 6 * x * x + 6 * x) / ((one + x) * (one + x) * (one + x)));
}

TEST_CASE("dual arithmetic: constants, sign, compound operators") {
  const Dual<double> x(3, 2), y(-4, 5);
  CHECK(Dual<double>(7).derivative == 0);
  CHECK(Dual<double>(0.5).value == 0.5);
  CHECK((-x).value == -3);
  CHECK((-x).derivative == -2);
  auto z = x;
  z += y;
  CHECK((z.value == -1 && z.derivative == 7));
  z -= y;
  CHECK((z.value == 3 && z.derivative == 2));
  z *= y;
  CHECK((z.value == -12 && z.derivative == 7));  // 2 (-4) + 3 5
  z /= y;
  CHECK((z.value == 3 && z.derivative == 2));
}

TEST_CASE("matrices of dual numbers follow the product rule exactly") {
  Random random(1);
  using M = Eigen::Matrix<Rational, 3, 3>;
  const M A = random.exact_rotation(), dA = random.exact_rotation();
  const M B = random.exact_rotation(), dB = random.exact_rotation();
  Eigen::Matrix<Dual<Rational>, 3, 3> a, b;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      a(i, j) = {A(i, j), dA(i, j)};
      b(i, j) = {B(i, j), dB(i, j)};
    }
  CHECK(values(a * b) == M(A * B));
  CHECK(derivatives(a * b) == M(A * dB + dA * B));
}

TEST_CASE(
    "products of matrices of fractions are those of whole numbers over doubles, which are exact there") {
  Random random(4);
  const auto whole = [&](int rows, int columns) {
    return MatrixX<double>(
        MatrixX<double>::NullaryExpr(rows, columns, [&] { return random.integer(-99, 99); }));
  };
  using Q = MatrixX<Rational>;
  for (const int n : {1, 5, 25}) {
    const MatrixX<double> a = whole(n, 9), b = whole(9, n), c = whole(n, n), v = whole(9, 1);
    const Q A = a.cast<Rational>(), B = b.cast<Rational>(), v_exact = v.cast<Rational>();
    Q C = c.cast<Rational>();
    const auto exact = [](const MatrixX<double>& x) { return Q(x.cast<Rational>()); };
    CHECK(Q(A * B) == exact(a * b));
    CHECK(Q(B.transpose() * A.transpose()) == exact((a * b).transpose()));
    CHECK(Q(A * VectorX<Rational>(v_exact)) == exact(a * v));
    C += A * B;
    CHECK(C == exact(c + a * b));
    C -= Rational(3) * A * B;
    CHECK(C == exact(c - 2 * a * b));
    C = C * C;  // what is written is read
    CHECK(C == exact((c - 2 * a * b) * (c - 2 * a * b)));
  }
}

TEST_CASE("rationals are fractions in lowest terms") {
  CHECK(Rational(1, 3) + Rational(1, 6) == Rational(1, 2));
  CHECK(Rational(1, 3) - Rational(1, 3) == Rational(0));
  CHECK(Rational(2, 3) * Rational(3, 4) == Rational(1, 2));
  CHECK(Rational(2, 3) / Rational(-4, 9) == Rational(-3, 2));
  CHECK(Rational(1, -2) == -Rational(1, 2));
  CHECK(abs(Rational(-5, 7)) == Rational(5, 7));
  std::ostringstream text;
  text << Rational(6, 4) << " " << Rational(4, 2);
  CHECK(text.str() == "3/2 2");
}

TEST_CASE("rationals are ordered") {
  CHECK(Rational(1, 3) < Rational(1, 2));
  CHECK(Rational(-1, 3) > Rational(-1, 2));
  CHECK(Rational(2, 4) <= Rational(1, 2));
  CHECK(Rational(1, 3) != Rational(333333333, 1000000000));
}

TEST_CASE("division by the rational zero throws") {
  CHECK_THROWS_AS(Rational(1) / Rational(0), std::overflow_error);
  CHECK_THROWS_AS(Rational(1, 0), std::overflow_error);
}

TEST_CASE("a double becomes exactly the fraction it is, and comes back") {
  CHECK(Rational(0.5) == Rational(1, 2));
  CHECK(Rational(0.1) != Rational(1, 10));
  Rational two_to_55(1 << 30);
  two_to_55 *= Rational(1 << 25);
  CHECK(Rational(0.1) * two_to_55 == Rational(3602879701896397.0));  // 0.1 is this integer over 2^55
  CHECK(static_cast<double>(Rational(1, 3)) == 1.0 / 3.0);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const double x = random.sign() * std::ldexp(random.uniform(0.5, 1), random.integer(-300, 300));
    CHECK(static_cast<double>(Rational(x)) == x);
  }
}

TEST_CASE("products over common denominators are products") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    MatrixX<Rational> A(random.integer(1, 5), random.integer(1, 5)), B(A.cols(), random.integer(1, 5));
    for (auto* M : {&A, &B})
      for (auto& x : M->reshaped())
        x = random.integer(0, 2) == 0 ? Rational(0) : random.fraction(9, random.integer(1, 12));
    MatrixX<Rational> C = MatrixX<Rational>::Zero(A.rows(), B.cols());
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      for (Eigen::Index j = 0; j < B.cols(); ++j)
        for (Eigen::Index k = 0; k < A.cols(); ++k) C(i, j) += A(i, k) * B(k, j);
    CHECK(product(A, B) == C);
  }
}

TEST_CASE("exact rotations are rotations") {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Matrix3<Rational> R = random.exact_rotation();
    CHECK(Matrix3<Rational>(R * R.transpose()) == Matrix3<Rational>(Matrix3<Rational>::Identity()));
    CHECK(R.col(0).dot(R.col(1).cross(R.col(2))) == Rational(1));
  }
}

TEST_CASE("random arms are physical, and the same every time") {
  for (unsigned seed = 1; seed <= 50; ++seed)
    for (const int n : {1, 6, 12}) {
      const auto arm = osculate::random_arm(seed, n);
      const auto again = osculate::random_arm(seed, n);
      CHECK(arm.q == again.q);
      CHECK(arm.chain.links.back().inertia == again.chain.links.back().inertia);
      REQUIRE(arm.chain.n() == n);
      for (const auto& link : arm.chain.links) {
        // Second moments are trace/2 1 - I; they are positive definite exactly when I is that of a solid
        // body. Their smallest eigenvalue is at least m (3 cm)^2 by construction, far above rounding.
        const Matrix3<double> second = link.inertia.trace() / 2 * Matrix3<double>::Identity() - link.inertia;
        const Eigen::SelfAdjointEigenSolver<Matrix3<double>> eigen(second);
        CHECK(eigen.eigenvalues()[0] > 0.99 * link.mass * 0.03 * 0.03);
        CHECK(std::abs(link.axis.norm() - 1) < 4 * std::numeric_limits<double>::epsilon());
        CHECK(link.mass >= 0.5);
      }
    }
  CHECK(osculate::random_arm(1, 6).q != osculate::random_arm(2, 6).q);
  CHECK(osculate::random_arm(1, 6, osculate::Regime::zero_velocity).qd.isZero(0));
  // Pins the generator itself: first outputs of splitmix64 for seed 0, published with the algorithm.
  Random zero(0);
  CHECK(zero.next() == 0xe220a8397b1dcdafu);
  CHECK(zero.next() == 0x6e789e6aa1b965f4u);
}

}  // namespace osculate::testing::numbers_tests
