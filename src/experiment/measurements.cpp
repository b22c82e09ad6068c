#include "experiment/measurements.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/rotation.hpp"
#include "experiment/make_loop.hpp"
#include "verification/step_check.hpp"

namespace osculate {

namespace {

// The transient has then decayed to the rounding of the tip position.
constexpr double decayed = 1e-13;

/// Task rows that follow the pose of the reference: all but those under force control.
TaskRows tracked(const LawOptions& law) {
  TaskRows out = law.rows;
  if (law.force)
    std::erase_if(out, [&](int row) {
      return std::find(law.force->rows.begin(), law.force->rows.end(), row) != law.force->rows.end();
    });
  return out;
}

DepartureInput departure_of(const Observation& seen) {
  DepartureInput at;
  at.tip_acceleration = seen.tip_acceleration;
  at.u = seen.command.u;
  at.error = seen.command.error.e;
  at.q = seen.q;
  at.qd = seen.qd;
  at.torque = seen.torque;
  at.singularity_policy = seen.command.filtered;
  at.saturated = seen.command.saturated;
  return at;
}

}  // namespace

Measurements::Measurements(const Experiment& experiment, const Arms& arms, const ClosedLoop& loop)
    : law_(loop.controller().options()),
      initial_(loop.controller().initial()),
      departure_(law_.rows, tracked(law_), joint_limits(arms.description)),
      path_(loop.controller().shared_path()) {
  const auto* sines = std::get_if<MultisineOptions>(&experiment.reference);
  const bool controls = sines && std::find(law_.rows.begin(), law_.rows.end(), sines->row) != law_.rows.end();
  if (!sines)
    no_frequency_ = "the reference is no sum of sines";
  else if (law_.feedforward || law_.law == Law::free || !controls)
    no_frequency_ = "the law takes the reference's acceleration: set controller.feedforward to false";
  else if (law_.sampling)
    no_frequency_ = "a sampled law is not the continuous one that was designed";
  else if (!loop.plant_is_model())
    no_frequency_ = "plant and model differ on purpose";
  else if (const std::string part = omission(law_); !part.empty())
    no_frequency_ = "the law omits " + part + " on purpose";
  no_poles_ = "verify.poles is false";
  if (!no_frequency_.empty()) return;
  row_ = sines->row;
  settled_ = settling_time(law_.stiffness[row_], law_.damping[row_], decayed);
  tip_fit_.emplace(sines->frequencies);
  reference_fit_.emplace(sines->frequencies);
}

void Measurements::linearise(ClosedLoop loop, std::span<const double> y) {
  no_poles_.clear();
  if (!loop.plant_is_model())
    no_poles_ = "plant and model differ on purpose";
  else if (const std::string part = omission(law_); !part.empty())
    no_poles_ = "the law omits " + part + " on purpose";
  else if (law_.force || !law_.obstacles.empty())
    no_poles_ = "forces and obstacles move the poles";
  if (!no_poles_.empty()) return;
  try {
    out_.poles = check_poles(loop, 0, y);
  } catch (const std::domain_error& error) { no_poles_ = error.what(); }
}

void Measurements::step(const Observation& seen, double h, const TrajectoryClaims& along,
                        const GlobalError& error, double self_motion, bool acts) {
  DepartureInput at = departure_of(seen);
  at.acts = acts;
  departure_.add(seen.t, h, at);
  if (along.off()) out_.coupling.add(along.commanded(), seen.t, *along.off());
  if (error.known && seen.t > 0) out_.growth.add(seen.t, error.position_now);
  if (self_motion > out_.self_motion) out_.self_motion = self_motion;
}

void Measurements::sample(double t, const Pose& tip) {
  if (!tip_fit_ || t < settled_) return;
  const double moved = row_ < 3 ? Vector3<double>(log_rotation(tip.R * initial_.R.transpose()))[row_]
                                : (tip.p - initial_.p)[row_ - 3];
  tip_fit_->add(t, moved);
  reference_fit_->add(t, path_->at(t).y[row_]);
}

ClaimResult Measurements::frequency_result(const GlobalError& error) {
  ClaimResult out;
  out.reason = no_frequency_;
  if (!tip_fit_) return out;
  out.reason = "no shadow run: verify.shadow is false";
  if (!error.known) return out;
  try {
    const double off = error_multiple * (row_ < 3 ? error.orientation : error.position);
    out_.frequency =
        compare(*tip_fit_, reference_fit_->amplitudes(), law_.stiffness[row_], law_.damping[row_], off);
  } catch (const std::domain_error& few) {
    out.reason = few.what();
    return out;
  }
  out.worst = {out_.frequency->worst, out_.frequency->bound, true};
  out.checked_steps = tip_fit_->samples();
  out.at_time = tip_fit_->latest();
  judge(out);
  return out;
}

ClaimResult Measurements::poles_result() const {
  ClaimResult out;
  out.reason = no_poles_;
  if (!no_poles_.empty() || !out_.poles) return out;
  out.worst = {out_.poles->worst, out_.poles->bound, true};
  out.checked_steps = 1;
  judge(out);
  return out;
}

Measured Measurements::finish() {
  out_.departure = departure_.result();
  // Growth within the rounding of the tip position is none.
  out_.growth_fit = out_.growth.fit(64 * std::numeric_limits<double>::epsilon());
  return out_;
}

}  // namespace osculate
