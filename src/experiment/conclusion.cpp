#include "experiment/conclusion.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "verification/step_check.hpp"

namespace osculate {

std::string stop_name(IntegrationStopped::Reason reason) {
  using Reason = IntegrationStopped::Reason;
  switch (reason) {
    case Reason::singular:
      return "singular";
    case Reason::non_finite:
      return "non_finite";
    case Reason::step_too_small:
      return "step_too_small";
    case Reason::law:
      return "law";
    case Reason::failed:
      return "failed";
  }
  return "failed";
}

std::array<std::string, claim_count> reasons_against(const ClosedLoop& loop, bool filtered) {
  const LawOptions& law = loop.controller().options();
  const bool delayed = law.sampling && law.sampling->delay != Delay::none;
  const std::string part = omission(law);
  std::array<std::string, claim_count> out;
  if (law.law == Law::free) {
    for (const Claim claim : {Claim::torque, Claim::linearization}) out[index(claim)] = "free swing";
  } else {
    if (law.law == Law::textbook && law.textbook != TextbookLaw::dense)
      out[index(Claim::torque)] = "the law is not (4)";
    else if (filtered)
      out[index(Claim::torque)] = "a singularity policy changed F everywhere";
    std::string& linearization = out[index(Claim::linearization)];
    if (!loop.plant_is_model())
      linearization = "plant and model differ on purpose";
    else if (!part.empty())
      linearization = "the law omits " + part + " on purpose";
    else if (delayed)
      linearization = "the law is delayed on purpose";
    else if (law.sampling && law.sampling->computation_time > 0)
      linearization = "the torque acts later than its sample";
    else if (law.sensors)
      linearization = "the law knows the joints through sensors only";
    else if (filtered)
      linearization = "a singularity policy or a torque limit acted everywhere";
  }
  out[index(Claim::null_space)] = delayed ? "the law is delayed on purpose" : "no null-space torque";
  if (law.law == Law::textbook && !law.null_space.empty())
    out[index(Claim::null_space)] = "the law is not (4)";
  out[index(Claim::coordinates)] =
      loop.controller().chart() ? out[index(Claim::linearization)] : "no coordinates of its own are tracked";
  return out;
}

void conclude(const ExpectConfig& expect, const std::string& stop, int signal, RunResult& result) {
  std::vector<std::string> failed;
  for (std::size_t i = 0; i < claim_count; ++i)
    if (result.claims[i].outcome == Outcome::fail) failed.emplace_back(claim_table[i].id);
  std::sort(failed.begin(), failed.end());
  // A stop after a recursion disagreed with its definition is the recursion's fault, not the arm's. A law of
  // the user's own that gives no answer stops the run whatever it answered before.
  bool recursion_failed = false;
  for (std::size_t i = 0; i < index(Claim::energy) && stop != "law"; ++i)
    recursion_failed = recursion_failed || result.claims[i].reason == "residual above its bound";

  if (signal != 0) {
    result.status = "interrupted";
    result.verdict = failed.empty() ? "pass" : "fail";
    result.exit = signal == SIGTERM ? Exit::terminated : Exit::interrupted;
    result.message = "interrupted at t = " + std::to_string(result.end_time) + " s";
    return;
  }
  result.status = stop.empty() ? "complete" : "failed";
  std::vector<std::string> expected = expect.fails;
  std::sort(expected.begin(), expected.end());
  const bool expects = !expect.stop.empty() || !expected.empty();
  const bool as_expected = stop == expect.stop && failed == expected;
  result.verdict = as_expected ? (expects ? "as_expected" : "pass") : "fail";
  if (as_expected) {
    result.exit = Exit::ok;
  } else if (stop != expect.stop && !stop.empty() && !recursion_failed) {
    result.exit = Exit::stopped;
  } else {
    result.exit = Exit::claim_failed;
    if (stop.empty() && !expect.stop.empty())
      result.message = "the run completed, but the experiment expects stop: " + expect.stop;
    for (const auto& id : expected)
      if (!std::binary_search(failed.begin(), failed.end(), id))
        result.message += (result.message.empty() ? "" : "; ") + std::string("claim ") + id +
                          " was expected to fail and did not";
  }
}

namespace {

/// printf into the end of a text.
[[gnu::format(printf, 2, 3)]] void add(std::string& out, const char* format, ...) {
  va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  const auto size = static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values));
  va_end(values);
  out.resize(out.size() + size + 1);
  std::vsnprintf(out.data() + out.size() - size - 1, size + 1, format, again);
  va_end(again);
  out.pop_back();  // the ending 0
}

void add_limits(std::string& out, const char* what, const std::vector<TimeSpent>& beyond) {
  for (std::size_t i = 0; i < beyond.size(); ++i)
    if (beyond[i].first)
      add(out, "joint coordinate %zu beyond its %s limit for %.4g s, first at %.4g s\n", i + 1, what,
          beyond[i].total, *beyond[i].first);
}

void add_tracking(std::string& out, const DepartureResult& d) {
  add(out, "tracking error: tip up to %.3e m, %.3e rad; root mean square %.3e m, %.3e rad\n",
      d.position.value, d.orientation.value, d.position_rms, d.orientation_rms);
  add(out, "tip acceleration missed u by up to %.2e m/s^2, %.2e rad/s^2\n", d.linear_acceleration.value,
      d.angular_acceleration.value);
  std::size_t most = 0;
  for (std::size_t i = 1; i < d.torque.size(); ++i)
    if (d.torque[i].value > d.torque[most].value) most = i;
  if (!d.torque.empty())
    add(out, "largest joint torque %.4g at joint coordinate %zu, t = %.4g s\n", d.torque[most].value,
        most + 1, d.torque[most].time);
}

void add_measured(std::string& out, const Measured& m) {
  const DepartureResult& d = m.departure;
  if (d.singularity_policy.first)
    add(out, "the singularity policy acted for %.4g s, from %.4g s to %.4g s\n", d.singularity_policy.total,
        *d.singularity_policy.first, *d.singularity_policy.last);
  if (d.saturated.first)
    add(out, "a torque limit acted for %.4g s, from %.4g s to %.4g s\n", d.saturated.total,
        *d.saturated.first, *d.saturated.last);
  if (m.mode_changes > 0) add(out, "%ld changes of contact or of the truncated directions\n", m.mode_changes);
  add_limits(out, "position", d.beyond_position);
  add_limits(out, "velocity", d.beyond_velocity);
  add_limits(out, "effort", d.beyond_effort);
  if (m.frequency)
    for (const FrequencyPoint& p : m.frequency->points)
      add(out, "at %.4g Hz: gain %.9f (design %.9f), phase %.9f rad (design %.9f)\n", p.frequency, p.gain,
          p.designed_gain, p.phase, p.designed_phase);
  if (m.poles)
    for (std::size_t i = 0; i < m.poles->found.size(); ++i)
      add(out, "pole %.9g %+.9gj 1/s\n", m.poles->found[i].real(), m.poles->found[i].imag());
}

}  // namespace

std::string report(const Experiment& experiment, const RunResult& r) {
  std::string out = verdict_table(r.claims);
  add(out, "\n%s: %s, verdict %s%s%s\n", experiment.name.c_str(), r.status.c_str(), r.verdict.c_str(),
      r.message.empty() ? "" : ": ", r.message.c_str());
  if (r.error.known) {
    add(out,
        "global error estimate: tip %.2e m, %.2e rad, joints %.2e; energies %.2e J, their balance %.2e J\n",
        r.error.position, r.error.orientation, r.error.joints, r.error.energy, r.error.imbalance);
    if (!r.measured.growth_fit.word.empty())
      add(out, "its growth in time: %s (exponent %.2f)\n", r.measured.growth_fit.word.c_str(),
          r.measured.growth_fit.exponent);
  }
  if (r.analytic)
    add(out, "distance from the closed-form solution: tip %.2e m, %.2e rad\n", r.worst_position,
        r.worst_orientation);
  if (experiment.controller.law != Law::free) add_tracking(out, r.measured.departure);
  add_measured(out, r.measured);
  if (r.samples > 0) add(out, "%ld samples of the law, %ld sweeps each\n", r.samples, r.sweeps_per_sample);
  add(out, "%ld steps, %ld right-hand sides, %.4g s simulated, %.0f times real time\n", r.steps,
      r.rhs_evaluations, r.end_time, r.times.simulation > 0 ? r.end_time / r.times.simulation : 0.0);
  if (experiment.integrator.method == Method::bdf)
    add(out, "Jacobian of bdf: %s\n", r.automatic_jacobian ? "in closed form" : "by differences");
  add(out, "wall time: simulation %.4f s, shadow run %.4f s, checking %.4f s, recording %.4f s\n",
      r.times.simulation, r.times.shadow, r.times.checking, r.times.recording);
  return out;
}

}  // namespace osculate
