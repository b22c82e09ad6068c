#include "control/rotation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

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

/// The four series side by side: coefficients of s^k in b, c, b_slope, c_slope.
using Four = Eigen::Array<double, 4, 1>;
constexpr auto four_series = [] {
  const auto b = alternating(2), c = alternating(3), b_slope = slope(b), c_slope = slope(c);
  std::array<std::array<double, 4>, terms> out{};
  for (int k = 0; k < terms; ++k) out[k] = {b[k], c[k], b_slope[k], c_slope[k]};
  return out;
}();

/// asin(x) / x = sum a_k x^2k, a_k = (2k)! / (4^k k!^2 (2k + 1)); for x^2 <= small_sine_squared the terms
/// left out are below 2e-20.
constexpr double small_sine_squared = 1e-3;
constexpr auto series_asin = [] {
  std::array<double, 6> out{};
  double a = 1;  // (2k)! / (4^k k!^2)
  for (int k = 0; k < 6; ++k) {
    out[k] = a / (2 * k + 1);
    a *= (2 * k + 1) / (2.0 * (k + 1));
  }
  return out;
}();

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
    const auto coefficients = [](int k) { return Eigen::Map<const Four>(four_series[k].data()); };
    Four sum = coefficients(terms - 1);
#pragma GCC unroll 12
    for (int k = terms - 2; k >= 0; --k) sum = coefficients(k) + s * sum;
    return {1 - s * sum[1], sum[0], sum[1], sum[2], sum[3]};
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

Matrix3<double> exp_rotation(const Vector3<double>& r) {
  return RotationVector(r).turned(Matrix3<double>(Matrix3<double>::Identity()));
}

Vector3<double> log_rotation(const Matrix3<double>& R) {
  const Eigen::Vector4d q = quaternion(R);  // w >= 0
  const Vector3<double> v = q.tail<3>();    // sin(theta/2) times the axis
  const double sine_squared = v.squaredNorm();
  if (sine_squared <= small_sine_squared) {  // 2 asin(sine) / sine, no root of what may underflow
    double sum = 0;
    for (std::size_t k = series_asin.size(); k-- > 0;) sum = series_asin[k] + sine_squared * sum;
    return 2 * sum * v;
  }
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
