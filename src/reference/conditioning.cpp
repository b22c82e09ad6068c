#include "reference/conditioning.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

namespace osculate {

namespace {

/// n: the number of rows, or Eigen::Dynamic.
template <int n>
using Symmetric = Eigen::Matrix<double, n, n>;

template <int n>
Eigen::Matrix<double, n, 1> eigenvalues(const Symmetric<n>& A) {
  return Eigen::SelfAdjointEigenSolver<Symmetric<n>>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

template <int n>
double condition_number(const Symmetric<n>& A) {
  const Eigen::Matrix<double, n, 1> values = eigenvalues<n>(A);
  return values[0] > 0 ? values[values.size() - 1] / values[0] : std::numeric_limits<double>::infinity();
}

template <int n>
double scaled_condition(const Eigen::Map<const Symmetric<n>>& A) {
  const Eigen::Matrix<double, n, 1> d = A.diagonal().cwiseSqrt();
  if (!(d.minCoeff() > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::Matrix<double, n, 1> inverse = d.cwiseInverse();
  return condition_number<n>(inverse.asDiagonal() * A * inverse.asDiagonal());
}

}  // namespace

double condition_number(const MatrixX<double>& A) { return condition_number<Eigen::Dynamic>(A); }

double scaled_condition(const MatrixX<double>& A) {
  constexpr int rows = 6;  // of most tasks: without allocation
  if (A.rows() == rows) return scaled_condition<rows>(Eigen::Map<const Symmetric<rows>>(A.data()));
  return scaled_condition<Eigen::Dynamic>(
      Eigen::Map<const Symmetric<Eigen::Dynamic>>(A.data(), A.rows(), A.cols()));
}

int scaled_rank(const MatrixX<double>& A) {
  VectorX<double> d = A.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (auto& x : d) x = x > 0 ? 1 / x : 0;
  const VectorX<double> values = eigenvalues<Eigen::Dynamic>(d.asDiagonal() * A * d.asDiagonal()).cwiseAbs();
  return static_cast<int>((values.array() > 1e-13 * values.maxCoeff()).count());
}

}  // namespace osculate
