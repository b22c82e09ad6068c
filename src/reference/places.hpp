// Where the links of an arm are and how points on them move, by homogeneous transforms and Jacobians: the
// kinematics of the oracle, see dense.hpp. Everything is resolved in the inertial frame, which is the base
// frame while the base rests; six-vectors angular rows first; joints base to tip; SI units and radians. Field
// operations only.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "model/chain.hpp"
#include "model/pose.hpp"
#include "scalar/dual.hpp"

namespace osculate::dense {

template <Field S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
template <Field S>
using Jacobian = Eigen::Matrix<S, 6, Eigen::Dynamic>;
template <Field S>
using Positions = std::vector<JointPosition<S>>;

/// A homogeneous transform [R p; 0 1]: x_outer = R x_inner + p.
template <Field S>
struct Transform {
  Matrix3<S> R = Matrix3<S>::Identity();
  Vector3<S> p = Vector3<S>::Zero();  // m

  friend Transform operator*(const Transform& a, const Transform& b) { return {a.R * b.R, a.p + a.R * b.p}; }
};

/// Where one link is, inertial frame.
template <Field S>
struct LinkPlace {
  JointType type = JointType::revolute;
  Matrix3<S> R;        // link axes
  Vector3<S> axis;     // unit vector of its joint
  Vector3<S> origin;   // m, link frame's origin, on the joint axis
  Vector3<S> com;      // m, centre of mass
  Vector3<S> axis2;    // universal: second axis; planar: direction of the first slide
  Matrix3<S> R_joint;  // joint axes. Like axis2 not set for revolute, prismatic and cylindrical joints
};

/// Where everything is, inertial frame. `links` base to tip.
template <Field S>
struct Places {
  std::vector<LinkPlace<S>> links;
  Transform<S> tip;
  Transform<S> base;
  Vector6<S> base_velocity = Vector6<S>::Zero();  // about the base origin; rad/s, m/s
};

/// Motion of one point that is fixed in a link: Vd = J qdd + Jdot_qd. About the point.
template <Field S>
struct PointMotion {
  Jacobian<S> J;                            // 6 x (velocities of the joints inboard of the point)  (7)
  Vector6<S> V = Vector6<S>::Zero();        // rad/s, m/s; J qd, and what the base adds
  Vector6<S> Jdot_qd = Vector6<S>::Zero();  // rad/s^2, m/s^2; ordinary acceleration at qdd = 0    (8)
};

/// a~ with a~ x = a x x.
template <Field S>
Matrix3<S> cross_matrix(const Vector3<S>& a) {
  const S o(0);
  Matrix3<S> A;
  A << o, -a[2], a[1],  //
      a[2], o, -a[0],   //
      -a[1], a[0], o;
  return A;
}

/// Pose of a link in its inboard link's frame. The position may be a dual number over the link's scalar.
template <Field N, Field S>
Transform<N> joint_transform(const Link<S>& link, const JointPosition<N>& q) {
  const Transform<N> origin{link.R_origin.template cast<N>(), link.p_origin.template cast<N>()};
  if (!one_axis(link.type)) return origin * Transform<N>{q.R, q.p};
  const Matrix3<S> K = cross_matrix(link.axis);
  const Matrix3<S> KK = K * K;
  const Matrix3<N> turn =
      Matrix3<N>::Identity() + q.s * K.template cast<N>() + (N(1) - q.c) * KK.template cast<N>();
  const Vector3<N> slide = q.d * link.axis.template cast<N>();
  return origin * Transform<N>{turn, slide};
}

/// Every joint, centre of mass and the tip, from base to tip. positions.size() == chain.n(); `base` is the
/// base frame's pose, and its velocity about its origin, in the inertial frame.
template <Field N, Field S>
Places<N> places(const Chain<S>& chain, const Positions<N>& positions, const Transform<N>& base = {},
                 const Vector6<N>& base_velocity = Vector6<N>::Zero()) {
  Places<N> out;
  out.links.reserve(chain.links.size());
  out.base = base;
  out.base_velocity = base_velocity;
  Transform<N> T = base;
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Link<S>& link = chain.links[i];
    const Matrix3<N> R_inboard = T.R;
    T = T * joint_transform(link, positions[i]);
    LinkPlace<N>& place = out.links.emplace_back();
    place.type = link.type;
    place.R = T.R;
    place.origin = T.p;
    place.com = T.p + T.R * link.com.template cast<N>();
    if (one_axis(link.type) || link.type == JointType::cylindrical) {
      place.axis = T.R * link.axis.template cast<N>();  // the same in link and joint axes
      continue;
    }
    place.R_joint = R_inboard * link.R_origin.template cast<N>();
    place.axis = place.R_joint * link.axis.template cast<N>();
    const Matrix3<N>& carrier = link.type == JointType::universal ? place.R : place.R_joint;
    place.axis2 = carrier * link.axis2.template cast<N>();
  }
  out.tip = T * Transform<N>{chain.R_tip.template cast<N>(), chain.p_tip.template cast<N>()};
  return out;
}

/// Value and derivative put together, entry by entry.
template <Field S, int Rows, int Columns>
Eigen::Matrix<Dual<S>, Rows, Columns> with_rate(const Eigen::Matrix<S, Rows, Columns>& value,
                                                const Eigen::Matrix<S, Rows, Columns>& rate) {
  return value.binaryExpr(rate, [](const S& v, const S& d) { return Dual<S>(v, d); });
}

/// Position of one joint with its rate as derivative: c' = -s qd, s' = c qd, d' = qd; R' = w~ R and p' = v
/// with w and v from qd, the joint's velocity_count numbers (see JointType).
template <Field S>
JointPosition<Dual<S>> moving(const Link<S>& link, const JointPosition<S>& q, const S* qd) {
  JointPosition<Dual<S>> out;
  if (link.type == JointType::revolute) {
    out.c = {q.c, -q.s * qd[0]};
    out.s = {q.s, q.c * qd[0]};
    return out;
  }
  if (link.type == JointType::prismatic) {
    out.d = {q.d, qd[0]};
    return out;
  }
  Vector3<S> w = Vector3<S>::Zero(), v = Vector3<S>::Zero();  // of the link in joint axes
  if (link.type == JointType::cylindrical) {
    w = link.axis * qd[0];
    v = link.axis * qd[1];
  } else if (link.type == JointType::universal) {
    w = link.axis * qd[0] + q.R * link.axis2 * qd[1];
  } else if (link.type == JointType::planar) {
    w = link.axis * qd[2];
    v = link.axis2 * qd[0] + link.axis.cross(link.axis2) * qd[1];
  } else {  // spherical, floating
    w = q.R * Vector3<S>(qd[0], qd[1], qd[2]);
    if (link.type == JointType::floating) v = {qd[3], qd[4], qd[5]};
  }
  out.R = with_rate<S, 3, 3>(q.R, cross_matrix(w) * q.R);
  out.p = with_rate<S, 3, 1>(q.p, v);
  return out;
}

/// Positions of all joints with their rates. positions.size() == chain.n(), qd.size() == chain.velocities().
template <Field S>
Positions<Dual<S>> moving(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd) {
  Positions<Dual<S>> out;
  out.reserve(positions.size());
  const S* rate = qd.data();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    out.push_back(moving(chain.links[i], positions[i], rate));
    rate += velocity_count(chain.links[i].type);
  }
  return out;
}

/// The places of joints moving at qd on a base moving as told, as dual numbers: the base's velocity has its
/// acceleration as derivative. Sizes as for `moving`.
template <Field S>
Places<Dual<S>> moving_places(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
                              const BaseMotion<S>& base = {}) {
  const Vector3<S> w = base.velocity.template head<3>(), v = base.velocity.template tail<3>();
  const Transform<Dual<S>> frame{with_rate<S, 3, 3>(base.R, cross_matrix(w) * base.R),
                                 with_rate<S, 3, 1>(base.p, v)};
  return places(chain, moving(chain, positions, qd), frame,
                Vector6<Dual<S>>(with_rate<S, 6, 1>(base.velocity, base.acceleration)));
}

/// How a link moves against its inboard link while the j-th velocity coordinate of its joint is 1: angular
/// and linear, at the link's origin.
template <Field S>
Vector6<S> unit_motion(const LinkPlace<S>& link, int j) {
  Vector6<S> out = Vector6<S>::Zero();
  auto angular = out.template head<3>();
  auto linear = out.template tail<3>();
  switch (link.type) {
    case JointType::revolute:
      angular = link.axis;
      break;
    case JointType::prismatic:
      linear = link.axis;
      break;
    case JointType::cylindrical:
      (j == 0 ? angular : linear) = link.axis;
      break;
    case JointType::universal:
      angular = j == 0 ? link.axis : link.axis2;
      break;
    case JointType::planar:
      if (j == 0) linear = link.axis2;
      if (j == 1) linear = link.axis.cross(link.axis2);
      if (j == 2) angular = link.axis;
      break;
    case JointType::spherical:
    case JointType::floating:
      if (j < 3) angular = link.R.col(j);
      if (j >= 3) linear = link.R_joint.col(j - 3);
      break;
  }
  return out;
}

/// Motion of `point` (moving with it) that sits on the `joints`-th moving link, counted from the base. The
/// places are those of `moving_places`, so the derivative of V at constant qd is Jdot qd.
template <Field S>
PointMotion<S> point_motion(const Places<Dual<S>>& at, const VectorX<S>& qd, const Vector3<Dual<S>>& point,
                            int joints) {
  using N = Dual<S>;
  int columns = 0;
  for (int i = 0; i < joints; ++i) columns += velocity_count(at.links[static_cast<std::size_t>(i)].type);
  PointMotion<S> out;
  out.J.resize(6, columns);
  Vector6<N> V = at.base_velocity;
  V.template tail<3>() += V.template head<3>().cross(point - at.base.p);
  int at_column = 0;
  for (int i = 0; i < joints; ++i) {
    const LinkPlace<N>& link = at.links[static_cast<std::size_t>(i)];
    for (int j = 0; j < velocity_count(link.type); ++j, ++at_column) {
      Vector6<N> column = unit_motion(link, j);
      if (link.type != JointType::prismatic)
        column.template tail<3>() += column.template head<3>().cross(point - link.origin);
      out.J.col(at_column) = values(column);
      V += column * N(qd[at_column]);
    }
  }
  out.V = values(V);
  out.Jdot_qd = derivatives(V);
  return out;
}

}  // namespace osculate::dense
