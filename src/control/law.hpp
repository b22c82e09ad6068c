// Operational space control (4) by the paper's recursions, with pose tracking.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "control/pose_error.hpp"
#include "control/reference.hpp"
#include "model/friction.hpp"
#include "recursion/operational_space.hpp"

namespace osculate {

enum class Law { operational_space /* (4) by the recursions */, free /* no torque: the free swing */ };

/// Omega(0) restricted to the task rows is not positive definite to working accuracy: no finite F gives the
/// command.
struct SingularTask : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct LawOptions {
  Law law = Law::operational_space;
  TaskRows rows = all_rows();
  Vector6 stiffness = Vector6::Constant(100);  // 1/s^2, each >= 0
  Vector6 damping = Vector6::Constant(20);     // 1/s, each >= 0
  double null_space_damping = 0;               // N m s/rad or N s/m, >= 0
  bool compensate_friction = true;
  std::optional<Vector6> constant_command;  // u itself, in place of pose tracking
};

/// What the law decided at one instant. Base frame, about the tip point, angular part first.
struct Command {
  TipReference reference;
  Pose tip;
  Vector6 tip_velocity = Vector6::Zero();
  PoseError error;
  Vector6 u =
      Vector6::Zero();  // commanded tip acceleration; rows that the task does not control are meaningless
  Vector6 F = Vector6::Zero();  // F_c(0); zero on rows that the task does not control
};

/// The operational-space terms of the model as the recursions give them, on the task rows (m <= 6).
struct RecursiveTerms {
  MatrixX<double> Omega;           // 6 x 6, all rows
  MatrixX<double> Lambda;          // m x m
  VectorX<double> c, g, c_plus_g;  // m
};

class Controller {
 public:
  /// `model` is what the controller believes of the arm. `initial` is the tip pose that the path is relative
  /// to.
  Controller(const Chain<double>& model, std::vector<JointFriction> friction, const LawOptions& options,
             std::shared_ptr<const Path> path, const Pose& initial);

  /// Joint torques, base to tip. Throws SingularTask. The result refers to this object and lasts until the
  /// next call.
  const Command& torque(double t, std::span<const double> q, std::span<const double> qd, std::span<double> T);

  /// The terms at the state of the last torque(), each by its own recursion; Omega alone where the arm is
  /// singular.
  RecursiveTerms terms(std::span<const double> qd);

  /// The result of the last torque().
  const Command& last() const { return command_; }
  /// Joint torque before friction compensation, J* F + null space, of the last torque(); base to tip.
  std::span<const double> rigid_torque() const { return rigid_torque_; }
  /// T0 of the last torque(), base to tip; all zero without null-space damping.
  std::span<const double> null_space_torque() const { return T0_; }
  const LawOptions& options() const { return options_; }
  const Path& path() const { return *path_; }
  const std::shared_ptr<const Path>& shared_path() const { return path_; }
  const std::vector<JointFriction>& friction() const { return friction_; }
  const Pose& initial() const { return initial_; }
  const Chain<double>& model() const { return model_; }

 private:
  TaskFactor<double> factor() const;
  /// First task row that depends on the rows before it, or -1.
  int lost_row(const TaskFactor<double>& Omega) const;

  Chain<double> model_;
  std::vector<JointFriction> friction_;
  LawOptions options_;
  std::shared_ptr<const Path> path_;
  Pose initial_;
  OperationalSpace<double> space_;
  std::vector<JointPosition<double>> joints_;
  std::vector<double> T0_, rigid_torque_;
  Command command_;
};

/// Pose of the tip of a chain at q (base to tip).
Pose tip_pose(const Chain<double>& chain, std::span<const double> q);

}  // namespace osculate
