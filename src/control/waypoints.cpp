// Waypoints: a CSV file and the clamped cubic splines through it.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string_view>

#include "control/reference.hpp"
#include "control/rotation.hpp"
#include "input/limits.hpp"
#include "input/named_columns.hpp"
#include "input/number_text.hpp"
#include "input/read_text.hpp"

namespace osculate {

namespace {

constexpr std::string_view plain_header = "t,x,y,z";
constexpr std::string_view oriented_header = "t,x,y,z,qw,qx,qy,qz";

struct Waypoint {
  int line = 0;                                 // of the file
  double t = 0;                                 // s
  Vector3<double> p = Vector3<double>::Zero();  // m, base frame
  Eigen::Vector4d q = Eigen::Vector4d::Zero();  // w, x, y, z, unit; zero where the file has none
};

struct Place {
  std::string file;
  int line = 0;
};

[[noreturn]] void reject(const Place& place, const std::string& what) {
  const std::string line = place.line > 0 ? ":" + std::to_string(place.line) : "";
  throw ReferenceError(place.file + line + ": " + what + ".");
}

double number(const Place& place, std::string_view column, std::string_view field) {
  std::string_view digits = field;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    reject(place, std::string(column) + " = '" + std::string(field) + "': must be a finite number");
  return value;
}

/// Whether the file gives orientations.
bool read_header(const Place& place, std::string_view line) {
  std::string names;
  for (const auto field : fields_of(line)) names += (names.empty() ? "" : ",") + std::string(field);
  if (names != plain_header && names != oriented_header)
    reject(place, "header '" + names + "': must be " + std::string(plain_header) + " or " +
                      std::string(oriented_header));
  return names == oriented_header;
}

Waypoint read_row(const Place& place, std::string_view line, bool oriented) {
  const auto columns = fields_of(oriented ? oriented_header : plain_header);
  const auto row = fields_of(line);
  if (row.size() != columns.size())
    reject(place, std::to_string(row.size()) + " values: must be " + std::to_string(columns.size()) +
                      ", as in the header");
  std::array<double, 8> values{};
  for (std::size_t i = 0; i < row.size(); ++i) values[i] = number(place, columns[i], row[i]);
  Waypoint out{place.line, values[0], {values[1], values[2], values[3]}, {}};
  out.q << values[4], values[5], values[6], values[7];
  if (!oriented) return out;
  const double length = out.q.norm();
  if (std::abs(length - 1) > 1e-3)
    reject(place, "quaternion qw,qx,qy,qz of length " + number_text(length) + ": must be 1 within 0.001");
  out.q /= length;
  return out;
}

void require_order(const Place& place, const std::vector<Waypoint>& before, const Waypoint& next) {
  if (before.empty() && next.t < 0)
    reject(place, "t = " + number_text(next.t) + " s: the first time must be >= 0");
  if (!before.empty() && next.t <= before.back().t)
    reject(place, "t = " + number_text(next.t) + " s: must be > " + number_text(before.back().t) +
                      " s, the time of the waypoint before");
}

TextFile read_waypoint_file(const std::filesystem::path& file) {
  return read_text(file, limits::waypoint_bytes, "check the path of reference.file");
}

std::vector<Waypoint> read_waypoints(const WaypointsOptions& options) {
  Place place{options.file.string()};
  const auto [content, fault] = options.text ? TextFile{*options.text, ""} : read_waypoint_file(options.file);
  if (!fault.empty()) throw ReferenceError(fault);
  std::istringstream in(content);
  std::vector<Waypoint> out;
  bool header_seen = false, oriented = false;
  std::string raw;
  while (std::getline(in, raw)) {
    if (++place.line == 1 && raw.starts_with(byte_order_mark)) raw.erase(0, byte_order_mark.size());
    const auto line = trimmed(std::string_view(raw).substr(0, raw.find('#')));
    if (line.empty()) continue;
    if (!header_seen) {
      oriented = read_header(place, line);
      header_seen = true;
      continue;
    }
    const Waypoint next = read_row(place, line, oriented);
    require_order(place, out, next);
    if (out.size() == limits::waypoints) reject(place, "at most 1e6 waypoints are read: leave some out");
    out.push_back(next);
  }
  place.line = 0;
  if (!header_seen) reject(place, "is empty; must start with the header " + std::string(plain_header));
  if (out.size() < 2) reject(place, std::to_string(out.size()) + " waypoints: must be at least 2");
  return out;
}

/// Rotation matrix of a unit quaternion w, x, y, z.
Matrix3<double> rotation_of(const Eigen::Vector4d& q) {
  const Matrix3<double> v_cross = cross_matrix(q.tail<3>());
  return Matrix3<double>::Identity() + 2 * (q[0] * v_cross + v_cross * v_cross);
}

/// Rotation vector of R, of the two nearest to `previous`: |r| <= pi, or the same rotation the other way
/// round.
Vector3<double> nearest_log(const Matrix3<double>& R, const Vector3<double>& previous) {
  const Vector3<double> r = log_rotation(R);
  const double angle = r.norm();
  if (angle == 0) return r;
  const Vector3<double> other = r * (1 - 2 * std::numbers::pi / angle);
  return (other - previous).norm() < (r - previous).norm() ? other : r;
}

/// Offsets from the initial pose at the waypoints (rad, m; base axes).
std::vector<Vector6> offsets(const Place& file, const std::vector<Waypoint>& waypoints, const Pose& initial) {
  // Slack above pi for files that give half a turn with few decimals.
  constexpr double largest_angle = std::numbers::pi + 1e-6;
  std::vector<Vector6> out;
  Vector3<double> r = Vector3<double>::Zero();
  for (const auto& waypoint : waypoints) {
    if (!waypoint.q.isZero(0)) r = nearest_log(rotation_of(waypoint.q) * initial.R.transpose(), r);
    if (r.norm() > largest_angle)
      reject({file.file, waypoint.line}, "orientation is " + number_text(r.norm()) +
                                             " rad from the initial one, followed continuously: must be <= "
                                             "pi; turn less far, or the other way");
    Vector6 y;
    y << r, waypoint.p - initial.p;
    out.push_back(y);
  }
  return out;
}

/// C^2 cubic spline with velocity zero at both ends, constant before the first and after the last knot.
class Waypoints final : public Path {
 public:
  Waypoints(std::vector<double> times, std::vector<Vector6> values)
      : t(std::move(times)), y(std::move(values)), v(knot_velocities(t, y)) {}

  PathPoint at(double time) const override {
    PathPoint out;
    if (time < t.front() || time >= t.back()) {
      out.y = time < t.front() ? y.front() : y.back();
      return out;
    }
    const auto i = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin()) - 1;
    const double h = t[i + 1] - t[i], x = time - t[i];
    const Vector6 mean = (y[i + 1] - y[i]) / h;
    const Vector6 c2 = (3 * mean - 2 * v[i] - v[i + 1]) / h;
    const Vector6 c3 = (v[i] + v[i + 1] - 2 * mean) / (h * h);
    out.y = y[i] + x * (v[i] + x * (c2 + x * c3));
    out.yd = v[i] + x * (2 * c2 + 3 * x * c3);
    out.ydd = 2 * c2 + 6 * x * c3;
    return out;
  }

  std::vector<double> breakpoints() const override {
    auto out = t;
    std::erase_if(out, [](double time) { return time <= 0; });
    return out;
  }

  std::array<bool, 6> commanded() const override {
    std::array<bool, 6> out{};
    for (const auto& value : y)
      for (int i = 0; i < 6; ++i) out[i] = out[i] || value[i] != 0;
    return out;
  }

 private:
  /// Continuity of the second derivative at the inner knots, h_i the length of interval i and m_i its mean
  /// velocity:
  ///   v_{i-1} / h_{i-1} + 2 (1/h_{i-1} + 1/h_i) v_i + v_{i+1} / h_i = 3 (m_{i-1} / h_{i-1} + m_i / h_i),
  /// tridiagonal and diagonally dominant, solved by elimination without pivoting; v = 0 at both ends.
  static std::vector<Vector6> knot_velocities(const std::vector<double>& t, const std::vector<Vector6>& y) {
    const std::size_t last = t.size() - 1;
    std::vector<Vector6> v(t.size(), Vector6::Zero());
    std::vector<double> above(t.size(), 0.0);  // superdiagonal after elimination, unit diagonal
    for (std::size_t i = 1; i < last; ++i) {
      const double left = 1 / (t[i] - t[i - 1]), right = 1 / (t[i + 1] - t[i]);
      const Vector6 side = 3 * (left * left * (y[i] - y[i - 1]) + right * right * (y[i + 1] - y[i]));
      const double pivot = 2 * (left + right) - left * above[i - 1];
      above[i] = right / pivot;
      v[i] = (side - left * v[i - 1]) / pivot;
    }
    for (std::size_t i = last; i-- > 1;) v[i] -= above[i] * v[i + 1];
    return v;
  }

  std::vector<double> t;   // s, strictly increasing
  std::vector<Vector6> y;  // rad, m
  std::vector<Vector6> v;  // rad/s, m/s
};

}  // namespace

std::optional<std::string> text_of(const std::filesystem::path& file) {
  const auto [text, fault] = read_waypoint_file(file);
  if (!fault.empty()) return std::nullopt;
  return text;
}

std::unique_ptr<Path> make_path(const WaypointsOptions& options, const Pose& initial) {
  const auto waypoints = read_waypoints(options);
  std::vector<double> times;
  for (const auto& waypoint : waypoints) times.push_back(waypoint.t);
  return std::make_unique<Waypoints>(std::move(times), offsets({options.file.string()}, waypoints, initial));
}

}  // namespace osculate
