#include "verification/departure.hpp"

#include <cmath>

namespace osculate {

namespace {

/// `beyond(i)` of each coordinate that has a limit.
template <class Beyond>
void spend(std::vector<TimeSpent>& spent, std::size_t limited, double t, double h, const Beyond& beyond) {
  spent.resize(std::max(spent.size(), limited));
  for (std::size_t i = 0; i < limited; ++i)
    if (beyond(i)) spent[i].add(t, h);
}

}  // namespace

void Peak::add(double t, double x) {
  if (std::isnan(x)) x = std::numeric_limits<double>::infinity();
  if (x > value || std::isnan(time)) value = x, time = t;
}

void TimeSpent::add(double t, double h) {
  total += h;
  if (!first) first = t;
  last = t;
}

Departure::Departure(TaskRows rows, TaskRows tracked, JointLimits limits)
    : rows_(std::move(rows)), tracked_(std::move(tracked)), limits_(std::move(limits)) {}

Departure::Lengths Departure::lengths(const Vector6& v, const TaskRows& rows) {
  double squares[2] = {0, 0};
  for (const int row : rows) squares[row / 3] += v[row] * v[row];
  return {std::sqrt(squares[0]), std::sqrt(squares[1])};
}

void Departure::add(double t, double h, const DepartureInput& at) {
  const Lengths acceleration = lengths(at.tip_acceleration - at.u, rows_),
                error = lengths(at.error, tracked_);
  if (at.acts) {
    so_far_.angular_acceleration.add(t, acceleration.angular);
    so_far_.linear_acceleration.add(t, acceleration.linear);
  }
  so_far_.orientation.add(t, error.angular);
  so_far_.position.add(t, error.linear);
  const auto trapezoid = [h](double a, double b) { return h / 2 * (a * a + b * b); };
  if (h > 0) {
    orientation_squares_ += trapezoid(last_error_.angular, error.angular);
    position_squares_ += trapezoid(last_error_.linear, error.linear);
    duration_ += h;
  }
  last_error_ = error;

  so_far_.torque.resize(at.torque.size());
  for (std::size_t i = 0; i < at.torque.size(); ++i) so_far_.torque[i].add(t, std::abs(at.torque[i]));
  if (at.singularity_policy) so_far_.singularity_policy.add(t, h);
  if (at.saturated) so_far_.saturated.add(t, h);
  // Written so that not-a-number is beyond every limit.
  const auto& [lower, upper, velocity, effort] = limits_;
  spend(so_far_.beyond_position, std::min(lower.size(), at.q.size()), t, h,
        [&](std::size_t i) { return !(lower[i] <= at.q[i] && at.q[i] <= upper[i]); });
  spend(so_far_.beyond_velocity, std::min(velocity.size(), at.qd.size()), t, h,
        [&](std::size_t i) { return !(std::abs(at.qd[i]) <= velocity[i]); });
  spend(so_far_.beyond_effort, std::min(effort.size(), at.torque.size()), t, h,
        [&](std::size_t i) { return !(std::abs(at.torque[i]) <= effort[i]); });
}

DepartureResult Departure::result() const {
  DepartureResult out = so_far_;
  if (duration_ > 0) {
    out.orientation_rms = std::sqrt(orientation_squares_ / duration_);
    out.position_rms = std::sqrt(position_squares_ / duration_);
  }
  return out;
}

}  // namespace osculate
