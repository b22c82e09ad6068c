// Random arms and states, to test laws on. The same seed gives the same arm with every compiler and library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "model/chain.hpp"
#include "model/pose.hpp"
#include "scalar/rational.hpp"

namespace osculate {

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
  /// Exact rotation from a quaternion of integers up to `range`; its columns are rational unit vectors.
  Matrix3<Rational> exact_rotation(int range = 2) {
    int w = 0, x = 0, y = 0, z = 0;
    while (w * w + x * x + y * y + z * z == 0)
      w = integer(-range, range), x = integer(-range, range), y = integer(-range, range),
      z = integer(-range, range);
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

inline const char* regime_name(Regime regime) {
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
  VectorX<double> q;   // chain.positions(), base to tip; rad, m or quaternions
  VectorX<double> qd;  // chain.velocities(), base to tip; rad/s or m/s
  std::vector<JointPosition<double>> positions;
};

/// An arm in a state with exact numbers: cosines and sines are Pythagorean, so there is no q.
struct ExactArm {
  Chain<Rational> chain;
  VectorX<Rational> qd;
  std::vector<JointPosition<Rational>> positions;
};

/// A link 0.1 to 0.5 m out from the last, 0.5 to 10 kg, its inertia that of a solid body (the triangle
/// inequality holds strictly); armature on every third or so of the joints that can have it.
inline Link<double> random_link(Random& random, JointType type) {
  Link<double> link;
  link.type = type;
  link.R_origin = random.rotation_matrix();
  link.p_origin = random.uniform(0.1, 0.5) * random.direction();
  link.axis = random.direction();
  link.mass = random.uniform(0.5, 10);
  link.com = random.uniform(0, 0.3) * random.direction();
  // Principal moments b + c, a + c, a + b of a body with second moments a, b, c > 0: m r^2 with r 3 to 20 cm.
  Vector3<double> second;
  for (double& x : second) {
    const double r = random.uniform(0.03, 0.2);
    x = link.mass * r * r;
  }
  const Matrix3<double> R = random.rotation_matrix();
  const Vector3<double> principal = Vector3<double>::Constant(second.sum()) - second;
  const Matrix3<double> I = R * principal.asDiagonal() * R.transpose();
  link.inertia = (I + I.transpose()) / 2;
  const bool motor = random.integer(0, 2) == 0;
  if (motor && one_axis(type)) link.armature = random.uniform(0.05, 1);
  if (type == JointType::universal || type == JointType::planar)
    link.axis2 = link.axis.cross(random.direction()).normalized();
  return link;
}

/// Tip offset and gravity in arbitrary directions.
inline void random_ends(Random& random, Chain<double>& chain) {
  chain.R_tip = random.rotation_matrix();
  chain.p_tip = random.uniform(0.1, 0.4) * random.direction();
  chain.gravity = 9.80665 * random.direction();
}

/// n links: about three revolute joints to one prismatic (the first is always revolute), arbitrary axes;
/// links as above.
inline RandomArm random_arm(std::uint64_t seed, int n, Regime regime = Regime::generic) {
  Random random(seed * 1000003u + static_cast<std::uint64_t>(n));
  RandomArm arm;
  arm.q.resize(n);
  arm.qd.resize(n);
  for (int i = 0; i < n; ++i) {
    const bool slides = i > 0 && random.integer(0, 3) == 0;
    arm.chain.links.push_back(random_link(random, slides ? JointType::prismatic : JointType::revolute));
    arm.q[i] = slides ? random.uniform(-0.3, 0.3) : random.uniform(-std::numbers::pi, std::numbers::pi);
    arm.qd[i] = random.uniform(-2, 2);
  }
  random_ends(random, arm.chain);
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

/// The same with joints of the given types, base to tip.
inline RandomArm random_arm_of(std::uint64_t seed, const std::vector<JointType>& types) {
  Random random(seed * 2750159u + types.size());
  RandomArm arm;
  for (const JointType type : types) arm.chain.links.push_back(random_link(random, type));
  random_ends(random, arm.chain);
  arm.q.resize(arm.chain.positions());
  arm.qd.resize(arm.chain.velocities());
  double* q = arm.q.data();
  for (const JointType type : types) {
    int done = 0;
    if (type == JointType::spherical || type == JointType::floating) {
      Eigen::Map<Eigen::Vector4d> quaternion(q);
      do {
        for (double& x : quaternion) x = random.uniform(-1, 1);
      } while (quaternion.norm() < 0.1);
      quaternion.normalize();
      done = 4;
    }
    for (; done < position_count(type); ++done) {
      const bool slides = type == JointType::prismatic || type == JointType::floating ||
                          (type == JointType::cylindrical && done == 1) ||
                          (type == JointType::planar && done < 2);
      q[done] = slides ? random.uniform(-0.3, 0.3) : random.uniform(-std::numbers::pi, std::numbers::pi);
    }
    q += position_count(type);
  }
  for (double& rate : arm.qd) rate = random.uniform(-2, 2);
  arm.positions = positions<double>(arm.chain, {arm.q.data(), static_cast<std::size_t>(arm.q.size())});
  return arm;
}

/// A link in small fractions: rotations from integer quaternions, inertia a sum over point masses, axes two
/// columns of one rotation.
inline Link<Rational> exact_link(Random& random, JointType type, int range) {
  Link<Rational> link;
  link.type = type;
  link.R_origin = random.exact_rotation(range);
  link.p_origin = random.fraction3(4, 8);
  const Matrix3<Rational> axes = random.exact_rotation(range);
  link.axis = axes.col(2);
  if (type == JointType::universal || type == JointType::planar) link.axis2 = axes.col(0);
  link.mass = Rational(random.integer(1, 10));
  link.com = random.fraction3(2, 8);
  for (int j = 0; j < 4; ++j) {
    const Vector3<Rational> r = random.fraction3(2, 8);
    link.inertia += r.dot(r) * Matrix3<Rational>::Identity() - r * r.transpose();
  }
  link.inertia += Rational(1, 64) * Matrix3<Rational>::Identity();
  const bool motor = random.integer(0, 2) == 0;
  if (motor && one_axis(type)) link.armature = Rational(random.integer(1, 4), 4);
  return link;
}

/// Where one joint stands, in small fractions; cosine and sine are ((1 - t^2)/(1 + t^2), 2t/(1 + t^2)).
inline JointPosition<Rational> exact_position(Random& random, const Link<Rational>& link, int range) {
  const auto turn = [&](Rational& c, Rational& s) {
    const int a = random.integer(-range - 1, range + 1), b = random.integer(1, range + 1);
    c = Rational(b * b - a * a, b * b + a * a);
    s = Rational(2 * a * b, b * b + a * a);
  };
  const auto turned = [&](const Vector3<Rational>& axis) {
    Rational c, s;
    turn(c, s);
    return rotation<Rational>(axis, c, s);
  };
  JointPosition<Rational> out;
  switch (link.type) {
    case JointType::revolute:
      turn(out.c, out.s);
      break;
    case JointType::prismatic:
      out.d = random.fraction(2, 8);
      break;
    case JointType::cylindrical:
      out.R = turned(link.axis);
      out.p = random.fraction(2, 8) * link.axis;
      break;
    case JointType::universal:
      out.R = turned(link.axis);
      out.R = out.R * turned(link.axis2);
      break;
    case JointType::planar:
      out.R = turned(link.axis);
      out.p = random.fraction(2, 8) * link.axis2;
      out.p += random.fraction(2, 8) * link.axis.cross(link.axis2);
      break;
    case JointType::spherical:
      out.R = random.exact_rotation(range);
      break;
    case JointType::floating:
      out.R = random.exact_rotation(range);
      out.p = random.fraction3(2, 8);
      break;
  }
  return out;
}

/// One link and its joint's state more.
inline void append_exact(Random& random, JointType type, int range, ExactArm& arm) {
  arm.chain.links.push_back(exact_link(random, type, range));
  arm.positions.push_back(exact_position(random, arm.chain.links.back(), range));
  const int first = static_cast<int>(arm.qd.size());
  arm.qd.conservativeResize(first + velocity_count(type));
  for (int i = first; i < arm.qd.size(); ++i)
    arm.qd[i] = Rational((2 * random.integer(0, 1) - 1) * random.integer(1, 4), 2);
}

inline void exact_ends(Random& random, Chain<Rational>& chain) {
  chain.R_tip = random.exact_rotation();
  chain.p_tip = random.fraction3(3, 8);
  chain.gravity = random.fraction3(10, 1);
}

/// The same kind of arm as `random_arm` in small fractions. Everything holds exactly in it. Rotations come
/// from quaternions of integers up to `range`: 1 keeps the fractions of long chains short.
inline ExactArm exact_arm(std::uint64_t seed, int n, int range = 2) {
  Random random(seed * 7368787u + static_cast<std::uint64_t>(n));
  ExactArm arm;
  for (int i = 0; i < n; ++i) {
    const bool slides = i > 0 && random.integer(0, 3) == 0;
    append_exact(random, slides ? JointType::prismatic : JointType::revolute, range, arm);
  }
  exact_ends(random, arm.chain);
  return arm;
}

/// The same with joints of the given types, base to tip.
inline ExactArm exact_arm_of(std::uint64_t seed, const std::vector<JointType>& types, int range = 2) {
  Random random(seed * 5800079u + types.size());
  ExactArm arm;
  for (const JointType type : types) append_exact(random, type, range, arm);
  exact_ends(random, arm.chain);
  return arm;
}

/// One letter per joint, base to tip: R P C U and L (planar), S (spherical), F (floating).
template <Field S>
std::string letters(const Chain<S>& chain) {
  std::string out;
  for (const Link<S>& link : chain.links) out += "RPCULSF"[static_cast<int>(link.type)];
  return out;
}

/// Printed with a failing check: what seed alone does not tell at a glance.
inline std::ostream& operator<<(std::ostream& out, const RandomArm& arm) {
  return out << letters(arm.chain) << " q = " << arm.q.transpose() << " qd = " << arm.qd.transpose();
}

}  // namespace osculate
