// Our calls as routes.
#pragma once

#include "benchmarks/route.hpp"
#include "model/chain.hpp"

namespace osculate::bench {

/// The four sweeps and forward dynamics by the recursions; cosines and sines included. The chain outlives the
/// routes.
void add_recursions(const Chain<double>& chain, std::vector<Route>& routes);
/// The same task with a sweep of columns instead of sweep 3.
void add_column_form(const Chain<double>& chain, std::vector<Route>& routes);
/// The dense side: an oracle, written to be plain.
void add_dense(const Chain<double>& chain, std::vector<Route>& routes);
/// One closed-loop right-hand side for the PUMA 560 with its rotors: reference, law, plant.
std::function<void()> puma560_right_side();

}  // namespace osculate::bench
