// Symmetric factorisation for the dense reference: field operations only, so no pivoting, no root, no
// comparison. Inner loops run down columns, which lie in one piece.
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
/// throws. `f` keeps its storage from call to call.      cost n^3 / 6
template <Field S>
void factor(const MatrixX<S>& A, Ldlt<S>& f) {
  const Eigen::Index n = A.rows();
  f.L.resize(n, n);
  f.D.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    S* const l = f.L.data() + j * n;
    const S* const a = A.data() + j * A.rows();
    for (Eigen::Index i = 0; i < j; ++i) l[i] = S(0);
    for (Eigen::Index i = j; i < n; ++i) l[i] = a[i];
    for (Eigen::Index k = 0; k < j; ++k) {
      const S* const before = f.L.data() + k * n;
      const S share = before[j] * f.D[k];
      for (Eigen::Index i = j; i < n; ++i) l[i] -= before[i] * share;
    }
    f.D[j] = l[j];
    l[j] = S(1);
    for (Eigen::Index i = j + 1; i < n; ++i) l[i] /= f.D[j];
  }
}
template <Field S>
Ldlt<S> factor(const MatrixX<S>& A) {
  Ldlt<S> f;
  factor(A, f);
  return f;
}

/// A^-1 B for B of n rows and any number of columns.
template <Field S, int Columns>
Eigen::Matrix<S, Eigen::Dynamic, Columns> solve(const Ldlt<S>& f,
                                                Eigen::Matrix<S, Eigen::Dynamic, Columns> B) {
  const Eigen::Index n = f.D.size();
  for (Eigen::Index c = 0; c < B.cols(); ++c) {
    S* const b = B.data() + c * n;
    for (Eigen::Index k = 0; k < n; ++k) {
      const S* const l = f.L.data() + k * n;
      for (Eigen::Index i = k + 1; i < n; ++i) b[i] -= l[i] * b[k];
    }
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      const S* const l = f.L.data() + i * n;
      b[i] /= f.D[i];
      for (Eigen::Index k = i + 1; k < n; ++k) b[i] -= l[k] * b[k];
    }
  }
  return B;
}

/// B A^-1 in place, for B of n columns. Works on whole columns of B, so that a fixed number of rows makes it
/// several times faster than solve().
template <Field S, int Rows, int Columns>
void divide(Eigen::Matrix<S, Rows, Columns>& B, const Ldlt<S>& f) {
  const Eigen::Index n = f.D.size();
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index i = k + 1; i < n; ++i) B.col(i) -= B.col(k) * f.L(i, k);
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    B.col(i) /= f.D[i];
    for (Eigen::Index k = i + 1; k < n; ++k) B.col(i) -= B.col(k) * f.L(k, i);
  }
}

/// A^-1, n x n. Both triangles are filled.      cost n^3 / 3
template <Field S>
void inverse(const Ldlt<S>& f, MatrixX<S>& X) {
  const Eigen::Index n = f.D.size();
  X.setIdentity(n, n);
  for (Eigen::Index k = 0; k < n; ++k)  // X = L^-T, upper triangular
    for (Eigen::Index i = k + 1; i < n; ++i)
      for (Eigen::Index r = 0; r <= k; ++r) X(r, i) -= X(r, k) * f.L(i, k);
  for (Eigen::Index i = n - 1; i >= 0; --i) {  // X = L^-T D^-1 L^-1, of which the upper triangle is enough
    for (Eigen::Index r = 0; r <= i; ++r) X(r, i) /= f.D[i];
    for (Eigen::Index k = i + 1; k < n; ++k)
      for (Eigen::Index r = 0; r <= i; ++r) X(r, i) -= X(r, k) * f.L(k, i);
  }
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index r = 0; r < i; ++r) X(i, r) = X(r, i);
}

}  // namespace osculate::dense
