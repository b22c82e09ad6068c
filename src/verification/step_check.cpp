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

Evidence gather(ClosedLoop& loop, double t, std::span<const double> y) {
  const Observation& seen = loop.observe(t, y);
  Controller& controller = loop.controller();
  const Plant& plant = loop.plant();
  const TaskRows& rows = controller.options().rows;
  const auto m = static_cast<Eigen::Index>(rows.size());

  Evidence e;
  e.rows = rows;
  e.controlled = controller.options().law == Law::operational_space;
  e.plant_is_model = loop.plant_is_model();
  e.reach = reach(plant.chain);
  e.qd = vector(seen.qd);
  e.u.resize(m);
  e.F.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    e.u[i] = seen.command.u[rows[static_cast<std::size_t>(i)]];
    e.F[i] = seen.command.F[rows[static_cast<std::size_t>(i)]];
  }
  e.T = vector(controller.rigid_torque());
  e.T0 = vector(controller.null_space_torque());
  e.net_torque = vector(loop.net_torque());
  e.tip_force = plant.tip_force;
  e.qdd = vector(seen.qdd);
  e.tip = seen.command.tip;
  e.tip_velocity = loop.plant_tip_velocity();
  e.tip_acceleration = seen.tip_acceleration;
  e.recursive = controller.terms(seen.qd);
  fill_dense_side(e, controller.model(), plant.chain, seen.q, e.recursive.Lambda.size() > 0);
  return e;
}

}  // namespace osculate
