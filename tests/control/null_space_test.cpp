#include "control/null_space.hpp"

#include <limits>

#include "control/differences.hpp"
#include "control/quick_arm.hpp"
#include "recursion/worst.hpp"
#include "reference/conditioning.hpp"
#include "reference/dense.hpp"
#include "support/catch.hpp"

namespace osculate::testing::null_space_tests {
using osculate::test::first_difference;
using osculate::test::quick_arm;
using osculate::test::QuickArm;

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

std::span<const double> span_of(const Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

Vector torque(const NullSpaceOptions& options, const Chain<double>& chain, const Vector& q, const Vector& qd,
              const TaskRows& rows = all_rows()) {
  Vector T0 = Vector::Constant(qd.size(), -77);
  null_space_torque(options, chain, rows, span_of(q), span_of(qd),
                    {T0.data(), static_cast<std::size_t>(T0.size())});
  return T0;
}

/// Rows of J at q.
Matrix jacobian(const Chain<double>& chain, const Vector& q, const TaskRows& rows) {
  const Vector at_rest = Vector::Zero(chain.velocities());
  return dense::kinematics(chain, positions<double>(chain, span_of(q)), at_rest).J(rows, Eigen::all);
}
double log_manipulability(const Chain<double>& chain, const Vector& q, const TaskRows& rows) {
  const Matrix J = jacobian(chain, q, rows);
  double sum = 0;
  for (const double pivot : dense::factor(Matrix(J * J.transpose())).D) sum += std::log(pivot);
  return sum / 2;
}

/// n revolute joints about z, links of 1 m along x.
Chain<double> planar(int n) {
  Chain<double> chain;
  for (int i = 0; i < n; ++i) {
    Link<double> link;
    link.mass = 1;
    link.inertia.setIdentity();
    if (i > 0) link.p_origin = {1, 0, 0};
    chain.links.push_back(link);
  }
  chain.p_tip = {1, 0, 0};
  return chain;
}

constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("damping and posture") {
  const Chain<double> chain = planar(3);
  const Vector q = Eigen::Vector3d(0.5, -1, 2), qd = Eigen::Vector3d(1, 2, -4);
  NullSpaceOptions options;
  CHECK(options.empty());
  CHECK(torque(options, chain, q, qd).isZero(0));
  options.damping = 0.5;
  CHECK(!options.empty());
  CHECK(torque(options, chain, q, qd) == Vector(Eigen::Vector3d(-0.5, -1, 2)));
  options.posture = {{1.0, 1.0, 1.0}, 8.0};
  CHECK(torque(options, chain, q, qd) == Vector(Eigen::Vector3d(3.5, 15, -6)));  // powers of two do not round
  options.damping = 0;
  CHECK(!options.empty());
  CHECK(torque(options, chain, q, qd) == Vector(Eigen::Vector3d(4, 16, -8)));
}

TEST_CASE("damping takes joints of any kind, the rest does not") {
  QuickArm arm = quick_arm(1, 2);
  arm.chain.links[0].type = JointType::spherical;
  arm.q = VectorX<double>::Unit(5, 0);
  arm.qd = VectorX<double>::Constant(4, 0.25);
  NullSpaceOptions options;
  options.damping = 2;
  CHECK(torque(options, arm.chain, arm.q, arm.qd) == Vector(-2 * arm.qd));
  options.manipulability = 1;
  CHECK_THROWS_AS(torque(options, arm.chain, arm.q, arm.qd), std::invalid_argument);
  options.manipulability = 0;
  options.posture = {std::vector<double>(5, 0.0), 1.0};
  CHECK_THROWS_AS(torque(options, arm.chain, arm.q, arm.qd), std::invalid_argument);
}

TEST_CASE("limits repel by the gradient of Khatib's field, within the margin only") {
  const Chain<double> chain = planar(3);
  NullSpaceOptions options;
  options.limits = {{-1, -infinite, 0}, {1, infinite, 0.5}, 0.4, 0.1};
  const auto& limits = *options.limits;
  const Vector still = Vector::Zero(3);
  const auto first = [&](double q) {
    return torque(options, chain, Eigen::Vector3d(q, 1e6, 0.25), still)[0];
  };
  // Outside every margin, and on its edge.
  CHECK(first(0) == 0);
  CHECK(first(0.6 - 1e-9) == 0);
  CHECK(first(-0.6 + 1e-9) == 0);
  CHECK(torque(options, chain, Eigen::Vector3d(0, 1e6, 0.25), still)[1] == 0);
  // Joint 3 is within both margins of a narrow range: the middle is free of force up to the rounding of two
  // terms of 0.1 (1/0.25 - 1/0.4) / 0.25^2 = 2.4.
  CHECK(std::abs(torque(options, chain, Eigen::Vector3d(0, 0, 0.25), still)[2]) <= 4 * eps * 2.4);
  // -dU/dq of U = gain/2 (1/d - 1/margin)^2
  for (const double q : {-0.95, -0.8, -0.61, 0.61, 0.7, 0.9, 0.99}) {
    const auto U = [&](double x) {
      const double s = 1 / (1 - std::abs(x)) - 1 / limits.margin;
      return limits.gain / 2 * s * s;
    };
    const double d = 1 - std::abs(q), h = d / 200;
    const auto slope = first_difference(U, q, h);
    // d = 1 - |q| is wrong by eps, so U by gain / d^3 eps at most and a few eps of itself.
    const double rounding = 2.1 / h * eps * (limits.gain / (d * d * d) + 4 * U(q));
    INFO("q = " << q);
    if (std::abs(q) > 0.65) CHECK(std::abs(first(q) + slope.value) <= rounding + std::abs(slope.truncation));
    CHECK((q > 0 ? first(q) < 0 : first(q) > 0));
  }
  CHECK(first(0.99) < -900);  // 0.1 (1/0.01 - 1/0.4) / 0.01^2 = 97500
}

TEST_CASE("a joint at or beyond a limit is named with its value") {
  const Chain<double> chain = planar(3);
  NullSpaceOptions options;
  options.limits = {{-1, -1, -1}, {1, 1, 1}, 0.4, 0.1};
  const Vector still = Vector::Zero(3);
  const auto message = [&](double q1, double q2, double q3) -> std::string {
    try {
      torque(options, chain, Eigen::Vector3d(q1, q2, q3), still);
    } catch (const std::domain_error& error) { return error.what(); }
    return "";
  };
  CHECK(message(0, 0.999, 0).empty());
  CHECK(
      message(0, 1.25, 0) ==
      "joint 2 (1 is next to the base) stands at 1.250000 rad, at or beyond its upper limit of 1.000000 rad: "
      "the null-space repulsion is not defined there");
  CHECK(message(0, 0, -1).find("joint 3") == 0);
  CHECK(message(0, 0, -1).find("lower limit of -1.000000 rad") != std::string::npos);
  CHECK(!message(std::numeric_limits<double>::quiet_NaN(), 0, 0).empty());
}

TEST_CASE("manipulability of two planar links is |sin q2|") {
  const Chain<double> chain = planar(2);
  NullSpaceOptions options;
  options.manipulability = 3;
  for (const double q2 : {0.01, 0.5, 1.5, 2.5, -1.0, -3.0}) {
    const Vector T0 = torque(options, chain, Eigen::Vector2d(0.3, q2), Vector::Zero(2), {3, 4});
    // J^+, of size 2 / |sin q2|, is wrong by eps cond(J J*), at most 6^2 / sin^2 q2; J' is of size 2.
    const double tol = 3 * 4 * 36 * eps / std::pow(std::abs(std::sin(q2)), 3);
    INFO("q2 = " << q2);
    CHECK(std::abs(T0[0]) <= tol);
    CHECK(std::abs(T0[1] - 3 / std::tan(q2)) <= tol);
  }
  CHECK_THROWS_AS(torque(options, chain, Eigen::Vector2d(0.3, 0), Vector::Zero(2), {3, 4}),
                  std::domain_error);
}

TEST_CASE("the manipulability gradient is that of log w, by differences") {
  NullSpaceOptions options;
  options.manipulability = 2;
  int seen = 0;
  double largest = 0;
  for (const auto& [n, rows] : std::vector<std::pair<int, TaskRows>>{
           {6, all_rows()}, {7, all_rows()}, {4, {3, 4, 5}}, {7, {0, 1, 2}}, {5, {1, 3, 5}}})
    for (unsigned seed = 1; seed <= 6; ++seed) {
      const QuickArm arm = quick_arm(seed, n);
      const Matrix J = jacobian(arm.chain, arm.q, rows);
      const double cond = scaled_condition(J * J.transpose());
      if (cond > 1e4) continue;
      ++seen;
      const Vector T0 = torque(options, arm.chain, arm.q, Vector::Zero(n), rows);
      for (int i = 0; i < n; ++i) {
        const auto log_w = [&](double x) {
          Vector q = arm.q;
          q[i] = x;
          return log_manipulability(arm.chain, q, rows);
        };
        const double h = 2e-3;
        const auto slope = first_difference(log_w, arm.q[i], h);
        // Entries of J are wrong by n eps of their size, which log det feels cond times.
        const double rounding = 2.1 / h * n * cond * eps;
        INFO(arm.name << ", joint " << i << ", rows " << rows.size());
        CHECK(std::abs(T0[i] / 2 - slope.value) <= rounding + std::abs(slope.truncation));
        CHECK(rounding + std::abs(slope.truncation) < 1e-3 * (1 + std::abs(slope.value)));  // it can fail
        largest = std::max(largest, std::abs(slope.value));
      }
    }
  CHECK(seen >= 15);
  CHECK(largest > 0.5);
}

}  // namespace osculate::testing::null_space_tests
