// The commanded linear system e.. + d e. + k e = 0 in closed form: what the tip error does if the theory
// holds.
#pragma once

#include "control/memory.hpp"

namespace osculate {

struct ErrorState {
  double e = 0, ed = 0;

  void remember(Memory& memory) { memory(e, ed); }
};

/// Solution at time t >= 0 for any start at t = 0, with the functions of t computed once. Under-, critically
/// and over-damped, and k = 0 or d = 0 too, without loss of accuracy where the cases meet.
class LinearResponse {
 public:
  LinearResponse(double stiffness, double damping, double t);

  /// The state at t that (e0, ed0) leads to.
  ErrorState from(ErrorState start) const;

 private:
  double stiffness_;
  bool oscillates_;
  double rate_;          // alpha where it oscillates, else the slow root
  double decay_;         // exp(-alpha t), or exp(slow root t)
  double kept_, moved_;  // cos(omega t) and sin(omega t) / omega, or exp(-gap t) and (1 - exp(-gap t)) / gap
};

/// The same from one start, (e0, ed0).
inline ErrorState linear_response(double stiffness, double damping, ErrorState start, double t) {
  return LinearResponse(stiffness, damping, t).from(start);
}

}  // namespace osculate
