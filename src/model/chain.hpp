// The numbers of a serial arm, and nothing else: what the recursions and the dense reference both start from.
#pragma once

#include <Eigen/Core>
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

enum class JointType { revolute /* and continuous */, prismatic };

/// A moving link and the joint that carries it. "Inboard" is the next link towards the base (or the base
/// itself). The link frame coincides with the joint frame and moves with the link; at q = 0 it has the pose
/// (R_origin, p_origin) in the inboard link frame. At displacement q its pose there is
///   revolute:  (R_origin Rot(axis, q), p_origin),   prismatic:  (R_origin, p_origin + R_origin axis q).
template <Field S>
struct Link {
  JointType type = JointType::revolute;
  Matrix3<S> R_origin = Matrix3<S>::Identity();  // link axes at q = 0, in the inboard link frame
  Vector3<S> p_origin = Vector3<S>::Zero();      // m, in the inboard link frame
  Vector3<S> axis = Vector3<S>::UnitZ();         // unit vector, link frame
  S mass = S(0);                                 // kg
  Vector3<S> com = Vector3<S>::Zero();           // m, centre of mass in the link frame
  Matrix3<S> inertia = Matrix3<S>::Zero();       // kg m^2, about the centre of mass, link axes
  S armature = S(0);  // reflected motor inertia: kg m^2 (revolute) or kg (prismatic)
  bool operator==(const Link&) const = default;
};

/// A serial chain on a fixed base. `links` run base to tip, as URDF users expect; the recursions renumber
/// (arm.hpp).
template <Field S>
struct Chain {
  std::vector<Link<S>> links;
  Matrix3<S> R_tip = Matrix3<S>::Identity();  // tip axes in the last link's frame
  Vector3<S> p_tip = Vector3<S>::Zero();      // m, tip point in the last link's frame
  Vector3<S> gravity = Vector3<S>::Zero();    // m/s^2, acceleration of free fall, base frame
  int n() const { return static_cast<int>(links.size()); }
  bool operator==(const Chain&) const = default;
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
                         l.inertia.template cast<To>(), To(l.armature)});
  return out;
}

}  // namespace osculate
