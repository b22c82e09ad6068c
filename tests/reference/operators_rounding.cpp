// The identities of the paper over doubles, on random arms of six links: each side a few eps of the terms
// that it sums.
#include <cmath>
#include <limits>
#include <string>

#include "model/random_arm.hpp"
#include "reference/identities.hpp"
#include "support/catch.hpp"

using namespace osculate;

TEST_CASE("over doubles every identity holds to a few eps of the terms it sums") {
  // Over seeds 1 to 1000: at most 4.4 eps, for (48); all but (47), (48), (59), (63) below 1.4 eps.
  const double allowed = 12 * std::numeric_limits<double>::epsilon();
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const RandomArm arm = random_arm(seed, 6);
    const auto x = dense::operators(arm.chain, arm.positions, arm.qd);
    for (const auto& identity : dense::identities<double>()) {
      INFO("seed " << seed << ", " << letters(arm.chain) << ": " << identity.equation << "  "
                   << identity.statement);
      CHECK(dense::residual(identity.sides(x)) <= allowed);
    }
    for (const auto& wrong : dense::printed_errors<double>()) {
      INFO("seed " << seed << ", as printed: " << wrong.equation << "  " << wrong.statement);
      CHECK(dense::residual(wrong.sides(x)) > 1e4 * allowed);
    }
  }
}

TEST_CASE("over doubles every identity holds to a few eps with joints of every type") {
  using enum JointType;
  // Over seeds 1 to 300: at most 18 eps, for (48), whose left side is a difference of accelerations that are
  // sums themselves; 7.6 for (47), below 5 for the others.
  const double allowed = 20 * std::numeric_limits<double>::epsilon();
  const std::vector<std::vector<JointType>> chains = {
      {revolute, spherical, revolute},   {floating, revolute, prismatic, revolute, revolute},
      {universal, spherical, universal}, {cylindrical, cylindrical, universal, universal},
      {planar, revolute, revolute},      {revolute, universal, spherical, cylindrical, prismatic}};
  for (const auto& types : chains)
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const RandomArm arm = random_arm_of(seed, types);
      const auto x = dense::operators(arm.chain, arm.positions, arm.qd);
      for (const auto& identity : dense::identities<double>()) {
        if (identity.regular_tip && x.m() < 6) continue;
        INFO("seed " << seed << ", " << letters(arm.chain) << ": " << identity.equation << "  "
                     << identity.statement);
        CHECK(dense::residual(identity.sides(x)) <= allowed);
      }
    }
}

TEST_CASE("a residual that is not a number is not within any bound") {
  const RandomArm arm = random_arm(1, 2);
  dense::Sides<double> sides = dense::jacobian(dense::operators(arm.chain, arm.positions, arm.qd));
  sides.left.value(0, 0) = std::nan("");
  CHECK_FALSE(dense::residual(sides) <= 1e300);
}
