// The arm at one configuration, in the paper's numbering: link 1 outermost ... n innermost, n+1 the base, 0
// the tip. This file is the one place where base-to-tip order becomes tip-to-base order.
#pragma once

#include <array>
#include <span>
#include <type_traits>
#include <vector>

#include "model/aligned.hpp"
#include "model/pose.hpp"
#include "scalar/inlined.hpp"
#include "spatial/hinge.hpp"
#include "spatial/joint.hpp"
#include "spatial/tip_columns.hpp"

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
Axes<S> to_axes(const Matrix3<S>& m) {
  return {to_vec3(Vector3<S>(m.col(0))), to_vec3(Vector3<S>(m.col(1))), to_vec3(Vector3<S>(m.col(2)))};
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
  [[no_unique_address]] RigidInertia<S> M;  // J stands where M ends
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

/// phi, H, M, J of every link at one configuration. arm[0] holds phi(1,0) alone, and no joint.
/// BasicArmBuilder::arm() makes one, with all that no configuration changes; its place() does the rest.
template <class H>
struct BasicArm {
  using S = typename H::Scalar;
  std::vector<ArmLink<H>> link;
  Placement<S> base;            // the base in the inertial frame
  Placement<S> tip;             // axes and tip point O(0), inertial frame; in link frames the sweeps find it
  std::vector<S> sine, cosine;  // of joints with one axis, base to tip
  int n() const { return static_cast<int>(link.size()) - 1; }
  ArmLink<H>& operator[](int k) { return link[static_cast<std::size_t>(k)]; }
  const ArmLink<H>& operator[](int k) const { return link[static_cast<std::size_t>(k)]; }
};
template <Field S>
using Arm = BasicArm<Hinge<S>>;

/// work(k, H(k)) for k = first .. 1, base -> tip. Joints of one kind in a row share a loop that knows their
/// kind; it ends at a joint of another kind, which arm[0] has.
template <class H, class Work>
constexpr void outward(const BasicArm<H>& arm, int first, const Work& work) {
  for (int k = first; k >= 1;)
    with_known_kind(arm[k].hinge, [&](const auto& kind) {
      do work(k, kind(arm[k].hinge));
      while (kind.holds(arm[--k].hinge));
    });
}
/// work(k, H(k)) for k = 1 .. n, tip -> base. Asks for n first: what work leaves for a next link is then not
/// computed for the last one.
template <class H, class Work>
constexpr void inward(const BasicArm<H>& arm, const Work& work) {
  const int n = arm.n();
  for (int k = 1; k <= n;)
    with_known_kind(arm[k].hinge, [&](const auto& kind) {
      do work(k, kind(arm[k].hinge));
      while (++k <= n && kind.holds(arm[k].hinge));
    });
}

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
  if constexpr (has_one_axis<H>) {
    return list.empty() ? typename H::Scalar(0) : list[order.joint.size() - 1 - static_cast<std::size_t>(k)];
  } else {
    const auto [first, m] = order[k];
    typename H::Coordinate out{m, {}};
    if (!list.empty())
      for (int i = 0; i < m; ++i) out[i] = list[static_cast<std::size_t>(first + i)];
    return out;
  }
}
template <class H>
void set_joint_entry(const JointOrder& order, std::span<typename H::Scalar> list, int k,
                     const typename H::Coordinate& value) {
  if constexpr (has_one_axis<H>) {
    list[list.size() - static_cast<std::size_t>(k)] = value;
  } else {
    const auto [first, m] = order[k];
    for (int i = 0; i < m; ++i) list[static_cast<std::size_t>(first + i)] = value[i];
  }
}

/// give(k, coordinates of joint k) for k = 1 .. n, from a base-to-tip list; zeros from an empty one.
template <class H, class Give>
void give_joint_entries(const JointOrder& order, std::span<const typename H::Scalar> list, const Give& give) {
  const int n = static_cast<int>(order.joint.size()) - 1;
  if constexpr (has_one_axis<H>)
    if (!list.empty()) {
      const auto* entry = list.data() + n;
      for (int k = 1; k <= n; ++k) give(k, *--entry);
      return;
    }
  for (int k = 1; k <= n; ++k) give(k, joint_entry<H>(order, list, k));
}

/// Joint coordinates in the paper's numbering from a base-to-tip list of all of them, for joints of any kind.
template <class H>
struct JointList {
  const JointOrder& order;
  std::span<const typename H::Scalar> base_first;
  typename H::Coordinate operator[](int k) const {
    if constexpr (has_one_axis<H>)
      return base_first[base_first.size() - static_cast<std::size_t>(k)];
    else
      return joint_entry<H>(order, base_first, k);
  }
};

/// The constants of a chain, prepared once so that placing the arm costs field operations only: joint axes
/// along z (aligned.hpp), and the inertia about O(k). Joints with one axis need H = Hinge.
template <class H>
class BasicArmBuilder {
 public:
  using S = typename H::Scalar;

  explicit BasicArmBuilder(const Chain<S>& given) {
    const Chain<S> chain = aligned(given);
    for (const auto& l : chain.links) {
      Constants c;
      c.type = l.type;
      c.kind = l.type == JointType::revolute ? HingeKind::revolute : HingeKind::prismatic;
      c.axis = to_vec3(l.axis);
      c.axis2 = to_vec3(l.axis2);
      c.p = to_vec3(l.p_origin);
      c.R = to_axes(l.R_origin);
      const Vec3<S> com = to_vec3(l.com);
      c.M.mp = com * l.mass;
      // I about O = I about the centre of mass - m p~ p~
      const Sym3<S> moved = upper(cross(c.M.mp, cross(com, identity3<S>())));
      const Sym3<S> about_com = upper(to_mat3(l.inertia));
      c.M.I = faulty(Fault::inertia_about_com) ? about_com : about_com - moved;
      c.M.m = l.mass;
      c.J = l.armature;
      c.R_along = {c.R.x, c.R.y, c.R.z};
      c.p_along = c.p;
      c.mp_along = c.M.mp;
      c.I_along = c.M.I;
      links_.push_back(c);
    }
    tip_axes_ = to_axes(chain.R_tip);
    tip_point_ = to_vec3(chain.p_tip);
    tip_axes_along_ = {tip_axes_.x, tip_axes_.y, tip_axes_.z};
    tip_point_along_ = tip_point_;
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

  /// An arm to be placed, on a base at rest: its memory and what no configuration changes.
  BasicArm<H> arm() const {
    BasicArm<H> out;
    out.link.resize(links_.size() + 1);
    if constexpr (has_one_axis<H>) out.sine.resize(links_.size()), out.cosine.resize(links_.size());
    for (int k = 1; k <= n(); ++k) {
      const Constants& c = links_[static_cast<std::size_t>(n() - k)];
      out[k].M.m = c.M.m;
      if constexpr (has_one_axis<H>) out[k].hinge.kind = c.kind, out[k].J.d = c.J;
    }
    return out;
  }

  /// Places an arm made by arm() on a base that stands where arm.base says. `joints` base to tip. In one
  /// frame this is forward kinematics, base to tip, the hidden sweep; in link frames each link is placed by
  /// itself. No allocation.
  void place(const std::vector<JointPosition<S>>& joints, BasicArm<H>& arm) const {
    if constexpr (in_link_frames<H>)
      place_in_link_frames(joints, arm);
    else
      inlined<S>([&] { place_in_one_frame(joints, arm); });
  }

  /// The same from coordinates, base to tip: all sines and cosines at once. Joints with one axis, in one
  /// frame.
  void place(std::span<const S> q, BasicArm<H>& arm) const {
    static_assert(has_one_axis<H> && !in_link_frames<H>);
    sine_cosine(q.data(), arm.sine.data(), arm.cosine.data(), arm.sine.size());
    inlined<S>([&] { place_in_one_frame(OneAxisPositions{q.data(), arm}, arm); });
  }

 private:
  struct Constants {
    JointType type;
    HingeKind kind;       // of joints with one axis
    Vec3<S> axis, axis2;  // joint axes
    Axes<S> R;            // joint axes, and
    Vec3<S> p;            // origin, in the inboard link's axes
    RigidInertia<S> M;    // link axes
    S J;
    // R, p and M again, as what multiplies vectors
    std::array<Coefficients<S>, 3> R_along;
    Coefficients<S> p_along, mp_along;
    SymmetricCoefficients<S> I_along;
  };
  /// Where joints with one axis stand, seen like a list of joint positions.
  struct OneAxisPosition {
    const S &c, &s, &d;
  };
  struct OneAxisPositions {
    const S* q;
    const BasicArm<H>& arm;
    OneAxisPosition operator[](std::size_t i) const { return {arm.cosine[i], arm.sine[i], q[i]}; }
  };
  /// Axes of a link whose joint's axes are `joint`, at q.
  template <class Position>
  static Axes<S> turned_by(const JointType type, const Axes<S>& joint, const Position& q) {
    if (type == JointType::prismatic) return joint;
    if constexpr (!has_one_axis<H>)
      if (type != JointType::revolute) return joint * to_axes(q.R);
    const S s = seeded(Fault::sense_of_rotation, q.s);
    return {joint.x * q.c + joint.y * s, joint.y * q.c - joint.x * s, joint.z};
  }
  /// How far the link's origin has moved, m. joint: the joint's axes, in which frame the result is.
  template <class Position>
  static Vec3<S> slid(const JointType type, const Axes<S>& joint, const Position& q) {
    if (type == JointType::revolute) return {};
    if constexpr (!has_one_axis<H>)
      if (type != JointType::prismatic) return joint * to_vec3(q.p);
    return seeded(Fault::slide, joint.z * q.d);
  }

  template <class Positions>
  void place_in_one_frame(const Positions& joints, BasicArm<H>& arm) const {
    Axes<S> e = axes_of(arm.base.R);  // of link k
    Vec3<S> O = arm.base.p;           // O(k)
    const int n = arm.n();
    for (int k = n; k >= 1; --k) {
      const auto i = static_cast<std::size_t>(n - k);
      const Constants& c = links_[i];
      auto& [phi, hinge, M, J] = arm[k];
      const Axes<S> joint = e * c.R_along;
      phi.l = e * c.p_along;
      if (c.type != JointType::revolute) [[unlikely]]
        phi.l = phi.l + slid(c.type, joint, joints[i]);  // O(k) moves with link k
      e = turned_by(c.type, joint, joints[i]);
      set_axes(hinge, J, c, joint, e);
      M.I = turned(faulty(Fault::inertia_turned_back) ? inverse(e) : e, c.I_along);
      M.mp = faulty(Fault::first_moment_not_turned) ? c.M.mp : e * c.mp_along;
      O = O + phi.l;
    }
    arm[0].phi.l = faulty(Fault::tip_not_turned) ? tip_point_ : e * tip_point_along_;
    arm.tip = {matrix_of(e * tip_axes_along_), O + arm[0].phi.l};
  }

  void place_in_link_frames(const std::vector<JointPosition<S>>& joints, BasicArm<H>& arm) const {
    const Axes<S> own = axes_of(identity3<S>());
    for (int k = n(); k >= 1; --k) {
      const auto i = static_cast<std::size_t>(n() - k);
      const Constants& c = links_[i];
      auto& [phi, hinge, M, J] = arm[k];
      const Axes<S> e = turned_by(c.type, c.R, joints[i]);
      phi.R = matrix_of(e);
      phi.l = c.p + slid(c.type, c.R, joints[i]);
      set_axes(hinge, J, c, inverse(e) * c.R, own);
      M = c.M;
    }
    arm[0].phi = {matrix_of(tip_axes_), tip_point_};
  }

  /// H(k) and J(k), but for what arm() has set, from the joint's axes and the link's, both in the frame that
  /// link k uses.
  static void set_axes(H& hinge, typename H::JointInertia& J, const Constants& c, const Axes<S>& joint,
                       const Axes<S>& link) {
    if constexpr (has_one_axis<H>) {
      hinge.h = link.z;  // the same as joint.z
    } else {
      const int m = velocity_count(c.type);
      hinge.axes.m = m;
      hinge.second_turns = c.type == JointType::universal;
      J = {m, {}};
      const Vec3<S> none;
      const auto turn = [&](int i, const Vec3<S>& h) { hinge.axes[i] = {h, none}; };
      const auto slide = [&](int i, const Vec3<S>& h) { hinge.axes[i] = {none, h}; };
      const auto column = [](const Axes<S>& e, int i) { return i == 0 ? e.x : i == 1 ? e.y : e.z; };
      const Vec3<S> h = joint * c.axis;
      switch (c.type) {
        case JointType::revolute:
          turn(0, link.z);
          J(0, 0) = c.J;
          break;
        case JointType::prismatic:
          slide(0, link.z);
          J(0, 0) = c.J;
          break;
        case JointType::cylindrical:
          turn(0, h);
          slide(1, h);
          break;
        case JointType::universal:
          turn(0, h);
          turn(1, link * c.axis2);
          break;
        case JointType::planar:
          slide(0, joint * c.axis2);
          slide(1, seeded(Fault::planar_axes, joint * cross(c.axis, c.axis2)));
          turn(2, h);
          break;
        case JointType::spherical:
        case JointType::floating:
          for (int i = 0; i < 3; ++i) turn(i, column(faulty(Fault::spherical_axes) ? joint : link, i));
          if (m == 6)
            for (int i = 0; i < 3; ++i) slide(3 + i, column(joint, i));
          break;
      }
    }
  }

  std::vector<Constants> links_;
  Axes<S> tip_axes_;  // in the last link's frame
  Vec3<S> tip_point_;
  std::array<Coefficients<S>, 3> tip_axes_along_;  // both again, as what multiplies vectors
  Coefficients<S> tip_point_along_;
  Vec<Motion, S> a_g_;
};
template <Field S>
using ArmBuilder = BasicArmBuilder<Hinge<S>>;

}  // namespace osculate
