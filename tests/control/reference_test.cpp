#include "control/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/differences.hpp"
#include "control/rotation.hpp"
#include "control/wide_rotation.hpp"
#include "support/catch.hpp"

namespace osculate::testing::reference_tests {
using namespace osculate::test;

namespace {

Vector6 vector6(double a, double b, double c, double d, double e, double f) {
  Vector6 out;
  out << a, b, c, d, e, f;
  return out;
}

/// yd and ydd against central differences of y and yd. Rounding: values wrong by 8 eps of their size (which
/// includes the angle of a sine, up to 20 rad here), times 2.1 / h.
void check_derivatives(const Path& path, std::initializer_list<double> times, double h) {
  for (const double t : times) {
    const auto point = path.at(t);
    const auto yd = first_difference([&](double x) -> Vector6 { return path.at(x).y; }, t, h);
    const auto ydd = first_difference([&](double x) -> Vector6 { return path.at(x).yd; }, t, h);
    INFO("t " << t);
    const double speed = point.yd.norm() + point.ydd.norm() + 1;
    const double rounding = 8 * eps * 2.1 / h * (point.y.norm() + speed);
    CHECK((point.yd - yd.value).norm() <= rounding + yd.truncation.norm() / 64);
    CHECK((point.ydd - ydd.value).norm() <= rounding * 20 + ydd.truncation.norm() / 64);
    CHECK(yd.truncation.norm() + ydd.truncation.norm() < 1e-7);
  }
}

std::string error_of(const auto& options) {
  try {
    make_path(options);
  } catch (const ReferenceError& error) { return error.what(); }
  return "no error";
}

const LissajousOptions lissajous{vector6(0.7, 0.4, 1.1, 0.1, 0.2, 0.3), vector6(2, 3, 5, 2.5, 4, 7),
                                 vector6(0, 0.5, 1, 1.5, 2, -0.5)};
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("hold stays") {
  const auto path = make_path(HoldOptions{});
  const auto point = path->at(3);
  CHECK(point.y == Vector6::Zero());
  CHECK(point.yd == Vector6::Zero());
  CHECK(point.ydd == Vector6::Zero());
  CHECK(path->commanded() == std::array<bool, 6>{});
  CHECK(path->breakpoints().empty());
}

TEST_CASE("step jumps at its time and moves at no other") {
  const Vector6 offset = vector6(0, 0.5, 0, 0.1, 0, 0);
  const auto path = make_path(StepOptions{offset, 2});
  CHECK(path->at(std::nextafter(2.0, 0.0)).y == Vector6::Zero());
  CHECK(path->at(2).y == offset);
  CHECK(path->at(2).yd == Vector6::Zero());
  CHECK(path->at(5).ydd == Vector6::Zero());
  CHECK(path->commanded() == std::array<bool, 6>{false, true, false, true, false, false});
  CHECK(path->breakpoints() == std::vector<double>{2});
  CHECK(path->commanded_from(0) == std::array<bool, 6>{});
  CHECK(path->commanded_from(2) == path->commanded());
  const auto at_once = make_path(StepOptions{offset, 0});
  CHECK(at_once->at(0).y == offset);
  CHECK(at_once->breakpoints().empty());
}

TEST_CASE("line: minimum-jerk timing, at rest outside, two derivatives continuous") {
  const Vector6 offset = vector6(0.2, -0.4, 0.6, 0.1, 0, -0.3);
  const auto path = make_path(LineOptions{offset, 0.5, 2});
  CHECK(path->at(0.25).y == Vector6::Zero());
  CHECK(path->at(2.5).y == offset);
  CHECK(path->at(9).yd == Vector6::Zero());
  CHECK((path->at(1.5).y - offset / 2).norm() <= 4 * eps * offset.norm());
  CHECK((path->at(1.5).yd - offset * (15.0 / 16)).norm() <=
        4 * eps * offset.norm());  // peak 15/8 of the mean
  check_derivatives(*path, {0.7, 1.0, 1.5, 2.3}, 0.02);
  CHECK(path->breakpoints() == std::vector<double>{0.5, 2.5});
  CHECK(make_path(LineOptions{offset, 0, 2})->breakpoints() == std::vector<double>{2});
  for (const double t : path->breakpoints())
    for (const double side : {-1e-9, 1e-9}) {
      const auto here = path->at(t), near = path->at(t + side);
      // Over 1e-9 s: third derivative at most 60 |offset| / 8 per s^3.
      CHECK((near.ydd - here.ydd).norm() <= 7.5 * offset.norm() * 1.001e-9);
      CHECK((near.yd - here.yd).norm() <= 7.5 * offset.norm() * 1e-18);
      CHECK((near.y - here.y).norm() <= 2 * eps * offset.norm());
    }
  CHECK(path->commanded() == std::array<bool, 6>{true, true, true, true, false, true});
}

TEST_CASE("circle: starts at the tip along the second axis, around a centre on the negative first axis") {
  const std::string axes = "xyz";
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const std::string plane{axes[i], axes[j]};
      const double radius = 0.15, period = 2.5, rate = 2 * 3.141592653589793 / period;
      const auto path = make_path(CircleOptions{radius, period, plane});
      INFO("plane " << plane);
      CHECK(path->at(0).y == Vector6::Zero());
      CHECK((path->at(0).yd - radius * rate * Vector6::Unit(3 + j)).norm() <= 4 * eps);
      CHECK((path->at(0).ydd + radius * rate * rate * Vector6::Unit(3 + i)).norm() <= 8 * eps);
      const Vector6 centre = -radius * Vector6::Unit(3 + i);
      for (int k = 0; k <= 50; ++k) {
        const auto point = path->at(0.1 * k);
        CHECK(std::abs((point.y - centre).norm() - radius) <= 4 * eps * radius);
        CHECK(std::abs(point.yd.norm() - radius * rate) <= 4 * eps * radius * rate);
        CHECK(std::abs(point.yd.dot(point.y - centre)) <= 4 * eps * radius * radius * rate);
        CHECK((point.ydd + rate * rate * (point.y - centre)).norm() <= 8 * eps * radius * rate * rate);
      }
      CHECK((path->at(period / 4).y - centre - radius * Vector6::Unit(3 + j)).norm() <= 4 * eps * radius);
      check_derivatives(*path, {0, 0.3, 1.7, 4.2}, 0.02);
      std::array<bool, 6> expected{};
      expected[3 + i] = expected[3 + j] = true;
      CHECK(path->commanded() == expected);
      CHECK(path->breakpoints().empty());
    }
  CHECK(make_path(CircleOptions{0, 1, "xy"})->commanded() == std::array<bool, 6>{});
}

TEST_CASE("Lissajous: starts at the tip, derivatives, period of each row") {
  const auto path = make_path(lissajous);
  CHECK(path->at(0).y == Vector6::Zero());
  check_derivatives(*path, {0, 0.4, 1.9, 6.3}, 0.02);
  for (int i = 0; i < 6; ++i)
    CHECK(std::abs(path->at(0.3 + lissajous.period[i]).y[i] - path->at(0.3).y[i]) <= 16 * eps);
  CHECK(path->commanded() == std::array<bool, 6>{true, true, true, true, true, true});
}

TEST_CASE("each axis: jumps there and back on one row after the other, again and again") {
  const Vector6 amplitude = vector6(0, 0.3, 0, -0.1, 0, 0.2);
  const double period = 0.7;  // its multiples are rounded
  const auto path = make_path(EachAxisOptions{amplitude, period}, 4.3);
  const std::array<int, 3> rows{1, 3, 5};
  std::vector<double> expected;
  for (int half = 1; half <= 12; ++half) expected.push_back(half * (period / 2));  // 4.2 s is the last
  CHECK(path->breakpoints() == expected);
  CHECK(path->at(0).y == Vector6(0.3 * Vector6::Unit(1)));
  for (int half = 0; half <= 12; ++half) {
    const double begin = half == 0 ? 0 : expected[half - 1], end = (half + 1) * (period / 2);
    const int row = rows[half / 2 % 3];
    const Vector6 y = (half % 2 == 0 ? amplitude[row] : 0) * Vector6::Unit(row);
    std::array<bool, 6> alone{};
    alone[row] = true;
    for (const double t : {begin, (begin + end) / 2, std::nextafter(end, 0.0)}) {
      INFO("t " << t);
      CHECK(path->at(t).y == y);
      CHECK(path->at(t).yd == Vector6::Zero());
      CHECK(path->at(t).ydd == Vector6::Zero());
      CHECK(path->commanded_from(t) == alone);
    }
  }
  CHECK(path->commanded() == std::array<bool, 6>{false, true, false, true, false, true});
  CHECK(path->at(-1e-9).y == Vector6::Zero());
  CHECK(path->commanded_from(-1e-9) == std::array<bool, 6>{});
  // A jump at the very end is outside the run.
  CHECK(make_path(EachAxisOptions{amplitude, 2}, 3)->breakpoints() == std::vector<double>{1, 2});
  const auto nothing = make_path(EachAxisOptions{}, 10);
  CHECK(nothing->at(3).y == Vector6::Zero());
  CHECK(nothing->breakpoints().empty());
  CHECK(nothing->commanded_from(3) == std::array<bool, 6>{});
}

TEST_CASE("each axis: value changes exactly at its breakpoints") {
  for (const double period : {0.1, 0.3, 1.0 / 3, 4.0, 3.141592653589793}) {
    const auto path = make_path(EachAxisOptions{Vector6::Ones(), period}, 400 * period);
    int wrong = 0;
    const auto jumps = path->breakpoints();
    CHECK(jumps.size() == 799);
    for (const double t : jumps) wrong += path->at(t).y == path->at(std::nextafter(t, 0.0)).y;
    for (const double t : jumps) wrong += path->at(t).y != path->at(std::nextafter(t, 1e9)).y;
    CHECK(wrong == 0);
  }
}

TEST_CASE("multisine: starts at the tip, derivatives, periodic, its peak below the sum of amplitudes") {
  for (int row = 0; row < 6; ++row) {
    const auto path = make_path(MultisineOptions{row, 0.02, {0.25, 0.5, 0.75}});
    CHECK(path->at(0).y == Vector6::Zero());
    check_derivatives(*path, {0, 0.4, 1.9, 3.3}, 0.02);
    const auto here = path->at(0.3), later = path->at(4.3);
    CHECK(here.y[row] != 0);
    // An angle of 20 rad is wrong by 2 eps of it.
    CHECK(std::abs(here.y[row] - later.y[row]) <= 3 * 0.02 * 40 * eps);
    std::array<bool, 6> alone{};
    alone[row] = true;
    CHECK(path->commanded() == alone);
    CHECK(path->commanded_from(1) == alone);
    for (int i = 0; i < 6; ++i)
      if (i != row) CHECK((here.y[i] == 0 && here.yd[i] == 0 && here.ydd[i] == 0));
  }
  for (const std::vector<double>& frequencies :
       {MultisineOptions{}.frequencies, {1, 2}, {1, 2, 3}, {0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4}}) {
    const auto path = make_path(MultisineOptions{4, 1, frequencies});
    double peak = 0;
    for (double t = 0; t < 2; t += 1e-3) peak = std::max(peak, std::abs(path->at(t).y[4]));
    INFO(frequencies.size() << " sines");
    CHECK(peak < static_cast<double>(frequencies.size()));
    CHECK(peak > 1);
  }
  CHECK(make_path(MultisineOptions{2, 0, {1}})->commanded() == std::array<bool, 6>{});
}

TEST_CASE("multisine: every sine has the amplitude, phases after Schroeder whatever the order") {
  const double amplitude = 0.5;
  const std::vector<double> frequencies{1, 2, 3, 4};
  const auto path = make_path(MultisineOptions{3, amplitude, frequencies});
  const auto shuffled = make_path(MultisineOptions{3, amplitude, {3, 1, 4, 2}});
  const double pi = 3.141592653589793;
  for (int k = 1; k <= 4; ++k) {
    // Fourier coefficients over one period by 64 samples, exact for 4 harmonics.
    double c = 0, s = 0;
    for (int i = 0; i < 64; ++i) {
      const double y = path->at(i / 64.0).y[3];
      CHECK(y == shuffled->at(i / 64.0).y[3]);
      c += y * std::cos(2 * pi * k * i / 64) / 32;
      s += y * std::sin(2 * pi * k * i / 64) / 32;
    }
    const double phase = -pi * k * (k - 1) / 4;
    CHECK(std::abs(s - amplitude * std::cos(phase)) <= 64 * eps);
    CHECK(std::abs(c - amplitude * std::sin(phase)) <= 64 * eps);
  }
}

TEST_CASE("tip reference: pose, angular velocity and acceleration are consistent") {
  const auto path = make_path(lissajous);
  Pose initial;
  initial.R = exp_rotation({0.3, -1.2, 0.8});
  initial.p << 0.5, -0.1, 0.9;
  const auto start = tip_reference(*path, initial, 0);
  CHECK((start.pose.R - initial.R).norm() <= 2 * eps);
  CHECK(start.pose.p == initial.p);
  const double h = 0.02, rounding = 8 * eps * 2.1 / h;
  for (const double t : {0.0, 0.7, 1.3, 2.9, 8.1}) {
    INFO("t " << t);
    const auto now = tip_reference(*path, initial, t);
    const auto point = path->at(t);
    CHECK((now.pose.p - initial.p - point.y.tail<3>()).norm() <= 2 * eps);
    const Eigen::Matrix3d R =
        (power_series(point.y.head<3>().cast<Wide>(), WideVector::Zero(), 0).value * initial.R.cast<Wide>())
            .cast<double>();
    CHECK((now.pose.R - R).norm() <= 16 * eps);
    const auto Rd = first_difference(
        [&](double x) -> Eigen::Matrix3d { return tip_reference(*path, initial, x).pose.R; }, t, h);
    const Eigen::Matrix3d spin = Rd.value * now.pose.R.transpose();
    CHECK((spin - cross_matrix(now.velocity.head<3>())).norm() <= 4 * rounding + Rd.truncation.norm() / 64);
    const auto vd = first_difference(
        [&](double x) -> Vector6 { return tip_reference(*path, initial, x).velocity; }, t, h);
    CHECK((vd.value - now.acceleration).norm() <=
          rounding * (1 + now.velocity.norm() + now.acceleration.norm()) + vd.truncation.norm() / 64);
    CHECK(Rd.truncation.norm() + vd.truncation.norm() < 1e-5);
  }
}

TEST_CASE("options that cannot be used are named with value and remedy") {
  Vector6 bad = Vector6::Zero();
  bad[2] = not_a_number;
  CHECK(error_of(StepOptions{bad, 0}) == "reference.offset[2] = nan rad: must be a finite number.");
  CHECK(error_of(StepOptions{Vector6::Zero(), infinity}) == "reference.at = inf s: must be a finite number.");
  CHECK(error_of(LineOptions{bad, 0, 1}) == "reference.offset[2] = nan rad: must be a finite number.");
  CHECK(error_of(LineOptions{Vector6::Zero(), not_a_number, 1}) ==
        "reference.start = nan s: must be a finite number.");
  CHECK(error_of(LineOptions{Vector6::Zero(), 0, 0}) == "reference.duration = 0 s: must be > 0.");
  CHECK(error_of(LineOptions{Vector6::Zero(), 0, not_a_number}) ==
        "reference.duration = nan s: must be a finite number.");
  CHECK(error_of(CircleOptions{-0.1, 1, "yz"}) == "reference.radius = -0.1 m: must be >= 0.");
  CHECK(error_of(CircleOptions{infinity, 1, "yz"}) == "reference.radius = inf m: must be a finite number.");
  CHECK(error_of(CircleOptions{0.1, -2, "yz"}) == "reference.period = -2 s: must be > 0.");
  for (const std::string plane : {"yy", "yw", "x", "xyz", "", "YZ"})
    CHECK(error_of(CircleOptions{0.1, 1, plane}) ==
          "reference.plane = '" + plane + "': must be two different letters of x, y, z, for instance yz.");
  LissajousOptions options;
  options.amplitude[4] = -infinity;
  CHECK(error_of(options) == "reference.amplitude[4] = -inf m: must be a finite number.");
  options = {};
  options.period[1] = 0;
  CHECK(error_of(options) == "reference.period[1] = 0 s: must be > 0.");
  options = {};
  options.phase[5] = not_a_number;
  CHECK(error_of(options) == "reference.phase[5] = nan rad: must be a finite number.");
  CHECK(error_of(CircleOptions{}) == "no error");
  CHECK(error_of(MultisineOptions{6, 1, {1}}) == "reference.row = 6: must be 0 to 5.");
  CHECK(error_of(MultisineOptions{-1, 1, {1}}) == "reference.row = -1: must be 0 to 5.");
  CHECK(error_of(MultisineOptions{3, infinity, {1}}) ==
        "reference.amplitude = inf m: must be a finite number.");
  CHECK(error_of(MultisineOptions{0, 1, {}}) == "reference.frequencies = []: must have at least one entry.");
  CHECK(error_of(MultisineOptions{0, 1, {1, 0}}) == "reference.frequencies[1] = 0 Hz: must be > 0.");
  CHECK(error_of(MultisineOptions{0, 1, {2, 1, 2}}) ==
        "reference.frequencies = 2 Hz: must not be there twice.");
  CHECK_THROWS_WITH(make_path(EachAxisOptions{bad, 1}, 1),
                    "reference.amplitude[2] = nan rad: must be a finite number.");
  CHECK_THROWS_WITH(make_path(EachAxisOptions{Vector6::Ones(), 0}, 1),
                    "reference.period = 0 s: must be > 0.");
  CHECK_THROWS_WITH(make_path(EachAxisOptions{Vector6::Ones(), 1e-6}, 1),
                    "reference.period = 1e-06 s: must be at least 2e-06 s, for at most a million jumps.");
}

}  // namespace osculate::testing::reference_tests
