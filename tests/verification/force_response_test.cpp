#include "verification/force_response.hpp"

#include <cmath>

#include "control/differences.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::force_response_tests {
using namespace osculate::test;

namespace {

const std::initializer_list<ForceLoop> loops{
    {1e4, 0, 1, 0, 10},      // undamped
    {1e4, 30, 1.5, 20, 10},  // under-damped
    {100, 10, 4, 7.5, -3},   // critical: (D + d/m)^2 = 4 k/m = 100
    {1000, 500, 2, 40, 25},  // over-damped
    {1000, 500, 2, 40, 0},   // nothing desired
};

}  // namespace

TEST_CASE("depth solves m xdd = desired - pressure - m D xd") {
  for (const auto& loop : loops)
    for (const ErrorState start : {ErrorState{0, 0.1}, ErrorState{0.004, -0.03}}) {
      const double k = loop.stiffness / loop.inertia, d = loop.law_damping + loop.damping / loop.inertia;
      const double fastest = std::sqrt(k) + d;  // 1/s
      const double rest = loop.desired / loop.stiffness;
      // m, m/s: larger than anything that happens
      const double size = std::abs(rest) + std::abs(start.e) + std::abs(start.ed) / std::sqrt(k);
      const double h = 0.05 / fastest, rounding = 2.1 / h * 16 * eps * size;
      const auto at = [&](double t) { return depth_response(loop, start, t); };
      for (const double turns : {0.5, 1.0, 3.0, 10.0}) {
        const double t = turns / fastest;
        INFO("k " << k << ", d " << d << ", t " << t);
        const ErrorState x = at(t);
        const auto rate = first_difference([&](double s) { return at(s).e; }, t, h);
        CHECK(std::abs(rate.value - x.ed) <= rounding + std::abs(rate.truncation) / 64);
        const auto acceleration = first_difference([&](double s) { return at(s).ed; }, t, h);
        const double force = loop.desired - pressure(loop, x) - loop.inertia * loop.law_damping * x.ed;
        // Rates are of the size fastest * size; so is their rounding.
        CHECK(std::abs(loop.inertia * acceleration.value - force) <=
              loop.inertia * (4 * fastest * rounding + std::abs(acceleration.truncation) / 64));
        CHECK(std::abs(acceleration.truncation) < 1e-4 * fastest * fastest * size);
      }
    }
}

TEST_CASE("depth begins as given and comes to rest at desired / stiffness") {
  for (const auto& loop : loops) {
    const double rest = loop.desired / loop.stiffness;
    const ErrorState start{0.003, -0.2}, first = depth_response(loop, start, 0);
    CHECK(std::abs(first.e - start.e) <= 2 * eps * (std::abs(rest) + start.e));
    CHECK(first.ed == start.ed);
    const ErrorState still = depth_response(loop, {rest, 0}, 0.37);
    CHECK(still.e == rest);
    CHECK(still.ed == 0);
    CHECK(pressure(loop, still) == Approx(loop.desired).epsilon(2 * eps));
    if (loop.damping == 0 && loop.law_damping == 0) continue;
    const ErrorState last = depth_response(loop, start, 1e4);
    CHECK(last.e == rest);
    CHECK(last.ed == 0);
  }
}

TEST_CASE("without damping the depth swings about desired / stiffness for ever") {
  const ForceLoop loop{400, 0, 4, 0, 8};  // 10 rad/s about 0.02 m
  for (const double t : {0.0, 0.1, 0.7, 3.0}) {
    const ErrorState x = depth_response(loop, {0, 0}, t);
    const double rounding = 8 * eps * (1 + 10 * t);
    CHECK(std::abs(x.e - 0.02 * (1 - std::cos(10 * t))) <= 0.02 * rounding);
    CHECK(std::abs(x.ed - 0.2 * std::sin(10 * t)) <= 0.2 * rounding);
    CHECK(std::abs(pressure(loop, x) - 8 * (1 - std::cos(10 * t))) <= 8 * rounding);
  }
}

TEST_CASE("damping of the surface and of the law add as d/m + D, but only the surface's is felt") {
  const ForceLoop surface{400, 12, 4, 0, 8}, law{400, 0, 4, 3, 8};
  const ErrorState start{0.01, 0.4};
  const ErrorState a = depth_response(surface, start, 0.3), b = depth_response(law, start, 0.3);
  CHECK(a.e == b.e);
  CHECK(a.ed == b.ed);
  CHECK(pressure(law, b) == 400 * b.e);
  CHECK(pressure(surface, a) - pressure(law, b) == Approx(12 * a.ed).epsilon(1e3 * eps));
  CHECK(std::abs(a.ed) > 0.01);
}

}  // namespace osculate::testing::force_response_tests
