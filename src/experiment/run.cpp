#include "experiment/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "experiment/conclusion.hpp"
#include "experiment/make_loop.hpp"
#include "experiment/recording.hpp"
#include "experiment/simulation.hpp"
#include "experiment/stops.hpp"
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

/// Kinetic energy of motion that the tip does not see, J: (qd* M qd - V* Lambda V) / 2 of the model.
double self_motion(const Evidence& e) {
  if (e.terms.Lambda.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const UpTo6 V = e.task.J.lazyProduct(e.qd);
  return (e.qd.dot(e.model.joint.M.lazyProduct(e.qd)) - V.dot(e.terms.Lambda.lazyProduct(V))) / 2;
}

/// The run while it goes on.
class Runner {
 public:
  Runner(const Experiment& experiment, const RunOptions& options)
      : experiment_(experiment),
        options_(options),
        arms_(make_arms(experiment)),
        blank_(make_loop(experiment, arms_)),
        problem_(blank_),
        measurements_(experiment, arms_, problem_),
        step_check_(problem_),
        force_(problem_) {
    result_.warnings = arms_.warnings;
    const auto& sampling = experiment.controller.sampling;
    if (sampling && sampling->delay != Delay::none)
      delayed_law_.emplace(arms_.model, problem_.controller().options());
    if (options.output) {
      const Timed timed(result_.times.recording);
      recording_.emplace(*options.output, experiment, arms_, options.command, options.force);
      if (options.from) recording_->go_on_from(*options.from);
    }
  }

  RunResult go() {
    std::string stop;  // why it ended early; "" at the end
    try {
      integrate();
    } catch (const IntegrationStopped& error) {
      stop = stop_name(error.reason);
      if (error.reason == Reason::step_too_small && last_condition() > singular_condition) stop = "singular";
      result_.message = error.what();
      judge_without_command();
    } catch (const MemoryMismatch& error) {
      if (!options_.from) throw;
      throw FileError(
          options_.from->file.string() + ": its restart point at t = " + std::to_string(options_.from->time) +
          " s cannot be used: " + error.what() + "; another version of osculate wrote it, or it is damaged");
    }
    if (stop.empty() && signal_ == 0 && result_.end_time < experiment_.duration) {
      stop = "too_many_steps";
      result_.message =
          "integrator.max_steps = " + std::to_string(experiment_.integrator.max_steps) + " reached";
    }
    collect();
    conclude(experiment_.expect, stop, signal_, result_);
    if (recording_) {
      const Timed timed(result_.times.recording);
      recording_->finish(result_);
    }
    return result_;
  }

 private:
  void integrate() {
    const std::vector<double> y0 = initial_state(experiment_, problem_);
    row_state_.resize(y0.size());
    if (experiment_.verify.poles) measurements_.linearise(problem_, y0);
    result_.error.tolerance = experiment_.integrator.rtol + experiment_.integrator.atol_position;
    result_.automatic_jacobian =
        automatic_jacobian(integrator_options(experiment_.integrator, blank_, 1), blank_);
    Stops stops(experiment_, problem_.controller());
    if (options_.from) {
      trajectory_.emplace(problem_, problem_.observe(0, y0));
      Memory memory(options_.from->memory);
      go_on_from(memory);
      std::optional<Stop> stop;
      for (long i = 0; i < stops_; ++i) stop = stops.next();
      if (!stop || stop->time != main_->integrator.t())
        throw MemoryMismatch("its time is no restart point of this experiment");
      pass(*stop);
    } else {
      start(y0);
    }
    while (const std::optional<Stop> stop = stops.next()) {
      ++stops_;
      // A law that acts at every instant sees a jump of its reference at the stop from the left up to there.
      limit_ = stop->jumps ? std::nextafter(stop->time, 0.0) : stop->time;
      for_each([this](Simulation& simulation) { simulation.limit = limit_; });
      while (main_->integrator.t() < stop->time) {
        if (options_.signal) signal_ = *options_.signal;
        if (signal_ != 0 || result_.steps >= experiment_.integrator.max_steps) return;
        advance(*stop);
        show_progress();
      }
      if (stop->kind == Stop::Kind::end) break;
      if (stop->restart) restart();
      pass(*stop);
    }
  }

  void start(const std::vector<double>& y0) {
    main_.emplace(blank_, y0, integrator_options(experiment_.integrator, blank_, 1));
    if (experiment_.verify.shadow)
      shadow_.emplace(blank_, y0, integrator_options(experiment_.integrator, blank_, shadow_factor));
    problem_.set_modes(main_->loop.modes());
    if (problem_.sampled()) {
      sample(0);
      apply();
    }
    trajectory_.emplace(problem_, problem_.observe(0, y0));
    result_.error.known = shadow_.has_value();
    check_step({}, y0, problem_.sampled());
    write_rows(0);
  }

  /// A restart point: the run becomes numbers, and goes on from nothing else, as a resumed one does.
  void restart() {
    Memory written;
    remember(written);
    if (recording_) {
      const Timed timed(result_.times.recording);
      recording_->restart_point(main_->integrator.t(), written.numbers());
    }
    Memory read(written.numbers());
    go_on_from(read);
  }

  /// Everything that changes along the run is set or made anew from the numbers of a restart point.
  void go_on_from(Memory& memory) {
    remember(memory);
    memory.require_end();
    problem_ = main_->loop;
    last_state_.assign(main_->integrator.state().begin(), main_->integrator.state().end());
    step_check_.gather(problem_, problem_.observe(main_->integrator.t(), last_state_));
  }

  void remember(Memory& memory) {
    memory(result_.error, result_.end_time, result_.steps, result_.rhs_evaluations, result_.samples,
           result_.sweeps_per_sample, verdict_, *trajectory_, force_, measurements_, filtered_, last_step_,
           next_row_, stops_);
    if (delayed_law_) memory(*delayed_law_);
    if (recording_) memory(*recording_);
    remember(memory, main_, 1);
    if (experiment_.verify.shadow) remember(memory, shadow_, shadow_factor);
  }

  /// State and memory of the run or its shadow; read, it is made anew with them.
  void remember(Memory& memory, std::optional<Simulation>& simulation, double tighter) {
    double t = 0;
    std::vector<double> y;
    if (!memory.reading()) {
      t = simulation->integrator.t();
      y.assign(simulation->integrator.state().begin(), simulation->integrator.state().end());
    }
    memory(t, y);
    if (!memory.reading()) return simulation->remember(memory);
    if (y.size() != blank_.states()) throw MemoryMismatch("its state belongs to another arm");
    simulation.emplace(blank_, t, y, integrator_options(experiment_.integrator, blank_, tighter), memory);
  }

  /// Calls `work` with the run and its shadow, if it has one.
  template <class Work>
  void for_each(const Work& work) {
    work(*main_);
    if (shadow_) work(*shadow_);
  }

  /// What happens at a stop.
  void pass(const Stop& stop) {
    limit_ = std::numeric_limits<double>::infinity();
    for_each([&](Simulation& simulation) {
      simulation.limit = limit_;
      if (stop.kind == Stop::Kind::jump) simulation.restart();
    });
    if (stop.kind == Stop::Kind::jump) trajectory_->restart_at(stop.time);
    if (stop.kind == Stop::Kind::sample) {
      sample(stop.time);
      if (problem_.controller().options().sampling->computation_time == 0) apply();
      check_step(last_step_, main_->integrator.state(), true);
      record_step(last_step_);  // what the law did at the end of the step is judged now
    }
    if (stop.kind == Stop::Kind::apply) apply();
  }

  /// The next sample of the law in the run, in its shadow, and in the copy that is observed.
  void sample(double t) {
    for_each([t](Simulation& simulation) { simulation.loop.sample(t, simulation.integrator.state()); });
    problem_.sample(t, main_->integrator.state());
    ++result_.samples;
    result_.sweeps_per_sample = problem_.controller().sweeps_of_last_torque();
  }

  /// The torque of the last sample begins to act.
  void apply() {
    problem_.apply();
    for_each([](Simulation& simulation) {
      simulation.loop.apply();
      simulation.restart();
    });
  }

  void advance(const Stop& stop) {
    Simulation& main = *main_;
    StepInfo step;
    bool switched = false;
    {
      const Timed timed(result_.times.simulation);
      std::tie(step, switched) = main.step(stop.time);
    }
    if (switched) measurements_.mode_changed();
    problem_.set_modes(main.loop.modes());
    if (shadow_) {
      const Timed timed(result_.times.shadow);
      // A one-step method stops where the run is, for nothing; the others would lose their order.
      const bool meets = experiment_.integrator.method == Method::runge_kutta;
      while (shadow_->integrator.t() < step.t) shadow_->step(meets ? step.t : stop.time);
    }
    ++result_.steps;
    last_step_ = step;
    result_.end_time = step.t;
    result_.rhs_evaluations = main.rhs_evaluations();
    last_state_.assign(main.integrator.state().begin(), main.integrator.state().end());
    write_rows(step.t - step.h);
    if (result_.steps % experiment_.verify.every == 0 || step.t >= experiment_.duration) {
      check_step(step, main.integrator.state(), false);
      const bool sample_follows = stop.kind == Stop::Kind::sample && step.t >= stop.time;
      if (!sample_follows) record_step(step);
    }
  }

  /// at_sample: a sampled law has just acted at this state.
  void check_step(const StepInfo& step, std::span<const double> y, bool at_sample) {
    const Timed timed(result_.times.checking);
    const double t = at_sample ? step.t : std::min(step.t, limit_);  // a jump is seen from the left
    const Observation& seen = problem_.observe(t, y);
    Evidence& evidence = step_check_.gather(problem_, seen, at_sample);
    if (at_sample && delayed_law_)
      evidence.delayed_torque = delayed_law_->torque(problem_.q(y.data()), evidence.qd, evidence.u,
                                                     evidence.T0, evidence.known_tip_force);
    residuals_ = assess(evidence);
    if (at_sample && problem_.controller().options().sensors) {
      const Residuals measured = assess(gather_as_measured(problem_, evidence));
      for (const Claim claim : {Claim::torque, Claim::null_space})
        residuals_[index(claim)] = measured[index(claim)];
    }
    if (shadow_ && t > 0 && !at_sample) {
      shadow_->integrator.interpolate(step.t, 0, row_state_);
      result_.error.add(seen, shadow_->loop.locate(t, row_state_));
    }
    const Residuals along = trajectory_->assess(seen, result_.error);
    for (const Claim claim : {Claim::analytic_response, Claim::decoupling})
      residuals_[index(claim)] = along[index(claim)];
    residuals_[index(Claim::force_response)] = force_.assess(seen, problem_.modes().contact, result_.error);
    worse_ = verdict_.add(step.t, residuals_);
    residuals_[index(Claim::energy)] = along[index(Claim::energy)];
    filtered_ = filtered_ || seen.command.filtered || seen.command.saturated;
    // The first samples fill the memory of a delayed law.
    const bool acts = !problem_.sampled() || (at_sample && (!delayed_law_ || result_.samples > 3));
    measurements_.step(seen, at_sample ? 0 : step.h, *trajectory_, result_.error, self_motion(evidence),
                       acts);
    missed_ = acts ? Vector6(seen.tip_acceleration - seen.command.u)
                   : Vector6(Vector6::Constant(std::numeric_limits<double>::quiet_NaN()));
  }

  /// After a stop: is the arm where it stopped as the recursions say? Omega, the plant and the kinematics can
  /// be judged without a command. A recursion that is wrong must not pass for a singular arm.
  void judge_without_command() {
    const std::vector<double> y = last_state_.empty() ? initial_state(experiment_, problem_) : last_state_;
    LawOptions law = problem_.controller().options();
    law.law = Law::free;
    law.sampling.reset();
    law.sensors.reset();
    ClosedLoop still(Controller(arms_.model, arms_.friction, law, problem_.controller().shared_path(),
                                problem_.controller().initial()),
                     arms_.plant);
    still.set_modes(problem_.modes());
    verdict_.add(result_.end_time, assess(gather(still, result_.end_time, y)));
  }

  /// Of Omega at the last checked step, scaled to unit diagonal.
  double last_condition() const {
    const MatrixX<double>& Omega = step_check_.last().task.Omega;
    return Omega.size() > 0 ? scaled_condition(Omega) : 1;
  }

  void record_step(const StepInfo& step) {
    if (!recording_) return;
    const VerifyConfig& verify = experiment_.verify;
    if (verify.record == VerifyConfig::Record::worst && !worse_) return;
    if (verify.record == VerifyConfig::Record::every && result_.steps % verify.record_every != 0) return;
    const Timed timed(result_.times.recording);
    recording_->step({result_.steps, step, result_.rhs_evaluations, result_.error, problem_.modes(), missed_},
                     residuals_);
  }

  /// Output instants that fall into the last step, by the method's own polynomial. `from`: start of the step.
  void write_rows(double from) {
    if (!recording_ && !measurements_.wants_samples()) return;
    const Integrator& integrator = main_->integrator;
    const double t_end = integrator.t();
    // Output times are k * interval, never accumulated; the last one may be the duration to rounding.
    for (;; ++next_row_) {
      double t = static_cast<double>(next_row_) * experiment_.output.interval;
      if (std::abs(t - experiment_.duration) <= 1e-9 * experiment_.output.interval) t = experiment_.duration;
      if (t > t_end || (next_row_ > 0 && t <= 0)) return;
      const Timed timed(result_.times.recording);
      if (t_end > from && t_end > 0)
        integrator.interpolate(t, 0, row_state_);
      else
        std::copy(integrator.state().begin(), integrator.state().end(), row_state_.begin());
      const Observation& seen = problem_.observe(std::min(t, limit_), row_state_);
      measurements_.sample(t, seen.command.tip);
      if (recording_)
        recording_->output(seen, problem_.controller().options().rows, problem_.controller().terms(seen.qd));
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

  /// The results of all claims and measurements.
  void collect() {
    auto reasons = reasons_against(problem_, filtered_);
    if (trajectory_)
      for (const Claim claim : {Claim::analytic_response, Claim::decoupling})
        reasons[index(claim)] =
            result_.error.known ? trajectory_->reason(claim) : "no shadow run: verify.shadow is false";
    reasons[index(Claim::force_response)] =
        force_.reason().empty() ? "the tip was never in contact" : force_.reason();
    if (arms_.plant.dense) reasons[index(Claim::forward_dynamics)] = "the plant is the definition itself";
    result_.claims = verdict_.results(reasons);
    result_.claims[index(Claim::frequency_response)] = measurements_.frequency_result(result_.error);
    result_.claims[index(Claim::poles)] = measurements_.poles_result();
    if (trajectory_) {
      result_.claims[index(Claim::energy)] = trajectory_->energy_result();
      result_.analytic = result_.claims[index(Claim::analytic_response)].checked_steps > 0 ||
                         trajectory_->reason(Claim::analytic_response).empty();
      result_.worst_position = trajectory_->worst_position();
      result_.worst_orientation = trajectory_->worst_orientation();
    }
    result_.measured = measurements_.finish();
  }

  const Experiment& experiment_;
  const RunOptions& options_;
  Arms arms_;
  const ClosedLoop blank_;                   // as it was made
  ClosedLoop problem_;                       // for rows and checks; the integrators have their own copies
  std::optional<Simulation> main_, shadow_;  // shadow_: none without verify.shadow
  Measurements measurements_;
  StepCheck step_check_;
  ForceTracking force_;
  RunResult result_;
  std::optional<Recording> recording_;
  std::optional<TrajectoryClaims> trajectory_;
  std::optional<DelayedLaw> delayed_law_;  // the definition that a law with delay is judged by
  Verdict verdict_;
  Residuals residuals_{};
  Vector6 missed_ = Vector6::Zero();  // tip acceleration - u at the last checked step
  bool worse_ = false, filtered_ = false;
  int signal_ = 0;  // that interrupted the run
  double limit_ = std::numeric_limits<double>::infinity();
  StepInfo last_step_;
  std::vector<double> row_state_, last_state_;
  long next_row_ = 0, stops_ = 0;
  Clock::time_point begun_ = Clock::now(), shown_ = Clock::now();
};

}  // namespace

IntegratorOptions integrator_options(const IntegratorConfig& config, const ClosedLoop& loop, double tighter) {
  IntegratorOptions options;
  options.method = config.method;
  options.jacobian = config.jacobian;
  options.rtol = std::max(config.rtol / tighter, std::min(config.rtol, smallest_rtol));
  options.max_step = config.max_step > 0 ? config.max_step : default_max_step;
  options.atol.assign(static_cast<std::size_t>(loop.positions()), config.atol_position / tighter);
  options.atol.insert(options.atol.end(), static_cast<std::size_t>(loop.velocities()),
                      config.atol_velocity / tighter);
  // The shadow's energies are held tighter than its motion: where an event ends a step the run's balance may
  // be off by little, by chance, and the shadow's must be off by less.
  options.atol.insert(options.atol.end(), 3, energy_atol * config.atol_velocity / (tighter * tighter));
  return options;
}

void check(const Experiment& experiment) {
  const RunOptions nothing;
  const Runner ready(experiment, nothing);
}

RunResult run(const Experiment& experiment, const RunOptions& options) {
  return Runner(experiment, options).go();
}

}  // namespace osculate
