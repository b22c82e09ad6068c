#include "verification/step_check.hpp"

namespace osculate {

namespace {

auto vector(std::span<const double> values) {
  return Eigen::Map<const VectorX<double>>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void assign(VectorX<double>& to, std::span<const double> values) { to = vector(values); }

}  // namespace

double reach(const Chain<double>& chain) {
  double sum = chain.p_tip.norm();
  for (const auto& link : chain.links) sum += link.p_origin.norm();
  return sum;
}

std::string omission(const LawOptions& law) {
  if (law.law != Law::textbook) return "";
  const TextbookLaw kind = law.textbook;
  if (kind == TextbookLaw::dense) return "";
  // These two differ from (16) by what they let through of a null-space torque.
  const bool other_null_space =
      kind == TextbookLaw::pseudo_inverse || kind == TextbookLaw::kinematic_null_space;
  if (other_null_space && law.null_space.empty()) return "";
  for (const TextbookLawInfo& info : textbook_laws())
    if (info.law == kind) return std::string(info.omits);
  return "";
}

StepCheck::StepCheck(const ClosedLoop& loop) {
  const LawOptions& law = loop.controller().options();
  // Between its samples, before its torque is applied and with values of the sample before, a law is not (5).
  const bool late =
      law.sampling && (law.sampling->delay != Delay::none || law.sampling->computation_time > 0);
  reach_ = reach(loop.plant().chain);
  equal_arms_ = loop.plant().chain == loop.controller().model();
  linearizes_ = loop.plant_is_model() && omission(law).empty() && !late && !law.sensors;
  by_definition_ = law.law != Law::textbook || law.textbook == TextbookLaw::dense;
}

Evidence& StepCheck::gather(ClosedLoop& loop, const Observation& seen, bool at_sample) {
  Controller& controller = loop.controller();
  const Plant& plant = loop.plant();
  const LawOptions& law = controller.options();
  const bool acts = law.law != Law::free && (!loop.sampled() || at_sample);

  Evidence& e = evidence_;
  e.rows = law.rows;
  e.controlled = acts && by_definition_ && !seen.command.filtered && !law.sensors;
  e.linearized = acts && linearizes_ && !seen.command.filtered && !seen.command.saturated;
  e.filtered = seen.command.filtered;
  e.one_solve = law.law != Law::textbook && law.law != Law::user;
  e.base = loop.base(seen.t);
  e.reach = reach_;
  assign(e.qd, seen.qd);
  e.u.resize(static_cast<Eigen::Index>(law.rows.size()));
  e.F.resize(law.law == Law::operational_space ? e.u.size() : 0);
  for (Eigen::Index i = 0; i < e.u.size(); ++i) {
    e.u[i] = seen.command.u[law.rows[static_cast<std::size_t>(i)]];
    if (e.F.size() > 0) e.F[i] = seen.command.F[law.rows[static_cast<std::size_t>(i)]];
  }
  assign(e.T, controller.rigid_torque());
  assign(e.T0, controller.null_space_torque());
  assign(e.net_torque, loop.net_torque());
  e.tip_force = seen.tip_force;
  e.known_tip_force = controller.known_tip_force();
  assign(e.qdd, seen.qdd);
  e.tip = seen.command.tip;
  e.tip_velocity = loop.plant_tip_velocity();
  e.tip_acceleration = seen.tip_acceleration;
  e.delayed_torque.resize(0);
  bool full_rank = true;
  if (controller.monitored() && (!loop.sampled() || at_sample || law.law != Law::resolved_acceleration)) {
    e.recursive = controller.terms(seen.qd);
    full_rank = e.recursive.Lambda.size() > 0;
  } else {
    e.recursive = {};
  }
  const Chain<double>& model = controller.model();
  fill_dense_side(e, model, equal_arms_ ? model : plant.chain, seen.q, full_rank);
  e.chart.reset();
  if (acts && !law.sensors && controller.chart()) {
    const auto& tip = e.plant.tip;
    e.chart = judge_chart({*controller.chart(), law.stiffness, law.damping, seen.command.reference},
                          seen.command.v, tip, tip.J * e.qdd + tip.Jdot_qd);
  }
  return e;
}

Evidence gather(ClosedLoop& loop, double t, std::span<const double> y, bool at_sample) {
  return StepCheck(loop).gather(loop, loop.observe(t, y), at_sample);
}

Evidence gather_as_measured(const ClosedLoop& loop, const Evidence& at) {
  const Controller& controller = loop.controller();
  Evidence e;
  e.rows = at.rows;
  e.u = at.u;
  e.F = at.F;
  e.T = at.T;
  e.T0 = at.T0;
  e.qd = vector(controller.known_qd());
  e.net_torque = at.net_torque;
  e.qdd = at.qdd;
  e.known_tip_force = at.known_tip_force;
  e.linearized = false;
  e.base = at.base;
  e.reach = at.reach;
  fill_dense_side(e, controller.model(), controller.model(), controller.known_q(),
                  at.terms.Lambda.size() > 0);
  return e;
}

}  // namespace osculate
