#include "simulation/closed_loop.hpp"

#include "simulation/cvode.hpp"

namespace osculate {

ClosedLoop::ClosedLoop(Controller controller, Plant plant)
    : controller_(std::move(controller)),
      plant_(std::move(plant)),
      plant_dynamics_(plant_.chain),
      joints_(plant_.chain.links.size()),
      net_torque_(plant_.chain.links.size()),
      derivative_(states()) {
  for (int i = 0; i < 6; ++i) component(tip_force_, i) = plant_.tip_force[i];
  for (auto* v : {&seen_.q, &seen_.qd, &seen_.qdd, &seen_.torque}) v->resize(joints_.size());
}

void ClosedLoop::right_side(double t, const double* y, double* yd) {
  const std::size_t n = joints_.size();
  const std::span<const double> q{y, n}, qd{y + n, n};
  const std::span<double> torque{seen_.torque};
  try {
    controller_.torque(t, q, qd, torque);
  } catch (const SingularTask& error) {
    throw IntegrationStopped(IntegrationStopped::Reason::singular, error.what());
  }

  double power = 0, loss = 0;  // W
  for (std::size_t i = 0; i < n; ++i) {
    const double friction = plant_.friction.empty() ? 0.0 : friction_torque(plant_.friction[i], qd[i]);
    net_torque_[i] = torque[i] - friction;
    power += torque[i] * qd[i];
    loss += friction * qd[i];
  }
  set_positions(plant_.chain, q, joints_);
  plant_dynamics_.place(joints_);
  plant_dynamics_.accelerations(qd, net_torque_, tip_force_, {yd + n, n});
  for (std::size_t i = 0; i < n; ++i) yd[i] = qd[i];
  yd[2 * n] = power;
  yd[2 * n + 1] = loss;
  yd[2 * n + 2] = dot(tip_force_, plant_dynamics_.tip_velocity());
}

bool ClosedLoop::plant_is_model() const {
  if (!(plant_.chain == controller_.model()) || !plant_.tip_force.isZero(0)) return false;
  const std::vector<JointFriction> none(joints_.size());
  const auto or_none = [&none](const std::vector<JointFriction>& f) { return f.empty() ? none : f; };
  return or_none(plant_.friction) ==
         (controller_.options().compensate_friction ? or_none(controller_.friction()) : none);
}

Vector6 ClosedLoop::plant_tip_velocity() const {
  Vector6 V;
  for (int i = 0; i < 6; ++i) V[i] = component(plant_dynamics_.tip_velocity(), i);
  return V;
}

const Observation& ClosedLoop::observe(double t, std::span<const double> y) {
  const std::size_t n = joints_.size();
  seen_.t = t;
  seen_.q.assign(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(n));
  seen_.qd.assign(y.begin() + static_cast<std::ptrdiff_t>(n), y.begin() + static_cast<std::ptrdiff_t>(2 * n));
  right_side(t, y.data(), derivative_.data());
  seen_.qdd.assign(derivative_.begin() + static_cast<std::ptrdiff_t>(n),
                   derivative_.begin() + static_cast<std::ptrdiff_t>(2 * n));
  seen_.command = controller_.last();
  for (int i = 0; i < 6; ++i) seen_.tip_acceleration[i] = component(plant_dynamics_.tip_acceleration(), i);
  seen_.kinetic = plant_dynamics_.kinetic_energy(seen_.qd);
  seen_.potential = plant_dynamics_.potential_energy();
  seen_.work = y[2 * n];
  seen_.dissipated = y[2 * n + 1];
  seen_.external_work = y[2 * n + 2];
  return seen_;
}

}  // namespace osculate
