// Laws that the recursions obey on random arms over doubles: generic, nearly singular and at rest, 1 to 12
// joints. Tolerances are a constant times eps times a scale that is stated; the constant is at most 5 times
// the worst seen.
#include "recursion/law_arms.hpp"

namespace osculate::testing::laws_tests {

namespace {

/// The same arm on a base that is turned by R and moved by p; gravity turns with it.
RandomArm turned_arm(RandomArm arm, const Matrix3<double>& R, const Vector3<double>& p) {
  Link<double>& first = arm.chain.links.front();
  first.R_origin = R * first.R_origin;
  first.p_origin = p + R * first.p_origin;
  arm.chain.gravity = R * arm.chain.gravity;
  return arm;
}

}  // namespace

TEST_CASE("Omega is positive semidefinite, Lambda symmetric, every D(k) positive") {
  Worst negative, skewness;
  double hardest = 0;
  for_arms([&](Case t) {
    const Sides s = sides_of(t.arm);
    CHECK(s.D.minCoeff() > 0);
    // Rounding in Omega is relative to the largest entry of its block, angular or linear (docs/claims.md).
    Vector d(6);
    d << Vector::Constant(3, 1 / std::sqrt(s.Omega.diagonal().head(3).maxCoeff())),
        Vector::Constant(3, 1 / std::sqrt(s.Omega.diagonal().tail(3).maxCoeff()));
    const Matrix scaled = d.asDiagonal() * s.Omega * d.asDiagonal();
    const double least = eigenvalues(scaled)[0];
    negative.see(std::max(0.0, -least), 1, t.which);

    const TaskRows rows = regular_rows(s.Omega);
    const int m = static_cast<int>(rows.size());
    CHECK(m >= 1);
    const double cond = condition(s.Omega(rows, rows));
    hardest = std::max(hardest, cond);
    OperationalSpace<double> space(t.arm.chain);
    space.place(t.arm.positions);
    space.sweep(span_of(t.arm.qd));
    const TaskFactor<double> factor(space.Omega(), rows);
    Matrix Lambda(m, m);
    for (int i = 0; i < m; ++i) {
      CHECK(factor.pivots()[static_cast<std::size_t>(i)] > 0);
      TaskVector<double> unit{};
      unit[static_cast<std::size_t>(i)] = 1;
      Lambda.col(i) = Eigen::Map<const Vector>(factor.solve(unit).data(), m);
    }
    const Vector root = Lambda.diagonal().cwiseSqrt();
    skewness.see_each(Lambda - Lambda.transpose(), cond * root * root.transpose(), t.which);
  });
  CHECK(hardest > 1e7);
  check_within("negative eigenvalue of the scaled Omega", negative, 30);  // seen 6.9
  check_within("Lambda - Lambda^T", skewness, 0.7);                       // seen 0.15
}

TEST_CASE("g follows gravity, c is even and quadratic in the rates: to the bit, and at rest there is no c") {
  Worst threefold;
  for_arms([&](Case t) {
    const Sides s = sides_of(t.arm);
    RandomArm other = t.arm;
    other.chain.gravity = -t.arm.chain.gravity;
    const Sides flipped = sides_of(other);
    CHECK(flipped.g == -s.g);
    CHECK(flipped.c == s.c);
    CHECK(flipped.Omega == s.Omega);

    other = t.arm;
    other.qd = -t.arm.qd;
    const Sides reversed = sides_of(other);
    CHECK(reversed.c == s.c);
    CHECK(reversed.both == s.both);
    CHECK(reversed.g == s.g);

    other.qd = 2 * t.arm.qd;  // a power of two does not round
    CHECK(sides_of(other).c == 4 * s.c);
    other.qd = 3 * t.arm.qd;
    const Vector error = sides_of(other).c - 9 * s.c;
    threefold.see_each(error, 9 * Sizes(t.arm).right_side_c(), t.which);
    if (t.arm.qd.isZero(0)) CHECK(s.c.isZero(0));
  });
  check_within("c at three times the rates", threefold, 1.9);  // seen 0.39
}

TEST_CASE("repeated calls give identical bits, whatever was computed in between") {
  for_arms([](Case t) {
    OperationalSpace<double> space(t.arm.chain);
    const Sides first = sides_of(space, t.arm);
    RandomArm elsewhere = random_arm(99, t.n);
    elsewhere.chain = t.arm.chain;
    elsewhere.positions = positions<double>(t.arm.chain, span_of(std::as_const(elsewhere.q)));
    const Sides other = sides_of(space, elsewhere);
    CHECK(!same_bits(first, other));
    CHECK(same_bits(first, sides_of(space, t.arm)));
    CHECK(same_bits(first, sides_of(t.arm)));
    const Vector T = uniform(t.random, t.n, 20);
    const Vector F_ext = uniform(t.random, 6, 20);
    const Motions m = motions_of(t.arm, T, F_ext), again = motions_of(t.arm, T, F_ext);
    CHECK((m.qdd == again.qdd && m.tip == again.tip));
  });
}

TEST_CASE("turning and moving the base turns the numbers and nothing else") {
  Worst Omega, both, qdd, tip;
  for_arms([&](Case t) {
    const Matrix3<double> R = t.random.rotation_matrix();
    const RandomArm other = turned_arm(t.arm, R, t.random.uniform(0, 3) * t.random.direction());
    Matrix turn = Matrix::Zero(6, 6);
    turn.topLeftCorner<3, 3>() = R;
    turn.bottomRightCorner<3, 3>() = R;
    const Sides a = sides_of(t.arm), b = sides_of(other);
    const Sizes size(t.arm);
    Omega.see_each(b.Omega - turn * a.Omega * turn.transpose(), entry_scale(a.Omega), t.which);
    const Vector right = size.right_side_c() + size.right_side_g();
    both.see((b.both - turn * a.both).norm(), right.norm(), t.which);
    const Vector T = uniform(t.random, t.n, 20);
    const Vector F_ext = uniform(t.random, 6, 20);
    const Motions m = motions_of(t.arm, T, F_ext), moved = motions_of(other, T, turn * F_ext);
    const Vector scale = size.accelerations(T, F_ext);
    qdd.see_each(moved.qdd - m.qdd, scale, t.which);
    tip.see((moved.tip - turn * m.tip).norm(), (size.J() * scale + size.tip).norm(), t.which);
  });
  check_within("Omega", Omega, 50);              // seen 12
  check_within("right side of c + g", both, 4);  // seen 0.83
  check_within("qdd", qdd, 7);                   // seen 1.5
  check_within("tip acceleration", tip, 5.5);    // seen 1.2
}

TEST_CASE("the energy of links and rotors grows by the power that is put in") {
  // dE/dt along the motion by dual numbers: q' = qd, qd' = qdd. Scale: |qd| |M| |qdd| and the terms of qd .
  // (C + G).
  Worst power;
  for_arms([&](Case t) {
    using D = Dual<double>;
    const Vector T = uniform(t.random, t.n, 20);
    const Vector F_ext = uniform(t.random, 6, 20);
    const Motions m = motions_of(t.arm, T, F_ext);
    ForwardDynamics<D> plant(cast<D>(t.arm.chain));
    plant.place(dense::moving(t.arm.chain, t.arm.positions, t.arm.qd));
    std::vector<D> qd, torque, unused(static_cast<std::size_t>(t.n));
    for (int i = 0; i < t.n; ++i) qd.push_back({t.arm.qd[i], m.qdd[i]}), torque.push_back(T[i]);
    plant.accelerations(qd, torque, {}, unused);
    const D energy = plant.kinetic_energy(qd) + plant.potential_energy();
    const Sizes size(t.arm);
    const double input = T.dot(t.arm.qd) + F_ext.dot(size.x.tip.tip_velocity);
    const Vector rates = t.arm.qd.cwiseAbs();
    const double scale = rates.dot(size.x.joint.M.cwiseAbs() * size.accelerations(T, F_ext));
    if (scale == 0)
      CHECK(energy.derivative == 0);  // at rest no power flows
    else
      power.see(std::abs(energy.derivative - input), scale, t.which);
  });
  check_within("power", power, 4);  // seen 0.84
}

TEST_CASE("a link in a chain is never more mobile than when free") {
  // Omega(0) <= phi*(1,0) M(1)^-1 phi(1,0); the free link's compliance from its centre of mass.
  Worst excess;
  for_arms([&](Case t) {
    for (const bool with_armature : {true, false}) {
      RandomArm arm = t.arm;
      if (!with_armature)
        for (auto& link : arm.chain.links) link.armature = 0;
      const Sides s = sides_of(arm);
      const auto x = dense::kinematics(arm.chain, arm.positions, arm.qd);
      const Link<double>& body = arm.chain.links.back();
      const Matrix3<double> R = x.R * arm.chain.R_tip.transpose();
      Matrix free = Matrix::Zero(6, 6), shift = Matrix::Identity(6, 6);
      free.topLeftCorner<3, 3>() = R * body.inertia.inverse() * R.transpose();
      free.bottomRightCorner<3, 3>() = Matrix3<double>::Identity() / body.mass;
      shift.topRightCorner<3, 3>() = skew<double>(R * (arm.chain.p_tip - body.com));
      free = (shift.transpose() * free * shift).eval();
      const Vector d = row_scale(free).cwiseInverse();
      const Matrix margin = d.asDiagonal() * (free - s.Omega) * d.asDiagonal();
      const double least = eigenvalues(margin)[0];
      excess.see(std::max(0.0, -least), 1, t.which);
      if (t.n == 1) CHECK(margin.norm() > 1e-3);  // a joint holds it, so the bound is not met with equality
    }
  });
  check_within("Omega above the bound", excess, 19);  // seen 4.0
}

}  // namespace osculate::testing::laws_tests
