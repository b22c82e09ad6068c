// Slopes, table and file of a sweep, from made-up runs; real runs are in tests/cli/test_sweep.py.
#include "experiment/sweep.hpp"

#include <cmath>
#include <limits>

#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::sweep_tests {
using Catch::Matchers::Contains;

namespace {

constexpr double none = SweepRun::none;
// Below: logarithms of at most 6, three decades apart at least; a slope from their differences is within 100
// eps.
constexpr double tol = 100 * eps;

/// Complete runs whose tip error is 3 value^2 and whose missed acceleration does not depend on it.
SweepResult square_law(const std::vector<double>& values) {
  SweepResult result;
  result.name = "made_up";
  result.key = "plant.payload.mass";
  for (const double value : values) {
    SweepRun& run = result.runs.emplace_back();
    run.name = std::to_string(value);
    run.value = value;
    run.status = "complete";
    run.verdict = "pass";
    run.position = 3 * value * value;
    run.linear_missed = 0.5;
    run.angular_missed = 0;
    run.torque = 12.5;
    run.torque_joint = 2;
    run.exit_code = 0;
  }
  return result;
}

std::string single_spaced(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' || !out.ends_with(' ')) out += c;
  return out;
}

const Slope& slope_of(const std::vector<Slope>& slopes, const std::string& quantity) {
  for (const Slope& slope : slopes)
    if (slope.quantity == quantity) return slope;
  throw std::out_of_range(quantity);
}

const Table& table_of(const Ending& ending, const std::string& path) {
  for (const Table& table : ending.tables)
    if (table.path == path) return table;
  throw std::out_of_range(path);
}

}  // namespace

TEST_CASE("a power law has its exponent as slope and no spread") {
  const std::vector<double> values{0.001, 0.1, 1, 100};
  for (const double exponent : {-1.0, 0.0, 0.5, 2.0}) {
    std::vector<double> quantities;
    for (const double x : values) quantities.push_back(7 * std::pow(x, exponent));
    const auto fit = fit_slope(values, quantities);
    REQUIRE(fit);
    CHECK(std::abs(fit->slope - exponent) <= tol);
    CHECK(fit->spread <= tol);
    CHECK(fit->points == 4);
    REQUIRE(fit->between.size() == 4);
    CHECK(std::isnan(fit->between[0]));
    for (std::size_t i = 1; i < 4; ++i) CHECK(std::abs(fit->between[i] - exponent) <= tol);
  }
}

TEST_CASE("slope and spread of points off a line, by hand") {
  // log10: x = 0 1 2, y = 0 0 3. Slope 3/2, intercept -1/2, residuals 1/2 -1 1/2: mean square 1/2.
  const auto fit = fit_slope(std::vector<double>{1, 10, 100}, std::vector<double>{1, 1, 1000});
  REQUIRE(fit);
  CHECK(std::abs(fit->slope - 1.5) <= tol);
  CHECK(std::abs(fit->spread - std::sqrt(0.5)) <= tol);
  CHECK(std::abs(fit->between[1] - 0) <= tol);
  CHECK(std::abs(fit->between[2] - 3) <= tol);
}

TEST_CASE("points that have no logarithm are left out") {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, none, infinite}) {
    const auto fit = fit_slope(std::vector<double>{1, 10, 100, 1000}, std::vector<double>{1, bad, 1e4, 1e6});
    REQUIRE(fit);
    CHECK(fit->points == 3);
    CHECK(std::abs(fit->slope - 2) <= tol);
    CHECK(std::isnan(fit->between[1]));
    CHECK(std::isnan(fit->between[2]));
    CHECK(std::abs(fit->between[3] - 2) <= tol);
    CHECK_FALSE(fit_slope(std::vector<double>{1, 10, 100}, std::vector<double>{1, bad, 1e4}));
  }
  CHECK_FALSE(fit_slope(std::vector<double>{2, 2, 2}, std::vector<double>{1, 2, 3}));
  CHECK_FALSE(fit_slope({}, {}));
}

TEST_CASE("slopes need three positive values") {
  const auto found = slopes(square_law({1, 10, 100}));
  CHECK(std::abs(slope_of(found, "tip_error_position").fit.value().slope - 2) <= tol);
  CHECK(std::abs(slope_of(found, "missed_acceleration_linear").fit.value().slope) <= tol);
  CHECK_FALSE(slope_of(found, "missed_acceleration_angular").fit);  // all zero
  CHECK_FALSE(slope_of(found, "global_error_position").fit);        // not measured
  CHECK(slopes(square_law({1, 10})).empty());
  CHECK(slopes(square_law({0, 1, 10, 100})).empty());
  auto unnamed = square_law({1, 10, 100});
  unnamed.runs[1].value.reset();
  CHECK(slopes(unnamed).empty());
}

TEST_CASE("a run that stopped early counts in no slope") {
  auto result = square_law({1, 10, 100, 1000});
  result.runs[3].position = 1;
  CHECK(slope_of(slopes(result), "tip_error_position").fit.value().slope < 1);
  result.runs[3].status = "failed";
  const auto fit = slope_of(slopes(result), "tip_error_position").fit.value();
  CHECK(fit.points == 3);
  CHECK(std::abs(fit.slope - 2) <= tol);
}

TEST_CASE("the report has a line for each variant and each slope") {
  auto result = square_law({1, 10, 100});
  result.runs[2].message = "claim lambda failed";
  const std::string text = report(result);
  CHECK_THAT(text, Contains("made_up, over plant.payload.mass\n"));
  CHECK_THAT(single_spaced(text), Contains("\n1.000000 complete pass 3e+03 - - 0.5 0 12.5 2 - - - - - -\n"));
  CHECK_THAT(text, Contains("\n100.000000: claim lambda failed\n"));
  CHECK_THAT(text, Contains("d log(quantity) / d log(plant.payload.mass)"));
  CHECK_THAT(single_spaced(text), Contains("\ntip error, position 2.000 0.0000 2.000 2.000\n") &&
                                      !Contains("missed acceleration, angular"));
  CHECK_THAT(report(square_law({1, 10})), Contains("no slopes: they need at least 3 values, all above 0"));
}

TEST_CASE("what goes into the file fits its layout") {
  auto result = square_law({1, 10, 100});
  result.runs.push_back({});  // not run
  result.runs[3].name = "later";
  result.runs[3].value = 1000;
  const Ending ending = sweep_ending(result);
  const auto& position = table_of(ending, "tip_error_position");
  CHECK(position.axes == std::vector<std::string>{"variant"});
  CHECK(position.values[1] == 300);
  CHECK(std::isnan(position.values[3]));
  CHECK(std::isnan(table_of(ending, "exit_code").values[3]));
  CHECK(table_of(ending, "value").values == std::vector<double>{1, 10, 100, 1000});
  const std::size_t fitted = slopes(result).size();
  CHECK(ending.axes.at(0).labels.size() == fitted);
  CHECK(table_of(ending, "slopes/slope").values.size() == fitted);
  CHECK(table_of(ending, "slopes/between").values.size() == fitted * 4);
  CHECK(std::abs(table_of(ending, "slopes/between").values[2] - 2) <= tol);

  auto words = square_law({1, 10});
  words.runs[0].value.reset();
  CHECK(sweep_ending(words).axes.empty());
  CHECK_THROWS_AS(table_of(sweep_ending(words), "value"), std::out_of_range);
  CHECK(sweep_layout(words, {}, {}).axes.at(0).labels == std::vector<std::string>{"1.000000", "10.000000"});
}

TEST_CASE("status and verdict of a sweep") {
  auto result = square_law({1, 10});
  CHECK(sweep_status(result) == "complete");
  CHECK(sweep_verdict(result) == "pass");
  result.runs[0].verdict = "as_expected";
  CHECK(sweep_verdict(result) == "as_expected");
  result.exit = Exit::claim_failed;
  CHECK(sweep_verdict(result) == "fail");
  CHECK(sweep_status(result) == "complete");
  result.exit = Exit::terminated;
  CHECK(sweep_status(result) == "interrupted");
}

}  // namespace osculate::testing::sweep_tests
