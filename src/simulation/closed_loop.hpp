// The true arm under its controller as y' = f(t, y).
// y = (q, qd, work, dissipated, external): joint coordinates and rates base to tip, then three energies in J:
// work of the joint torques, energy lost in joint friction, work of the external wrench on the tip.
#pragma once

#include <span>
#include <vector>

#include "control/law.hpp"
#include "recursion/forward_dynamics.hpp"

namespace osculate {

/// The arm as it really is; its controller may believe something else.
struct Plant {
  Chain<double> chain;
  std::vector<JointFriction> friction;  // empty: none
  Vector6 tip_force = Vector6::Zero();  // N m, N: wrench on the tip, base axes, about the tip point
};

/// Everything worth recording at one instant. Base frame, about the tip point, angular part first; joints
/// base to tip.
struct Observation {
  double t = 0;
  std::vector<double> q, qd, qdd, torque;
  Command command;
  Vector6 tip_acceleration = Vector6::Zero();          // of the plant, by its own recursion
  double kinetic = 0, potential = 0;                   // J
  double work = 0, dissipated = 0, external_work = 0;  // J, since the start
};

class ClosedLoop {
 public:
  ClosedLoop(Controller controller, Plant plant);

  int joints() const { return plant_dynamics_.n(); }
  std::size_t states() const { return 2 * static_cast<std::size_t>(joints()) + 3; }

  /// y' = f(t, y). Throws IntegrationStopped where the arm is singular. Uses this object's workspace: one
  /// object for each integrator.
  void right_side(double t, const double* y, double* yd);

  /// The closed loop at (t, y) in full, by the lines that right_side runs. Valid until the next call.
  const Observation& observe(double t, std::span<const double> y);

  Controller& controller() { return controller_; }
  const Controller& controller() const { return controller_; }
  const Plant& plant() const { return plant_; }
  /// True if the controller believes the truth: the same arm, friction compensated exactly, no wrench on the
  /// tip. Then (5) must hold.
  bool plant_is_model() const;
  /// Joint torque minus friction that the plant felt in the last evaluation, base to tip.
  std::span<const double> net_torque() const { return net_torque_; }
  /// Tip velocity of the plant in the last evaluation, by its own recursion.
  Vector6 plant_tip_velocity() const;

 private:
  Controller controller_;
  Plant plant_;
  ForwardDynamics<double> plant_dynamics_;
  Vec<Force, double> tip_force_;
  std::vector<JointPosition<double>> joints_;
  std::vector<double> net_torque_;
  Observation seen_;
  std::vector<double> derivative_;
};

}  // namespace osculate
