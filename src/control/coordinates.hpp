// Operational coordinates y of the tip: minimal ones, which have singular poses, and quaternions, which have
// none. Kreutz-Delgado, Jain & Rodriguez (1992), text after (1), with beta = (angular; linear) velocity of
// the tip, base frame, angular rows first:
//   beta = Pi(y) yd,   beta. = Pi ydd + Pi. yd,   so beta. = u with u = Pi v + Pi. yd gives ydd = v.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "control/reference.hpp"

namespace osculate {

enum class OrientationCoordinates {
  rotation_vector,  // the error-based law of pose_error.hpp; no coordinates here
  roll_pitch_yaw,   // R = Rz(yaw) Ry(pitch) Rx(roll); y = roll, pitch, yaw, |pitch| <= pi/2
  zyz_euler,        // R = Rz(a) Ry(b) Rz(c); y = a, b, c, 0 <= b <= pi
  quaternion,       // y = w, x, y, z of length 1, sign continuous
};

enum class PositionCoordinates {
  cartesian,    // x, y, z
  cylindrical,  // rho, phi, z about the base z axis: p = (rho cos(phi), rho sin(phi), z)
  spherical,    // r, theta from +z, phi: p = r (sin(theta) cos(phi), sin(theta) sin(phi), cos(theta))
};

/// As in the enumerations: "roll_pitch_yaw", "cylindrical", ...
std::string_view name(OrientationCoordinates coordinates);
std::string_view name(PositionCoordinates coordinates);

/// One coordinate: "pitch", "rad". Units are "rad", "m", or "1" for the quaternion's qw, qx, qy, qz.
struct CoordinateName {
  std::string_view name, unit;
};

/// The pose has no usable coordinates. The message names the representation, the coordinate and its value,
/// and what to use instead.
struct RepresentationSingular : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Coordinates are refused where the smallest singular value of Pi falls below this: rates of the coordinates
/// can then exceed the tip's velocity a thousandfold. Angles of position coordinates count times 1 m, so that
/// the singular values of Pi have no unit: the limits are |cos(pitch)|, |sin(b)| < 1.4e-3 and rho, r,
/// r sin(theta) < 1 mm.
inline constexpr double representation_limit = 1e-3;

/// One number per coordinate: orientation (3, or 4 for a quaternion), then position (3). A part that is not
/// controlled takes no room. Lives on the stack.
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 7, 1>;

/// A motion in coordinates at one instant: rad or m or 1, and the same per s and per s^2.
struct CoordinateMotion {
  Coordinates y, yd, ydd;
};

/// The coordinates chosen for the tip's orientation and position. The two parts are independent of each
/// other. Arguments y, yd, ydd, v have size() entries; rows of beta that belong to an absent part are ignored
/// on input and zero on output. The functions allocate nothing (names and messages do).
class CoordinateChart {
 public:
  /// nullopt: that part is not controlled. Throws std::invalid_argument for OrientationCoordinates::
  /// rotation_vector and if both parts are absent.
  CoordinateChart(std::optional<OrientationCoordinates> orientation,
                  std::optional<PositionCoordinates> position);

  std::optional<OrientationCoordinates> orientation() const { return orientation_; }
  std::optional<PositionCoordinates> position() const { return position_; }
  int orientation_size() const;  // 0, 3 or 4
  int position_size() const;     // 0 or 3
  int size() const { return orientation_size() + position_size(); }
  std::vector<CoordinateName> names() const;

  /// y of a pose. With `previous`, the one nearest to it: angles that turn without end by multiples of 2 pi,
  /// the quaternion by sign. Empty `previous`: angles in [-pi, pi], qw >= 0. `whose` begins the error
  /// message. Throws RepresentationSingular.
  Coordinates coordinates(const Pose& pose, const Coordinates& previous = {},
                          std::string_view whose = "tip") const;
  /// The pose with coordinates y; identity and zero in an absent part. A quaternion may have any length but
  /// 0.
  Pose pose(const Coordinates& y) const;

  /// Smallest singular value of Pi, lengths in m; see representation_limit. 2 for a quaternion.
  double smallest_singular_value(const Coordinates& y) const;

  /// Pi(y) x: beta for the rate x.
  Vector6 velocity(const Coordinates& y, const Coordinates& x) const;
  /// Pi.(y, yd) yd: beta. for ydd = 0.
  Vector6 bias(const Coordinates& y, const Coordinates& yd) const;
  /// yd = Pi^-1 beta; for a quaternion the pseudo-inverse, so y.yd = 0. Throws RepresentationSingular.
  Coordinates rates(const Coordinates& y, const Vector6& beta) const;
  /// ydd = Pi^-1 (beta. - Pi. yd). For a quaternion e the component along e is -|ed|^2, as |e| = 1 demands.
  /// Throws RepresentationSingular.
  Coordinates accelerations(const Coordinates& y, const Coordinates& yd, const Vector6& betad) const;

  /// The v that ydd can equal: v itself, but for a quaternion e, where |e| = 1 demands
  /// e.ydd + |ed|^2 = 0, the nearest vector that satisfies this.
  Coordinates attainable(const Coordinates& y, const Coordinates& yd, const Coordinates& v) const;
  /// u = Pi v + Pi. yd, the beta. (rad/s^2, m/s^2) for which ydd = attainable(y, yd, v). The projection
  /// onto |e| = 1 needs no extra step here: Pi e = 0 removes what v has along a quaternion e.
  Vector6 command(const Coordinates& y, const Coordinates& yd, const Coordinates& v) const;

  /// The reference in coordinates, y nearest to `near`. Throws RepresentationSingular.
  CoordinateMotion motion(const TipReference& reference, const Coordinates& near = {}) const;

 private:
  void require_regular(const Coordinates& y, std::string_view whose) const;

  std::optional<OrientationCoordinates> orientation_;
  std::optional<PositionCoordinates> position_;
};

/// v = ydd_ref + D (yd_ref - yd) + K (y_ref - y), K (1/s^2) and D (1/s) diagonal, one gain per coordinate.
/// With command(): e'' + D e' + K e = 0 for e = y_ref - y; for a quaternion, its part normal to y only.
Coordinates tracking_acceleration(const CoordinateMotion& reference, const Coordinates& y,
                                  const Coordinates& yd, const Coordinates& K, const Coordinates& D);

}  // namespace osculate
