// psi(k+1,k) (33) for every joint type, kept as its factors. A joint type H brings the member types Scalar,
// Shift, Coordinate, JointInertia and Gain, the products of H, D, G, K among themselves, and `stripped`:
//   stripped(P, G, H) = (1 - G H) P,   stripped(Omega, G, H) = (1 - G H)* Omega (1 - G H).
#pragma once

#include <concepts>

#include "spatial/map.hpp"

namespace osculate {

template <class H>
concept JointMap = requires {
  typename H::Scalar;
  typename H::Shift;
  typename H::Coordinate;
  typename H::JointInertia;
  typename H::Gain;
};
template <class G, class H>
concept GainOf = JointMap<H> && std::same_as<G, typename H::Gain>;

/// 1 - G H, written `one - G * H`.
struct One {};
inline constexpr One one;
template <JointMap H>
struct GainJoint {
  const typename H::Gain& G;
  const H& joint;
};
template <JointMap H, GainOf<H> G>
constexpr GainJoint<H> operator*(const G& gain, const H& joint) {
  return {gain, joint};
}
template <JointMap H>
struct Strip {
  const typename H::Gain& G;
  const H& joint;
};
template <JointMap H>
constexpr Strip<H> operator-(One, const GainJoint<H>& GH) {
  return {GH.G, GH.joint};
}

/// psi(k+1,k) = phi(k+1,k) (1 - G(k) H(k)) (33). Refers to its factors.
template <JointMap J>
struct Psi {
  const typename J::Shift& phi;
  const typename J::Gain& G;
  const J& H;
  constexpr Star<Psi> T() const { return {*this}; }
};
template <ShiftMap Phi, JointMap H>
constexpr Psi<H> operator*(const Phi& phi, const Strip<H>& strip) {
  return {phi, strip.G, strip.joint};
}
template <JointMap J, Field S>
constexpr Vec<Force, S> operator*(const Psi<J>& psi, const Vec<Force, S>& f) {
  const auto& [phi, G, H] = psi;
  if (faulty(Fault::psi_order)) {
    const Vec<Force, S> moved = phi * f;
    return moved - G * (H * moved);
  }
  return phi * (f - G * (H * f));
}
template <JointMap J, Field S>
constexpr Vec<Motion, S> operator*(const Star<Psi<J>>& psi, const Vec<Motion, S>& V) {
  const auto& [phi, G, H] = psi.map;
  if (faulty(Fault::psi_star_order)) return phi.T() * (V - H.T() * (G.T() * V));
  const Vec<Motion, S> moved = phi.T() * V;
  return moved - H.T() * (G.T() * moved);
}

/// psi P phi*, symmetric for the G that belongs to P: psi * P waits for phi.T(). Waiting products refer to
/// their factors.
template <JointMap H>
struct PsiInertia {
  const Psi<H>& psi;
  const Inertia<typename H::Scalar>& P;
};
template <JointMap H>
constexpr PsiInertia<H> operator*(const Psi<H>& psi, const Inertia<typename H::Scalar>& P) {
  return {psi, P};
}
template <JointMap J>
constexpr Inertia<typename J::Scalar> operator*(const PsiInertia<J>& left,
                                                const Star<typename J::Shift>& phi) {
  if (faulty(Fault::composite_inertia)) return carried(phi.map, left.P);
  return carried(phi.map, stripped(left.P, left.psi.G, left.psi.H));
}

/// psi* Omega psi: psi.T() * Omega waits for psi.
template <JointMap H>
struct PsiCompliance {
  const Psi<H>& psi;
  const Compliance<typename H::Scalar>& Omega;
};
template <JointMap H>
constexpr PsiCompliance<H> operator*(const Star<Psi<H>>& psi, const Compliance<typename H::Scalar>& Omega) {
  return {psi.map, Omega};
}
template <JointMap J>
constexpr Compliance<typename J::Scalar> operator*(const PsiCompliance<J>& left, const Psi<J>& right) {
  const auto& [phi, G, H] = right;
  const Compliance<typename J::Scalar> X = carried(phi.T(), left.Omega);
  return faulty(Fault::compliance_not_stripped) ? X : stripped(X, G, H);
}

}  // namespace osculate
