// Condition numbers and ranks, by symmetric eigenvalues. Compiled once: the eigenvalue solver is slow to
// compile.
#pragma once

#include "model/chain.hpp"

namespace osculate {

/// 2-norm condition number of a symmetric positive definite matrix; infinite if it is not.
double condition_number(const MatrixX<double>& A);

/// The same of A scaled to unit diagonal.
double scaled_condition(const MatrixX<double>& A);

/// Number of singular values of A, scaled to unit diagonal, above 1e-13 times the largest. Rows with a zero
/// diagonal count as lost.
int scaled_rank(const MatrixX<double>& A);

}  // namespace osculate
