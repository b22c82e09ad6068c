// The sweep of columns gives what sweep 3 gives: exactly over fractions, to rounding over doubles. Joints
// with several axes: fast_path_test.cpp.
#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/worst.hpp"
#include "spatial/plain.hpp"

namespace osculate::testing::column_form_tests {
using Q = Rational;

namespace {

/// No residual between sweep() and sweep_from_tip(), with T0, a wrench on the tip and a base that moves.
void check_exactly_equal(const ExactArm& arm, Random& random) {
  OperationalSpace<Q> space(arm.chain), columns(arm.chain);
  std::vector<Q> T0(static_cast<std::size_t>(arm.chain.velocities()));
  for (Q& x : T0) x = random.fraction(8, 2);
  const std::span<const Q> qd(arm.qd.data(), static_cast<std::size_t>(arm.qd.size()));
  const auto six = [&] { return Vector6<Q>(Vector6<Q>::NullaryExpr([&] { return random.fraction(8, 2); })); };
  const auto F_ext = as<Force, Q>(six());
  BaseMotion<Q> base;
  base.velocity = six(), base.acceleration = six();
  for (auto* each : {&space, &columns}) {
    each->move_base(base);
    each->place(arm.positions);
  }
  space.sweep(qd, T0, F_ext);
  columns.sweep_from_tip(qd, T0, F_ext);
  CHECK(plain(space.Omega()) == plain(columns.Omega()));
  CHECK(plain(space.right_side()) == plain(columns.right_side()));
  CHECK(space.sweeps() == columns.sweeps());
}

}  // namespace

TEST_CASE("columns from the tip give Omega and the right side of sweep 3 exactly") {
  for (int n = 1; n <= 5; ++n)
    for (unsigned seed = 1; seed <= 4; ++seed) {
      INFO("exact_arm(" << seed << ", " << n << ")");
      Random random(seed);
      check_exactly_equal(exact_arm(seed, n), random);
    }
}

TEST_CASE("an arm is placed from coordinates as from joint positions, and gives the same bits") {
  for (int n = 1; n <= 12; ++n)
    for (unsigned seed = 1; seed <= 4; ++seed) {
      INFO("random_arm(" << seed << ", " << n << ")");
      const RandomArm arm = random_arm(seed, n);
      const auto size = static_cast<std::size_t>(n);
      const std::span<const double> q(arm.q.data(), size), qd(arm.qd.data(), size);
      OperationalSpace<double> space(arm.chain), from_q(arm.chain);
      space.place(arm.positions), from_q.place(q);
      space.sweep(qd), from_q.sweep(qd);
      CHECK(plain(space.Omega()) == plain(from_q.Omega()));
      CHECK(plain(space.right_side()) == plain(from_q.right_side()));
      ForwardDynamics<double> plant(arm.chain), plant_from_q(arm.chain);
      plant.place(arm.positions), plant_from_q.place(q);
      std::vector<double> T(size, 1.0), qdd(size), qdd_from_q(size);
      plant.move(qd);
      plant.accelerations(T, {}, qdd);
      plant_from_q.accelerations(qd, T, {}, qdd_from_q);
      CHECK(qdd == qdd_from_q);
    }
}

TEST_CASE("columns from the tip agree with sweep 3 to rounding") {
  Worst Omega, both;
  for (int n = 1; n <= 12; ++n)
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const RandomArm arm = random_arm(seed, n);
      OperationalSpace<double> space(arm.chain), columns(arm.chain);
      space.place(arm.positions);
      columns.place(arm.positions);
      const std::span<const double> qd(arm.qd.data(), static_cast<std::size_t>(n));
      space.sweep(qd);
      columns.sweep_from_tip(qd);
      const std::string which = "random_arm(" + std::to_string(seed) + ", " + std::to_string(n) + ")";
      // An entry of Omega may be as large as the roots of its diagonal; a right side is a sum of
      // accelerations.
      const auto expected = plain(space.Omega());
      const Vector6<double> root = expected.diagonal().cwiseSqrt(), right = plain(space.right_side());
      Omega.see((plain(columns.Omega()) - expected).cwiseAbs().maxCoeff(), root.maxCoeff() * root.maxCoeff(),
                which);
      both.see((plain(columns.right_side()) - right).cwiseAbs().maxCoeff(), right.cwiseAbs().maxCoeff(),
               which);
    }
  check_within("Omega", Omega, 13);               // seen 2.7
  check_within("right side of c + g", both, 25);  // seen 5.3
}

}  // namespace osculate::testing::column_form_tests
