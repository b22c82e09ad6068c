// Sampled laws, delayed forms and joints with quaternions along simulated time.
#include <cmath>

#include "experiment/arms.hpp"
#include "experiment/run.hpp"
#include "simulation/integrator.hpp"
#include "support/catch.hpp"

namespace osculate::testing::sampled_tests {

namespace {

const std::filesystem::path experiments = std::filesystem::path(OSCULATE_SOURCE_DIR) / "experiments";

IntegratorOptions tolerances(std::size_t states, double rtol) {
  IntegratorOptions options;
  options.method = Method::runge_kutta;
  options.rtol = rtol;
  options.atol.assign(states, rtol / 100);
  return options;
}

/// Largest |beta_dot - u| at the samples of 0.4 s (rad/s^2 or m/s^2), read just after each sample; the first
/// three fill the memory.
double sample_error(const Experiment& e, double period, Delay delay, bool extrapolate) {
  const Arms arms = make_arms(e);
  LawOptions law;
  law.sampling = Sampling{period, delay, extrapolate};
  law.know_tip_force = true;
  const Pose initial = tip_pose(arms.model, e.q);
  ClosedLoop loop(
      Controller(arms.model, arms.friction, law, make_path(std::get<LissajousOptions>(e.reference)), initial),
      arms.plant);
  std::vector<double> y(loop.states(), 0.0);
  std::copy(e.q.begin(), e.q.end(), y.begin());
  Integrator integrator([&loop](double t, const double* x, double* xd) { loop.right_side(t, x, xd); }, 0, y,
                        tolerances(y.size(), 1e-9));
  double worst = 0;
  const int samples = static_cast<int>(std::lround(0.4 / period));
  for (int k = 0; k <= samples; ++k) {
    const double t = k * period;
    while (integrator.t() < t) integrator.step(t);
    loop.sample(t, integrator.state());
    loop.apply();
    if (k > 0) integrator.restart();
    const Observation& seen = loop.observe(t, integrator.state());
    if (k >= 3) worst = std::max(worst, (seen.tip_acceleration - seen.command.u).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "a delay costs the first order of the period, with extrapolation the second; without one (5) is exact") {
  const Experiment e = read_experiment(experiments / "puma560_two_sweeps.yaml");
  const double exact = sample_error(e, 0.004, Delay::none, false);
  WARN("no delay: " << exact);
  CHECK(exact < 1e-9);
  for (const Delay delay : {Delay::velocity, Delay::force, Delay::both})
    for (const bool extrapolate : {false, true}) {
      const double coarse = sample_error(e, 0.002, delay, extrapolate);
      const double fine = sample_error(e, 0.0005, delay, extrapolate);
      const double slope = std::log(coarse / fine) / std::log(4.0);
      WARN("delay " << static_cast<int>(delay) << (extrapolate ? " extrapolated: " : ": ") << coarse
                    << " at 2 ms, " << fine << " at 0.5 ms, slope " << slope);
      CHECK(fine > 1e3 * exact);
      CHECK(slope > (extrapolate ? 1.8 : 0.9));
      CHECK(slope < (extrapolate ? 2.2 : 1.1));
    }
}

TEST_CASE("a sampled run says how many sweeps each sample took, and judges the law at its samples") {
  const auto swept = [](const char* name) {
    return run(read_experiment(experiments / name, {"duration=0.02"}), {});
  };
  for (const auto& [name, sweeps] : {std::pair{"puma560_sampled.yaml", 4L},
                                     {"puma560_old_velocities.yaml", 3L},
                                     {"puma560_old_force.yaml", 3L},
                                     {"puma560_two_sweeps.yaml", 2L},
                                     {"puma560_hybrid.yaml", 4L}}) {
    const RunResult r = swept(name);
    INFO(name);
    CHECK(r.exit == Exit::ok);
    CHECK(r.samples == 5);
    CHECK(r.sweeps_per_sample == sweeps);
    CHECK(r.claims[index(Claim::torque)].checked_steps == 5);
  }
}

TEST_CASE("a law with delay and a known wrench on the tip is judged against its definition too") {
  const RunResult r = run(read_experiment(experiments / "puma560_two_sweeps.yaml", {"duration=0.04"}), {});
  CHECK(r.exit == Exit::ok);
  CHECK(r.claims[index(Claim::torque)].outcome == Outcome::pass);
}

TEST_CASE("resolved acceleration and operational space control move the tip alike") {
  const auto tip_error = [](const char* law) {
    const RunResult r = run(read_experiment(experiments / "puma560_resolved_acceleration.yaml",
                                            {"duration=1", std::string("controller.law=") + law}),
                            {});
    CHECK(r.exit == Exit::ok);
    return r.worst_position;
  };
  CHECK(tip_error("resolved_acceleration") < 1e-9);
  CHECK(tip_error("operational_space") < 1e-9);
}

TEST_CASE("the quaternion of a tumbling body keeps its length, and returns to it when disturbed") {
  const Experiment e = read_experiment(experiments / "satellite_arm_tumble.yaml");
  const Arms arms = make_arms(e);
  LawOptions law;
  law.law = Law::free;
  const auto length_after = [&](double duration, double stretched, double rtol) {
    ClosedLoop loop(Controller(arms.model, {}, law, make_path(HoldOptions{}), tip_pose(arms.model, e.q)),
                    arms.plant);
    std::vector<double> y(loop.states(), 0.0);
    std::copy(e.q.begin(), e.q.end(), y.begin());
    std::copy(e.qd.begin(), e.qd.end(), y.begin() + static_cast<std::ptrdiff_t>(e.q.size()));
    for (int i = 0; i < 4; ++i) y[static_cast<std::size_t>(i)] *= stretched;
    Integrator integrator([&loop](double t, const double* x, double* xd) { loop.right_side(t, x, xd); }, 0, y,
                          tolerances(y.size(), rtol));
    while (integrator.t() < duration) integrator.step(duration);
    const auto state = integrator.state();
    return std::sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2] + state[3] * state[3]);
  };
  const double rtol = 1e-6;
  const double soon = std::abs(length_after(10, 1, rtol) - 1),
               late = std::abs(length_after(200, 1, rtol) - 1);
  WARN("length off by " << soon << " after 10 s, " << late << " after 200 s");
  // Each step may miss the length by its tolerance; 10 / s of restoring leaves some tens of steps' worth.
  CHECK(soon < 100 * rtol);
  CHECK(late < 100 * rtol);
  CHECK(std::abs(length_after(2, 1.1, rtol) - 1) < 100 * rtol);
  CHECK(std::abs(length_after(0.05, 1.1, rtol) - 1) > 0.01);  // the restoring takes its time
}

TEST_CASE("a moving base and a singular representation are met as promised") {
  CHECK(run(read_experiment(experiments / "arm7_moving_base.yaml", {"duration=0.5"}), {}).exit == Exit::ok);
  const RunResult r = run(read_experiment(experiments / "puma560_gimbal_lock.yaml"), {});
  CHECK(r.verdict == "as_expected");
  CHECK(r.message.find("roll_pitch_yaw") != std::string::npos);
  CHECK(r.message.find("pitch") != std::string::npos);
}

}  // namespace osculate::testing::sampled_tests
