// The true arm under its controller as y' = f(t, y).
// y = (q, qd, work, dissipated, external): joint position and velocity coordinates base to tip, then three
// energies in J: work of the joint torques, energy lost in joint friction, work of the external wrench on the
// tip.
#pragma once

#include <span>
#include <variant>
#include <vector>

#include "control/law.hpp"
#include "recursion/forward_dynamics.hpp"

namespace osculate {

/// The arm as it really is; its controller may believe something else.
struct Plant {
  Chain<double> chain;
  std::vector<JointFriction> friction;  // for each velocity coordinate; empty: none
  Vector6 tip_force = Vector6::Zero();  // N m, N: wrench on the tip, inertial axes, about the tip point
};

/// Everything worth recording at one instant. Inertial frame, about the tip point, angular part first; joints
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

  int positions() const { return positions_; }
  int velocities() const { return velocities_; }
  std::size_t states() const { return static_cast<std::size_t>(positions_ + velocities_) + 3; }
  std::span<const double> q(const double* y) const { return {y, static_cast<std::size_t>(positions_)}; }
  std::span<const double> qd(const double* y) const {
    return {y + positions_, static_cast<std::size_t>(velocities_)};
  }

  /// The law acts at sample times only; its torque is held in between.
  bool sampled() const { return controller_.options().sampling.has_value(); }
  /// One sample of such a law: the torque held from now on. Throws IntegrationStopped where the arm is
  /// singular.
  void sample(double t, std::span<const double> y);

  /// y' = f(t, y). Throws IntegrationStopped where the arm is singular. Uses this object's workspace: one
  /// object for each integrator.
  void right_side(double t, const double* y, double* yd);

  /// The closed loop at (t, y) in full, by the lines that right_side runs. Valid until the next call.
  const Observation& observe(double t, std::span<const double> y);

  Controller& controller() { return controller_; }
  const Controller& controller() const { return controller_; }
  const Plant& plant() const { return plant_; }
  BaseMotion<double> base(double t) const { return base_motion(controller_.options().base_path.get(), t); }
  /// True if the controller believes the truth: the same arm, friction compensated exactly, the wrench on the
  /// tip known. Then (5) must hold.
  bool plant_is_model() const;
  /// Joint torque minus friction that the plant felt in the last evaluation, base to tip.
  std::span<const double> net_torque() const { return net_torque_; }
  /// Tip velocity of the plant in the last evaluation, by its own recursion.
  Vector6 plant_tip_velocity() const;

 private:
  using Dynamics = std::variant<BasicForwardDynamics<Hinge<double>>, BasicForwardDynamics<Joint<double>>>;

  /// The law's torque at (t, y), with its refusals as IntegrationStopped.
  void control(double t, const double* y);

  Controller controller_;
  Plant plant_;
  Dynamics plant_dynamics_;
  int positions_, velocities_;
  Vec<Force, double> tip_force_;
  std::vector<JointPosition<double>> joints_;
  std::vector<double> net_torque_;
  Observation seen_;  // seen_.torque is what a sampled law holds
  std::vector<double> derivative_;
};

}  // namespace osculate
