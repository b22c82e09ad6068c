// The arm at one configuration, in the paper's numbering: link 1 outermost ... n innermost, n+1 the fixed
// base, 0 the tip. This file is the one place where base-to-tip order becomes tip-to-base order.
#pragma once

#include <vector>

#include "model/chain.hpp"
#include "model/pose.hpp"
#include "spatial/hinge.hpp"

namespace osculate {

template <Field S>
Vec3<S> to_vec3(const Vector3<S>& v) {
  return {v[0], v[1], v[2]};
}
template <Field S>
Mat3<S> to_mat3(const Matrix3<S>& m) {
  return {{m(0, 0), m(0, 1), m(0, 2)}, {m(1, 0), m(1, 1), m(1, 2)}, {m(2, 0), m(2, 1), m(2, 2)}};
}

/// What the recursions need of link k, base frame: phi(k+1,k), H(k), M(k) about O(k), armature J(k).
template <class H>
struct ArmLink {
  using S = typename H::Scalar;
  Shift<S> phi;
  H hinge;
  RigidInertia<S> M;
  typename H::JointInertia J;
};

/// phi, H, M, J of every link at one configuration, and the tip's pose. arm[0] holds phi(1,0) alone.
template <class H>
struct BasicArm {
  using S = typename H::Scalar;
  std::vector<ArmLink<H>> link;
  Mat3<S> R_tip;  // tip axes in the base frame
  Vec3<S> p_tip;  // m, tip point O(0), base frame
  int n() const { return static_cast<int>(link.size()) - 1; }
  ArmLink<H>& operator[](int k) { return link[static_cast<std::size_t>(k)]; }
  const ArmLink<H>& operator[](int k) const { return link[static_cast<std::size_t>(k)]; }
};
template <Field S>
using Arm = BasicArm<Hinge<S>>;

/// The constants of a chain, prepared once so that placing the arm costs field operations only: R_origin
/// Rot(axis) is A + c B + s C, and the inertia is about O(k).
template <Field S>
class ArmBuilder {
 public:
  explicit ArmBuilder(const Chain<S>& chain) {
    for (const auto& l : chain.links) {
      Constants c;
      c.type = l.type;
      c.axis = to_vec3(l.axis);
      c.p = to_vec3(l.p_origin);
      const Mat3<S> R = to_mat3(l.R_origin);
      c.A = outer(R * c.axis, c.axis);
      c.B = R - c.A;
      c.C = cross(R, c.axis);
      const Vec3<S> com = to_vec3(l.com);
      c.mp = com * l.mass;
      // I about O = I about the centre of mass - m p~ p~
      c.I = upper(to_mat3(l.inertia)) - upper(cross(c.mp, cross(com, identity())));
      c.m = l.mass;
      c.J = l.armature;
      links_.push_back(c);
    }
    R_tip_ = to_mat3(chain.R_tip);
    l_tip_ = to_vec3(chain.p_tip);
    a_g_ = {{S(0), S(0), S(0)}, -to_vec3(chain.gravity)};
  }

  int n() const { return static_cast<int>(links_.size()); }
  /// a_g: the fictitious upward acceleration of the base (0; -gravity).
  const Vec<Motion, S>& a_g() const { return a_g_; }

  /// Forward kinematics, base to tip: the hidden sweep. `joints` base to tip. No allocation after the first
  /// call.
  void place(const std::vector<JointPosition<S>>& joints, Arm<S>& arm) const {
    arm.link.resize(links_.size() + 1);
    Mat3<S> R = identity();  // axes of link k in the base frame
    Vec3<S> O;               // O(k)
    for (int k = n(); k >= 1; --k) {
      const auto i = static_cast<std::size_t>(n() - k);
      const Constants& c = links_[i];
      const JointPosition<S>& q = joints[i];
      auto& [phi, H, M, J] = arm[k];
      Vec3<S> l = R * c.p;
      R = R * (c.A + c.B * q.c + c.C * q.s);
      const Vec3<S> h = R * c.axis;
      H = c.type == JointType::revolute ? revolute(h) : prismatic(h);
      if (c.type == JointType::prismatic) l = l + h * q.d;  // O(k) moves with link k
      phi.l = l;
      M = {turned(R, c.I), R * c.mp, c.m};
      J.d = c.J;
      O = O + l;
    }
    arm[0].phi.l = R * l_tip_;
    arm.R_tip = R * R_tip_;
    arm.p_tip = O + arm[0].phi.l;
  }

 private:
  struct Constants {
    JointType type;
    Vec3<S> axis, p, mp;
    Mat3<S> A, B, C;
    Sym3<S> I;
    S m, J;
  };
  static Mat3<S> identity() { return {{S(1), S(0), S(0)}, {S(0), S(1), S(0)}, {S(0), S(0), S(1)}}; }
  std::vector<Constants> links_;
  Mat3<S> R_tip_;
  Vec3<S> l_tip_;
  Vec<Motion, S> a_g_;
};

}  // namespace osculate
