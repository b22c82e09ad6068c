// Whole runs against what theory says: order of convergence, energy, step counts, stops, expectations.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "experiment/arms.hpp"
#include "experiment/run.hpp"
#include "support/catch.hpp"

namespace osculate::testing::runs_tests {

namespace {

const std::filesystem::path experiments = std::filesystem::path(OSCULATE_SOURCE_DIR) / "experiments";

Experiment circle(const std::vector<std::string>& overrides) {
  return read_experiment(experiments / "puma560_circle.yaml", overrides);
}

/// Slope of log y over log x, and the largest deviation from the line in decades.
std::pair<double, double> fitted_slope(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log10(x[i]), b = std::log10(y[i]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), offset = (sy - slope * sx) / n;
  double scatter = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    scatter = std::max(scatter, std::abs(std::log10(y[i]) - offset - slope * std::log10(x[i])));
  return {slope, scatter};
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", x);
  return text;
}

}  // namespace

TEST_CASE("the closed loop converges to the exact linear solution with its tolerance") {
  std::vector<double> tolerances, errors;
  for (const double rtol : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11}) {
    const RunResult r = run(circle({"duration=3", "integrator.rtol=" + number(rtol),
                                    "integrator.atol=" + number(rtol / 100), "verify.shadow=false"}),
                            {});
    REQUIRE(r.analytic);
    tolerances.push_back(rtol);
    errors.push_back(r.worst_position);
    WARN("rtol " << rtol << ": tip error " << r.worst_position << " m, " << r.worst_orientation << " rad, "
                 << r.steps << " steps");
  }
  const auto [slope, scatter] = fitted_slope(tolerances, errors);
  WARN("fitted slope " << slope << ", scatter " << scatter << " decades");
  CHECK(slope > 0.7);
  CHECK(slope < 1.3);
}

TEST_CASE("with fixed steps of the classical fourth-order method the closed loop converges with order four") {
  // No friction: its steps in tanh would need very small steps before the order shows.
  const Experiment e =
      circle({"model.friction.viscous=[0,0,0,0,0,0]", "model.friction.coulomb_positive=[0,0,0,0,0,0]",
              "model.friction.coulomb_negative=[0,0,0,0,0,0]"});
  const Arms arms = make_arms(e);
  const Pose initial = tip_pose(arms.model, e.q);
  ClosedLoop loop(Controller(arms.model, arms.friction, LawOptions{},
                             make_path(std::get<CircleOptions>(e.reference)), initial),
                  arms.plant);
  std::vector<double> start(loop.states(), 0.0);
  std::copy(e.q.begin(), e.q.end(), start.begin());
  const PoseError e0 = loop.observe(0, start).command.error;
  std::vector<double> sizes, errors;
  for (const int steps : {50, 100, 200, 400}) {
    const double h = 1.0 / steps;
    std::vector<double> y = start, k1(y.size()), k2 = k1, k3 = k1, k4 = k1, at = k1;
    for (int i = 0; i < steps; ++i) {
      const double t = i * h;
      const auto stage = [&](const std::vector<double>& k, double by) {
        for (std::size_t j = 0; j < y.size(); ++j) at[j] = y[j] + by * k[j];
      };
      loop.right_side(t, y.data(), k1.data());
      stage(k1, h / 2);
      loop.right_side(t + h / 2, at.data(), k2.data());
      stage(k2, h / 2);
      loop.right_side(t + h / 2, at.data(), k3.data());
      stage(k3, h);
      loop.right_side(t + h, at.data(), k4.data());
      for (std::size_t j = 0; j < y.size(); ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    const Vector6 seen = loop.observe(1, y).command.error.e;
    double worst = 0;
    for (int i = 0; i < 6; ++i)
      worst = std::max(worst, std::abs(seen[i] - linear_response(100, 20, {e0.e[i], e0.ed[i]}, 1).e));
    sizes.push_back(h);
    errors.push_back(worst);
  }
  const auto [slope, scatter] = fitted_slope(sizes, errors);
  WARN("order " << slope << ", scatter " << scatter << " decades");
  CHECK(slope > 3.8);
  CHECK(slope < 4.3);
}

TEST_CASE("a free swing keeps its energy to its tolerance") {
  for (const double rtol : {1e-6, 1e-8, 1e-10}) {
    const RunResult r =
        run(circle({"controller.law=free", "duration=2", "integrator.rtol=" + number(rtol),
                    "integrator.atol=" + number(rtol / 100), "model.friction.viscous=[0,0,0,0,0,0]",
                    "model.friction.coulomb_positive=[0,0,0,0,0,0]",
                    "model.friction.coulomb_negative=[0,0,0,0,0,0]", "reference={type: hold}"}),
            {});
    CHECK(r.exit == Exit::ok);
    const ClaimResult& energy = r.claims[index(Claim::energy)];
    INFO("rtol " << rtol << ": imbalance " << energy.worst.value << " of the energy moved, " << r.steps
                 << " steps");
    CHECK(energy.outcome == Outcome::pass);
    // Each step leaves at most about rtol of the energy it touches.
    CHECK(energy.worst.value < static_cast<double>(r.steps) * rtol);
    CHECK(r.claims[index(Claim::linearization)].outcome == Outcome::not_applicable);
  }
}

TEST_CASE("the demo keeps its promises") {
  const RunResult r = run(circle({}), {});
  CHECK(r.exit == Exit::ok);
  CHECK(r.verdict == "pass");
  CHECK(r.worst_position < 1e-8);
  CHECK(r.worst_orientation < 1e-8);
  CHECK(r.claims[index(Claim::energy)].worst.value < 1e-8);
  CHECK(r.steps > 500);
  CHECK(r.steps < 9000);
  for (std::size_t i = 0; i < claim_count; ++i) {
    INFO(claim_table[i].id);
    CHECK(r.claims[i].undecided_steps == 0);
    // No null-space torque, coordinates of its own, sines or surface in the demo.
    const Claim absent[] = {Claim::null_space, Claim::coordinates, Claim::frequency_response, Claim::poles,
                            Claim::force_response};
    const bool missing =
        std::find(std::begin(absent), std::end(absent), static_cast<Claim>(i)) != std::end(absent);
    if (!missing) CHECK(r.claims[i].outcome == Outcome::pass);
  }
  // The estimate is right within a factor of five, and the error is far above the rounding of the kinematics.
  CHECK(r.error.position < 5 * r.worst_position);
  CHECK(r.worst_position < 5 * r.error.position);
}

TEST_CASE("expectations decide the exit") {
  const RunResult surprise = run(circle({"duration=0.05", "expect.fails=[omega]"}), {});
  CHECK(surprise.exit == Exit::claim_failed);
  CHECK(surprise.message == "claim omega was expected to fail and did not");
  const RunResult no_stop = run(circle({"duration=0.05", "expect.stop=singular"}), {});
  CHECK(no_stop.exit == Exit::claim_failed);
  // The outstretched arm at rest is singular from the start.
  const std::string stretched = "initial.q=[0, 0, -1.5707963267948966, 0, 0, 0]";
  const RunResult stopped = run(circle({stretched}), {});
  CHECK(stopped.exit == Exit::stopped);
  CHECK(stopped.status == "failed");
  CHECK(stopped.message.find("singular at t = 0") != std::string::npos);
  const RunResult expected = run(circle({stretched, "expect.stop=singular"}), {});
  CHECK(expected.exit == Exit::ok);
  CHECK(expected.verdict == "as_expected");
  const RunResult many = run(circle({"integrator.max_steps=20"}), {});
  CHECK(many.exit == Exit::stopped);
  CHECK(many.message.find("max_steps") != std::string::npos);
}

TEST_CASE("a wrong model is not a broken theory") {
  const RunResult r = run(circle({"duration=0.5", "plant.payload={mass: 1.0, com: [0, 0, 0.05]}"}), {});
  CHECK(r.exit == Exit::ok);
  CHECK(r.claims[index(Claim::linearization)].outcome == Outcome::not_applicable);
  CHECK(r.claims[index(Claim::linearization)].reason == "plant and model differ on purpose");
  CHECK(r.claims[index(Claim::forward_dynamics)].outcome == Outcome::pass);
  CHECK(r.claims[index(Claim::energy)].outcome == Outcome::pass);
}

TEST_CASE("a jump of the reference restarts the integrator and the closed form") {
  for (const char* reference :
       {"reference={type: step, offset: [0.1, 0, 0, 0, 0.02, 0.01], at: 0.4}",
        "reference={type: line, offset: [0, 0.2, 0, 0.03, 0, 0], start: 0.2, duration: 0.5}"}) {
    INFO(reference);
    const RunResult r = run(circle({"duration=1", "initial.q=[0, -0.8, 0.4, 0, 0.9, 0]", reference}), {});
    CHECK(r.exit == Exit::ok);
    CHECK(r.claims[index(Claim::analytic_response)].outcome == Outcome::pass);
    CHECK(r.worst_position < 1e-8);
  }
}

TEST_CASE("the stiff method agrees with the closed form too") {
  const RunResult r = run(
      circle({"duration=0.5", "integrator.method=bdf", "integrator.rtol=1e-8", "integrator.atol=1e-10"}), {});
  CHECK(r.exit == Exit::ok);
  CHECK(r.worst_position < 1e-6);
}

}  // namespace osculate::testing::runs_tests
