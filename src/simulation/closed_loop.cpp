#include "simulation/closed_loop.hpp"

#include "simulation/cvode.hpp"

namespace osculate {

ClosedLoop::ClosedLoop(Controller controller, Plant plant)
    : controller_(std::move(controller)),
      plant_(std::move(plant)),
      plant_dynamics_(plant_.chain.one_axis_joints() ? Dynamics(std::in_place_index<0>, plant_.chain)
                                                     : Dynamics(std::in_place_index<1>, plant_.chain)),
      positions_(plant_.chain.positions()),
      velocities_(plant_.chain.velocities()),
      joints_(plant_.chain.links.size()),
      net_torque_(static_cast<std::size_t>(velocities_)),
      derivative_(states()) {
  for (int i = 0; i < 6; ++i) component(tip_force_, i) = plant_.tip_force[i];
  seen_.q.resize(static_cast<std::size_t>(positions_));
  for (auto* v : {&seen_.qd, &seen_.qdd, &seen_.torque}) v->resize(net_torque_.size());
}

void ClosedLoop::control(double t, const double* y) {
  try {
    controller_.torque(t, q(y), qd(y), seen_.torque);
  } catch (const SingularTask& error) {
    throw IntegrationStopped(IntegrationStopped::Reason::singular, error.what());
  } catch (const RepresentationSingular& error) {
    throw IntegrationStopped(IntegrationStopped::Reason::singular,
                             std::string(error.what()) + " (t = " + std::to_string(t) + " s)");
  }
}

void ClosedLoop::sample(double t, std::span<const double> y) { control(t, y.data()); }

void ClosedLoop::right_side(double t, const double* y, double* yd) {
  const auto np = static_cast<std::size_t>(positions_), nv = static_cast<std::size_t>(velocities_);
  if (!sampled()) control(t, y);
  const std::span<const double> rates = qd(y), torque{seen_.torque};

  double power = 0, loss = 0;  // W
  for (std::size_t i = 0; i < nv; ++i) {
    const double friction = plant_.friction.empty() ? 0.0 : friction_torque(plant_.friction[i], rates[i]);
    net_torque_[i] = torque[i] - seeded(Fault::plant_friction, friction);
    power += torque[i] * rates[i];
    loss += friction * rates[i];
  }
  set_positions(plant_.chain, q(y), joints_);
  std::visit(
      [&](auto& dynamics) {
        if (controller_.options().base_path) dynamics.move_base(base(t));
        dynamics.place(joints_);
        dynamics.accelerations(rates, net_torque_, seeded(Fault::plant_wrench, tip_force_), {yd + np, nv});
        yd[np + nv + 2] = dot(tip_force_, dynamics.tip_velocity());
      },
      plant_dynamics_);
  position_rates(plant_.chain, q(y), rates, {yd, np});
  yd[np + nv] = seeded(Fault::work, power);
  yd[np + nv + 1] = loss;
}

bool ClosedLoop::plant_is_model() const {
  const LawOptions& law = controller_.options();
  if (!(plant_.chain == controller_.model()) || plant_.tip_force != law.known_tip_force) return false;
  const std::vector<JointFriction> none(net_torque_.size());
  const auto or_none = [&none](const std::vector<JointFriction>& f) { return f.empty() ? none : f; };
  return or_none(plant_.friction) == (law.compensate_friction ? or_none(controller_.friction()) : none);
}

Vector6 ClosedLoop::plant_tip_velocity() const {
  return std::visit(
      [](const auto& dynamics) {
        Vector6 V;
        for (int i = 0; i < 6; ++i) V[i] = component(dynamics.tip_velocity(), i);
        return V;
      },
      plant_dynamics_);
}

const Observation& ClosedLoop::observe(double t, std::span<const double> y) {
  const auto np = static_cast<std::size_t>(positions_), nv = static_cast<std::size_t>(velocities_);
  seen_.t = t;
  std::copy_n(y.begin(), np, seen_.q.begin());
  std::copy_n(y.begin() + positions_, nv, seen_.qd.begin());
  right_side(t, y.data(), derivative_.data());
  std::copy_n(derivative_.begin() + positions_, nv, seen_.qdd.begin());
  seen_.command = sampled() ? controller_.look(t, seen_.q, seen_.qd) : controller_.last();
  std::visit(
      [&](const auto& dynamics) {
        for (int i = 0; i < 6; ++i) seen_.tip_acceleration[i] = component(dynamics.tip_acceleration(), i);
        seen_.kinetic = dynamics.kinetic_energy(seen_.qd);
        seen_.potential = dynamics.potential_energy();
      },
      plant_dynamics_);
  seen_.work = y[np + nv];
  seen_.dissipated = y[np + nv + 1];
  seen_.external_work = y[np + nv + 2];
  return seen_;
}

}  // namespace osculate
