// One integrator with the closed loop it integrates.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "experiment/config.hpp"
#include "simulation/closed_loop.hpp"
#include "simulation/closed_loop_slopes.hpp"
#include "simulation/integrator.hpp"

namespace osculate {

/// `tighter`: the tolerances of the configuration are divided by this, that of the energies twice.
IntegratorOptions integrator_options(const IntegratorConfig& config, const ClosedLoop& loop, double tighter);

/// Whether df/dy comes from ClosedLoopSlopes.
inline bool automatic_jacobian(const IntegratorOptions& options, const ClosedLoop& loop) {
  return options.method == Method::bdf && options.jacobian == JacobianBy::automatic &&
         ClosedLoopSlopes::exist(loop);
}

/// Its own copy of the closed loop, so that no workspace is shared. The reference may jump at the end of a
/// segment; up to `limit` the integrator sees it from the left.
class Simulation {
 public:
  ClosedLoop loop;
  double limit = std::numeric_limits<double>::infinity();  // s
  Integrator integrator;

  /// Begins at t = 0.
  Simulation(const ClosedLoop& problem, std::span<const double> y0, const IntegratorOptions& options)
      : Simulation(problem, 0, y0, options) {
    loop.switch_modes(0, y0);
  }
  /// Goes on from a restart point at (t, y), which `memory` was written at; see remember().
  Simulation(const ClosedLoop& problem, double t, std::span<const double> y, const IntegratorOptions& options,
             Memory& memory)
      : Simulation(problem, t, y, options) {
    remember(memory);
  }
  Simulation(const Simulation&) = delete;  // the integrator holds a pointer to the loop

  /// All but the state and the integrator's own memory: at a restart point that begins anew.
  void remember(Memory& memory) {
    long evaluations = rhs_evaluations();
    memory(loop, event_pending_, evaluations);
    if (memory.reading()) evaluations_before_ = evaluations;
  }
  /// Calls of f since the beginning of the run.
  long rhs_evaluations() const { return evaluations_before_ + integrator.rhs_evaluations(); }

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
  Simulation(const ClosedLoop& problem, double t0, std::span<const double> y0,
             const IntegratorOptions& options)
      : loop(problem),
        integrator(
            [this](double t, const double* y, double* yd) { loop.right_side(std::min(t, limit), y, yd); }, t0,
            y0, options, loop.event_count(),
            [this](double t, const double* y, double* g) { loop.events(std::min(t, limit), y, g); },
            jacobian(options)) {}
  Integrator::Jacobian jacobian(const IntegratorOptions& options) {
    if (!automatic_jacobian(options, loop)) return {};
    return [this, slopes = std::make_shared<ClosedLoopSlopes>(loop)](double t, const double* y, double* df) {
      (*slopes)(std::min(t, limit), y, df);
    };
  }
  bool settle() {
    event_pending_ = false;
    const bool changed = loop.switch_modes(std::min(integrator.t(), limit), integrator.state());
    if (changed) integrator.restart();
    return changed;
  }
  bool event_pending_ = false;
  long evaluations_before_ = 0;  // by integrators before this one
};

}  // namespace osculate
