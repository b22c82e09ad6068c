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
//  - the P update carries the armature term K J K* (J: reflected motor inertia); K = phi G is (32);
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

/// Everything the sweeps leave behind at link k. 0 is the tip point, n+1 the base.
template <class H>
struct Pass {
  using S = typename H::Scalar;
  using Coordinate = typename H::Coordinate;
  Vec<Motion, S> V, a;            // velocity, bias acceleration
  Vec<Force, S> b;                // bias force
  Inertia<S> P;                   // articulated inertia
  typename H::JointInertia D;     // its projection on the joint axes, plus armature
  typename H::Gain G, K;          // G(k), K(k+1,k)
  Psi<H> psi;                     // psi(k+1,k)
  Vec<Force, S> z;                // articulated bias force
  Vec<Motion, S> xi, eta, eta_g;  // (66), (67), (73)
  Compliance<S> Omega;            // (58)
  Vec<Force, S> f;                // (39)
  Coordinate T0{}, T{};           // joint torque known beforehand; joint torque of (39)
  Vec<Motion, S> alpha;           // acceleration
  Coordinate thdd{};              // joint acceleration (plant)
};

/// x[0] .. x[n+1], and how often a sweep went along the arm.
template <class H>
struct Passes {
  std::vector<Pass<H>> pass;
  Placement<typename H::Scalar> tip;  // in link frames: pose of the tip, found on the way out
  long sweeps = 0;
  explicit Passes(int n) : pass(static_cast<std::size_t>(n) + 2) {}
  Pass<H>& operator[](int k) { return pass[static_cast<std::size_t>(k)]; }
  const Pass<H>& operator[](int k) const { return pass[static_cast<std::size_t>(k)]; }
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

/// V(k), a(k), b(k) from the next link inward.
template <class H>
void velocity_step(const ArmLink<H>& link, const Pass<H>& in, const typename H::Coordinate& thd, Pass<H>& x) {
  const auto& [phi, Hk, M, J] = link;
  const auto joint = Hk.T() * thd;
  x.V = phi.T() * in.V + seeded(Fault::velocity_joint, joint);  // (41)
  x.a = with_inner_bias(Hk, thd,
                        seeded(Fault::bias_acceleration, bias_acceleration(in.V, phi, joint)));  // (48)
  x.b = seeded(Fault::bias_force, bias_force(M, faulty(Fault::inner_velocity) ? in.V : x.V));    // (47)
}
template <class H>
void velocity_at_tip(const ArmLink<H>& tip, const Pass<H>& in, Pass<H>& x) {
  x.V = tip.phi.T() * in.V;                                   // (41)
  x.a = seeded(Fault::tip_bias, bias_at_tip(in.V, tip.phi));  // (48), k = 0
}

/// P(k), D(k), G(k), K(k+1,k), psi(k+1,k) from the next link outward: one step of (37).
template <class H>
void articulate(const ArmLink<H>& link, const typename H::JointInertia& J_out, const Pass<H>& out,
                Pass<H>& x) {
  const auto& [phi, Hk, M, J] = link;
  auto& P = x.P;
  P = out.psi * out.P * out.psi.T() + seeded(Fault::articulated_armature, out.K * J_out * out.K.T()) +
      seeded(Fault::articulated_mass, M);  // (37)
  if (faulty(Fault::armature_without_gain)) P = P - out.K * J_out * out.K.T();
  x.D = Hk * P * Hk.T() + J;        // (30)
  x.G = P * Hk.T() * inverse(x.D);  // (31)
  x.K = phi * x.G;                  // (32)
  x.psi = phi * (one - x.G * Hk);   // (33)
  if (faulty(Fault::stale_gain)) x.psi = phi * (one - out.G * Hk);
}

/// z(k), xi(k) from the next link outward. abar: a(k), with A of the base added for k = n.
template <class H>
void bias_step(const H& Hk, const Pass<H>& out, const Vec<Motion, typename H::Scalar>& abar, Pass<H>& x) {
  const auto& b = x.b;
  x.z = out.psi * out.z + seeded(Fault::known_torque, out.K * out.T0) +
        seeded(Fault::bias_inertia, x.P * abar) + seeded(Fault::articulated_force, b);  // (66)
  x.xi = Hk.T() * inverse(x.D) * (seeded(Fault::innovation, Hk * x.z) - x.T0) -
         seeded(Fault::innovation_bias, abar);  // (66)
}
/// abar(n): the innermost link also carries what the base does.
template <class H>
Vec<Motion, typename H::Scalar> with_ground(const Vec<Motion, typename H::Scalar>& a, const ArmLink<H>& link,
                                            const Ground<typename H::Scalar>& ground) {
  return a + link.phi.T() * ground.A;  // section 4.3: a(n) + phi*(n+1,n) a_g
}

inline bool carries_ground(int k, int n) { return k == n || faulty(Fault::ground_in_every_link); }

/// Omega(k), eta(k) from the next link inward.
template <class H>
void compliance_step(const H& Hk, const Pass<H>& in, Pass<H>& x) {
  const auto& psi = x.psi;
  x.Omega = psi.T() * in.Omega * psi + seeded(Fault::compliance_joint, Hk.T() * inverse(x.D) * Hk);  // (58)
  x.eta = psi.T() * in.eta + seeded(Fault::compliance_bias, x.xi);                                   // (67)
}
/// a_g: in the axes of x.
template <class H>
void compliance_at_tip(const ArmLink<H>& tip, const Pass<H>& in, const Vec<Motion, typename H::Scalar>& a_g,
                       Pass<H>& x) {
  const auto& phi = tip.phi;           // phi(1,0)
  x.Omega = phi.T() * in.Omega * phi;  // (60)
  x.eta = phi.T() * in.eta - seeded(Fault::tip_right_side, x.a) +
          seeded(Fault::tip_gravity, a_g);  // (68), corrected
  if (faulty(Fault::printed_4_3)) x.eta = x.eta - a_g;
}

/// f(k), T(k) from the next link outward. phi_out: phi(k,k-1).
template <class H>
void torque_step(const ArmLink<H>& link, const typename H::Shift& phi_out, const Pass<H>& out, Pass<H>& x) {
  const auto& phi = faulty(Fault::torque_next_shift) ? link.phi : phi_out;
  x.f = phi * seeded(Fault::torque_shift, out.f);  // (39)
  x.T = link.hinge * x.f;                          // (39)
}

/// Sweep 1, base -> tip: velocities and the biases that depend on them.
template <class H, class Rates>
void sweep_velocities(const BasicArm<H>& arm, const Rates& thd, const Ground<typename H::Scalar>& ground,
                      Passes<H>& x) {
  ++x.sweeps;
  x.tip = arm.base;
  x[arm.n() + 1].V = ground.V;
  for (int k = arm.n(); k >= 1; --k) {
    velocity_step(arm[k], x[k + 1], thd[k], x[k]);
    x.tip = x.tip * arm[k].phi;
  }
  velocity_at_tip(arm[0], x[1], x[0]);
  x.tip = x.tip * arm[0].phi;
}

/// Start of sweep 2. F_ext: external wrench on the tip, about the tip point.
template <class H>
void begin_articulation(const BasicArm<H>& arm, const Vec<Force, typename H::Scalar>& F_ext, Pass<H>& tip) {
  tip.P = {};
  tip.K = {};
  tip.psi = {arm[0].phi, {}, {}};  // psi(1,0) = phi(1,0)
  tip.z = seeded(Fault::tip_wrench, -F_ext);
  tip.T0 = {};
}

/// Sweep 2, tip -> base: articulated inertia, and the bias carried through it. Reads x[k].T0.
template <class H>
void sweep_articulated(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                       const Vec<Force, typename H::Scalar>& F_ext, Passes<H>& x) {
  ++x.sweeps;
  const int n = arm.n();
  begin_articulation(arm, F_ext, x[0]);
  for (int k = 1; k <= n; ++k) {
    articulate(arm[k], arm[k - 1].J, x[k - 1], x[k]);  // (37)
    bias_step(arm[k].hinge, x[k - 1], carries_ground(k, n) ? with_ground(x[k].a, arm[k], ground) : x[k].a,
              x[k]);  // (66)
  }
}

/// Sweep 3, base -> tip: Omega(0), and the right side of Omega(0) (c + g) = x[0].eta (c alone when a_g = 0).
/// a_g: in the axes of the tip.
template <class H>
void sweep_compliance(const BasicArm<H>& arm, const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  ++x.sweeps;
  const int n = arm.n();
  x[n + 1].Omega = {};
  x[n + 1].eta = {};
  for (int k = n; k >= 1; --k) compliance_step(arm[k].hinge, x[k + 1], x[k]);  // (58), (67)
  compliance_at_tip(arm[0], x[1], a_g, x[0]);                                  // (60), (68)
}

/// Base -> tip: the right side of Omega(0) g = x[0].eta_g, from psi alone. x[k].alpha is the alpha of (73).
template <class H>
void sweep_gravity(const BasicArm<H>& arm, const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  ++x.sweeps;
  const int n = arm.n();
  x[n + 1].alpha = a_g;                                // (73)
  x[n + 1].eta_g = seeded(Fault::gravity_start, a_g);  // (73)
  for (int k = n; k >= 1; --k) {
    const auto& psi = x[k].psi;
    x[k].alpha = arm[k].phi.T() * x[k + 1].alpha;  // (73)
    x[k].eta_g = psi.T() * x[k + 1].eta_g;         // (73)
  }
  x[0].eta_g = arm[0].phi.T() * x[1].alpha - seeded(Fault::gravity_tip, arm[0].phi.T() * x[1].eta_g);  // (74)
}

/// Sweep 4, tip -> base: the tip force F_c becomes joint torques x[k].T = (J* F_c)(k).
template <class H>
void sweep_torques(const BasicArm<H>& arm, const Vec<Force, typename H::Scalar>& F_c, Passes<H>& x) {
  ++x.sweeps;
  x[0].f = F_c;
  for (int k = 1; k <= arm.n(); ++k) torque_step(arm[k], arm[k - 1].phi, x[k - 1], x[k]);  // (39)
}

/// Sweeps 2 and 4 in one, tip -> base: x[k].T from a tip force F_c that is known already.
template <class H>
void sweep_articulated_and_torques(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground,
                                   const Vec<Force, typename H::Scalar>& F_ext,
                                   const Vec<Force, typename H::Scalar>& F_c, Passes<H>& x) {
  ++x.sweeps;
  const int n = arm.n();
  begin_articulation(arm, F_ext, x[0]);
  x[0].f = F_c;
  for (int k = 1; k <= n; ++k) {
    articulate(arm[k], arm[k - 1].J, x[k - 1], x[k]);  // (37)
    bias_step(arm[k].hinge, x[k - 1], carries_ground(k, n) ? with_ground(x[k].a, arm[k], ground) : x[k].a,
              x[k]);                                      // (66)
    torque_step(arm[k], arm[k - 1].phi, x[k - 1], x[k]);  // (39)
  }
}

/// Sweeps 3 and 1 in one, base -> tip: the biases that sweep 2 has used give way to those of this state. The
/// right side uses the old a(0). In link frames only: they alone have phi before this sweep.
template <class H, class Rates>
void sweep_compliance_and_velocities(const BasicArm<H>& arm, const Rates& thd,
                                     const Ground<typename H::Scalar>& ground, Passes<H>& x) {
  ++x.sweeps;
  const int n = arm.n();
  x.tip = arm.base;
  x[n + 1].V = ground.V;
  x[n + 1].Omega = {};
  x[n + 1].eta = {};
  for (int k = n; k >= 1; --k) {
    compliance_step(arm[k].hinge, x[k + 1], x[k]);  // (58), (67)
    velocity_step(arm[k], x[k + 1], thd[k], x[k]);  // (41), (47), (48)
    x.tip = x.tip * arm[k].phi;
  }
  x.tip = x.tip * arm[0].phi;
  compliance_at_tip(arm[0], x[1], seen_from(x.tip, ground.a_g), x[0]);  // (60), (68)
  velocity_at_tip(arm[0], x[1], x[0]);
}

/// After sweeps 1 and 2 (the latter with a ground at rest and the applied torques as T0), base -> tip: joint
/// accelerations x[k].thdd and the tip's acceleration x[0].alpha. This is M^-1 = (1 - H psi K)* D^-1 (1 - H
/// psi K) (51), row by row, O(n). The accelerations x[k].alpha contain a_g; x[0].alpha is the true one.
template <class H>
void sweep_accelerations(const BasicArm<H>& arm, const Ground<typename H::Scalar>& ground, Passes<H>& x) {
  static_assert(!in_link_frames<H>, "the tip's acceleration is wanted in the inertial frame");
  ++x.sweeps;
  const int n = arm.n();
  x[n + 1].alpha = ground.A;
  for (int k = n; k >= 1; --k) {
    const auto& [phi, Hk, M, J] = arm[k];
    auto& [V, a, b, P, D, G, K, psi, z, xi, eta, eta_g, Omega, f, T0, T, alpha, thdd] = x[k];
    const auto carried_on = phi.T() * x[k + 1].alpha;
    const auto innovation =
        inverse(D) * (T0 - seeded(Fault::plant_innovation, Hk * z));            // (51): D^-1 (1 - H psi K)
    thdd = innovation - seeded(Fault::plant_acceleration, G.T() * carried_on);  // (51): (1 - H psi K)*
    alpha = carried_on + Hk.T() * seeded(Fault::plant_joint, thdd) + seeded(Fault::plant_bias, a);
  }
  x[0].alpha = arm[0].phi.T() * x[1].alpha + seeded(Fault::plant_tip_bias, x[0].a) - ground.a_g;  // (8)
}

}  // namespace osculate
