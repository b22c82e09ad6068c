// Eigenvalues and vectors of symmetric matrices up to 6 x 6, compiled once: the solver is slow to compile.
#pragma once

#include <array>

#include "recursion/task.hpp"

namespace osculate {

struct Spectrum {
  TaskVector<double> values{};                  // ascending; entries from m on are 0
  std::array<TaskVector<double>, 6> vectors{};  // vectors[k]: unit vector of the k-th
};

/// Of the leading m x m block of A, of which the lower triangle is read. Errors are a few eps |A| in the
/// values, whatever their size. No allocation.
Spectrum spectrum(const std::array<TaskVector<double>, 6>& A, int m);
/// Its values alone, at a third of the cost.
TaskVector<double> eigenvalues(const std::array<TaskVector<double>, 6>& A, int m);

}  // namespace osculate
