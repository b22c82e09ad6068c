// Recursive operational space control in four sweeps, O(n).
// Kreutz-Delgado, Jain & Rodriguez (1992); equation numbers are theirs.
//
// Links are numbered as in the paper: 1 outermost ... n innermost; n+1 is the fixed base, 0 the tip point.
// Everything is in the base frame, about the joint point O(k), angular part first. `A.T()` is the paper's A*.
// arm[k] holds phi(k+1,k), H(k), M(k), J(k); `in` is the next link inward (k+1), `out` the next outward
// (k-1).
//
// Deviations from the print:
//  - the P update carries the armature term K J K* (J: reflected motor inertia); K = phi G is (32);
//  - gravity enters as section 4.3 says, a(n) -> a(n) + phi*(n+1,n) a_g, and a_g is also added on the right
//  of (68),
//    which the print omits; without it c+g is wrong by exactly Lambda a_g;
//  - joint torques T0 already known (null space, or the plant's own) enter z and xi; T0 = 0 gives the paper's
//  (66);
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
  typename H::JointInertia D;     // its projection on the joint axis, plus armature
  typename H::Gain G, K;          // G(k), K(k+1,k)
  typename H::Psi psi;            // psi(k+1,k)
  Vec<Force, S> z;                // articulated bias force
  Vec<Motion, S> xi, eta, eta_g;  // (66), (67), (73)
  Compliance<S> Omega;            // (58)
  Vec<Force, S> f;                // (39)
  Coordinate T0{}, T{};           // joint torque known beforehand; joint torque of (39)
  Vec<Motion, S> alpha;           // acceleration (plant)
  Coordinate thdd{};              // joint acceleration (plant)
};

/// x[0] .. x[n+1].
template <class H>
struct Passes {
  std::vector<Pass<H>> pass;
  explicit Passes(int n) : pass(static_cast<std::size_t>(n) + 2) {}
  Pass<H>& operator[](int k) { return pass[static_cast<std::size_t>(k)]; }
  const Pass<H>& operator[](int k) const { return pass[static_cast<std::size_t>(k)]; }
};

/// Joint coordinates in the paper's numbering, read from a base-to-tip list.
template <class C>
struct TipFirst {
  const C* base_first;
  int n;
  const C& operator[](int k) const { return base_first[n - k]; }
};

/// a(k) of a joint whose H* is fixed in link k+1 or turns with link k about its own axis: revolute,
/// prismatic, cylindrical. (48), and for sliding joints 2 w(k+1) x v_rel.
template <Field S>
constexpr Vec<Motion, S> bias_acceleration(const Vec<Motion, S>& in, const Shift<S>& phi,
                                           const Vec<Motion, S>& joint) {
  return {cross(in.ang, joint.ang), cross(in.ang, cross(in.ang, phi.l) + joint.lin + joint.lin)};
}

/// b(k) (47), gyroscopic and centrifugal force of a body about O(k).
template <Field S>
constexpr Vec<Force, S> bias_force(const RigidInertia<S>& M, const Vec<Motion, S>& V) {
  return {cross(V.ang, M.I * V.ang), cross(V.ang, cross(V.ang, M.mp))};
}

/// a(0) (48) for k = 0: the tip point is fixed in link 1.
template <Field S>
constexpr Vec<Motion, S> bias_at_tip(const Vec<Motion, S>& V1, const Shift<S>& phi) {
  return {{S(0), S(0), S(0)}, cross(V1.ang, cross(V1.ang, phi.l))};
}

/// Sweep 1, base -> tip: velocities and the biases that depend on them. a_g = 0 leaves gravity out.
template <class H, class Rates>
void sweep_velocities(const BasicArm<H>& arm, const Rates& thd, const Vec<Motion, typename H::Scalar>& a_g,
                      Passes<H>& x) {
  const int n = arm.n();
  x[n + 1].V = {};
  for (int k = n; k >= 1; --k) {
    const auto& [phi, Hk, M, J] = arm[k];
    const auto& in = x[k + 1];
    const auto joint = Hk.T() * thd[k];
    x[k].V = phi.T() * in.V + seeded(Fault::velocity_joint, joint);                  // (41)
    x[k].a = seeded(Fault::bias_acceleration, bias_acceleration(in.V, phi, joint));  // (48)
    x[k].b = seeded(Fault::bias_force, bias_force(M, x[k].V));                       // (47)
  }
  x[n].a = x[n].a + arm[n].phi.T() * a_g;                             // section 4.3
  x[0].V = arm[0].phi.T() * x[1].V;                                   // (41)
  x[0].a = seeded(Fault::tip_bias, bias_at_tip(x[1].V, arm[0].phi));  // (48), k = 0
}

/// P(k), D(k), G(k), K(k+1,k), psi(k+1,k) from the next link outward: one step of (37).
template <class H>
void articulate(const ArmLink<H>& link, const typename H::JointInertia& J_out, const Pass<H>& out,
                Pass<H>& x) {
  const auto& [phi, Hk, M, J] = link;
  auto& P = x.P;
  P = out.psi * out.P * out.psi.T() + seeded(Fault::articulated_armature, out.K * J_out * out.K.T()) +
      seeded(Fault::articulated_mass, M);  // (37)
  x.D = Hk * P * Hk.T() + J;               // (30)
  x.G = P * Hk.T() * inverse(x.D);         // (31)
  x.K = phi * x.G;                         // (32)
  x.psi = phi * (one - x.G * Hk);          // (33)
}

/// Sweep 2, tip -> base: articulated inertia, and the bias carried through it. Reads x[k].T0.
/// F_ext: external wrench on the tip, base frame, about the tip point.
template <class H>
void sweep_articulated(const BasicArm<H>& arm, const Vec<Force, typename H::Scalar>& F_ext, Passes<H>& x) {
  x[0].P = {};
  x[0].K = {};
  x[0].psi = {arm[0].phi, {}, {}};  // psi(1,0) = phi(1,0)
  x[0].z = -F_ext;
  x[0].T0 = {};
  for (int k = 1; k <= arm.n(); ++k) {
    const auto& Hk = arm[k].hinge;
    const auto& out = x[k - 1];
    auto& [V, a, b, P, D, G, K, psi, z, xi, eta, eta_g, Omega, f, T0, T, alpha, thdd] = x[k];
    articulate(arm[k], arm[k - 1].J, out, x[k]);                                         // (37)
    z = out.psi * out.z + out.K * out.T0 + P * a + seeded(Fault::articulated_force, b);  // (66)
    xi = Hk.T() * inverse(D) * (Hk * z - T0) - seeded(Fault::innovation_bias, a);        // (66)
  }
}

/// Sweep 3, base -> tip: Omega(0), and the right side of Omega(0) (c + g) = x[0].eta (c alone when a_g = 0).
template <class H>
void sweep_compliance(const BasicArm<H>& arm, const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  const int n = arm.n();
  x[n + 1].Omega = {};
  x[n + 1].eta = {};
  for (int k = n; k >= 1; --k) {
    const auto& Hk = arm[k].hinge;
    const auto& in = x[k + 1];
    const auto& psi = x[k].psi;
    x[k].Omega =
        psi.T() * in.Omega * psi + seeded(Fault::compliance_joint, Hk.T() * inverse(x[k].D) * Hk);  // (58)
    x[k].eta = psi.T() * in.eta + seeded(Fault::compliance_bias, x[k].xi);                          // (67)
  }
  const auto& phi = arm[0].phi;             // phi(1,0)
  x[0].Omega = phi.T() * x[1].Omega * phi;  // (60)
  x[0].eta = phi.T() * x[1].eta - seeded(Fault::tip_right_side, x[0].a) +
             seeded(Fault::tip_gravity, a_g);  // (68), corrected
}

/// Base -> tip: the right side of Omega(0) g = x[0].eta_g, from psi alone.
template <class H>
void sweep_gravity(const BasicArm<H>& arm, const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  const int n = arm.n();
  // psi(n+1,n) moves from O(n+1); a_g has no angular part, so phi*(i,j) a_g = a_g and alpha(k) = a_g for
  // every k.
  x[n + 1].eta_g = a_g;                                                        // (73)
  for (int k = n; k >= 1; --k) x[k].eta_g = x[k].psi.T() * x[k + 1].eta_g;     // (73)
  x[0].eta_g = a_g - seeded(Fault::gravity_tip, arm[0].phi.T() * x[1].eta_g);  // (74)
}

/// Sweep 4, tip -> base: the tip force F_c becomes joint torques x[k].T = (J* F_c)(k).
template <class H>
void sweep_torques(const BasicArm<H>& arm, const Vec<Force, typename H::Scalar>& F_c, Passes<H>& x) {
  x[0].f = F_c;
  for (int k = 1; k <= arm.n(); ++k) {
    x[k].f = arm[k - 1].phi * seeded(Fault::torque_shift, x[k - 1].f);  // (39)
    x[k].T = arm[k].hinge * x[k].f;                                     // (39)
  }
}

/// After sweeps 1 and 2 with the applied torques as T0, base -> tip: joint accelerations x[k].thdd and the
/// tip's acceleration x[0].alpha. This is M^-1 = (1 - H psi K)* D^-1 (1 - H psi K) (51), row by row, O(n).
/// The accelerations x[k].alpha, k >= 1, contain a_g; x[0].alpha is the true one.
template <class H>
void sweep_accelerations(const BasicArm<H>& arm, const Vec<Motion, typename H::Scalar>& a_g, Passes<H>& x) {
  const int n = arm.n();
  x[n + 1].alpha = {};
  for (int k = n; k >= 1; --k) {
    const auto& [phi, Hk, M, J] = arm[k];
    auto& [V, a, b, P, D, G, K, psi, z, xi, eta, eta_g, Omega, f, T0, T, alpha, thdd] = x[k];
    const auto carried_on = phi.T() * x[k + 1].alpha;
    const auto innovation = inverse(D) * (T0 - Hk * z);                         // (51): D^-1 (1 - H psi K)
    thdd = innovation - seeded(Fault::plant_acceleration, G.T() * carried_on);  // (51): (1 - H psi K)*
    alpha = carried_on + Hk.T() * seeded(Fault::plant_joint, thdd) + a;
  }
  x[0].alpha = arm[0].phi.T() * x[1].alpha + x[0].a - a_g;  // (8)
}

}  // namespace osculate
