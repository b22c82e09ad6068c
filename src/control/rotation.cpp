#include "control/rotation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace osculate {

namespace {

// b = sum (-s)^k / (2k+2)!,  c = sum (-s)^k / (2k+3)!, and their derivatives, all alternating with falling
// terms for s <= 6, so that the first term left out bounds the remainder. At s = 6 the closed forms lose at
// most a factor 2 / |3a - cos - 2| = 4.5 to cancellation (in c_slope), the series at most (cosh - 1) / (1 -
// cos) = 2.7 (in b). With 12 terms the remainders at s = 6, relative to the sum, are below 2e-17 (b), 2e-18
// (c), 4e-18 (b_slope), 1e-19 (c_slope).
constexpr double switch_to_closed_form = 6;
constexpr int terms = 12;

constexpr double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

/// Coefficients of sum over k of (-s)^k / (2k + first)!, k = 0 .. terms (one more, for the derivative).
constexpr std::array<double, terms + 1> alternating(int first) {
  std::array<double, terms + 1> out{};
  for (int k = 0; k <= terms; ++k) out[k] = (k % 2 == 0 ? 1 : -1) / factorial(2 * k + first);
  return out;
}

constexpr std::array<double, terms + 1> slope(const std::array<double, terms + 1>& series) {
  std::array<double, terms + 1> out{};
  for (int k = 0; k < terms; ++k) out[k] = (k + 1) * series[k + 1];
  return out;
}

constexpr auto series_b = alternating(2);
constexpr auto series_c = alternating(3);
constexpr auto series_b_slope = slope(series_b);
constexpr auto series_c_slope = slope(series_c);

/// The matrix of a linear map of vectors.
template <class LinearMap>
Matrix3<double> matrix_of(const LinearMap& map) {
  Matrix3<double> out;
  for (int j = 0; j < 3; ++j) out.col(j) = map(Vector3<double>::Unit(j));
  return out;
}

}  // namespace

RotationCoefficients rotation_coefficients(double s) {
  RotationCoefficients f;
  if (s <= switch_to_closed_form) {
    f.b = f.c = f.b_slope = f.c_slope = 0;
    for (int k = terms - 1; k >= 0; --k) {
      f.b = series_b[k] + s * f.b;
      f.c = series_c[k] + s * f.c;
      f.b_slope = series_b_slope[k] + s * f.b_slope;
      f.c_slope = series_c_slope[k] + s * f.c_slope;
    }
    f.a = 1 - s * f.c;
    return f;
  }
  const double theta = std::sqrt(s);
  const double half = std::sin(theta / 2);
  f.a = std::sin(theta) / theta;
  f.b = 2 * half * half / s;
  f.c = (1 - f.a) / s;
  f.b_slope = (f.a / 2 - f.b) / s;
  f.c_slope = (3 * f.a - std::cos(theta) - 2) / (2 * s * s);
  return f;
}

double inverse_jacobian_coefficient(double s) {
  const auto f = rotation_coefficients(s);
  return -f.b_slope / f.b;  // (theta/2) cot(theta/2) = a / (2 b), and b_slope = (a/2 - b) / s
}

Matrix3<double> cross_matrix(const Vector3<double>& a) {
  Matrix3<double> out;
  out << 0, -a[2], a[1],  //
      a[2], 0, -a[0],     //
      -a[1], a[0], 0;
  return out;
}

RotationVector::RotationVector(const Vector3<double>& r)
    : r_(r), f_(rotation_coefficients(r.squaredNorm())) {}

Vector3<double> RotationVector::turned(const Vector3<double>& x) const {
  const Vector3<double> rx = r_.cross(x);
  return x + f_.a * rx + f_.b * r_.cross(rx);
}

Matrix3<double> RotationVector::turned(const Matrix3<double>& R) const {
  Matrix3<double> out;
  for (int j = 0; j < 3; ++j) out.col(j) = turned(Vector3<double>(R.col(j)));
  return out;
}

Vector3<double> RotationVector::left_jacobian(const Vector3<double>& x) const {
  const Vector3<double> rx = r_.cross(x);
  return x + f_.b * rx + f_.c * r_.cross(rx);
}

Vector3<double> RotationVector::left_jacobian_inverse(const Vector3<double>& x) const {
  const Vector3<double> rx = r_.cross(x);
  return x - 0.5 * rx - (f_.b_slope / f_.b) * r_.cross(rx);  // see inverse_jacobian_coefficient
}

Vector3<double> RotationVector::left_jacobian_rate(const Vector3<double>& rd,
                                                   const Vector3<double>& x) const {
  const double sd = 2 * r_.dot(rd);
  const Vector3<double> rx = r_.cross(x), rdx = rd.cross(x);
  return f_.b_slope * sd * rx + f_.b * rdx + f_.c_slope * sd * r_.cross(rx) +
         f_.c * (rd.cross(rx) + r_.cross(rdx));
}

Matrix3<double> exp_rotation(const Vector3<double>& r) {
  return RotationVector(r).turned(Matrix3<double>(Matrix3<double>::Identity()));
}

Vector3<double> log_rotation(const Matrix3<double>& R) {
  const Eigen::Vector4d q = quaternion(R);  // w >= 0
  const Vector3<double> v = q.tail<3>();    // sin(theta/2) times the axis
  const double sine_squared = v.squaredNorm();
  // theta / sin(theta/2) = 2 (1 + sin^2/6 + ...): 2 to rounding below eps, where the square may also
  // underflow.
  if (sine_squared < std::numeric_limits<double>::epsilon()) return 2 * v;
  const double sine = std::sqrt(sine_squared);
  return 2 * std::atan2(sine, q[0]) / sine * v;
}

Matrix3<double> left_jacobian(const Vector3<double>& r) {
  return matrix_of([at = RotationVector(r)](const Vector3<double>& x) { return at.left_jacobian(x); });
}

Matrix3<double> left_jacobian_inverse(const Vector3<double>& r) {
  return matrix_of(
      [at = RotationVector(r)](const Vector3<double>& x) { return at.left_jacobian_inverse(x); });
}

Matrix3<double> left_jacobian_rate(const Vector3<double>& r, const Vector3<double>& rd) {
  return matrix_of(
      [at = RotationVector(r), &rd](const Vector3<double>& x) { return at.left_jacobian_rate(rd, x); });
}

Eigen::Vector4d quaternion(const Matrix3<double>& R, const Eigen::Vector4d& previous) {
  // 4 times one row of q q^T, the row of the largest component: that one is at least 1/2, so nothing cancels.
  const double x = R(0, 0), y = R(1, 1), z = R(2, 2);
  Eigen::Vector4d q;
  if (x + y + z >= std::max({x, y, z}))
    q << 1 + x + y + z, R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1);
  else if (x >= y && x >= z)
    q << R(2, 1) - R(1, 2), 1 + x - y - z, R(0, 1) + R(1, 0), R(0, 2) + R(2, 0);
  else if (y >= z)
    q << R(0, 2) - R(2, 0), R(0, 1) + R(1, 0), 1 - x + y - z, R(1, 2) + R(2, 1);
  else
    q << R(1, 0) - R(0, 1), R(0, 2) + R(2, 0), R(1, 2) + R(2, 1), 1 - x - y + z;
  q /= q.norm();
  const double agreement = previous.isZero(0) ? q[0] : q.dot(previous);
  return agreement < 0 ? Eigen::Vector4d(-q) : q;
}

}  // namespace osculate
