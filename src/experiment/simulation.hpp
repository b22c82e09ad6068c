// One integrator with the closed loop it integrates.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "experiment/config.hpp"
#include "simulation/closed_loop.hpp"
#include "simulation/integrator.hpp"

namespace osculate {

/// `tighter`: the tolerances of the configuration are divided by this.
IntegratorOptions integrator_options(const IntegratorConfig& config, const ClosedLoop& loop, double tighter);

/// Its own copy of the closed loop, so that no workspace is shared. The reference may jump at the end of a
/// segment; up to `limit` the integrator sees it from the left.
class Simulation {
 public:
  ClosedLoop loop;
  double limit = std::numeric_limits<double>::infinity();  // s
  Integrator integrator;

  Simulation(const ClosedLoop& problem, std::span<const double> y0, const IntegratorOptions& options)
      : loop(problem),
        integrator(
            [this](double t, const double* y, double* yd) { loop.right_side(std::min(t, limit), y, yd); }, 0,
            y0, options, loop.event_count(),
            [this](double t, const double* y, double* g) { loop.events(std::min(t, limit), y, g); }) {
    loop.switch_modes(0, y0);
  }
  Simulation(const Simulation&) = delete;  // the integrator holds a pointer to the loop

  /// One accepted step. The modes that an event at its end asks for are taken at the start of the next, so
  /// that everything inside this one can still be looked at. Returns the step and whether modes changed
  /// before it.
  std::pair<StepInfo, bool> step(double stop) {
    const bool switched = event_pending_ && settle();
    const StepInfo info = integrator.step(stop);
    event_pending_ = info.at_event;
    return {info, switched};
  }
  /// Starts anew at a known jump.
  void restart() {
    event_pending_ = false;
    loop.switch_modes(std::min(integrator.t(), limit), integrator.state());
    integrator.restart();
  }

 private:
  bool settle() {
    event_pending_ = false;
    const bool changed = loop.switch_modes(std::min(integrator.t(), limit), integrator.state());
    if (changed) integrator.restart();
    return changed;
  }
  bool event_pending_ = false;
};

}  // namespace osculate
