#pragma once

#include <Eigen/Core>

namespace osculate::testing {

/// Singular values, largest first. Compiled once for all tests: Eigen's decomposition takes longer than most
/// of them.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& A);

}  // namespace osculate::testing
