// The fit of sines, and gain and phase of a linear system in closed form.
#include <cmath>
#include <numbers>
#include <random>

#include "control/linear_response.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"
#include "verification/frequency_response.hpp"

namespace osculate::testing::frequency_tests {
using Complex = std::complex<double>;

namespace {

const std::vector<double> frequencies{0.5, 1, 2, 4};  // Hz
const std::vector<Complex> known{{0.005, -0.001}, {-0.002, 0.004}, {1e-6, 2e-6}, {0, -0.005}};

double angular(double hz) { return 2 * std::numbers::pi * hz; }

double sum_of_sines(const std::vector<Complex>& amplitudes, double t) {
  double x = 0;
  for (std::size_t i = 0; i < frequencies.size(); ++i)
    x += (amplitudes[i] * std::polar(1.0, angular(frequencies[i]) * t)).real();
  return x;
}

template <class Noise>
SineFit fitted(double from, double to, double interval, double constant, const Noise& noise) {
  SineFit fit(frequencies);
  const long steps = std::lround((to - from) / interval);
  for (long i = 0; i < steps; ++i) {
    const double t = from + static_cast<double>(i) * interval;
    fit.add(t, constant + sum_of_sines(known, t) + noise(i, t));
  }
  return fit;
}

double worst_error(const SineFit& fit) {
  double worst = 0;
  const auto found = fit.amplitudes();
  for (std::size_t i = 0; i < known.size(); ++i) worst = std::max(worst, std::abs(found[i] - known[i]));
  return worst;
}

const auto exact = [](long, double) { return 0.0; };

}  // namespace

TEST_CASE("the fit recovers amplitudes to rounding, over short and long times and beside a large constant") {
  struct Window {
    double from, to, interval, constant;
  };
  for (const auto& [from, to, interval, constant] :
       {Window{3, 9, 0.01, 0}, Window{1.234, 8.21, 0.013, 0.7}, Window{5, 1005, 0.01, -0.4},
        Window{9000, 9010, 0.01, 0.1}, Window{0, 1.0, 0.01, 0.2}}) {
    INFO("from " << from << " to " << to << " s");
    const SineFit fit = fitted(from, to, interval, constant, exact);
    // Each x is rounded to half of eps of itself.
    const double allowed = response_bound(fit, 1, eps * (std::abs(constant) + 0.02));
    WARN("error " << worst_error(fit) << ", allowed " << allowed << ", condition " << fit.condition());
    CHECK(worst_error(fit) <= allowed);
    CHECK(allowed < 1e-10);
  }
  // Whole periods of all four: the basis is orthogonal, and condition() says so up to its own sqrt(2 m + 1).
  CHECK(fitted(3, 9, 0.01, 0, exact).condition() < 1 + 1e-12);
  CHECK(fitted(0, 1.0, 0.01, 0, exact).condition() > 2);
}

TEST_CASE("an error in the samples makes at most sqrt(2) condition times as much in an amplitude") {
  const double size = 1e-6;
  std::mt19937_64 random(7);
  const auto sign = [&](long, double) { return random() % 2 ? size : -size; };
  // The worst for one amplitude: a square wave in step with its cosine, 4/pi of it.
  const auto in_step = [&](long, double t) { return std::cos(angular(1) * t) > 0 ? size : -size; };
  for (const double to : {1.7, 3.0, 9.0}) {
    const SineFit noisy = fitted(1, to, 0.001, 0.3, sign), aligned = fitted(1, to, 0.001, 0.3, in_step);
    INFO("to " << to << " s, condition " << noisy.condition());
    CHECK(worst_error(noisy) <= std::numbers::sqrt2 * noisy.condition() * size);
    CHECK(worst_error(aligned) <= std::numbers::sqrt2 * aligned.condition() * size);
    CHECK(worst_error(aligned) > size);  // the bound is not far from what can happen
  }
}

TEST_CASE("too little to fit") {
  CHECK_THROWS_AS(SineFit({1, 0}), std::domain_error);
  SineFit empty(frequencies);
  CHECK(std::isinf(empty.condition()));
  CHECK_THROWS_AS(empty.amplitudes(), std::domain_error);
  CHECK_THROWS_AS(fitted(0, 0.08, 0.01, 0, exact).amplitudes(),
                  std::domain_error);  // eight samples for nine numbers
  CHECK_THROWS_AS(fitted(0, 0.01, 1e-5, 0, exact).amplitudes(),
                  std::domain_error);  // a hundredth of a period
  CHECK(std::isinf(response_bound(empty, 1, 0)));
}

TEST_CASE("the designed response in three points that are known") {
  CHECK(std::abs(designed_response(100, 20, 1e-9) - 1.0) < 1e-8);
  // At w = sqrt(K): K / (j D w), a quarter behind.
  CHECK(std::abs(designed_response(100, 20, 10 / angular(1)) - Complex(0, -0.5)) < 4 * eps);
  CHECK(std::abs(designed_response(100, 20, 1000 / angular(1))) ==
        Approx(100 / (1e6 + 100)));  // (10 / |10 + j w|)^2
  CHECK(std::abs(sine_amplitude(2, 0.3) - Complex(0, -2) * std::polar(1.0, 0.3)) < 4 * eps);
}

TEST_CASE("settling time covers the transient, and not by much") {
  for (const auto& [K, D] : {std::pair{100.0, 20.0}, {100.0, 5.0}, {100.0, 90.0}, {4.0, 0.1}})
    for (const double share : {1e-3, 1e-9}) {
      const double t = settling_time(K, D, share), w = std::sqrt(K);
      INFO("K " << K << ", D " << D << ", share " << share << ": " << t << " s");
      double left = 0, before = 0;
      for (const ErrorState start : {ErrorState{1, 0}, {0, w}, {0.5, -w / 2}})
        for (int i = 0; i < 100; ++i) {
          const auto size = [&](double at) {
            const ErrorState s = linear_response(K, D, start, at);
            return std::max(std::abs(s.e), std::abs(s.ed) / w);
          };
          left = std::max(left, size(t * (1 + i * 0.01)));
          before = std::max(before, size(t * (0.3 + i * 0.001)));
        }
      CHECK(left <=
            share *
                (1 + 8 * eps * (1 + w * t)));  // a critically damped axis reaches it; exp(-w t) is rounded
      CHECK(before > share);
    }
  CHECK(std::isinf(settling_time(100, 0, 1e-3)));
  CHECK(std::isinf(settling_time(0, 20, 1e-3)));
  CHECK(settling_time(100, 20, 2) == 0);
}

TEST_CASE("gain and phase of a linear axis are the designed ones, and a wrong damping is noticed") {
  for (const auto& [K, D] : {std::pair{100.0, 20.0}, {400.0, 10.0}, {100.0, 60.0}}) {
    // r = sum A sin(w t + phase) - its value at 0; x starts at rest at 0.
    std::vector<Complex> reference, forced;
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      reference.push_back(sine_amplitude(0.005, -0.7 * static_cast<double>(i * i)));
      forced.push_back(reference[i] * designed_response(K, D, frequencies[i]));
    }
    const double constant = -sum_of_sines(reference, 0);
    double rate = 0;
    for (std::size_t i = 0; i < forced.size(); ++i)
      rate += (Complex(0, angular(frequencies[i])) * forced[i]).real();
    const ErrorState start{-constant - sum_of_sines(forced, 0), -rate};
    const double share = 1e-8, from = settling_time(K, D, share);
    SineFit fit(frequencies);
    for (int i = 0; i < 4000; ++i) {
      const double t = from + 0.01 * i;
      fit.add(t, constant + sum_of_sines(forced, t) + linear_response(K, D, start, t).e);
    }
    const double left = share * (std::abs(start.e) + std::abs(start.ed) / std::sqrt(K));
    const FrequencyResponse right = compare(fit, reference, K, D, left + 4 * eps);
    WARN("K " << K << ", D " << D << ": worst " << right.worst << ", bound " << right.bound << " at "
              << right.at);
    REQUIRE(right.points.size() == 4);
    for (const FrequencyPoint& p : right.points) {
      CHECK(p.error <= p.bound);
      CHECK(p.gain == Approx(p.designed_gain).epsilon(1e-6));
      CHECK(p.phase == Approx(p.designed_phase).epsilon(1e-6));
      CHECK(p.phase < 0);
    }
    CHECK(right.worst <= right.bound);
    const FrequencyResponse wrong = compare(fit, reference, K, D * (1 + 1e-5), left + 4 * eps);
    CHECK(wrong.worst > wrong.bound);
  }
  CHECK_THROWS_AS(compare(fitted(0, 4, 0.01, 0, exact), {1.0}, 100, 20, 0), std::domain_error);
}

}  // namespace osculate::testing::frequency_tests
