// When the integrators of a run stop and start anew.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "experiment/config.hpp"

namespace osculate {

struct Stop {
  double time = 0;  // s
  enum class Kind {
    jump,    // of the reference or the base
    sample,  // the law takes a sample
    apply,   // the torque of the last sample begins to act
    end,     // the duration
  } kind = Kind::end;
  bool jumps = true;  // something may jump at that time: up to there it is seen from the left
};

/// The stops of a run in order: the samples of a sampled law and the times at which their torques begin to
/// act, or else the times at which the reference or the base jumps; at last the duration.
class Stops {
 public:
  Stops(const Experiment& experiment, const Controller& controller) : duration_(experiment.duration) {
    if (experiment.controller.sampling) {
      period_ = experiment.controller.sampling->period;
      late_ = experiment.controller.sampling->computation_time;
      return;
    }
    jumps_ = controller.path().breakpoints();
    if (const auto& base = controller.options().base_path)
      for (const double t : base->breakpoints()) jumps_.push_back(t);
    std::sort(jumps_.begin(), jumps_.end());
    jumps_.erase(std::unique(jumps_.begin(), jumps_.end()), jumps_.end());
    may_jump_at_end_ = !jumps_.empty() && !controller.path().moves();
  }

  /// Nothing after the last.
  std::optional<Stop> next() {
    if (done_) return std::nullopt;
    Stop stop = following();
    // A last sample that is the duration to rounding counts as the duration.
    if (stop.kind == Stop::Kind::end || stop.time > duration_ - 1e-9 * period_ || stop.time >= duration_)
      stop = {duration_, Stop::Kind::end, may_jump_at_end_};
    done_ = stop.kind == Stop::Kind::end;
    return stop;
  }

 private:
  Stop following() {
    if (period_ > 0) {
      // The first sample, at t = 0, acts at once. Times are k * period, never accumulated.
      const bool apply = late_ > 0 && number_ > 0 && !applied_;
      applied_ = apply || late_ == 0;
      if (apply) return {static_cast<double>(number_) * period_ + late_, Stop::Kind::apply};
      ++number_;
      return {static_cast<double>(number_) * period_, Stop::Kind::sample};
    }
    const auto i = static_cast<std::size_t>(number_++);
    if (i < jumps_.size()) return {jumps_[i], Stop::Kind::jump};
    return {duration_, Stop::Kind::end};
  }

  double duration_, period_ = 0, late_ = 0;
  std::vector<double> jumps_;
  long number_ = 0;
  bool applied_ = true, done_ = false, may_jump_at_end_ = false;
};

}  // namespace osculate
