#include "control/reference.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "control/rotation.hpp"

namespace osculate {

namespace {

std::string text(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

[[noreturn]] void reject(const std::string& name, const std::string& value, const std::string& remedy) {
  throw ReferenceError("reference." + name + " = " + value + ": " + remedy + ".");
}

void require_finite(const std::string& name, double value, const std::string& unit) {
  if (!std::isfinite(value)) reject(name, text(value) + " " + unit, "must be a finite number");
}

void require_positive(const std::string& name, double value, const std::string& unit) {
  require_finite(name, value, unit);
  if (value <= 0) reject(name, text(value) + " " + unit, "must be > 0");
}

std::string entry(const std::string& name, int row) { return name + "[" + std::to_string(row) + "]"; }

/// Rows 0..2 in rad, rows 3..5 in m.
void require_finite(const std::string& name, const Vector6& value) {
  for (int i = 0; i < 6; ++i) require_finite(entry(name, i), value[i], i < 3 ? "rad" : "m");
}

std::array<bool, 6> nonzero(const Vector6& value) {
  std::array<bool, 6> out{};
  for (int i = 0; i < 6; ++i) out[i] = value[i] != 0;
  return out;
}

/// Breakpoints at or before t = 0 are of no interest: nothing is integrated there.
std::vector<double> after_start(std::vector<double> times) {
  std::erase_if(times, [](double t) { return t <= 0; });
  return times;
}

class Hold final : public Path {
 public:
  PathPoint at(double) const override { return {}; }
  std::array<bool, 6> commanded() const override { return {}; }
};

class Step final : public Path {
 public:
  explicit Step(const StepOptions& options) : o(options) {
    require_finite("offset", o.offset);
    require_finite("at", o.at, "s");
  }
  PathPoint at(double t) const override {
    PathPoint out;
    if (t >= o.at) out.y = o.offset;
    return out;
  }
  std::vector<double> breakpoints() const override { return after_start({o.at}); }
  std::array<bool, 6> commanded() const override { return nonzero(o.offset); }

 private:
  StepOptions o;
};

/// Minimum-jerk timing: sigma = 10 x^3 - 15 x^4 + 6 x^5 of the elapsed fraction x; velocity and acceleration
/// are zero at both ends, the third derivative jumps there.
class Line final : public Path {
 public:
  explicit Line(const LineOptions& options) : o(options) {
    require_finite("offset", o.offset);
    require_finite("start", o.start, "s");
    require_positive("duration", o.duration, "s");
  }
  PathPoint at(double t) const override {
    const double x = (t - o.start) / o.duration;
    PathPoint out;
    if (x <= 0) return out;
    if (x >= 1) {
      out.y = o.offset;
      return out;
    }
    out.y = o.offset * (x * x * x * (10 + x * (-15 + x * 6)));
    out.yd = o.offset * (30 * x * x * (1 - x) * (1 - x) / o.duration);
    out.ydd = o.offset * (60 * x * (1 - x) * (1 - 2 * x) / (o.duration * o.duration));
    return out;
  }
  std::vector<double> breakpoints() const override { return after_start({o.start, o.start + o.duration}); }
  std::array<bool, 6> commanded() const override { return nonzero(o.offset); }

 private:
  LineOptions o;
};

class Circle final : public Path {
 public:
  explicit Circle(const CircleOptions& options) : radius(options.radius) {
    require_finite("radius", radius, "m");
    if (radius < 0) reject("radius", text(radius) + " m", "must be >= 0");
    require_positive("period", options.period, "s");
    const std::string axes = "xyz";
    const auto& plane = options.plane;
    if (plane.size() != 2 || plane[0] == plane[1] || axes.find(plane[0]) == std::string::npos ||
        axes.find(plane[1]) == std::string::npos)
      reject("plane", "'" + plane + "'", "must be two different letters of x, y, z, for instance yz");
    first = 3 + static_cast<int>(axes.find(plane[0]));
    second = 3 + static_cast<int>(axes.find(plane[1]));
    rate = 2 * std::numbers::pi / options.period;
  }
  PathPoint at(double t) const override {
    const double c = std::cos(rate * t), s = std::sin(rate * t), half = std::sin(rate * t / 2);
    PathPoint out;
    out.y[first] = -2 * radius * half * half;  // radius (cos - 1) without cancellation
    out.y[second] = radius * s;
    out.yd[first] = -radius * rate * s;
    out.yd[second] = radius * rate * c;
    out.ydd[first] = -radius * rate * rate * c;
    out.ydd[second] = -radius * rate * rate * s;
    return out;
  }
  std::array<bool, 6> commanded() const override {
    std::array<bool, 6> out{};
    out[first] = out[second] = radius != 0;
    return out;
  }

 private:
  double radius, rate;  // m, rad/s
  int first, second;    // rows of y
};

class Lissajous final : public Path {
 public:
  explicit Lissajous(const LissajousOptions& options) : amplitude(options.amplitude), phase(options.phase) {
    require_finite("amplitude", amplitude);
    for (int i = 0; i < 6; ++i) require_positive(entry("period", i), options.period[i], "s");
    for (int i = 0; i < 6; ++i) require_finite(entry("phase", i), phase[i], "rad");
    rate = 2 * std::numbers::pi * options.period.cwiseInverse();
  }
  PathPoint at(double t) const override {
    PathPoint out;
    for (int i = 0; i < 6; ++i) {
      const double angle = rate[i] * t + phase[i];
      out.y[i] = amplitude[i] * (std::sin(angle) - std::sin(phase[i]));
      out.yd[i] = amplitude[i] * rate[i] * std::cos(angle);
      out.ydd[i] = -amplitude[i] * rate[i] * rate[i] * std::sin(angle);
    }
    return out;
  }
  std::array<bool, 6> commanded() const override { return nonzero(amplitude); }

 private:
  Vector6 amplitude, rate, phase;  // rad or m, rad/s, rad
};

}  // namespace

std::unique_ptr<Path> make_path(const HoldOptions&) { return std::make_unique<Hold>(); }
std::unique_ptr<Path> make_path(const StepOptions& options) { return std::make_unique<Step>(options); }
std::unique_ptr<Path> make_path(const LineOptions& options) { return std::make_unique<Line>(options); }
std::unique_ptr<Path> make_path(const CircleOptions& options) { return std::make_unique<Circle>(options); }
std::unique_ptr<Path> make_path(const LissajousOptions& options) {
  return std::make_unique<Lissajous>(options);
}

TipReference tip_reference(const Path& path, const Pose& initial, double t) {
  const PathPoint point = path.at(t);
  const Vector3<double> r = point.y.head<3>(), rd = point.yd.head<3>(), rdd = point.ydd.head<3>();
  const RotationVector turn(r);
  TipReference out;
  out.pose.R = turn.turned(initial.R);
  out.pose.p = initial.p + point.y.tail<3>();
  out.velocity << turn.left_jacobian(rd), point.yd.tail<3>();
  out.acceleration << turn.left_jacobian(rdd) + turn.left_jacobian_rate(rd, rd), point.ydd.tail<3>();
  return out;
}

}  // namespace osculate
