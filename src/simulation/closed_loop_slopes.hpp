// The Jacobian df/dy of the closed loop in closed form, by the chain rule: arm, law, friction, surface.
#pragma once

#include <memory>

#include "simulation/closed_loop.hpp"

namespace osculate {

/// df/dy of one closed loop, in its present modes. Its own workspace; no allocation after construction.
class ClosedLoopSlopes {
 public:
  /// Whether `loop` has a Jacobian here: joints with one axis, the recursive plant, and a free swing or the
  /// exact operational-space law at every instant, of any task rows, with rotation vector and Cartesian
  /// position, singularity policy none, no obstacles, and in the null space damping and posture alone.
  static bool exist(const ClosedLoop& loop);

  /// `loop` has a Jacobian, and must stay where it is while this object is asked.
  explicit ClosedLoopSlopes(ClosedLoop& loop);
  ~ClosedLoopSlopes();

  /// columns[j states + i] = df_i/dy_j at (t, y). Evaluates the right side once, for its values, and throws
  /// IntegrationStopped as that does. O(n^3).
  void operator()(double t, const double* y, double* columns);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace osculate
