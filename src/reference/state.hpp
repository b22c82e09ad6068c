// What a state of an arm defines before a task is chosen: pose, Jacobian and velocity terms of the tip, and
// M, C, G of the joint-space equation, in two passes along the arm; cost O(n^2). The definitions are those of
// dense.hpp (Jacobians, Newton-Euler at the centres of mass, derivatives by the product rule). Only their
// sums are taken in another order: one joint moves all links outboard of it as one rigid body, so the
// inertias, weights and forces of these links are added first. Nothing articulated appears. Over exact
// numbers the results are those of kinematics() and joint_space().
#pragma once

#include "reference/places.hpp"
#include "scalar/inlined.hpp"

namespace osculate::dense {

/// Pose and motion of the tip, about the tip's origin. m = chain.velocities().
template <Field S>
struct Kinematics {
  Matrix3<S> R;             // tip axes
  Vector3<S> p;             // m, tip origin
  Jacobian<S> J;            // 6 x m                                                            (7)
  Vector6<S> tip_velocity;  // J qd, and what a moving base adds: rad/s, m/s                    (7)
  Vector6<S> Jdot_qd;       // rad/s^2, m/s^2; acceleration at qdd = 0, a moving base included  (8)
};

/// M(q) qdd + C(q, qd) + G(q) = T + J^T F_ext                                                   (6)
/// m = chain.velocities() rows; row i in N m (turning) or N (sliding) per unit of the column's coordinate.
template <Field S>
struct JointSpace {
  MatrixX<S> M;  // m x m, armature on the diagonal
  VectorX<S> C;  // m, centrifugal and Coriolis, and what a moving base asks for; no friction
  VectorX<S> G;  // m, weight: dU/dq, or what stands for it where qd is no derivative of q
};

/// All that a state defines before a task is chosen.
template <Field S>
struct State {
  Kinematics<S> tip;
  JointSpace<S> joint;
};

/// A vector or matrix with its time derivative: a dual number whose parts are matrices.
template <class Value>
struct Rated {
  Value value, rate;

  Rated& operator+=(const Rated& y) {
    value += y.value, rate += y.rate;
    return *this;
  }
  friend Rated operator+(const Rated& x, const Rated& y) { return {x.value + y.value, x.rate + y.rate}; }
  friend Rated operator-(const Rated& x, const Rated& y) { return {x.value - y.value, x.rate - y.rate}; }
};

template <Field S, int Columns>
Rated<Eigen::Matrix<S, 3, Columns>> operator*(const Rated<Matrix3<S>>& A,
                                              const Rated<Eigen::Matrix<S, 3, Columns>>& B) {
  return {A.value * B.value, A.rate * B.value + A.value * B.rate};
}
/// B is constant.
template <Field S, int Columns>
Rated<Eigen::Matrix<S, 3, Columns>> operator*(const Rated<Matrix3<S>>& A,
                                              const Eigen::Matrix<S, 3, Columns>& B) {
  return {A.value * B, A.rate * B};
}
template <Field S>
Rated<Vector3<S>> cross(const Rated<Vector3<S>>& a, const Rated<Vector3<S>>& b) {
  return {a.value.cross(b.value), a.rate.cross(b.value) + a.value.cross(b.rate)};
}

/// How a link moves against its inboard link while one velocity coordinate of its joint is 1, at the link's
/// origin: the motion unit_motion(), in its two halves.
template <Field S>
struct UnitMotion {
  Rated<Vector3<S>> ang, lin;
};

/// One link on its way, inertial frame. For the velocities of its joint and all those inboard.
template <Field S>
struct MovingLink {
  Rated<Matrix3<S>> R;            // link axes
  Rated<Vector3<S>> origin, com;  // m
  Rated<Vector3<S>> w;            // rad/s
  Vector3<S> com_acceleration;    // m/s^2 at qdd = 0
  int first = 0, columns = 0;     // of its joint among the velocity coordinates
};

/// The links of an arm and their joints' motions as state() found them; storage that is used again.
template <Field S>
struct Moving {
  std::vector<MovingLink<S>> links;    // base to tip
  std::vector<UnitMotion<S>> motions;  // for each velocity coordinate
  Rated<Matrix3<S>> R_tip;             // tip axes
  Rated<Vector3<S>> tip;               // m, tip origin
};

namespace internal {

/// Pose of a revolute or prismatic joint's link in the joint's frame, by the exponential of the axis.
template <Field S>
Rated<Matrix3<S>> turn(const Link<S>& link, const JointPosition<S>& q, const S& qd) {
  const Vector3<S>& a = link.axis;
  const Matrix3<S> K = cross_matrix(a);
  const Matrix3<S> KK = a * a.transpose() - a.dot(a) * Matrix3<S>::Identity();  // K K
  return {Matrix3<S>::Identity() + q.s * K + (S(1) - q.c) * KK, (q.c * qd) * K + (q.s * qd) * KK};
}

/// The unit motions of a joint of several axes. R_joint: axes of its frame; R: of its link.
template <Field S>
UnitMotion<S> unit_motion(const Link<S>& link, const Rated<Matrix3<S>>& R_joint, const Rated<Matrix3<S>>& R,
                          int j) {
  const Rated<Vector3<S>> none{Vector3<S>::Zero(), Vector3<S>::Zero()};
  const auto column = [](const Rated<Matrix3<S>>& A, int k) {
    return Rated<Vector3<S>>{A.value.col(k), A.rate.col(k)};
  };
  const Rated<Vector3<S>> axis = R_joint * link.axis;
  switch (link.type) {
    case JointType::cylindrical:
      return j == 0 ? UnitMotion<S>{axis, none} : UnitMotion<S>{none, axis};
    case JointType::universal:
      return {j == 0 ? axis : R * link.axis2, none};
    case JointType::planar:
      if (j == 2) return {axis, none};
      return {none, j == 0 ? R_joint * link.axis2 : R_joint * Vector3<S>(link.axis.cross(link.axis2))};
    default:  // spherical, floating
      return j < 3 ? UnitMotion<S>{column(R, j), none} : UnitMotion<S>{none, column(R_joint, j - 3)};
  }
}

/// Base to tip: where all links are and how they move.
template <Field S>
void move(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
          const BaseMotion<S>& base, Moving<S>& out) {
  const Vector3<S> zero = Vector3<S>::Zero();
  const Vector3<S> spin = base.velocity.template head<3>(), pace = base.velocity.template tail<3>();
  Rated<Matrix3<S>> R{base.R, cross_matrix(spin) * base.R};
  Rated<Vector3<S>> point{base.p, pace};  // moves with the link last seen, here the base,
  Rated<Vector3<S>> w{spin, base.acceleration.template head<3>()};
  Rated<Vector3<S>> v{pace, base.acceleration.template tail<3>()};  // at this velocity
  out.links.resize(chain.links.size());
  out.motions.resize(static_cast<std::size_t>(qd.size()));
  int column = 0;
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    const Link<S>& link = chain.links[i];
    const JointPosition<S>& q = positions[i];
    MovingLink<S>& here = out.links[i];
    here.first = column;
    here.columns = velocity_count(link.type);
    const Rated<Vector3<S>> joint = point + R * link.p_origin;
    const Rated<Matrix3<S>> R_joint = R * link.R_origin;
    UnitMotion<S>* const motion = &out.motions[static_cast<std::size_t>(column)];
    here.origin = joint;
    if (link.type == JointType::revolute) {
      R = R_joint * turn(link, q, qd[column]);
      *motion = {R_joint * link.axis, {zero, zero}};
    } else if (link.type == JointType::prismatic) {
      R = R_joint;
      *motion = {{zero, zero}, R_joint * link.axis};
      here.origin += R_joint * Rated<Vector3<S>>{link.axis * q.d, link.axis * qd[column]};
    } else {
      const JointPosition<Dual<S>> at = moving(link, q, qd.data() + column);
      R = R_joint * Rated<Matrix3<S>>{values(at.R), derivatives(at.R)};
      here.origin += R_joint * Rated<Vector3<S>>{values(at.p), derivatives(at.p)};
      for (int j = 0; j < here.columns; ++j) motion[j] = unit_motion(link, R_joint, R, j);
    }
    here.R = R;
    here.com = here.origin + R * link.com;
    v += cross(w, here.origin - point);
    for (int j = 0; j < here.columns; ++j, ++column) {
      const S& rate = qd[column];
      w += Rated<Vector3<S>>{motion[j].ang.value * rate, motion[j].ang.rate * rate};
      v += Rated<Vector3<S>>{motion[j].lin.value * rate, motion[j].lin.rate * rate};
    }
    here.w = w;
    here.com_acceleration = v.rate + cross(w, here.com - here.origin).rate;
    point = here.origin;
  }
  out.R_tip = R * chain.R_tip;
  out.tip = point + R * chain.p_tip;
}

/// J, its product with qd and the derivative of that: (7), (8).
template <Field S>
void tip_motion(const Moving<S>& at, const VectorX<S>& qd, const BaseMotion<S>& base, Kinematics<S>& out) {
  out.R = at.R_tip.value;
  out.p = at.tip.value;
  out.J.resize(6, qd.size());
  const Vector3<S> spin = base.velocity.template head<3>(), pace = base.velocity.template tail<3>();
  Rated<Vector3<S>> w{spin, base.acceleration.template head<3>()};
  Rated<Vector3<S>> v{pace, base.acceleration.template tail<3>()};
  v += cross(w, at.tip - Rated<Vector3<S>>{base.p, pace});
  for (const MovingLink<S>& link : at.links)
    for (int c = link.first; c < link.first + link.columns; ++c) {
      const UnitMotion<S>& motion = at.motions[static_cast<std::size_t>(c)];
      const Rated<Vector3<S>> lin = motion.lin + cross(motion.ang, at.tip - link.origin);
      out.J.col(c) << motion.ang.value, lin.value;
      w += Rated<Vector3<S>>{motion.ang.value * qd[c], motion.ang.rate * qd[c]};
      v += Rated<Vector3<S>>{lin.value * qd[c], lin.rate * qd[c]};
    }
  out.tip_velocity << w.value, v.value;
  out.Jdot_qd << w.rate, v.rate;
}

/// Adds 2 a.b 1 - a b* - b a* to A: a = b m / 2 makes it the inertia of a mass m at b.
template <Field S>
void add_points(Matrix3<S>& A, const Vector3<S>& a, const Vector3<S>& b) {
  const S x = a[0] * b[0], y = a[1] * b[1], z = a[2] * b[2];
  A(0, 0) += S(2) * (y + z);
  A(1, 1) += S(2) * (x + z);
  A(2, 2) += S(2) * (x + y);
  const S xy = a[0] * b[1] + a[1] * b[0], xz = a[0] * b[2] + a[2] * b[0], yz = a[1] * b[2] + a[2] * b[1];
  A(0, 1) -= xy, A(1, 0) -= xy;
  A(0, 2) -= xz, A(2, 0) -= xz;
  A(1, 2) -= yz, A(2, 1) -= yz;
}

/// Tip to base: M = sum J_i* M_i J_i, C = sum J_i* (rates of momentum), G = - sum J_i* (weights), where the
/// sums over the links outboard of a joint are taken first, about the origin of the joint's link.
template <Field S>
void joint_sums(const Chain<S>& chain, const Moving<S>& at, JointSpace<S>& out) {
  const auto m = static_cast<Eigen::Index>(at.motions.size());
  out.M.resize(m, m);
  out.C.resize(m);
  out.G.resize(m);
  S mass(0);                                 // kg, of all links from here on
  Vector3<S> first = Vector3<S>::Zero();     // kg m, mass times centre of mass
  Matrix3<S> inertia = Matrix3<S>::Zero();   // kg m^2
  Vector3<S> force = first, moment = first;  // N, N m
  for (int i = chain.n() - 1; i >= 0; --i) {
    const Link<S>& link = chain.links[static_cast<std::size_t>(i)];
    const MovingLink<S>& here = at.links[static_cast<std::size_t>(i)];
    if (i + 1 < chain.n()) {  // to the origin of this link: r becomes r + d
      const Vector3<S> d = at.links[static_cast<std::size_t>(i) + 1].origin.value - here.origin.value;
      const Vector3<S> half = (mass / S(2)) * d;
      add_points(inertia, Vector3<S>(first + half), d);
      first += half + half;
      moment += d.cross(force);
    }
    const Vector3<S> c = here.com.value - here.origin.value, w = here.w.value;
    const Matrix3<S> I = here.R.value * link.inertia * here.R.value.transpose();  // about the centre of mass
    const Vector3<S> Iw = I * w;
    const Vector3<S> rate = link.mass * here.com_acceleration;
    mass += link.mass;
    first += link.mass * c;
    inertia += I;
    add_points(inertia, Vector3<S>((link.mass / S(2)) * c), c);
    moment += I * here.w.rate + w.cross(Iw) + c.cross(rate);
    force += rate;

    const Vector3<S> weight = mass * chain.gravity, weight_moment = first.cross(chain.gravity);
    for (int k = here.first; k < here.first + here.columns; ++k) {
      const Vector3<S>&ang = at.motions[static_cast<std::size_t>(k)].ang.value,
            &lin = at.motions[static_cast<std::size_t>(k)].lin.value;
      out.C[k] = ang.dot(moment) + lin.dot(force);
      out.G[k] = -(ang.dot(weight_moment) + lin.dot(weight));
      // momentum of the links outboard while this coordinate moves alone, and its work on those inboard
      const Vector3<S> linear = mass * lin + ang.cross(first);
      Vector3<S> angular = inertia * ang + first.cross(lin);
      for (int j = i; j >= 0; --j) {
        const MovingLink<S>& inboard = at.links[static_cast<std::size_t>(j)];
        for (int l = inboard.first; l < inboard.first + inboard.columns; ++l) {
          const UnitMotion<S>& motion = at.motions[static_cast<std::size_t>(l)];
          out.M(k, l) = motion.ang.value.dot(angular) + motion.lin.value.dot(linear);
          out.M(l, k) = out.M(k, l);
        }
        if (j > 0)
          angular +=
              (inboard.origin.value - at.links[static_cast<std::size_t>(j) - 1].origin.value).cross(linear);
      }
    }
    if (one_axis(link.type)) out.M(here.first, here.first) += link.armature;
  }
}

}  // namespace internal

/// Tip and joint space at once. positions.size() == chain.n(), qd.size() == chain.velocities(). On a moving
/// base Jdot_qd and C contain the base's velocity and acceleration: (6) and (8) hold with the base moving as
/// told. `at` and `out` keep their storage from call to call.
template <Field S>
void state(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
           const BaseMotion<S>& base, Moving<S>& at, State<S>& out) {
  inlined<S>([&] { internal::move(chain, positions, qd, base, at); });
  inlined<S>([&] { internal::tip_motion(at, qd, base, out.tip); });
  inlined<S>([&] { internal::joint_sums(chain, at, out.joint); });
}
template <Field S>
State<S> state(const Chain<S>& chain, const Positions<S>& positions, const VectorX<S>& qd,
               const BaseMotion<S>& base = {}) {
  Moving<S> at;
  State<S> out;
  state(chain, positions, qd, base, at, out);
  return out;
}

}  // namespace osculate::dense
