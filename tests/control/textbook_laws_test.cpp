// Each law against the recursions, against its equation with explicit inverses, and by what the tip does.
// Errors are counted in eps times the condition of what is inverted times the sizes of the terms that are
// summed; the factor allowed is at most 5 times the worst that was seen.
#include "control/textbook_laws.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "control/quick_arm.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/worst.hpp"
#include "reference/conditioning.hpp"
#include "reference/dense.hpp"
#include "spatial/plain.hpp"
#include "support/catch.hpp"

namespace osculate::testing::textbook_laws_tests {
using osculate::test::Draw;
using osculate::test::quick_arm;
using osculate::test::QuickArm;

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

std::span<const double> span_of(const Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }
std::span<double> span_of(Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

/// Of a positive definite matrix, by elimination down and up (Gauss and Jordan).
Matrix inverse(Matrix A) {
  const Eigen::Index n = A.rows();
  Matrix out = Matrix::Identity(n, n);
  for (Eigen::Index p = 0; p < n; ++p) {
    const double pivot = A(p, p);
    for (Eigen::Index j = 0; j < n; ++j) A(p, j) /= pivot, out(p, j) /= pivot;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == p) continue;
      const double factor = A(i, p);
      for (Eigen::Index j = 0; j < n; ++j) A(i, j) -= factor * A(p, j), out(i, j) -= factor * out(p, j);
    }
  }
  return out;
}
Matrix transposed(const Matrix& A) { return A.transpose(); }
Matrix product(const Matrix& A, const Matrix& B) { return A * B; }
Vector product(const Matrix& A, const Vector& x) { return A * x; }
Matrix size(const Matrix& A) { return A.cwiseAbs(); }
Vector size(const Vector& x) { return x.cwiseAbs(); }

/// An arm, a task and what the law is told, with the dense terms and explicit inverses.
struct Problem {
  QuickArm arm;
  TaskRows rows;
  BaseMotion<double> base;
  Vector u, T0, B, F_known;
  std::string which;

  Matrix M, J, Jt, Omega, Minv, Lambda, blocks;
  Matrix pinv;        // J^+
  Matrix JMinv, JtL;  // J M^-1, J* Lambda
  Matrix dynamic;     // 1 - J* Lambda J M^-1
  Matrix kinematic;   // 1 - J* J*^+
  Vector C, G, Jdot_qd;
  Vector known;  // J* F_known of all rows
  double condition;
  Vector torque_size, tip_size;  // of the terms that are summed

  Vector torque(TextbookLaw law) const {
    Vector T = Vector::Constant(M.rows(), -77);
    CHECK(textbook_torque(law, arm.chain, arm.positions, base, span_of(arm.qd), rows, span_of(u), span_of(T0),
                          as<Force, double>(F_known), span_of(B), span_of(T)));
    return T;
  }
  /// Acceleration of the task rows under T and the known wrench, by (6) and (8).
  Vector tip_acceleration(const Vector& T) const {
    const Vector forces = T - C - G + known;
    return product(JMinv, forces) + Jdot_qd;
  }
};

Problem problem(unsigned seed, int n, const TaskRows& rows, bool moving_base, bool wrench) {
  Problem p;
  p.arm = quick_arm(seed, n);
  p.rows = rows;
  Draw draw(seed + 100);
  const auto m = static_cast<Eigen::Index>(rows.size());
  p.u = draw.vector(m, 3);
  p.T0 = draw.vector(n, 10);
  p.B = draw.vector(m, 2);
  p.F_known = draw.vector(6, wrench ? 20 : 0);
  if (moving_base) {
    p.base.R = draw.turn();
    p.base.p = draw(0, 2) * draw.direction();
    p.base.velocity = draw.vector(6, 1);
    p.base.acceleration = draw.vector(6, 2);
  }
  p.which = p.arm.name + ", base " + std::to_string(moving_base) + ", wrench " + std::to_string(wrench) +
            ", rows " + std::to_string(m);
  const auto x = dense::state(p.arm.chain, p.arm.positions, p.arm.qd, p.base);
  p.M = x.joint.M, p.C = x.joint.C, p.G = x.joint.G;
  p.J.resize(m, n), p.Jdot_qd.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    p.J.row(i) = x.tip.J.row(row), p.Jdot_qd[i] = x.tip.Jdot_qd[row];
  }
  p.known = product(transposed(x.tip.J), p.F_known);
  p.Jt = transposed(p.J);
  p.Minv = inverse(p.M);
  p.JMinv = product(p.J, p.Minv);
  p.Omega = product(p.JMinv, p.Jt);
  p.Lambda = inverse(p.Omega);
  p.JtL = product(p.Jt, p.Lambda);
  const Matrix JJt = product(p.J, p.Jt);
  p.pinv = product(p.Jt, inverse(JJt));
  p.dynamic = Matrix::Identity(n, n) - product(p.JtL, p.JMinv);
  p.kinematic = Matrix::Identity(n, n) - product(p.pinv, p.J);
  const auto turning = std::count_if(rows.begin(), rows.end(), [](int row) { return row < 3; });
  const auto sliding = m - turning;
  p.blocks = Matrix::Zero(m, m);
  p.blocks.topLeftCorner(turning, turning) = inverse(p.Omega.topLeftCorner(turning, turning));
  p.blocks.bottomRightCorner(sliding, sliding) = inverse(p.Omega.bottomRightCorner(sliding, sliding));

  p.condition = scaled_condition(p.M) * std::max(scaled_condition(p.Omega), scaled_condition(JJt));
  const Vector joints = size(p.C) + size(p.G) + size(p.T0) + size(p.known);
  const Vector inside = size(p.u) + size(p.Jdot_qd) + product(size(p.J), product(size(p.Minv), joints));
  p.torque_size = joints + product(size(p.Jt), product(size(p.Lambda), inside)) +
                  product(size(p.M), product(size(p.pinv), inside));
  p.tip_size = size(p.Jdot_qd) + product(size(p.J), product(size(p.Minv), p.torque_size));
  return p;
}

/// Square and redundant arms, all rows and fewer, on a base at rest and moving, with and without a wrench.
/// Arms that are worse than 1e6 are left out: nothing of the laws is tested by the rounding of their
/// inverses.
template <class Check>
void for_problems(Check check) {
  int seen = 0;
  for (const auto& [n, rows] : std::vector<std::pair<int, TaskRows>>{
           {6, all_rows()}, {7, all_rows()}, {9, all_rows()}, {3, {3, 4, 5}}, {7, {3, 4, 5}}, {6, {0, 2, 5}}})
    for (unsigned seed = 1; seed <= 6; ++seed)
      for (const bool moving_base : {false, true})
        for (const bool wrench : {false, true}) {
          const Problem p = problem(seed, n, rows, moving_base, wrench);
          if (!(p.condition <= 1e6)) continue;
          INFO(p.which);
          check(p);
          ++seen;
        }
  CHECK(seen >= 100);
}

Vector recursive_torque(const Problem& p) {
  OperationalSpace<double> space(p.arm.chain);
  space.move_base(p.base);
  space.place(p.arm.positions);
  space.sweep(span_of(p.arm.qd), span_of(p.T0), as<Force, double>(p.F_known));
  TaskVector<double> right = restricted(space.right_side(), p.rows);
  for (std::size_t i = 0; i < p.rows.size(); ++i) right[i] += p.u[static_cast<Eigen::Index>(i)];
  const TaskFactor<double> factor(space.Omega(), p.rows);
  Vector T(p.M.rows());
  space.torques(wrench(factor.solve(right), p.rows), span_of(T));
  return T;
}

}  // namespace

TEST_CASE("the dense law is the law of the recursions") {
  Worst worst;
  for_problems([&](const Problem& p) {
    // A known wrench is taken away at the joints here and within F there: the difference moves joints only.
    const Vector expected = recursive_torque(p) - product(p.dynamic, p.known);
    worst.see_each(p.torque(TextbookLaw::dense) - expected, p.condition * p.torque_size, p.which);
  });
  check_within("dense law", worst, 0.05);  // seen 0.011
}

TEST_CASE("each law is its equation: the dense law without the terms that it omits") {
  std::array<Worst, 8> worst;
  std::array<double, 8> least;  // what is omitted, as a share of the torque
  least.fill(std::numeric_limits<double>::infinity());
  for_problems([&](const Problem& p) {
    const Vector full = p.torque(TextbookLaw::dense);
    const Vector c = product(p.JtL, product(p.JMinv, p.C));
    const Vector rate = product(p.JtL, p.Jdot_qd);
    const auto see = [&](TextbookLaw law, const Vector& omitted) {
      const auto i = static_cast<std::size_t>(law);
      const Vector error = p.torque(law) - full + omitted;
      worst[i].see_each(error, p.condition * p.torque_size, p.which);
      least[i] = std::min(least[i], omitted.norm() / full.norm());
    };
    see(TextbookLaw::no_jdot_qd, -rate);
    see(TextbookLaw::no_coriolis, c);
    see(TextbookLaw::gravity_only, c - rate - product(p.dynamic, p.G));
    const Matrix coupling = p.Lambda - p.blocks;
    const Vector bias = p.C + p.G;
    see(TextbookLaw::block_inertia, product(p.Jt, product(coupling, p.u)) - rate - product(p.dynamic, bias));
    const Matrix projectors = p.dynamic - p.kinematic;
    see(TextbookLaw::kinematic_null_space, product(projectors, p.T0));
    const Vector command = p.u - p.Jdot_qd;
    const Vector accelerated = product(p.M, product(p.pinv, command));
    see(TextbookLaw::pseudo_inverse, full - accelerated - bias - product(p.kinematic, p.T0) + p.known);
    const Vector scaled_command = p.B.cwiseProduct(p.u);
    see(TextbookLaw::jacobian_transpose, full - product(p.Jt, scaled_command) - p.G - p.T0 + p.known);
  });
  for (const TextbookLawInfo& law : textbook_laws()) {
    if (law.law == TextbookLaw::dense) continue;
    const auto i = static_cast<std::size_t>(law.law);
    check_within(law.name.data(), worst[i], 0.016);  // seen 0.0033
    // Without redundancy all projectors are zero, and one block alone is the whole of Lambda.
    const bool always = law.law == TextbookLaw::no_jdot_qd || law.law == TextbookLaw::no_coriolis ||
                        law.law == TextbookLaw::gravity_only || law.law == TextbookLaw::jacobian_transpose;
    INFO(law.name << " omits " << least[i]);
    if (always) CHECK(least[i] > 1e-3);
  }
}

TEST_CASE("what the tip does under each law") {
  std::array<Worst, 8> worst;
  double least_disturbance = std::numeric_limits<double>::infinity();
  for_problems([&](const Problem& p) {
    const Vector tip_of_C = product(p.JMinv, p.C);
    // T0 reaches the tip through the kinematic projector.
    const Vector disturbance = product(p.JMinv, product(p.kinematic, p.T0));
    const auto see = [&](const Problem& told, TextbookLaw law, const Vector& expected) {
      const Vector error = p.tip_acceleration(told.torque(law)) - expected;
      worst[static_cast<std::size_t>(law)].see_each(error, p.condition * p.tip_size, p.which);
    };
    see(p, TextbookLaw::dense, p.u);
    see(p, TextbookLaw::no_jdot_qd, p.u + p.Jdot_qd);
    see(p, TextbookLaw::no_coriolis, p.u - tip_of_C);
    see(p, TextbookLaw::gravity_only, p.u - tip_of_C + p.Jdot_qd);
    see(p, TextbookLaw::block_inertia, product(p.Omega, product(p.blocks, p.u)) + p.Jdot_qd);
    see(p, TextbookLaw::pseudo_inverse, p.u + disturbance);
    see(p, TextbookLaw::kinematic_null_space, p.u + disturbance);
    Problem still = p;
    still.T0.setZero();
    see(still, TextbookLaw::pseudo_inverse, p.u);
    if (p.M.rows() > p.J.rows()) least_disturbance = std::min(least_disturbance, disturbance.norm());
  });
  for (const TextbookLawInfo& law : textbook_laws())
    check_within(law.name.data(), worst[static_cast<std::size_t>(law.law)], 0.0026);  // seen 0.00054
  CHECK(least_disturbance > 1e-2);                                                    // rad/s^2, m/s^2
}

TEST_CASE("a singular task is refused, and the torque left alone") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    QuickArm arm = quick_arm(seed, 6);
    // The last two joints turn about one line, or about lines 1e-4 rad and m apart.
    Link<double>& last = arm.chain.links[5];
    last.type = arm.chain.links[4].type, last.axis = arm.chain.links[4].axis;
    last.R_origin.setIdentity(), last.p_origin.setZero();
    arm.place();
    const std::vector<double> six(6, 1.0);
    for (const TextbookLawInfo& law : textbook_laws()) {
      INFO("seed " << seed << ", " << law.name);
      std::vector<double> T(6, -77.0);
      const bool regular = textbook_torque(law.law, arm.chain, arm.positions, {}, span_of(arm.qd), all_rows(),
                                           six, six, {}, six, T);
      CHECK(regular == (law.law == TextbookLaw::jacobian_transpose));
      if (!regular) CHECK(T == std::vector<double>(6, -77.0));
    }
    CHECK_THROWS_AS(inertia_diagonal(arm.chain, arm.positions, all_rows()), std::domain_error);

    last.R_origin = rotation<double>({1, 0, 0}, std::cos(1e-4), std::sin(1e-4));
    last.p_origin = {0, 1e-4, 0};
    arm.place();
    std::vector<double> T(6, 0.0);
    CHECK(textbook_torque(TextbookLaw::dense, arm.chain, arm.positions, {}, span_of(arm.qd), all_rows(), six,
                          six, {}, {}, T));
  }
}

TEST_CASE("the diagonal of Lambda") {
  Worst worst;
  for_problems([&](const Problem& p) {
    const std::vector<double> B = inertia_diagonal(p.arm.chain, p.arm.positions, p.rows, p.base);
    REQUIRE(B.size() == p.rows.size());
    const Vector got = Eigen::Map<const Vector>(B.data(), static_cast<Eigen::Index>(B.size()));
    const Vector expected = p.Lambda.diagonal();
    worst.see_each(got - expected, p.condition * expected, p.which);
  });
  check_within("diagonal of Lambda", worst, 0.3);  // seen 0.062
}

TEST_CASE("every law has a name of its own") {
  std::set<std::string_view> names;
  int expected = 0;
  for (const TextbookLawInfo& law : textbook_laws()) {
    CHECK(static_cast<int>(law.law) == expected++);
    CHECK(names.insert(law.name).second);
    CHECK(!law.omits.empty());
    CHECK(!law.source.empty());
  }
  CHECK(expected == static_cast<int>(TextbookLaw::jacobian_transpose) + 1);
}

}  // namespace osculate::testing::textbook_laws_tests
