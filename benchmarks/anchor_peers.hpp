// The peers' integrators on the anchor.
#pragma once

#include "benchmarks/anchor.hpp"

namespace osculate::bench {

/// Runs every peer whose module was built over many numbers of steps, and prints a CSV line for each run
/// as work_precision.cpp does. `exact`: the tip's true position, m. Times are the best of `repeats` runs.
void run_peers(Anchor anchor, const char* problem, const std::function<Eigen::Vector3d(double t)>& exact,
               int repeats);

}  // namespace osculate::bench
