// The commanded linear system e.. + d e. + k e = 0 in closed form: what the tip error does if the theory
// holds.
#pragma once

#include "control/memory.hpp"

namespace osculate {

struct ErrorState {
  double e = 0, ed = 0;

  void remember(Memory& memory) { memory(e, ed); }
};

/// Solution at time t >= 0 from (e0, ed0) at t = 0. Under-, critically and over-damped, and k = 0 or d = 0
/// too, without loss of accuracy where the cases meet.
ErrorState linear_response(double stiffness, double damping, ErrorState start, double t);

}  // namespace osculate
