#include "support/singular_values.hpp"

#include <Eigen/SVD>

namespace osculate::testing {

Eigen::VectorXd singular_values(const Eigen::MatrixXd& A) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(A).singularValues();
}

}  // namespace osculate::testing
