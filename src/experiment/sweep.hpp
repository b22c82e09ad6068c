// `osculate sweep`: one run for each variant of an experiment's section `sweep`, what they have in common in
// one table, and how it grows with the swept number.
#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/embedded.hpp"
#include "experiment/run.hpp"
#include "record/result_file.hpp"

namespace osculate {

struct SweepOptions {
  std::optional<std::filesystem::path> output;         // absent: record nothing
  bool force = false;                                  // overwrite
  std::string command;                                 // for the provenance
  const volatile std::sig_atomic_t* signal = nullptr;  // non-zero: finish properly and stop
  /// Called about twice a second; `label` is "2/5 NAME".
  std::function<void(const std::string& label, double t, double duration, double wall)> progress;
};

/// What a sweep keeps of one variant. NaN: not run, interrupted, or not measured.
struct SweepRun {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::string name;
  std::optional<double> value;     // of the swept number
  std::string changes;             // "key.path=value", one a line
  std::string status = "not_run";  // or complete | failed | interrupted | refused
  std::string verdict;             // pass | fail | as_expected | "" where there is none
  std::string message;             // why it stopped or was not as expected
  std::vector<std::string> warnings;

  double exit_code = none;
  double position = none, orientation = none;          // m, rad: largest tracking error of the tip
  double position_rms = none, orientation_rms = none;  // m, rad: over time
  double linear_missed = none, angular_missed = none;  // m/s^2, rad/s^2: largest |tip acceleration - u|
  double torque = none;                                // N m or N: largest |T| of any joint
  double torque_joint = none;                          // its velocity coordinate, 1 at the base
  double analytic_position = none, analytic_orientation = none;  // m, rad: distance from the closed form
  double error_position = none, error_orientation = none;        // m, rad: estimate of the global error
  double end_time = none;                                        // s, simulated
  double steps = none, rhs_evaluations = none;
  double wall_time = none;  // s, without recording
};

struct SweepResult {
  std::string name;  // of the experiment
  std::string key;   // the swept key, or ""
  std::vector<SweepRun> runs;
  Exit exit = Exit::ok;  // the gravest of the runs
};

/// quantity ~ value^slope, by least squares of log10(quantity) over log10(value).
struct SlopeFit {
  double slope = 0;
  double spread = 0;  // root mean square of log10(quantity) about the fit
  int points = 0;     // that could be used: positive and finite
  /// between[i]: slope from point i - 1 to point i. NaN for i = 0 and where one of them cannot be used.
  std::vector<double> between;
};

/// Nothing with fewer than 3 usable points, or where all values are the same.
std::optional<SlopeFit> fit_slope(std::span<const double> values, std::span<const double> quantities);

/// A fit for each quantity that can follow a power law.
struct Slope {
  std::string quantity;  // its variable in the result file
  std::string label;     // for a reader
  std::optional<SlopeFit> fit;
};

/// Over the variants that ran to the end. Empty unless each variant has a value, there are at least 3 of them
/// and all are > 0.
std::vector<Slope> slopes(const SweepResult& result);

/// Where the experiment of a sweep comes from: its name for messages, and how it is read with overrides.
struct SweepSource {
  std::string name;
  std::function<Experiment(const std::vector<std::string>& overrides)> read;
};

/// Runs the variants of an experiment, one after the other. Reads and checks all of them before the first one
/// runs, and makes the result file then, so that nothing is computed in vain. A run that fails does not stop
/// the others; a signal does. Throws ConfigError (also where there is no sweep), ModelError, ReferenceError
/// (nothing has been run) or FileError.
SweepResult sweep(const SweepSource& source, const std::vector<std::string>& overrides,
                  const SweepOptions& options);
/// The same of an experiment file.
SweepResult sweep(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                  const SweepOptions& options);

/// The table and the slopes as text for stdout.
std::string report(const SweepResult& result);

/// The result file: names and provenance at the start, numbers at the end; `files` are those that any variant
/// names. docs/sweeps.md lists it.
Layout sweep_layout(const SweepResult& planned, std::vector<Text> provenance, const NamedFiles& files);
/// What the result file receives at the end: every number of the sweep.
Ending sweep_ending(const SweepResult& result);
/// complete | interrupted, of a sweep as a whole.
std::string sweep_status(const SweepResult& result);
/// pass | fail | as_expected.
std::string sweep_verdict(const SweepResult& result);

}  // namespace osculate
