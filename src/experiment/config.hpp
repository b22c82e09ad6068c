// An experiment as a value: what the YAML file says, every default filled in.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "control/law.hpp"
#include "control/reference.hpp"
#include "model/friction.hpp"
#include "model/urdf.hpp"
#include "simulation/contact.hpp"
#include "simulation/integrator.hpp"

namespace osculate {

/// Names of the six task rows, angular part first.
inline constexpr std::array<const char*, 6> task_row_names{"wx", "wy", "wz", "vx", "vy", "vz"};

/// A configuration that cannot be used. The message starts with file:line:column: and names key, value and
/// remedy.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Body added to the tip link of the true arm.
struct Payload {
  double mass = 0;                                    // kg, >= 0
  Vector3<double> com = Vector3<double>::Zero();      // m, tip frame
  Matrix3<double> inertia = Matrix3<double>::Zero();  // kg m^2, about its centre of mass, tip axes
};

enum class PlantDynamics { recursive /* O(n), (51) */, dense /* M^-1 by the definitions */ };

struct ModelConfig {
  std::filesystem::path urdf;                 // absolute after reading
  std::optional<std::string> urdf_text = {};  // what is in it, if that is known already
  ChainChoice choice;                         // keys: base, tip, gravity, side_branches
  std::vector<double> armature;         // kg m^2 or kg for each velocity coordinate, base to tip; empty: none
  std::vector<JointFriction> friction;  // for each velocity coordinate; empty: none
};

/// How the true arm differs from the controller's model. Absent: as the model.
struct PlantConfig {
  Payload payload;
  std::optional<std::vector<double>> armature;
  std::optional<std::vector<JointFriction>> friction;
  double mass_scale = 1;                // every link's mass and inertia times this, > 0
  std::vector<double> link_mass_scale;  // the same for each link by itself, base to tip; empty: 1
  double inertia_scale = 1;             // every link's inertia about its centre of mass times this, > 0
  Vector6 tip_force = Vector6::Zero();  // N m, N: constant wrench on the tip, base axes, about the tip point
  std::optional<Environment> environment;  // a surface that the tip may touch
  PlantDynamics dynamics = PlantDynamics::recursive;
  bool share_kinematics = true;  // where the plant is the model: simulation/closed_loop.hpp
};

using ReferenceConfig = std::variant<HoldOptions, StepOptions, LineOptions, CircleOptions, LissajousOptions,
                                     WaypointsOptions, EachAxisOptions, MultisineOptions>;

/// `null_space` as the file says it; what it takes from the arm is filled in later.
struct NullSpaceConfig {
  double damping = 0;  // N m s/rad or N s/m
  double posture_stiffness = 0;
  std::optional<std::vector<double>> posture;  // absent with a stiffness: the initial q
  double limit_gain = 0, limit_margin = 0.2;   // limits of the URDF file
  double manipulability = 0;
  bool operator==(const NullSpaceConfig&) const = default;
};

/// Torque limits of the law.
enum class EffortLimit { none, model /* <limit effort> of the URDF file */, list };

struct ControllerConfig {
  Law law = Law::operational_space;
  std::vector<int> rows{0, 1, 2, 3, 4, 5};     // controlled task rows; YAML names wx wy wz vx vy vz
  Vector6 stiffness = Vector6::Constant(100);  // 1/s^2 for each axis, >= 0; YAML: a number or six
  Vector6 damping = Vector6::Constant(20);     // 1/s for each axis, >= 0
  TextbookLaw textbook = TextbookLaw::dense;   // with Law::textbook
  UserLawOptions user;                         // with Law::user; paths absolute after reading
  NullSpaceConfig null_space;                  // redundant arms
  bool feedforward = true;                     // velocity and acceleration of the reference are part of u
  bool compensate_friction = true;             // add the model's joint friction to the torque
  bool compensate_tip_force = false;           // the law measures the wrench on the tip
  std::optional<Vector6> virtual_inertia;  // impedance control; stiffness and damping then in N/m, N s/m, ...
  std::optional<ForceControl> force;
  std::vector<Obstacle> obstacles;
  SingularityOptions singularity;
  std::optional<Sensors> sensors;
  EffortLimit effort_limit = EffortLimit::none;
  std::vector<double> effort_limits;  // with EffortLimit::list: N m or N for each velocity coordinate
  OrientationCoordinates orientation = OrientationCoordinates::rotation_vector;
  PositionCoordinates position = PositionCoordinates::cartesian;
  std::optional<Sampling> sampling;  // none: the law acts at every instant
};

struct IntegratorConfig {
  Method method = Method::adams;
  double rtol = 1e-10;           // 1e-14 <= rtol < 1
  double atol_position = 1e-12;  // rad or m; YAML atol: one number, or {position: , velocity: }
  double atol_velocity = 1e-12;  // rad/s or m/s
  double max_step = 0;           // s; 0: chosen by the program
  long max_steps = 50'000'000;   // a run that needs more stops early
  JacobianBy jacobian = JacobianBy::automatic;  // of bdf; differences where the loop has no other
};

struct OutputConfig {
  double interval = 0.01;         // s, > 0
  double restart_interval = 100;  // s, >= 0: simulated time between restart points; 0: none
};

struct VerifyConfig {
  long every = 1;  // check every N-th accepted step; YAML `step` means 1
  enum class Record { all, worst, every } record = Record::all;
  long record_every = 1;  // with Record::every; YAML `record: N`
  bool shadow = true;     // shadow run at tolerance / 100: the global error estimate
  bool poles = false;     // linearise the closed loop at the start and judge its poles
};

/// What changes from run to run in `osculate sweep`: each variant is a name with its overrides.
struct SweepConfig {
  struct Variant {
    std::string name;
    std::vector<std::string> overrides;  // "key.path=value" as of --set, the value on one line of YAML
    std::optional<double> value;         // of the swept number, where one number is swept
  };
  std::string key;                // the swept key, or "" where variants are given one by one
  std::vector<Variant> variants;  // empty: nothing to sweep
};

/// Exit code 0 means exactly this came true. Empty: every claim passes and the run completes.
struct ExpectConfig {
  std::string stop;  // "" or "singular" | "non_finite" | "step_too_small" | "too_many_steps" | "law"
  std::vector<std::string> fails;  // claim ids
};

struct Experiment {
  std::string name;
  std::filesystem::path file;            // where it was read, for messages
  std::filesystem::path directory = {};  // where relative paths start, absolute
  ModelConfig model;
  PlantConfig plant;
  std::vector<double> q, qd;  // base to tip; qd empty: at rest
  ReferenceConfig reference;
  std::optional<ReferenceConfig> base_motion;  // of the base in the inertial frame; none: at rest
  ControllerConfig controller;
  IntegratorConfig integrator;
  double duration = 10;  // s, > 0
  OutputConfig output;
  VerifyConfig verify;
  ExpectConfig expect;
  SweepConfig sweep;
  std::map<std::string, std::string>
      places;  // key path -> file:line:column, for the messages of check_against
};

/// Reads a file; `overrides` are "key.path=value" of --set, values in YAML. Lengths that depend on the arm
/// (q, armature, friction) are checked by `check_against`. Every variant of a sweep is read too, and refused
/// with its name.
Experiment read_experiment(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});
/// The same from text; relative paths are relative to `directory`.
Experiment parse_experiment(const std::string& text, const std::string& source,
                            const std::filesystem::path& directory,
                            const std::vector<std::string>& overrides = {});
/// What --set needs to make `variant` the experiment: `overrides` that were given already, no sweep, and then
/// its own.
std::vector<std::string> overrides_of(const SweepConfig::Variant& variant,
                                      const std::vector<std::string>& overrides = {});
/// Throws ConfigError where a list does not have one entry for each joint, a row is out of reach, ...
void check_against(const Experiment& experiment, const ArmDescription& arm);
/// The resolved experiment as YAML: reading it back gives an equal value. Numbers keep every bit.
std::string to_yaml(const Experiment& experiment);

}  // namespace osculate
