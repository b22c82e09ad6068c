// Motions whose coordinates are known without any of the formulas: arms whose joints are the coordinates.
#include "reference/coordinates.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::coordinates_tests {

namespace {

using Vector = VectorX<double>;

Link<double> joint(JointType type, const Vector3<double>& axis) {
  Link<double> out;
  out.type = type;
  out.axis = axis;
  return out;
}

struct Case {
  Vector q, qd, qdd;
};

const Vector3<double> X = Vector3<double>::UnitX(), Y = Vector3<double>::UnitY(),
                      Z = Vector3<double>::UnitZ();

template <int size>
Vector joined(const dense::TimeDerivatives<Eigen::Matrix<double, size, 1>>& m) {
  Vector out(3 * size);
  out << m.y, m.yd, m.ydd;
  return out;
}

Vector joined(const Vector& y, const Vector& yd, const Vector& ydd) {
  Vector out(3 * y.size());
  out << y, yd, ydd;
  return out;
}

/// The three joints in the order of the coordinates.
Vector expected(const Case& c, const std::vector<int>& order) {
  return joined(c.q(order), c.qd(order), c.qdd(order));
}

const Case cases[] = {
    {Vector{{0.7, 0.4, -2.1}}, Vector{{1.2, -0.6, 0.3}}, Vector{{-0.9, 2.0, 1.1}}},
    {Vector{{-2.9, 1.3, 0.8}}, Vector{{-0.4, 0.9, -1.7}}, Vector{{1.5, -0.2, 0.6}}},
    {Vector{{1.9, 0.2, 1.4}}, Vector{{0.8, 1.1, 0.5}}, Vector{{0.1, 0.3, -2.2}}},
};

/// Rounding of a handful of operations, times the accelerations' size (at most 4), times up to 1/d^3 with
/// d = sin or cos of the middle angle, or the radius: d appears squared in the denominators of the first
/// derivatives of acos and atan2, once more in the second.
double bound(double d) { return 20 * eps * 4 / (d * d * d); }

}  // namespace

/// The judge's y, yd, ydd of an arm of three joints are those of the joints, in the given order; and not so
/// when a joint's acceleration is ten tolerances more.
template <class Y>
void check_joints(const std::vector<Link<double>>& links, Case c, const std::vector<int>& order,
                  double tolerance, const Y& y) {
  Chain<double> arm;
  arm.links = links;
  const Vector want = expected(c, order);
  const auto error = [&] {
    const Vector got = joined(dense::time_derivatives(y(dense::moving_tip(arm, c.q, c.qd, c.qdd))));
    return (got - want).cwiseAbs().maxCoeff();
  };
  CHECK(error() <= tolerance);
  c.qdd[1] += 10 * tolerance;
  CHECK(error() > tolerance);
}

TEST_CASE("the judge finds the joints of arms that are coordinate systems") {
  using Pose = dense::MovingPose<double>;
  const auto turns = [](const Vector3<double>& axis) { return joint(JointType::revolute, axis); };
  const auto slides = [](const Vector3<double>& axis) { return joint(JointType::prismatic, axis); };
  for (const Case& c : cases) {
    const double cosine = std::cos(c.q[1]), sine = std::sin(c.q[1]);
    check_joints({turns(Z), turns(Y), turns(X)}, c, {2, 1, 0}, bound(cosine),
                 [](const Pose& at) { return dense::roll_pitch_yaw(at.R); });
    check_joints({turns(Z), turns(Y), turns(Z)}, c, {0, 1, 2}, bound(sine),
                 [](const Pose& at) { return dense::zyz_euler(at.R); });
    Case positive = c;  // the last joint is a radius
    positive.q[2] = std::abs(c.q[2]);
    const double radius = std::min(1.0, positive.q[2]);
    check_joints({turns(Z), slides(Z), slides(X)}, positive, {2, 0, 1}, bound(radius),
                 [](const Pose& at) { return dense::cylindrical(at.p); });
    check_joints({turns(Z), turns(Y), slides(Z)}, positive, {2, 1, 0}, bound(radius * sine),
                 [](const Pose& at) { return dense::spherical(at.p); });
  }
}

TEST_CASE("the judge's quaternion of a turn about a fixed axis is (cos, axis sin) of half the angle") {
  const Vector3<double> axis(2.0 / 7, -3.0 / 7, 6.0 / 7);
  for (const double angle : {0.3, 1.9, -2.6}) {
    const double rate = 0.8, acceleration = -1.7;
    Chain<double> arm;
    arm.links = {joint(JointType::revolute, axis)};
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    Eigen::Vector4d e, half_turned;  // e, and e at half an angle of pi/2 further: de/d(angle/2)
    e << c, s * axis;
    half_turned << -s, c * axis;
    const Vector want =
        joined(e, rate / 2 * half_turned, acceleration / 2 * half_turned - rate * rate / 4 * e);
    const auto error = [&](int positive, double extra) {
      const auto tip =
          dense::moving_tip(arm, Vector{{angle}}, Vector{{rate}}, Vector{{acceleration + extra}});
      const double sign = e[positive] < 0 ? -1 : 1;
      const Vector got = sign * joined(dense::time_derivatives(dense::quaternion(tip.R, positive)));
      return (got - want).cwiseAbs().maxCoeff();
    };
    for (int positive = 0; positive < 4; ++positive) {
      // Four divisions by the chosen component and its square at most thrice, as in bound() above.
      const double tolerance = bound(std::abs(e[positive]));
      INFO("component " << positive << " angle " << angle);
      CHECK(error(positive, 0) <= tolerance);
      CHECK(error(positive, 10 * 2 * std::sqrt(3) * tolerance) >
            tolerance);  // moves ydd by 10 tolerances or more
    }
  }
}

TEST_CASE("a moving pose and the arm that makes it have the same second derivatives") {
  // A revolute joint about z at the base carries the tip at distance 1 along x: angular velocity qd, linear
  // velocity along y, centripetal acceleration towards the axis.
  const double q = 0.6, qd = 1.3, qdd = -0.7;
  Chain<double> arm;
  arm.links = {joint(JointType::revolute, Z)};
  arm.p_tip = X;
  const auto by_arm = dense::moving_tip(arm, Vector{{q}}, Vector{{qd}}, Vector{{qdd}});
  const Vector3<double> out(std::cos(q), std::sin(q), 0), along(-std::sin(q), std::cos(q), 0);
  dense::Vector6<double> beta, betad;
  beta << qd * Z, qd * along;
  betad << qdd * Z, qdd * along - qd * qd * out;
  const Matrix3<double> R = rotation(Z, std::cos(q), std::sin(q));
  const auto by_hand = dense::moving_pose(R, out, beta, betad);
  const double tolerance = 8 * eps * 2;  // a few roundings of numbers up to 2
  const Matrix3<double> Rdd = derivatives(derivatives(by_arm.R)) - derivatives(derivatives(by_hand.R));
  const Vector3<double> pdd = derivatives(derivatives(by_arm.p)) - derivatives(derivatives(by_hand.p));
  CHECK(Rdd.cwiseAbs().maxCoeff() <= tolerance);
  CHECK(pdd.cwiseAbs().maxCoeff() <= tolerance);
  betad[2] += 10 * tolerance;
  const auto moved = dense::moving_pose(R, out, beta, betad);
  const Matrix3<double> changed = derivatives(derivatives(by_arm.R)) - derivatives(derivatives(moved.R));
  CHECK(changed.cwiseAbs().maxCoeff() > tolerance);
}

}  // namespace osculate::testing::coordinates_tests
