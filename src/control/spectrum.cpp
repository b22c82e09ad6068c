#include "control/spectrum.hpp"

#include <Eigen/Eigenvalues>

namespace osculate {

Spectrum spectrum(const std::array<TaskVector<double>, 6>& A, int m) {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  const auto entry = [](int i) { return static_cast<std::size_t>(i); };
  if (m < 1) return {};
  Square lower(m, m);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) lower(i, j) = A[entry(i)][entry(j)];
  const Eigen::SelfAdjointEigenSolver<Square> solver(lower);  // by iteration
  Spectrum out;
  for (int k = 0; k < m; ++k) {
    out.values[entry(k)] = solver.eigenvalues()[k];
    for (int i = 0; i < m; ++i) out.vectors[entry(k)][entry(i)] = solver.eigenvectors()(i, k);
  }
  return out;
}

}  // namespace osculate
