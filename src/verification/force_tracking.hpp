// The claim force_response: a run under force control against its closed-form solution, from each touch-down
// on.
#pragma once

#include <optional>
#include <string>

#include "verification/force_response.hpp"
#include "verification/trajectory.hpp"

namespace osculate {

class ForceTracking {
 public:
  explicit ForceTracking(const ClosedLoop& loop);

  /// Why the claim does not apply, or "".
  const std::string& reason() const { return reason_; }
  /// Pressure on the surface against that of the closed form since the tip touched down, relative to the
  /// desired one. `contact`: the tip is in contact. `error`: of the run, which bounds the claim.
  Residual assess(const Observation& seen, bool contact, const GlobalError& error);
  void remember(Memory& memory) { memory(start_time_, start_); }

 private:
  std::string reason_;
  ForceLoop loop_;
  double reach_ = 1;                 // m, of the arm
  double rounding_ = 0;              // of the depth, m
  double start_time_ = 0;            // s
  std::optional<ErrorState> start_;  // depth and rate at the first instant in contact
};

}  // namespace osculate
