// The filter on Omega against matrices whose eigenvalues and vectors are known, and the ellipsoids. Errors
// are counted in eps times a stated scale; the factor allowed is at most 5 times the worst that was seen.
#include "control/singular_task.hpp"

#include "control/differences.hpp"
#include "control/effective_mass.hpp"
#include "control/quick_arm.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/worst.hpp"
#include "spatial/plain.hpp"
#include "support/catch.hpp"

namespace osculate::testing::singular_task_tests {
using osculate::test::Draw;
using osculate::test::quick_arm;
using osculate::test::QuickArm;
using osculate::test::second_difference;

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

Compliance<double> compliance(const Matrix6<double>& m) {
  const auto row = [&](int i) { return Vec3<double>{m(i, 3), m(i, 4), m(i, 5)}; };
  return {{m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)},
          {row(0), row(1), row(2)},
          {m(3, 3), m(3, 4), m(3, 5), m(4, 4), m(4, 5), m(5, 5)}};
}

Vector head(const TaskVector<double>& v, Eigen::Index m) { return Eigen::Map<const Vector>(v.data(), m); }
TaskVector<double> task(const Vector& v) {
  TaskVector<double> out{};
  for (Eigen::Index i = 0; i < v.size(); ++i) out[static_cast<std::size_t>(i)] = v[i];
  return out;
}

/// S = V diag(sigma) V* on six rows, with V made of pairs (x, y) and (x, -y) over the root of 2, x and y from
/// two orthonormal triples: both blocks of S have the trace sum(sigma) / 2, so their mean diagonals are 1
/// when sum(sigma) is 6. Omega = W S W.
struct Known {
  Vector sigma;  // ascending
  Matrix V, S;
  Vector w;
  Compliance<double> Omega;
};
Known known(Draw& draw, Vector sigma, double w_angular, double w_linear) {
  Known out;
  const Matrix3<double> X = draw.turn(), Y = draw.turn();
  out.V.resize(6, 6);
  for (int i = 0; i < 3; ++i) {
    out.V.col(2 * i) << X.col(i), Y.col(i);
    out.V.col(2 * i + 1) << X.col(i), -Y.col(i);
  }
  out.V /= std::sqrt(2.0);
  out.sigma = sigma * (6 / sigma.sum());
  out.S = out.V * out.sigma.asDiagonal() * out.V.transpose();
  out.w.resize(6);
  out.w << Vector::Constant(3, w_angular), Vector::Constant(3, w_linear);
  out.Omega = compliance(out.w.asDiagonal() * out.S * out.w.asDiagonal());
  return out;
}
/// Ascending, six orders of magnitude.
Vector spread(Draw& draw, double least) {
  Vector out(6);
  out << least, 1e-3, 0.02, 0.5, 1, 2;
  for (double& x : out) x *= draw(0.9, 1.1);
  return out;
}

/// Largest value and slope of the filter on [0, 6], by sampling densely around the scales that it has.
struct Sizes {
  double value = 0, slope = 0;
};
Sizes sizes(const SingularityOptions& options, double from) {
  Sizes out;
  double before = filtered_inverse(options, from);
  for (double sigma = from; sigma < 6;) {
    const double next = sigma * 1.001 + 1e-3 * from;
    const double f = filtered_inverse(options, next);
    out.value = std::max({out.value, std::abs(before), std::abs(f)});
    out.slope = std::max(out.slope, std::abs(f - before) / (next - sigma));
    sigma = next, before = f;
  }
  return out;
}

const SingularityOptions damped{SingularPolicy::damped, 0.1, 0.05};
const SingularityOptions released{SingularPolicy::released, 0.1, 0.05};
const SingularityOptions truncated{SingularPolicy::truncated, 0.1, 0.05};

}  // namespace

TEST_CASE("the filter is the spectral sum over known eigenvectors") {
  // A function of a symmetric matrix changes by at most its largest slope times the change of the matrix:
  // here |S| <= 6 times a few eps.
  Draw draw(5);
  Worst worst, values;
  for (int trial = 0; trial < 50; ++trial) {
    const Known k = known(draw, spread(draw, trial % 5 == 0 ? 1e-12 : 1e-6), 3.7, 0.02);
    const Vector right = draw.vector(6, 1);
    for (const auto& [options, skipped] :
         {std::pair{damped, 0}, std::pair{released, 0}, std::pair{truncated, 2}}) {
      const SingularTask filter(options, k.Omega, all_rows(), skipped);
      CHECK(filter.active());
      Vector expected = Vector::Zero(6);
      for (int i = skipped; i < 6; ++i) {
        const Vector v = k.V.col(i).cwiseQuotient(k.w);
        expected += v * (filtered_inverse(options, k.sigma[i]) * v.dot(right));
      }
      const Sizes size = sizes(options, skipped ? k.sigma[skipped] : 1e-9);
      const double gap = skipped ? k.sigma[skipped] - k.sigma[skipped - 1] : 1e300;
      const double change = 6 * (size.slope + size.value / gap) + size.value;
      const Vector entry = k.w.cwiseInverse() * k.w.cwiseInverse().dot(right.cwiseAbs()) * change;
      worst.see_each(head(filter.solve(task(right)), 6) - expected, entry, "trial " + std::to_string(trial));
      values.see((head(filter.eigenvalues(), 6) - k.sigma).norm(), 6, "trial " + std::to_string(trial));
    }
  }
  check_within("filtered solve", worst, 0.9);  // seen 0.18
  check_within("eigenvalues", values, 19);     // seen 3.9
}

TEST_CASE("the filter is off exactly where no eigenvalue is below the threshold") {
  Draw draw(6);
  int between = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const double least = draw(0.02, 0.2);
    Vector sigma(6);
    sigma << least, 1.1 * least, 0.5, 1, 1.5, 2;
    const Known k = known(draw, sigma, 1, 30);
    const TaskFactor<double> factor(k.Omega, all_rows());
    const Vector right = draw.vector(6, 1);
    for (const SingularityOptions& options : {damped, released}) {
      const SingularTask filter(options, k.Omega, all_rows());
      CHECK(filter.active() == (k.sigma[0] < options.threshold));
      between += smooth_measure(k.Omega, all_rows()) < options.threshold && !filter.active();
      if (filter.active()) continue;
      // Off: the plain inverse, to eps times the condition.
      const Vector expected = head(factor.solve(task(right)), 6);
      const Vector error = (head(filter.solve(task(right)), 6) - expected).cwiseProduct(k.w);
      CHECK(error.norm() <= 20 * eps * 6 / k.sigma[0] * expected.cwiseProduct(k.w).norm());
    }
    CHECK(!SingularTask({}, k.Omega, all_rows()).active());
    CHECK(!SingularTask(truncated, k.Omega, all_rows(), 0).active());
    CHECK(SingularTask(truncated, k.Omega, all_rows(), 1).active());
  }
  CHECK(between >= 5);  // also where only the eigenvalues can tell
}

TEST_CASE("the measure lies between sigma_min / m and sigma_min") {
  Draw draw(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Known k = known(draw, spread(draw, trial % 2 ? 1e-6 : 5e-4), 0.3, 12);
    const double measure = smooth_measure(k.Omega, all_rows());
    const double slack = 20 * eps * 6 / k.sigma[0];  // relative error of 1 / sigma_min
    CHECK(measure <= k.sigma[0] * (1 + slack));
    CHECK(measure >= k.sigma[0] / 6 * (1 - slack));
    CHECK(measure == Approx(1 / k.sigma.cwiseInverse().sum()).epsilon(slack));
  }
  // Fewer rows, from arms: against the eigenvalues of the rows alone.
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const TaskRows& rows : {TaskRows{3, 4, 5}, TaskRows{0, 2, 4}, TaskRows{5}}) {
      const QuickArm arm = quick_arm(seed, 7);
      OperationalSpace<double> space(arm.chain);
      space.place(arm.positions);
      space.sweep({arm.qd.data(), 7});
      const auto m = static_cast<Eigen::Index>(rows.size());
      const Vector sigma = head(SingularTask({}, space.Omega(), rows).eigenvalues(), m);
      CHECK(std::abs(sigma.sum() - static_cast<double>(m)) <= 20 * eps * static_cast<double>(m));
      const double slack = 20 * eps * static_cast<double>(m) / sigma[0];
      CHECK(smooth_measure(space.Omega(), rows) == Approx(1 / sigma.cwiseInverse().sum()).epsilon(slack));
    }
}

TEST_CASE("a lost direction has measure 0, and no filter asks for a force along it") {
  Draw draw(8);
  // Three sliding joints: nothing turns.
  Matrix6<double> gantry = Matrix6<double>::Zero();
  gantry.diagonal() << 0, 0, 0, 1, 2, 3;
  CHECK(smooth_measure(compliance(gantry), all_rows()) == 0);
  CHECK(smooth_measure(compliance(gantry), {3, 4, 5}) == Approx(2 / (2 + 1 + 2.0 / 3) / 2).epsilon(8 * eps));
  const Vector ones = Vector::Ones(6);
  for (const SingularityOptions& options : {damped, released}) {
    const SingularTask filter(options, compliance(gantry), all_rows());
    CHECK(filter.active());
    const Vector F = head(filter.solve(task(ones)), 6);
    CHECK(F.head<3>().isZero(0));
    for (int i = 0; i < 3; ++i) CHECK(F[3 + i] == Approx(1.0 / (i + 1)).epsilon(16 * eps));
  }
  Matrix6<double> bad = Matrix6<double>::Identity();
  bad(2, 2) = -1e-17;
  CHECK(smooth_measure(compliance(bad), all_rows()) == 0);
  bad(2, 2) = std::numeric_limits<double>::quiet_NaN();
  CHECK(smooth_measure(compliance(bad), all_rows()) == 0);
  CHECK(SingularTask(damped, compliance(bad), all_rows()).active());
}

TEST_CASE("the filters meet 1 / sigma at the threshold as smoothly as they say, and are bounded") {
  const double th = released.threshold;
  for (const SingularityOptions& options : {damped, released}) {
    const auto f = [&](double sigma) { return filtered_inverse(options, sigma); };
    CHECK(f(th) == 1 / th);
    CHECK(f(2 * th) == 1 / (2 * th));
    CHECK(f(0) == 0);
    // The second derivative from either side, 8 steps away from the threshold where the stencil ends.
    const double h = 1e-5 * th;
    const auto curvature = [&](double steps) { return second_difference(f, th + steps * h, h).value; };
    const double below = curvature(-9), above = curvature(9);
    // What it changes by over 9 more steps, and rounding 6.6 eps / h^2 of values of 1 / th and a few eps.
    const double rounding = 6.6 * 4 * eps / th / (h * h);
    const double change = std::abs(curvature(-18) - below) + std::abs(curvature(18) - above);
    const double tol = 2 * change + 4 * rounding;
    // f = sigma / (sigma^2 + q) with q'' = 8 damping^2 / th^2 at th, where q and q' vanish.
    const double jump = options.policy == SingularPolicy::damped ? 8 * std::pow(damped.damping, 2) : 0;
    INFO("tolerance " << tol << " of " << 2 / (th * th * th));
    CHECK(std::abs(above - 2 / (th * th * th)) <= tol);
    CHECK(std::abs(below - (2 / (th * th * th) - jump / std::pow(th, 5))) <= tol);
    CHECK(tol < 0.02 * 2 / (th * th * th));
    // The slope: -1/th^2 from below, up to h times the curvature.
    CHECK(std::abs((f(th) - f(th - h)) / h + 1 / (th * th)) <= h * (2 / (th * th * th)) + 4 * eps / th / h);
  }
  double largest = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double sigma = th * i / 1000;
    const double lambda = damped.damping * (1 - (sigma / th) * (sigma / th));
    largest = std::max(largest, filtered_inverse(released, sigma) * th);
    CHECK(filtered_inverse(damped, sigma) * 2 * lambda <= 1 + 8 * eps);
    CHECK(filtered_inverse(released, sigma) * sigma <= 1 + 8 * eps);
  }
  CHECK(largest < 1.2);
  CHECK(largest > 1.19);
  CHECK(filtered_inverse(released, -1e-17) == 0);
}

TEST_CASE("another unit of length changes nothing") {
  Draw draw(9);
  const double L = 1000;  // m to mm
  for (int trial = 0; trial < 20; ++trial) {
    const Known k = known(draw, spread(draw, 1e-4), 2, 0.5);
    Vector D = Vector::Ones(6);
    D.tail(3).setConstant(L);
    const Matrix6<double> scaled = D.asDiagonal() * plain(k.Omega) * D.asDiagonal();
    const double slack = 20 * eps * 6 / k.sigma[0];
    CHECK(smooth_measure(compliance(scaled), all_rows()) ==
          Approx(smooth_measure(k.Omega, all_rows())).epsilon(slack));
    const SingularTask here(damped, k.Omega, all_rows()), there(damped, compliance(scaled), all_rows());
    CHECK((head(here.eigenvalues(), 6) - head(there.eigenvalues(), 6)).norm() <= 20 * eps * 6);
    const Vector right = draw.vector(6, 1);
    const Vector a = head(here.solve(task(right)), 6);
    const Vector b = head(there.solve(task(D.cwiseProduct(right))), 6).cwiseProduct(D);
    const Sizes size = sizes(damped, 1e-9);
    const double entry = k.w.cwiseInverse().dot(right.cwiseAbs()) * (6 * size.slope + size.value);
    CHECK((a - b).cwiseProduct(k.w).norm() <= 20 * eps * entry);
  }
}

TEST_CASE("effective mass along its axes, between the principal values elsewhere") {
  Draw draw(10);
  Worst along, orthogonal;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const QuickArm arm = quick_arm(seed, 6);
    OperationalSpace<double> space(arm.chain);
    space.place(arm.positions);
    space.sweep({arm.qd.data(), 6});
    const Matrix6<double> Omega = plain(space.Omega());
    for (const bool turning : {false, true}) {
      const Matrix3<double> block = turning ? Omega.topLeftCorner<3, 3>() : Omega.bottomRightCorner<3, 3>();
      const Ellipsoid e = turning ? effective_inertia(space.Omega()) : effective_mass(space.Omega());
      const auto mass = [&](const Vector3<double>& n) { return 1 / n.dot(block * n); };
      orthogonal.see((e.axes.transpose() * e.axes - Matrix3<double>::Identity()).norm(), 1, arm.name);
      for (int i = 0; i < 3; ++i) {
        if (std::isinf(e.principal[i])) {  // an arm with fewer than three turning joints
          CHECK(e.axes.col(i).dot(block * e.axes.col(i)) <= 2 * immobile * block.trace());
          continue;
        }
        // Omega n is known to eps trace, so its inverse to eps trace times itself.
        const double scale = block.trace() * e.principal[i] * e.principal[i];
        along.see(std::abs(mass(e.axes.col(i)) - e.principal[i]), scale, arm.name);
      }
      CHECK(e.principal[0] <= e.principal[1]);
      CHECK(e.principal[1] <= e.principal[2]);
      for (int trial = 0; trial < 20; ++trial) {
        const double m = mass(draw.direction());
        CHECK(m >= e.principal[0] * (1 - 20 * eps));
        CHECK(m <= e.principal[2] * (1 + 20 * eps * block.trace() * e.principal[2]));
      }
    }
  }
  check_within("mass along its axes", along, 14);  // seen 2.9
  check_within("axes", orthogonal, 34);            // seen 6.8
}

TEST_CASE("the mass is infinite where the arm cannot move") {
  for (unsigned seed = 1; seed <= 1000; ++seed)
    for (const int n : {1, 2, 3}) {
      const QuickArm arm = quick_arm(seed, n);
      OperationalSpace<double> space(arm.chain);
      space.place(arm.positions);
      space.sweep({arm.qd.data(), static_cast<std::size_t>(n)});
      const Ellipsoid e = effective_mass(space.Omega());
      INFO(arm.name << ", " << e.principal.transpose());
      for (int i = 0; i < 3; ++i) CHECK(std::isinf(e.principal[i]) == (i >= n));
    }
}

}  // namespace osculate::testing::singular_task_tests
