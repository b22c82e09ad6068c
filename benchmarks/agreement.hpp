// Whether two routes give the same answer: asked before either is timed.
#pragma once

#include <algorithm>

#include "benchmarks/route.hpp"

namespace osculate::bench {

/// Largest difference over the states, in the norm of the reference's answer: max |a - b| / max |b|.
struct Agreement {
  double qdd = 0;                  // forward dynamics
  double Omega = 0, F = 0, T = 0;  // task; F at u = 0 too, where it is c + g
  double worst() const { return std::max({qdd, Omega, F, T}); }
};

/// An n-link sweep and a solve by M both err by eps times n times a condition number; 1e-9 leaves those room
/// and catches every difference in the numbers of the arm, in frames and in signs.
inline constexpr double agreement_bound = 1e-9;

/// `route` against `reference`, which compute the same call.
Agreement compare(const Route& route, const Route& reference, const std::vector<State>& states);

}  // namespace osculate::bench
