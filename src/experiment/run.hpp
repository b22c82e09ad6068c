// One experiment from start to verdict.
#pragma once

#include <array>
#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "experiment/measurements.hpp"
#include "record/restart_point.hpp"

namespace osculate {

/// Exit codes of the program (README.md). The gravest of several runs wins.
enum class Exit {
  ok = 0,
  claim_failed = 1,
  bad_input = 2,
  stopped = 3,
  io_failure = 4,
  interrupted = 130,
  terminated = 143
};

struct RunOptions {
  std::optional<std::filesystem::path> output;                           // absent: record nothing
  bool force = false;                                                    // overwrite
  std::string command;                                                   // for the provenance
  std::optional<RestartPoint> from = {};                                 // go on from there
  const volatile std::sig_atomic_t* signal = nullptr;                    // non-zero: finish properly and stop
  std::function<void(double t, double duration, double wall)> progress;  // called about twice a second
};

/// Wall times, s.
struct RunTimes {
  double simulation = 0, shadow = 0, checking = 0, recording = 0;
};

struct RunResult {
  Exit exit = Exit::ok;
  std::string status;   // complete | failed | interrupted
  std::string verdict;  // pass | fail | as_expected
  std::string message;  // why it stopped or was not as expected, or ""
  std::array<ClaimResult, claim_count> claims;
  GlobalError error;
  double worst_position = 0, worst_orientation = 0;  // m, rad: distance from the closed-form solution
  bool analytic = false;                             // whether that distance was measured
  double end_time = 0;                               // s, simulated
  long steps = 0, rhs_evaluations = 0;
  bool automatic_jacobian = false;          // bdf had it in closed form
  long samples = 0, sweeps_per_sample = 0;  // of a sampled law: how often it acted, sweeps of the last time
  Measured measured;
  RunTimes times;
  std::vector<std::string> warnings;
};

/// Runs it. Throws ConfigError, ModelError, ReferenceError (nothing has been run) or FileError (what was
/// written stays).
RunResult run(const Experiment& experiment, const RunOptions& options);

/// Reads and validates all that a run would: model, waypoints, lengths, inertias. Throws as run does.
void check(const Experiment& experiment);

/// The verdict table and the summary as text for stdout.
std::string report(const Experiment& experiment, const RunResult& result);

}  // namespace osculate
