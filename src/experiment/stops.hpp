// When the integrators of a run stop and start anew.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "experiment/config.hpp"

namespace osculate {

/// Times at which the integrators stop and start anew: the samples of a sampled law, or else the times at
/// which the reference or the base jumps; at last the duration.
class Stops {
 public:
  Stops(const Experiment& experiment, const Controller& controller) : duration_(experiment.duration) {
    if (experiment.controller.sampling) {
      period_ = experiment.controller.sampling->period;
      return;
    }
    times_ = controller.path().breakpoints();
    if (const auto& base = controller.options().base_path)
      for (const double t : base->breakpoints()) times_.push_back(t);
    std::sort(times_.begin(), times_.end());
    times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
    std::erase_if(times_, [this](double t) { return t >= duration_; });
  }
  /// NaN after the last.
  double next() {
    ++number_;
    // k * period, never accumulated; a last one that is the duration to rounding counts as the duration.
    double t = duration_;
    if (period_ > 0)
      t = static_cast<double>(number_) * period_;
    else if (number_ <= static_cast<long>(times_.size()))
      t = times_[static_cast<std::size_t>(number_ - 1)];
    if (t > duration_ - 1e-9 * period_) t = duration_;
    if (done_) return std::numeric_limits<double>::quiet_NaN();
    done_ = t >= duration_;
    return t;
  }

 private:
  double duration_, period_ = 0;
  std::vector<double> times_;
  long number_ = 0;
  bool done_ = false;
};

}  // namespace osculate
