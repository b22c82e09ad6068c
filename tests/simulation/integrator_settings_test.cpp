// What an integrator does must not depend on how its numbers lie in memory; and its settings act.
#include <algorithm>
#include <cmath>
#include <vector>

#include "simulation/integrator.hpp"
#include "support/catch.hpp"

namespace osculate::testing::integrator_settings_tests {

namespace {

constexpr Method methods[] = {Method::adams, Method::bdf, Method::runge_kutta};

/// Steps of n equal equations y' = -y + sin t from y = 1, to t = 5.
struct Run {
  std::vector<double> ends;   // s
  std::vector<double> state;  // at t = 5
  int largest_order = 0;
  long rhs = 0;
};

Run run(std::size_t n, Method method, int max_order = 0, double fraction = 0, int remembered = -1) {
  const auto f = [n](double t, const double* y, double* yd) {
    for (std::size_t i = 0; i < n; ++i) yd[i] = -y[i] + std::sin(t);
  };
  IntegratorOptions options{method, 1e-8, std::vector<double>(n, 1e-8), 0.5};
  options.max_order = max_order;
  options.nonlinear_fraction = fraction;
  options.remembered_iterates = remembered;
  Integrator integrator(f, 0, std::vector<double>(n, 1.0), options);
  Run result;
  while (integrator.t() < 5) {
    result.largest_order = std::max(result.largest_order, integrator.step(5).order);
    result.ends.push_back(integrator.t());
  }
  result.state.assign(integrator.state().begin(), integrator.state().end());
  result.rhs = integrator.rhs_evaluations();
  return result;
}

// y = (3/2) exp(-t) + (sin t - cos t) / 2
const double exact = 1.5 * std::exp(-5) + (std::sin(5.0) - std::cos(5.0)) / 2;

}  // namespace

TEST_CASE("equal equations stay equal to the last bit, however many they are") {
  for (const Method method : methods) {
    const double alone = run(1, method).state[0];
    for (std::size_t n = 1; n <= 17; ++n) {
      INFO(n << " equations");
      const Run many = run(n, method);
      REQUIRE(many.state.size() == n);
      for (const double y : many.state) CHECK(y == many.state[0]);
      // The mean square of n equal errors is one of them to rounding. A step chosen anew differs by as
      // little, unless it is refused; so the error and not the bits.
      CHECK(std::abs(many.state[0] - exact) < static_cast<double>(many.ends.size()) * 1e-8);
      CHECK(std::abs(many.state[0] - alone) < static_cast<double>(many.ends.size()) * 1e-8);
    }
  }
}

TEST_CASE("the first steps do not depend on the number of equal equations") {
  // Filling that counted in the norm would change the tolerance by sqrt(n / filled), up to a factor of two.
  for (const Method method : methods) {
    const Run alone = run(1, method);
    for (std::size_t n = 2; n <= 9; ++n)
      for (std::size_t i = 0; i < 8; ++i)
        CHECK(run(n, method).ends[i] == Approx(alone.ends[i]).epsilon(1e-6));
  }
}

TEST_CASE("max_order is not exceeded, and the limits are reached without it") {
  CHECK(run(3, Method::adams).largest_order > 5);
  CHECK(run(3, Method::bdf).largest_order == 5);
  for (const int order : {1, 2, 4}) {
    CHECK(run(3, Method::adams, order).largest_order == order);
    CHECK(run(3, Method::bdf, order).largest_order == order);
  }
  CHECK_THROWS_AS(run(3, Method::adams, 13), IntegrationStopped);
}

TEST_CASE("a corrector solved farther costs evaluations, and memory saves them") {
  CHECK(run(3, Method::adams, 0, 1e-5, 0).rhs > run(3, Method::adams, 0, 0.1, 0).rhs);
  CHECK(run(3, Method::adams, 0, 1e-5, 1).rhs < run(3, Method::adams, 0, 1e-5, 0).rhs);
}

}  // namespace osculate::testing::integrator_settings_tests
