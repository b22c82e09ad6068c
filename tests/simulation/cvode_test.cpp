// The wrapper of CVODE, on problems with known solutions.
#include "simulation/cvode.hpp"

#include <array>
#include <cmath>

#include "support/catch.hpp"

using namespace osculate;
using Reason = IntegrationStopped::Reason;

namespace {

void oscillator(double, const double* y, double* yd) {
  yd[0] = y[1];
  yd[1] = -y[0];
}

IntegratorOptions options(Method method, double rtol) {
  return {method, rtol, {rtol / 100, rtol / 100}, 0.5};
}

}  // namespace

TEST_CASE("both methods follow an oscillator to a small multiple of the tolerance") {
  for (const Method method : {Method::adams, Method::bdf}) {
    const double rtol = 1e-9;
    const std::array<double, 2> y0{1, 0};
    Cvode cvode(oscillator, 0, y0, options(method, rtol));
    long steps = 0;
    while (cvode.t() < 10) {
      const StepInfo step = cvode.step(10);
      ++steps;
      CHECK(step.h > 0);
      CHECK(step.order >= 1);
      CHECK(step.local_error <= 1.5);  // the error test's norm is a mean over components, this is the largest
    }
    CHECK(cvode.t() == 10);
    // Local errors of at most rtol a step, carried on without growth: at most steps * rtol.
    CHECK(std::abs(cvode.state()[0] - std::cos(10)) < static_cast<double>(steps) * rtol);
    CHECK(cvode.rhs_evaluations() >= steps);
  }
}

TEST_CASE("the interpolant agrees with the solution, and its derivative with the right-hand side") {
  for (const double rtol : {1e-6, 1e-8, 1e-10}) {
    const std::array<double, 2> y0{1, 0};
    Cvode cvode(oscillator, 0, y0, options(Method::adams, rtol));
    double worst = 0, worst_value = 0;
    while (cvode.t() < 20) {
      const StepInfo step = cvode.step(20);
      std::array<double, 2> slope{}, value{}, f{};
      cvode.interpolate(cvode.t(), 1, slope);
      oscillator(0, cvode.state().data(), f.data());
      // h y' differs from h f by what the nonlinear iteration leaves: a fraction of the tolerance
      for (std::size_t i = 0; i < 2; ++i) worst = std::max(worst, step.h * std::abs(slope[i] - f[i]) / rtol);
      const double middle = cvode.t() - step.h / 2;
      cvode.interpolate(middle, 0, value);
      worst_value = std::max(worst_value, std::abs(value[0] - std::cos(middle)) / rtol);
    }
    INFO("rtol " << rtol << ", defect " << worst << " of the tolerance, value " << worst_value);
    CHECK(worst < 1);
    CHECK(worst_value < 1000);
  }
}

TEST_CASE("a stop time is met exactly and a restart goes on from there") {
  const std::array<double, 2> y0{1, 0};
  Cvode cvode(oscillator, 0, y0, options(Method::adams, 1e-10));
  while (cvode.t() < 1.0 / 3) cvode.step(1.0 / 3);
  CHECK(cvode.t() == 1.0 / 3);
  const long before = cvode.rhs_evaluations();
  cvode.restart();
  CHECK(cvode.rhs_evaluations() == before);
  CHECK(cvode.step(1).order == 1);
  while (cvode.t() < 1) cvode.step(1);
  CHECK(std::abs(cvode.state()[0] - std::cos(1)) < 1e-8);
}

TEST_CASE("stops carry their reason and keep the last accepted state") {
  const std::array<double, 2> y0{1, 0};
  const auto reason = [&y0](Cvode::RightSide f) {
    Cvode cvode(std::move(f), 0, y0, options(Method::adams, 1e-8));
    try {
      while (cvode.t() < 2) cvode.step(2);
    } catch (const IntegrationStopped& stop) {
      CHECK(cvode.t() <= 1.0 + 1e-12);
      CHECK(std::isfinite(cvode.state()[0]));
      return stop.reason;
    }
    FAIL("it went on");
    return Reason::failed;
  };
  CHECK(reason([](double t, const double* y, double* yd) {
          if (t > 1) throw IntegrationStopped(Reason::singular, "wall");
          oscillator(t, y, yd);
        }) == Reason::singular);
  // y' = y^2 from 1 leaves every bound at t = 1.
  const Reason blown = reason([](double, const double* y, double* yd) {
    yd[0] = y[0] * y[0];
    yd[1] = 0;
  });
  CHECK((blown == Reason::step_too_small || blown == Reason::non_finite || blown == Reason::failed));
  // Another exception of the right-hand side comes through unchanged.
  Cvode other([](double, const double*, double*) { throw std::runtime_error("mine"); }, 0, y0,
              options(Method::bdf, 1e-8));
  CHECK_THROWS_WITH(other.step(1), "mine");
}

TEST_CASE("the same problem gives the same bits") {
  const std::array<double, 2> y0{1, 0};
  Cvode a(oscillator, 0, y0, options(Method::adams, 1e-11)),
      b(oscillator, 0, y0, options(Method::adams, 1e-11));
  while (a.t() < 5) {
    a.step(5);
    b.step(5);
    REQUIRE(a.t() == b.t());
    REQUIRE(a.state()[0] == b.state()[0]);
  }
}
