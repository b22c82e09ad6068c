// The identities of the paper: those of dynamics and operational space, (38) to (51) and (60) to (72), each a
// function that returns its two sides; and the table of all, with those of operator_relations.hpp.
// Kreutz-Delgado, Jain & Rodriguez (1992); where the printed form is wrong the corrected one stands here, and
// the printed one in `printed_errors`. Each holds for joints of any type, motor inertia and a moving base.
// The paper's loops, (37), (39), (58), (66) to (68), (73) and (74), are these, link by link.
//
// Lambda(0), which exists at full rank only, is multiplied out: (62), (64), (69) to (71) are stated for
// Omega(0) c(0) = J M^-1 C - Jdot thd and Omega(0) g(0) = J M^-1 G, which exist at any rank.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/operator_relations.hpp"

namespace osculate::dense {

/// max |left - right| over the largest magnitude of the terms that were added up to make the two sides (see
/// Operator): some eps where the identity holds in floating point. Exact scalars: max |left - right|, exactly
/// 0 where it holds. Infinite where the shapes differ.
template <Field S>
double residual(const Sides<S>& sides) {
  const auto& [left, right] = sides;
  if (left.rows() != right.rows() || left.cols() != right.cols())
    return std::numeric_limits<double>::infinity();
  if constexpr (std::floating_point<S>) {
    const S largest = (left.size + right.size).template maxCoeff<Eigen::PropagateNaN>();
    const S error = (left.value - right.value).cwiseAbs().template maxCoeff<Eigen::PropagateNaN>();
    return static_cast<double>(error == S(0) ? error : error / largest);
  } else {
    double worst = 0;
    for (Eigen::Index i = 0; i < left.rows(); ++i)
      for (Eigen::Index j = 0; j < left.cols(); ++j) {
        if (left.value(i, j) == right.value(i, j)) continue;
        const double d = std::abs(static_cast<double>(S(left.value(i, j) - right.value(i, j))));
        worst = std::max({worst, d, std::numeric_limits<double>::min()});
      }
    return worst;
  }
}

// Dynamics: (38) to (51).

template <Field S>
Sides<S> jacobian(const Operators<S>& x) {
  return {x.dense.J.T(), x.H * x.phi * x.B};
}
template <Field S>
Sides<S> tip_velocity(const Operators<S>& x) {
  return {x.dense.V_tip, x.B.T() * (x.phi.T() * (x.H.T() * x.thd + x.E.T() * x.V_base))};
}
template <Field S>
Sides<S> link_velocities(const Operators<S>& x) {
  return {x.dense.V, x.phi.T() * (x.H.T() * x.thd + x.E.T() * x.V_base)};
}
template <Field S>
Sides<S> velocity_step(const Operators<S>& x) {
  return {x.dense.V, x.E_phi.T() * x.dense.V + x.H.T() * x.thd + x.E.T() * x.V_base};
}
template <Field S>
Sides<S> newton_euler_factors(const Operators<S>& x) {
  return {x.dense.M, x.H * x.phi * x.M * x.phi.T() * x.H.T() + x.Jm};
}
template <Field S>
Sides<S> coriolis(const Operators<S>& x) {
  return {x.dense.C, x.H * (x.phi * (x.M * (x.phi.T() * x.a) + x.b))};
}
template <Field S>
Sides<S> weight(const Operators<S>& x) {
  return {x.dense.G, x.H * (x.phi * (x.M * (x.phi.T() * (x.E.T() * x.a_g))))};
}
template <Field S>
Sides<S> coriolis_and_weight(const Operators<S>& x) {
  const Operator<S> a_bar = x.a + x.E.T() * x.a_g;
  return {x.dense.C + x.dense.G, x.H * (x.phi * (x.M * (x.phi.T() * a_bar) + x.b))};
}
template <Field S>
Sides<S> tip_bias(const Operators<S>& x) {
  return {x.dense.Jdot_qd, x.B.T() * (x.phi.T() * x.a) + x.a_tip};
}
/// b(k) = (w x I w; m w x (w x p)).
template <Field S>
Sides<S> bias_force(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  for (int k = 1; k <= x.n; ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const Operator<S> w = x.dense.V.block(6 * (k - 1), 0, 3, 1),
                      I = x.link_block(x.M, k, k).block(0, 0, 3, 3);
    const Vector3<S> spin = w.value, mp = x.mass[i] * x.p[i];
    pieces.push_back({6 * (k - 1), 0, internal::cross(spin, I * w)});
    pieces.push_back({6 * (k - 1) + 3, 0, internal::cross(spin, internal::cross(spin, Operator<S>(mp)))});
  }
  return {x.b, internal::assembled(6 * x.n, 1, pieces)};
}
/// With s = H* thd and w = w(k+1): a(k) = (w x s_w; w x (w x l) + 2 w x s_v). A universal joint adds the turn
/// of its second axis by its first; a moving base adds its acceleration to a(n).
template <Field S>
Sides<S> bias_acceleration(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  const Operator<S> joint = x.H.T() * x.thd;
  for (int k = 1; k <= x.n; ++k) {
    const int o = 6 * (k - 1);
    const Vector3<S> w = (k == x.n ? x.V_base.value : x.dense.V.value.middleRows(o + 6, 6)).topRows(3);
    const Vector3<S> l = x.O[static_cast<std::size_t>(k)] - x.O[static_cast<std::size_t>(k + 1)];
    const Operator<S> s_v = joint.block(o + 3, 0, 3, 1);
    Operator<S> angular = internal::cross(w, joint.block(o, 0, 3, 1));
    Operator<S> linear = internal::cross(w, internal::cross(w, Operator<S>(l)) + s_v + s_v);
    if (x.type[static_cast<std::size_t>(k - 1)] == JointType::universal) {
      const MatrixX<S> axes = x.H_block(k).value.leftCols(3).transpose();
      const Vector3<S> first = axes.col(0) * x.thd.value(x.first(k), 0);
      const Vector3<S> second = axes.col(1) * x.thd.value(x.first(k) + 1, 0);
      angular = angular + internal::cross(first, Operator<S>(second));
    }
    pieces.push_back({o, 0, angular});
    pieces.push_back({o + 3, 0, linear});
  }
  return {x.a, internal::assembled(6 * x.n, 1, pieces) + x.E.T() * x.A_base};
}
template <Field S>
Sides<S> innovations_factors(const Operators<S>& x) {
  const Operator<S> factor = internal::one_joints(x) + x.H * x.phi * x.K;
  return {x.dense.M, factor * x.D * factor.T()};
}
template <Field S>
Sides<S> innovations_inverse(const Operators<S>& x) {
  return {(internal::one_joints(x) + x.H * x.phi * x.K) * (internal::one_joints(x) - x.H * x.psi * x.K),
          internal::one_joints(x)};
}
template <Field S>
Sides<S> mass_inverse(const Operators<S>& x) {
  const Operator<S> factor = internal::one_joints(x) - x.H * x.psi * x.K;
  return {x.dense.M_inv, factor.T() * x.D_inv * factor};
}

// Operational space: (60) to (72).

template <Field S>
Sides<S> tip_compliance_long(const Operators<S>& x) {
  return {internal::Omega_tip(x), x.B.T() * internal::psi_HD(x) * (internal::H_psi(x) * x.B)};
}
template <Field S>
Sides<S> tip_compliance(const Operators<S>& x) {
  return {internal::Omega_tip(x), x.B.T() * x.Omega * x.B};
}
template <Field S>
Sides<S> tip_inertia(const Operators<S>& x) {
  const MatrixX<S> Omega = internal::Omega_tip(x).value;
  return {inverse(Operator<S>(Omega)) * (x.B.T() * x.Omega * x.B), one<S>(6)};
}
template <Field S>
Sides<S> coriolis_at_tip(const Operators<S>& x) {
  const Operator<S> phi_a = x.phi.T() * x.a;
  return {internal::Omega_c(x), x.B.T() * internal::psi_HD(x) * (internal::H_psi(x) * (x.M * phi_a + x.b)) -
                                    x.B.T() * phi_a - x.a_tip};
}
template <Field S>
Sides<S> response_to_inertia(const Operators<S>& x) {
  const Operator<S> left = internal::psi_HD(x), right = internal::H_psi(x);
  return {left * (right * x.M * x.phi.T()), left * (right * x.P) + x.phi.T() - x.psi.T()};
}
/// What turns one line of (63) into the next.
template <Field S>
Sides<S> response_step(const Operators<S>& x) {
  return {x.D_inv * x.H * x.P * internal::less_one(x.phi).T(), x.K.T() * x.phi.T()};
}
/// The right side of (65) for given biases of the joints.
template <Field S>
Operator<S> coriolis_right_side(const Operators<S>& x, const Operator<S>& a) {
  const Operator<S> z = x.psi * (x.P * a + x.b);
  return x.B.T() * (x.psi.T() * (internal::HDH(x) * z - a)) - x.a_tip;
}
template <Field S>
Sides<S> coriolis_at_tip_short(const Operators<S>& x) {
  return {internal::Omega_c(x), coriolis_right_side(x, x.a)};
}
template <Field S>
Sides<S> weight_at_tip(const Operators<S>& x) {
  return {internal::Omega_g(x),
          x.B.T() * internal::psi_HD(x) * (internal::H_psi(x) * (x.M * (x.phi.T() * (x.E.T() * x.a_g))))};
}
template <Field S>
Sides<S> weight_at_tip_second(const Operators<S>& x) {
  const Operator<S> lift = x.E.T() * x.a_g;
  const Operator<S> stripped = lift - internal::HDH(x) * (x.psi * (x.P * lift));
  return {internal::Omega_g(x), x.B.T() * (x.phi.T() * lift - x.psi.T() * stripped)};
}
template <Field S>
Sides<S> weight_at_tip_short(const Operators<S>& x) {
  return {internal::Omega_g(x), x.B.T() * (x.phi.T() * (x.E.T() * x.a_g) - x.psi.T() * (x.W.T() * x.a_g))};
}
template <Field S>
Sides<S> coriolis_and_weight_at_tip(const Operators<S>& x) {
  return {internal::Omega_c(x) + internal::Omega_g(x), coriolis_right_side(x, x.a + x.E.T() * x.a_g) + x.a_g};
}

// Three printed forms that are wrong.

/// (46) as printed, with J for its derivative.
template <Field S>
Sides<S> printed_tip_bias(const Operators<S>& x) {
  return {x.dense.J * x.thd, x.B.T() * (x.phi.T() * x.a) + x.a_tip};
}
/// The text after (40), with phi for phi*. For n = 1 both are 1.
template <Field S>
Sides<S> printed_link_velocities(const Operators<S>& x) {
  return {x.dense.V, x.phi * (x.H.T() * x.thd + x.E.T() * x.V_base)};
}
/// Section 4.3: (65) with a + E* a_g for a, and no a_g at the tip.
template <Field S>
Sides<S> printed_coriolis_and_weight(const Operators<S>& x) {
  return {internal::Omega_c(x) + internal::Omega_g(x), coriolis_right_side(x, x.a + x.E.T() * x.a_g)};
}

/// A numbered statement and the function that evaluates both sides of it.
template <Field S>
struct Identity {
  const char* equation;
  const char* statement;
  Sides<S> (*sides)(const Operators<S>&);
  bool regular_tip = false;  // needs Omega(0) of full rank: divides by its pivots
};

/// All identities, in the order of the paper. The properties that it does not number have "-".
template <Field S>
const std::vector<Identity<S>>& identities() {
  static const std::vector<Identity<S>> table = {
      {"(18)", "E_phi^n = 0", phi_step_is_nilpotent<S>},
      {"(19)", "phi(i,j)^-1 = phi(j,i)", shift_inverse<S>},
      {"(19)", "phi(i,l) phi(l,j) = phi(i,j)", shift_group<S>},
      {"(20)", "M(k) = phi(k,com) M_com phi*(k,com)", link_inertia<S>},
      {"(23)", "phi (1 - E_phi) = 1", phi_inverts<S>},
      {"(24)", "P = E_psi P E_psi* + K Jm K* + M", articulated_inertia<S>},
      {"(25)", "D = H P H* + Jm", hinge_inertia<S>},
      {"(26)", "G = P H* D^-1", gain<S>},
      {"(27)", "K = E_phi G", shifted_gain<S>},
      {"(28)", "E_psi = E_phi (1 - G H)", psi_step<S>},
      {"(29)", "psi (1 - E_psi) = 1", psi_inverts<S>},
      {"(29)", "E_psi^n = 0", psi_step_is_nilpotent<S>},
      {"(30)", "D(k) = H(k) P(k) H*(k) + Jm(k)", hinge_inertia_blocks<S>},
      {"(31)", "G(k) D(k) = P(k) H*(k)", gain_blocks<S>},
      {"(32)", "K(k+1,k) = phi(k+1,k) G(k)", shifted_gain_blocks<S>},
      {"(33)", "psi(k+1,k) = phi(k+1,k) (1 - G(k) H(k))", psi_step_blocks<S>},
      {"(34)", "W = E (1 - G H)", base_step<S>},
      {"(35)", "psi(i,l) psi(l,j) = psi(i,j)", psi_semigroup<S>},
      {"(36)", "phi has the blocks phi(i,j)", phi_blocks<S>},
      {"(36)", "psi has the blocks psi(i,j)", psi_blocks<S>},
      {"(38)", "J* = H phi B", jacobian<S>},
      {"(40)", "V(0) = B* phi* (H* thd + E* V(n+1))", tip_velocity<S>},
      {"(40)", "V = phi* (H* thd + E* V(n+1))", link_velocities<S>},
      {"(41)", "V = E_phi* V + H* thd + E* V(n+1)", velocity_step<S>},
      {"(42)", "M = H phi M phi* H* + Jm", newton_euler_factors<S>},
      {"(43)", "C = H phi (M phi* a + b)", coriolis<S>},
      {"(44)", "G = H phi M phi* E* a_g", weight<S>},
      {"(45)", "C + G = H phi (M phi* (a + E* a_g) + b)", coriolis_and_weight<S>},
      {"(46)", "Jdot thd = B* phi* a + a(0)", tip_bias<S>},
      {"(47)", "b(k) = (w x I w; m w x (w x p))", bias_force<S>},
      {"(48)", "a(k) = (w' x s_w; w' x (w' x l) + 2 w' x s_v), w' = w(k+1), s = H* thd",
       bias_acceleration<S>},
      {"(49)", "M = (1 + H phi K) D (1 + H phi K)*", innovations_factors<S>},
      {"(50)", "(1 + H phi K) (1 - H psi K) = 1", innovations_inverse<S>},
      {"(51)", "M^-1 = (1 - H psi K)* D^-1 (1 - H psi K)", mass_inverse<S>},
      {"(52)", "phi K H psi = phi - psi", phi_less_psi<S>},
      {"(52)", "psi K H phi = phi - psi", phi_less_psi_turned<S>},
      {"(53)", "(1 - H psi K) H phi = H psi", stripped_phi<S>},
      {"(54)", "psi M phi* = P + psi~ P + P phi~*", inertia_split<S>},
      {"(54)", "P + psi~ P = psi P", inertia_split_short<S>},
      {"(55)", "phi~ = phi E_phi", phi_tilde<S>},
      {"(55)", "phi~ = E_phi phi", phi_tilde_turned<S>},
      {"(56)", "psi* H* D^-1 H psi = Omega + psi~* Omega + Omega psi~", compliance_split<S>},
      {"(57)", "Omega = E_psi* Omega E_psi + H* D^-1 H", compliance<S>},
      {"(59)", "(1 - H* D^-1 H psi P) E* = W*", base_step_by_operators<S>},
      {"(60)", "J M^-1 J* = B* psi* H* D^-1 H psi B", tip_compliance_long<S>},
      {"(60)", "J M^-1 J* = B* Omega B", tip_compliance<S>},
      {"(61)", "Lambda(0) B* Omega B = 1", tip_inertia<S>, true},
      {"(62)", "Omega(0) c(0) = B* psi* H* D^-1 H psi (M phi* a + b) - B* phi* a - a(0)", coriolis_at_tip<S>},
      {"(63)", "D^-1 H P phi~* = K* phi*", response_step<S>},
      {"(63)", "psi* H* D^-1 H psi M phi* = psi* H* D^-1 H psi P + phi* - psi*", response_to_inertia<S>},
      {"(64), (65)", "Omega(0) c(0) = B* psi* (H* D^-1 H psi (P a + b) - a) - a(0)",
       coriolis_at_tip_short<S>},
      {"(69)", "Omega(0) g(0) = B* psi* H* D^-1 H psi M phi* E* a_g", weight_at_tip<S>},
      {"(70)", "Omega(0) g(0) = B* (phi* - psi* (1 - H* D^-1 H psi P)) E* a_g", weight_at_tip_second<S>},
      {"(71), (72)", "Omega(0) g(0) = B* (phi* E* - psi* W*) a_g", weight_at_tip_short<S>},
      {"section 4.3",
       "Omega(0) (c(0) + g(0)) = B* psi* (H* D^-1 H psi (P a' + b) - a') - a(0) + a_g, a' = a + E* a_g",
       coriolis_and_weight_at_tip<S>},
      {"-", "H G = 1 - Jm D^-1", hinge_gain<S>},
      {"-", "H (1 - G H) = Jm D^-1 H", hinge_strip<S>},
      {"-", "psi(k+1,k) G(k) = K(k+1,k) Jm(k) D(k)^-1", psi_gain<S>},
      {"-", "P(k) = P*(k)", articulated_symmetry<S>},
      {"-", "Omega(k) = Omega*(k)", compliance_symmetry<S>},
  };
  return table;
}

/// The forms that the paper prints and that do not hold.
template <Field S>
const std::vector<Identity<S>>& printed_errors() {
  static const std::vector<Identity<S>> table = {
      {"(46)", "J thd = B* phi* a + a(0)", printed_tip_bias<S>},
      {"text after (40)", "V = phi H* thd", printed_link_velocities<S>},
      {"section 4.3",
       "Omega(0) (c(0) + g(0)) = B* psi* (H* D^-1 H psi (P a' + b) - a') - a(0), a' = a + E* a_g",
       printed_coriolis_and_weight<S>},
  };
  return table;
}

}  // namespace osculate::dense
