// Matrices of a peer as the lists that the jury takes.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace osculate::jury {

template <class Matrix>
std::vector<double> by_rows(const Matrix& A) {
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(A.size()));
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j) out.push_back(A(i, j));
  return out;
}

}  // namespace osculate::jury
