// How far rounding takes the recursions: from the dense reference, and from the tip acceleration that was
// commanded. Tolerances are a constant times eps times a scale that is stated; the constant is at most 5
// times the worst seen.
#include "recursion/law_arms.hpp"

namespace osculate::testing::rounding_tests {

TEST_CASE("the recursions agree with the dense reference to rounding, whatever the condition of Omega") {
  Worst Omega, c, g, both, qdd, tip;
  for_arms([&](Case t) {
    const Sides s = sides_of(t.arm);
    const Sizes size(t.arm);
    const auto task = dense::mobility(size.x.tip, size.x.joint);
    Omega.see_each(s.Omega - task.Omega, entry_scale(s.Omega), t.which);
    c.see_each(s.c - (task.J_Minv_C - task.Jdot_qd), size.right_side_c(), t.which);
    g.see_each(s.g - task.J_Minv_G, size.right_side_g(), t.which);
    both.see_each(s.both - (task.J_Minv_C - task.Jdot_qd + task.J_Minv_G),
                  (size.right_side_c() + size.right_side_g()), t.which);
    const Vector T = uniform(t.random, t.n, 20);
    const Vector F_ext = uniform(t.random, 6, 20);
    const Motions m = motions_of(t.arm, T, F_ext);
    const Vector expected = dense::forward_dynamics<double>(size.x.joint, size.x.tip.J, T, F_ext);
    const Vector scale = size.accelerations(T, F_ext);
    qdd.see_each(m.qdd - expected, scale, t.which);
    tip.see_each(m.tip - Vector(size.x.tip.J * expected + size.x.tip.Jdot_qd), (size.J() * scale + size.tip),
                 t.which);
  });
  check_within("Omega", Omega, 40);               // seen 8.4
  check_within("right side of c", c, 3.5);        // seen 0.74
  check_within("right side of g", g, 30);         // seen 6.1
  check_within("right side of c + g", both, 18);  // seen 3.6
  check_within("qdd", qdd, 4.5);                  // seen 0.93
  check_within("tip acceleration", tip, 50);      // seen 11
}

TEST_CASE("the tip accelerates as commanded; held by gravity's force alone, an arm at rest stays at rest") {
  // F itself grows with the condition of Omega.
  Worst commanded, held;
  for_arms([&](Case t) {
    const Sizes size(t.arm);
    const bool at_rest = t.arm.qd.isZero(0);
    OperationalSpace<double> space(t.arm.chain);
    space.place(t.arm.positions);
    space.sweep(span_of(t.arm.qd));
    const TaskRows rows = regular_rows(plain(space.Omega()));
    const int m = static_cast<int>(rows.size());
    const TaskFactor<double> factor(space.Omega(), rows);
    for (const double range : {5.0, 0.0}) {
      if (range == 0 && !at_rest) continue;
      const Vector u = uniform(t.random, m, range);
      TaskVector<double> right = restricted(space.right_side(), rows);
      for (int i = 0; i < m; ++i) right[static_cast<std::size_t>(i)] += u[i];
      const auto F = wrench(factor.solve(right), rows);
      Vector T(t.n);
      space.torques(F, span_of(T));
      const Vector got = motions_of(t.arm, T, Vector::Zero(6)).tip(rows);
      const Vector scale = size.commanded(plain(F))(rows);
      (range == 0 ? held : commanded).see_each(got - u, scale, t.which);
    }
  });
  check_within("tip acceleration - u", commanded, 0.7);         // seen 0.15
  check_within("tip acceleration of the held arm", held, 0.7);  // seen 0.15
}

TEST_CASE("an arm of 60 joints agrees with the dense reference, one of 1000 obeys its own command") {
  Worst Omega, both, qdd, commanded;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const RandomArm arm = random_arm(seed, 60);
    INFO("random_arm(" << seed << ", 60)");
    const Sides s = sides_of(arm);
    const Sizes size(arm);
    const auto task = dense::mobility(size.x.tip, size.x.joint);
    const std::string which = "seed " + std::to_string(seed);
    Omega.see_each(s.Omega - task.Omega, entry_scale(s.Omega), which);
    both.see_each(s.both - (task.J_Minv_C - task.Jdot_qd + task.J_Minv_G),
                  Vector::Constant(6, s.both.cwiseAbs().maxCoeff()), which);
    Random random(seed);
    const Vector T = uniform(random, 60, 20);
    const Vector F_ext = uniform(random, 6, 20);
    const Vector expected = dense::forward_dynamics<double>(size.x.joint, size.x.tip.J, T, F_ext);
    qdd.see_each(motions_of(arm, T, F_ext).qdd - expected,
                 size.Minv * size.x.joint.M.cwiseAbs() * expected.cwiseAbs(), which);
  }
  for (unsigned seed = 1; seed <= 3; ++seed) {
    RandomArm arm = random_arm(seed, 1000);
    arm.qd *= 0.01;  // so that the tip does not outrun everything else
    INFO("random_arm(" << seed << ", 1000)");
    OperationalSpace<double> space(arm.chain);
    space.place(arm.positions);
    space.sweep(span_of(arm.qd));
    for (int k = 1; k <= 1000; ++k) CHECK(space.articulated_joint_inertia(k).d > 0);
    Random random(seed);
    const Vector u = uniform(random, 6, 5);
    TaskVector<double> right = restricted(space.right_side(), all_rows());
    double terms = u.norm();
    for (std::size_t i = 0; i < 6; ++i)
      terms = std::max(terms, std::abs(right[i])), right[i] += u[static_cast<int>(i)];
    const auto F = wrench(TaskFactor<double>(space.Omega(), all_rows()).solve(right), all_rows());
    Vector T(1000);
    space.torques(F, span_of(T));
    const Vector got = motions_of(arm, T, Vector::Zero(6)).tip;
    const Vector scale = plain(space.Omega()).cwiseAbs() * plain(F).cwiseAbs() + Vector::Constant(6, terms);
    commanded.see_each(got - u, scale, "seed " + std::to_string(seed));
  }
  check_within("Omega at 60", Omega, 34);                        // seen 7.0
  check_within("right side of c + g at 60", both, 230);          // seen 47
  check_within("qdd at 60", qdd, 0.9);                           // seen 0.19
  check_within("tip acceleration - u at 1000", commanded, 1.2);  // seen 0.26
}

}  // namespace osculate::testing::rounding_tests
