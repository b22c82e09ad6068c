// Random arms and states for tests of laws. The same seed gives the same arm with every compiler and library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <vector>

#include "model/chain.hpp"
#include "model/pose.hpp"
#include "scalar/rational.hpp"

namespace osculate::testing {

/// splitmix64 (Steele, Lea & Flood 2014); scaling is our own, because the standard distributions differ by
/// library.
struct Random {
  std::uint64_t state;
  explicit Random(std::uint64_t seed) : state(seed) {}

  std::uint64_t next() {
    state += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }
  /// low ... high, both included. The bias of the remainder is below 2^-50 for the small ranges used here.
  int integer(int low, int high) {
    return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
  }
  double sign() { return integer(0, 1) == 0 ? -1.0 : 1.0; }

  /// Uniform on the unit sphere.
  Vector3<double> direction() {
    const double z = uniform(-1, 1);
    const double angle = uniform(-std::numbers::pi, std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  Matrix3<double> rotation_matrix() {
    const double angle = uniform(-std::numbers::pi, std::numbers::pi);
    return rotation<double>(direction(), std::cos(angle), std::sin(angle));
  }

  /// A fraction of small integers, |numerator| <= range.
  Rational fraction(int range, int denominator) { return Rational(integer(-range, range), denominator); }
  Vector3<Rational> fraction3(int range, int denominator) {
    return {fraction(range, denominator), fraction(range, denominator), fraction(range, denominator)};
  }
  /// Exact rotation from a quaternion of small integers; its columns are rational unit vectors.
  Matrix3<Rational> exact_rotation() {
    int w = 0, x = 0, y = 0, z = 0;
    while (w * w + x * x + y * y + z * z == 0)
      w = integer(-2, 2), x = integer(-2, 2), y = integer(-2, 2), z = integer(-2, 2);
    const int norm = w * w + x * x + y * y + z * z;
    Eigen::Matrix3i R;
    R << w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z;
    return R.cast<Rational>() / Rational(norm);
  }
};

/// nearly_singular: the last two joints turn (or slide) about nearly the same axis, 1e-4 apart in rad and m,
/// so that for n = 6 cond(Omega) is about 1e8. zero_velocity: as generic, qd = 0.
enum class Regime { generic, nearly_singular, zero_velocity };

inline const char* name(Regime regime) {
  switch (regime) {
    case Regime::generic:
      return "generic";
    case Regime::nearly_singular:
      return "nearly singular";
    case Regime::zero_velocity:
      return "zero velocity";
  }
  return "?";
}

/// An arm in a state. `positions` belong to q.
struct RandomArm {
  Chain<double> chain;
  VectorX<double> q;   // rad or m, base to tip
  VectorX<double> qd;  // rad/s or m/s
  std::vector<JointPosition<double>> positions;
};

/// An arm in a state with exact numbers: cosines and sines are Pythagorean, so there is no q.
struct ExactArm {
  Chain<Rational> chain;
  VectorX<Rational> qd;
  std::vector<JointPosition<Rational>> positions;
};

/// n links: about three revolute joints to one prismatic (the first is always revolute), arbitrary axes,
/// offsets 0.1 to 0.5 m, masses 0.5 to 10 kg, inertias of solid bodies (the triangle inequality holds
/// strictly), armature on every third joint or so, a tip offset and gravity in an arbitrary direction.
inline RandomArm random_arm(std::uint64_t seed, int n, Regime regime = Regime::generic) {
  Random random(seed * 1000003u + static_cast<std::uint64_t>(n));
  RandomArm arm;
  arm.q.resize(n);
  arm.qd.resize(n);
  for (int i = 0; i < n; ++i) {
    Link<double> link;
    link.type = i > 0 && random.integer(0, 3) == 0 ? JointType::prismatic : JointType::revolute;
    link.R_origin = random.rotation_matrix();
    link.p_origin = random.uniform(0.1, 0.5) * random.direction();
    link.axis = random.direction();
    link.mass = random.uniform(0.5, 10);
    link.com = random.uniform(0, 0.3) * random.direction();
    // Principal moments b + c, a + c, a + b of a body with second moments a, b, c > 0: m r^2 with r 3 to 20
    // cm.
    Vector3<double> second;
    for (double& x : second) {
      const double r = random.uniform(0.03, 0.2);
      x = link.mass * r * r;
    }
    const Matrix3<double> R = random.rotation_matrix();
    const Vector3<double> principal = Vector3<double>::Constant(second.sum()) - second;
    const Matrix3<double> I = R * principal.asDiagonal() * R.transpose();
    link.inertia = (I + I.transpose()) / 2;
    if (random.integer(0, 2) == 0) link.armature = random.uniform(0.05, 1);
    arm.chain.links.push_back(link);
    const bool turns = link.type == JointType::revolute;
    arm.q[i] = turns ? random.uniform(-std::numbers::pi, std::numbers::pi) : random.uniform(-0.3, 0.3);
    arm.qd[i] = random.uniform(-2, 2);
  }
  arm.chain.R_tip = random.rotation_matrix();
  arm.chain.p_tip = random.uniform(0.1, 0.4) * random.direction();
  arm.chain.gravity = 9.80665 * random.direction();
  if (regime == Regime::zero_velocity) arm.qd.setZero();
  if (regime == Regime::nearly_singular && n >= 2) {
    Link<double>& last = arm.chain.links[static_cast<std::size_t>(n - 1)];
    const Link<double>& inboard = arm.chain.links[static_cast<std::size_t>(n - 2)];
    last.type = inboard.type;
    last.axis = inboard.axis;
    last.R_origin = rotation<double>(random.direction(), std::cos(1e-4), std::sin(1e-4));
    last.p_origin = 1e-4 * random.direction();
    if (last.type == JointType::prismatic) arm.q[n - 1] = random.uniform(-0.3, 0.3);
  }
  arm.positions = positions<double>(arm.chain, {arm.q.data(), static_cast<std::size_t>(n)});
  return arm;
}

/// The same kind of arm in small fractions: rotations from integer quaternions, cosine and sine from
/// ((1 - t^2)/(1 + t^2), 2t/(1 + t^2)), inertias as sums over point masses. Everything holds exactly in it.
inline ExactArm exact_arm(std::uint64_t seed, int n) {
  Random random(seed * 7368787u + static_cast<std::uint64_t>(n));
  ExactArm arm;
  arm.qd.resize(n);
  for (int i = 0; i < n; ++i) {
    Link<Rational> link;
    link.type = i > 0 && random.integer(0, 3) == 0 ? JointType::prismatic : JointType::revolute;
    link.R_origin = random.exact_rotation();
    link.p_origin = random.fraction3(4, 8);
    link.axis = random.exact_rotation().col(2);
    link.mass = Rational(random.integer(1, 10));
    link.com = random.fraction3(2, 8);
    for (int j = 0; j < 4; ++j) {
      const Vector3<Rational> r = random.fraction3(2, 8);
      link.inertia += r.dot(r) * Matrix3<Rational>::Identity() - r * r.transpose();
    }
    link.inertia += Rational(1, 64) * Matrix3<Rational>::Identity();
    if (random.integer(0, 2) == 0) link.armature = Rational(random.integer(1, 4), 4);
    arm.chain.links.push_back(link);
    if (link.type == JointType::revolute) {
      const int a = random.integer(-3, 3), b = random.integer(1, 3);
      arm.positions.push_back(
          {Rational(b * b - a * a, b * b + a * a), Rational(2 * a * b, b * b + a * a), Rational(0)});
    } else {
      arm.positions.push_back({Rational(1), Rational(0), random.fraction(2, 8)});
    }
    arm.qd[i] = Rational((2 * random.integer(0, 1) - 1) * random.integer(1, 4), 2);
  }
  arm.chain.R_tip = random.exact_rotation();
  arm.chain.p_tip = random.fraction3(3, 8);
  arm.chain.gravity = random.fraction3(10, 1);
  return arm;
}

/// Printed with a failing check: what seed alone does not tell at a glance.
inline std::ostream& operator<<(std::ostream& out, const RandomArm& arm) {
  for (const Link<double>& link : arm.chain.links) out << (link.type == JointType::revolute ? 'R' : 'P');
  return out << " q = " << arm.q.transpose() << " qd = " << arm.qd.transpose();
}

}  // namespace osculate::testing
