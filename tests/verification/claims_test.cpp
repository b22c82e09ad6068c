// Each claim holds at ordinary states and fails when its input is off by ten times its bound.
#include <functional>

#include "support/catch.hpp"
#include "verification/bounds.hpp"
#include "verification/bounds_sample.hpp"
#include "verification/trajectory.hpp"

namespace osculate::testing::claims_tests {

namespace {

using Disturb = std::function<void(Evidence&, double)>;

/// How each claim's input from the recursions is pushed, with an arbitrary unit.
const std::vector<std::pair<Claim, Disturb>> disturbances{
    {Claim::omega, [](Evidence& e, double by) { e.recursive.Omega(1, 1) += by; }},
    {Claim::lambda, [](Evidence& e, double by) { e.recursive.Lambda(2, 2) += by; }},
    {Claim::c, [](Evidence& e, double by) { e.recursive.c[0] += by; }},
    {Claim::g, [](Evidence& e, double by) { e.recursive.g[4] += by; }},
    {Claim::c_plus_g, [](Evidence& e, double by) { e.recursive.c_plus_g[5] += by; }},
    {Claim::torque, [](Evidence& e, double by) { e.T[1] += by; }},
    {Claim::forward_dynamics, [](Evidence& e, double by) { e.qdd[3] += by; }},
    {Claim::linearization, [](Evidence& e, double by) { e.tip_acceleration[4] += by; }},
    {Claim::kinematics, [](Evidence& e, double by) { e.tip_velocity[3] += by; }},
    {Claim::null_space, [](Evidence& e, double by) { e.T[0] += by; }},
    {Claim::coordinates, [](Evidence& e, double by) { e.chart->ydd[0] += by; }},
};

/// A state where every claim applies: redundant, with null-space damping, in coordinates, well conditioned.
Evidence ordinary_state(std::uint64_t from) {
  for (std::uint64_t seed = from;; ++seed) {
    try {
      Evidence e = sample_state(seed);
      if (e.chart && e.qd.size() > 6 && e.T0.cwiseAbs().maxCoeff() > 0 &&
          scaled_condition(e.task.Omega) < 1e4)
        return e;
    } catch (const IntegrationStopped&) {}
  }
}

}  // namespace

TEST_CASE("every step claim passes at ordinary states and fails ten bounds away") {
  for (const std::uint64_t from : {1u, 500u, 900u}) {
    const Evidence fine = ordinary_state(from);
    const Residuals before = assess(fine);
    for (const auto& [claim, disturb] : disturbances) {
      INFO(claim_table[index(claim)].id);
      const Residual& r = before[index(claim)];
      REQUIRE(r.applies);
      REQUIRE(r.bound < undecided_bound);
      CHECK(r.value <= r.bound);

      // The residual grows in proportion to a large disturbance: scale it to ten bounds.
      Evidence far = fine;
      disturb(far, 1e3);
      const double per_unit = assess(far)[index(claim)].value / 1e3;
      REQUIRE(per_unit > 0);
      Evidence off = fine;
      disturb(off, 10 * r.bound / per_unit);
      const Residual after = assess(off)[index(claim)];
      CHECK(after.value > after.bound);
      CHECK(after.value < 12 * after.bound);
    }
  }
}

TEST_CASE("a claim about a quantity that must vanish demands exact zeros where its scale is zero") {
  Evidence still = ordinary_state(1);
  still.recursive.c.setZero();
  still.terms.c.setZero();
  still.task.J_Minv_C.setZero();
  still.task.Jdot_qd.setZero();
  CHECK(assess(still)[index(Claim::c)].value == 0);
  still.recursive.c[2] = 1e-300;
  CHECK(std::isinf(assess(still)[index(Claim::c)].value));
}

TEST_CASE("the table of bounds is neither exceeded nor slack") {
  std::array<double, measured_bounds.size()> worst{};
  const auto look = [&worst](std::uint64_t seed) {
    Residuals residuals;
    try {
      residuals = assess(sample_state(seed));
    } catch (const IntegrationStopped&) { return; }
    for (std::size_t i = 0; i < worst.size(); ++i) {
      if (!residuals[i].applies || residuals[i].bound > undecided_bound) continue;
      INFO("seed " << seed << ", claim " << measured_bounds[i].claim);
      CHECK(residuals[i].value <= residuals[i].bound);
      worst[i] = std::max(worst[i], residuals[i].value / (residuals[i].bound / measured_bounds[i].constant));
    }
  };
  // States that the study did not see, and those where it saw the worst.
  for (std::uint64_t seed = 10'000'001; seed <= 10'004'000; ++seed) look(seed);
  for (const auto& row : measured_bounds) look(row.seed);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    INFO(measured_bounds[i].claim << ": constant " << measured_bounds[i].constant << ", worst seen here "
                                  << worst[i]);
    CHECK(measured_bounds[i].constant <= 5 * worst[i]);
    CHECK(std::string(measured_bounds[i].claim) == claim_table[i].id);
  }
}

namespace {

/// A closed loop of a random arm on a circle, with its observation at the start and a little later.
struct Moving {
  ClosedLoop loop;
  Observation start;
  GlobalError error;
};

Moving moving_arm() {
  const RandomArm arm = random_arm(4, 7);
  const Pose pose = tip_pose(arm.chain, {arm.q.data(), 7});
  LawOptions options;
  ClosedLoop loop(Controller(arm.chain, {}, options, make_path(CircleOptions{}), pose),
                  Plant{arm.chain, {}, Vector6::Zero()});
  std::vector<double> y(loop.states(), 0.0);
  for (std::size_t i = 0; i < 7; ++i) y[i] = arm.q[static_cast<Eigen::Index>(i)];
  const Observation start = loop.observe(0, y);
  GlobalError error;
  error.known = true;
  error.position = 1e-9;
  error.orientation = 1e-9;
  error.imbalance = 1e-8;
  return {std::move(loop), start, error};
}

}  // namespace

TEST_CASE("every trajectory claim passes at the exact solution and fails ten bounds away") {
  Moving m = moving_arm();
  TrajectoryClaims claims(m.loop, m.start);

  // The exact solution at t = 0 is the start itself.
  const Residuals fine = claims.assess(m.start, m.error);
  for (const Claim claim : {Claim::analytic_response, Claim::decoupling}) {
    const Residual& r = fine[index(claim)];
    REQUIRE(r.applies);
    CHECK(r.value <= r.bound);
  }
  const double bound = error_multiple * m.error.position;
  Observation off = m.start;
  off.command.error.e[4] += 10 * bound;  // along the circle's plane: commanded
  const Residuals response = claims.assess(off, m.error);
  CHECK(response[index(Claim::analytic_response)].value > response[index(Claim::analytic_response)].bound);
  CHECK(response[index(Claim::decoupling)].value <= response[index(Claim::decoupling)].bound);
  off = m.start;
  off.command.error.e[3] += 10 * bound;  // x: not commanded by a circle in y-z
  const Residuals coupled = claims.assess(off, m.error);
  CHECK(coupled[index(Claim::decoupling)].value > coupled[index(Claim::decoupling)].bound);
  off = m.start;
  off.command.error.e[1] += 10 * error_multiple * m.error.orientation;
  CHECK(claims.assess(off, m.error)[index(Claim::decoupling)].value >
        coupled[index(Claim::decoupling)].bound);

  // Energy: 5 J of work became 5 J of motion; then 10 bounds are missing.
  TrajectoryClaims balanced(m.loop, m.start), cheated(m.loop, m.start);
  Observation later = m.start;
  later.t = 1;
  later.work = 5;
  later.kinetic += 5;
  const Residual good = balanced.assess(later, m.error)[index(Claim::energy)];
  CHECK(good.value <= good.bound);
  CHECK(balanced.energy_result().outcome == Outcome::pass);
  later.kinetic += 10 * error_multiple * m.error.imbalance;
  const Residual bad = cheated.assess(later, m.error)[index(Claim::energy)];
  CHECK(bad.value > bad.bound);
  CHECK(cheated.energy_result().outcome == Outcome::fail);
}

TEST_CASE("claims that do not apply say why") {
  const RandomArm arm = random_arm(4, 7);
  const Pose pose = tip_pose(arm.chain, {arm.q.data(), 7});
  const auto reason = [&](LawOptions options, Plant plant, Claim claim) {
    ClosedLoop loop(Controller(arm.chain, {}, options, make_path(CircleOptions{}), pose), std::move(plant));
    std::vector<double> y(loop.states(), 0.0);
    for (std::size_t i = 0; i < 7; ++i) y[i] = arm.q[static_cast<Eigen::Index>(i)];
    return TrajectoryClaims(loop, loop.observe(0, y)).reason(claim);
  };
  const Plant same{arm.chain, {}, Vector6::Zero()};
  CHECK(reason({}, same, Claim::analytic_response) == "");
  Plant heavier = same;
  heavier.chain.links[6].mass += 1;
  CHECK(reason({}, heavier, Claim::analytic_response) == "plant and model differ on purpose");
  CHECK(reason({}, heavier, Claim::energy) == "");
  LawOptions free;
  free.law = Law::free;
  CHECK(reason(free, same, Claim::decoupling) == "no tip command in a free swing");
  LawOptions part;
  part.rows = {0, 3, 4, 5};
  CHECK(reason(part, same, Claim::analytic_response).find("do not decouple") != std::string::npos);
}

TEST_CASE("the verdict: worst step, undecided steps, failures and not-a-number") {
  Residuals none;
  none.fill({0, 0, false});
  const auto with = [&none](Residual r) {
    Residuals out = none;
    out[index(Claim::omega)] = r;
    return out;
  };
  Verdict fine;
  fine.add(0.1, with({1e-15, 1e-14, true}));
  fine.add(0.2, with({5e-15, 1e-14, true}));
  fine.add(0.3, with({6e-15, 1e-13, true}));
  const ClaimResult best = fine.results()[index(Claim::omega)];
  CHECK(best.outcome == Outcome::pass);
  CHECK(best.at_time == 0.2);
  CHECK(best.worst.value == 5e-15);
  CHECK(fine.results()[index(Claim::c)].outcome == Outcome::not_applicable);

  Verdict above;
  above.add(0.1, with({2e-14, 1e-14, true}));
  for (int i = 0; i < 1000; ++i) above.add(1, with({0, 1e-14, true}));
  CHECK(above.results()[index(Claim::omega)].outcome == Outcome::fail);
  CHECK(above.results()[index(Claim::omega)].at_time == 0.1);

  Verdict broken;
  broken.add(0.1, with({std::nan(""), 1e-14, true}));
  CHECK(broken.results()[index(Claim::omega)].outcome == Outcome::fail);

  const auto undecided = [&](int of_1000) {
    Verdict v;
    for (int i = 0; i < 1000; ++i) v.add(i, with({1e-15, i < of_1000 ? 1e-2 : 1e-14, true}));
    return v.results()[index(Claim::omega)];
  };
  CHECK(undecided(10).outcome == Outcome::pass);
  CHECK(undecided(10).undecided_steps == 10);
  CHECK(undecided(11).outcome == Outcome::fail);
  CHECK(undecided(1000).outcome == Outcome::fail);  // never passed
}

}  // namespace osculate::testing::claims_tests
