// Rotation vectors: exponential, logarithm, and the map between their rates and angular velocity.
// All vectors in the base frame. For R(t) = exp(r(t)): omega = left_jacobian(r) rd, R. = omega~ R.
#pragma once

#include "control/rotation_coefficients.hpp"
#include "model/chain.hpp"

namespace osculate {

/// Everything about one rotation vector r = r(t), |r| < 2 pi, with the coefficients computed once. Applies
/// maps to vectors; the functions below give the same maps as matrices.
class RotationVector {
 public:
  explicit RotationVector(const Vector3<double>& r);

  /// exp(r) x
  Vector3<double> turned(const Vector3<double>& x) const;
  /// exp(r) R
  Matrix3<double> turned(const Matrix3<double>& R) const;
  /// J_l(r) x: the angular velocity for the rate x.
  Vector3<double> left_jacobian(const Vector3<double>& x) const;
  /// J_l(r)^-1 x: the rate for the angular velocity x.
  Vector3<double> left_jacobian_inverse(const Vector3<double>& x) const;
  /// (d/dt J_l(r)) x for the rate rd.
  Vector3<double> left_jacobian_rate(const Vector3<double>& rd, const Vector3<double>& x) const;

 private:
  Vector3<double> r_;
  RotationCoefficients f_;
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
