// The scalar functions behind exp and the left Jacobian, as functions of s = |r|^2: smooth at s = 0, no
// square root there.
#pragma once

namespace osculate {

/// With theta = sqrt(s); each accurate to a few eps for 0 <= s < 4 pi^2 (relative; near the zeros of a and b
/// relative to 1 and to the error that rounding of s brings). Beyond, absolute accuracy only.
struct RotationCoefficients {
  double a;        // sin(theta) / theta
  double b;        // (1 - cos(theta)) / theta^2
  double c;        // (theta - sin(theta)) / theta^3
  double b_slope;  // db/ds
  double c_slope;  // dc/ds
};

RotationCoefficients rotation_coefficients(double s);

/// (1 - (theta/2) cot(theta/2)) / theta^2 = -b_slope / b, for 0 <= s < 4 pi^2: the quadratic term of J_l^-1.
double inverse_jacobian_coefficient(double s);

}  // namespace osculate
