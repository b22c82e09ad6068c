// Joint positions as field numbers. Trigonometry stops here: everything further in takes cosines, sines and
// rotation matrices, so that exact rational poses exist.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <span>
#include <vector>

#include "model/chain.hpp"
#include "scalar/sine_cosine.hpp"

namespace osculate {

/// Where one joint stands. Revolute: c, s are cosine and sine of the angle. Prismatic: d in m. All other
/// joints: R and p, the pose of the link in the joint frame.
template <Field S>
struct JointPosition {
  S c = S(1), s = S(0), d = S(0);
  Matrix3<S> R = Matrix3<S>::Identity();
  Vector3<S> p = Vector3<S>::Zero();  // m
};

/// How the base frame moves, in the inertial frame; at rest in it by default. Gravity is given in that frame.
template <Field S>
struct BaseMotion {
  using Vector6 = Eigen::Matrix<S, 6, 1>;
  Matrix3<S> R = Matrix3<S>::Identity();   // base axes
  Vector3<S> p = Vector3<S>::Zero();       // m, base origin
  Vector6 velocity = Vector6::Zero();      // (angular; linear) of the base at its origin, rad/s, m/s
  Vector6 acceleration = Vector6::Zero();  // its ordinary derivative, rad/s^2, m/s^2
};

/// Rotation about the unit vector `axis` with the given cosine and sine (Rodrigues' formula). Field
/// operations only.
template <Field S>
Matrix3<S> rotation(const Vector3<S>& axis, const S& c, const S& s) {
  const S& x = axis[0];
  const S& y = axis[1];
  const S& z = axis[2];
  const S v = S(1) - c;
  Matrix3<S> R;
  R << c + v * x * x, v * x * y - s * z, v * x * z + s * y,  //
      v * x * y + s * z, c + v * y * y, v * y * z - s * x,   //
      v * x * z - s * y, v * y * z + s * x, c + v * z * z;
  return R;
}

/// Rotation of the quaternion w x y z of any length but 0: the length does not matter. Field operations only.
template <Field S>
Matrix3<S> rotation_of_quaternion(const S& w, const S& x, const S& y, const S& z) {
  const S two = S(2) / (w * w + x * x + y * y + z * z);
  Matrix3<S> R;
  R << S(1) - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y),  //
      two * (x * y + w * z), S(1) - two * (x * x + z * z), two * (y * z - w * x),   //
      two * (x * z - w * y), two * (y * z + w * x), S(1) - two * (x * x + y * y);
  return R;
}

/// Position of one joint from its coordinates.
template <Field S>
JointPosition<S> joint_position(const Link<S>& link, const S* q) {
  using std::cos;
  using std::sin;
  JointPosition<S> out;
  switch (link.type) {
    case JointType::revolute:
      out.c = cos(q[0]), out.s = sin(q[0]);
      break;
    case JointType::prismatic:
      out.d = q[0];
      break;
    case JointType::cylindrical:
      out.R = rotation(link.axis, S(cos(q[0])), S(sin(q[0])));
      out.p = link.axis * q[1];
      break;
    case JointType::universal:
      out.R =
          rotation(link.axis, S(cos(q[0])), S(sin(q[0]))) * rotation(link.axis2, S(cos(q[1])), S(sin(q[1])));
      break;
    case JointType::planar:
      out.R = rotation(link.axis, S(cos(q[2])), S(sin(q[2])));
      out.p = link.axis2 * q[0] + link.axis.cross(link.axis2) * q[1];
      break;
    case JointType::spherical:
      out.R = rotation_of_quaternion(q[0], q[1], q[2], q[3]);
      break;
    case JointType::floating:
      out.R = rotation_of_quaternion(q[0], q[1], q[2], q[3]);
      out.p = {q[4], q[5], q[6]};
      break;
  }
  return out;
}

/// The same for doubles where every joint has one coordinate: sines and cosines of several joints at once.
inline void set_one_axis_positions(const Chain<double>& chain, std::span<const double> q,
                                   std::vector<JointPosition<double>>& out) {
  constexpr std::size_t block = 64;
  double sine[block], cosine[block];
  for (std::size_t first = 0; first < q.size(); first += block) {
    const std::size_t count = std::min(block, q.size() - first);
    sine_cosine(&q[first], sine, cosine, count);
    for (std::size_t i = 0; i < count; ++i) {
      JointPosition<double>& joint = out[first + i];
      if (chain.links[first + i].type == JointType::revolute)
        joint.c = cosine[i], joint.s = sine[i];
      else
        joint.d = q[first + i];
    }
  }
}

/// Joint positions (base to tip) of a chain from coordinates q (base to tip, q.size() == chain.positions()).
template <Field S>
void set_positions(const Chain<S>& chain, std::span<const S> q, std::vector<JointPosition<S>>& out) {
  out.resize(chain.links.size());
  if constexpr (std::same_as<S, double>)
    if (q.size() == out.size()) return set_one_axis_positions(chain, q, out);
  const S* at = q.data();
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = joint_position(chain.links[i], at);
    at += position_count(chain.links[i].type);
  }
}

/// The same as a new list.
template <Field S>
std::vector<JointPosition<S>> positions(const Chain<S>& chain, std::span<const S> q) {
  std::vector<JointPosition<S>> out;
  set_positions(chain, q, out);
  return out;
}

/// Rate at which a quaternion's length returns to 1, 1/s: |q|^2 - 1 decays as exp(-2 x 10 t).
inline constexpr double quaternion_restoring_rate = 10;

/// dq/dt from q and qd (all base to tip): qd itself, but for a quaternion e
///   de/dt = 1/2 e (0, omega) + k (1 - |e|^2) e.
/// The second term moves e along itself only, which no rotation feels, and keeps its length at 1 however long
/// the integration: errors in length decay instead of adding up.
template <Field S>
void position_rates(const Chain<S>& chain, std::span<const S> q, std::span<const S> qd, std::span<S> out) {
  const S* e = q.data();
  const S* w = qd.data();
  S* to = out.data();
  for (const Link<S>& link : chain.links) {
    const bool turns_freely = link.type == JointType::spherical || link.type == JointType::floating;
    int taken = 0, given = 0;  // coordinates done so far
    if (turns_freely) {
      const S half = S(1) / S(2);
      const S k =
          S(quaternion_restoring_rate) * (S(1) - e[0] * e[0] - e[1] * e[1] - e[2] * e[2] - e[3] * e[3]);
      to[0] = k * e[0] - half * (e[1] * w[0] + e[2] * w[1] + e[3] * w[2]);
      to[1] = k * e[1] + half * (e[0] * w[0] + e[2] * w[2] - e[3] * w[1]);
      to[2] = k * e[2] + half * (e[0] * w[1] + e[3] * w[0] - e[1] * w[2]);
      to[3] = k * e[3] + half * (e[0] * w[2] + e[1] * w[1] - e[2] * w[0]);
      taken = 3, given = 4;
    }
    for (; taken < velocity_count(link.type); ++taken, ++given) to[given] = w[taken];
    e += position_count(link.type);
    w += velocity_count(link.type);
    to += position_count(link.type);
  }
}

}  // namespace osculate
