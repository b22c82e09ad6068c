// What a joint does to spatial vectors: H, D, G, K, psi for a joint with one axis.
// A joint with m axes is another type with the same operators and member types (D an m x m block); the sweeps
// are templates on it.
#pragma once

#include "spatial/map.hpp"

namespace osculate {

/// Which half of a spatial vector a joint moves: a revolute joint the angular one, a prismatic joint the
/// linear one.
enum class HingeKind { revolute, prismatic };

template <Field S>
struct JointInertia;
template <Field S>
struct Gain;
template <Field S>
struct Psi;

/// H(k): the row of a one-axis joint. H* = (h;0) revolute, (0;h) prismatic. The products below use that one
/// half is zero.
template <Field S>
struct Hinge {
  using Scalar = S;
  using Coordinate = S;  // joint rate, acceleration or torque: one number
  using JointInertia = osculate::JointInertia<S>;
  using Gain = osculate::Gain<S>;
  using Psi = osculate::Psi<S>;
  HingeKind kind = HingeKind::revolute;
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
template <Field S>
constexpr S operator*(const Hinge<S>& H, const Vec<Force, S>& f) {
  return dot(H.h, H.turns() ? f.ang : f.lin);
}
template <Field S>
constexpr Vec<Motion, S> operator*(const Star<Hinge<S>>& H, const S& rate) {
  const Vec3<S> moved = H.map.h * rate, none;
  return H.map.turns() ? Vec<Motion, S>{moved, none} : Vec<Motion, S>{none, moved};
}

/// D(k), J(k): Torque <- Rate, and its inverse.
template <Field S>
struct JointInertia {
  S d = S(0);
};
template <Field S>
struct JointCompliance {
  S d = S(0);
};
template <Field S>
constexpr JointInertia<S> operator+(const JointInertia<S>& a, const JointInertia<S>& b) {
  return {a.d + b.d};
}
template <Field S>
constexpr JointCompliance<S> inverse(const JointInertia<S>& D) {
  return {S(1) / D.d};
}
template <Field S>
constexpr S operator*(const JointCompliance<S>& D, const S& torque) {
  return D.d * torque;
}

/// P H*: Force <- Rate, as a column.
template <Field S>
struct InertiaTimesHinge {
  Vec<Force, S> column;
};
template <Field S>
constexpr InertiaTimesHinge<S> operator*(const Inertia<S>& P, const Star<Hinge<S>>& H) {
  const Vec3<S>& h = H.map.h;
  if (H.map.turns()) return {{P.J * h, transposed_times(P.B, h)}};
  return {{P.B * h, P.A * h}};
}
/// H P H*: H * P waits for H.T().
template <Field S>
struct HingeTimesInertia {
  const Hinge<S>& H;
  const Inertia<S>& P;
};
template <Field S>
constexpr HingeTimesInertia<S> operator*(const Hinge<S>& H, const Inertia<S>& P) {
  return {H, P};
}
template <Field S>
constexpr JointInertia<S> operator*(const HingeTimesInertia<S>& HP, const Star<Hinge<S>>& H) {
  return {dot(HP.H.h, (HP.H.turns() ? HP.P.J : HP.P.A) * H.map.h)};
}

/// G(k), K(k+1,k): Force <- Torque (31), (32).
template <Field S>
struct Gain {
  Vec<Force, S> column;
  constexpr Star<Gain> T() const { return {*this}; }
};
template <Field S>
constexpr Gain<S> operator*(const InertiaTimesHinge<S>& PH, const JointCompliance<S>& Dinv) {
  return {PH.column * Dinv.d};
}
template <Field S>
constexpr Gain<S> operator*(const Shift<S>& phi, const Gain<S>& G) {
  return {phi * G.column};
}
template <Field S>
constexpr Vec<Force, S> operator*(const Gain<S>& G, const S& torque) {
  return G.column * torque;
}
template <Field S>
constexpr S operator*(const Star<Gain<S>>& G, const Vec<Motion, S>& V) {
  return dot(G.map.column, V);
}
/// K J K*
template <Field S>
struct GainTimesInertia {
  const Gain<S>& K;
  const JointInertia<S>& J;
};
template <Field S>
constexpr GainTimesInertia<S> operator*(const Gain<S>& K, const JointInertia<S>& J) {
  return {K, J};
}
template <Field S>
constexpr Inertia<S> operator*(const GainTimesInertia<S>& KJ, const Star<Gain<S>>& K) {
  return scaled_square(K.map.column, KJ.J.d);
}

/// H* D^-1: Motion <- Torque, and H* D^-1 H: Motion <- Force.
template <Field S>
struct HingeCompliance {
  const Hinge<S>& H;
  JointCompliance<S> Dinv;
};
template <Field S>
constexpr HingeCompliance<S> operator*(const Star<Hinge<S>>& H, const JointCompliance<S>& Dinv) {
  return {H.map, Dinv};
}
template <Field S>
constexpr Vec<Motion, S> operator*(const HingeCompliance<S>& HD, const S& torque) {
  return HD.H.T() * (HD.Dinv.d * torque);
}
template <Field S>
constexpr Compliance<S> operator*(const HingeCompliance<S>& HD, const Hinge<S>& H) {
  const Sym3<S> block = square(H.h) * HD.Dinv.d, none;
  return H.turns() ? Compliance<S>{block, {}, none} : Compliance<S>{none, {}, block};
}

/// 1 - G H, written `one - G * H`.
struct One {};
inline constexpr One one;
template <Field S>
struct GainHinge {
  const Gain<S>& G;
  const Hinge<S>& H;
};
template <Field S>
constexpr GainHinge<S> operator*(const Gain<S>& G, const Hinge<S>& H) {
  return {G, H};
}
template <Field S>
struct Strip {
  const Gain<S>& G;
  const Hinge<S>& H;
};
template <Field S>
constexpr Strip<S> operator-(One, const GainHinge<S>& GH) {
  return {GH.G, GH.H};
}

/// psi(k+1,k) = phi(k+1,k) (1 - G(k) H(k)) (33), kept as its factors.
template <Field S>
struct Psi {
  Shift<S> phi;
  Gain<S> G;
  Hinge<S> H;
  constexpr Star<Psi> T() const { return {*this}; }
};
template <Field S>
constexpr Psi<S> operator*(const Shift<S>& phi, const Strip<S>& strip) {
  return {phi, strip.G, strip.H};
}
template <Field S>
constexpr Vec<Force, S> operator*(const Psi<S>& psi, const Vec<Force, S>& f) {
  return psi.phi * (f - psi.G * (psi.H * f));
}
template <Field S>
constexpr Vec<Motion, S> operator*(const Star<Psi<S>>& psi, const Vec<Motion, S>& V) {
  const auto& [phi, G, H] = psi.map;
  const Vec<Motion, S> moved = phi.T() * V;
  return moved - H.T() * (G.T() * moved);
}

/// psi P psi*: psi * P waits for psi.T(). These waiting products refer to their factors.
template <Field S>
struct PsiInertia {
  const Psi<S>& psi;
  const Inertia<S>& P;
};
template <Field S>
constexpr PsiInertia<S> operator*(const Psi<S>& psi, const Inertia<S>& P) {
  return {psi, P};
}
/// (1 - G H) P (1 - G H)* = P - G (HP) - r G*, with r = P H* - G (H P H*): the product as printed, in
/// symmetric form.
template <Field S>
constexpr Inertia<S> operator*(const PsiInertia<S>& left, const Star<Psi<S>>& right) {
  const auto& [phi, G, H] = right.map;
  const Vec<Force, S> PH = (left.P * H.T()).column;
  const Vec<Force, S> r = PH - G.column * (H * PH);
  const S half = S(1) / S(2);
  return carried(phi, less_twice_outer(left.P, G.column, seeded(Fault::strip_inertia, (PH + r) * half)));
}

/// psi* Omega psi: psi.T() * Omega waits for psi.
template <Field S>
struct PsiCompliance {
  const Psi<S>& psi;
  const Compliance<S>& Omega;
};
template <Field S>
constexpr PsiCompliance<S> operator*(const Star<Psi<S>>& psi, const Compliance<S>& Omega) {
  return {psi.map, Omega};
}
/// (1 - G H)* X (1 - G H) = X - H* y* - y H + (G* y) H* H, with X = phi* Omega phi and y = X G.
template <Field S>
constexpr Compliance<S> operator*(const PsiCompliance<S>& left, const Psi<S>& right) {
  const auto& [phi, G, H] = right;
  const Compliance<S> X = carried(phi.T(), left.Omega);
  const Vec<Motion, S> y = X * G.column;
  const S half = S(1) / S(2);
  const Vec<Motion, S> r = seeded(Fault::strip_compliance, y - H.T() * (dot(G.column, y) * half));
  if (H.turns()) return {less_twice_outer(X.J, H.h, r.ang), X.B - outer(H.h, r.lin), X.A};
  return {X.J, X.B - outer(r.ang, H.h), less_twice_outer(X.A, H.h, r.lin)};
}

/// phi* Omega phi for the last step to the tip (60).
template <Field S>
struct ShiftCompliance {
  const Shift<S>& phi;
  const Compliance<S>& Omega;
};
template <Field S>
constexpr ShiftCompliance<S> operator*(const Star<Shift<S>>& phi, const Compliance<S>& Omega) {
  return {phi.map, Omega};
}
template <Field S>
constexpr Compliance<S> operator*(const ShiftCompliance<S>& left, const Shift<S>& phi) {
  return carried(phi.T(), left.Omega);
}

}  // namespace osculate
