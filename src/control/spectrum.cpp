#include "control/spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace osculate {

namespace {

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

std::size_t entry(int i) { return static_cast<std::size_t>(i); }

Square leading(const std::array<TaskVector<double>, 6>& A, int m) {
  Square lower(m, m);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) lower(i, j) = A[entry(i)][entry(j)];
  return lower;
}

}  // namespace

Spectrum spectrum(const std::array<TaskVector<double>, 6>& A, int m) {
  if (m < 1) return {};
  const Eigen::SelfAdjointEigenSolver<Square> solver(leading(A, m));  // by iteration
  Spectrum out;
  for (int k = 0; k < m; ++k) {
    out.values[entry(k)] = solver.eigenvalues()[k];
    for (int i = 0; i < m; ++i) out.vectors[entry(k)][entry(i)] = solver.eigenvectors()(i, k);
  }
  return out;
}

TaskVector<double> eigenvalues(const std::array<TaskVector<double>, 6>& A, int m) {
  TaskVector<double> out{};
  if (m < 1) return out;
  const Eigen::SelfAdjointEigenSolver<Square> solver(leading(A, m), Eigen::EigenvaluesOnly);
  for (int k = 0; k < m; ++k) out[entry(k)] = solver.eigenvalues()[k];
  return out;
}

}  // namespace osculate
