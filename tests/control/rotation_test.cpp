#include "control/rotation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "control/rotation_coefficients.hpp"
#include "control/wide_rotation.hpp"
#include "support/catch.hpp"

namespace osculate::testing::rotation_tests {
using namespace osculate::test;

namespace {

/// a, b, c, b_slope, c_slope, -b_slope/b in long double, switched at s = 1, far from the switch of the
/// program. There the closed forms lose at most a factor 120 (c_slope), 0.06 of an eps of double.
std::array<Wide, 6> wide_coefficients(Wide s) {
  Wide a = 0, b = 0, c = 0, b_slope = 0, c_slope = 0;
  if (s < 1) {
    Wide power = 1, factorial = 1;  // (-s)^k, (2k + 1)!
    for (int k = 0; k < 25; ++k) {
      if (k > 0) factorial *= Wide(2 * k) * Wide(2 * k + 1);
      const Wide to_2 = factorial * (2 * k + 2), to_3 = to_2 * (2 * k + 3), to_4 = to_3 * (2 * k + 4);
      a += power / factorial;
      b += power / to_2;
      c += power / to_3;
      b_slope -= (k + 1) * power / to_4;
      c_slope -= (k + 1) * power / (to_4 * (2 * k + 5));
      power *= -s;
    }
  } else {
    const Wide theta = std::sqrt(s), half = std::sin(theta / 2);
    a = std::sin(theta) / theta;
    b = 2 * half * half / s;
    c = (1 - a) / s;
    b_slope = (a / 2 - b) / s;
    c_slope = (3 * a - std::cos(theta) - 2) / (2 * s * s);
  }
  return {a, b, c, b_slope, c_slope, -b_slope / b};
}

std::array<double, 6> coefficients(double s) {
  const auto f = rotation_coefficients(s);
  return {f.a, f.b, f.c, f.b_slope, f.c_slope, inverse_jacobian_coefficient(s)};
}

const std::array<const char*, 6> coefficient_names{"a", "b", "c", "b_slope", "c_slope", "inverse"};

double largest(const WideMatrix& x) { return static_cast<double>(x.cwiseAbs().maxCoeff()); }

/// Angles from 1e-12 to 6.2 on a logarithmic scale, i = 0 .. 399.
double angle(int i) { return std::pow(10.0, -12 + i * (std::log10(6.2) + 12) / 399); }

Eigen::Matrix3d rounded_exp(const Eigen::Vector3d& r) {
  return power_series(r.cast<Wide>(), WideVector::Zero(), 0).value.cast<double>();
}

}  // namespace

TEST_CASE("coefficients of exp and Jacobian agree with long double on both sides of the switch") {
  std::vector<double> samples{0, 1e-300, std::nextafter(6.0, 0.0), 6.0, std::nextafter(6.0, 7.0)};
  for (int i = 1; i < 2000; ++i) samples.push_back(39.4 * i / 2000);
  for (int i = 0; i < 400; ++i) samples.push_back(angle(i) * angle(i));
  for (const double s : samples) {
    const auto got = coefficients(s);
    const auto expected = wide_coefficients(s);
    const auto nearby = wide_coefficients(Wide(s) * (1 + Wide(1e-6)));
    for (std::size_t i = 0; i < got.size(); ++i) {
      INFO(coefficient_names[i] << "(" << s << ")");
      // theta = sqrt(s) and the arguments of sine and cosine are rounded: as if s were wrong by 2 eps. Beyond
      // that the largest loss is a factor 4.5 (c_slope above the switch), seen as 4.7 eps; 8 allowed.
      const Wide by_rounding_s = std::abs(nearby[i] - expected[i]) / Wide(1e-6);
      const Wide tolerance = eps * (8 * std::abs(expected[i]) + 2 * by_rounding_s);
      CHECK(std::abs(got[i] - expected[i]) <= tolerance);
    }
  }
}

TEST_CASE("coefficients at zero are the limits") {
  const auto f = rotation_coefficients(0);
  CHECK(f.a == 1.0);
  CHECK(f.b == 1.0 / 2);
  CHECK(f.c == 1.0 / 6);
  CHECK(f.b_slope == -1.0 / 24);
  CHECK(f.c_slope == -1.0 / 120);
  CHECK(inverse_jacobian_coefficient(0) == Approx(1.0 / 12).epsilon(eps));
}

TEST_CASE("exp, left Jacobian, its inverse and its rate agree with the power series") {
  std::mt19937 random(11);
  for (int i = 0; i < 400; ++i) {
    const double theta = angle(i);
    const Eigen::Vector3d r = theta * random_direction(random), rd = random_vector(random);
    INFO("angle " << theta << ", sample " << i);
    const auto exponential = power_series(r.cast<Wide>(), rd.cast<Wide>(), 0);
    const auto jacobian = power_series(r.cast<Wide>(), rd.cast<Wide>(), 1);
    // Entries are sums of at most 4 products: coefficient within 2 eps (1 + theta) absolutely, times theta.
    const double tolerance = 4 * eps * (1 + theta);
    CHECK(largest(exp_rotation(r).cast<Wide>() - exponential.value) <= tolerance);
    CHECK(largest(left_jacobian(r).cast<Wide>() - jacobian.value) <= tolerance);
    CHECK(largest(left_jacobian_rate(r, rd).cast<Wide>() - jacobian.rate) <= tolerance * rd.norm());
    // The quadratic term of the inverse has the size coefficient theta^2, unbounded towards 2 pi.
    const double inverse_size = 1 + inverse_jacobian_coefficient(theta * theta) * theta * theta;
    CHECK(largest(left_jacobian_inverse(r).cast<Wide>() * jacobian.value - WideMatrix::Identity()) <=
          tolerance * inverse_size);
  }
}

TEST_CASE("small rotations are accurate relative to their size") {
  std::mt19937 random(12);
  for (const double theta : {1e-200, 1e-100, 1e-12, 1e-9, 1e-6, 1e-3}) {
    const Eigen::Vector3d r = theta * random_direction(random);
    INFO("angle " << theta);
    const Eigen::Matrix3d R = exp_rotation(r);
    const Eigen::Vector3d off_diagonal(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    const WideVector expected = 2 * wide_quaternion(r.cast<Wide>())[0] * 2 *
                                wide_quaternion(r.cast<Wide>()).tail<3>();  // 2 sin(theta) axis
    CHECK((off_diagonal.cast<Wide>() - expected).norm() <= 4 * eps * theta);
    CHECK((log_rotation(R) - r).norm() <= 4 * eps * theta);
  }
}

TEST_CASE("angular velocity is J_l times the rate: omega~ = Rdot R^T") {
  std::mt19937 random(13);
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d r = angle(i) * random_direction(random), rd = random_vector(random);
    const auto R = power_series(r.cast<Wide>(), rd.cast<Wide>(), 0);
    const WideMatrix spin = R.rate * R.value.transpose();
    const Eigen::Vector3d omega = left_jacobian(r) * rd;
    INFO("angle " << angle(i) << ", sample " << i);
    CHECK(largest(wide_cross(omega.cast<Wide>()) - spin) <= 6 * eps * (1 + angle(i)) * rd.norm());
  }
}

TEST_CASE("log inverts exp up to pi") {
  std::mt19937 random(14);
  for (int i = 0; i < 400; ++i) {
    const double theta = std::min(angle(i), 3.14159);
    const Eigen::Vector3d r = theta * random_direction(random);
    INFO("angle " << theta << ", sample " << i);
    // The entries of the rounded R that matter are wrong by eps/2 of theta; the largest quaternion component
    // halves them.
    CHECK((log_rotation(rounded_exp(r)) - r).norm() <= 6 * eps * theta);
  }
}

TEST_CASE("log near half a turn, about axes on and off the coordinate directions") {
  std::mt19937 random(15);
  std::vector<Eigen::Vector3d> axes{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                    Eigen::Vector3d::UnitZ()};
  for (int i = 0; i < 30; ++i) axes.push_back(random_direction(random));
  for (const auto& axis : axes)
    for (double digits = 0; digits <= 17; digits += 0.25) {
      const Eigen::Vector3d r = (3.141592653589793 - std::pow(10.0, -digits)) * axis;
      const Eigen::Vector3d got = log_rotation(rounded_exp(r));
      INFO("pi - 1e-" << digits << ", axis " << axis.transpose());
      // Within rounding of half a turn both signs are right.
      const bool either = digits >= 15;
      const double error = either ? std::min((got - r).norm(), (got + r).norm()) : (got - r).norm();
      // The rounding of R turns it by at most 1.1 eps; seen 1.5 eps pi with the arithmetic of log.
      CHECK(error <= 3 * eps * 3.15);
      CHECK(got.norm() <= 3.141592653589793 * (1 + 2 * eps));
    }
}

TEST_CASE("log of the identity and of exact half turns") {
  CHECK(log_rotation(Eigen::Matrix3d::Identity()) == Eigen::Vector3d::Zero());
  const Eigen::Matrix3d half_turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
  CHECK(std::abs(log_rotation(half_turn)[0]) == 3.141592653589793);
  CHECK(log_rotation(half_turn).tail<2>() == Eigen::Vector2d::Zero());
}

TEST_CASE("quaternion: value, sign without a predecessor, continuity of sign") {
  std::mt19937 random(16);
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d r = angle(i) * random_direction(random);
    const WideQuaternion expected = wide_quaternion(r.cast<Wide>());
    const Eigen::Vector4d q = quaternion(rounded_exp(r));
    INFO("angle " << angle(i));
    CHECK(q[0] >= 0);
    CHECK(std::min((q.cast<Wide>() - expected).norm(), (q.cast<Wide>() + expected).norm()) <= 4 * eps);
  }
  // Two turns about a fixed axis: q follows (cos, sin) of half the angle through both signs of w.
  const Eigen::Vector3d axis = random_direction(random);
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  for (int i = 0; i <= 400; ++i) {
    const Eigen::Vector3d r = 4 * 3.141592653589793 * i / 400 * axis;
    q = quaternion(exp_rotation(r), q);
    INFO("step " << i);
    // exp_rotation is wrong by 4 eps (1 + |r|) at the most; the quaternion by half of that and 4 eps of its
    // own.
    CHECK((q.cast<Wide>() - wide_quaternion(r.cast<Wide>())).norm() <= eps * (4 + 4 * (1 + r.norm())));
  }
}

TEST_CASE("cross_matrix is the vector product") {
  const Eigen::Vector3d a(1, 2, 3), b(-2, 5, 7);
  CHECK(cross_matrix(a) * b == Eigen::Vector3d(-1, -13, 9));
  CHECK(cross_matrix(a) == -cross_matrix(a).transpose());
}

}  // namespace osculate::testing::rotation_tests
