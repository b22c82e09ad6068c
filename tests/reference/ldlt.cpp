// The factorisation that the dense reference solves with: exact over fractions, backward stable over doubles.
#include "reference/ldlt.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "model/random_arm.hpp"
#include "reference/exact.hpp"
#include "support/catch.hpp"

namespace osculate::testing::ldlt_tests {

namespace {

MatrixX<Rational> exact_positive(Random& random, int n) {
  MatrixX<Rational> B(n, n);
  for (auto& x : B.reshaped()) x = random.fraction(5, 3);
  return B * B.transpose() + MatrixX<Rational>(MatrixX<Rational>::Identity(n, n));
}

}  // namespace

TEST_CASE("L D L^T is the matrix and solve its inverse, exactly") {
  for (int n = 1; n <= 8; ++n) {
    INFO("n = " << n);
    Random random(static_cast<std::uint64_t>(n));
    const MatrixX<Rational> A = exact_positive(random, n);
    const auto f = dense::factor(A);
    CHECK(MatrixX<Rational>(f.L * f.D.asDiagonal() * f.L.transpose()) == A);
    for (int i = 0; i < n; ++i) {
      CHECK(f.D[i] > Rational(0));
      CHECK(f.L(i, i) == Rational(1));
      for (int j = i + 1; j < n; ++j) CHECK(f.L(i, j) == Rational(0));
    }
    const MatrixX<Rational> one = MatrixX<Rational>::Identity(n, n);
    CHECK(MatrixX<Rational>(A * dense::solve(f, one)) == one);
    VectorX<Rational> b(n);
    for (auto& x : b) x = random.fraction(9, 4);
    CHECK(VectorX<Rational>(A * dense::solve(f, b)) == b);
    MatrixX<Rational> inverse, quotient = MatrixX<Rational>(A * A);
    dense::inverse(f, inverse);
    CHECK(MatrixX<Rational>(A * inverse) == one);
    dense::divide(quotient, f);
    CHECK(quotient == A);
  }
}

TEST_CASE("only the lower triangle is read") {
  Random random(3);
  MatrixX<double> A = exact_positive(random, 4).cast<double>();
  const MatrixX<double> L = dense::factor(A).L;
  A.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  CHECK(dense::factor(A).L == L);
}

TEST_CASE("backward error over doubles stays at rounding, whatever the condition") {
  // |b - A x| <= k eps |L| |D| |L^T| |x| by components; theory (Higham, 2002, ch. 10) has k about 3 n.
  // Hilbert matrices of n = 2 ... 10 reach cond 1e13.
  const double eps = std::numeric_limits<double>::epsilon();
  for (int n = 2; n <= 10; ++n) {
    INFO("n = " << n);
    MatrixX<double> A(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) A(i, j) = 1.0 / (i + j + 1);
    const VectorX<double> b = VectorX<double>::LinSpaced(n, -1, 2);
    const auto f = dense::factor(A);
    const VectorX<double> x = dense::solve(f, b);
    const MatrixX<double> absolute =
        f.L.cwiseAbs() * f.D.cwiseAbs().asDiagonal() * f.L.cwiseAbs().transpose();
    const VectorX<double> scale = absolute * x.cwiseAbs();
    const VectorX<double> residual = (b - A * x).cwiseAbs();
    CHECK((residual.array() <= 3 * n * eps * scale.array()).all());
  }
}

TEST_CASE("a zero pivot throws over fractions and is not finite over doubles") {
  const MatrixX<Rational> A = MatrixX<Rational>::Constant(2, 2, Rational(1));
  const VectorX<Rational> b = VectorX<Rational>::Constant(2, Rational(1));
  CHECK_THROWS_AS(dense::solve(dense::factor(A), b), std::overflow_error);
  const MatrixX<double> a = MatrixX<double>::Constant(2, 2, 1.0);
  const VectorX<double> x = dense::solve(dense::factor(a), VectorX<double>(VectorX<double>::Unit(2, 0)));
  CHECK_FALSE(x.allFinite());
}

}  // namespace osculate::testing::ldlt_tests
