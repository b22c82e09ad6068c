// Symmetric factorisation for the dense reference: field operations only, so no pivoting, no root, no
// comparison. Inner loops run down columns, which lie in one piece.
#pragma once

#include <type_traits>

#include "model/chain.hpp"
#include "scalar/inlined.hpp"

namespace osculate::dense {

/// A = L diag(D) L^T of a symmetric n x n matrix, L unit lower triangular.
template <Field S>
struct Ldlt {
  MatrixX<S> L;  // n x n; the strict upper triangle is 0
  VectorX<S> D;  // n; all > 0 exactly when A is positive definite (in exact arithmetic)
};

namespace internal {

/// work(n), with n = 6 known when this is compiled: so many joints and task rows have most arms, and loops of
/// known length over doubles run several times faster.
template <Field S, class Work>
void with_size(Eigen::Index n, const Work& work) {
  if constexpr (in_register<S>)
    if (n == 6) return work(std::integral_constant<Eigen::Index, 6>());
  work(n);
}

}  // namespace internal

/// Factors the symmetric matrix A (n x n; only the lower triangle is read). Backward stable for positive
/// definite A. Divides by every D(j): where one is 0, a double yields infinities or NaN and a Rational
/// throws. `f` keeps its storage from call to call.      cost n^3 / 6
template <Field S>
void factor(const MatrixX<S>& A, Ldlt<S>& f) {
  f.L.resize(A.rows(), A.rows());
  f.D.resize(A.rows());
  internal::with_size<S>(A.rows(), [&](const auto size) {
    const Eigen::Index n = size;
    const S* const a = A.data();
    S* __restrict const L = f.L.data();
    S* __restrict const D = f.D.data();
#pragma GCC unroll 6
    for (Eigen::Index j = 0; j < n; ++j) {
      S* const l = L + j * n;
#pragma GCC unroll 6
      for (Eigen::Index i = 0; i < n; ++i) l[i] = i < j ? S(0) : a[i + j * n];
#pragma GCC unroll 6
      for (Eigen::Index k = 0; k < j; ++k) {
        const S* const before = L + k * n;
        const S share = before[j] * D[k];
#pragma GCC unroll 6
        for (Eigen::Index i = j; i < n; ++i) l[i] -= before[i] * share;
      }
      D[j] = l[j];
      l[j] = S(1);
#pragma GCC unroll 6
      for (Eigen::Index i = j + 1; i < n; ++i) l[i] /= D[j];
    }
  });
}
template <Field S>
Ldlt<S> factor(const MatrixX<S>& A) {
  Ldlt<S> f;
  factor(A, f);
  return f;
}

/// A^-1 b in place of b, which has n entries.
template <Field S>
void solve_in_place(const Ldlt<S>& f, S* __restrict const b) {
  internal::with_size<S>(f.D.size(), [&](const auto size) {
    const Eigen::Index n = size;
    const S* const L = f.L.data();
    const S* const D = f.D.data();
#pragma GCC unroll 6
    for (Eigen::Index k = 0; k < n; ++k)
#pragma GCC unroll 6
      for (Eigen::Index i = k + 1; i < n; ++i) b[i] -= L[i + k * n] * b[k];
#pragma GCC unroll 6
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      b[i] /= D[i];
#pragma GCC unroll 6
      for (Eigen::Index k = i + 1; k < n; ++k) b[i] -= L[k + i * n] * b[k];
    }
  });
}
/// A^-1 B for B of n rows and any number of columns.
template <Field S, int Columns>
Eigen::Matrix<S, Eigen::Dynamic, Columns> solve(const Ldlt<S>& f,
                                                Eigen::Matrix<S, Eigen::Dynamic, Columns> B) {
  for (Eigen::Index c = 0; c < B.cols(); ++c) solve_in_place(f, B.data() + c * B.rows());
  return B;
}

/// B A^-1 in place, for B of n columns. Works on whole columns of B, so that a fixed number of rows makes it
/// several times faster than solve().
template <Field S, int Rows, int Columns>
void divide(Eigen::Matrix<S, Rows, Columns>& B, const Ldlt<S>& f) {
  internal::with_size<S>(f.D.size(), [&](const auto size) {
    const Eigen::Index n = size;
    const S* const L = f.L.data();
#pragma GCC unroll 6
    for (Eigen::Index k = 0; k < n; ++k)
#pragma GCC unroll 6
      for (Eigen::Index i = k + 1; i < n; ++i) B.col(i) -= B.col(k) * L[i + k * n];
#pragma GCC unroll 6
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      B.col(i) /= f.D[i];
#pragma GCC unroll 6
      for (Eigen::Index k = i + 1; k < n; ++k) B.col(i) -= B.col(k) * L[k + i * n];
    }
  });
}

/// A^-1, n x n. Both triangles are filled.      cost n^3 / 3
template <Field S>
void inverse(const Ldlt<S>& f, MatrixX<S>& out) {
  out.resize(f.D.size(), f.D.size());
  internal::with_size<S>(f.D.size(), [&](const auto size) {
    const Eigen::Index n = size;
    const S* const L = f.L.data();
    const S* const D = f.D.data();
    S* __restrict const X = out.data();
    for (Eigen::Index i = 0; i < n; ++i)
#pragma GCC unroll 6
      for (Eigen::Index r = 0; r < n; ++r) X[r + i * n] = r == i ? S(1) : S(0);
#pragma GCC unroll 6
    for (Eigen::Index k = 0; k < n; ++k)  // X = L^-T, upper triangular
#pragma GCC unroll 6
      for (Eigen::Index i = k + 1; i < n; ++i)
#pragma GCC unroll 6
        for (Eigen::Index r = 0; r <= k; ++r) X[r + i * n] -= X[r + k * n] * L[i + k * n];
#pragma GCC unroll 6
    for (Eigen::Index i = n - 1; i >= 0; --i) {  // X = L^-T D^-1 L^-1, of which the upper triangle is enough
#pragma GCC unroll 6
      for (Eigen::Index r = 0; r <= i; ++r) X[r + i * n] /= D[i];
#pragma GCC unroll 6
      for (Eigen::Index k = i + 1; k < n; ++k)
#pragma GCC unroll 6
        for (Eigen::Index r = 0; r <= i; ++r) X[r + i * n] -= X[r + k * n] * L[k + i * n];
    }
#pragma GCC unroll 6
    for (Eigen::Index i = 0; i < n; ++i)
#pragma GCC unroll 6
      for (Eigen::Index r = 0; r < i; ++r) X[i + r * n] = X[r + i * n];
  });
}

}  // namespace osculate::dense
