// The true arm under its controller as y' = f(t, y).
// y = (q, qd, work, dissipated, external): joint position and velocity coordinates base to tip, then three
// energies in J: work of the joint torques, energy lost in joint friction and at a surface, work of the
// constant wrench on the tip.
//
// Between events f is smooth. What switches it is a mode: whether the tip is in contact, and how many
// directions a truncating law leaves out. Modes change only where `switch_modes` is called.
#pragma once

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "control/law.hpp"
#include "recursion/forward_dynamics.hpp"
#include "simulation/contact.hpp"
#include "simulation/dense_plant.hpp"

namespace osculate {

/// The arm as it really is; its controller may believe something else.
struct Plant {
  Chain<double> chain;
  std::vector<JointFriction> friction;  // for each velocity coordinate; empty: none
  Vector6 tip_force =
      Vector6::Zero();  // N m, N: constant wrench on the tip, inertial axes, about the tip point
  std::optional<Environment> environment = {};  // a surface that the tip may touch
  bool dense = false;                           // accelerations by the definitions instead of the recursion
  /// Where plant and controller are the same arm at the same state, the plant takes over what the controller
  /// has computed there and no claim is about: cosines and sines, placement, velocities and the biases that
  /// depend on them. Never P, D, G, z and what follows from them, nor friction. False: shares nothing.
  bool share_kinematics = true;
};

/// Everything worth recording at one instant. Inertial frame, about the tip point, angular part first; joints
/// base to tip.
struct Observation {
  double t = 0;
  std::vector<double> q, qd, qdd, torque;
  Command command;
  Vector6 tip_acceleration = Vector6::Zero();          // of the plant, by its own recursion
  Vector6 tip_force = Vector6::Zero();                 // N m, N: all that pushes the tip
  Touch touch;                                         // of the tip at the surface; zero gap without one
  double kinetic = 0, potential = 0;                   // J
  double work = 0, dissipated = 0, external_work = 0;  // J, since the start
};

/// Where the arm is, how its tip moves and its energies at one instant: the part of an Observation that needs
/// no accelerations. Frames as there.
struct Whereabouts {
  std::span<const double> q;
  TipMotion tip;                                       // of the controller's model, as in a Command
  double kinetic = 0, potential = 0;                   // J
  double work = 0, dissipated = 0, external_work = 0;  // J, since the start
};

struct Modes {
  bool contact = false;
  int truncated = 0;  // directions that policy truncated leaves out
  bool operator==(const Modes&) const = default;
  void remember(Memory& memory) { memory(contact, truncated); }
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
  /// One sample of such a law: the torque that the next apply() puts on the joints. Throws IntegrationStopped
  /// where the law has no answer.
  void sample(double t, std::span<const double> y);
  void apply() { held_ = computed_; }

  /// y' = f(t, y). Throws IntegrationStopped where the law has no answer. Uses this object's workspace: one
  /// object for each integrator.
  void right_side(double t, const double* y, double* yd);

  /// Functions whose zeros are events: gap and pressure of a surface, the rim of each obstacle's field, and
  /// of a law that acts at every instant what its singularity policy looks at.
  int event_count() const;
  void events(double t, const double* y, double* g);
  /// The modes that (t, y) asks for become those of f. True if any changed. Throws IntegrationStopped where
  /// the arm is as singular as the law allows.
  bool switch_modes(double t, std::span<const double> y);
  const Modes& modes() const { return modes_; }
  void set_modes(const Modes& modes);

  /// The closed loop at (t, y) in full, by the lines that right_side runs. Valid until the next call.
  const Observation& observe(double t, std::span<const double> y);
  /// The same values as far as they go, by placement and sweep 1 alone. `q` of the result points into y.
  Whereabouts locate(double t, std::span<const double> y);

  Controller& controller() { return controller_; }
  const Controller& controller() const { return controller_; }
  const Plant& plant() const { return plant_; }
  BaseMotion<double> base(double t) const { return base_motion(controller_.options().base_path.get(), t); }
  /// True if the controller believes the truth: the same arm, friction compensated exactly, the wrench on the
  /// tip known. Then (5) must hold for a law that is (4).
  bool plant_is_model() const;
  /// The plant takes over the controller's kinematics (Plant::share_kinematics).
  bool shares_kinematics() const { return shares_kinematics_; }
  /// Joint torque minus friction that the plant felt in the last evaluation, base to tip.
  std::span<const double> net_torque() const { return net_torque_; }
  /// Tip velocity of the plant in the last evaluation, by its own recursion.
  Vector6 plant_tip_velocity() const;

  /// Modes, held torque and what the law keeps from sample to sample. A loop that is as it was made and reads
  /// them goes on as the one that wrote them. The values that a delay uses are computed anew, from the states
  /// of the samples that they depend on.
  void remember(Memory& memory);

 private:
  using Dynamics =
      std::variant<BasicForwardDynamics<Hinge<double>>, BasicForwardDynamics<Joint<double>>, DensePlant>;

  /// Places and moves the plant's links; what pushes the tip there.
  void move(double t, const double* y);
  /// The same from the controller's kinematics, after control() at the same (t, y).
  void follow(const double* y);
  /// Sets seen_.touch and seen_.tip_force from a plant that has moved.
  template <class PlantDynamics>
  void feel(const PlantDynamics& dynamics);
  /// The plant is the controller's model, exactly known at every instant, and nothing of its motion is needed
  /// before the law acts.
  bool same_arm_and_state() const;
  /// y' with or without a look at what the law sees where it does nothing (a free swing).
  void evaluate(double t, const double* y, double* yd, bool look);
  /// Kinetic and potential energy of the plant, which has moved, at joint velocities qd; J.
  std::pair<double, double> energies(std::span<const double> qd) const;
  /// The law's torque at (t, y), with its refusals as IntegrationStopped.
  void control(double t, const double* y);
  bool watches_singularity() const;

  Controller controller_;
  Plant plant_;
  Dynamics plant_dynamics_;
  int positions_, velocities_;
  bool one_axis_joints_, shares_kinematics_;
  Modes modes_;
  std::vector<JointPosition<double>> joints_;
  std::vector<double> net_torque_, computed_, held_;  // computed_ and held_: of a sampled law
  /// What one sample of a law with delay saw, and what its sensors knew before.
  struct Sample {
    double t = 0;  // s
    Modes modes;
    SensorMemory sensed;
    std::vector<double> y;

    void remember(Memory& memory) { memory(t, modes, sensed, y); }
  };
  std::vector<Sample> taken_;  // the last of them
  Observation seen_;
  std::vector<double> derivative_;
};

}  // namespace osculate
