// Growth of the error, cross coupling and departures: what they say of made-up runs.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "support/catch.hpp"
#include "verification/cross_coupling.hpp"
#include "verification/departure.hpp"
#include "verification/error_growth.hpp"

namespace osculate::testing::linear_checks_tests {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

ErrorGrowth grown(const std::function<double(double)>& error, double to = 10'000, double step = 0.0625) {
  ErrorGrowth growth;
  growth.add(0, error(0));
  for (long i = 1; static_cast<double>(i) * step <= to; ++i)
    growth.add(static_cast<double>(i) * step, error(static_cast<double>(i) * step));
  return growth;
}

}  // namespace

TEST_CASE("the exponent of a power is found and worded") {
  struct Case {
    double exponent;
    std::string word;
  };
  for (const auto& [exponent, word] :
       {Case{0, "bounded"}, Case{0.5, "linear"}, Case{1, "linear"}, Case{1.5, "worse"}, Case{2, "worse"}}) {
    INFO("t^" << exponent);
    const double by = exponent;
    const GrowthFit fit = grown([by](double t) { return 1e-9 * std::pow(t, by); }).fit();
    // The peak of a bin is at its end, which is on the line itself; what is left is the rounding of the
    // logarithms.
    CHECK(fit.exponent == Approx(exponent).margin(1e-9));
    CHECK(fit.spread < 1e-9);
    CHECK(fit.word == word);
    // With an oscillation from nothing to twice the mean the peaks still are on the line, and bins without a
    // peak below it by less than a tenth of their distance.
    const auto waves = [by](double t) { return 1e-9 * std::pow(t, by) * (1 + std::sin(0.37 * t)); };
    CHECK(grown(waves).fit().word == word);
    CHECK(grown(waves).fit().exponent == Approx(exponent).margin(0.05));
  }
}

TEST_CASE("bounded errors of every kind") {
  std::mt19937_64 random(3);
  const auto noise = [&](double) { return 1e-15 * static_cast<double>(random() >> 11) * 0x1p-53; };
  CHECK(grown(noise).fit().word == "bounded");
  CHECK(grown([](double t) { return std::exp(-t); }).fit().word == "bounded");
  CHECK(grown([](double t) { return 1 - std::exp(-t / 3); }).fit().word == "bounded");
  // Slower than the bins: three periods in the run.
  CHECK(grown([](double t) { return std::abs(std::sin(6e-4 * std::numbers::pi * t)); }).fit().word ==
        "bounded");
  CHECK(grown([](double) { return 0.0; }).fit().word == "bounded");
  // Growth within rounding is none.
  const auto tiny = grown([](double t) { return 1e-19 * t; });
  CHECK(tiny.fit().word == "linear");
  CHECK(tiny.fit(1e-15).word == "bounded");
}

TEST_CASE("random walks grow with the root of time on average, and exponential growth is worse than linear") {
  std::mt19937_64 random(11);
  double mean = 0, squares = 0;
  const int walks = 200;
  for (int i = 0; i < walks; ++i) {
    double x = 0;
    const GrowthFit fit =
        grown([&](double) { return std::abs(x += random() % 2 ? 1e-16 : -1e-16); }, 10'000, 1).fit();
    mean += fit.exponent / walks;
    squares += fit.exponent * fit.exponent / walks;
  }
  const double scatter = std::sqrt(squares - mean * mean);
  WARN("exponent of a random walk: " << mean << " +- " << scatter);
  CHECK(std::abs(mean - 0.5) < 4 * scatter / std::sqrt(walks));
  CHECK(grown([](double t) { return std::exp(t / 500); }).fit().word == "worse");
  CHECK(grown([](double t) { return t > 7000 ? std::nan("") : 0.0; }).fit().word == "worse");
}

TEST_CASE("bins: constant memory, the largest error kept, too little to fit") {
  ErrorGrowth growth;
  CHECK(growth.bins().empty());
  CHECK(growth.fit().word == "");
  growth.add(0, 3);
  CHECK(growth.fit().word == "");
  for (int i = 1; i <= 1000; ++i) growth.add(i * 0.25, i == 700 ? 9 : 1);
  const auto bins = growth.bins();
  CHECK(bins.size() == 125);  // 250 s in bins of 2 s
  CHECK(bins.front().end == 2);
  CHECK(bins.front().error == 3);
  CHECK(bins.back().end == 250);
  for (const auto& bin : bins)
    if (bin.end != 2) CHECK(bin.error == (bin.end == 176 ? 9 : 1));  // 175 s is in (174, 176]
  ErrorGrowth few;
  for (int i = 1; i <= 8; ++i) few.add(i, i);
  CHECK(few.fit().word == "");  // from sqrt(8) s on there are six bins
  ErrorGrowth sparse;
  sparse.add(1, 1);
  sparse.add(1e6, 2);
  CHECK(sparse.bins().size() <= 128);
  CHECK(sparse.bins().back().error == 2);
}

TEST_CASE("cross coupling keeps the worst of each pair of axes while one alone is commanded") {
  CrossCoupling coupling;
  CHECK(coupling.worst().array().isNaN().all());
  Vector6 off = Vector6::Zero();
  off[1] = -2;
  off[5] = 1;
  coupling.add({false, false, false, true, false, false}, 0.5, off);
  off[1] = 1;
  off[5] = -4;
  coupling.add({false, false, false, true, false, false}, 1.5, off);
  coupling.add({false, false, false, true, true, false}, 2.5, 10 * off);  // two: not counted
  coupling.add({}, 2.5, 10 * off);
  off[0] = std::nan("");
  coupling.add({true, false, false, false, false, false}, 3.5, off);
  CHECK(coupling.worst()(3, 1) == 2);
  CHECK(coupling.time()(3, 1) == 0.5);
  CHECK(coupling.worst()(3, 5) == 4);
  CHECK(coupling.time()(3, 5) == 1.5);
  CHECK(coupling.worst()(3, 0) == 0);
  CHECK(coupling.time()(3, 0) == 0.5);
  CHECK(coupling.worst()(0, 0) == infinite);
  for (const int row : {1, 2, 4, 5}) {
    CHECK(coupling.worst().row(row).array().isNaN().all());
    CHECK(coupling.time().row(row).array().isNaN().all());
  }
}

TEST_CASE("departures: peaks and their times, root mean square, on the task rows alone") {
  Departure departure({0, 3, 4}, {0, 3, 4});
  const std::vector<double> T{1, -5}, later{-2, 4};
  DepartureInput at;
  at.error << 0.5, 9, 9, 3, 4, 9;
  at.u << 1, 0, 0, 2, 0, 0;
  at.torque = T;
  departure.add(0, 0, at);
  at.error << -1, 9, 9, 0, 0, 9;
  at.tip_acceleration << 1, 7, 7, 5, 4, 7;
  at.torque = later;
  at.singularity_policy = true;
  departure.add(2, 2, at);
  departure.add(2.5, 0.5, at);
  at.singularity_policy = false;
  departure.add(3, 0.5, at);
  const DepartureResult r = departure.result();
  CHECK(r.angular_acceleration.value == 1);
  CHECK(r.angular_acceleration.time == 0);
  CHECK(r.linear_acceleration.value == 5);
  CHECK(r.linear_acceleration.time == 2);
  CHECK(r.orientation.value == 1);
  CHECK(r.orientation.time == 2);
  CHECK(r.position.value == 5);
  CHECK(r.position.time == 0);
  CHECK(r.orientation_rms == Approx(std::sqrt((1.25 + 1) / 3)));
  CHECK(r.position_rms == Approx(std::sqrt(25.0 / 3)));
  REQUIRE(r.torque.size() == 2);
  CHECK(r.torque[0].value == 2);
  CHECK(r.torque[0].time == 2);
  CHECK(r.torque[1].value == 5);
  CHECK(r.torque[1].time == 0);
  CHECK(r.singularity_policy.total == 2.5);
  CHECK(r.singularity_policy.first == 2);
  CHECK(r.singularity_policy.last == 2.5);
  CHECK(r.beyond_position.empty());
}

TEST_CASE("the root mean square of a sine over whole periods") {
  Departure departure(all_rows(), all_rows());
  DepartureInput at;
  const int steps = 1000;
  for (int i = 0; i <= steps; ++i) {
    at.error[3] = std::sin(2 * std::numbers::pi * i / steps);
    departure.add(i * 0.01, i == 0 ? 0 : 0.01, at);
  }
  // Trapezoids over whole periods of sin^2 are exact.
  CHECK(departure.result().position_rms == Approx(std::sqrt(0.5)).epsilon(1e-13));
  CHECK(departure.result().orientation_rms == 0);
}

TEST_CASE("time beyond the limits of the joints") {
  Departure departure({3}, {3}, {{-1, -infinite}, {1, infinite}, {2, infinite}, {3, 3}});
  DepartureInput at;
  const auto step = [&](double t, std::vector<double> q, std::vector<double> qd, std::vector<double> T) {
    at.q = q, at.qd = qd, at.torque = T;
    departure.add(t, 1, at);
  };
  step(1, {1, 100}, {2, 100}, {3, -3});  // at the limit is not beyond it
  step(2, {1.5, 0}, {-3, 0}, {0, -4});
  step(3, {0, 0}, {0, 0}, {0, 0});
  step(4, {-1.5, 0}, {0, 0}, {std::nan(""), 0});
  const DepartureResult r = departure.result();
  REQUIRE(r.beyond_position.size() == 2);
  CHECK(r.beyond_position[0].total == 2);
  CHECK(r.beyond_position[0].first == 2);
  CHECK(r.beyond_position[0].last == 4);
  CHECK(r.beyond_position[1].total == 0);
  CHECK(!r.beyond_position[1].first);
  CHECK(r.beyond_velocity[0].total == 1);
  CHECK(r.beyond_effort[0].first == 4);
  CHECK(r.beyond_effort[1].first == 2);
  CHECK(r.beyond_effort[1].total == 1);
  CHECK(r.torque[0].value == infinite);
}

}  // namespace osculate::testing::linear_checks_tests
