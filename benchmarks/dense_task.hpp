// Omega, F and T from M, C + G, J and Jdot qd with one Cholesky factor, as an expert composes them for a
// peer.
#pragma once

#include <Eigen/Cholesky>

#include "benchmarks/route.hpp"

namespace osculate::bench {

/// Angular rows first, inertial frame, about the tip point. Nothing allocates after construction.
struct DenseTask {
  using Six = Eigen::Matrix<double, 6, 6>;
  using Six1 = Eigen::Matrix<double, 6, 1>;

  explicit DenseTask(int n) : J(6, n), factor(n), Y(n, 6), y(n) {}

  /// M = L L^T, Y = L^-1 J^T, y = L^-1 (C + G): Omega = Y^T Y and J M^-1 (C + G) = Y^T y.
  template <class Matrix, class Vector>
  void solve(const Matrix& M, const Vector& bias, const State& state, Answer& answer) {
    factor.compute(M);
    Y = J.transpose();
    factor.matrixL().solveInPlace(Y);
    y = bias;
    factor.matrixL().solveInPlace(y);
    Omega.noalias() = Y.transpose() * Y;
    free.noalias() = Jdot_qd - Y.transpose() * y;  // tip acceleration without joint torques
    finish(state, answer);
  }

  /// F and T from Omega, J and the free tip acceleration.
  void finish(const State& state, Answer& answer) {
    force(state, answer);
    Eigen::Map<Eigen::VectorXd>(answer.T.data(), J.cols()).noalias() =
        J.transpose() * Eigen::Map<const Six1>(answer.F.data());
  }
  /// F alone.
  void force(const State& state, Answer& answer) {
    small.compute(Omega);
    Eigen::Map<Six1>(answer.F.data()) = small.solve(Eigen::Map<const Six1>(state.u.data()) - free);
  }

  void read_Omega(double* out) const {
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{out} = Omega;
  }

  Eigen::Matrix<double, 6, Eigen::Dynamic> J;
  Six1 Jdot_qd, free;
  Six Omega;
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::LLT<Six> small;
  Eigen::Matrix<double, Eigen::Dynamic, 6> Y;
  Eigen::VectorXd y;
};

}  // namespace osculate::bench
