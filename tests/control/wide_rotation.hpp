// Rotations in long double, from the definitions: power series of matrices, and quaternions for the
// logarithm. Nothing is shared with control/rotation.cpp.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "scalar/eps.hpp"

namespace osculate::test {

using Wide = long double;
using WideVector = Eigen::Matrix<Wide, 3, 1>;
using WideMatrix = Eigen::Matrix<Wide, 3, 3>;
using WideQuaternion = Eigen::Matrix<Wide, 4, 1>;  // w, x, y, z

inline const Wide wide_pi = std::acos(Wide(-1));

/// A matrix and its derivative along the rate rd.
struct WideDual {
  WideMatrix value, rate;
};

inline WideMatrix wide_cross(const WideVector& a) {
  WideMatrix out;
  out << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return out;
}

/// sum r~^k / (k + shift)!, k = 0 .. 79: exp for shift 0, left Jacobian for shift 1. The remainder at |r| = 2
/// pi is below 1e-50; cancellation costs at most exp(2 pi) = 535 long double roundings, a quarter of one in
/// double.
inline WideDual power_series(const WideVector& r, const WideVector& rd, int shift) {
  const WideMatrix A = wide_cross(r), Ad = wide_cross(rd);
  WideDual term{WideMatrix::Identity(), WideMatrix::Zero()};
  WideDual out = term;
  for (int k = 1; k < 80; ++k) {
    term = {term.value * A / Wide(k + shift), (term.rate * A + term.value * Ad) / Wide(k + shift)};
    out.value += term.value;
    out.rate += term.rate;
  }
  return out;
}

inline WideQuaternion product(const WideQuaternion& a, const WideQuaternion& b) {
  WideQuaternion out;
  out << a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
      a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
      a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
      a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
  return out;
}

inline WideQuaternion conjugate(const WideQuaternion& q) { return {q[0], -q[1], -q[2], -q[3]}; }

inline WideQuaternion wide_quaternion(const WideVector& r) {
  const Wide angle = r.norm();
  const Wide ratio = angle == 0 ? Wide(0.5) : std::sin(angle / 2) / angle;
  return {std::cos(angle / 2), ratio * r[0], ratio * r[1], ratio * r[2]};
}

/// Rotation vector with |r| <= 2 pi of the branch that w continues: no jump at pi.
inline WideVector wide_log(const WideQuaternion& q) {
  const WideVector v = q.tail<3>();
  const Wide sine = v.norm();
  if (sine == 0) return WideVector::Zero();
  return 2 * std::atan2(sine, q[0]) / sine * v;
}

inline Eigen::Vector3d random_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

inline Eigen::Vector3d random_direction(std::mt19937& random) { return random_vector(random).normalized(); }

}  // namespace osculate::test
