// Operational space control (4) by the paper's recursions, with pose tracking.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <variant>
#include <vector>

#include "control/coordinates.hpp"
#include "control/memory.hpp"
#include "control/null_space.hpp"
#include "control/obstacles.hpp"
#include "control/pose_error.hpp"
#include "control/reference.hpp"
#include "control/singular_task.hpp"
#include "control/textbook_laws.hpp"
#include "model/friction.hpp"
#include "plugin/user_law.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/resolved_acceleration.hpp"

namespace osculate {

enum class Law {
  operational_space,      // (4) by the recursions
  resolved_acceleration,  // (16) by Newton-Euler; as many task rows as joint coordinates
  textbook,               // an equation evaluated with the dense terms, LawOptions.textbook
  user,                   // somebody else's, in a process of its own, LawOptions.user
  free,                   // no torque: the free swing
};

/// Omega(0) restricted to the task rows is not positive definite to working accuracy: no finite F gives the
/// command.
struct SingularArm : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The law is evaluated at t = 0, period, 2 period, ..., and its torque held in between.
struct Sampling {
  double period = 0.001;        // s, > 0
  Delay delay = Delay::none;    // what is taken from the sample before
  bool extrapolate = false;     // delayed values x(-1) become 2 x(-1) - x(-2)
  long monitor_every = 1;       // resolved acceleration: Lambda, c, g are computed at every N-th sample
  double computation_time = 0;  // s, 0 <= computation_time < period: the torque acts so much after its sample
  bool operator==(const Sampling&) const = default;
};

/// Force control of some task rows: u = (desired + wrench of the surface on the tip) / inertia - damping v.
struct ForceControl {
  TaskRows rows;                // among the task rows
  std::vector<double> desired;  // N m or N for each: what the tip exerts on its surroundings
  double inertia = 1;           // kg m^2 or kg, > 0
  double damping = 20;          // 1/s, >= 0
  bool operator==(const ForceControl&) const = default;
};

/// What a sampled law knows of the joints.
struct Sensors {
  double resolution = 0;       // rad or m, >= 0: positions are rounded to multiples of it; 0: exact
  double velocity_cutoff = 0;  // Hz, >= 0: velocities are differences of positions through a first-order low
                               // pass; 0: exact velocities
  bool operator==(const Sensors&) const = default;
};

struct LawOptions {
  Law law = Law::operational_space;
  TaskRows rows = all_rows();
  Vector6 stiffness = Vector6::Constant(100);  // 1/s^2, each >= 0
  Vector6 damping = Vector6::Constant(20);     // 1/s, each >= 0
  NullSpaceOptions null_space;
  bool compensate_friction = true;
  std::optional<Vector6> constant_command;  // u itself, in place of pose tracking
  OrientationCoordinates orientation = OrientationCoordinates::rotation_vector;
  PositionCoordinates position = PositionCoordinates::cartesian;
  std::optional<Sampling> sampling;  // none: the law acts at every instant
  TextbookLaw textbook = TextbookLaw::dense;
  bool feedforward = true;      // false: the reference's velocity and acceleration are taken as zero
  bool know_tip_force = false;  // the law measures the wrench on the tip and takes it into account
  std::optional<Vector6> virtual_inertia;  // kg m^2, kg, > 0: impedance, edd -= (wrench on the tip) / inertia
  std::optional<ForceControl> force;
  std::vector<Obstacle> obstacles;  // their fields add to the linear rows of u
  SingularityOptions singularity;
  std::optional<Sensors> sensors;    // of a sampled law
  std::vector<double> effort_limit;  // N m or N for each velocity coordinate: torques saturate; empty: never
  std::vector<double> constant_inertia;  // TextbookLaw::jacobian_transpose: kg m^2 and kg on the task rows
  std::shared_ptr<const Path> base_path = {};     // how the base moves in the inertial frame; none: at rest
  std::shared_ptr<const UserLawSetup> user = {};  // of Law::user
};

/// What the sensors of a sampled law gave at the sample before; empty before the first.
struct SensorMemory {
  std::vector<double> q, qd;  // measured, filtered

  void remember(Memory& memory) { memory(q, qd); }
};

/// What the law decided at one instant. Inertial frame, about the tip point, angular part first.
struct Command {
  TipReference reference;
  Pose tip;
  Vector6 tip_velocity = Vector6::Zero();
  PoseError error;
  Vector6 u =
      Vector6::Zero();  // commanded tip acceleration; rows that the task does not control are meaningless
  Vector6 F = Vector6::Zero();  // F_c(0); zero on rows that the task does not control
  Coordinates y, v;  // coordinates of the chart and their commanded second derivative; empty without a chart
  bool filtered = false;   // a singularity policy changed F
  bool saturated = false;  // a torque limit changed T
};

/// Up to six rows and columns, without allocation.
using UpTo6x6 = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using UpTo6 = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

/// The operational-space terms of the model as the recursions give them, on the task rows (m <= 6). Empty
/// where they do not exist.
struct RecursiveTerms {
  UpTo6x6 Omega;         // 6 x 6, all rows
  UpTo6x6 Lambda;        // m x m
  UpTo6 c, g, c_plus_g;  // m

  void remember(Memory& memory) { memory(Omega, Lambda, c, g, c_plus_g); }
};

/// Pose and velocity of the tip. Inertial frame, about the tip point, angular part first.
struct TipMotion {
  Pose pose;
  Vector6 velocity = Vector6::Zero();  // rad/s, m/s
};

/// Pose and motion of a base that moves along `path` (none: at rest) in the inertial frame.
BaseMotion<double> base_motion(const Path* path, double t);

/// The chart of the parts that are tracked in coordinates of their own; none for rotation vector and
/// Cartesian position.
std::optional<CoordinateChart> chart_of(OrientationCoordinates orientation, PositionCoordinates position);

class Controller {
 public:
  /// `model` is what the controller believes of the arm. `initial` is the tip pose that the path is relative
  /// to. Throws UserLawFailed where Law::user cannot be started.
  Controller(const Chain<double>& model, std::vector<JointFriction> friction, const LawOptions& options,
             std::shared_ptr<const Path> path, const Pose& initial);

  /// Joint torques, base to tip, of a law that acts at every instant; of a sampled one, the next sample.
  /// `tip_force`: wrench on the tip now, which a law that measures it takes into account. Throws SingularArm,
  /// RepresentationSingular, UserLawFailed, std::domain_error (at a joint limit or an obstacle whose field
  /// has no bound). The result refers to this object and lasts until the next call.
  const Command& torque(double t, std::span<const double> q, std::span<const double> qd, std::span<double> T,
                        const Vector6& tip_force = Vector6::Zero());

  /// Of a sampled law between its samples: reference, tip and error as they are at t; u, F, v as they were at
  /// the last sample.
  const Command& look(double t, std::span<const double> q, std::span<const double> qd);

  /// The terms at the state of the last torque() or look(), each by its own recursion; Omega alone where the
  /// arm is singular. Under resolved acceleration with a slower monitor, those of the last monitored sample.
  /// What the sweeps of that call have found is not computed again. Lasts until the next call.
  const RecursiveTerms& terms(std::span<const double> qd);

  /// The tip of the model at (t, q, qd), by placement and sweep 1 alone. Afterwards terms() needs a torque()
  /// or look().
  TipMotion tip_motion(double t, std::span<const double> q, std::span<const double> qd);

  /// Omega(0) of the model at (q, qd), all six rows, by sweeps 1 to 3 of the exact recursions.
  const Compliance<double>& compliance(double t, std::span<const double> q, std::span<const double> qd);
  /// Smooth measure of the distance from a singularity that the last torque() saw (singular_task.hpp);
  /// negative where it did not look.
  double last_measure() const { return measure_; }
  /// Number of directions that policy truncated leaves out; changes at events only.
  void set_truncated(int directions) { truncated_ = directions; }
  /// What to tell of an arm with this Omega that the law refuses: time, the task row most lost, remedy.
  std::string singular_message(double t, const Compliance<double>& Omega) const;

  /// The result of the last torque().
  const Command& last() const { return command_; }
  /// Joint torque before friction compensation, J* F + null space, of the last torque(); base to tip.
  std::span<const double> rigid_torque() const { return rigid_torque_; }
  /// Joint positions and velocities as the last torque() knew them: measured by sensors, or exact.
  std::span<const double> known_q() const { return known_q_; }
  std::span<const double> known_qd() const { return known_qd_; }
  /// The wrench on the tip that the last torque() took into account; zero if the law does not measure it.
  const Vector6& known_tip_force() const { return known_tip_force_; }
  /// Positions of the joints at the last torque() or look(), base to tip, trigonometry done.
  const std::vector<JointPosition<double>>& joints() const { return joints_; }
  /// The exact recursions where the joints have one axis each, else null; swept at the state of the last
  /// torque() of a law that uses them: operational_space without sampling, textbook, user, free.
  /// After tip_motion() placed, with sweep 1.
  const OperationalSpace<double>* exact_sweeps() const { return std::get_if<0>(&space_); }
  /// T0 of the last torque(), base to tip.
  std::span<const double> null_space_torque() const { return T0_; }
  /// Sweeps along the arm that the last torque() took, forward kinematics not counted.
  long sweeps_of_last_torque() const { return sweeps_; }
  /// Whether the monitor of a sampled resolved-acceleration law ran at the last sample.
  bool monitored() const { return monitored_; }
  const LawOptions& options() const { return options_; }
  /// The chart of coordinates that are tracked in place of rotation vector or Cartesian position.
  const std::optional<CoordinateChart>& chart() const { return chart_; }
  const Path& path() const { return *path_; }
  const std::shared_ptr<const Path>& shared_path() const { return path_; }
  const std::vector<JointFriction>& friction() const { return friction_; }
  const Pose& initial() const { return initial_; }
  const Chain<double>& model() const { return model_; }

  const SensorMemory& sensed() const { return sensed_; }
  void set_sensed(const SensorMemory& sensed) { sensed_ = sensed; }
  /// What a sampled law keeps from sample to sample, but for the values of old samples that a delay uses.
  void remember(Memory& memory) { memory(sensed_, samples_, seen_by_monitor_); }

 private:
  using Space = std::variant<BasicOperationalSpace<Hinge<double>>, BasicOperationalSpace<Joint<double>>>;
  using SampledSpace =
      std::variant<BasicOperationalSpace<LinkHinge<double>>, BasicOperationalSpace<LinkJoint<double>>>;
  using Resolved = std::variant<ResolvedAcceleration<Hinge<double>>, ResolvedAcceleration<Joint<double>>>;

  /// Sets joints and base; T0.
  void begin(double t, std::span<const double> q, std::span<const double> qd);
  /// Tip, reference and error at t.
  template <class Sweeps>
  void see_tip(const Sweeps& sweeps, double t);
  /// u, and v of a chart, from what see_tip found (command.cpp).
  void decide();
  /// Second derivative of the pose error that the gains ask for.
  Vector6 wanted_error_acceleration() const;
  /// u of a chart: Pi v + Pi. yd (1), on the part that it covers.
  void decide_in_coordinates();
  /// q and qd through the sensors of a sampled law.
  void sense(std::span<const double> q, std::span<const double> qd);
  /// F = Omega^-1 (u + right side) on the task rows, which becomes that of the command. Throws SingularArm.
  Vec<Force, double> tip_force(const Compliance<double>& Omega, const Vec<Motion, double>& right_side,
                               double t);
  template <class Sweeps>
  void terms_of(Sweeps& space, std::span<const double> qd, RecursiveTerms& out) const;
  void operational_space(double t, std::span<const double> qd);
  void resolved_acceleration(double t, std::span<const double> qd);
  void textbook(double t, std::span<const double> qd);
  /// Asks the law of Law::user, where the tip has been seen and u decided (user_law.cpp).
  void user(double t, std::span<const double> qd);
  /// Sets base and placement of the exact recursions at the present state.
  void place_exactly();
  /// Sweeps 1 to 3 of the exact recursions at the present state, for look() and the monitor.
  void sweep_exactly(std::span<const double> qd);

  Chain<double> model_;
  std::vector<JointFriction> friction_;
  LawOptions options_;
  std::shared_ptr<const Path> path_;
  Pose initial_;
  std::optional<CoordinateChart> chart_;
  Vector6 known_tip_force_ = Vector6::Zero();
  Vec<Force, double> known_push_;        // the same
  Space space_;                          // the exact recursions: the law itself, or its monitor
  std::optional<SampledSpace> sampled_;  // the same in link frames, with a memory
  std::optional<Resolved> resolved_;
  bool has_null_space_;  // else T0 stays zero
  std::vector<JointPosition<double>> joints_;
  BaseMotion<double> base_;
  std::vector<double> T0_, rigid_torque_;
  std::vector<double> known_q_, known_qd_;
  SensorMemory sensed_;
  double measure_ = -1;
  int truncated_ = 0;
  PoseTracking tracking_;  // of the reference as the law follows it
  Command command_;
  long sweeps_ = 0, samples_ = 0;
  bool monitored_ = true;
  RecursiveTerms terms_, seen_by_monitor_;
  bool swept_alone_ = false;  // space_ holds the right side of c + g, without T0 or a wrench on the tip
  UserLaw user_;
};

/// Pose of the tip of a chain at q (base to tip) on a base at rest.
Pose tip_pose(const Chain<double>& chain, std::span<const double> q);
/// The same in the inertial frame, on a base that stands as given.
Pose tip_pose(const Chain<double>& chain, std::span<const double> q, const BaseMotion<double>& base);

}  // namespace osculate
