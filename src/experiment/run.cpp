#include "experiment/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "experiment/recording.hpp"
#include "experiment/stops.hpp"
#include "simulation/cvode.hpp"
#include "verification/delayed_law.hpp"
#include "verification/step_check.hpp"

namespace osculate {

namespace {

using Clock = std::chrono::steady_clock;
using Reason = IntegrationStopped::Reason;

/// Adds the time until its end to a wall time.
class Timed {
 public:
  explicit Timed(double& total) : total_(total) {}
  ~Timed() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Timed(const Timed&) = delete;

 private:
  double& total_;
  Clock::time_point start_ = Clock::now();
};

constexpr double shadow_factor = 100;  // the shadow's tolerances are the run's divided by this
constexpr double energy_atol =
    1e4;  // J per (rad/s): the energies are only checked, they must not shorten the steps
constexpr double smallest_rtol = 1e-14;  // below this CVODE's own rounding governs
constexpr double default_max_step =
    0.1;  // s: a resting arm does not step across a short change of its reference

/// Condition numbers above this with a shrinking step mean that the arm ran into a singularity.
constexpr double singular_condition = 1e6;

std::string stop_name(Reason reason) {
  switch (reason) {
    case Reason::singular:
      return "singular";
    case Reason::non_finite:
      return "non_finite";
    case Reason::step_too_small:
      return "step_too_small";
    case Reason::failed:
      return "failed";
  }
  return "failed";
}

IntegratorOptions integrator_options(const IntegratorConfig& config, const ClosedLoop& loop, double tighter) {
  IntegratorOptions options;
  options.method = config.method;
  options.rtol = std::max(config.rtol / tighter, std::min(config.rtol, smallest_rtol));
  options.max_step = config.max_step > 0 ? config.max_step : default_max_step;
  options.atol.assign(static_cast<std::size_t>(loop.positions()), config.atol_position / tighter);
  options.atol.insert(options.atol.end(), static_cast<std::size_t>(loop.velocities()),
                      config.atol_velocity / tighter);
  options.atol.insert(options.atol.end(), 3, energy_atol * config.atol_velocity / tighter);
  return options;
}

/// The problem of one integrator: its own closed loop, so that no workspace is shared. The reference may jump
/// at the end of a segment; up to `limit` the integrator sees it from the left.
struct Simulation {
  ClosedLoop loop;
  double limit = std::numeric_limits<double>::infinity();  // s
  Cvode integrator;

  Simulation(const ClosedLoop& problem, std::span<const double> y0, const IntegratorOptions& options)
      : loop(problem),
        integrator(
            [this](double t, const double* y, double* yd) { loop.right_side(std::min(t, limit), y, yd); }, 0,
            y0, options) {}
  Simulation(const Simulation&) = delete;  // the integrator holds a pointer to the loop
};

/// The run while it goes on.
class Runner {
 public:
  Runner(const Experiment& experiment, const RunOptions& options)
      : experiment_(experiment), options_(options), arms_(make_arms(experiment)), problem_(make_problem()) {
    result_.warnings = arms_.warnings;
    const auto& sampling = experiment.controller.sampling;
    if (sampling && sampling->delay != Delay::none)
      delayed_law_.emplace(arms_.model, problem_.controller().options());
    if (options.output) {
      const Timed timed(result_.times.recording);
      recording_.emplace(*options.output, experiment, arms_, options.command, options.force);
    }
  }

  RunResult go() {
    std::string stop;  // why it ended early; "" at the end
    try {
      integrate();
    } catch (const IntegrationStopped& error) {
      stop = stop_name(error.reason);
      if (error.reason == Reason::step_too_small && last_condition_ > singular_condition) stop = "singular";
      result_.message = error.what();
      judge_without_command();
    }
    if (stop.empty() && !interrupted_ && result_.end_time < experiment_.duration) {
      stop = "too_many_steps";
      result_.message =
          "integrator.max_steps = " + std::to_string(experiment_.integrator.max_steps) + " reached";
    }
    conclude(stop);
    if (recording_) {
      const Timed timed(result_.times.recording);
      recording_->finish(result_);
    }
    return result_;
  }

 private:
  ClosedLoop make_problem() const {
    const ControllerConfig& c = experiment_.controller;
    LawOptions law;
    law.law = c.law;
    law.rows = c.rows;
    law.stiffness = c.stiffness;
    law.damping = c.damping;
    law.null_space_damping = c.null_space_damping;
    law.compensate_friction = c.compensate_friction;
    law.orientation = c.orientation;
    law.position = c.position;
    law.sampling = c.sampling;
    if (c.compensate_tip_force) law.known_tip_force = arms_.plant.tip_force;
    if (experiment_.base_motion && !std::holds_alternative<HoldOptions>(*experiment_.base_motion))
      law.base_path = path_of(*experiment_.base_motion, {});
    const Pose initial = tip_pose(arms_.model, experiment_.q, base_motion(law.base_path.get(), 0));
    std::shared_ptr<const Path> path = path_of(experiment_.reference, initial);
    return ClosedLoop(Controller(arms_.model, arms_.friction, law, std::move(path), initial), arms_.plant);
  }

  /// `initial`: where waypoints start from.
  static std::shared_ptr<const Path> path_of(const ReferenceConfig& config, const Pose& initial) {
    return std::visit(
        [&initial](const auto& reference) -> std::unique_ptr<Path> {
          if constexpr (std::is_same_v<std::decay_t<decltype(reference)>, WaypointsOptions>)
            return make_path(reference, initial);
          else
            return make_path(reference);
        },
        config);
  }

  std::vector<double> start() const {
    std::vector<double> y(problem_.states(), 0.0);
    std::copy(experiment_.q.begin(), experiment_.q.end(), y.begin());
    std::copy(experiment_.qd.begin(), experiment_.qd.end(),
              y.begin() + static_cast<std::ptrdiff_t>(experiment_.q.size()));
    return y;
  }

  void integrate() {
    const std::vector<double> y0 = start();
    Simulation main(problem_, y0, integrator_options(experiment_.integrator, problem_, 1));
    std::optional<Simulation> shadow;
    if (experiment_.verify.shadow)
      shadow.emplace(problem_, y0, integrator_options(experiment_.integrator, problem_, shadow_factor));
    Simulation* const other = shadow ? &*shadow : nullptr;
    row_state_.resize(y0.size());
    if (problem_.sampled()) sample(0, main, other);
    trajectory_.emplace(problem_, problem_.observe(0, y0));
    if (shadow) result_.error.known = true;
    check_step(0, y0, other, problem_.sampled());
    write_rows(main, 0);

    Stops stops(experiment_, problem_.controller());
    for (double stop = stops.next(); !std::isnan(stop); stop = stops.next()) {
      // A law that acts at every instant sees a jump of its reference at `stop` from the left up to there.
      limit_ = stop < experiment_.duration ? std::nextafter(stop, 0.0) : stop;
      main.limit = limit_;
      if (shadow) shadow->limit = limit_;
      while (main.integrator.t() < stop) {
        interrupted_ = options_.signal && *options_.signal != 0;
        if (interrupted_ || result_.steps >= experiment_.integrator.max_steps) return;
        advance(main, other, stop);
        show_progress();
      }
      if (stop >= experiment_.duration) break;
      main.integrator.restart();
      if (shadow) shadow->integrator.restart();
      if (problem_.sampled()) {
        sample(stop, main, other);
        check_step(stop, main.integrator.state(), other, true);
        record_step(last_step_);  // what the law did at the end of the step is judged now
      } else {
        trajectory_->restart_at(stop);
      }
    }
  }

  /// The next sample of the law in the run, in its shadow, and in the copy that is observed.
  void sample(double t, Simulation& main, Simulation* shadow) {
    main.loop.sample(t, main.integrator.state());
    problem_.sample(t, main.integrator.state());
    if (shadow) shadow->loop.sample(t, shadow->integrator.state());
    ++result_.samples;
    result_.sweeps_per_sample = problem_.controller().sweeps_of_last_torque();
  }

  void advance(Simulation& main, Simulation* shadow, double stop) {
    StepInfo step;
    {
      const Timed timed(result_.times.simulation);
      step = main.integrator.step(stop);
    }
    if (shadow) {
      const Timed timed(result_.times.shadow);
      while (shadow->integrator.t() < step.t) shadow->integrator.step(stop);
    }
    ++result_.steps;
    last_step_ = step;
    result_.end_time = step.t;
    result_.rhs_evaluations = main.integrator.rhs_evaluations();
    last_state_.assign(main.integrator.state().begin(), main.integrator.state().end());
    write_rows(main, step.t - step.h);
    if (result_.steps % experiment_.verify.every == 0 || step.t >= experiment_.duration) {
      check_step(step.t, main.integrator.state(), shadow, false);
      const bool sample_follows = problem_.sampled() && step.t >= stop && stop < experiment_.duration;
      if (!sample_follows) record_step(step);
    }
  }

  /// at_sample: a sampled law has just acted at this state.
  void check_step(double step_end, std::span<const double> y, Simulation* shadow, bool at_sample) {
    const Timed timed(result_.times.checking);
    const double t = at_sample ? step_end : std::min(step_end, limit_);  // a jump is seen from the left
    Evidence evidence = gather(problem_, t, y, at_sample);
    if (at_sample && delayed_law_)
      evidence.delayed_torque =
          delayed_law_->torque(problem_.q(y.data()), evidence.qd, evidence.u, evidence.T0);
    residuals_ = assess(evidence);
    last_condition_ = scaled_condition(evidence.task.Omega);
    // The trajectory claims read a fresh observation: gather went on to other sweeps.
    const Observation seen = problem_.observe(t, y);
    if (shadow && t > 0 && !at_sample) {
      shadow->integrator.interpolate(step_end, 0, row_state_);
      result_.error.add(seen, shadow->loop.observe(t, row_state_));
    }
    const Residuals along = trajectory_->assess(seen, result_.error);
    for (const Claim claim : {Claim::analytic_response, Claim::decoupling})
      residuals_[index(claim)] = along[index(claim)];
    worse_ = verdict_.add(step_end, residuals_);
    residuals_[index(Claim::energy)] = along[index(Claim::energy)];
  }

  /// After a stop: is the arm where it stopped as the recursions say? Omega, the plant and the kinematics can
  /// be judged without a command. A recursion that is wrong must not pass for a singular arm.
  void judge_without_command() {
    const std::vector<double> y = last_state_.empty() ? start() : last_state_;
    LawOptions law = problem_.controller().options();
    law.law = Law::free;
    law.sampling.reset();
    ClosedLoop still(Controller(arms_.model, arms_.friction, law, problem_.controller().shared_path(),
                                problem_.controller().initial()),
                     arms_.plant);
    verdict_.add(result_.end_time, assess(gather(still, result_.end_time, y)));
  }

  void record_step(const StepInfo& step) {
    if (!recording_) return;
    const VerifyConfig& verify = experiment_.verify;
    if (verify.record == VerifyConfig::Record::worst && !worse_) return;
    if (verify.record == VerifyConfig::Record::every && result_.steps % verify.record_every != 0) return;
    const Timed timed(result_.times.recording);
    recording_->step(
        {result_.steps, step.t, step.h, step.local_error, step.order, result_.rhs_evaluations, result_.error},
        residuals_);
  }

  /// Output rows that fall into the last step, by the method's own polynomial. `from`: start of the step.
  void write_rows(const Simulation& main, double from) {
    if (!recording_) return;
    const double t_end = main.integrator.t();
    // Output times are k * interval, never accumulated; the last one may be the duration to rounding.
    for (;; ++next_row_) {
      double t = static_cast<double>(next_row_) * experiment_.output.interval;
      if (std::abs(t - experiment_.duration) <= 1e-9 * experiment_.output.interval) t = experiment_.duration;
      if (t > t_end || (next_row_ > 0 && t <= 0)) return;
      const Timed timed(result_.times.recording);
      if (t_end > from && t_end > 0)
        main.integrator.interpolate(t, 0, row_state_);
      else
        std::copy(main.integrator.state().begin(), main.integrator.state().end(), row_state_.begin());
      const Observation& seen = problem_.observe(std::min(t, limit_), row_state_);
      const TaskRows& rows = problem_.controller().options().rows;
      const RecursiveTerms terms = problem_.controller().terms(seen.qd);
      const MatrixX<double> Omega = terms.Omega(rows, rows);
      const double condition = scaled_condition(Omega);
      recording_->output(seen, rows, terms,
                         std::isfinite(condition) ? condition : std::numeric_limits<double>::quiet_NaN());
    }
  }

  void show_progress() {
    if (!options_.progress) return;
    const auto now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(500)) return;
    shown_ = now;
    options_.progress(result_.end_time, experiment_.duration,
                      std::chrono::duration<double>(now - begun_).count());
  }

  void conclude(const std::string& stop) {
    std::array<std::string, claim_count> reasons;
    if (trajectory_)
      for (const Claim claim : {Claim::analytic_response, Claim::decoupling})
        reasons[index(claim)] =
            result_.error.known ? trajectory_->reason(claim) : "no shadow run: verify.shadow is false";
    if (experiment_.controller.law == Law::free) {
      for (const Claim claim : {Claim::torque, Claim::linearization}) reasons[index(claim)] = "free swing";
    } else if (!problem_.plant_is_model()) {
      reasons[index(Claim::linearization)] = "plant and model differ on purpose";
    } else if (delayed_law_) {
      reasons[index(Claim::linearization)] = "the law is delayed on purpose";
    }
    reasons[index(Claim::null_space)] =
        delayed_law_ ? "the law is delayed on purpose" : "no null-space torque";
    reasons[index(Claim::coordinates)] = problem_.controller().chart()
                                             ? reasons[index(Claim::linearization)]
                                             : "no coordinates of its own are tracked";
    result_.claims = verdict_.results(reasons);
    if (trajectory_) {
      result_.claims[index(Claim::energy)] = trajectory_->energy_result();
      result_.analytic = trajectory_->reason(Claim::analytic_response).empty();
      result_.worst_position = trajectory_->worst_position();
      result_.worst_orientation = trajectory_->worst_orientation();
    }

    std::vector<std::string> failed;
    for (std::size_t i = 0; i < claim_count; ++i)
      if (result_.claims[i].outcome == Outcome::fail) failed.emplace_back(claim_table[i].id);
    std::sort(failed.begin(), failed.end());
    // A stop after a recursion disagreed with its definition is the recursion's fault, not the arm's.
    bool recursion_failed = false;
    for (std::size_t i = 0; i < index(Claim::energy); ++i)
      recursion_failed = recursion_failed || result_.claims[i].reason == "residual above its bound";

    if (interrupted_) {
      result_.status = "interrupted";
      result_.verdict = failed.empty() ? "pass" : "fail";
      result_.exit = *options_.signal == SIGTERM ? Exit::terminated : Exit::interrupted;
      result_.message = "interrupted at t = " + std::to_string(result_.end_time) + " s";
      return;
    }
    result_.status = stop.empty() ? "complete" : "failed";
    const ExpectConfig& expect = experiment_.expect;
    std::vector<std::string> expected = expect.fails;
    std::sort(expected.begin(), expected.end());
    const bool expects = !expect.stop.empty() || !expected.empty();
    const bool as_expected = stop == expect.stop && failed == expected;
    result_.verdict = as_expected ? (expects ? "as_expected" : "pass") : "fail";
    if (as_expected) {
      result_.exit = Exit::ok;
    } else if (stop != expect.stop && !stop.empty() && !recursion_failed) {
      result_.exit = Exit::stopped;
    } else {
      result_.exit = Exit::claim_failed;
      if (stop.empty() && !expect.stop.empty())
        result_.message = "the run completed, but the experiment expects stop: " + expect.stop;
      for (const auto& id : expected)
        if (!std::binary_search(failed.begin(), failed.end(), id))
          result_.message += (result_.message.empty() ? "" : "; ") + std::string("claim ") + id +
                             " was expected to fail and did not";
    }
  }

  const Experiment& experiment_;
  const RunOptions& options_;
  Arms arms_;
  ClosedLoop problem_;  // for rows and checks; the integrators have their own copies
  RunResult result_;
  std::optional<Recording> recording_;
  std::optional<TrajectoryClaims> trajectory_;
  std::optional<DelayedLaw> delayed_law_;  // the definition that a law with delay is judged by
  Verdict verdict_;
  Residuals residuals_{};
  bool worse_ = false, interrupted_ = false;
  double last_condition_ = 1;
  double limit_ = std::numeric_limits<double>::infinity();
  StepInfo last_step_;
  std::vector<double> row_state_, last_state_;
  long next_row_ = 0;
  Clock::time_point begun_ = Clock::now(), shown_ = Clock::now();
};

}  // namespace

void check(const Experiment& experiment) {
  const RunOptions nothing;
  const Runner ready(experiment, nothing);
}

RunResult run(const Experiment& experiment, const RunOptions& options) {
  return Runner(experiment, options).go();
}

std::string report(const Experiment& experiment, const RunResult& r) {
  std::string out = verdict_table(r.claims);
  char line[320];
  const auto add = [&out, &line] { out += line; };
  std::snprintf(line, sizeof line, "\n%s: %s, verdict %s%s%s\n", experiment.name.c_str(), r.status.c_str(),
                r.verdict.c_str(), r.message.empty() ? "" : ": ", r.message.c_str());
  add();
  if (r.error.known) {
    std::snprintf(line, sizeof line,
                  "global error estimate: tip %.2e m, %.2e rad; energies %.2e J, their balance %.2e J\n",
                  r.error.position, r.error.orientation, r.error.energy, r.error.imbalance);
    add();
  }
  if (r.analytic) {
    std::snprintf(line, sizeof line, "distance from the closed-form solution: tip %.2e m, %.2e rad\n",
                  r.worst_position, r.worst_orientation);
    add();
  }
  if (r.samples > 0) {
    std::snprintf(line, sizeof line, "%ld samples of the law, %ld sweeps each\n", r.samples,
                  r.sweeps_per_sample);
    add();
  }
  std::snprintf(
      line, sizeof line, "%ld steps, %ld right-hand sides, %.4g s simulated, %.0f times real time\n", r.steps,
      r.rhs_evaluations, r.end_time, r.times.simulation > 0 ? r.end_time / r.times.simulation : 0.0);
  add();
  std::snprintf(line, sizeof line,
                "wall time: simulation %.3f s, shadow run %.3f s, checking %.3f s, recording %.3f s\n",
                r.times.simulation, r.times.shadow, r.times.checking, r.times.recording);
  add();
  return out;
}

}  // namespace osculate
