#include "control/coordinates.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "control/rotation.hpp"
#include "scalar/fault.hpp"

namespace osculate {

namespace {

using Vector4 = Eigen::Vector4d;

/// The multiple of a turn added to `angle` that brings it nearest to `near`.
double unwrapped(double angle, double near) {
  constexpr double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((near - angle) / turn);
}

Matrix3<double> turn_about_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3<double> R;
  R << c, -s, 0,  //
      s, c, 0,    //
      0, 0, 1;
  return R;
}

Matrix3<double> turn_about_y(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3<double> R;
  R << c, 0, s,  //
      0, 1, 0,   //
      -s, 0, c;
  return R;
}

Matrix3<double> turn_about_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3<double> R;
  R << 1, 0, 0,  //
      0, c, -s,  //
      0, s, c;
  return R;
}

/// Three angles in the order of turning: R = Rz(a) Ry(b) R3(c), R3 about x (roll-pitch-yaw) or z (zyz).
struct ThreeTurns {
  double a, b, c;
};

ThreeTurns by_turn(OrientationCoordinates kind, const Coordinates& y) {
  if (kind == OrientationCoordinates::roll_pitch_yaw) return {y[2], y[1], y[0]};
  return {y[0], y[1], y[2]};
}

Vector3<double> by_coordinate(OrientationCoordinates kind, const ThreeTurns& x) {
  if (kind == OrientationCoordinates::roll_pitch_yaw) return {x.c, x.b, x.a};
  return {x.a, x.b, x.c};
}

/// Pi of three turns. The axes of the turns are z, t and k h + m z, with h = Rz(a) x and t = Rz(a) y, so
///   omega = (a. + m c.) z + b. t + k c. h.
struct TurnAxes {
  Vector3<double> h, t;
  double k, m;    // horizontal and vertical part of the third axis
  double kb, mb;  // their derivatives by b

  TurnAxes(OrientationCoordinates kind, const ThreeTurns& y) {
    const double ca = std::cos(y.a), sa = std::sin(y.a);
    const double cb = std::cos(y.b), sb = std::sin(y.b);
    h << ca, sa, 0;
    t << -sa, ca, 0;
    if (kind == OrientationCoordinates::roll_pitch_yaw)
      k = cb, m = -sb, kb = -sb, mb = -cb;
    else
      k = sb, m = cb, kb = cb, mb = -sb;
  }
  Vector3<double> velocity(const ThreeTurns& x) const {
    Vector3<double> out = x.b * t + k * x.c * h;
    out[2] += x.a + m * x.c;
    return out;
  }
  /// With h. = a. t and t. = -a. h.
  Vector3<double> bias(const ThreeTurns& yd) const {
    Vector3<double> out = (kb * yd.b * yd.c - yd.a * yd.b) * h + k * yd.a * yd.c * t;
    out[2] += mb * yd.b * yd.c;
    return out;
  }
  ThreeTurns rates(const Vector3<double>& omega) const {
    const double c = h.dot(omega) / k;
    return {omega[2] - m * c, t.dot(omega), c};
  }
  /// Of three unit axes of which only the first and the third are not normal to each other, with cosine m:
  /// sqrt(1 - |m|), written without the difference.
  double smallest_singular_value() const { return std::abs(k) / std::sqrt(1 + std::abs(m)); }
};

ThreeTurns angles(OrientationCoordinates kind, const Matrix3<double>& R) {
  if (kind == OrientationCoordinates::roll_pitch_yaw)
    return {std::atan2(R(1, 0), R(0, 0)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
            std::atan2(R(2, 1), R(2, 2))};
  return {std::atan2(R(1, 2), R(0, 2)), std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2)),
          std::atan2(R(2, 1), -R(2, 0))};
}

/// omega = 2 (e. e*), the vector part of the quaternion product: base axes, |e| = 1.
Vector3<double> quaternion_velocity(const Vector4& e, const Vector4& ed) {
  const Vector3<double> v = e.tail<3>(), vd = ed.tail<3>();
  return 2 * (e[0] * vd - ed[0] * v + v.cross(vd));
}

/// e. = (0, omega) e / 2.
Vector4 quaternion_rates(const Vector4& e, const Vector3<double>& omega) {
  const Vector3<double> v = e.tail<3>();
  Vector4 out;
  out << -omega.dot(v) / 2, (e[0] * omega + omega.cross(v)) / 2;
  return out;
}

/// Directions in which the position coordinates push the tip: v = diag(scale) applied to yd along the axes.
struct PositionAxes {
  Matrix3<double> axes = Matrix3<double>::Identity();  // orthonormal columns, base frame
  Vector3<double> scale = Vector3<double>::Ones();     // m/s per unit of the coordinate's rate
  double ct = 0, st = 0;                               // cosine and sine of theta

  PositionAxes(PositionCoordinates kind, const Vector3<double>& y) {
    if (kind == PositionCoordinates::cylindrical) {
      axes = turn_about_z(y[1]);
      scale[1] = y[0];
    } else if (kind == PositionCoordinates::spherical) {
      const double cp = std::cos(y[2]), sp = std::sin(y[2]);
      ct = std::cos(y[1]), st = std::sin(y[1]);
      axes << st * cp, ct * cp, -sp,  //
          st * sp, ct * sp, cp,       //
          ct, -st, 0;
      scale << 1, y[0], y[0] * st;
    }
  }
  Vector3<double> velocity(const Vector3<double>& yd) const { return axes * scale.cwiseProduct(yd); }
  Vector3<double> rates(const Vector3<double>& v) const {
    return (axes.transpose() * v).cwiseQuotient(scale);
  }
};

/// Acceleration at ydd = 0: centripetal and Coriolis terms along the axes.
Vector3<double> position_bias(PositionCoordinates kind, const Vector3<double>& y, const Vector3<double>& yd) {
  if (kind == PositionCoordinates::cartesian) return Vector3<double>::Zero();
  const PositionAxes at(kind, y);
  if (kind == PositionCoordinates::cylindrical)
    return at.axes * Vector3<double>(-y[0] * yd[1] * yd[1], 2 * yd[0] * yd[1], 0);
  const double r = y[0], rd = yd[0], td = yd[1], pd = yd[2];
  return at.axes * Vector3<double>(-r * (td * td + at.st * at.st * pd * pd),
                                   2 * rd * td - r * at.st * at.ct * pd * pd,
                                   2 * pd * (rd * at.st + r * at.ct * td));
}

Vector3<double> position_coordinates(PositionCoordinates kind, const Vector3<double>& p) {
  const double rho = std::hypot(p[0], p[1]);
  const double phi = std::atan2(p[1], p[0]);
  if (kind == PositionCoordinates::cylindrical) return {rho, phi, p[2]};
  if (kind == PositionCoordinates::spherical) return {p.norm(), std::atan2(rho, p[2]), phi};
  return p;
}

std::string printed(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

[[noreturn]] void refuse(std::string_view whose, std::string_view representation,
                         const CoordinateName& coordinate, double value, double smallest,
                         const char* remedy) {
  std::string text(whose);
  text.append(": ").append(representation).append(" coordinates are singular at ").append(coordinate.name);
  text.append(" = ").append(printed(value)).append(" ").append(coordinate.unit);
  text.append(": the smallest singular value of Pi is ").append(printed(smallest));
  text.append(", must be >= ").append(printed(representation_limit)).append(". ").append(remedy);
  throw RepresentationSingular(text);
}

constexpr CoordinateName orientation_names[][4] = {
    {},
    {{"roll", "rad"}, {"pitch", "rad"}, {"yaw", "rad"}},
    {{"a", "rad"}, {"b", "rad"}, {"c", "rad"}},
    {{"qw", "1"}, {"qx", "1"}, {"qy", "1"}, {"qz", "1"}},
};
constexpr CoordinateName position_names[][3] = {
    {{"x", "m"}, {"y", "m"}, {"z", "m"}},
    {{"rho", "m"}, {"phi", "rad"}, {"z", "m"}},
    {{"r", "m"}, {"theta", "rad"}, {"phi", "rad"}},
};

double smallest(OrientationCoordinates kind, const Coordinates& y) {
  if (kind == OrientationCoordinates::quaternion) return 2;
  return TurnAxes(kind, by_turn(kind, y)).smallest_singular_value();
}

double smallest(PositionCoordinates kind, const Vector3<double>& y) {
  return PositionAxes(kind, y).scale.cwiseAbs().minCoeff();
}

}  // namespace

std::string_view name(OrientationCoordinates coordinates) {
  constexpr std::string_view names[] = {"rotation_vector", "roll_pitch_yaw", "zyz_euler", "quaternion"};
  return names[static_cast<int>(coordinates)];
}

std::string_view name(PositionCoordinates coordinates) {
  constexpr std::string_view names[] = {"cartesian", "cylindrical", "spherical"};
  return names[static_cast<int>(coordinates)];
}

CoordinateChart::CoordinateChart(std::optional<OrientationCoordinates> orientation,
                                 std::optional<PositionCoordinates> position)
    : orientation_(orientation), position_(position) {
  if (!orientation && !position)
    throw std::invalid_argument("coordinates: neither orientation nor position is chosen: choose one.");
  if (orientation == OrientationCoordinates::rotation_vector)
    throw std::invalid_argument(
        "coordinates: rotation_vector is a law for the orientation error, not coordinates: use pose_error, "
        "or choose roll_pitch_yaw, zyz_euler or quaternion.");
}

int CoordinateChart::orientation_size() const {
  if (!orientation_) return 0;
  return orientation_ == OrientationCoordinates::quaternion ? 4 : 3;
}

int CoordinateChart::position_size() const { return position_ ? 3 : 0; }

std::vector<CoordinateName> CoordinateChart::names() const {
  std::vector<CoordinateName> out;
  for (int i = 0; i < orientation_size(); ++i)
    out.push_back(orientation_names[static_cast<int>(*orientation_)][i]);
  for (int i = 0; i < position_size(); ++i) out.push_back(position_names[static_cast<int>(*position_)][i]);
  return out;
}

Coordinates CoordinateChart::coordinates(const Pose& pose, const Coordinates& previous,
                                         std::string_view whose) const {
  const bool continues = previous.size() > 0;
  Coordinates y(size());
  if (orientation_ == OrientationCoordinates::quaternion) {
    const Vector4 near = continues ? Vector4(previous.head<4>()) : Vector4(Vector4::Zero());
    y.head<4>() = quaternion(pose.R, near);
  } else if (orientation_) {
    ThreeTurns turns = angles(*orientation_, pose.R);
    if (continues) {
      const ThreeTurns near = by_turn(*orientation_, previous);
      turns.a = unwrapped(turns.a, near.a);
      turns.c = unwrapped(turns.c, near.c);
    }
    y.head<3>() = by_coordinate(*orientation_, turns);
  }
  if (position_) {
    y.tail<3>() = position_coordinates(*position_, pose.p);
    if (continues && position_ != PositionCoordinates::cartesian) {
      const int phi = size() - (position_ == PositionCoordinates::cylindrical ? 2 : 1);
      y[phi] = unwrapped(y[phi], previous[phi]);
    }
  }
  require_regular(y, whose);
  return y;
}

Pose CoordinateChart::pose(const Coordinates& y) const {
  Pose out;
  if (orientation_ == OrientationCoordinates::quaternion) {
    out.R = Eigen::Quaterniond(y[0], y[1], y[2], y[3]).normalized().toRotationMatrix();
  } else if (orientation_) {
    const ThreeTurns turns = by_turn(*orientation_, y);
    const bool rolls = orientation_ == OrientationCoordinates::roll_pitch_yaw;
    const Matrix3<double> last = rolls ? turn_about_x(turns.c) : turn_about_z(turns.c);
    out.R = turn_about_z(turns.a) * turn_about_y(turns.b) * last;
  }
  if (position_ == PositionCoordinates::cartesian) {
    out.p = y.tail<3>();
  } else if (position_) {
    const PositionAxes at(*position_, y.tail<3>());
    const Vector3<double> from_z = position_ == PositionCoordinates::cylindrical
                                       ? Vector3<double>(0, 0, y[size() - 1])
                                       : Vector3<double>(Vector3<double>::Zero());
    out.p = y[size() - 3] * at.axes.col(0) + from_z;
  }
  return out;
}

double CoordinateChart::smallest_singular_value(const Coordinates& y) const {
  if (!position_) return smallest(*orientation_, y);
  const double of_position = smallest(*position_, y.tail<3>());
  return orientation_ ? std::min(of_position, smallest(*orientation_, y)) : of_position;
}

void CoordinateChart::require_regular(const Coordinates& y, std::string_view whose) const {
  if (orientation_) {
    const double sigma = smallest(*orientation_, y);
    if (sigma < representation_limit)
      refuse(whose, name(*orientation_), orientation_names[static_cast<int>(*orientation_)][1], y[1], sigma,
             "Choose the quaternion, which has no singular orientation, or move the path away.");
  }
  if (position_) {
    const Vector3<double> at = y.tail<3>();
    const double sigma = smallest(*position_, at);
    const bool on_the_axis = position_ == PositionCoordinates::spherical && at[0] >= representation_limit;
    const int blamed = on_the_axis ? 1 : 0;
    if (sigma < representation_limit)
      refuse(whose, name(*position_), position_names[static_cast<int>(*position_)][blamed], at[blamed], sigma,
             "Choose cartesian coordinates, which have no singular position, or move the path away.");
  }
}

Vector6 CoordinateChart::velocity(const Coordinates& y, const Coordinates& x) const {
  Vector6 out = Vector6::Zero();
  if (orientation_ == OrientationCoordinates::quaternion)
    out.head<3>() = quaternion_velocity(y.head<4>(), x.head<4>());
  else if (orientation_)
    out.head<3>() = TurnAxes(*orientation_, by_turn(*orientation_, y)).velocity(by_turn(*orientation_, x));
  if (position_) out.tail<3>() = PositionAxes(*position_, y.tail<3>()).velocity(x.tail<3>());
  return out;
}

Vector6 CoordinateChart::bias(const Coordinates& y, const Coordinates& yd) const {
  Vector6 out = Vector6::Zero();
  // A quaternion has none: Pi. e. = 2 (e. e.*) has no vector part.
  if (orientation_ && orientation_ != OrientationCoordinates::quaternion)
    out.head<3>() = TurnAxes(*orientation_, by_turn(*orientation_, y)).bias(by_turn(*orientation_, yd));
  if (position_) out.tail<3>() = position_bias(*position_, y.tail<3>(), yd.tail<3>());
  return out;
}

Coordinates CoordinateChart::rates(const Coordinates& y, const Vector6& beta) const {
  require_regular(y, "tip");
  Coordinates out(size());
  if (orientation_ == OrientationCoordinates::quaternion) {
    out.head<4>() = quaternion_rates(y.head<4>(), beta.head<3>());
  } else if (orientation_) {
    const TurnAxes at(*orientation_, by_turn(*orientation_, y));
    out.head<3>() = by_coordinate(*orientation_, at.rates(beta.head<3>()));
  }
  if (position_) out.tail<3>() = PositionAxes(*position_, y.tail<3>()).rates(beta.tail<3>());
  return out;
}

Coordinates CoordinateChart::accelerations(const Coordinates& y, const Coordinates& yd,
                                           const Vector6& betad) const {
  Coordinates out = rates(y, betad - bias(y, yd));
  if (orientation_ == OrientationCoordinates::quaternion)
    out.head<4>() -= yd.head<4>().squaredNorm() * y.head<4>();
  return out;
}

Coordinates CoordinateChart::attainable(const Coordinates& y, const Coordinates& yd,
                                        const Coordinates& v) const {
  Coordinates out = v;
  if (orientation_ == OrientationCoordinates::quaternion)
    out.head<4>() -= (y.head<4>().dot(v.head<4>()) + yd.head<4>().squaredNorm()) * y.head<4>();
  return out;
}

Vector6 CoordinateChart::command(const Coordinates& y, const Coordinates& yd, const Coordinates& v) const {
  return velocity(y, v) + bias(y, yd);
}

CoordinateMotion CoordinateChart::motion(const TipReference& reference, const Coordinates& near) const {
  CoordinateMotion out;
  out.y = coordinates(reference.pose, near, "reference");
  out.yd = rates(out.y, reference.velocity);
  out.ydd = accelerations(out.y, out.yd, reference.acceleration);
  return out;
}

Coordinates tracking_acceleration(const CoordinateMotion& reference, const Coordinates& y,
                                  const Coordinates& yd, const Coordinates& K, const Coordinates& D) {
  const Coordinates damping = D.cwiseProduct(reference.yd - yd);
  return seeded(Fault::tracking_reference, reference.ydd) + seeded(Fault::tracking_damping, damping) +
         K.cwiseProduct(reference.y - y);
}

}  // namespace osculate
