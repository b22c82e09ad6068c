// The Jacobian of the closed loop against central differences of its right side, and what bdf makes of it.
#include "simulation/closed_loop_slopes.hpp"

#include <cmath>

#include "control/quick_arm.hpp"
#include "reference/dense.hpp"
#include "scalar/eps.hpp"
#include "simulation/integrator.hpp"
#include "support/catch.hpp"
#include "support/singular_values.hpp"

namespace osculate::testing::closed_loop_slopes_tests {
using namespace osculate::test;

namespace {

struct Setting {
  LawOptions law;
  Plant plant;
  std::vector<JointFriction> friction;
  std::shared_ptr<const Path> path = make_path(CircleOptions{});
};

ClosedLoop loop_of(const Setting& setting, const QuickArm& arm) {
  const std::span<const double> q{arm.q.data(), static_cast<std::size_t>(arm.q.size())};
  const Pose start = tip_pose(arm.chain, q, base_motion(setting.law.base_path.get(), 0));
  return {Controller(arm.chain, setting.friction, setting.law, setting.path, start), setting.plant};
}

/// The arm's state, moved off the path.
std::vector<double> state_of(const ClosedLoop& loop, const QuickArm& arm, double off) {
  std::vector<double> y(loop.states());
  for (Eigen::Index i = 0; i < arm.q.size(); ++i) {
    y[static_cast<std::size_t>(i)] = arm.q[i] + off * std::sin(1.0 + 3.0 * static_cast<double>(i));
    y[static_cast<std::size_t>(arm.q.size() + i)] = arm.qd[i];
  }
  return y;
}

MatrixX<double> slopes(ClosedLoop& loop, double t, const std::vector<double>& y) {
  const auto N = static_cast<Eigen::Index>(y.size());
  MatrixX<double> out(N, N);
  ClosedLoopSlopes jacobian(loop);
  jacobian(t, y.data(), out.data());
  return out;
}

// With f' = (45 (f1 - f-1) - 9 (f2 - f-2) + (f3 - f-3)) / (60 h) + h^6 f^(7) / 140, fk = f(x + k h), the step
// and the rounding of f balance near h = eps^(1/7) times the size over which f changes: 1 rad, 1 m, 1 rad/s.
MatrixX<double> differences(ClosedLoop& loop, double t, const std::vector<double>& y, double h) {
  const auto N = static_cast<Eigen::Index>(y.size());
  MatrixX<double> out = MatrixX<double>::Zero(N, N);
  VectorX<double> f(N);
  for (Eigen::Index j = 0; j < N; ++j)
    for (const auto& [k, weight] : {std::pair(1, 45), {-1, -45}, {2, -9}, {-2, 9}, {3, 1}, {-3, -1}}) {
      std::vector<double> moved = y;
      moved[static_cast<std::size_t>(j)] += k * h;
      loop.right_side(t, moved.data(), f.data());
      out.col(j) += weight / (60 * h) * f;
    }
  return out;
}

/// Bound on the error of the differences with step h/2: the step's share is 1/64 of that with h, so less than
/// what the two differ by; and 11/6 roundings of f over the step. Those of the recursions are about n eps
/// cond(M) of what M^-1 makes of the torques, and as much of the powers; the law's solve multiplies them by
/// the condition of Omega on its rows.
MatrixX<double> bound(ClosedLoop& loop, double t, const std::vector<double>& y, const MatrixX<double>& coarse,
                      const MatrixX<double>& fine, double h) {
  const Observation& at = loop.observe(t, y);
  const Eigen::Map<const VectorX<double>> qd(at.qd.data(), loop.velocities());
  const Eigen::Map<const VectorX<double>> torque(at.torque.data(), loop.velocities());
  const auto moved =
      dense::state<double>(loop.plant().chain, positions<double>(loop.plant().chain, at.q), qd, loop.base(t));
  const VectorX<double> sizes = singular_values(moved.joint.M);
  const double condition = sizes[0] / sizes[sizes.size() - 1];
  const TaskRows rows =
      loop.controller().options().law == Law::free ? all_rows() : loop.controller().options().rows;
  MatrixX<double> Omega(rows.size(), rows.size());
  const Compliance<double> all = loop.controller().compliance(t, at.q, at.qd);
  for (Eigen::Index i = 0; i < Omega.rows(); ++i)
    for (Eigen::Index j = 0; j < Omega.cols(); ++j)
      Omega(i, j) = component(all, rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
  const VectorX<double> task = singular_values(Omega);
  const double law = loop.controller().options().law == Law::free ? 1.0 : task[0] / task[task.size() - 1];
  const double forces = torque.norm() + moved.joint.C.norm() + moved.joint.G.norm() + at.tip_force.norm();
  const double rounding = static_cast<double>(loop.velocities()) * eps * condition * law;
  VectorX<double> noise = VectorX<double>::Zero(coarse.rows());
  noise.segment(loop.velocities(), loop.velocities()).setConstant(forces / sizes[sizes.size() - 1]);
  noise.tail<3>().setConstant(forces * (1 + qd.norm()));
  const MatrixX<double> floor = (11.0 / 6 * rounding / (h / 2) * noise).replicate(1, coarse.cols());
  const double exact = 2 * eps / (h / 2) * 3;  // q' = qd: only the step's rounding
  return ((coarse - fine).cwiseAbs() + floor).array() + exact;
}

void check(const Setting& setting, const QuickArm& arm, double off = 0.05, const Modes& modes = {}) {
  INFO(arm.name);
  ClosedLoop loop = loop_of(setting, arm);
  REQUIRE(ClosedLoopSlopes::exist(loop));
  loop.set_modes(modes);
  const std::vector<double> y = state_of(loop, arm, off);
  const double t = 0.3, h = std::pow(eps, 1 / 7.0);
  const MatrixX<double> J = slopes(loop, t, y);
  const MatrixX<double> coarse = differences(loop, t, y, h), fine = differences(loop, t, y, h / 2);
  const MatrixX<double> tolerance = bound(loop, t, y, coarse, fine, h);
  Eigen::Index i = 0, j = 0;
  const double worst = (J - fine).cwiseAbs().cwiseQuotient(tolerance).maxCoeff(&i, &j);
  INFO("df" << i << "/dy" << j << " = " << J(i, j) << ", by differences " << fine(i, j));
  CHECK(worst <= 1);
  // The bound sees an error of a thousandth in any entry that matters.
  for (const auto& [first, rows] : {std::pair(arm.q.size(), arm.q.size()), {2 * arm.q.size(), 2}})
    CHECK(10 * tolerance.middleRows(first, rows).norm() < 1e-3 * J.middleRows(first, rows).norm());
}

}  // namespace

TEST_CASE("the Jacobian is the derivative of the right side") {
  const QuickArm arm = quick_arm(3, 6), long_arm = quick_arm(2, 7);
  Setting s;
  s.plant.chain = arm.chain;
  SECTION("tracking a circle") { check(s, arm); }
  SECTION("far from the reference") { check(s, arm, 0.4); }
  SECTION("on the reference") {
    s.path = make_path(HoldOptions{});
    check(s, arm, 0);
  }
  SECTION("seven joints, null space, friction that the law knows wrongly, a heavier plant") {
    s.plant.chain = long_arm.chain;
    s.plant.chain.links.back().mass += 1;
    s.friction.assign(7, {0.1, 1, 2, 1});
    s.plant.friction.assign(7, {0.2, 2, 1, 2});
    s.law.null_space.damping = 1;
    s.law.null_space.posture = NullSpaceOptions::Posture{std::vector<double>(7, 0.1), 2};
    check(s, long_arm);
  }
  SECTION("three rows, torque limits, no feedforward") {
    s.plant.chain = long_arm.chain;
    s.law.rows = {3, 4, 5};
    s.law.feedforward = false;
    s.law.effort_limit.assign(7, 20);
    check(s, long_arm);
    ClosedLoop loop = loop_of(s, long_arm);
    CHECK(loop.observe(0.3, state_of(loop, long_arm, 0.05)).command.saturated);
  }
  SECTION("a constant command and a constant wrench") {
    s.law.constant_command = Vector6::Constant(0.5);
    s.plant.tip_force << 1, 2, 3, 4, 5, 6;
    check(s, arm);
  }
  SECTION("moving base") {
    Vector6 amplitude;  // turning and sliding along different axes
    amplitude << 0.3, 0.1, -0.2, 0.1, 0.3, 0.2;
    s.law.base_path = make_path(LissajousOptions{.amplitude = amplitude, .phase = Vector6::Constant(0.5)});
    check(s, arm);
  }
  SECTION("impedance at a ball that the law feels, in contact and not") {
    s.plant.environment = Environment{Ball{{5, 5, 5}, 12}, 1e2, 10, 0.2, 1};
    s.law.know_tip_force = true;
    s.law.virtual_inertia = Vector6::Constant(2);
    check(s, arm, 0.05, {.contact = true});
    check(s, arm);
  }
  SECTION("force control on a plane") {
    s.plant.environment = Environment{Plane{{0, 0, 9}, {1, 2, 3}}, 1e2, 10, 0.2, 1};
    s.law.know_tip_force = true;
    s.law.force = ForceControl{{4, 5}, {10, 3}, 1, 20};
    check(s, arm, 0.05, {.contact = true});
  }
  SECTION("free swing") {
    s.law.law = Law::free;
    s.plant.friction.assign(6, {0.2, 2, 1, 2});
    check(s, arm);
  }
}

TEST_CASE("loops without a Jacobian say so") {
  const QuickArm arm = quick_arm(3, 6);
  const auto exist = [&](const Setting& setting) { return ClosedLoopSlopes::exist(loop_of(setting, arm)); };
  Setting plain;
  plain.plant.chain = arm.chain;
  CHECK(exist(plain));
  Setting dense = plain, textbook = plain, sampled = plain, chart = plain, obstacle = plain, damped = plain,
          limits = plain, manipulability = plain;
  dense.plant.dense = true;
  textbook.law.law = Law::textbook;
  sampled.law.sampling = Sampling{};
  chart.law.orientation = OrientationCoordinates::quaternion;
  obstacle.law.obstacles = {Obstacle{{-5, 5, 5}, 0.1, 40, 0.01}};
  damped.law.singularity.policy = SingularPolicy::damped;
  limits.law.null_space.limits =
      NullSpaceOptions::Limits{std::vector<double>(6, -9), std::vector<double>(6, 9), 8, 0.1};
  manipulability.law.null_space.manipulability = 1;
  for (const Setting& s : {dense, textbook, sampled, chart, obstacle, damped, limits, manipulability})
    CHECK(!exist(s));
  Chain<double> wrist = arm.chain;
  wrist.links.back().type = JointType::spherical;
  std::vector<double> q(static_cast<std::size_t>(wrist.positions()), 0.5);
  CHECK(!ClosedLoopSlopes::exist(
      {Controller(wrist, {}, {}, make_path(HoldOptions{}), tip_pose(wrist, q)), Plant{wrist, {}}}));
}

TEST_CASE("bdf goes the same way with both Jacobians, with fewer right sides by the automatic one") {
  const QuickArm arm = quick_arm(3, 6);
  Setting s;
  s.plant.chain = arm.chain;
  struct Run {
    VectorX<double> y;
    long rhs, jacobians, steps;
  };
  const double tolerance = 1e-7;
  const auto run = [&](JacobianBy by, double rtol) {
    ClosedLoop loop = loop_of(s, arm);
    std::vector<double> y = state_of(loop, arm, 0);
    std::fill(y.begin() + 6, y.end(), 0.0);
    ClosedLoopSlopes jacobian(loop);
    const IntegratorOptions options{.method = Method::bdf,
                                    .rtol = rtol,
                                    .atol = std::vector<double>(loop.states(), rtol),
                                    .jacobian = by};
    Integrator integrator([&](double t, const double* at, double* yd) { loop.right_side(t, at, yd); }, 0, y,
                          options, 0, {},
                          [&](double t, const double* at, double* df) { jacobian(t, at, df); });
    Run out{};
    for (; integrator.t() < 1; ++out.steps) integrator.step(1);
    out.y = Eigen::Map<const VectorX<double>>(integrator.state().data(), 12);
    out.rhs = integrator.rhs_evaluations();
    out.jacobians = integrator.jacobian_evaluations();
    return out;
  };
  const Run automatic = run(JacobianBy::automatic, tolerance);
  const Run differences = run(JacobianBy::differences, tolerance);
  const Run exact = run(JacobianBy::automatic, tolerance / 1e3);
  // Each step adds an error of its tolerance, and the closed loop lets it decay.
  for (const Run& r : {automatic, differences})
    CHECK((r.y - exact.y).norm() < static_cast<double>(r.steps) * tolerance * (1 + exact.y.norm()));
  CHECK(automatic.jacobians > 1);
  CHECK(differences.jacobians == 0);
  // Fifteen for each Jacobian; the two runs need not ask for equally many.
  CHECK(differences.rhs > automatic.rhs + 15 * automatic.jacobians / 2);
}

TEST_CASE("what a Jacobian throws counts as what f throws") {
  const auto f = [](double, const double* y, double* yd) { yd[0] = -y[0]; };
  const IntegratorOptions options{.method = Method::bdf, .rtol = 1e-6, .atol = {1e-6}};
  const std::vector<double> y0 = {1};
  const auto refused = IntegrationStopped(IntegrationStopped::Reason::singular, "refused");
  long calls = 0;
  SECTION("a refusal is tried again with a smaller step") {
    Integrator integrator(f, 0, y0, options, 0, {}, [&](double, const double*, double* df) {
      if (++calls == 1) throw refused;
      df[0] = -1;
    });
    while (integrator.t() < 1) integrator.step(1);
    CHECK(std::abs(integrator.state()[0] - std::exp(-1)) < 1e-4);
    CHECK(integrator.jacobian_evaluations() == calls);
    CHECK(calls > 1);
  }
  SECTION("a refusal that stays is the reason") {
    Integrator integrator(f, 0, y0, options, 0, {}, [&](double, const double*, double*) { throw refused; });
    CHECK_THROWS_WITH(integrator.step(1), "refused");
  }
  SECTION("anything else stops the run") {
    Integrator integrator(f, 0, y0, options, 0, {},
                          [&](double, const double*, double*) { throw std::logic_error("mistake"); });
    CHECK_THROWS_WITH(integrator.step(1), "mistake");
  }
}

}  // namespace osculate::testing::closed_loop_slopes_tests
