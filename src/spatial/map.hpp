// Linear maps that know their spaces: a forgotten star does not compile. `A.T()` is the paper's A*.
// With everything resolved in one frame phi is a pure Shift; between link frames it also turns (TurnedShift).
// Angular part first.
//
//   phi, psi: Force <- Force      H: Torque <- Force      M, P: Force <- Motion      Omega: Motion <- Force
//   D: Torque <- Rate             G, K: Force <- Torque
#pragma once

#include "spatial/vector3.hpp"

namespace osculate {

struct Force;  // (moment; force), N m and N
struct Motion {
  using Dual = Force;
};  // (angular; linear), rad/s and m/s, and their derivatives
struct Force {
  using Dual = Motion;
};

/// A spatial vector: an element of Motion or Force.
template <class Space, Field S>
struct Vec {
  Vec3<S> ang, lin;
};

template <class Space, Field S>
constexpr Vec<Space, S> operator+(const Vec<Space, S>& a, const Vec<Space, S>& b) {
  return {a.ang + b.ang, a.lin + b.lin};
}
template <class Space, Field S>
constexpr Vec<Space, S> operator-(const Vec<Space, S>& a, const Vec<Space, S>& b) {
  return {a.ang - b.ang, a.lin - b.lin};
}
template <class Space, Field S>
constexpr Vec<Space, S> operator-(const Vec<Space, S>& a) {
  return {-a.ang, -a.lin};
}
template <class Space, Field S>
constexpr Vec<Space, S> operator*(const Vec<Space, S>& a, const S& s) {
  return {a.ang * s, a.lin * s};
}
/// Pairing of a force with a motion: power.
template <class Space, Field S>
constexpr S dot(const Vec<Space, S>& a, const Vec<typename Space::Dual, S>& b) {
  return dot(a.ang, b.ang, a.lin, b.lin);
}

/// A* of a structured map A: refers to A, computes nothing. Use it in the expression that makes it.
template <class Map>
struct Star {
  const Map& map;
};

/// phi(k+1,k) (18): moves a force from O(k) to O(k+1); its star moves a motion from O(k+1) to O(k).
template <Field S>
struct Shift {
  Vec3<S> l;  // l(k+1,k) = O(k) - O(k+1), m
  constexpr Star<Shift> T() const { return {*this}; }
};
template <Field S>
constexpr Vec<Force, S> operator*(const Shift<S>& phi, const Vec<Force, S>& f) {
  return {plus_cross(f.ang, seeded(Fault::shift_force, phi.l), f.lin), f.lin};
}
template <Field S>
constexpr Vec<Motion, S> operator*(const Star<Shift<S>>& phi, const Vec<Motion, S>& V) {
  return {V.ang, plus_cross(V.lin, V.ang, seeded(Fault::shift_motion, phi.map.l))};
}
/// phi* V, where w x l is wanted by itself too: as a sum, so that the product is there once.
template <Field S>
constexpr Vec<Motion, S> star_as_sum(const Shift<S>& phi, const Vec<Motion, S>& V) {
  return {V.ang, V.lin + cross(V.ang, seeded(Fault::shift_motion, phi.l))};
}

/// phi(k+1,k) between link frames: the vectors of link k are resolved in its own axes, which R turns into
/// those of link k+1.
template <Field S>
struct TurnedShift {
  Mat3<S> R;
  Vec3<S> l;  // O(k) - O(k+1), m, axes of link k+1
  constexpr Star<TurnedShift> T() const { return {*this}; }
};
template <Field S>
constexpr Vec<Force, S> operator*(const TurnedShift<S>& phi, const Vec<Force, S>& f) {
  return Shift<S>{phi.l} * Vec<Force, S>{phi.R * f.ang, seeded(Fault::frame_force, phi.R * f.lin)};
}
template <Field S>
constexpr Vec<Motion, S> operator*(const Star<TurnedShift<S>>& phi, const Vec<Motion, S>& V) {
  const auto& [R, l] = phi.map;
  const Shift<S> shift{l};
  const Vec<Motion, S> moved = shift.T() * V;
  return {transposed_times(R, moved.ang), seeded(Fault::frame_motion, transposed_times(R, moved.lin))};
}
template <Field S>
constexpr Vec<Motion, S> star_as_sum(const TurnedShift<S>& phi, const Vec<Motion, S>& V) {
  return phi.T() * V;
}
/// A vector of link k+1 in the axes that link k uses.
template <Field S>
constexpr const Vec3<S>& in_outer_axes(const Shift<S>&, const Vec3<S>& v) {
  return v;
}
template <Field S>
constexpr Vec3<S> in_outer_axes(const TurnedShift<S>& phi, const Vec3<S>& v) {
  return transposed_times(phi.R, v);
}
template <class Phi>
concept ShiftMap = requires(const Phi& phi) {
  phi.l;
  phi.T();
  in_outer_axes(phi, phi.l);
};

/// Symmetric map [J B; B^T A] between a space and its dual, 21 numbers.
/// To = Force: articulated inertia P. To = Motion: compliance Omega.
template <class To, Field S>
struct Symmetric {
  Sym3<S> J;
  Mat3<S> B;
  Sym3<S> A;
};
template <Field S>
using Inertia = Symmetric<Force, S>;
template <Field S>
using Compliance = Symmetric<Motion, S>;

template <class To, Field S>
constexpr Symmetric<To, S> operator+(const Symmetric<To, S>& a, const Symmetric<To, S>& b) {
  return {a.J + b.J, a.B + b.B, a.A + b.A};
}
template <class To, Field S>
constexpr Symmetric<To, S> operator-(const Symmetric<To, S>& a, const Symmetric<To, S>& b) {
  return {a.J - b.J, a.B - b.B, a.A - b.A};
}
template <class To, Field S>
constexpr Symmetric<To, S> operator-(const Symmetric<To, S>& a) {
  return {-a.J, -a.B, -a.A};
}
template <class To, Field S>
constexpr Vec<To, S> operator*(const Symmetric<To, S>& a, const Vec<typename To::Dual, S>& b) {
  return {product_sum(a.J, b.ang, a.B, b.lin), transposed_product_sum(a.A, b.lin, a.B, b.ang)};
}
/// a b^T + b a^T
template <class To, Field S>
constexpr Symmetric<To, S> twice_outer(const Vec<To, S>& a, const Vec<To, S>& b) {
  return {twice_outer(a.ang, b.ang), outer(a.ang, b.lin) + outer(b.ang, a.lin), twice_outer(a.lin, b.lin)};
}
/// P - a b^T where that is symmetric by construction
template <class To, Field S>
constexpr Symmetric<To, S> less_outer(const Symmetric<To, S>& P, const Vec<To, S>& a, const Vec<To, S>& b) {
  return {P.J - symmetric_outer(a.ang, b.ang), P.B - outer(a.ang, b.lin),
          P.A - symmetric_outer(a.lin, b.lin)};
}
/// P - (a b^T + c d^T) where that is symmetric by construction
template <class To, Field S>
constexpr Symmetric<To, S> less_outers(const Symmetric<To, S>& P, const Vec<To, S>& a, const Vec<To, S>& b,
                                       const Vec<To, S>& c, const Vec<To, S>& d) {
  const Sym3<S> A = less_outers(P.A, a.lin, b.lin, c.lin, d.lin);
  const Mat3<S> B = less_outers(P.B, a.ang, b.lin, c.ang, d.lin);
  return {less_outers(P.J, a.ang, b.ang, c.ang, d.ang), B, A};
}
/// s a a^T
template <class To, Field S>
constexpr Symmetric<To, S> scaled_square(const Vec<To, S>& a, const S& s) {
  const Vec<To, S> b = a * s;
  return {symmetric_outer(a.ang, b.ang), outer(a.ang, b.lin), symmetric_outer(a.lin, b.lin)};
}

/// phi P phi*
template <Field S>
constexpr Inertia<S> carried(const Shift<S>& phi, const Inertia<S>& P) {
  const Vec3<S> l = seeded(Fault::spatial_cross, phi.l);
  const Mat3<S> B = plus_left_cross(P.B, l, P.A);
  if (faulty(Fault::shift_inertia)) return {-less_right_cross_sum(-P.J, B, P.B, l), B, P.A};
  return {less_right_cross_sum(P.J, B, P.B, l), B, P.A};
}
/// phi* Omega phi
template <Field S>
constexpr Compliance<S> carried(const Star<Shift<S>>& phi, const Compliance<S>& Omega) {
  const Vec3<S> l = seeded(Fault::spatial_cross, phi.map.l);
  const Mat3<S> B = plus_right_cross(Omega.B, Omega.J, l);
  if (faulty(Fault::shift_compliance)) return {Omega.J, B, -less_left_cross_sum(-Omega.A, B, Omega.B, l)};
  return {Omega.J, B, less_left_cross_sum(Omega.A, B, Omega.B, l)};
}

/// The same map in other axes, which R turns the present ones into.
template <class To, Field S>
constexpr Symmetric<To, S> turned(const Mat3<S>& R, const Symmetric<To, S>& a) {
  return {turned(R, a.J), R * a.B * transpose(R), turned(R, a.A)};
}
template <Field S>
constexpr Inertia<S> carried(const TurnedShift<S>& phi, const Inertia<S>& P) {
  return carried(Shift<S>{phi.l}, turned(phi.R, P));
}
template <Field S>
constexpr Compliance<S> carried(const Star<TurnedShift<S>>& phi, const Compliance<S>& Omega) {
  const Shift<S> shift{phi.map.l};
  return turned(transpose(phi.map.R), carried(shift.T(), Omega));
}

/// phi* Omega phi, written in this order: phi.T() * Omega waits for phi.
template <ShiftMap Phi, Field S>
struct ShiftCompliance {
  const Phi& phi;
  const Compliance<S>& Omega;
};
template <ShiftMap Phi, Field S>
constexpr ShiftCompliance<Phi, S> operator*(const Star<Phi>& phi, const Compliance<S>& Omega) {
  return {phi.map, Omega};
}
template <ShiftMap Phi, Field S>
constexpr Compliance<S> operator*(const ShiftCompliance<Phi, S>& left, const Phi& phi) {
  return carried(phi.T(), left.Omega);
}

/// Rigid-body inertia M(k) (20) about O(k): second moment I, first moment m p, mass.
template <Field S>
struct RigidInertia {
  Sym3<S> I;   // kg m^2, about O(k)
  Vec3<S> mp;  // kg m
  S m = S(0);  // kg
};
template <Field S>
constexpr Inertia<S> operator+(const Inertia<S>& P, const RigidInertia<S>& M) {
  return {P.J + M.I, plus_skew(P.B, M.mp), plus_diagonal(P.A, M.m)};
}
template <Field S>
constexpr RigidInertia<S> operator-(const RigidInertia<S>& M) {
  return {-M.I, -M.mp, -M.m};
}
template <Field S>
constexpr Vec<Force, S> operator*(const RigidInertia<S>& M, const Vec<Motion, S>& V) {
  return {M.I * V.ang + cross(M.mp, V.lin), V.lin * M.m + cross(V.ang, M.mp)};
}

}  // namespace osculate
