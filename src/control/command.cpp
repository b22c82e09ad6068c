// What the law asks of the tip: u, from the reference, the gains, the measured force and the obstacles.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/law.hpp"

namespace osculate {

void Controller::sense(std::span<const double> q, std::span<const double> qd) {
  std::copy(q.begin(), q.end(), known_q_.begin());
  std::copy(qd.begin(), qd.end(), known_qd_.begin());
  if (!options_.sensors || !options_.sampling) return;
  const Sensors& sensors = *options_.sensors;
  if (sensors.resolution > 0)
    for (double& x : known_q_) x = sensors.resolution * std::round(x / sensors.resolution);
  if (sensors.velocity_cutoff > 0) {
    const double T = options_.sampling->period;
    const double keep = std::exp(-2 * std::numbers::pi * sensors.velocity_cutoff * T);
    if (sensed_.q.empty()) {  // the first sample: the filter starts at the true velocity
      sensed_.qd = known_qd_;
    } else {
      for (std::size_t i = 0; i < known_q_.size(); ++i)
        sensed_.qd[i] = keep * sensed_.qd[i] + (1 - keep) * (known_q_[i] - sensed_.q[i]) / T;
    }
    sensed_.q = known_q_;
    known_qd_ = sensed_.qd;
  }
}

Vector6 Controller::wanted_error_acceleration() const {
  const auto& [e, ed] = command_.error;
  Vector6 edd;
  for (int i = 0; i < 6; ++i)
    edd[i] = seeded(Fault::law_damping, -options_.damping[i] * ed[i]) - options_.stiffness[i] * e[i];
  // impedance: inertia e.. + D e. + K e = -(wrench on the tip)
  if (options_.virtual_inertia) edd -= known_tip_force_.cwiseQuotient(*options_.virtual_inertia);
  return edd;
}

void Controller::decide() {
  if (options_.constant_command) {
    command_.u = *options_.constant_command;
    return;
  }
  const Vector6 edd = wanted_error_acceleration();
  const Vector6& acceleration = command_.reference.acceleration;
  command_.u = options_.feedforward
                   ? tracking_.command(seeded(Fault::reference_acceleration, acceleration), edd)
                   : tracking_.command(Vector6::Zero(), edd);
  if (chart_) decide_in_coordinates();
  if (options_.force) {
    const ForceControl& force = *options_.force;
    for (std::size_t i = 0; i < force.rows.size(); ++i) {
      const int row = force.rows[i];
      // inertia v. = desired + wrench - inertia damping v
      command_.u[row] =
          (force.desired[i] + seeded(Fault::force_feedback, known_tip_force_[row])) / force.inertia -
          force.damping * command_.tip_velocity[row];
    }
  }
  if (!options_.obstacles.empty()) command_.u.tail<3>() += repulsion(options_.obstacles, command_.tip.p);
}

void Controller::decide_in_coordinates() {
  TipReference reference = command_.reference;
  if (!options_.feedforward) reference.velocity.setZero(), reference.acceleration.setZero();
  const Coordinates y = chart_->coordinates(command_.tip);
  const Coordinates yd = chart_->rates(y, command_.tip_velocity);
  Coordinates K(chart_->size()), D(chart_->size());
  const int turning = chart_->orientation_size();
  for (int i = 0; i < chart_->size(); ++i) {
    // A quaternion's four coordinates share the first gain.
    const int row = i >= turning ? 3 + i - turning : turning == 4 ? 0 : i;
    K[i] = options_.stiffness[row];
    D[i] = options_.damping[row];
  }
  const Coordinates v = tracking_acceleration(chart_->motion(reference, y), y, yd, K, D);
  const Vector6 u = seeded(Fault::coordinate_map, chart_->velocity(y, v)) +
                    seeded(Fault::coordinate_rate, chart_->bias(y, yd));
  if (chart_->orientation()) command_.u.head<3>() = u.head<3>();
  if (chart_->position()) command_.u.tail<3>() = u.tail<3>();
  command_.y = y;
  command_.v = chart_->attainable(y, yd, v);
}

}  // namespace osculate
