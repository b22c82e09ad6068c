// The arm at one configuration, in the paper's numbering: link 1 outermost ... n innermost, n+1 the base, 0
// the tip. This file is the one place where base-to-tip order becomes tip-to-base order.
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "model/chain.hpp"
#include "model/pose.hpp"
#include "spatial/hinge.hpp"
#include "spatial/joint.hpp"

namespace osculate {

/// A link-frame joint type: the same joint, with the vectors of each link resolved in its own axes.
template <Field S>
using LinkHinge = Hinge<S, TurnedShift<S>>;
template <Field S>
using LinkJoint = Joint<S, TurnedShift<S>>;

template <class H>
inline constexpr bool in_link_frames = std::is_same_v<typename H::Shift, TurnedShift<typename H::Scalar>>;
template <class H>
inline constexpr bool has_one_axis = std::is_same_v<typename H::Coordinate, typename H::Scalar>;

template <Field S>
Vec3<S> to_vec3(const Vector3<S>& v) {
  return {v[0], v[1], v[2]};
}
template <Field S>
Mat3<S> to_mat3(const Matrix3<S>& m) {
  return {{m(0, 0), m(0, 1), m(0, 2)}, {m(1, 0), m(1, 1), m(1, 2)}, {m(2, 0), m(2, 1), m(2, 2)}};
}
template <Field S>
Mat3<S> identity3() {
  return {{S(1), S(0), S(0)}, {S(0), S(1), S(0)}, {S(0), S(0), S(1)}};
}

/// What the recursions need of link k: phi(k+1,k), H(k), M(k) about O(k), armature J(k).
template <class H>
struct ArmLink {
  using S = typename H::Scalar;
  typename H::Shift phi;
  H hinge;
  RigidInertia<S> M;
  typename H::JointInertia J;
};

/// Axes and origin of a link (or the tip) in the inertial frame.
template <Field S>
struct Placement {
  Mat3<S> R = identity3<S>();
  Vec3<S> p;  // m
};
/// One link outward.
template <Field S>
constexpr Placement<S> operator*(const Placement<S>& in, const TurnedShift<S>& phi) {
  return {in.R * phi.R, in.p + in.R * phi.l};
}

/// In one frame nothing is left to do: placing the arm has found the tip.
template <Field S>
constexpr const Placement<S>& operator*(const Placement<S>& in, const Shift<S>&) {
  return in;
}
/// A vector of the inertial frame in the axes of `at`.
template <class Space, Field S>
constexpr Vec<Space, S> seen_from(const Placement<S>& at, const Vec<Space, S>& v) {
  return {transposed_times(at.R, v.ang), transposed_times(at.R, v.lin)};
}
/// A vector resolved in the axes of `at` in the inertial frame.
template <class Space, Field S>
constexpr Vec<Space, S> turned(const Placement<S>& at, const Vec<Space, S>& v) {
  return {at.R * v.ang, at.R * v.lin};
}

/// What the base does to the arm: its velocity V(n+1), and A = Vdot(n+1) + a_g, which the arm feels. About
/// the base origin O(n+1); inertial frame, or the base's axes in link frames. All zero: base at rest, no
/// gravity.
template <Field S>
struct Ground {
  Vec<Motion, S> V, A;
  Vec<Motion, S> a_g;  // (0; -gravity): the upward acceleration that stands for gravity; inertial frame
};

/// phi, H, M, J of every link at one configuration. arm[0] holds phi(1,0) alone.
template <class H>
struct BasicArm {
  using S = typename H::Scalar;
  std::vector<ArmLink<H>> link;
  Placement<S> base;  // the base in the inertial frame
  Placement<S> tip;   // axes and tip point O(0), inertial frame; in link frames the sweeps find it
  int n() const { return static_cast<int>(link.size()) - 1; }
  ArmLink<H>& operator[](int k) { return link[static_cast<std::size_t>(k)]; }
  const ArmLink<H>& operator[](int k) const { return link[static_cast<std::size_t>(k)]; }
};
template <Field S>
using Arm = BasicArm<Hinge<S>>;

/// Joint coordinates in the paper's numbering, read from a base-to-tip list of one number for each joint.
template <class C>
struct TipFirst {
  const C* base_first;
  int n;
  const C& operator[](int k) const { return base_first[n - k]; }
};

/// Where the coordinates of joint k stand in a base-to-tip list: entries first .. first + m - 1.
struct JointOrder {
  struct Place {
    int first, m;
  };
  std::vector<Place> joint;  // [0] unused
  template <Field S>
  explicit JointOrder(const Chain<S>& chain) : joint(chain.links.size() + 1) {
    int first = 0;
    for (int k = chain.n(); k >= 1; --k) {
      const int m = velocity_count(chain.links[static_cast<std::size_t>(chain.n() - k)].type);
      joint[static_cast<std::size_t>(k)] = {first, m};
      first += m;
    }
  }
  const Place& operator[](int k) const { return joint[static_cast<std::size_t>(k)]; }
};

/// The coordinates of joint k from a base-to-tip list; zero from an empty one.
template <class H>
typename H::Coordinate joint_entry(const JointOrder& order, std::span<const typename H::Scalar> list, int k) {
  const auto [first, m] = order[k];
  if constexpr (has_one_axis<H>) {
    return list.empty() ? typename H::Scalar(0) : list[static_cast<std::size_t>(first)];
  } else {
    typename H::Coordinate out{m, {}};
    if (!list.empty())
      for (int i = 0; i < m; ++i) out[i] = list[static_cast<std::size_t>(first + i)];
    return out;
  }
}
template <class H>
void set_joint_entry(const JointOrder& order, std::span<typename H::Scalar> list, int k,
                     const typename H::Coordinate& value) {
  const auto [first, m] = order[k];
  if constexpr (has_one_axis<H>)
    list[static_cast<std::size_t>(first)] = value;
  else
    for (int i = 0; i < m; ++i) list[static_cast<std::size_t>(first + i)] = value[i];
}

/// Joint coordinates in the paper's numbering from a base-to-tip list, for joints of any kind.
template <class H>
struct JointList {
  const JointOrder& order;
  std::span<const typename H::Scalar> base_first;
  typename H::Coordinate operator[](int k) const { return joint_entry<H>(order, base_first, k); }
};

/// The constants of a chain, prepared once so that placing the arm costs field operations only: R_origin
/// Rot(axis) is A + c B + s C, and the inertia is about O(k). Joints with one axis need H = Hinge.
template <class H>
class BasicArmBuilder {
 public:
  using S = typename H::Scalar;

  explicit BasicArmBuilder(const Chain<S>& chain) {
    for (const auto& l : chain.links) {
      Constants c;
      c.type = l.type;
      c.axis = to_vec3(l.axis);
      c.axis2 = to_vec3(l.axis2);
      c.p = to_vec3(l.p_origin);
      c.R = to_mat3(l.R_origin);
      c.A = outer(c.R * c.axis, c.axis);
      c.B = c.R - c.A;
      c.C = cross(c.R, c.axis);
      const Vec3<S> com = to_vec3(l.com);
      c.M.mp = com * l.mass;
      // I about O = I about the centre of mass - m p~ p~
      const Sym3<S> moved = upper(cross(c.M.mp, cross(com, identity3<S>())));
      const Sym3<S> about_com = upper(to_mat3(l.inertia));
      c.M.I = faulty(Fault::inertia_about_com) ? about_com : about_com - moved;
      c.M.m = l.mass;
      c.J = l.armature;
      links_.push_back(c);
    }
    tip_ = {to_mat3(chain.R_tip), to_vec3(chain.p_tip)};
    a_g_ = {{S(0), S(0), S(0)}, seeded(Fault::gravity_sign, -to_vec3(chain.gravity))};
  }

  int n() const { return static_cast<int>(links_.size()); }
  /// a_g: the upward acceleration of the base that stands for gravity, (0; -gravity).
  const Vec<Motion, S>& a_g() const { return a_g_; }
  /// A base at rest, with gravity.
  Ground<S> ground() const { return {{}, a_g_, a_g_}; }
  /// A base that moves as prescribed, with gravity.
  Ground<S> ground(const BaseMotion<S>& base) const {
    const auto motion = [](const auto& v) { return Vec<Motion, S>{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; };
    const Vec<Motion, S> V = motion(base.velocity);
    const Vec<Motion, S> A = a_g_ + seeded(Fault::base_acceleration, motion(base.acceleration));
    const Placement<S> at = placement(base);
    if constexpr (in_link_frames<H>) return {seen_from(at, V), seen_from(at, A), a_g_};
    return {V, A, a_g_};
  }
  /// Axes and origin of the base, where it is not the inertial frame.
  static Placement<S> placement(const BaseMotion<S>& base) { return {to_mat3(base.R), to_vec3(base.p)}; }

  /// Places the arm on a base that stands where arm.base says. `joints` base to tip. In one frame this is
  /// forward kinematics, base to tip, the hidden sweep; in link frames each link is placed by itself. No
  /// allocation after the first call.
  void place(const std::vector<JointPosition<S>>& joints, BasicArm<H>& arm) const {
    arm.link.resize(links_.size() + 1);
    if constexpr (in_link_frames<H>) {
      for (int k = n(); k >= 1; --k) {
        const auto i = static_cast<std::size_t>(n() - k);
        const Constants& c = links_[i];
        auto& [phi, hinge, M, J] = arm[k];
        phi.R = c.turned(joints[i]);
        phi.l = c.p + c.R * c.slid(joints[i]);
        set_axes(hinge, J, c, transpose(phi.R) * c.R, identity3<S>());
        M = c.M;
      }
      arm[0].phi = {tip_.R, tip_.p};
    } else {
      Mat3<S> R = arm.base.R;  // axes of link k in the inertial frame
      Vec3<S> O = arm.base.p;  // O(k)
      for (int k = n(); k >= 1; --k) {
        const auto i = static_cast<std::size_t>(n() - k);
        const Constants& c = links_[i];
        auto& [phi, hinge, M, J] = arm[k];
        phi.l = R * c.p;
        if constexpr (has_one_axis<H>) {
          R = R * c.turned(joints[i]);
          set_axes(hinge, J, c, R, R);
          if (c.type == JointType::prismatic)  // O(k) moves with link k
            phi.l = phi.l + seeded(Fault::slide, hinge.h * joints[i].d);
        } else {
          const Mat3<S> R_joint = R * c.R;
          phi.l = phi.l + R_joint * c.slid(joints[i]);
          R = R * c.turned(joints[i]);
          set_axes(hinge, J, c, R_joint, R);
        }
        M = {turned(faulty(Fault::inertia_turned_back) ? transpose(R) : R, c.M.I),
             faulty(Fault::first_moment_not_turned) ? c.M.mp : R * c.M.mp, c.M.m};
        O = O + phi.l;
      }
      arm[0].phi.l = faulty(Fault::tip_not_turned) ? tip_.p : R * tip_.p;
      arm.tip = {R * tip_.R, O + arm[0].phi.l};
    }
  }

 private:
  struct Constants {
    JointType type;
    Vec3<S> axis, axis2, p;
    Mat3<S> R, A, B, C;
    RigidInertia<S> M;  // link axes
    S J;
    /// Link axes in the inboard link's.
    Mat3<S> turned(const JointPosition<S>& q) const {
      if (one_axis(type)) return A + B * q.c + seeded(Fault::sense_of_rotation, C * q.s);
      return R * to_mat3(q.R);
    }
    /// Displacement of the link's origin, joint axes, m.
    Vec3<S> slid(const JointPosition<S>& q) const {
      return one_axis(type) ? seeded(Fault::slide, axis * q.d) : to_vec3(q.p);
    }
  };

  /// H(k) and J(k), from the joint's axes and the link's, both in the frame that link k uses.
  static void set_axes(H& hinge, typename H::JointInertia& J, const Constants& c, const Mat3<S>& R_joint,
                       const Mat3<S>& R_link) {
    if constexpr (has_one_axis<H>) {
      // The axis is the same in the joint's and the link's axes.
      hinge.kind = c.type == JointType::revolute ? HingeKind::revolute : HingeKind::prismatic;
      hinge.h = in_link_frames<H> ? c.axis : R_link * c.axis;
      J.d = c.J;
    } else {
      const int m = velocity_count(c.type);
      hinge.axes.m = m;
      hinge.second_turns = c.type == JointType::universal;
      J = {m, {}};
      const Vec3<S> none;
      const auto turn = [&](int i, const Vec3<S>& h) { hinge.axes[i] = {h, none}; };
      const auto slide = [&](int i, const Vec3<S>& h) { hinge.axes[i] = {none, h}; };
      const auto column = [](const Mat3<S>& R, int i) {
        const auto entry = [i](const Vec3<S>& row) { return i == 0 ? row.x : i == 1 ? row.y : row.z; };
        return Vec3<S>{entry(R.x), entry(R.y), entry(R.z)};
      };
      const Vec3<S> h = R_joint * c.axis;
      switch (c.type) {
        case JointType::revolute:
          turn(0, R_link * c.axis);
          J(0, 0) = c.J;
          break;
        case JointType::prismatic:
          slide(0, R_link * c.axis);
          J(0, 0) = c.J;
          break;
        case JointType::cylindrical:
          turn(0, h);
          slide(1, h);
          break;
        case JointType::universal:
          turn(0, h);
          turn(1, R_link * c.axis2);
          break;
        case JointType::planar:
          slide(0, R_joint * c.axis2);
          slide(1, seeded(Fault::planar_axes, R_joint * cross(c.axis, c.axis2)));
          turn(2, h);
          break;
        case JointType::spherical:
        case JointType::floating:
          for (int i = 0; i < 3; ++i) turn(i, column(faulty(Fault::spherical_axes) ? R_joint : R_link, i));
          if (m == 6)
            for (int i = 0; i < 3; ++i) slide(3 + i, column(R_joint, i));
          break;
      }
    }
  }

  std::vector<Constants> links_;
  Placement<S> tip_;  // in the last link's frame
  Vec<Motion, S> a_g_;
};
template <Field S>
using ArmBuilder = BasicArmBuilder<Hinge<S>>;

}  // namespace osculate
