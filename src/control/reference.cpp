#include "control/reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/rotation.hpp"
#include "input/number_text.hpp"

namespace osculate {

namespace {

[[noreturn]] void reject(const std::string& name, const std::string& value, const std::string& remedy) {
  throw ReferenceError("reference." + name + " = " + value + ": " + remedy + ".");
}

void require_finite(const std::string& name, double value, const std::string& unit) {
  if (!std::isfinite(value)) reject(name, number_text(value) + " " + unit, "must be a finite number");
}

void require_positive(const std::string& name, double value, const std::string& unit) {
  require_finite(name, value, unit);
  if (value <= 0) reject(name, number_text(value) + " " + unit, "must be > 0");
}

std::string entry(const std::string& name, int row) { return name + "[" + std::to_string(row) + "]"; }

/// Rows 0..2 in rad, rows 3..5 in m.
void require_finite(const std::string& name, const Vector6& value) {
  for (int i = 0; i < 6; ++i) require_finite(entry(name, i), value[i], i < 3 ? "rad" : "m");
}

bool zero(const Vector3<double>& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

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
  bool moves() const override { return false; }
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
  bool moves() const override { return false; }
  std::array<bool, 6> commanded() const override { return nonzero(o.offset); }
  std::array<bool, 6> commanded_from(double start) const override {
    return start < o.at ? std::array<bool, 6>{} : commanded();
  }

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
    if (radius < 0) reject("radius", number_text(radius) + " m", "must be >= 0");
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
    const double angle = rate * t / 2, half = std::sin(angle), c_half = std::cos(angle);
    const double s = 2 * half * c_half, c = 1 - 2 * half * half;
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

/// Time is cut into half periods, number h beginning at h * half: in those of even number the reference is
/// away on one row, in the others it is back.
class EachAxis final : public Path {
 public:
  EachAxis(const EachAxisOptions& options, double run_duration)
      : amplitude(options.amplitude), half(options.period / 2), duration(run_duration) {
    require_finite("amplitude", amplitude);
    require_positive("period", options.period, "s");
    if (!(duration <= 1e6 * half))
      reject("period", number_text(options.period) + " s",
             "must be at least " + number_text(2e-6 * duration) + " s, for at most a million jumps");
    for (int i = 0; i < 6; ++i)
      if (amplitude[i] != 0) rows.push_back(i);
  }
  PathPoint at(double t) const override {
    PathPoint out;
    if (t < 0 || rows.empty()) return out;
    const double h = half_period(t);
    if (std::fmod(h, 2) == 0) out.y[row(h)] = amplitude[row(h)];
    return out;
  }
  std::vector<double> breakpoints() const override {
    std::vector<double> out;
    if (rows.empty()) return out;
    for (double h = 1; h * half < duration; ++h) out.push_back(h * half);
    return out;
  }
  bool moves() const override { return false; }
  std::array<bool, 6> commanded() const override { return nonzero(amplitude); }
  std::array<bool, 6> commanded_from(double start) const override {
    std::array<bool, 6> out{};
    if (start < 0 || rows.empty()) return out;
    out[row(half_period(start))] = true;
    return out;
  }

 private:
  /// Largest h with h * half <= t in floating point, so that the value changes at the breakpoints to the bit.
  double half_period(double t) const {
    double h = std::floor(t / half);
    if ((h + 1) * half <= t) ++h;
    if (h * half > t) --h;
    return h;
  }
  /// Row of that half period; `rows` is not empty.
  int row(double h) const {
    const double turn = std::fmod(std::floor(h / 2), static_cast<double>(rows.size()));
    return rows[static_cast<std::size_t>(turn)];
  }

  Vector6 amplitude;      // rad or m
  double half, duration;  // s
  std::vector<int> rows;  // that jump, in their order
};

/// y = amplitude sum_k (sin(w_k t + phase_k) - sin(phase_k)), k = 1 ... N by rising frequency, with the
/// phases of Schroeder (1970) for a flat spectrum: phase_k = -pi k (k - 1) / N.
class Multisine final : public Path {
 public:
  explicit Multisine(const MultisineOptions& options) : row(options.row), amplitude(options.amplitude) {
    if (row < 0 || row > 5) reject("row", std::to_string(row), "must be 0 to 5");
    require_finite("amplitude", amplitude, row < 3 ? "rad" : "m");
    std::vector<double> frequencies = options.frequencies;  // Hz
    if (frequencies.empty()) reject("frequencies", "[]", "must have at least one entry");
    for (std::size_t k = 0; k < frequencies.size(); ++k)
      require_positive(entry("frequencies", static_cast<int>(k)), frequencies[k], "Hz");
    std::sort(frequencies.begin(), frequencies.end());
    const auto twice = std::adjacent_find(frequencies.begin(), frequencies.end());
    if (twice != frequencies.end())
      reject("frequencies", number_text(*twice) + " Hz", "must not be there twice");
    const auto N = static_cast<double>(frequencies.size());
    for (double k = 1; k <= N; ++k) phase.push_back(-std::numbers::pi * std::fmod(k * (k - 1) / N, 2));
    for (const double f : frequencies) rate.push_back(2 * std::numbers::pi * f);
  }
  PathPoint at(double t) const override {
    PathPoint out;
    for (std::size_t k = 0; k < rate.size(); ++k) {
      const double angle = rate[k] * t + phase[k];
      out.y[row] += amplitude * (std::sin(angle) - std::sin(phase[k]));
      out.yd[row] += amplitude * rate[k] * std::cos(angle);
      out.ydd[row] -= amplitude * rate[k] * rate[k] * std::sin(angle);
    }
    return out;
  }
  std::array<bool, 6> commanded() const override {
    std::array<bool, 6> out{};
    out[row] = amplitude != 0;
    return out;
  }

 private:
  int row;
  double amplitude;                 // rad or m
  std::vector<double> rate, phase;  // rad/s, rad
};

}  // namespace

std::unique_ptr<Path> make_path(const HoldOptions&) { return std::make_unique<Hold>(); }
std::unique_ptr<Path> make_path(const StepOptions& options) { return std::make_unique<Step>(options); }
std::unique_ptr<Path> make_path(const LineOptions& options) { return std::make_unique<Line>(options); }
std::unique_ptr<Path> make_path(const CircleOptions& options) { return std::make_unique<Circle>(options); }
std::unique_ptr<Path> make_path(const LissajousOptions& options) {
  return std::make_unique<Lissajous>(options);
}
std::unique_ptr<Path> make_path(const EachAxisOptions& options, double duration) {
  return std::make_unique<EachAxis>(options, duration);
}
std::unique_ptr<Path> make_path(const MultisineOptions& options) {
  return std::make_unique<Multisine>(options);
}

TipReference tip_reference(const Path& path, const Pose& initial, double t) {
  TipReference out;
  tip_reference(path, initial, t, out);
  return out;
}

void tip_reference(const Path& path, const Pose& initial, double t, TipReference& out) {
  const PathPoint point = path.at(t);
  const Vector3<double> r = point.y.head<3>(), rd = point.yd.head<3>(), rdd = point.ydd.head<3>();
  out.pose.p = initial.p + point.y.tail<3>();
  out.velocity = point.yd;
  out.acceleration = point.ydd;
  if (zero(r) && zero(rd) && zero(rdd)) {  // exp(0) = J_l(0) = 1
    out.pose.R = initial.R;
    return;
  }
  const RotationVector turn(r);
  out.pose.R = turn.turned(initial.R);
  out.velocity.head<3>() = turn.left_jacobian(rd);
  out.acceleration.head<3>() = turn.left_jacobian(rdd) + turn.left_jacobian_rate(rd);
}

}  // namespace osculate
