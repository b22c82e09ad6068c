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

Evidence gather(ClosedLoop& loop, double t, std::span<const double> y, bool at_sample) {
  const Observation& seen = loop.observe(t, y);
  Controller& controller = loop.controller();
  const Plant& plant = loop.plant();
  const LawOptions& law = controller.options();
  const TaskRows& rows = law.rows;
  const bool delayed = law.sampling && law.sampling->delay != Delay::none;

  Evidence e;
  e.rows = rows;
  e.controlled = law.law != Law::free && (!loop.sampled() || at_sample);
  e.linearized = loop.plant_is_model() && !delayed;
  e.base = loop.base(t);
  e.reach = reach(plant.chain);
  e.qd = vector(seen.qd);
  e.u = seen.command.u(rows);
  if (law.law == Law::operational_space) e.F = seen.command.F(rows);
  e.T = vector(controller.rigid_torque());
  e.T0 = vector(controller.null_space_torque());
  e.net_torque = vector(loop.net_torque());
  e.tip_force = plant.tip_force;
  e.known_tip_force = law.known_tip_force;
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
  if (e.controlled && controller.chart()) {
    const auto& tip = e.plant.tip;
    e.chart = judge_chart({*controller.chart(), law.stiffness, law.damping, reference}, v, tip,
                          tip.J * e.qdd + tip.Jdot_qd);
  }
  return e;
}

}  // namespace osculate
