// Both sides of every step claim at one state of a running closed loop.
#pragma once

#include <string>

#include "simulation/closed_loop.hpp"
#include "verification/claims.hpp"

namespace osculate {

/// Sum of the distances between consecutive joint origins and the tip, m.
double reach(const Chain<double>& chain);

/// What a law leaves out on purpose, in words; "" for a law that is (4) or reaches the same accelerations.
std::string omission(const LawOptions& law);

/// Evaluates the closed loop at (t, y) by the lines that the right-hand side runs, then the dense side from
/// the models' numbers and (q, qd) alone. Of a sampled law the torque is judged where it acts only:
/// `at_sample` says that the law took its sample at this very state.
Evidence gather(ClosedLoop& loop, double t, std::span<const double> y, bool at_sample = false);

/// Of a law with sensors, at a sample that gather() has just seen: the torque against the dense side at the
/// joint positions and velocities that the sensors gave. Only the claims torque and null_space mean anything.
Evidence gather_as_measured(const ClosedLoop& loop, const Evidence& at);

}  // namespace osculate
