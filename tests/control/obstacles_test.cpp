#include "control/obstacles.hpp"

#include <cmath>

#include "control/differences.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::obstacles_tests {
using namespace osculate::test;

namespace {

using V3 = Vector3<double>;

const std::vector<Obstacle> two{{.centre = {0.4, 0.1, -0.2}, .radius = 0.15, .influence = 0.3, .gain = 0.02},
                                {.centre = {0.8, 0.3, 0.1}, .radius = 0.1, .influence = 0.35, .gain = 0.05}};

/// Sum of the potentials, m^2/s^2.
double potential(const std::vector<Obstacle>& obstacles, const V3& p) {
  double out = 0;
  for (const auto& o : obstacles) {
    const double d = (p - o.centre).norm() - o.radius;
    if (d < o.influence) out += o.gain / 2 * std::pow(1 / d - 1 / o.influence, 2);
  }
  return out;
}

}  // namespace

TEST_CASE("distance from the surface of an obstacle") {
  const Obstacle ball{.centre = {1, 2, 3}, .radius = 0.5};
  CHECK(distance(ball, {1, 2, 5}) == 1.5);
  CHECK(distance(ball, {1, 5, 7}) == 4.5);
  CHECK(distance(ball, {1.25, 2, 3}) == -0.25);
  CHECK(distance(ball, {1, 2, 3}) == -0.5);
}

TEST_CASE("repulsion by hand: away from the centre, gain (1/d - 1/d0) / d^2") {
  const Obstacle ball{.centre = {1, 0, 0}, .radius = 0.5, .influence = 0.5, .gain = 0.01};
  // d = 0.25: (4 - 2) 16 0.01 = 0.32 along (0.6, 0, 0.8).
  const V3 got = repulsion({ball}, V3(1, 0, 0) + 0.75 * V3(0.6, 0, 0.8));
  CHECK((got - 0.32 * V3(0.6, 0, 0.8)).norm() <= 100 * eps * 0.32);
  CHECK(repulsion({}, {0, 0, 0}) == V3::Zero());
}

TEST_CASE("repulsion is the negative gradient of the potential") {
  const double h = 0.002;  // m, small against every distance here
  for (const V3& p : {V3(0.6, 0.2, 0.02), V3(0.45, 0.28, -0.25), V3(0.95, 0.5, 0.3), V3(0.55, 0.16, -0.14)}) {
    INFO("p " << p.transpose());
    const V3 got = repulsion(two, p);
    CHECK(got.norm() > 0.01);
    for (int i = 0; i < 3; ++i) {
      const auto slope =
          first_difference([&](double x) { return potential(two, p + x * V3::Unit(i)); }, 0.0, h);
      // U is wrong by a few eps of its largest terms, gain/2 / d^2; 1/d by 1/d times that: d is a difference
      // of numbers below 1.
      double size = 0;
      for (const auto& o : two) {
        const double d = distance(o, p) - 8 * h;  // nearest of all points that are used
        REQUIRE(d > 0);
        REQUIRE(std::abs(distance(o, p) - o.influence) > 8 * h);  // the potential is smooth there
        size += o.gain / 2 / (d * d) * (4 + 4 / d);
      }
      const double rounding = eps * size * 2.1 / h;
      CHECK(std::abs(got[i] + slope.value) <= rounding + std::abs(slope.truncation) / 64);
      CHECK(rounding + std::abs(slope.truncation) / 64 < 1e-3 * got.norm());
    }
  }
}

TEST_CASE("repulsion begins at the influence, without a jump") {
  const Obstacle ball{.centre = V3::Zero(), .radius = 0.5, .influence = 0.25, .gain = 1};
  CHECK(repulsion({ball}, {0, 0.75, 0}) == V3::Zero());
  CHECK(repulsion({ball}, {0, 0, -2}) == V3::Zero());
  // Just inside by 2^-30 m: (1/d - 1/d0) / d^2 = 2^-30 / d0^4 to first order, the next terms 4 2^-28 of it.
  const double step = std::ldexp(1.0, -30);
  const V3 got = repulsion({ball}, {0, 0.75 - step, 0});
  CHECK(got[1] == Approx(256 * step).epsilon(16 * 4 * step + 8 * eps / step));
  CHECK(got[0] == 0);
}

TEST_CASE("fields add, nearer is stronger, every number counts") {
  const V3 p(0.6, 0.2, 0.02);
  const V3 sum = repulsion({two[0]}, p) + repulsion({two[1]}, p);
  CHECK((repulsion(two, p) - sum).norm() <= 4 * eps * sum.norm());
  CHECK(repulsion({two[0]}, p).norm() > 0);
  CHECK(repulsion({two[1]}, p).norm() > 0);
  double before = 0;
  for (const double d : {0.29, 0.2, 0.1, 0.01, 1e-4}) {
    const double now = repulsion({two[0]}, two[0].centre + V3(0, 0, 0.15 + d)).norm();
    CHECK(now > before);
    before = now;
  }
  const double base = repulsion({two[0]}, p).norm();
  for (double Obstacle::*member : {&Obstacle::radius, &Obstacle::influence, &Obstacle::gain}) {
    Obstacle other = two[0];
    other.*member *= 1.01;
    CHECK(repulsion({other}, p).norm() > base);
  }
}

TEST_CASE("no field at or inside an obstacle") {
  const Obstacle ball{.centre = V3::Zero(), .radius = 0.5};
  for (const V3& p : {V3(0.5, 0, 0), V3(0, 0, -0.25), V3(0, 0, 0)})
    CHECK_THROWS_AS(repulsion({two[0], ball}, p), std::domain_error);
  CHECK_THROWS_WITH(repulsion({two[0], ball}, {0, 0, 0}),
                    "the tip point is at or inside obstacles[1], where the field has no value");
  CHECK_THROWS_AS(repulsion({ball}, {std::nan(""), 0, 0}), std::domain_error);
  CHECK_NOTHROW(repulsion({ball}, {0.5 + eps, 0, 0}));
}

}  // namespace osculate::testing::obstacles_tests
