// The dense formulation over doubles: how far rounding takes it from what it is over exact numbers, and that
// the law of the task holds to eps times the condition of Omega. Exact runs take the very same doubles as
// fractions.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "model/random_arm.hpp"
#include "reference/dense.hpp"
#include "scalar/eps.hpp"
#include "scalar/rational.hpp"
#include "support/catch.hpp"
#include "support/singular_values.hpp"

using namespace osculate;
using osculate::random_arm;
using osculate::Regime;
using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

namespace {

double largest(const Matrix& x) { return x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

/// max |x - exact|, the difference taken exactly.
template <class X, class E>
double error(const X& x, const E& exact) {
  return largest((x.template cast<Rational>() - exact).template cast<double>());
}

/// cond of Omega scaled to unit diagonal.
double condition(const Matrix& Omega) {
  const Vector d = Omega.diagonal().cwiseSqrt().cwiseInverse();
  const Vector sigma = testing::singular_values(d.asDiagonal() * Omega * d.asDiagonal());
  return sigma[0] / sigma[sigma.size() - 1];
}

/// Largest of error / (eps scale), and the arm it was seen on. A NaN is worse than everything.
struct Worst {
  double factor = 0;
  std::string where;

  void see(double error, double scale, const std::string& arm) {
    const double now = error / (eps * scale);
    if (now <= factor || std::isnan(factor)) return;
    factor = now;
    where = arm;
  }
};

std::string label(unsigned seed, int n, Regime regime = Regime::generic) {
  std::ostringstream out;
  out << "seed " << seed << ", " << regime_name(regime) << ", " << random_arm(seed, n, regime);
  return out.str();
}

/// `allowed` is at most 5 times the worst that was seen on these arms, which stands beside each use.
void check_within(const char* what, const Worst& worst, double allowed) {
  INFO(what << ": " << worst.factor << " eps on " << worst.where);
  CHECK(worst.factor <= allowed);
}

}  // namespace

TEST_CASE("over doubles M, C, G, J and Jdot qd stay within a few eps of their exact values") {
  // Scales: the largest entry; for C and Jdot qd, sums that may cancel, the largest entry of M or J times the
  // square of the rates, summed (a rotating arm differentiates to terms of the size of its own lever arms).
  Worst M, C, G, J, A;
  for (const int n : {1, 3, 6})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const auto arm = random_arm(seed, n);
      dense::Positions<Rational> exact_positions;
      for (const auto& at : arm.positions)
        exact_positions.push_back({Rational(at.c), Rational(at.s), Rational(at.d)});
      const auto x = dense::state(arm.chain, arm.positions, arm.qd);
      const auto e =
          dense::state<Rational>(cast<Rational>(arm.chain), exact_positions, arm.qd.cast<Rational>());
      const std::string which = label(seed, n);
      const double rates = arm.qd.lpNorm<1>() * arm.qd.lpNorm<1>();
      double weight = 0;
      for (const auto& link : arm.chain.links) weight += link.mass * arm.chain.gravity.norm();
      M.see(error(x.joint.M, e.joint.M), largest(x.joint.M), which);
      C.see(error(x.joint.C, e.joint.C), largest(x.joint.M) * rates, which);
      G.see(error(x.joint.G, e.joint.G), weight * largest(x.tip.J), which);
      J.see(error(x.tip.J, e.tip.J), largest(x.tip.J), which);
      A.see(error(x.tip.Jdot_qd, e.tip.Jdot_qd), largest(x.tip.J) * rates, which);
    }
  check_within("M", M, 10);         // seen 2.1
  check_within("C", C, 1.8);        // seen 0.36
  check_within("G", G, 6);          // seen 1.3
  check_within("J", J, 10);         // seen 2.0
  check_within("Jdot qd", A, 2.5);  // seen 0.55
}

TEST_CASE("over doubles C is that of Lagrange, up to twelve joints") {
  Worst worst;
  for (const int n : {2, 6, 12})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const auto arm = random_arm(seed, n);
      const Chain<Dual<double>> chain = cast<Dual<double>>(arm.chain);
      const VectorX<Dual<double>> rest = VectorX<Dual<double>>::Zero(n);
      Vector C = Vector::Zero(n);
      for (int k = 0; k < n; ++k) {
        const auto moved = dense::moving(arm.chain, arm.positions, Vector(Vector::Unit(n, k)));
        const Matrix dM = derivatives(dense::joint_space<Dual<double>>(chain, moved, rest).M);
        C += dM * arm.qd * arm.qd[k];
        C[k] -= arm.qd.dot(dM * arm.qd) / 2;
      }
      const auto x = dense::joint_space(arm.chain, arm.positions, arm.qd);
      const double rates = arm.qd.lpNorm<1>() * arm.qd.lpNorm<1>();
      worst.see(largest(x.C - C), largest(x.M) * rates, label(seed, n));
    }
  check_within("C", worst, 2.5);  // seen 0.54
}

TEST_CASE("over doubles the law of the task holds to eps times the condition of Omega") {
  Worst inverse, law, closed;
  double hardest = 0;
  int arms = 0;
  for (const Regime regime : {Regime::generic, Regime::nearly_singular, Regime::zero_velocity})
    for (const int n : {6, 7, 8})
      for (unsigned seed = 1; seed <= 50; ++seed) {
        const auto arm = random_arm(seed, n, regime);
        const auto x = dense::state(arm.chain, arm.positions, arm.qd);
        const auto task = dense::mobility(x.tip, x.joint);
        const double cond = condition(task.Omega);
        if (!(cond < 1e13)) continue;  // beyond that no digit of Lambda is left
        hardest = std::max(hardest, cond);
        ++arms;
        const std::string which = label(seed, n, regime);
        const auto terms = dense::task_terms(task);
        osculate::Random random(seed);
        const Vector F = Vector::NullaryExpr(6, [&] { return random.uniform(-20, 20); });
        const Vector u = Vector::NullaryExpr(6, [&] { return random.uniform(-5, 5); });
        const Matrix one = Matrix::Identity(6, 6);

        // Lambda Omega - 1, in the units of Omega scaled to unit diagonal.
        const Vector d = task.Omega.diagonal().cwiseSqrt();
        inverse.see(
            largest(d.asDiagonal() * (terms.Lambda * task.Omega - one) * d.cwiseInverse().asDiagonal()), cond,
            which);

        // (2): Lambda (J qdd + Jdot qd) + c + g = F, each row over the sum of what was added to it.
        const Vector qdd = dense::forward_dynamics<double>(x.joint, x.tip.J, x.tip.J.transpose() * F);
        const Vector left = terms.Lambda * (x.tip.J * qdd + task.Jdot_qd) + terms.c + terms.g;
        const Vector added = task.Omega.cwiseAbs() * F.cwiseAbs() + task.J_Minv_C.cwiseAbs() +
                             task.J_Minv_G.cwiseAbs() + task.Jdot_qd.cwiseAbs();
        const Vector scale = terms.Lambda.cwiseAbs() * added;
        law.see((left - F).cwiseAbs().cwiseQuotient(scale).maxCoeff<Eigen::PropagateNaN>(), cond, which);

        // (5): with T from (4) and (16) the tip accelerates as commanded, over |Omega| |F|; cond is in F
        // already.
        const auto command = dense::task_force(task, terms, u);
        const Vector reached =
            x.tip.J * dense::forward_dynamics<double>(x.joint, x.tip.J, command.T) + task.Jdot_qd;
        const Vector parts = task.Omega.cwiseAbs() * (terms.Lambda.cwiseAbs() * u.cwiseAbs() +
                                                      terms.c.cwiseAbs() + terms.g.cwiseAbs());
        closed.see((reached - u).cwiseAbs().cwiseQuotient(parts).maxCoeff<Eigen::PropagateNaN>(), 1, which);
      }
  REQUIRE(arms >= 400);
  CHECK(hardest > 1e8);
  check_within("Lambda Omega = 1", inverse, 3);  // seen 0.69
  check_within("law (2)", law, 1);               // seen 0.21
  check_within("law (5)", closed, 14);           // seen 2.9
}
