// Every recursion of the paper as a statement: what the sweeps give equals what the operators and the
// definitions say. Written like the identities of reference/identities.hpp, and judged in the same units.
#pragma once

#include <string>

#include "paper/swept.hpp"

namespace osculate::paper {

using dense::Operator;
using dense::Sides;

/// A state with the recursions' answers and the operators that judge them. Tip first, as in operators.hpp.
template <Field S>
struct Trial {
  Question<S> ask;
  Swept<S> swept;
  dense::Operators<S> x;              // base at rest
  Operator<S> C_moving, Jdot_moving;  // of (6) and (8) on the moving base, tip first
  Operator<S> M_inv_moving, J_moving;
  Operator<S> rows;               // m x 6: selects the task rows
  Operator<S> u, T0, T, F, push;  // the question's vectors as operators; joint lists tip first
};

template <Field S>
Trial<S> trial(Question<S> question) {
  Trial<S> t;
  t.ask = std::move(question);
  const Question<S>& ask = t.ask;
  t.swept = swept(ask);
  t.x = dense::operators(ask.chain, ask.positions, ask.qd);
  const JointOrder order(ask.chain);
  const auto joint_list = [&order](const VectorX<S>& list) {
    return Operator<S>(internal::tip_first(order, std::vector<S>(list.data(), list.data() + list.size())));
  };
  MatrixX<S> select = MatrixX<S>::Zero(static_cast<Eigen::Index>(ask.rows.size()), 6);
  for (std::size_t i = 0; i < ask.rows.size(); ++i) select(static_cast<Eigen::Index>(i), ask.rows[i]) = S(1);
  t.rows = Operator<S>(select);
  t.u = Operator<S>(ask.u);
  t.T0 = joint_list(ask.T0);
  t.T = joint_list(ask.T);
  t.F = Operator<S>(ask.F);
  t.push = Operator<S>(ask.push);
  const auto moving = dense::operators(ask.chain, ask.positions, ask.qd, ask.base);
  t.C_moving = moving.dense.C;
  t.Jdot_moving = moving.dense.Jdot_qd;
  t.M_inv_moving = moving.dense.M_inv;
  t.J_moving = moving.dense.J;
  // G of an arm on a turned base is its own; the operators have it.
  t.C_moving = t.C_moving + moving.dense.G;
  return t;
}

namespace internal {

/// S J M^-1 J* S* on the task rows. Rounding in Omega is relative to its block, angular or linear, whichever
/// way the axes are turned: so are the sizes.
template <Field S>
Operator<S> task_compliance(const Trial<S>& t, const Operator<S>& J, const Operator<S>& M_inv) {
  const Operator<S> Omega = J * M_inv * J.T();
  Operator<S> out = t.rows * Omega * t.rows.T();
  if constexpr (std::floating_point<S>) {
    const S largest[2] = {Omega.size.diagonal().head(3).maxCoeff(), Omega.size.diagonal().tail(3).maxCoeff()};
    const auto half = [&t](Eigen::Index i) { return t.ask.rows[static_cast<std::size_t>(i)] / 3; };
    for (Eigen::Index i = 0; i < out.rows(); ++i)
      for (Eigen::Index j = 0; j < out.cols(); ++j)
        out.size(i, j) = std::sqrt(largest[half(i)] * largest[half(j)]);
  }
  return out;
}
/// T = T0 + J* (Lambda (u + J M^-1 (C + G - T0) - Jdot qd) - F_ext), (16) with what is added to it.
template <Field S>
Operator<S> torque(const Trial<S>& t, const Operator<S>& T0, const Operator<S>& F_ext) {
  const Operator<S> J = t.rows * t.x.dense.J;
  const Operator<S> forces = t.x.dense.C + t.x.dense.G - T0 - t.x.dense.J.T() * F_ext;
  const Operator<S> right = t.u + J * (t.x.dense.M_inv * forces) - t.rows * t.x.dense.Jdot_qd;
  return T0 + J.T() * (dense::inverse(task_compliance(t, t.x.dense.J, t.x.dense.M_inv)) * right);
}
template <Field S>
Operator<S> torque(const Trial<S>& t) {
  const Operator<S> none = MatrixX<S>(MatrixX<S>::Zero(t.T0.rows(), 1)),
                    still = MatrixX<S>(MatrixX<S>::Zero(6, 1));
  return torque(t, none, still);
}
template <Field S>
Operator<S> null_space_torque(const Trial<S>& t) {
  return torque(t, t.T0, Operator<S>(MatrixX<S>(MatrixX<S>::Zero(6, 1))));
}
/// A result that is a sum in which `term` is one summand: its size counts, however much cancels.
template <Field S>
Operator<S> sum_with(const MatrixX<S>& result, const Operator<S>& term) {
  Operator<S> out = result;
  if constexpr (std::floating_point<S>) out.size += term.size;
  return out;
}
/// a + E* a_g: the reassignment of section 4.3.
template <Field S>
Operator<S> a_bar(const Trial<S>& t) {
  return t.x.a + t.x.E.T() * t.x.a_g;
}
template <Field S>
Operator<S> z(const Trial<S>& t) {
  return t.x.psi * (t.x.P * a_bar(t) + t.x.b);
}
template <Field S>
Operator<S> xi(const Trial<S>& t) {
  return dense::internal::HDH(t.x) * z(t) - a_bar(t);
}

}  // namespace internal

/// A numbered recursion and the function that evaluates both sides: the sweeps' answer, then the operators'.
template <Field S>
struct Recursion {
  const char* equation;
  const char* statement;
  const char* place;  // function of src/recursion that runs it
  Sides<S> (*sides)(const Trial<S>&);
  bool square = false;  // holds where there are as many task rows as joint coordinates
};

/// All recursions, in the order of the paper; those that it describes in words name the section.
template <Field S>
const std::vector<Recursion<S>>& recursions() {
  using T = Trial<S>;
  namespace in = internal;
  static const std::vector<Recursion<S>> table = {
      {"(37)", "P(k) by recursion", "articulate",
       [](const T& t) {
         return Sides<S>{t.swept.P, t.x.P};
       }},
      {"(37)", "D(k) by recursion", "articulate",
       [](const T& t) {
         return Sides<S>{t.swept.D, t.x.D};
       }},
      {"(37)", "G(k) by recursion", "articulate",
       [](const T& t) {
         return Sides<S>{t.swept.G, t.x.G};
       }},
      {"(37)", "K(k+1,k) by recursion", "articulate",
       [](const T& t) {
         return Sides<S>{t.swept.K, t.x.K};
       }},
      {"(37)", "psi(k+1,k) by recursion", "articulate",
       [](const T& t) {
         return Sides<S>{t.swept.E_psi, t.x.E_psi};
       }},
      {"(37)", "psi(n+1,n) by recursion", "articulate",
       [](const T& t) {
         return Sides<S>{t.swept.W, t.x.W};
       }},
      {"(39)", "T = J* F", "torque_step",
       [](const T& t) {
         return Sides<S>{t.swept.T_of_F, t.x.dense.J.T() * t.F};
       }},
      {"(41)", "V(k) by recursion", "velocity_step",
       [](const T& t) {
         return Sides<S>{t.swept.V, t.x.dense.V};
       }},
      {"(41)", "V(0) = J thd", "velocity_at_tip",
       [](const T& t) {
         return Sides<S>{t.swept.V_tip, t.x.dense.V_tip};
       }},
      {"(47)", "b(k) of link k", "bias_force",
       [](const T& t) {
         return Sides<S>{t.swept.b, t.x.b};
       }},
      {"(48)", "a(k) of joint k", "bias_acceleration",
       [](const T& t) {
         return Sides<S>{t.swept.a, t.x.a};
       }},
      {"(48)", "a(0)", "bias_at_tip",
       [](const T& t) {
         return Sides<S>{t.swept.a_tip, t.x.a_tip};
       }},
      {"(51)", "thdd = M^-1 (T - C - G + J* F)", "sweep_accelerations",
       [](const T& t) {
         return Sides<S>{t.swept.thdd,
                         t.x.dense.M_inv * (t.T - t.x.dense.C - t.x.dense.G + t.x.dense.J.T() * t.push)};
       }},
      {"(8)", "tip acceleration = J thdd + Jdot thd", "sweep_accelerations",
       [](const T& t) {
         const Operator<S> thdd =
             t.x.dense.M_inv * (t.T - t.x.dense.C - t.x.dense.G + t.x.dense.J.T() * t.push);
         return Sides<S>{t.swept.tip_acceleration, t.x.dense.J * thdd + t.x.dense.Jdot_qd};
       }},
      {"(58)", "Omega(k) by recursion", "compliance_step",
       [](const T& t) {
         return Sides<S>{t.swept.Omega, t.x.Omega};
       }},
      {"(60)", "Omega(0) = J M^-1 J*", "compliance_at_tip",
       [](const T& t) {
         return Sides<S>{t.swept.Omega_tip, t.x.dense.J * t.x.dense.M_inv * t.x.dense.J.T()};
       }},
      {"(66)", "z = psi (P a' + b), a' = a + E* a_g", "bias_step",
       [](const T& t) {
         return Sides<S>{t.swept.z, in::z(t)};
       }},
      {"(66)", "xi = H* D^-1 H z - a'", "bias_step",
       [](const T& t) {
         return Sides<S>{t.swept.xi, in::xi(t)};
       }},
      {"(67)", "eta = psi* xi", "compliance_step",
       [](const T& t) {
         return Sides<S>{t.swept.eta, t.x.psi.T() * in::xi(t)};
       }},
      {"(68)", "eta(0) - a(0) = Omega(0) c(0)", "compliance_at_tip",
       [](const T& t) {
         return Sides<S>{t.swept.of_c, dense::internal::Omega_c(t.x)};
       }},
      {"(73)", "eta = psi* W* a_g", "sweep_gravity",
       [](const T& t) {
         return Sides<S>{t.swept.eta_g, t.x.psi.T() * (t.x.W.T() * t.x.a_g)};
       }},
      {"(74)", "phi*(1,0) (alpha(1) - eta(1)) = Omega(0) g(0)", "sweep_gravity",
       [](const T& t) {
         return Sides<S>{in::sum_with(t.swept.of_g, t.x.a_g), dense::internal::Omega_g(t.x)};
       }},
      {"section 4.3", "one pass, with + a_g at the tip: Omega(0) (c(0) + g(0))", "compliance_at_tip",
       [](const T& t) {
         return Sides<S>{in::sum_with(t.swept.of_c_plus_g, t.x.a_g),
                         dense::internal::Omega_c(t.x) + dense::internal::Omega_g(t.x)};
       }},
      {"(4), (16)", "T in four sweeps = J* Lambda (u + J M^-1 (C + G) - Jdot thd)", "BasicOperationalSpace",
       [](const T& t) {
         return Sides<S>{t.swept.torque.four_sweeps, in::torque(t)};
       }},
      {"(13)", "the same with a null-space torque T0, in the same sweeps", "BasicOperationalSpace",
       [](const T& t) {
         return Sides<S>{t.swept.torque.null_space, in::null_space_torque(t)};
       }},
      {"(2)", "the same with a known wrench on the tip: z(0) = -F", "sweep_articulated",
       [](const T& t) {
         const Operator<S> none = MatrixX<S>(MatrixX<S>::Zero(t.T0.rows(), 1));
         return Sides<S>{t.swept.torque.known_force, in::torque(t, none, t.push)};
       }},
      {"section 2", "the same on a base that moves as prescribed", "bias_with_ground",
       [](const T& t) {
         const Operator<S> J = t.rows * t.J_moving;
         const Operator<S> right = t.u + J * (t.M_inv_moving * t.C_moving) - t.rows * t.Jdot_moving;
         return Sides<S>{
             t.swept.torque.moving_base,
             J.T() * (dense::inverse(in::task_compliance(t, t.J_moving, t.M_inv_moving)) * right)};
       }},
      {"section 2", "the same through joints of any kind", "Joint",
       [](const T& t) {
         return Sides<S>{t.swept.torque.any_joint, in::torque(t)};
       }},
      {"section 2", "the same by resolved acceleration", "ResolvedAcceleration",
       [](const T& t) {
         return Sides<S>{t.swept.torque.resolved, in::torque(t)};
       },
       true},
      {"(37)-(68)", "the same in link frames", "LinkHinge",
       [](const T& t) {
         return Sides<S>{t.swept.torque.link_frames, in::null_space_torque(t)};
       }},
      {"section 4.2", "old velocity terms at a frozen state, third sample: the same", "begin_sample",
       [](const T& t) {
         return Sides<S>{t.swept.torque.old_velocity, in::null_space_torque(t)};
       }},
      {"section 5", "old F_c at a frozen state, third sample: the same", "begin_sample",
       [](const T& t) {
         return Sides<S>{t.swept.torque.old_force, in::null_space_torque(t)};
       }},
      {"section 5", "two sweeps at a frozen state, third sample: the same", "begin_sample",
       [](const T& t) {
         return Sides<S>{t.swept.torque.two_sweeps, in::null_space_torque(t)};
       }},
      {"-", "kinetic energy = thd* M thd / 2", "kinetic_energy",
       [](const T& t) {
         const S half = S(1) / S(2);
         const Operator<S> energy = t.x.thd.T() * t.x.dense.M * t.x.thd;
         return Sides<S>{t.swept.kinetic, energy * Operator<S>(MatrixX<S>(MatrixX<S>::Constant(1, 1, half)))};
       }},
  };
  return table;
}

/// Section 4.3 as printed, by the sweeps: wrong by a_g on the right side.
template <Field S>
Sides<S> printed_section_4_3(const Trial<S>& t) {
  return {t.swept.printed_4_3, dense::internal::Omega_c(t.x) + dense::internal::Omega_g(t.x)};
}

}  // namespace osculate::paper
