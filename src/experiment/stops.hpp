// When the integrators of a run stop and start anew.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "experiment/config.hpp"

namespace osculate {

struct Stop {
  double time = 0;  // s
  enum class Kind {
    jump,     // of the reference or the base
    sample,   // the law takes a sample
    apply,    // the torque of the last sample begins to act
    restart,  // a restart point and nothing else
    end,      // the duration
  } kind = Kind::end;
  bool jumps = true;     // something may jump at that time: up to there it is seen from the left
  bool restart = false;  // a restart point, before what happens at the stop
};

/// The stops of a run in order: the samples of a sampled law and the times at which their torques begin to
/// act, or else the times at which the reference or the base jumps; at last the duration. Restart points are
/// the multiples of their interval; of a sampled law, the samples that are the first at or after them.
class Stops {
 public:
  Stops(const Experiment& experiment, const Controller& controller)
      : duration_(experiment.duration), restart_interval_(experiment.output.restart_interval) {
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
    if (restart_interval_ > 0) plan_restart(stop);
    // A last sample that is the duration to rounding counts as the duration.
    if (stop.kind == Stop::Kind::end || stop.time > duration_ - 1e-9 * period_ || stop.time >= duration_)
      stop = {duration_, Stop::Kind::end, may_jump_at_end_};
    done_ = stop.kind == Stop::Kind::end;
    return stop;
  }

 private:
  /// Makes the stop a restart point if one is due, or puts one before it.
  void plan_restart(Stop& stop) {
    const double due = static_cast<double>(restarts_ + 1) * restart_interval_;
    if (stop.time < due || stop.kind == Stop::Kind::apply) return;
    if (period_ == 0 && stop.time > due) {
      following_ = stop;
      stop = {due, Stop::Kind::restart, false};
    }
    stop.restart = true;
    while (static_cast<double>(restarts_ + 1) * restart_interval_ <= stop.time) ++restarts_;
  }

  Stop following() {
    if (following_) return *std::exchange(following_, std::nullopt);
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

  double duration_, restart_interval_, period_ = 0, late_ = 0;
  std::vector<double> jumps_;
  std::optional<Stop> following_;  // if it is known already
  long restarts_ = 0;              // restart points so far
  long number_ = 0;
  bool applied_ = true, done_ = false, may_jump_at_end_ = false;
};

}  // namespace osculate
