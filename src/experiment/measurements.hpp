// What a run measures along the way besides the claims about single steps, in constant memory.
#pragma once

#include <optional>

#include "experiment/arms.hpp"
#include "verification/cross_coupling.hpp"
#include "verification/departure.hpp"
#include "verification/error_growth.hpp"
#include "verification/force_tracking.hpp"
#include "verification/frequency_response.hpp"
#include "verification/poles.hpp"
#include "verification/trajectory.hpp"

namespace osculate {

/// The outcome, for the report and the result file.
struct Measured {
  DepartureResult departure;
  CrossCoupling coupling;
  ErrorGrowth growth;
  GrowthFit growth_fit;
  std::optional<FrequencyResponse> frequency;
  std::optional<PoleCheck> poles;
  double self_motion = 0;  // J, largest kinetic energy that the tip does not see
  long mode_changes = 0;   // contact made or lost, directions truncated or kept again
};

class Measurements {
 public:
  Measurements(const Experiment& experiment, const Arms& arms, const ClosedLoop& loop);

  /// The closed loop at the start, at rest in its reference: its poles. A copy of the loop is linearised.
  void linearise(ClosedLoop loop, std::span<const double> y);
  /// An accepted step of length h that was checked, or with h = 0 the instant just after a sample of the law.
  /// self_motion: J, or NaN. acts: u is the command of this instant.
  void step(const Observation& seen, double h, const TrajectoryClaims& along, const GlobalError& error,
            double self_motion, bool acts);
  void mode_changed() { ++out_.mode_changes; }
  /// Instants k * output.interval, for what wants evenly spaced samples.
  bool wants_samples() const { return tip_fit_.has_value(); }
  void sample(double t, const Pose& tip);

  /// Claims about the whole run that are judged here: frequency_response and poles. `error`: of the run.
  ClaimResult frequency_result(const GlobalError& error);
  ClaimResult poles_result() const;
  Measured finish();
  /// Without the poles, which belong to the start.
  void remember(Memory& memory) {
    memory(departure_, out_.coupling, out_.growth, out_.self_motion, out_.mode_changes);
    if (tip_fit_) memory(*tip_fit_, *reference_fit_);
  }

 private:
  LawOptions law_;
  Pose initial_;
  Departure departure_;
  Measured out_;
  // the row that a multisine moves
  std::optional<SineFit> tip_fit_, reference_fit_;
  int row_ = 0;
  double settled_ = 0;  // s
  std::shared_ptr<const Path> path_;
  std::string no_frequency_, no_poles_;  // why not
};

}  // namespace osculate
