// Recursive operational space control in four sweeps, O(n).
// Kreutz-Delgado, Jain & Rodriguez (1992); equation numbers are theirs.
//
// Links are numbered as in the paper: 1 outermost ... n innermost; n+1 is the base, 0 the tip point. Vectors
// of link k are about the joint point O(k), angular part first, all in one inertial frame, or each in the
// axes of its own link (LinkHinge, LinkJoint): the same lines serve both. `A.T()` is the paper's A*.
// arm[k] holds phi(k+1,k), H(k), M(k), J(k); `in` is the next link inward (k+1), `out` the next outward
// (k-1).
//
// Deviations from the print:
//  - the P update is psi P phi*, which is psi P psi* + K J K* (J: reflected motor inertia); as printed, psi P
//  psi*
//    alone, it holds for J = 0 only;
//  - the base may move: V(n+1) starts (41), and A = Vdot(n+1) + a_g is reassigned to a(n) as section 4.3 does
//    with a_g; a_g is also added on the right of (68), which the print omits; without it c+g is wrong by
//    exactly Lambda a_g;
//  - joint torques T0 already known (null space, or the plant's own) enter z and xi; T0 = 0 gives the paper's
//    (66);
//  - the paper's z: F = P (alpha - a) + z. Featherstone's bias force is z - P a: compare accelerations, not
//  z.
#pragma once

#include <vector>

#include "recursion/arm.hpp"

namespace osculate {

/// What one sweep leaves at link k for the next. V, P, z, xi, Omega, eta, f, alpha run along the arm and are
/// not kept; whoever wants to see them gives a sweep a function `see`.
template <class H>
struct Pass {
  using S = typename H::Scalar;
  using Coordinate = typename H::Coordinate;
  Vec<Motion, S> a;    // bias acceleration
  Vec<Force, S> b;     // bias force
  typename H::Gain G;  // (31); G.D: (30), articulated inertia felt by the joint, with armature
  typename H::JointMobility D_inverse;
  Coordinate Hz{};       // H(k) z(k)
  Coordinate T0{}, T{};  // joint torque known beforehand; joint torque of (39)
};

/// x[1] .. x[n], what the sweeps find at the tip, and how often one went along the arm.
template <class H>
struct Passes {
  using S = typename H::Scalar;
  std::vector<Pass<H>> pass;
  Vec<Motion, S> V0, a0;        // V(0), a(0)
  Compliance<S> Omega0;         // Omega(0) (60)
  Vec<Motion, S> eta0, eta_g0;  // right sides of (65) and (72)
  Vec<Motion, S> alpha0;        // acceleration of the tip
  Placement<S> tip;             // in link frames: pose of the tip, found on the way out
  long sweeps = 0;
  explicit Passes(int n) : pass(static_cast<std::size_t>(n) + 1) {}
  Pass<H>& operator[](int k) { return pass[static_cast<std::size_t>(k)]; }
  const Pass<H>& operator[](int k) const { return pass[static_cast<std::size_t>(k)]; }
};

/// Looks at nothing.
struct Unseen {
  template <class... Values>
  constexpr void operator()(int, const Values&...) const {}
};

/// a(k) of a joint whose H* is fixed in link k+1 or turns with link k about its own axes: all but universal.
/// (48), and for sliding joints 2 w(k+1) x v_rel. w: angular velocity of link k+1, w_out: that of link k.
template <ShiftMap Phi, Field S>
constexpr Vec<Motion, S> bias_acceleration(const Vec<Motion, S>& in, const Phi& phi,
                                           const Vec<Motion, S>& joint) {
  const Vec3<S> w = in_outer_axes(phi, in.ang), l = in_outer_axes(phi, phi.l);
  const Vec3<S> v = faulty(Fault::coriolis_once) ? joint.lin : joint.lin + joint.lin;
  const Vec3<S> carried_on = faulty(Fault::outer_rate) ? cross(w + joint.ang, l) : cross(w, l);
  return {seeded(Fault::bias_turn, cross(w, joint.ang)), cross(w, carried_on + v)};
}

/// b(k) (47), gyroscopic and centrifugal force of a body about O(k).
template <Field S>
constexpr Vec<Force, S> bias_force(const RigidInertia<S>& M, const Vec<Motion, S>& V) {
  return {seeded(Fault::gyroscopic, cross(V.ang, M.I * V.ang)),
          seeded(Fault::centrifugal, cross(V.ang, cross(V.ang, M.mp)))};
}

/// a(0) (48) for k = 0: the tip point is fixed in link 1.
template <ShiftMap Phi, Field S>
constexpr Vec<Motion, S> bias_at_tip(const Vec<Motion, S>& V1, const Phi& phi) {
  const Vec3<S> w = in_outer_axes(phi, V1.ang), l = in_outer_axes(phi, phi.l);
  return {{S(0), S(0), S(0)}, cross(w, cross(w, l))};
}

/// V(k), a(k), b(k) from the next link inward. V: V(k+1), becomes V(k).
template <class H>
constexpr void velocity_step(const ArmLink<H>& link, const H& Hk, const typename H::Coordinate& thd,
                             Vec<Motion, typename H::Scalar>& V, Pass<H>& x) {
  const auto& phi = link.phi;
  const auto& M = link.M;
  const auto in = V;
  const auto joint = Hk.T() * thd;
  V = star_as_sum(phi, in) + seeded(Fault::velocity_joint, joint);  // (41): phi* V(k+1) + H* thd
  x.a =
      with_inner_bias(Hk, thd, seeded(Fault::bias_acceleration, bias_acceleration(in, phi, joint)));  // (48)
  x.b = seeded(Fault::bias_force, bias_force(M, faulty(Fault::inner_velocity) ? in : V));             // (47)
}
template <class H>
constexpr void velocity_at_tip(const ArmLink<H>& tip, const Vec<Motion, typename H::Scalar>& V,
                               Passes<H>& x) {
  x.V0 = tip.phi.T() * V;                                   // (41)
  x.a0 = seeded(Fault::tip_bias, bias_at_tip(V, tip.phi));  // (48), k = 0
}

/// psi(k+1,k) (33), after articulate.
template <class H>
constexpr Psi<H> psi_of(const BasicArm<H>& arm, const H& Hk, const Passes<H>& x, int k) {
  const auto& G = faulty(Fault::stale_gain) ? x[k - 1].G : x[k].G;
  return arm[k].phi * (one - G * Hk);
}

/// D(k), G(k). P: what comes from link k-1, becomes P(k).
template <class H>
constexpr void articulate(const ArmLink<H>& link, const H& Hk, Inertia<typename H::Scalar>& P, Pass<H>& x) {
  P = P + seeded(Fault::articulated_mass, link.M);  // (37)
  const auto D = Hk * P * Hk.T() + link.J;          // (30)
  x.D_inverse = inverse(D);
  x.G = P * Hk.T() * x.D_inverse;  // (31)
  x.G.D = D;
}
/// P(k) as link k+1 feels it.
template <class H>
constexpr void carry_inertia(const ArmLink<H>& link, const Pass<H>& x, const Psi<H>& psi,
                             Inertia<typename H::Scalar>& P) {
  P = psi * P * link.phi.T();  // (37): psi P psi* + K J K*
  if (!faulty(Fault::armature_without_gain) && !faulty(Fault::articulated_armature)) return;
  const auto K = link.phi * x.G;  // (32)
  P = P - K * link.J * K.T();     // as printed
  if (faulty(Fault::articulated_armature)) P = P - K * link.J * K.T();
}

/// a(k), to which the innermost link adds what the base does.
template <class H>
constexpr Vec<Motion, typename H::Scalar> bias_with_ground(const BasicArm<H>& arm, const Passes<H>& moved,
                                                           int k, const Ground<typename H::Scalar>& ground) {
  if (k != arm.n() && !faulty(Fault::ground_in_every_link)) return moved[k].a;
  return moved[k].a + arm[k].phi.T() * ground.A;  // section 4.3: a(n) + phi*(n+1,n) a_g
}

/// z: what comes from link k-1, becomes what link k+1 feels of z(k). P: P(k). abar: bias_with_ground.
template <class H, class See>
constexpr void bias_step(const Inertia<typename H::Scalar>& P, const Psi<H>& psi,
                         const Vec<Motion, typename H::Scalar>& abar, const Vec<Force, typename H::Scalar>& b,
                         Pass<H>& x, Vec<Force, typename H::Scalar>& z, const See& see_z) {
  const auto& [phi, G, Hk] = psi;
  z = z + seeded(Fault::bias_inertia, P * abar) + seeded(Fault::articulated_force, b);  // (66)
  see_z(z);
  x.Hz = Hk * z;
  const auto T0 = seeded(Fault::known_torque, x.T0);
  if (faulty(Fault::psi_order))
    z = psi * z + phi * (x.G * T0);
  else
    z = phi * (z - G * (x.Hz - T0));  // (66): psi z + K T0
}

/// xi(k) (66).
template <class H>
constexpr Vec<Motion, typename H::Scalar> innovation_step(const H& Hk, const Pass<H>& x,
                                                          const Vec<Motion, typename H::Scalar>& abar) {
  return Hk.T() * x.D_inverse * (seeded(Fault::innovation, x.Hz) - x.T0) -
         seeded(Fault::innovation_bias, abar);
}
/// Omega(n), eta(n): Omega(n+1) = 0 and eta(n+1) = 0.
template <class H, class See>
constexpr void compliance_at_base(const BasicArm<H>& arm, const H& Hn, const Passes<H>& x,
                                  const Ground<typename H::Scalar>& ground,
                                  Compliance<typename H::Scalar>& Omega, Vec<Motion, typename H::Scalar>& eta,
                                  const See& see) {
  const auto& xn = x[arm.n()];
  const auto xi = innovation_step(Hn, xn, bias_with_ground(arm, x, arm.n(), ground));  // (66)
  Omega = seeded(Fault::compliance_joint, Hn.T() * xn.D_inverse * Hn);                 // (58)
  eta = seeded(Fault::compliance_bias, xi);                                            // (67)
  see(arm.n(), Omega, eta, xi);
}
/// Omega(k), eta(k) from the next link inward, k < n.
template <class H, class See>
constexpr void compliance_step(const BasicArm<H>& arm, const H& Hk, const Passes<H>& x, int k,
                               const Ground<typename H::Scalar>& ground,
                               Compliance<typename H::Scalar>& Omega, Vec<Motion, typename H::Scalar>& eta,
                               const See& see) {
  const auto psi = psi_of(arm, Hk, x, k);
  Omega = psi.T() * Omega * psi + seeded(Fault::compliance_joint, Hk.T() * x[k].D_inverse * Hk);  // (58)
  const auto xi = innovation_step(Hk, x[k], bias_with_ground(arm, x, k, ground));                 // (66)
  eta = psi.T() * eta + seeded(Fault::compliance_bias, xi);                                       // (67)
  see(k, Omega, eta, xi);
}
/// eta: eta(1). a_g: in the axes of the tip.
template <class H>
constexpr void right_side_at_tip(const ArmLink<H>& tip, const Vec<Motion, typename H::Scalar>& a_g,
                                 const Vec<Motion, typename H::Scalar>& eta, Passes<H>& x) {
  x.eta0 = tip.phi.T() * eta - seeded(Fault::tip_right_side, x.a0) +
           seeded(Fault::tip_gravity, a_g);  // (68), corrected
  if (faulty(Fault::printed_4_3)) x.eta0 = x.eta0 - a_g;
}
/// a_g: in the axes of the tip.
template <class H>
constexpr void compliance_at_tip(const ArmLink<H>& tip, const Vec<Motion, typename H::Scalar>& a_g,
                                 const Compliance<typename H::Scalar>& Omega,
                                 const Vec<Motion, typename H::Scalar>& eta, Passes<H>& x) {
  const auto& phi = tip.phi;            // phi(1,0)
  x.Omega0 = phi.T() * Omega * phi;     // (60)
  right_side_at_tip(tip, a_g, eta, x);  // (68)
}

/// alpha: of link k+1, becomes that of link k, and eta likewise.
template <class H>
constexpr void gravity_step(const BasicArm<H>& arm, int k, const Passes<H>& x,
                            Vec<Motion, typename H::Scalar>& alpha, Vec<Motion, typename H::Scalar>& eta) {
  alpha = arm[k].phi.T() * alpha;                   // (73)
  eta = psi_of(arm, arm[k].hinge, x, k).T() * eta;  // (73)
}
template <class H>
constexpr void gravity_at_tip(const ArmLink<H>& tip, const Vec<Motion, typename H::Scalar>& alpha,
                              const Vec<Motion, typename H::Scalar>& eta, Passes<H>& x) {
  x.eta_g0 = tip.phi.T() * alpha - seeded(Fault::gravity_tip, tip.phi.T() * eta);  // (74)
}

/// T(k). f: f(k-1), becomes f(k).
template <class H>
constexpr void torque_step(const BasicArm<H>& arm, const H& Hk, int k, Vec<Force, typename H::Scalar>& f,
                           Pass<H>& x) {
  const auto& phi = arm[faulty(Fault::torque_next_shift) ? k : k - 1].phi;
  f = phi * seeded(Fault::torque_shift, f);  // (39)
  x.T = Hk * f;                              // (39)
}

/// Sweep 1, base -> tip: velocities and the biases that depend on them. see(k, V(k)).
template <class H, class Rates, class See = Unseen>
void sweep_velocities(const BasicArm<H>& arm, const Rates& thd, const Ground<typename H::Scalar>& ground,
                      Passes<H>& x, const See& see = {}) {
  ++x.sweeps;
  if constexpr (in_link_frames<H>) x.tip = arm.base;
  auto V = ground.V;
  outward(arm, arm.n(), [&](int k, const H& Hk) {
    velocity_step(arm[k], Hk, thd[k], V, x[k]);
    see(k, V);
    if constexpr (in_link_frames<H>) x.tip = x.tip * arm[k].phi;
  });
  velocity_at_tip(arm[0], V, x);
  if constexpr (in_link_frames<H>) x.tip = x.tip * arm[0].phi;
}

/// Sweep 2, tip -> base: articulated inertia, and the bias carried through it. Reads x[k].T0. F_ext: external
/// wrench on the tip, about the tip point. moved: where sweep 1 has left a and b, x itself as a rule. see(k,
/// P(k), z(k)).
template <class H, class See = Unseen>
void sweep_articulated(const BasicArm<H>& arm, const Passes<H>& moved,
                       const Ground<typename H::Scalar>& ground, const Vec<Force, typename H::Scalar>& F_ext,
                       Passes<H>& x, const See& see = {}) {
  ++x.sweeps;
  Inertia<typename H::Scalar> P;
  auto z = arm[0].phi * seeded(Fault::tip_wrench, -F_ext);  // z(0) = -F_ext
  inward(arm, [&](int k, const H& Hk) {
    articulate(arm[k], Hk, P, x[k]);  // (37), (30), (31)
    const auto psi = psi_of(arm, Hk, x, k);
    bias_step(P, psi, bias_with_ground(arm, moved, k, ground), moved[k].b, x[k], z,
              [&](const auto& at_k) { see(k, P, at_k); });  // (66)
    carry_inertia(arm[k], x[k], psi, P);                    // (37)
  });
}

/// Sweep 3, base -> tip: Omega(0), and the right side of Omega(0) (c + g) = eta0 (c alone when a_g = 0 and
/// the base does not accelerate). a_g: in the axes of the tip. see(k, Omega(k), eta(k), xi(k)).
template <class H, class See = Unseen>
void sweep_compliance(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                      const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x, const See& see = {}) {
  ++x.sweeps;
  Compliance<typename H::Scalar> Omega;
  Vec<Motion, typename H::Scalar> eta;
  compliance_at_base(arm, arm[arm.n()].hinge, x, ground, Omega, eta, see);
  outward(arm, arm.n() - 1, [&](int k, const H& Hk) {
    compliance_step(arm, Hk, x, k, ground, Omega, eta, see);  // (58), (67)
  });
  compliance_at_tip(arm[0], a_g, Omega, eta, x);  // (60), (68)
}

/// Sweep 3 for the right side alone: eta0, where Omega(0) of these links is known already.
template <class H>
void sweep_right_side(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                      const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  ++x.sweeps;
  Vec<Motion, typename H::Scalar> eta;
  outward(arm, arm.n(), [&](int k, const H& Hk) {
    const auto xi = innovation_step(Hk, x[k], bias_with_ground(arm, x, k, ground));  // (66)
    eta = psi_of(arm, Hk, x, k).T() * eta + seeded(Fault::compliance_bias, xi);      // (67)
  });
  right_side_at_tip(arm[0], a_g, eta, x);  // (68)
}

/// Instead of sweep 3, after sweep 2, tip -> base: the same Omega(0) and eta0, summed over the links while
/// six unit forces on the tip are carried inward by psi. Fewer steps that wait for each other; in one frame
/// only.
template <class H>
void sweep_columns(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                   const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  static_assert(!in_link_frames<H>, "between link frames the columns would have to be turned");
  ++x.sweeps;
  TipMobility<typename H::Scalar> Omega;
  SixRow<typename H::Scalar> eta;
  auto X = tip_columns(arm[0].phi);  // X(1) = phi(1,0)
  inward(arm, [&](int k, const H& Hk) {
    const auto abar = bias_with_ground(arm, x, k, ground);
    const auto E = Hk * X;
    Omega = Omega + E.T() * x[k].D_inverse * E;                                 // (58), (60)
    eta = eta + E.T() * (x[k].D_inverse * (x[k].Hz - x[k].T0)) - X.T() * abar;  // (66), (67)
    X = arm[k].phi * (X - x[k].G * E);                                          // psi X
  });
  x.Omega0 = compliance_of(Omega);
  x.eta0 = motion_of(eta) - x.a0 + a_g;  // (68), corrected
}

/// Base -> tip: the right side of Omega(0) g = eta_g0, from psi alone. see(k, eta(k)), the eta of (73).
template <class H, class See = Unseen>
void sweep_gravity(const BasicArm<H>& arm, const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x,
                   const See& see = {}) {
  ++x.sweeps;
  auto alpha = a_g;                              // (73)
  auto eta = seeded(Fault::gravity_start, a_g);  // (73)
  for (int k = arm.n(); k >= 1; --k) {
    gravity_step(arm, k, x, alpha, eta);  // (73)
    see(k, eta);
  }
  gravity_at_tip(arm[0], alpha, eta, x);  // (74)
}

/// Sweeps 3 and that of gravity in one, base -> tip: Omega(0), eta0 and eta_g0 from one reading of psi. In
/// one frame only.
template <class H>
void sweep_compliance_and_gravity(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                                  Passes<H>& x) {
  static_assert(!in_link_frames<H>, "gravity would be wanted in the axes of the base and of the tip");
  auto alpha = ground.a_g;                                // (73)
  auto eta_g = seeded(Fault::gravity_start, ground.a_g);  // (73)
  sweep_compliance(arm, ground, ground.a_g, x, [&](int k, const auto&...) {
    gravity_step(arm, k, x, alpha, eta_g);
  });                                       // (58), (67), (73)
  gravity_at_tip(arm[0], alpha, eta_g, x);  // (74)
}

/// Sweep 4, tip -> base: the tip force F_c becomes joint torques x[k].T = (J* F_c)(k). see(k, x[k].T).
template <class H, class See = Unseen>
void sweep_torques(const BasicArm<H>& arm, const Vec<Force, typename H::Scalar>& F_c, Passes<H>& x,
                   const See& see = {}) {
  ++x.sweeps;
  auto f = F_c;
  inward(arm, [&](int k, const H& Hk) {
    torque_step(arm, Hk, k, f, x[k]);  // (39)
    see(k, x[k].T);
  });
}

/// Sweeps 2 and 4 in one, tip -> base: x[k].T from a tip force F_c that is known already.
template <class H>
void sweep_articulated_and_torques(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                                   const Vec<Force, typename H::Scalar>& F_ext,
                                   const Vec<Force, typename H::Scalar>& F_c, Passes<H>& x) {
  auto f = F_c;
  sweep_articulated(arm, x, ground, F_ext, x,
                    [&](int k, const auto&...) { torque_step(arm, arm[k].hinge, k, f, x[k]); });  // (39)
}

/// Sweeps 3 and 1 in one, base -> tip: the biases that sweep 2 has used give way to those of this state. The
/// right side uses the old a(0). In link frames only: they alone have phi before this sweep.
template <class H, class Rates>
void sweep_compliance_and_velocities(const BasicArm<H>& arm, const Rates& thd,
                                     const Ground<typename H::Scalar>& ground, Passes<H>& x) {
  ++x.sweeps;
  if constexpr (in_link_frames<H>) x.tip = arm.base;
  auto V = ground.V;
  Compliance<typename H::Scalar> Omega;
  Vec<Motion, typename H::Scalar> eta;
  for (int k = arm.n(); k >= 1; --k) {
    if (k == arm.n())
      compliance_at_base(arm, arm[k].hinge, x, ground, Omega, eta, Unseen());  // (58), (67)
    else
      compliance_step(arm, arm[k].hinge, x, k, ground, Omega, eta, Unseen());  // (58), (67)
    velocity_step(arm[k], arm[k].hinge, thd[k], V, x[k]);                      // (41), (47), (48)
    if constexpr (in_link_frames<H>) x.tip = x.tip * arm[k].phi;
  }
  if constexpr (in_link_frames<H>) x.tip = x.tip * arm[0].phi;
  compliance_at_tip(arm[0], seen_from(x.tip, ground.a_g), Omega, eta, x);  // (60), (68)
  velocity_at_tip(arm[0], V, x);
}

/// After sweeps 1 and 2 (the latter with a ground at rest and the applied torques as T0), base -> tip: joint
/// accelerations thdd and the tip's acceleration alpha0. This is M^-1 = (1 - H psi K)* D^-1 (1 - H
/// psi K) (51), row by row, O(n). alpha(k) contains a_g; alpha0 is the true one. moved: as for sweep 2.
/// see(k, thdd(k)).
template <class H, class See = Unseen>
void sweep_accelerations(const BasicArm<H>& arm, const Passes<H>& moved,
                         const Ground<typename H::Scalar>& ground, Passes<H>& x, const See& see = {}) {
  static_assert(!in_link_frames<H>, "the tip's acceleration is wanted in the inertial frame");
  ++x.sweeps;
  auto alpha = ground.A;
  outward(arm, arm.n(), [&](int k, const H& Hk) {
    const auto& [own_a, own_b, G, D_inverse, Hz, T0, T] = x[k];
    alpha = arm[k].phi.T() * alpha;
    const auto innovation =
        D_inverse * (T0 - seeded(Fault::plant_innovation, Hz));  // (51): D^-1 (1 - H psi K)
    const auto thdd = innovation - seeded(Fault::plant_acceleration, G.T() * alpha);  // (51): (1 - H psi K)*
    alpha = alpha + Hk.T() * seeded(Fault::plant_joint, thdd) + seeded(Fault::plant_bias, moved[k].a);
    see(k, thdd);
  });
  x.alpha0 = arm[0].phi.T() * alpha + seeded(Fault::plant_tip_bias, moved.a0) - ground.a_g;  // (8)
}

}  // namespace osculate
