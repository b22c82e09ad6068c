// The numbers of a serial arm, and nothing else: what the recursions and the dense reference both start from.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "scalar/field.hpp"

namespace osculate {

template <Field S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <Field S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;
template <Field S>
using VectorX = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <Field S>
using MatrixX = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;

/// How a link moves in the frame of its joint, with its position coordinates q and velocity coordinates qd.
/// qd is q's derivative except where a quaternion stands for three angular velocities.
enum class JointType {
  revolute,     // turns about axis: q = angle; also continuous joints
  prismatic,    // slides along axis: q = displacement
  cylindrical,  // both: q = (angle, displacement)
  universal,    // turns about axis, then about axis2, which the first turn carries: q = (angle, angle)
  planar,       // slides along axis2 and axis x axis2, then turns about axis: q = (x, y, angle)
  spherical,    // q = unit quaternion w x y z of the link's axes; qd = angular velocity in link axes
  floating,  // q = (quaternion w x y z, x y z); qd = (angular velocity in link axes, velocity of the link's
             // origin in the joint's axes)
};

/// Number of position coordinates.
constexpr int position_count(JointType type) {
  constexpr int counts[] = {1, 1, 2, 2, 3, 4, 7};
  return counts[static_cast<int>(type)];
}
/// Number of velocity coordinates: the degrees of freedom.
constexpr int velocity_count(JointType type) {
  constexpr int counts[] = {1, 1, 2, 2, 3, 3, 6};
  return counts[static_cast<int>(type)];
}
/// One position and one velocity coordinate: revolute and prismatic joints.
constexpr bool one_axis(JointType type) {
  return type == JointType::revolute || type == JointType::prismatic;
}

/// A moving link and the joint that carries it. "Inboard" is the next link towards the base (or the base
/// itself). The joint frame is fixed in the inboard link, at (R_origin, p_origin); the link frame coincides
/// with it at q = 0 and moves with the link. Its pose in the inboard link is
///   (R_origin R(q), p_origin + R_origin p(q)),
/// with R = Rot(axis, q), p = 0 for a revolute and R = 1, p = axis q for a prismatic joint.
template <Field S>
struct Link {
  JointType type = JointType::revolute;
  Matrix3<S> R_origin = Matrix3<S>::Identity();  // joint axes in the inboard link frame
  Vector3<S> p_origin = Vector3<S>::Zero();      // m, in the inboard link frame
  Vector3<S> axis = Vector3<S>::UnitZ();         // unit vector, joint frame
  S mass = S(0);                                 // kg
  Vector3<S> com = Vector3<S>::Zero();           // m, centre of mass in the link frame
  Matrix3<S> inertia = Matrix3<S>::Zero();       // kg m^2, about the centre of mass, link axes
  S armature = S(0);  // reflected motor inertia: kg m^2 (revolute) or kg (prismatic); 0 for other joints
  Vector3<S> axis2 = Vector3<S>::UnitX();  // unit vector; universal: link frame; planar: joint frame, normal
                                           // to axis; other joints: unused
  bool operator==(const Link&) const = default;
};

/// A serial chain on a base. `links` run base to tip, as URDF users expect; the recursions renumber
/// (arm.hpp).
template <Field S>
struct Chain {
  std::vector<Link<S>> links;
  Matrix3<S> R_tip = Matrix3<S>::Identity();  // tip axes in the last link's frame
  Vector3<S> p_tip = Vector3<S>::Zero();      // m, tip point in the last link's frame
  Vector3<S> gravity = Vector3<S>::Zero();    // m/s^2, acceleration of free fall, base frame
  /// Number of moving links, which is the number of joints.
  int n() const { return static_cast<int>(links.size()); }
  /// Number of position coordinates of all joints.
  int positions() const { return count(position_count); }
  /// Number of velocity coordinates of all joints: the degrees of freedom.
  int velocities() const { return count(velocity_count); }
  /// Every joint is revolute or prismatic.
  bool one_axis_joints() const {
    return std::all_of(links.begin(), links.end(), [](const Link<S>& l) { return one_axis(l.type); });
  }
  bool operator==(const Chain&) const = default;

 private:
  int count(int (*of)(JointType)) const {
    int sum = 0;
    for (const auto& l : links) sum += of(l.type);
    return sum;
  }
};

/// The same numbers in another scalar (double to a wider one, say).
template <Field To, Field From>
Chain<To> cast(const Chain<From>& chain) {
  Chain<To> out;
  out.R_tip = chain.R_tip.template cast<To>();
  out.p_tip = chain.p_tip.template cast<To>();
  out.gravity = chain.gravity.template cast<To>();
  for (const auto& l : chain.links)
    out.links.push_back({l.type, l.R_origin.template cast<To>(), l.p_origin.template cast<To>(),
                         l.axis.template cast<To>(), To(l.mass), l.com.template cast<To>(),
                         l.inertia.template cast<To>(), To(l.armature), l.axis2.template cast<To>()});
  return out;
}

}  // namespace osculate
