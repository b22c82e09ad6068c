#include "verification/step_check.hpp"

namespace osculate {

namespace {

VectorX<double> vector(std::span<const double> values) {
  return Eigen::Map<const VectorX<double>>(values.data(), static_cast<Eigen::Index>(values.size()));
}

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

Evidence gather(ClosedLoop& loop, double t, std::span<const double> y, bool at_sample) {
  const Observation& seen = loop.observe(t, y);
  Controller& controller = loop.controller();
  const Plant& plant = loop.plant();
  const LawOptions& law = controller.options();
  const TaskRows& rows = law.rows;
  const bool acts = law.law != Law::free && (!loop.sampled() || at_sample);
  const bool by_definition = law.law != Law::textbook || law.textbook == TextbookLaw::dense;
  // Between its samples, before its torque is applied and with values of the sample before, a law is not (5).
  const bool late =
      law.sampling && (law.sampling->delay != Delay::none || law.sampling->computation_time > 0);
  const bool disturbed = seen.command.filtered || seen.command.saturated || law.sensors;

  Evidence e;
  e.rows = rows;
  e.controlled = acts && by_definition && !seen.command.filtered && !law.sensors;
  e.linearized = acts && loop.plant_is_model() && omission(law).empty() && !late && !disturbed;
  e.filtered = seen.command.filtered;
  e.one_solve = law.law != Law::textbook;
  e.base = loop.base(t);
  e.reach = reach(plant.chain);
  e.qd = vector(seen.qd);
  e.u = seen.command.u(rows);
  if (law.law == Law::operational_space) e.F = seen.command.F(rows);
  e.T = vector(controller.rigid_torque());
  e.T0 = vector(controller.null_space_torque());
  e.net_torque = vector(loop.net_torque());
  e.tip_force = seen.tip_force;
  e.known_tip_force = controller.known_tip_force();
  e.qdd = vector(seen.qdd);
  e.tip = seen.command.tip;
  e.tip_velocity = loop.plant_tip_velocity();
  e.tip_acceleration = seen.tip_acceleration;
  const Coordinates v = seen.command.v;
  const TipReference reference = seen.command.reference;
  bool full_rank = true;
  if (controller.monitored() && (!loop.sampled() || at_sample || law.law != Law::resolved_acceleration)) {
    e.recursive = controller.terms(seen.qd);
    full_rank = e.recursive.Lambda.size() > 0;
  }
  fill_dense_side(e, controller.model(), plant.chain, seen.q, full_rank);
  if (acts && !law.sensors && controller.chart()) {
    const auto& tip = e.plant.tip;
    e.chart = judge_chart({*controller.chart(), law.stiffness, law.damping, reference}, v, tip,
                          tip.J * e.qdd + tip.Jdot_qd);
  }
  return e;
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
