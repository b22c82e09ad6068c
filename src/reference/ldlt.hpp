// Symmetric factorisation for the dense reference: field operations only, so no pivoting, no root, no
// comparison.
#pragma once

#include "model/chain.hpp"

namespace osculate::dense {

/// A = L diag(D) L^T of a symmetric n x n matrix, L unit lower triangular.
template <Field S>
struct Ldlt {
  MatrixX<S> L;  // n x n; the strict upper triangle is 0
  VectorX<S> D;  // n; all > 0 exactly when A is positive definite (in exact arithmetic)
};

/// Factors the symmetric matrix A (n x n; only the lower triangle is read). Backward stable for positive
/// definite A. Divides by every D(j): where one is 0, a double yields infinities or NaN and a Rational
/// throws.      cost n^3 / 6
template <Field S>
Ldlt<S> factor(const MatrixX<S>& A) {
  const Eigen::Index n = A.rows();
  Ldlt<S> f{MatrixX<S>::Identity(n, n), VectorX<S>::Zero(n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    S d = A(j, j);
    for (Eigen::Index k = 0; k < j; ++k) d -= f.L(j, k) * f.L(j, k) * f.D[k];
    f.D[j] = d;
    for (Eigen::Index i = j + 1; i < n; ++i) {
      S l = A(i, j);
      for (Eigen::Index k = 0; k < j; ++k) l -= f.L(i, k) * f.L(j, k) * f.D[k];
      f.L(i, j) = l / d;
    }
  }
  return f;
}

/// A^-1 B for B of n rows and any number of columns.
template <Field S, int Columns>
Eigen::Matrix<S, Eigen::Dynamic, Columns> solve(const Ldlt<S>& f,
                                                Eigen::Matrix<S, Eigen::Dynamic, Columns> B) {
  const Eigen::Index n = f.D.size();
  for (Eigen::Index c = 0; c < B.cols(); ++c) {
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index k = 0; k < i; ++k) B(i, c) -= f.L(i, k) * B(k, c);
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      B(i, c) /= f.D[i];
      for (Eigen::Index k = i + 1; k < n; ++k) B(i, c) -= f.L(k, i) * B(k, c);
    }
  }
  return B;
}

}  // namespace osculate::dense
