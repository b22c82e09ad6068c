#include <cmath>
#include <limits>

#include "experiment/recording.hpp"

namespace osculate {

namespace {

std::vector<VerdictRow> verdict_rows(const RunResult& result) {
  std::vector<VerdictRow> rows;
  for (std::size_t i = 0; i < claim_count; ++i) {
    const ClaimResult& r = result.claims[i];
    const bool judged = r.outcome != Outcome::not_applicable;
    rows.push_back({std::string(claim_table[i].id), std::string(claim_table[i].equation), r.reason,
                    judged ? r.worst.value : missing, judged ? r.worst.bound : missing,
                    judged ? r.at_time : missing, static_cast<int>(r.outcome), r.undecided_steps,
                    r.checked_steps});
  }
  return rows;
}

std::vector<Scalar> scalars(const RunResult& r) {
  const auto known = [&r](double x) { return r.error.known ? x : missing; };
  const auto analytic = [&r](double x) { return r.analytic ? x : missing; };
  const DepartureResult& d = r.measured.departure;
  const auto& policy = d.singularity_policy;
  return {
      {"timing/simulation", r.times.simulation, "s", "wall time of the integration"},
      {"timing/shadow", r.times.shadow, "s", "wall time of the shadow run"},
      {"timing/checking", r.times.checking, "s", "wall time of the checks"},
      {"timing/recording", r.times.recording, "s", "wall time of recording"},
      {"global_error/position", known(r.error.position), "m", "estimate of the tip position's true error"},
      {"global_error/orientation", known(r.error.orientation), "rad",
       "estimate of the tip orientation's true error"},
      {"global_error/velocity", known(r.error.velocity), "m/s", "estimate of the tip velocity's true error"},
      {"global_error/joints", known(r.error.joints), "1",
       "estimate of the joint positions' true error, rad and m alike"},
      {"global_error/energy", known(r.error.energy), "J", "estimate of the energies' true error"},
      {"analytic_response/position", analytic(r.worst_position), "m",
       "largest distance of the tip from the closed-form solution"},
      {"analytic_response/orientation", analytic(r.worst_orientation), "rad",
       "largest angle between the tip and the closed-form solution"},
      {"measured/position_error", d.position.value, "m", "largest tracking error on the task rows"},
      {"measured/orientation_error", d.orientation.value, "rad", "largest tracking error on the task rows"},
      {"measured/position_rms", d.position_rms, "m", "root mean square of the tracking error"},
      {"measured/orientation_rms", d.orientation_rms, "rad", "root mean square of the tracking error"},
      {"measured/missed_linear_acceleration", d.linear_acceleration.value, "m/s^2",
       "largest tip acceleration - u on the task rows"},
      {"measured/missed_angular_acceleration", d.angular_acceleration.value, "rad/s^2",
       "largest tip acceleration - u on the task rows"},
      {"measured/policy_seconds", policy.total, "s", "time for which the singularity policy changed F"},
      {"measured/policy_first", policy.first.value_or(missing), "s", "when it first did"},
      {"measured/policy_last", policy.last.value_or(missing), "s", "when it last did"},
      {"measured/saturated_seconds", d.saturated.total, "s", "time for which a torque limit acted"},
      {"measured/self_motion", r.measured.self_motion, "J",
       "largest kinetic energy of motion that the tip does not see"},
      {"measured/mode_changes", static_cast<double>(r.measured.mode_changes), "1",
       "changes of contact or of the truncated directions"},
      {"measured/growth_exponent",
       r.measured.growth_fit.word.empty() ? missing : r.measured.growth_fit.exponent, "1",
       "error ~ time^exponent over the later half of log time"},
  };
}

void add_coupling(const Measured& m, Ending& out) {
  std::vector<double> worst, time;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      worst.push_back(m.coupling.worst()(i, j));
      time.push_back(m.coupling.time()(i, j));
    }
  out.tables.push_back(
      {"measured/cross_coupling",
       {"spatial", "spatial_column"},
       "",
       "largest motion along the column's axis while the row's axis alone was commanded, less "
       "that of the closed form; rad or m by column",
       worst});
  out.tables.push_back(
      {"measured/cross_coupling_time", {"spatial", "spatial_column"}, "s", "when it occurred", time});
}

void add_growth(const Measured& m, Ending& out) {
  std::vector<double> ends, errors;
  for (const ErrorGrowth::Bin& bin : m.growth.bins()) {
    ends.push_back(bin.end);
    errors.push_back(bin.error);
  }
  if (ends.empty()) return;
  out.axes.push_back(
      {.name = "growth_time", .unit = "s", .long_name = "end of the bin", .coordinates = ends});
  out.tables.push_back({"measured/error_growth",
                        {"growth_time"},
                        "m",
                        "largest estimate of the tip position's error in the bin",
                        errors});
}

void add_joints(const DepartureResult& d, Ending& out) {
  const auto totals = [](const std::vector<TimeSpent>& spent) {
    std::vector<double> seconds;
    for (const TimeSpent& s : spent) seconds.push_back(s.total);
    return seconds;
  };
  std::vector<double> peak, time;
  for (const Peak& p : d.torque) {
    peak.push_back(p.value);
    time.push_back(p.time);
  }
  if (peak.empty()) return;
  out.tables.push_back({"measured/joint_torque_peak",
                        {"velocity_coordinate"},
                        "",
                        "largest |joint torque|, see effort_unit",
                        peak});
  out.tables.push_back(
      {"measured/joint_torque_peak_time", {"velocity_coordinate"}, "s", "when it occurred", time});
  out.tables.push_back({"measured/seconds_beyond_position",
                        {"position_coordinate"},
                        "s",
                        "time outside the position limits of the model",
                        totals(d.beyond_position)});
  out.tables.push_back({"measured/seconds_beyond_velocity",
                        {"velocity_coordinate"},
                        "s",
                        "time above the velocity limit of the model",
                        totals(d.beyond_velocity)});
  out.tables.push_back({"measured/seconds_beyond_effort",
                        {"velocity_coordinate"},
                        "s",
                        "time above the effort limit of the model",
                        totals(d.beyond_effort)});
}

void add_frequency(const FrequencyResponse& response, Ending& out) {
  std::vector<double> frequency, gain, phase, designed_gain, designed_phase, error, bound;
  for (const FrequencyPoint& p : response.points) {
    frequency.push_back(p.frequency);
    gain.push_back(p.gain);
    phase.push_back(p.phase);
    designed_gain.push_back(p.designed_gain);
    designed_phase.push_back(p.designed_phase);
    error.push_back(p.error);
    bound.push_back(p.bound);
  }
  out.axes.push_back({.name = "frequency",
                      .unit = "Hz",
                      .long_name = "frequencies of the reference",
                      .coordinates = frequency});
  const auto add = [&out](const char* name, const char* unit, const char* about, std::vector<double> values) {
    out.tables.push_back(
        {std::string("frequency_response/") + name, {"frequency"}, unit, about, std::move(values)});
  };
  add("gain", "1", "tip over reference, measured", gain);
  add("phase", "rad", "tip over reference, measured; negative where the tip is late", phase);
  add("designed_gain", "1", "of K / (K - w^2 + j D w)", designed_gain);
  add("designed_phase", "rad", "of K / (K - w^2 + j D w)", designed_phase);
  add("error", "1", "distance of the measured from the designed complex gain", error);
  add("bound", "1", "what the error of the run allows", bound);
}

void add_poles(const PoleCheck& poles, Ending& out) {
  const auto add = [&out](const char* axis, const char* name, const char* about,
                          const std::vector<std::complex<double>>& values) {
    std::vector<std::string> labels;
    std::vector<double> real, imaginary;
    for (const auto& pole : values) {
      labels.push_back(std::to_string(labels.size() + 1));
      real.push_back(pole.real());
      imaginary.push_back(pole.imag());
    }
    if (labels.empty()) return;
    out.axes.push_back({.name = axis, .labels = labels, .long_name = "number of the pole"});
    const std::string path = std::string("poles/") + name;
    out.tables.push_back({path + "_real", {axis}, "1/s", std::string(about) + ", real part", real});
    out.tables.push_back({path + "_imag", {axis}, "1/s", std::string(about) + ", imaginary part", imaginary});
  };
  add("pole", "found", "poles of the closed loop linearised at the start", poles.found);
  add("designed_pole", "designed", "roots of s^2 + D s + K", poles.designed);
}

}  // namespace

Ending ending_of(const RunResult& result) {
  Ending out{.rows = verdict_rows(result), .scalars = scalars(result)};
  const Measured& m = result.measured;
  if (!m.coupling.worst().array().isNaN().all()) add_coupling(m, out);
  add_growth(m, out);
  add_joints(m.departure, out);
  if (m.frequency) add_frequency(*m.frequency, out);
  if (m.poles) add_poles(*m.poles, out);
  return out;
}

}  // namespace osculate
