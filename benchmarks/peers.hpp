// Loads the peers' modules.
#pragma once

#include "benchmarks/route.hpp"

namespace osculate::bench {

/// Adds the routes of every peer whose module was built. A peer that cannot take the arm is told on stderr
/// and left out.
void add_peers(const Arm& arm, std::vector<Route>& routes);

}  // namespace osculate::bench
