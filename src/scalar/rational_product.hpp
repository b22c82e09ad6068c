// Products of matrices of fractions. A sum of fractions reduces after every term; over a common denominator
// for each row and column it reduces once.
#pragma once

#include "scalar/rational.hpp"

namespace osculate {

/// A B, exactly. Zeros cost nothing.
MatrixOfFractions product(const MatrixOfFractions& A, const MatrixOfFractions& B);

}  // namespace osculate
