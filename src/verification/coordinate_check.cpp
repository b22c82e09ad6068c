#include "verification/coordinate_check.hpp"

#include <cmath>
#include <numbers>

#include "reference/coordinates.hpp"

namespace osculate {

namespace {

using N = dense::Nested<double>;

/// Coordinates and their derivatives, in the order of the chart.
struct MovingCoordinates {
  Coordinates y, yd, ydd;
};

/// Coordinates of one part, from `first` on.
template <int size>
void put(const Eigen::Matrix<N, size, 1>& y, int first, MovingCoordinates& out) {
  const auto moved = dense::time_derivatives(y);
  out.y.segment(first, size) = moved.y;
  out.yd.segment(first, size) = moved.yd;
  out.ydd.segment(first, size) = moved.ydd;
}

/// The quaternion's component of largest magnitude: w from the trace, or the largest diagonal entry's.
int largest_component(const Matrix3<double>& R) {
  int largest = 0;
  for (int i = 1; i < 3; ++i)
    if (R(i, i) > R(largest, largest)) largest = i;
  return R.trace() > R(largest, largest) ? 0 : largest + 1;
}

/// The coordinates of a moving pose by their definitions. A quaternion has the sign in which its largest
/// component is positive.
MovingCoordinates coordinates(const CoordinateChart& chart, const Pose& pose, const Vector6& beta,
                              const Vector6& betad) {
  const auto moving = dense::moving_pose<double>(pose.R, pose.p, beta, betad);
  const int turning = chart.orientation_size();
  MovingCoordinates out;
  for (Coordinates* list : {&out.y, &out.yd, &out.ydd}) list->resize(chart.size());
  if (chart.orientation()) switch (*chart.orientation()) {
      case OrientationCoordinates::roll_pitch_yaw:
        put<3>(dense::roll_pitch_yaw(moving.R), 0, out);
        break;
      case OrientationCoordinates::zyz_euler:
        put<3>(dense::zyz_euler(moving.R), 0, out);
        break;
      case OrientationCoordinates::quaternion:
        put<4>(dense::quaternion(moving.R, largest_component(pose.R)), 0, out);
        break;
      case OrientationCoordinates::rotation_vector:
        break;
    }
  if (chart.position()) switch (*chart.position()) {
      case PositionCoordinates::cartesian:
        put<3>(moving.p, turning, out);
        break;
      case PositionCoordinates::cylindrical:
        put<3>(dense::cylindrical(moving.p), turning, out);
        break;
      case PositionCoordinates::spherical:
        put<3>(dense::spherical(moving.p), turning, out);
        break;
    }
  return out;
}

/// y_ref - y the short way round: angles within half a turn.
void shorten(const CoordinateChart& chart, Coordinates& e) {
  const auto names = chart.names();
  for (int i = 0; i < e.size(); ++i)
    if (names[static_cast<std::size_t>(i)].unit == "rad") e[i] = std::remainder(e[i], 2 * std::numbers::pi);
}

}  // namespace

ChartEvidence judge_chart(const ChartLaw& law, const Coordinates& v, const dense::Kinematics<double>& tip,
                          const dense::Vector6<double>& betad) {
  const CoordinateChart& chart = law.chart;
  MovingCoordinates at = coordinates(chart, {tip.R, tip.p}, tip.tip_velocity, betad);
  MovingCoordinates due =
      coordinates(chart, law.reference.pose, law.reference.velocity, law.reference.acceleration);
  ChartEvidence out;
  out.turning = chart.orientation_size();
  const auto flip = [](MovingCoordinates& m) {
    for (Coordinates* list : {&m.y, &m.yd, &m.ydd}) list->head(4) *= -1;
  };
  if (out.turning == 4) {
    if (at.y.head(4).dot(chart.coordinates({tip.R, tip.p}).head(4)) < 0) flip(at);
    if (due.y.head(4).dot(at.y.head(4)) < 0) flip(due);
  }
  Coordinates e = due.y - at.y;
  shorten(chart, e);
  out.due.resize(chart.size());
  for (int i = 0; i < chart.size(); ++i) {
    const int row = i >= out.turning ? 3 + i - out.turning : out.turning == 4 ? 0 : i;
    out.due[i] = due.ydd[i] + law.damping[row] * (due.yd[i] - at.yd[i]) + law.stiffness[row] * e[i];
  }
  // |e| = 1 leaves a quaternion no choice along itself.
  if (out.turning == 4) {
    const Eigen::Vector4d q = at.y.head(4);
    out.due.head(4) -= (q.dot(out.due.head(4)) + at.yd.head(4).squaredNorm()) * q;
  }
  out.v = v;
  out.ydd = at.ydd;
  out.yd = at.yd;
  out.smallest_singular_value =
      std::min(chart.smallest_singular_value(at.y), chart.smallest_singular_value(due.y));
  return out;
}

}  // namespace osculate
