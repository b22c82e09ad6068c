// Over exact fractions the recursions equal the definitions: no tolerance anywhere in this file.
#include <span>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "reference/dense.hpp"
#include "spatial/plain.hpp"
#include "support/catch.hpp"

namespace osculate::testing::exact_tests {
using osculate::exact_arm;
using osculate::ExactArm;
using osculate::Random;
using osculate::testing::as;
using osculate::testing::plain;
using osculate::testing::skew;
using osculate::testing::Vector6;
using Q = Rational;
using Vector = VectorX<Q>;
using Matrix = MatrixX<Q>;

namespace {

std::span<const Q> span_of(const Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }
std::span<Q> span_of(Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

Vector fractions(Random& random, int n) {
  Vector out(n);
  for (Q& x : out) x = random.fraction(8, 2);
  return out;
}
TaskVector<Q> task_vector(const Vector& v) {
  TaskVector<Q> out{};
  for (int i = 0; i < v.size(); ++i) out[static_cast<std::size_t>(i)] = v[i];
  return out;
}
Vector plain(const TaskVector<Q>& v, const TaskRows& rows) {
  return Eigen::Map<const Vector>(v.data(), static_cast<int>(rows.size()));
}
Vector operator+(const Vector& a, const TaskVector<Q>& b) {
  return a + Eigen::Map<const Vector>(b.data(), a.size());
}

/// As many rows as Omega has rank, by adding those whose pivot is not zero.
TaskRows independent_rows(const Compliance<Q>& Omega) {
  TaskRows rows;
  for (int row = 0; row < 6; ++row) {
    rows.push_back(row);
    if (TaskFactor<Q>(Omega, rows).pivots()[rows.size() - 1] == Q(0)) rows.pop_back();
  }
  return rows;
}

/// The recursions' inverse of Omega on the rows, a column at a time.
Matrix Lambda_of(const TaskFactor<Q>& factor, const TaskRows& rows) {
  const int m = static_cast<int>(rows.size());
  Matrix out(m, m);
  for (int i = 0; i < m; ++i) out.col(i) = plain(factor.solve(task_vector(Vector::Unit(m, i))), rows);
  return out;
}

template <class Check>
void for_arms(int n_from, int n_to, unsigned seeds, Check check) {
  for (int n = n_from; n <= n_to; ++n)
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      INFO("exact_arm(" << seed << ", " << n << ")");
      Random random(seed);
      check(exact_arm(seed, n), random);
    }
}

}  // namespace

TEST_CASE("the four sweeps are the definitions: Omega, Lambda, c, g, c + g, F, T") {
  int of_full_rank = 0;
  for_arms(1, 6, 20, [&](const ExactArm& arm, Random& random) {
    const int n = arm.chain.n();
    const auto x = dense::state(arm.chain, arm.positions, arm.qd);
    OperationalSpace<Q> space(arm.chain);
    space.place(arm.positions);
    space.sweep(span_of(arm.qd));
    const Vec<Motion, Q> both = space.right_side(), of_g = space.right_side_of_g();
    const Compliance<Q> Omega = space.Omega();
    for (int k = 1; k <= n; ++k) CHECK(space.articulated_joint_inertia(k).d > Q(0));
    CHECK(plain(space.tip_rotation()) == x.tip.R);
    CHECK(plain(space.tip_position()) == x.tip.p);
    CHECK(plain(space.tip_velocity()) == x.tip.tip_velocity);
    CHECK(plain(Omega) == dense::mobility(x.tip, x.joint).Omega);  // (11), (58), (60)

    const TaskRows rows = independent_rows(Omega);
    if (static_cast<int>(rows.size()) == std::min(n, 6)) ++of_full_rank;
    const auto task = dense::mobility(x.tip, x.joint, rows);
    const auto terms = dense::task_terms(task);
    const TaskFactor<Q> factor(Omega, rows);
    const Vector u = fractions(random, static_cast<int>(rows.size()));
    const auto command = dense::task_force(task, terms, u);
    CHECK(Lambda_of(factor, rows) == terms.Lambda);                                 // (12), (61)
    CHECK(plain(factor.solve(restricted(both, rows)), rows) == terms.c + terms.g);  // section 4.3, corrected
    CHECK(plain(factor.solve(restricted(of_g, rows)), rows) == terms.g);            // (15), (72)
    const auto F = factor.solve(task_vector(u + restricted(both, rows)));
    CHECK(plain(F, rows) == command.F);  // (4)
    Vector T(n);
    space.torques(wrench(F, rows), span_of(T));
    CHECK(T == command.T);  // (16), (39)
    const Vec<Motion, Q> of_c = space.right_side_of_c(span_of(arm.qd));
    CHECK(plain(factor.solve(restricted(of_c, rows)), rows) == terms.c);  // (14), (65)
  });
  CHECK(of_full_rank >= 100);  // of 120
}

TEST_CASE("the operator inverse of the mass matrix is M^-1: joint and tip accelerations, energies") {
  for_arms(1, 6, 20, [](const ExactArm& arm, Random& random) {
    const int n = arm.chain.n();
    const auto x = dense::state(arm.chain, arm.positions, arm.qd);
    const Vector T = fractions(random, n);
    const Vector6<Q> F_ext = fractions(random, 6);
    const Vector qdd = dense::forward_dynamics<Q>(x.joint, x.tip.J, T, F_ext);
    ForwardDynamics<Q> plant(arm.chain);
    plant.place(arm.positions);
    Vector accelerations(n);
    plant.accelerations(span_of(arm.qd), span_of(T), as<Force>(F_ext), span_of(accelerations));
    CHECK(accelerations == qdd);                                                          // (6), (51)
    CHECK(plain(plant.tip_velocity()) == x.tip.tip_velocity);                             // (7)
    CHECK(plain(plant.tip_acceleration()) == Vector6<Q>(x.tip.J * qdd + x.tip.Jdot_qd));  // (8)
    CHECK(plant.kinetic_energy(span_of(arm.qd)) == dense::kinetic_energy(x.joint, arm.qd));
    CHECK(plant.potential_energy() == dense::potential_energy(arm.chain, arm.positions));
  });
}

TEST_CASE("the torque of the sweeps accelerates the tip as commanded, in every independent row") {
  for_arms(1, 6, 5, [](const ExactArm& arm, Random& random) {
    const int n = arm.chain.n();
    OperationalSpace<Q> space(arm.chain);
    space.place(arm.positions);
    space.sweep(span_of(arm.qd));
    const TaskRows rows = independent_rows(space.Omega());
    const Vector u = fractions(random, static_cast<int>(rows.size()));
    const auto F =
        TaskFactor<Q>(space.Omega(), rows).solve(task_vector(u + restricted(space.right_side(), rows)));
    Vector T(n), qdd(n);
    space.torques(wrench(F, rows), span_of(T));
    ForwardDynamics<Q> plant(arm.chain);
    plant.place(arm.positions);
    plant.accelerations(span_of(arm.qd), span_of(T), {}, span_of(qdd));
    CHECK(plain(restricted(plant.tip_acceleration(), rows), rows) == u);  // (5)
  });
}

TEST_CASE("section 4.3 as printed, without a_g on the right of (68), is wrong by exactly Lambda a_g") {
  for_arms(1, 6, 5, [](const ExactArm& arm, Random&) {
    const int n = arm.chain.n();
    const ArmBuilder<Q> builder(arm.chain);
    Arm<Q> placed = builder.arm();
    builder.place(arm.positions, placed);
    Passes<Hinge<Q>> x(n);
    sweep_velocities(placed, TipFirst<Q>{arm.qd.data(), n}, builder.ground(), x);
    sweep_articulated(placed, x, builder.ground(), {}, x);  // a(n) + phi*(n+1,n) a_g
    sweep_compliance(placed, builder.ground(), {}, x);      // nothing added at the tip
    const TaskRows rows = independent_rows(x.Omega0);
    const TaskFactor<Q> factor(x.Omega0, rows);
    const Vector printed = plain(factor.solve(restricted(x.eta0, rows)), rows);

    const auto state = dense::state(arm.chain, arm.positions, arm.qd);
    const auto terms = dense::task_terms(dense::mobility(state.tip, state.joint, rows));
    const Vector error = terms.c + terms.g - printed;
    const Vector a_g = plain(restricted(builder.a_g(), rows), rows);
    CHECK(error == terms.Lambda * a_g);
    CHECK((error.isZero(0)) == (a_g.isZero(0)));  // rows that gravity does not reach are the only ones spared
    if (n == 6) CHECK(!error.isZero(0));
  });
}

TEST_CASE(
    "joint torques known beforehand move the arm within itself and leave the tip's acceleration alone") {
  for_arms(7, 7, 3, [](const ExactArm& arm, Random& random) {
    const int n = arm.chain.n();
    OperationalSpace<Q> space(arm.chain);
    ForwardDynamics<Q> plant(arm.chain);
    space.place(arm.positions);
    plant.place(arm.positions);
    const Vector u = fractions(random, 6), T0 = fractions(random, n);
    const auto reached = [&](std::span<const Q> beforehand) {
      space.sweep(span_of(arm.qd), beforehand);
      const TaskFactor<Q> factor(space.Omega(), all_rows());
      const auto F = factor.solve(task_vector(u + restricted(space.right_side(), all_rows())));
      Vector T(n), qdd(n);
      space.torques(wrench(F, all_rows()), span_of(T));
      plant.accelerations(span_of(arm.qd), span_of(T), {}, span_of(qdd));
      CHECK(plain(plant.tip_acceleration()) == u);
      return qdd;
    };
    CHECK(reached({}) != reached(span_of(T0)));
  });
}

TEST_CASE("a single free body: six joints on massless links do not show") {
  // Closed form: Lambda is the body's inertia about the tip, c = (w x I w; m w x (w x p)), g = -(p x m gamma;
  // m gamma) with p from the tip to the centre of mass and gamma the acceleration of free fall.
  for (unsigned seed = 1; seed <= 10; ++seed) {
    INFO("seed " << seed);
    Random random(seed);
    ExactArm arm = exact_arm(seed, 6);
    for (int i = 0; i < 6; ++i) {
      Link<Q>& link = arm.chain.links[static_cast<std::size_t>(i)];
      JointPosition<Q>& q = arm.positions[static_cast<std::size_t>(i)];
      link.type = i < 3 ? JointType::prismatic : JointType::revolute;
      link.R_origin = Matrix3<Q>::Identity();
      link.p_origin = Vector3<Q>::Zero();
      link.axis = Vector3<Q>::Unit(i % 3);
      link.armature = Q(0);
      if (i < 5) link.mass = Q(0), link.inertia.setZero();
      q = i < 3 ? JointPosition<Q>{Q(1), Q(0), random.fraction(4, 2)}
                : JointPosition<Q>{Q(4, 5), Q(3, 5), Q(0)};
    }
    OperationalSpace<Q> space(arm.chain);
    space.place(arm.positions);
    space.sweep(span_of(arm.qd));
    const TaskFactor<Q> factor(space.Omega(), all_rows());
    const Vector g = plain(factor.solve(restricted(space.right_side_of_g(), all_rows())), all_rows());
    const Vector c =
        plain(factor.solve(restricted(space.right_side_of_c(span_of(arm.qd)), all_rows())), all_rows());

    const Link<Q>& body = arm.chain.links.back();
    const Matrix3<Q> R = plain(space.tip_rotation()) * arm.chain.R_tip.transpose();  // body axes
    const Vector3<Q> p = R * (body.com - arm.chain.p_tip), w = plain(space.tip_velocity().ang);
    const Q m = body.mass;
    const Matrix3<Q> I = R * body.inertia * R.transpose() - m * skew(p) * skew(p);
    Matrix Lambda(6, 6);
    Lambda << I, m * skew(p), -m * skew(p), m * Matrix3<Q>::Identity();
    Vector6<Q> c_body, g_body;
    c_body << w.cross(I * w), m * w.cross(w.cross(p));
    g_body << -p.cross(m * arm.chain.gravity), -m * arm.chain.gravity;
    CHECK(Lambda_of(factor, all_rows()) == Lambda);
    CHECK(c == c_body);
    CHECK(g == g_body);
  }
}

TEST_CASE("a bead on a turning rod: the sliding joint feels 2 w x h qd") {
  // Polar coordinates: (J1 + I + m r^2) th'' + 2 m r r' th' = T and (m + J2) r'' - m r th'^2 = f; the tip is
  // the bead.
  const Q m(3), I(1, 4), J1(1, 2), J2(2), r(5, 3), th_rate(7, 2), r_rate(-4, 3), T(11), f(5);
  Chain<Q> chain;
  Link<Q> rod, bead;
  rod.armature = J1;
  bead.type = JointType::prismatic;
  bead.axis = Vector3<Q>::UnitX();
  bead.mass = m;
  bead.inertia = I * Matrix3<Q>::Identity();
  bead.armature = J2;
  chain.links = {rod, bead};
  ForwardDynamics<Q> plant(chain);
  plant.place({{Q(1), Q(0), Q(0)}, {Q(1), Q(0), r}});
  const Vector qd{{th_rate, r_rate}}, torque{{T, f}};
  Vector qdd(2);
  plant.accelerations(span_of(qd), span_of(torque), {}, span_of(qdd));
  CHECK(qdd[0] == (T - Q(2) * m * r * r_rate * th_rate) / (J1 + I + m * r * r));
  CHECK(qdd[1] == (f + m * r * th_rate * th_rate) / (m + J2));
  CHECK(plant.tip_acceleration().lin.x == qdd[1] - r * th_rate * th_rate);
  CHECK(plant.tip_acceleration().lin.y == r * qdd[0] + Q(2) * th_rate * r_rate);
}

}  // namespace osculate::testing::exact_tests
