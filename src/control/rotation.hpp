// Rotation vectors: exponential, logarithm, and the map between their rates and angular velocity.
// All vectors in the base frame. For R(t) = exp(r(t)): omega = left_jacobian(r) rd, R. = omega~ R.
#pragma once

#include <Eigen/Geometry>

#include "control/rotation_coefficients.hpp"
#include "model/chain.hpp"

namespace osculate {

/// Everything about one rotation vector r = r(t), |r| < 2 pi, with the coefficients computed once. Applies
/// maps to vectors; the functions below give the same maps as matrices. By default r = 0.
class RotationVector {
 public:
  RotationVector() = default;
  explicit RotationVector(const Vector3<double>& r) : r_(r), f_(rotation_coefficients(r.squaredNorm())) {}

  /// exp(r) x
  Vector3<double> turned(const Vector3<double>& x) const {
    const Vector3<double> rx = r_.cross(x);
    return x + f_.a * rx + f_.b * r_.cross(rx);
  }
  /// exp(r) R
  Matrix3<double> turned(const Matrix3<double>& R) const {
    Matrix3<double> out;
    for (int j = 0; j < 3; ++j) out.col(j) = turned(Vector3<double>(R.col(j)));
    return out;
  }
  /// J_l(r) x: the angular velocity for the rate x.
  Vector3<double> left_jacobian(const Vector3<double>& x) const {
    const Vector3<double> rx = r_.cross(x);
    return x + f_.b * rx + f_.c * r_.cross(rx);
  }
  /// J_l(r)^-1 x: the rate for the angular velocity x.
  Vector3<double> left_jacobian_inverse(const Vector3<double>& x) const {
    const Vector3<double> rx = r_.cross(x);
    return x - 0.5 * rx - (f_.b_slope / f_.b) * r_.cross(rx);  // see inverse_jacobian_coefficient
  }
  /// (d/dt J_l(r)) x for the rate rd.
  Vector3<double> left_jacobian_rate(const Vector3<double>& rd, const Vector3<double>& x) const {
    const double sd = 2 * r_.dot(rd);
    const Vector3<double> rx = r_.cross(x), rdx = rd.cross(x);
    return f_.b_slope * sd * rx + f_.b * rdx + f_.c_slope * sd * r_.cross(rx) +
           f_.c * (rd.cross(rx) + r_.cross(rdx));
  }
  /// (d/dt J_l(r)) rd
  Vector3<double> left_jacobian_rate(const Vector3<double>& rd) const {
    const double sd = 2 * r_.dot(rd);
    const Vector3<double> rrd = r_.cross(rd);
    return f_.b_slope * sd * rrd + f_.c_slope * sd * r_.cross(rrd) + f_.c * rd.cross(rrd);
  }

 private:
  Vector3<double> r_ = Vector3<double>::Zero();
  RotationCoefficients f_ = {1, 1 / 2.0, 1 / 6.0, -1 / 24.0, -1 / 120.0};
};

/// a~, the matrix of the vector product: cross_matrix(a) x = a x x.
Matrix3<double> cross_matrix(const Vector3<double>& a);

/// Rotation by |r| about r; exact near zero.
Matrix3<double> exp_rotation(const Vector3<double>& r);

/// Rotation vector of R, |r| <= pi; accurate to rounding near 0 and near pi.
Vector3<double> log_rotation(const Matrix3<double>& R);

/// J_l with omega = J_l(r) rd.
Matrix3<double> left_jacobian(const Vector3<double>& r);

/// J_l^-1, for |r| < 2 pi.
Matrix3<double> left_jacobian_inverse(const Vector3<double>& r);

/// d/dt J_l(r(t)) for the rate rd.
Matrix3<double> left_jacobian_rate(const Vector3<double>& r, const Vector3<double>& rd);

/// Rotation matrix to unit quaternion w, x, y, z; the sign is the one nearer to `previous` (w >= 0 if that is
/// zero).
Eigen::Vector4d quaternion(const Matrix3<double>& R,
                           const Eigen::Vector4d& previous = Eigen::Vector4d::Zero());

}  // namespace osculate
