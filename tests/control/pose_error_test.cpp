#include "control/pose_error.hpp"

#include <cmath>

#include "control/differences.hpp"
#include "control/rotation.hpp"
#include "control/wide_rotation.hpp"
#include "support/catch.hpp"

namespace osculate::testing::pose_error_tests {
using namespace osculate::test;

namespace {

/// A motion of reference and tip about t = 0. Both turn as exp(omega t + omegad t^2 / 2) times the start:
/// angular velocity omega and angular acceleration omegad at t = 0, because the two commute to that order.
struct Motion {
  TipReference reference;
  Pose tip;
  Vector6 tip_velocity, tip_acceleration;
  WideQuaternion reference_start, tip_start;  // exact to long double; the matrices are their rounding
};

WideQuaternion turning(const Vector6& velocity, const Vector6& acceleration, const WideQuaternion& start,
                       Wide t) {
  const WideVector psi =
      velocity.head<3>().cast<Wide>() * t + acceleration.head<3>().cast<Wide>() * (t * t / 2);
  return product(wide_quaternion(psi), start);
}

/// The orientation error e_R(t) in long double, continuous through half a turn.
WideVector orientation_error(const Motion& m, Wide t) {
  const WideQuaternion q_ref = turning(m.reference.velocity, m.reference.acceleration, m.reference_start, t);
  const WideQuaternion q = turning(m.tip_velocity, m.tip_acceleration, m.tip_start, t);
  return wide_log(product(q_ref, conjugate(q)));
}

Vector6 random_twist(std::mt19937& random, double size) {
  Vector6 out;
  const Eigen::Vector3d angular = size * random_vector(random), linear = size * random_vector(random);
  out << angular, linear;
  return out;
}

/// Start with the given orientation error, random otherwise. Tip acceleration zero.
Motion random_motion(std::mt19937& random, const Eigen::Vector3d& e_R) {
  Motion m;
  const WideVector r_ref = random_vector(random).cast<Wide>();
  m.reference_start = wide_quaternion(r_ref);
  m.tip_start = product(wide_quaternion(-e_R.cast<Wide>()), m.reference_start);
  const WideMatrix R_ref = power_series(r_ref, WideVector::Zero(), 0).value;
  const WideMatrix E = power_series(e_R.cast<Wide>(), WideVector::Zero(), 0).value;
  m.reference.pose.R = R_ref.cast<double>();
  m.tip.R = (E.transpose() * R_ref).cast<double>();
  m.reference.pose.p = random_vector(random);
  m.tip.p = random_vector(random);
  m.reference.velocity = random_twist(random, 0.4);
  m.reference.acceleration = random_twist(random, 0.4);
  m.tip_velocity = random_twist(random, 0.4);
  m.tip_acceleration = Vector6::Zero();
  return m;
}

std::vector<double> error_angles() {
  std::vector<double> out{0, 1e-12, 1e-9, 1e-6, 1e-3, 3.1415, 3.141592};
  for (int i = 1; i <= 30; ++i) out.push_back(0.1 * i);
  return out;
}

// The difference step for e_R(t) in long double. Its rounding, 3 long double eps of at most 4 rad, times 6.6
// / h^2 is 2.2e-14 = 97 eps of double in the worst case and a tenth of it as a rule.
const Wide step = 0.02L;
const double second_difference_rounding = 97 * eps;

}  // namespace

TEST_CASE("pose error is what exact_tip was given") {
  std::mt19937 random(21);
  for (const double angle : error_angles()) {
    const Motion m = random_motion(random, angle * random_direction(random));
    Vector6 e;
    e << angle * random_direction(random), random_vector(random);
    const auto error = pose_error(m.reference, exact_tip(m.reference, e), Vector6::Zero());
    INFO("angle " << angle);
    // Two products of rotations, each entry wrong by 4 eps; exp by 4 (1 + angle) eps.
    CHECK((error.e.head<3>() - e.head<3>()).norm() <= eps * (8 + 4 * (1 + angle)));
    CHECK((error.e.tail<3>() - e.tail<3>()).norm() <= 2 * eps * (m.reference.pose.p.norm() + e.norm()));
  }
}

TEST_CASE("error and its rate vanish on the reference") {
  std::mt19937 random(22);
  const Motion m = random_motion(random, Eigen::Vector3d::Zero());
  const auto error = pose_error(m.reference, m.reference.pose, m.reference.velocity);
  CHECK(error.e.norm() <= 4 * eps);
  CHECK(error.ed.norm() <= 8 * eps);
  const Vector6 u = pose_command(m.reference, m.reference.pose, m.reference.velocity,
                                 {Vector6::Zero(), Vector6::Zero()}, Vector6::Zero());
  CHECK((u - m.reference.acceleration).norm() <= 16 * eps);
}

TEST_CASE("the rate of the pose error is its time derivative") {
  std::mt19937 random(23);
  for (const double angle : error_angles())
    for (int repeat = 0; repeat < 5; ++repeat) {
      Motion m = random_motion(random, angle * random_direction(random));
      m.tip_acceleration = random_twist(random, 0.4);
      const auto error = pose_error(m.reference, m.tip, m.tip_velocity);
      const auto d = first_difference([&](Wide t) { return orientation_error(m, t); }, Wide(0), step / 2);
      INFO("angle " << angle << ", repeat " << repeat);
      // The rounded R are wrong by 4 eps each, E and E omega by 8 eps; J_l^-1 and its slope are below 3.
      const double speed = m.reference.velocity.norm() + m.tip_velocity.norm();
      const double tolerance = 32 * eps * (1 + speed) + static_cast<double>(d.truncation.norm()) / 64;
      CHECK(tolerance < 1e-12);
      CHECK(static_cast<double>((error.ed.head<3>().cast<Wide>() - d.value).norm()) <= tolerance);
      CHECK(error.ed.tail<3>() == m.reference.velocity.tail<3>() - m.tip_velocity.tail<3>());
    }
}

TEST_CASE("under the commanded acceleration the error has exactly the second derivative asked for") {
  std::mt19937 random(24);
  for (const double angle : error_angles())
    for (int repeat = 0; repeat < 5; ++repeat) {
      Motion m = random_motion(random, angle * random_direction(random));
      const auto error = pose_error(m.reference, m.tip, m.tip_velocity);
      const Vector6 edd = random_twist(random, 1);
      m.tip_acceleration = pose_command(m.reference, m.tip, m.tip_velocity, error, edd);
      const auto d = second_difference([&](Wide t) { return orientation_error(m, t); }, Wide(0), step);
      INFO("angle " << angle << ", repeat " << repeat);
      // As for the rate, with terms of the size of velocity squared and of the accelerations.
      const double speed = m.reference.velocity.norm() + m.tip_velocity.norm();
      const double size = 1 + speed * speed + m.tip_acceleration.norm() + m.reference.acceleration.norm();
      const double tolerance =
          32 * eps * size + second_difference_rounding + static_cast<double>(d.truncation.norm()) / 64;
      CHECK(tolerance < 1e-10);
      CHECK(static_cast<double>((edd.head<3>().cast<Wide>() - d.value).norm()) <= tolerance);
      const Vector6 linear = m.reference.acceleration - m.tip_acceleration;
      CHECK((linear - edd).tail<3>().norm() <= 2 * eps * size);
    }
}

TEST_CASE("pose error does not depend on which way the base axes point") {
  std::mt19937 random(25);
  for (int i = 0; i < 20; ++i) {
    const Motion m = random_motion(random, 2.5 * random_direction(random));
    const Eigen::Matrix3d turn = exp_rotation(random_vector(random));
    const auto turned = [&](const Vector6& x) {
      Vector6 out;
      out << turn * x.head<3>(), turn * x.tail<3>();
      return out;
    };
    const TipReference reference{{turn * m.reference.pose.R, turn * m.reference.pose.p},
                                 turned(m.reference.velocity),
                                 turned(m.reference.acceleration)};
    const Pose tip{turn * m.tip.R, turn * m.tip.p};
    const auto error = pose_error(m.reference, m.tip, m.tip_velocity);
    const auto error_turned = pose_error(reference, tip, turned(m.tip_velocity));
    const Vector6 edd = random_twist(random, 1);
    const Vector6 u = pose_command(m.reference, m.tip, m.tip_velocity, error, edd);
    const Vector6 u_turned = pose_command(reference, tip, turned(m.tip_velocity), error_turned, turned(edd));
    INFO("sample " << i);
    // Each of the turned quantities carries the 8 eps of exp_rotation, relative to its size.
    const double size =
        1 + error.e.norm() + error.ed.squaredNorm() + u.norm() + m.reference.pose.p.norm() + m.tip.p.norm();
    CHECK((error_turned.e - turned(error.e)).norm() <= 32 * eps * size);
    CHECK((error_turned.ed - turned(error.ed)).norm() <= 64 * eps * size);
    CHECK((u_turned - turned(u)).norm() <= 128 * eps * size);
  }
}

}  // namespace osculate::testing::pose_error_tests
