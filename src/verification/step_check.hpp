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

/// The steps of one run. What the run does not change is found once, and storage is used again.
class StepCheck {
 public:
  explicit StepCheck(const ClosedLoop& loop);

  /// Both sides at the state that the loop observed last: `seen` is what observe() returned, and stays valid.
  /// Of a sampled law the torque is judged where it acts only: `at_sample` says that the law took its sample
  /// at this very state. The result lasts until the next call.
  Evidence& gather(ClosedLoop& loop, const Observation& seen, bool at_sample = false);
  /// The result of the last gather().
  const Evidence& last() const { return evidence_; }

 private:
  double reach_;
  bool equal_arms_;     // model and plant are the same chain
  bool linearizes_;     // (5) holds wherever the law acts undisturbed
  bool by_definition_;  // the law is (4) or (16)
  Evidence evidence_;
};

/// Evaluates the closed loop at (t, y) by the lines that the right-hand side runs, then the dense side from
/// the models' numbers and (q, qd) alone. Of a sampled law the torque is judged where it acts only:
/// `at_sample` says that the law took its sample at this very state.
Evidence gather(ClosedLoop& loop, double t, std::span<const double> y, bool at_sample = false);

/// Of a law with sensors, at a sample that gather() has just seen: the torque against the dense side at the
/// joint positions and velocities that the sensors gave. Only the claims torque and null_space mean anything.
Evidence gather_as_measured(const ClosedLoop& loop, const Evidence& at);

}  // namespace osculate
