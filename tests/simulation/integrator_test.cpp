// The integrator on problems with known solutions.
#include "simulation/integrator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/catch.hpp"

namespace osculate::testing::integrator_tests {
using Reason = IntegrationStopped::Reason;
using State = std::array<double, 2>;

namespace {

constexpr Method methods[] = {Method::adams, Method::bdf, Method::runge_kutta};

void oscillator(double, const double* y, double* yd) {
  yd[0] = y[1];
  yd[1] = -y[0];
}

/// y[0] is the time.
void elapse(double, const double*, double* yd) {
  yd[0] = 1;
  yd[1] = 0;
}

IntegratorOptions options(Method method, double rtol) {
  return {method, rtol, {rtol / 100, rtol / 100}, 0.5};
}

Reason reason_of(Integrator& integrator, double end) {
  try {
    while (integrator.t() < end) integrator.step(end);
  } catch (const IntegrationStopped& stop) {
    CHECK(std::isfinite(integrator.state()[0]));
    return stop.reason;
  }
  FAIL("it went on");
  return Reason::failed;
}

}  // namespace

TEST_CASE("every method follows an oscillator to a small multiple of the tolerance") {
  for (const Method method : methods)
    for (const double rtol : {1e-6, 1e-9, 1e-11}) {
      Integrator integrator(oscillator, 0, State{1, 0}, options(method, rtol));
      long steps = 0;
      double largest_error = 0;
      while (integrator.t() < 10) {
        const StepInfo step = integrator.step(10);
        ++steps;
        largest_error = std::max(largest_error, step.local_error);
        CHECK(step.h > 0);
        CHECK(step.order >= 1);
        CHECK(step.local_error <=
              1.5);  // the error test's norm is a mean over components, this is the largest
        CHECK(step.at_stop == (integrator.t() == 10));
        CHECK(!step.at_event);
      }
      CHECK(integrator.t() == 10);
      CHECK(largest_error > 0.01);
      // Local errors of at most rtol a step, carried on without growth: at most steps * rtol.
      CHECK(std::abs(integrator.state()[0] - std::cos(10)) < static_cast<double>(steps) * rtol);
      CHECK(integrator.rhs_evaluations() >= steps);
    }
}

TEST_CASE("the Adams interpolant agrees with the solution, and its derivative with the right-hand side") {
  for (const double rtol : {1e-6, 1e-8, 1e-10}) {
    Integrator integrator(oscillator, 0, State{1, 0}, options(Method::adams, rtol));
    double worst = 0, worst_value = 0;
    while (integrator.t() < 20) {
      const StepInfo step = integrator.step(20);
      State slope{}, value{}, f{};
      integrator.interpolate(integrator.t(), 1, slope);
      oscillator(0, integrator.state().data(), f.data());
      // h y' differs from h f by what the nonlinear iteration leaves: a fraction of the tolerance
      for (std::size_t i = 0; i < 2; ++i) worst = std::max(worst, step.h * std::abs(slope[i] - f[i]) / rtol);
      const double middle = integrator.t() - step.h / 2;
      integrator.interpolate(middle, 0, value);
      worst_value = std::max(worst_value, std::abs(value[0] - std::cos(middle)) / rtol);
    }
    INFO("rtol " << rtol << ", defect " << worst << " of the tolerance, value " << worst_value);
    CHECK(worst < 1);
    CHECK(worst_value < 1000);
  }
}

TEST_CASE("the Runge-Kutta interpolant is about as accurate as the step and costs one evaluation") {
  for (const double rtol : {1e-6, 1e-8, 1e-10}) {
    Integrator integrator(oscillator, 0, State{1, 0}, options(Method::runge_kutta, rtol));
    double worst = 0, worst_slope = 0;  // in units of rtol
    while (integrator.t() < 20) {
      const State start{integrator.state()[0], integrator.state()[1]};
      const StepInfo step = integrator.step(20);
      const long before = integrator.rhs_evaluations();
      for (const double part : {0.0, 0.2, 0.4, 0.5, 0.6, 0.8, 1.0}) {
        const double x = part * step.h;
        // The exact solution from where the step started.
        const State exact{start[0] * std::cos(x) + start[1] * std::sin(x),
                          start[1] * std::cos(x) - start[0] * std::sin(x)};
        State value{}, slope{}, f{};
        oscillator(0, exact.data(), f.data());
        integrator.interpolate(integrator.t() - step.h + x, 0, value);
        integrator.interpolate(integrator.t() - step.h + x, 1, slope);
        for (std::size_t i = 0; i < 2; ++i) {
          worst = std::max(worst, std::abs(value[i] - exact[i]) / rtol);
          worst_slope = std::max(worst_slope, step.h * std::abs(slope[i] - f[i]) / rtol);
        }
      }
      CHECK(integrator.rhs_evaluations() - before <= 1);
    }
    INFO("rtol " << rtol << ", value " << worst << " of the tolerance, slope " << worst_slope);
    CHECK(worst < 2);
    CHECK(worst_slope < 6);
  }
}

TEST_CASE("a stop time is met exactly and a restart goes on from there") {
  for (const Method method : methods) {
    Integrator integrator(oscillator, 0, State{1, 0}, options(method, 1e-10));
    while (integrator.t() < 1.0 / 3) integrator.step(1.0 / 3);
    CHECK(integrator.t() == 1.0 / 3);
    const long before = integrator.rhs_evaluations();
    integrator.restart();
    CHECK(integrator.rhs_evaluations() == before);
    CHECK(integrator.step(1).order == (method == Method::runge_kutta ? 5 : 1));
    while (integrator.t() < 1) integrator.step(1);
    CHECK(std::abs(integrator.state()[0] - std::cos(1)) < 1e-8);
  }
}

TEST_CASE("a stop time next to the present time is met") {
  for (const Method method : methods)
    for (const double ahead : {2.3e-16, 1e-15, 1e-13, 1e-11}) {
      Integrator integrator(oscillator, 0, State{1, 0}, options(method, 1e-10));
      while (integrator.t() < 1) integrator.step(1);
      integrator.restart();
      CHECK(integrator.step(1 + ahead).at_stop);
      CHECK(integrator.t() == 1 + ahead);
      CHECK(std::abs(integrator.state()[0] - std::cos(1)) < 1e-8);
    }
}

TEST_CASE("after a known jump in f a restart keeps the accuracy") {
  // y'' = u - y, u jumps from 0 to 1: y = cos t, then 1 - cos(t - jump) + cos t.
  const double rtol = 1e-9;
  for (const Method method : methods)
    for (const bool at_stop : {true, false}) {
      double u = 0, first_call = -1;
      const auto f = [&](double t, const double* y, double* yd) {
        if (first_call < 0) first_call = t;
        yd[0] = y[1];
        yd[1] = u - y[0];
      };
      Integrator integrator(f, 0, State{1, 0}, options(method, rtol));
      long steps = 0;
      for (; integrator.t() < 1; ++steps) integrator.step(at_stop ? 1 : 6);
      const double jump = integrator.t();
      u = 1;
      integrator.restart();
      first_call = -1;
      for (; integrator.t() < 6; ++steps) integrator.step(6);
      CHECK(first_call == jump);  // no value of f from before the jump is used again
      const double exact = 1 - std::cos(6 - jump) + std::cos(6);
      CHECK(std::abs(integrator.state()[0] - exact) < static_cast<double>(steps) * rtol);
    }
}

TEST_CASE("an exception that only an interpolant meets is not passed over") {
  for (const Method method : methods)
    for (double from = 10; from < 11; from += 0.02) {
      const auto f = [from](double t, const double*, double* yd) {
        if (t > from && t < from + 0.02) throw IntegrationStopped(Reason::singular, "gap");
        elapse(t, nullptr, yd);
      };
      const auto event = [](double, const double* y, double* g) { g[0] = y[0] - 10.5; };
      Integrator integrator(f, 0, State{0, 0}, options(method, 1e-9), 1, event);
      try {
        while (integrator.t() < 11) {
          integrator.step(11);
          REQUIRE(std::abs(integrator.state()[0] - integrator.t()) < 1e-12);
        }
      } catch (const IntegrationStopped& stop) {
        CHECK(stop.reason == Reason::singular);
        CHECK(integrator.t() <= from + 0.02);
        CHECK(std::abs(integrator.state()[0] - integrator.t()) < 1e-12);
      }
    }
}

TEST_CASE("failures of the error test are counted across restarts") {
  for (const Method method : methods) {
    // A jump that nobody told the integrator.
    const auto f = [](double t, const double*, double* yd) { yd[0] = yd[1] = std::fmod(t, 1) < 0.5 ? 0 : 1; };
    Integrator integrator(f, 0, State{1, 0}, options(method, 1e-8));
    long last = 0;
    for (int second = 1; second <= 3; ++second) {
      while (integrator.t() < second) integrator.step(second);
      CHECK(integrator.error_test_failures() > last);
      last = integrator.error_test_failures();
      integrator.restart();
      CHECK(integrator.error_test_failures() == last);
    }
  }
}

TEST_CASE("where f jumps every millisecond Runge-Kutta needs fewer evaluations than Adams") {
  // A mass under sampled PD control: between samples u is constant and the motion is a parabola.
  const auto evaluations_per_sample = [](Method method) {
    double u = 0;
    const auto f = [&u](double, const double* y, double* yd) {
      yd[0] = y[1];
      yd[1] = u - 9.81 * std::sin(y[0]);
    };
    Integrator integrator(f, 0, State{1, 0}, options(method, 1e-9));
    const int samples = 200;
    for (int k = 1; k <= samples; ++k) {
      u = -400 * integrator.state()[0] - 40 * integrator.state()[1];
      integrator.restart();
      while (integrator.t() < k * 1e-3) integrator.step(k * 1e-3);
    }
    return static_cast<double>(integrator.rhs_evaluations()) / samples;
  };
  const double runge_kutta = evaluations_per_sample(Method::runge_kutta);
  const double adams = evaluations_per_sample(Method::adams);
  INFO(runge_kutta << " and " << adams);
  // One for the restart, six stages, one for the interpolant at the stop, and the first steps of the run.
  CHECK(runge_kutta < 8.5);
  CHECK(2 * runge_kutta < adams);
}

TEST_CASE("stops carry their reason and keep the last accepted state") {
  const auto wall = [](double t, const double* y, double* yd) {
    if (t > 1) throw IntegrationStopped(Reason::singular, "wall");
    oscillator(t, y, yd);
  };
  for (const Method method : methods) {
    Integrator walled(wall, 0, State{1, 0}, options(method, 1e-8));
    CHECK(reason_of(walled, 2) == Reason::singular);
    CHECK(walled.t() <= 1);
    CHECK(walled.t() > 1 - 1e-9);
    CHECK(std::abs(walled.state()[0] - std::cos(walled.t())) < 1e-5);
    // y' = y^2 from 1 leaves every bound at t = 1; an error of rtol in y moves that time by as much.
    const auto square = [](double, const double* y, double* yd) {
      yd[0] = y[0] * y[0];
      yd[1] = 0;
    };
    Integrator blown(square, 0, State{1, 0}, options(method, 1e-8));
    const Reason why = reason_of(blown, 2);
    CHECK((why == Reason::step_too_small || why == Reason::non_finite));
    CHECK(std::abs(blown.t() - 1) < 1e-5);
    // Another exception of the right-hand side comes through unchanged.
    Integrator other([](double, const double*, double*) { throw std::runtime_error("mine"); }, 0, State{1, 0},
                     options(method, 1e-8));
    CHECK_THROWS_WITH(other.step(1), "mine");
  }
}

TEST_CASE("a right-hand side that refuses a predicted state only is passed by") {
  // cos t never goes below -1; a stage or a predictor may.
  for (const Method method : methods) {
    const auto f = [](double t, const double* y, double* yd) {
      if (y[0] < -1 - 1e-7) throw IntegrationStopped(Reason::singular, "outside");
      oscillator(t, y, yd);
    };
    Integrator integrator(f, 0, State{1, 0}, options(method, 1e-9));
    while (integrator.t() < 10) integrator.step(10);
    CHECK(std::abs(integrator.state()[0] - std::cos(10)) < 1e-6);
  }
}

TEST_CASE("the same problem gives the same bits") {
  for (const Method method : methods) {
    const auto event = [](double, const double* y, double* g) { g[0] = y[0]; };
    Integrator a(oscillator, 0, State{1, 0}, options(method, 1e-11), 1, event);
    Integrator b(oscillator, 0, State{1, 0}, options(method, 1e-11), 1, event);
    while (a.t() < 5) {
      const bool at_event = a.step(5).at_event;
      REQUIRE(b.step(5).at_event == at_event);
      if (at_event) a.restart(), b.restart();
      REQUIRE(a.t() == b.t());
      REQUIRE(a.state()[0] == b.state()[0]);
      REQUIRE(a.rhs_evaluations() == b.rhs_evaluations());
    }
  }
}

TEST_CASE("a ball on a spring: every touch and every release once, at its time") {
  const double gravity = 9.81, w = 100, height = 0.3;  // m/s^2, rad/s of ball and spring, m
  const double speed = std::sqrt(2 * gravity * height);
  const double flight = 2 * speed / gravity;
  const double touching = 2 * (std::acos(-1) - std::atan(speed * w / gravity)) / w;
  for (const Method method : methods)
    for (const double rtol : {1e-6, 1e-9}) {
      bool contact = false;
      const auto f = [&](double, const double* y, double* yd) {
        yd[0] = y[1];
        yd[1] = -gravity - (contact ? w * w * y[0] : 0);
      };
      const auto gap = [](double, const double* y, double* g) { g[0] = y[0]; };
      Integrator integrator(f, 0, State{height, 0}, options(method, rtol), 1, gap);
      double due = flight / 2;
      int events = 0;
      long steps = 0;
      while (integrator.t() < 6) {
        const double before = integrator.t();
        const StepInfo step = integrator.step(6);
        ++steps;
        CHECK(step.h == integrator.t() - before);
        if (!step.at_event) continue;
        ++events;
        // Just past the surface, on the side of the next mode.
        REQUIRE(integrator.state()[0] != 0);
        REQUIRE(contact == (integrator.state()[0] > 0));
        CHECK(std::abs(integrator.state()[0]) < 1e-12);
        contact = !contact;
        // Errors of rtol in the speed for each step so far change the times of all flights that follow.
        CHECK(std::abs(integrator.t() - due) < static_cast<double>(steps) * rtol * (due + flight));
        due += contact ? touching : flight;
        integrator.restart();
      }
      const double period = flight + touching;
      CHECK(events == 1 + static_cast<int>((6 - flight / 2) / period) +
                          static_cast<int>((6 - flight / 2 - touching) / period + 1));
    }
}

TEST_CASE("a ball thrown from the surface: the zero it starts from is no event") {
  for (const Method method : methods) {
    const auto fall = [](double, const double* y, double* yd) {
      yd[0] = y[1];
      yd[1] = -9.81;
    };
    const auto gap = [](double, const double* y, double* g) { g[0] = y[0]; };
    Integrator integrator(fall, 0, State{0, 2}, options(method, 1e-9), 1, gap);
    while (!integrator.step(1).at_event) REQUIRE(integrator.t() < 1);
    CHECK(std::abs(integrator.t() - 2 * 2 / 9.81) < 1e-7);
    CHECK(integrator.state()[0] < 0);
  }
}

TEST_CASE("of two events in one step the first comes first, with and without a restart") {
  for (const Method method : methods)
    for (const bool restart : {false, true}) {
      const auto events = [](double, const double* y, double* g) {
        g[0] = y[0] - 10.22;
        g[1] = 10.2 - y[0];
      };
      Integrator unwatched(elapse, 0, State{0, 0}, options(method, 1e-9));
      Integrator integrator(elapse, 0, State{0, 0}, options(method, 1e-9), 2, events);
      double start = 0;
      while (integrator.t() < 10.2) {
        start = integrator.t();
        integrator.step(20);
        if (unwatched.t() < 10.2) unwatched.step(20);
      }
      REQUIRE(start < 10.2);
      REQUIRE(unwatched.t() > 10.22);  // in one step from before 10.2
      CHECK(std::abs(integrator.t() - 10.2) < 1e-12);
      CHECK(integrator.state()[0] > 10.2);
      if (restart) integrator.restart();
      while (!integrator.step(20).at_event) REQUIRE(integrator.t() < 11);
      CHECK(std::abs(integrator.t() - 10.22) < 1e-12);
      while (integrator.t() < 20) CHECK(!integrator.step(20).at_event);
    }
}

TEST_CASE("an event at the stop time is both") {
  for (const Method method : methods) {
    const auto event = [](double t, const double*, double* g) { g[0] = t < 0.5 ? -1 : 1; };
    Integrator integrator(oscillator, 0, State{1, 0}, options(method, 1e-9), 1, event);
    StepInfo step;
    while (integrator.t() < 0.5) step = integrator.step(0.5);
    CHECK(step.at_stop);
    CHECK(step.at_event);
    integrator.restart();
    while (integrator.t() < 1) CHECK(!integrator.step(1).at_event);
  }
}

TEST_CASE("what event functions throw stops the run as the right-hand side's does") {
  for (const Method method : methods) {
    const auto wall = [](double t, const double*, double* g) {
      if (t > 1) throw IntegrationStopped(Reason::singular, "wall");
      g[0] = 1;
    };
    Integrator walled(oscillator, 0, State{1, 0}, options(method, 1e-8), 1, wall);
    CHECK(reason_of(walled, 2) == Reason::singular);
    CHECK(walled.t() <= 1);
    CHECK(walled.t() > 1 - 1e-9);
    CHECK(std::abs(walled.state()[0] - std::cos(walled.t())) < 1e-5);
    const auto other = [](double t, const double*, double* g) {
      if (t > 1) throw std::runtime_error("mine");
      g[0] = 1;
    };
    Integrator thrown(oscillator, 0, State{1, 0}, options(method, 1e-8), 1, other);
    while (thrown.t() + 0.6 < 1) thrown.step(2);
    CHECK_THROWS_WITH(
        [&] {
          while (thrown.t() < 2) thrown.step(2);
        }(),
        "mine");
    CHECK(thrown.t() <= 1);
    CHECK(std::abs(thrown.state()[0] - std::cos(thrown.t())) < 1e-5);
  }
}

}  // namespace osculate::testing::integrator_tests
