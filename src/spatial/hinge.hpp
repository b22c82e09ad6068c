// What a joint with one axis does to spatial vectors: H, D, G, K. Joints with more axes: joint.hpp.
#pragma once

#include "scalar/inlined.hpp"
#include "spatial/psi.hpp"

namespace osculate {

/// Which half of a spatial vector a joint moves: a revolute joint the angular one, a prismatic joint the
/// linear one. Where a link has no joint, none.
enum class HingeKind { revolute, prismatic, none };

template <Field S>
struct HingeInertia;
template <Field S>
struct HingeMobility;
template <Field S>
struct HingeGain;

/// H(k): the row of a one-axis joint. H* = (h;0) revolute, (0;h) prismatic. The products below use that one
/// half is zero. Phi: how links are shifted, Shift in one frame or TurnedShift in link frames.
template <Field S, ShiftMap Phi = osculate::Shift<S>>
struct Hinge {
  using Scalar = S;
  using Shift = Phi;
  using Coordinate = S;  // joint rate, acceleration or torque: one number
  using JointInertia = HingeInertia<S>;
  using JointMobility = HingeMobility<S>;
  using Gain = HingeGain<S>;
  HingeKind kind = HingeKind::none;
  Vec3<S> h;  // unit vector along the axis
  constexpr bool turns() const { return kind == HingeKind::revolute; }
  constexpr Star<Hinge> T() const { return {*this}; }
};
template <Field S>
constexpr Hinge<S> revolute(const Vec3<S>& h) {
  return {HingeKind::revolute, h};
}
template <Field S>
constexpr Hinge<S> prismatic(const Vec3<S>& h) {
  return {HingeKind::prismatic, h};
}
/// A kind that the compiler knows, so that the zero half of such a hinge costs nothing.
template <HingeKind kind>
struct KnownKind {
  template <Field S, ShiftMap Phi>
  constexpr bool holds(const Hinge<S, Phi>& H) const {
    return H.kind == kind;
  }
  /// A copy of a hinge for which holds() is true.
  template <Field S, ShiftMap Phi>
  constexpr Hinge<S, Phi> operator()(const Hinge<S, Phi>& H) const {
    return {kind, H.h};
  }
};
template <Field S, ShiftMap Phi, class Work>
constexpr void with_known_kind(const Hinge<S, Phi>& H, const Work& work) {
  if (H.turns())
    work(KnownKind<HingeKind::revolute>());
  else
    work(KnownKind<HingeKind::prismatic>());
}

template <Field S, ShiftMap Phi>
constexpr S operator*(const Hinge<S, Phi>& H, const Vec<Force, S>& f) {
  return dot(H.h, H.turns() ? f.ang : f.lin);
}
template <Field S, ShiftMap Phi>
constexpr Vec<Motion, S> operator*(const Star<Hinge<S, Phi>>& H, const S& rate) {
  const Vec3<S> moved = H.map.h * rate, none;
  return H.map.turns() ? Vec<Motion, S>{moved, none} : Vec<Motion, S>{none, moved};
}
/// What the rate of H* within the joint adds to (48): nothing for one axis.
template <Field S, ShiftMap Phi>
constexpr Vec<Motion, S> with_inner_bias(const Hinge<S, Phi>&, const S&, const Vec<Motion, S>& a) {
  return a;
}

/// D(k), J(k): Torque <- Rate, and its inverse.
template <Field S>
struct HingeInertia {
  S d = S(0);
};
template <Field S>
struct HingeMobility {
  S d = S(0);
};
template <Field S>
constexpr HingeInertia<S> operator+(const HingeInertia<S>& a, const HingeInertia<S>& b) {
  return {a.d + b.d};
}
template <Field S>
constexpr HingeMobility<S> inverse(const HingeInertia<S>& D) {
  return {S(1) / D.d};
}
template <Field S>
constexpr S operator*(const HingeMobility<S>& D, const S& torque) {
  return D.d * torque;
}
template <Field S>
constexpr S operator*(const HingeInertia<S>& J, const S& rate) {
  return J.d * rate;
}

/// P H*: Force <- Rate, as a column.
template <Field S>
struct InertiaTimesHinge {
  Vec<Force, S> column;
};
template <Field S, ShiftMap Phi>
constexpr InertiaTimesHinge<S> operator*(const Inertia<S>& P, const Star<Hinge<S, Phi>>& H) {
  const Vec3<S>& h = H.map.h;
  if (H.map.turns()) return {{P.J * h, transposed_times(P.B, h)}};
  return {{P.B * h, P.A * h}};
}
/// H P H*: H * P waits for H.T().
template <Field S, ShiftMap Phi>
struct HingeTimesInertia {
  const Hinge<S, Phi>& H;
  const Inertia<S>& P;
};
template <Field S, ShiftMap Phi>
constexpr HingeTimesInertia<S, Phi> operator*(const Hinge<S, Phi>& H, const Inertia<S>& P) {
  return {H, P};
}
template <Field S, ShiftMap Phi>
constexpr HingeInertia<S> operator*(const HingeTimesInertia<S, Phi>& HP, const Star<Hinge<S, Phi>>& H) {
  return {dot(HP.H.h, (HP.H.turns() ? HP.P.J : HP.P.A) * H.map.h)};
}

/// G(k), K(k+1,k): Force <- Torque (31), (32). G(k) keeps the column P H* that it comes from and, once it is
/// set, D(k).
template <Field S>
struct HingeGain {
  Vec<Force, S> column, PH{};
  HingeInertia<S> D{};
  constexpr Star<HingeGain> T() const { return {*this}; }
};
/// Numbers that live in registers still have P H* there where it is wanted again.
template <Field S>
requires in_register<S>
struct HingeGain<S> {
  Vec<Force, S> column;
  HingeInertia<S> D{};
  constexpr Star<HingeGain> T() const { return {*this}; }
};
template <Field S>
constexpr HingeGain<S> operator*(const InertiaTimesHinge<S>& PH, const HingeMobility<S>& Dinv) {
  if constexpr (in_register<S>)
    return {PH.column * Dinv.d};
  else
    return {PH.column * Dinv.d, PH.column};
}
template <ShiftMap Phi, Field S>
constexpr HingeGain<S> operator*(const Phi& phi, const HingeGain<S>& G) {
  return {phi * G.column};
}
template <Field S>
constexpr Vec<Force, S> operator*(const HingeGain<S>& G, const S& torque) {
  return G.column * torque;
}
template <Field S>
constexpr S operator*(const Star<HingeGain<S>>& G, const Vec<Motion, S>& V) {
  return dot(G.map.column, V);
}
/// K J K*
template <Field S>
struct GainTimesInertia {
  const HingeGain<S>& K;
  const HingeInertia<S>& J;
};
template <Field S>
constexpr GainTimesInertia<S> operator*(const HingeGain<S>& K, const HingeInertia<S>& J) {
  return {K, J};
}
template <Field S>
constexpr Inertia<S> operator*(const GainTimesInertia<S>& KJ, const Star<HingeGain<S>>& K) {
  return scaled_square(K.map.column, KJ.J.d);
}

/// H* D^-1: Motion <- Torque, and H* D^-1 H: Motion <- Force.
template <Field S, ShiftMap Phi>
struct HingeCompliance {
  const Hinge<S, Phi>& H;
  HingeMobility<S> Dinv;
};
template <Field S, ShiftMap Phi>
constexpr HingeCompliance<S, Phi> operator*(const Star<Hinge<S, Phi>>& H, const HingeMobility<S>& Dinv) {
  return {H.map, Dinv};
}
template <Field S, ShiftMap Phi>
constexpr Vec<Motion, S> operator*(const HingeCompliance<S, Phi>& HD, const S& torque) {
  return HD.H.T() * (HD.Dinv.d * torque);
}
template <Field S, ShiftMap Phi>
constexpr Compliance<S> operator*(const HingeCompliance<S, Phi>& HD, const Hinge<S, Phi>& H) {
  const Sym3<S> block = symmetric_outer(H.h, H.h * HD.Dinv.d), none;
  return H.turns() ? Compliance<S>{block, {}, none} : Compliance<S>{none, {}, block};
}

/// (1 - G H) P for G = P H* D^-1 with any D: P - G (H P), symmetric. The last term, (P H* - G D) G*, is zero
/// but for what rounding left in G; with it the loss under a heavy tip stays second order, as in psi P psi*.
template <Field S, ShiftMap Phi>
constexpr Inertia<S> stripped(const Inertia<S>& P, const HingeGain<S>& G, const Hinge<S, Phi>& H) {
  Vec<Force, S> PH;
  if constexpr (in_register<S>)
    PH = (P * H.T()).column;
  else
    PH = G.PH;
  return less_outers(P, G.column, seeded(Fault::strip_inertia, PH), PH - G.column * G.D.d, G.column);
}
/// (1 - G H)* X (1 - G H) = X - H* y* - y H + (G* y) H* H, with y = X G.
template <Field S, ShiftMap Phi>
constexpr Compliance<S> stripped(const Compliance<S>& X, const HingeGain<S>& G, const Hinge<S, Phi>& H) {
  const Vec<Motion, S> y = X * G.column;
  const Vec<Motion, S> r = seeded(Fault::strip_compliance, y);
  const Vec<Motion, S> t = seeded(Fault::strip_compliance, y - H.T() * dot(G.column, y));
  if (H.turns()) return {less_outers(X.J, H.h, r.ang, t.ang, H.h), X.B - outer(H.h, r.lin), X.A};
  return {X.J, X.B - outer(r.ang, H.h), less_outers(X.A, H.h, r.lin, t.lin, H.h)};
}

}  // namespace osculate
