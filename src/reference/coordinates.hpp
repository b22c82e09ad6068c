// The judge of operational coordinates: y as a function of the tip's pose, from the definition of each
// coordinate, and its first two time derivatives by differentiating that function along a motion with nested
// dual numbers. No Pi appears. Base frame, angular rows first, SI units and radians.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

#include "model/pose.hpp"
#include "reference/dense.hpp"
#include "scalar/dual.hpp"

namespace osculate {

// Elementary functions of dual numbers, nested or not, found by argument-dependent lookup. Undefined where
// the function has no derivative.

template <Field S>
Dual<S> sqrt(const Dual<S>& x) {
  using std::sqrt;
  const S root = sqrt(x.value);
  return {root, x.derivative / (S(2) * root)};
}

template <Field S>
Dual<S> sin(const Dual<S>& x) {
  using std::cos;
  using std::sin;
  return {sin(x.value), cos(x.value) * x.derivative};
}

template <Field S>
Dual<S> cos(const Dual<S>& x) {
  using std::cos;
  using std::sin;
  return {cos(x.value), -sin(x.value) * x.derivative};
}

template <Field S>
Dual<S> acos(const Dual<S>& x) {
  using std::acos;
  using std::sqrt;
  return {acos(x.value), -x.derivative / sqrt((S(1) - x.value) * (S(1) + x.value))};
}

/// The angle of the point (x, y), which is not the origin.
template <Field S>
Dual<S> atan2(const Dual<S>& y, const Dual<S>& x) {
  using std::atan2;
  const S square = x.value * x.value + y.value * y.value;
  return {atan2(y.value, x.value), (x.value * y.derivative - y.value * x.derivative) / square};
}

namespace dense {

/// x(t) to second order: value (x, x.), derivative (x., x..).
template <Field S>
using Nested = Dual<Dual<S>>;

template <Field S>
Nested<S> nested(const S& x, const S& xd, const S& xdd) {
  return {Dual<S>(x, xd), Dual<S>(xd, xdd)};
}

/// A moving pose to second order.
template <Field S>
struct MovingPose {
  Matrix3<Nested<S>> R;
  Vector3<Nested<S>> p;  // m
};

/// The pose (R, p) that moves with velocity beta and acceleration betad = beta.:
///   R. = w~ R,   R.. = (w.~ + w~ w~) R.
template <Field S>
MovingPose<S> moving_pose(const Matrix3<S>& R, const Vector3<S>& p, const Vector6<S>& beta,
                          const Vector6<S>& betad) {
  const Matrix3<S> W = cross_matrix(Vector3<S>(beta.template head<3>()));
  const Matrix3<S> Wd = cross_matrix(Vector3<S>(betad.template head<3>()));
  const Matrix3<S> Rd = W * R;
  const Matrix3<S> Rdd = Wd * R + W * Rd;
  MovingPose<S> out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.R(i, j) = nested(R(i, j), Rd(i, j), Rdd(i, j));
    out.p[i] = nested(p[i], beta[3 + i], betad[3 + i]);
  }
  return out;
}

/// The tip of an arm of revolute and prismatic joints moving with q, qd, qdd (rad or m; base to tip).
template <Field S>
MovingPose<S> moving_tip(const Chain<S>& chain, const VectorX<S>& q, const VectorX<S>& qd,
                         const VectorX<S>& qdd) {
  using N = Nested<S>;
  std::vector<JointPosition<N>> joints(chain.links.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int k = static_cast<int>(i);
    const N at = nested(q[k], qd[k], qdd[k]);
    if (chain.links[i].type == JointType::revolute)
      joints[i].c = cos(at), joints[i].s = sin(at);
    else
      joints[i].d = at;
  }
  const auto tip = places(chain, joints).tip;
  return {tip.R, tip.p};
}

/// roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll), from its first column and last row:
/// (cos y cos p, sin y cos p, -sin p) and (-sin p, cos p sin r, cos p cos r), with |p| < pi/2.
template <Field N>
Vector3<N> roll_pitch_yaw(const Matrix3<N>& R) {
  const N quarter_turn = atan2(N(1), N(0));
  return {atan2(R(2, 1), R(2, 2)), acos(R(2, 0)) - quarter_turn, atan2(R(1, 0), R(0, 0))};
}

/// a, b, c of R = Rz(a) Ry(b) Rz(c), from its last column and last row:
/// (cos a sin b, sin a sin b, cos b) and (-sin b cos c, sin b sin c, cos b), with 0 < b < pi.
template <Field N>
Vector3<N> zyz_euler(const Matrix3<N>& R) {
  return {atan2(R(1, 2), R(0, 2)), acos(R(2, 2)), atan2(R(2, 1), -R(2, 0))};
}

/// w, x, y, z with component `positive` > 0, which must not be 0 in R; use a large one. From the diagonal of
/// R, 4 w^2 = 1 + R00 + R11 + R22, 4 x^2 = 1 + R00 - R11 - R22 and so on; then the others from 4 w x =
/// R21 - R12, 4 x y = R10 + R01 and their cyclic kin.
template <Field N>
Eigen::Matrix<N, 4, 1> quaternion(const Matrix3<N>& R, int positive) {
  Eigen::Matrix<N, 4, 1> e;
  if (positive == 0) {
    e[0] = sqrt(N(1) + R(0, 0) + R(1, 1) + R(2, 2)) / N(2);
    const N four = N(4) * e[0];
    e[1] = (R(2, 1) - R(1, 2)) / four;
    e[2] = (R(0, 2) - R(2, 0)) / four;
    e[3] = (R(1, 0) - R(0, 1)) / four;
    return e;
  }
  const int i = positive - 1, j = (i + 1) % 3, k = (i + 2) % 3;
  e[1 + i] = sqrt(N(1) + R(i, i) - R(j, j) - R(k, k)) / N(2);
  const N four = N(4) * e[1 + i];
  e[0] = (R(k, j) - R(j, k)) / four;
  e[1 + j] = (R(i, j) + R(j, i)) / four;
  e[1 + k] = (R(i, k) + R(k, i)) / four;
  return e;
}

/// rho, phi, z; not on the z axis.
template <Field N>
Vector3<N> cylindrical(const Vector3<N>& p) {
  return {sqrt(p[0] * p[0] + p[1] * p[1]), atan2(p[1], p[0]), p[2]};
}

/// r, theta, phi; not on the z axis.
template <Field N>
Vector3<N> spherical(const Vector3<N>& p) {
  const N r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  return {r, acos(p[2] / r), atan2(p[1], p[0])};
}

/// A vector that moves, and its first two time derivatives.
template <class V>
struct TimeDerivatives {
  V y, yd, ydd;
};

template <Field S, int size>
TimeDerivatives<Eigen::Matrix<S, size, 1>> time_derivatives(const Eigen::Matrix<Nested<S>, size, 1>& y) {
  return {values(values(y)), derivatives(values(y)), derivatives(derivatives(y))};
}

}  // namespace dense
}  // namespace osculate
