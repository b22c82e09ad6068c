// The arms and states that are timed. The same name gives the same numbers everywhere.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/route.hpp"
#include "model/chain.hpp"

namespace osculate::bench {

/// puma560, arm7 (models/, rotors left out, links made solids), or random<n>: n revolute joints, axes and
/// links arbitrary. Throws std::invalid_argument for any other name.
Chain<double> chain_named(const std::string& name);

/// The count is a power of two, so that a call picks its state by a mask.
inline constexpr std::size_t state_count = 8;
std::vector<State> states(int n);

}  // namespace osculate::bench
