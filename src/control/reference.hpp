// Reference motions of the tip, each a smooth path y(t) in R^6 relative to the initial tip pose.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/chain.hpp"

namespace osculate {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Pose of the tip in the base frame.
struct Pose {
  Matrix3<double> R = Matrix3<double>::Identity();
  Vector3<double> p = Vector3<double>::Zero();  // m
};

/// Offset from the initial tip pose and its time derivatives. Rows 0..2: rotation vector r (rad, base axes),
/// meaning R(t) = exp(r) R(0); rows 3..5: displacement (m, base axes), p(t) = p(0) + y[3..5].
struct PathPoint {
  Vector6 y = Vector6::Zero(), yd = Vector6::Zero(), ydd = Vector6::Zero();
};

/// Where the tip should be, and how it should move there: base frame, about the tip point, angular part
/// first.
struct TipReference {
  Pose pose;
  Vector6 velocity = Vector6::Zero();      // rad/s, m/s
  Vector6 acceleration = Vector6::Zero();  // rad/s^2, m/s^2, ordinary derivative of `velocity`
};

/// A path. Pure: the same t gives the same point.
class Path {
 public:
  virtual ~Path() = default;
  /// Where the path is at t >= 0, s, with its derivatives.
  virtual PathPoint at(double t) const = 0;
  /// Times inside (0, duration) where a derivative up to the third jumps; the integrator stops and restarts
  /// there.
  virtual std::vector<double> breakpoints() const { return {}; }
  /// True for each of the six rows that ever leaves zero.
  virtual std::array<bool, 6> commanded() const = 0;
  /// False for a path that only jumps: its velocity is zero everywhere.
  virtual bool moves() const { return true; }
  /// The same as commanded() from breakpoint to breakpoint: rows commanded in the segment that begins at
  /// `start`.
  virtual std::array<bool, 6> commanded_from(double /*start*/) const { return commanded(); }
};

struct ReferenceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct HoldOptions {};
struct StepOptions {
  Vector6 offset = Vector6::Zero();  // rad, m; the reference jumps there at t = at
  double at = 0;                     // s
};
struct LineOptions {
  Vector6 offset = Vector6::Zero();  // rad, m
  double start = 0;                  // s
  double duration = 1;               // s; minimum-jerk timing (quintic), at rest before and after
};
struct CircleOptions {
  double radius = 0.1;  // m
  double period = 2;    // s
  std::string plane =
      "yz";  // two of x, y, z: the motion starts along the second axis, towards +; the centre lies
             // at distance `radius` along the NEGATIVE first axis from the initial tip position
};
struct LissajousOptions {
  Vector6 amplitude = Vector6::Zero();  // rad, m
  Vector6 period = Vector6::Ones();     // s
  Vector6 phase =
      Vector6::Zero();  // rad; y_i = amplitude_i (sin(2 pi t / period_i + phase_i) - sin(phase_i))
};
struct WaypointsOptions {
  std::filesystem::path file;  // CSV with a header: t,x,y,z or t,x,y,z,qw,qx,qy,qz (absolute, base frame)
  std::optional<std::string> text = {};  // what is in it, if that is known already
};

/// What is in a file of waypoints; nothing if it cannot be read.
std::optional<std::string> text_of(const std::filesystem::path& file);

/// One axis after the other: at i * period the reference jumps by amplitude[i] on row i alone, and half a
/// period later back; rows with amplitude 0 are passed over. Then from the first again, to the end.
struct EachAxisOptions {
  Vector6 amplitude = Vector6::Zero();  // rad, m
  double period = 4;                    // s, > 0: time of one axis
};
/// A sum of sines of equal amplitude on one row; phases by Schroeder (1970), which keep its peak low, minus
/// the value at t = 0.
struct MultisineOptions {
  int row = 3;                                    // 0..5
  double amplitude = 0.005;                       // rad or m, of each sine
  std::vector<double> frequencies{0.5, 1, 2, 4};  // Hz, distinct, > 0
};

/// The path that the options describe.
std::unique_ptr<Path> make_path(const HoldOptions&);
/// The path that the options describe.
std::unique_ptr<Path> make_path(const StepOptions&);
/// The path that the options describe.
std::unique_ptr<Path> make_path(const LineOptions&);
/// The path that the options describe.
std::unique_ptr<Path> make_path(const CircleOptions&);
/// The path that the options describe.
std::unique_ptr<Path> make_path(const LissajousOptions&);
/// The path that the options describe; `duration` of the run, s, is shared among its axes.
std::unique_ptr<Path> make_path(const EachAxisOptions&, double duration);
/// The path that the options describe.
std::unique_ptr<Path> make_path(const MultisineOptions&);
/// C^2 cubic splines through the waypoints, at rest at both ends, holding the last point afterwards. The
/// first waypoint may differ from `initial`: the error then decays as the gains say.
std::unique_ptr<Path> make_path(const WaypointsOptions&, const Pose& initial);

/// The tip's reference motion at time t: the path applied to the initial pose.
TipReference tip_reference(const Path& path, const Pose& initial, double t);
/// The same into `out`, whose storage is used again.
void tip_reference(const Path& path, const Pose& initial, double t, TipReference& out);

}  // namespace osculate
