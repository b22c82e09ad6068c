#include "reference/conditioning.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

namespace osculate {

namespace {

VectorX<double> eigenvalues(const MatrixX<double>& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixX<double>>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

double condition_number(const MatrixX<double>& A) {
  const VectorX<double> values = eigenvalues(A);
  return values[0] > 0 ? values[values.size() - 1] / values[0] : std::numeric_limits<double>::infinity();
}

double scaled_condition(const MatrixX<double>& A) {
  const VectorX<double> d = A.diagonal().cwiseSqrt();
  if (!(d.minCoeff() > 0)) return std::numeric_limits<double>::infinity();
  return condition_number(d.cwiseInverse().asDiagonal() * A * d.cwiseInverse().asDiagonal());
}

int scaled_rank(const MatrixX<double>& A) {
  VectorX<double> d = A.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (auto& x : d) x = x > 0 ? 1 / x : 0;
  const VectorX<double> values = eigenvalues(d.asDiagonal() * A * d.asDiagonal()).cwiseAbs();
  return static_cast<int>((values.array() > 1e-13 * values.maxCoeff()).count());
}

}  // namespace osculate
