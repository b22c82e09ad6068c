// Laws and plants beyond tracking in free space, through the closed loop that `run` integrates.
#include <cmath>
#include <numbers>

#include "experiment/config.hpp"
#include "experiment/make_loop.hpp"
#include "experiment/stops.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::situations_tests {

namespace {

const std::filesystem::path experiments = std::filesystem::path(OSCULATE_SOURCE_DIR) / "experiments";

struct Built {
  Experiment experiment;
  Arms arms;
  ClosedLoop loop;
  std::vector<double> y;
};

/// The loop of a shipped experiment with overrides, at its start but moving.
Built build(const std::string& name, const std::vector<std::string>& overrides = {}) {
  Experiment experiment = read_experiment(experiments / (name + ".yaml"), overrides);
  Arms arms = make_arms(experiment);
  ClosedLoop loop = make_loop(experiment, arms);
  std::vector<double> y = initial_state(experiment, loop);
  for (int i = 0; i < loop.velocities(); ++i)
    y[static_cast<std::size_t>(loop.positions() + i)] = 0.2 * (i % 3) - 0.1;
  loop.switch_modes(0, y);
  return {std::move(experiment), std::move(arms), std::move(loop), std::move(y)};
}

}  // namespace

TEST_CASE("a plant by the definitions moves as the recursion does") {
  Built recursive = build("puma560_circle"), dense = build("puma560_circle", {"plant.dynamics=dense"});
  const Observation a = recursive.loop.observe(0.3, recursive.y), b = dense.loop.observe(0.3, dense.y);
  // M of this arm has a condition below 1e3; its accelerations are of order 10.
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(a.qdd[i] - b.qdd[i]) < 1e3 * 64 * eps * 10);
  CHECK((a.tip_acceleration - b.tip_acceleration).cwiseAbs().maxCoeff() < 1e3 * 64 * eps * 10);
  CHECK(a.kinetic == Approx(b.kinetic).epsilon(64 * eps));
  CHECK(a.potential == Approx(b.potential).epsilon(64 * eps));
  CHECK(a.kinetic > 0);
}

TEST_CASE("impedance: inertia e.. + D e. + K e is minus the wrench on the tip") {
  const std::vector<std::string> settings{
      "plant.tip_force=[1, -2, 0.5, 20, -10, 5]", "controller.compensate_tip_force=true",
      "controller.impedance={inertia: [0.5, 0.6, 0.7, 8, 9, 10]}",
      "controller.gains={stiffness: [20, 20, 20, 500, 600, 700], damping: [5, 5, 5, 90, 90, 90]}"};
  Built built = build("puma560_circle", settings);
  const Observation& seen = built.loop.observe(0.3, built.y);
  const ControllerConfig& c = built.experiment.controller;
  const auto& [e, ed] = seen.command.error;
  for (int row = 3; row < 6; ++row) {
    const double m = (*c.virtual_inertia)[row];
    const double edd = seen.command.reference.acceleration[row] - seen.tip_acceleration[row];
    const double left = m * edd + c.damping[row] * ed[row] + c.stiffness[row] * e[row];
    // The tip acceleration is exact to eps times the condition of Omega (below 1e4 here) and the forces.
    CHECK(std::abs(left + built.arms.plant.tip_force[row]) < 1e4 * 64 * eps * 100);
  }
  CHECK(built.loop.plant_is_model());
}

TEST_CASE("a controlled force accelerates the tip as a mass does") {
  Built built = build("puma560_force");
  for (const double height : {0.0, 0.03}) {  // free, then inside the table
    Built at =
        build("puma560_force", {"plant.environment.point=[0, 0, " + std::to_string(0.73 + height) + "]"});
    const Observation& seen = at.loop.observe(0, at.y);
    const ForceControl& force = *at.experiment.controller.force;
    const double expected =
        (force.desired[0] + seen.tip_force[5]) / force.inertia - force.damping * seen.command.tip_velocity[5];
    CHECK(at.loop.modes().contact == (height > 0));
    CHECK((seen.tip_force[5] > 0) == (height > 0));
    CHECK(std::abs(seen.tip_acceleration[5] - expected) < 1e4 * 64 * eps * 100);
  }
}

TEST_CASE("sensors round positions and filter their differences") {
  Built built = build("puma560_sampled", {"controller.sensors={resolution: 0.001, velocity_cutoff: 40}",
                                          "controller.sampling.period=0.002"});
  Controller& controller = built.loop.controller();
  built.loop.sample(0, built.y);
  std::vector<double> first(controller.known_q().begin(), controller.known_q().end());
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(first[i] - built.y[i]) <= 0.0005 * (1 + 8 * eps));
    CHECK(std::abs(first[i] / 0.001 - std::round(first[i] / 0.001)) < 1e4 * eps);
    CHECK(controller.known_qd()[i] == built.y[6 + i]);  // the filter starts at the true velocity
  }
  for (std::size_t i = 0; i < 6; ++i) built.y[i] += 0.0037;
  built.loop.sample(0.002, built.y);
  const double keep = std::exp(-2 * std::numbers::pi * 40 * 0.002);
  for (std::size_t i = 0; i < 6; ++i) {
    const double difference = (controller.known_q()[i] - first[i]) / 0.002;
    CHECK(controller.known_qd()[i] ==
          Approx(keep * built.y[6 + i] + (1 - keep) * difference).epsilon(16 * eps));
  }
}

TEST_CASE("torque limits cut what the joints get, and say so") {
  Built free = build("puma560_circle"),
        limited = build("puma560_circle", {"controller.effort_limit=[500, 20, 500, 500, 500, 500]"});
  const Observation a = free.loop.observe(0.3, free.y), b = limited.loop.observe(0.3, limited.y);
  REQUIRE(std::abs(a.torque[1]) > 20);
  CHECK(std::abs(b.torque[1]) == 20);
  CHECK(b.torque[0] == a.torque[0]);
  CHECK(b.command.saturated);
  CHECK(!a.command.saturated);
}

TEST_CASE("the torque of a sampled law acts when it is applied, not before") {
  Built built = build("puma560_sampled");
  built.loop.sample(0, built.y);
  built.loop.apply();
  const std::vector<double> held = built.loop.observe(0, built.y).torque;
  for (double& x : built.y) x += 0.01;
  built.loop.sample(0.004, built.y);
  CHECK(built.loop.observe(0.004, built.y).torque == held);
  built.loop.apply();
  CHECK(built.loop.observe(0.004, built.y).torque != held);
}

TEST_CASE("stops: samples and the times at which their torques act, in order, then the duration") {
  const Built built = build("puma560_sampled",
                            {"controller.sampling={period: 0.01, computation_time: 0.004}", "duration=0.03"});
  Stops stops(built.experiment, built.loop.controller());
  std::vector<double> times;
  std::vector<Stop::Kind> kinds;
  while (const auto stop = stops.next()) {
    times.push_back(stop->time);
    kinds.push_back(stop->kind);
  }
  using Kind = Stop::Kind;
  CHECK(times == std::vector<double>{0.01, 0.01 + 0.004, 0.02, 0.02 + 0.004, 0.03});
  CHECK(kinds == std::vector<Kind>{Kind::sample, Kind::apply, Kind::sample, Kind::apply, Kind::end});
}

TEST_CASE("every law by name reaches or misses u as its omission says") {
  for (const TextbookLawInfo& info : textbook_laws()) {
    Built built = build("puma560_circle", {"controller.law=" + std::string(info.name)});
    const Observation& seen = built.loop.observe(0.3, built.y);
    const double missed = (seen.tip_acceleration - seen.command.u).cwiseAbs().maxCoeff();
    CAPTURE(info.name, missed);
    const bool exact = info.law == TextbookLaw::dense || info.law == TextbookLaw::pseudo_inverse ||
                       info.law == TextbookLaw::kinematic_null_space;
    if (exact)
      CHECK(missed < 1e4 * 64 * eps * 100);
    else
      CHECK(missed > 1e-4);
  }
}

TEST_CASE("a loop watches what its situation asks for") {
  CHECK(build("puma560_circle").loop.event_count() == 1);  // the singularity
  CHECK(build("puma560_force").loop.event_count() == 3);   // gap, pressure, singularity
  CHECK(build("puma560_circle", {"controller.singularity.policy=truncated"}).loop.event_count() == 6);
  CHECK(build("puma560_circle", {"controller.singularity.policy=damped"}).loop.event_count() == 0);
  CHECK(build("puma560_free_swing").loop.event_count() == 0);
  CHECK(build("puma560_sampled").loop.event_count() == 0);
}

TEST_CASE("without a policy a singular arm is refused with the row that it loses") {
  Built built = build("puma560_circle");
  built.y[4] = 0;  // wrist axes in line
  std::string message;
  try {
    built.loop.switch_modes(0, built.y);
  } catch (const IntegrationStopped& stopped) {
    message = stopped.what();
    CHECK(stopped.reason == IntegrationStopped::Reason::singular);
  }
  CHECK(message.find("task row w") != std::string::npos);
  CHECK(message.find("policy") != std::string::npos);
  Built sampled = build("puma560_sampled");
  sampled.y[4] = 1e-4;  // not yet singular to rounding, but below the threshold
  CHECK_THROWS_AS(sampled.loop.sample(0, sampled.y), IntegrationStopped);
  Built damped = build("puma560_circle", {"controller.singularity={policy: damped, threshold: 0.01}"});
  damped.y[4] = 0;
  CHECK(damped.loop.observe(0, damped.y).command.filtered);
}

}  // namespace osculate::testing::situations_tests
