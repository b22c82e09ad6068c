#include <algorithm>

#include "experiment/config.hpp"

namespace osculate {
namespace {

/// An experiment and its arm, with the words that messages need.
struct Check {
  const Experiment& experiment;
  const ArmDescription& arm;
  std::size_t positions = static_cast<std::size_t>(arm.chain.positions());
  std::size_t velocities = static_cast<std::size_t>(arm.chain.velocities());
  bool one_axis_joints = arm.chain.one_axis_joints();
  std::string names = joint_names();

  std::string joint_names() const {
    std::string out;
    for (const auto& joint : arm.joints) out += (out.empty() ? "" : " ") + joint.name;
    return out;
  }

  /// Throws "place: text" with the place of `path`, or of the nearest map around it.
  [[noreturn]] void fail(std::string path, const std::string& text) const {
    std::string place = experiment.file.string();
    while (!path.empty()) {
      if (const auto found = experiment.places.find(path); found != experiment.places.end()) {
        place = found->second;
        break;
      }
      const auto dot = path.find_last_of('.');
      path.resize(dot == std::string::npos ? 0 : dot);
    }
    throw ConfigError(place + ": " + text);
  }

  /// `counted`: what the list has one entry for, where joints may have several axes.
  void require_size(const std::string& path, std::size_t size, std::size_t wanted,
                    const std::string& counted) const {
    if (size == wanted) return;
    fail(path, path + " has " + std::to_string(size) + " entries, the chain has " + std::to_string(wanted) +
                   (one_axis_joints ? " joints: " : " " + counted + " in its joints ") + names + ".");
  }
  void require_positions(const std::string& path, std::size_t size) const {
    require_size(path, size, positions, "position coordinates");
  }
  void require_rates(const std::string& path, std::size_t size) const {
    require_size(path, size, velocities, "velocity coordinates");
  }

  void lists() const;
  void joints() const;
  void rows() const;
  void coordinates() const;
  void null_space() const;
  void effort_limit() const;
};

void Check::lists() const {
  const auto& model = experiment.model;
  const auto& plant = experiment.plant;
  require_positions("initial.q", experiment.q.size());
  if (!experiment.qd.empty()) require_rates("initial.qd", experiment.qd.size());
  if (!model.armature.empty()) require_rates("model.armature", model.armature.size());
  if (!model.friction.empty()) require_rates("model.friction", model.friction.size());
  if (plant.armature && !plant.armature->empty()) require_rates("plant.armature", plant.armature->size());
  if (plant.friction && !plant.friction->empty()) require_rates("plant.friction", plant.friction->size());
  if (const auto size = plant.link_mass_scale.size(); size != 0 && size != arm.joints.size())
    fail("plant.mass_scale", "plant.mass_scale has " + std::to_string(size) +
                                 " entries; give one number, or one for each of the " +
                                 std::to_string(arm.joints.size()) + " links that the joints " + names +
                                 " carry.");
}

void Check::joints() const {
  const auto& plant = experiment.plant;
  const std::vector<double> none;
  std::size_t first = 0, first_position = 0;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto type = arm.chain.links[i].type;
    for (const auto& [path, armature] : {std::pair{"model.armature", &experiment.model.armature},
                                         {"plant.armature", plant.armature ? &*plant.armature : &none}})
      if (!armature->empty() && !one_axis(type))
        for (int j = 0; j < velocity_count(type); ++j)
          if ((*armature)[first + static_cast<std::size_t>(j)] != 0)
            fail(path, path + (": joint " + arm.joints[i].name) +
                           " has several axes and no motor of its own: its armature must be 0.");
    const auto q = experiment.q.begin() + static_cast<std::ptrdiff_t>(first_position);
    if ((type == JointType::spherical || type == JointType::floating) &&
        std::all_of(q, q + 4, [](double x) { return x == 0; }))
      fail("initial.q", "initial.q: joint " + arm.joints[i].name +
                            " starts with the quaternion w x y z = 0 0 0 0, which is no orientation; "
                            "1 0 0 0 is that of the joint frame.");
    first += static_cast<std::size_t>(velocity_count(type));
    first_position += static_cast<std::size_t>(position_count(type));
  }
}

void Check::rows() const {
  const auto& controller = experiment.controller;
  const auto count = controller.rows.size();
  if (controller.law != Law::free && count > velocities) {
    std::string some;
    for (std::size_t i = 0; i < std::min<std::size_t>(velocities, 3); ++i)
      some += std::string(i == 0 ? "" : ", ") + task_row_names[3 + i];
    fail("controller.rows", "controller.rows has " + std::to_string(count) +
                                " task rows, the chain has only " + std::to_string(velocities) +
                                (one_axis_joints ? " joints (" : " coordinates in its joints (") + names +
                                "); choose at most " + std::to_string(velocities) +
                                ", for instance controller.rows: [" + some + "].");
  }
  if (controller.law == Law::resolved_acceleration && count != velocities)
    fail(
        "controller.law",
        "controller.law = resolved_acceleration solves J qdd = u - Jdot qd, so it needs as many task rows as "
        "joint coordinates; here are " +
            std::to_string(count) + " and " + std::to_string(velocities) +
            ". Choose controller.rows, or operational_space.");
}

void Check::coordinates() const {
  const auto& controller = experiment.controller;
  const auto controls = [&](int from) {
    for (int row = from; row < from + 3; ++row)
      if (std::find(controller.rows.begin(), controller.rows.end(), row) == controller.rows.end())
        return false;
    return true;
  };
  if (controller.orientation != OrientationCoordinates::rotation_vector && !controls(0))
    fail("controller.orientation",
         "controller.orientation needs the task rows wx, wy and wz: choose rotation_vector.");
  if (controller.position != PositionCoordinates::cartesian && !controls(3))
    fail("controller.position", "controller.position needs the task rows vx, vy and vz: choose cartesian.");
  if (!controller.obstacles.empty() && !controls(3))
    fail("controller.obstacles",
         "controller.obstacles needs the task rows vx, vy and vz: add them to controller.rows.");
  const auto equal = [](const Vector6& gain) { return gain[0] == gain[1] && gain[1] == gain[2]; };
  if (controller.orientation == OrientationCoordinates::quaternion &&
      !(equal(controller.stiffness) && equal(controller.damping)))
    fail(
        "controller.gains",
        "controller.gains must be equal for wx, wy and wz: the four numbers of a quaternion share one gain.");
  const bool base_moves =
      experiment.base_motion && !std::holds_alternative<HoldOptions>(*experiment.base_motion);
  if (base_moves && controller.sampling && controller.sampling->delay != Delay::none)
    fail("controller.sampling.delay",
         "controller.sampling.delay: the delayed forms are for a base at rest; use delay: none or remove "
         "base_motion.");
}

void Check::null_space() const {
  const auto& null_space = experiment.controller.null_space;
  const bool posture = null_space.posture_stiffness > 0 || null_space.posture;
  for (const auto& [path, acts] : {std::pair{"controller.null_space.posture", posture},
                                   {"controller.null_space.limits", null_space.limit_gain > 0},
                                   {"controller.null_space.manipulability", null_space.manipulability > 0},
                                   {"controller.sensors", experiment.controller.sensors.has_value()}})
    if (acts && !one_axis_joints)
      fail(path, std::string(path) + " is for joints with one axis each; this chain has others: remove it.");
  if (null_space.posture) require_positions("controller.null_space.posture.q", null_space.posture->size());
  if (!(null_space.limit_gain > 0)) return;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto& joint = arm.joints[i];
    const double q = experiment.q[i];
    if ((joint.lower && q <= *joint.lower) || (joint.upper && q >= *joint.upper))
      fail("initial.q", "initial.q: joint " + joint.name +
                            " starts at or beyond its limit, where controller.null_space.limits has no "
                            "value: start between the limits of the URDF file.");
  }
}

void Check::effort_limit() const {
  const auto& controller = experiment.controller;
  if (controller.effort_limit == EffortLimit::list)
    require_rates("controller.effort_limit", controller.effort_limits.size());
  if (controller.effort_limit != EffortLimit::model) return;
  std::string without;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto& joint = arm.joints[i];
    const bool has = joint.effort && *joint.effort > 0 && one_axis(arm.chain.links[i].type);
    if (!has) without += (without.empty() ? "" : " ") + joint.name;
  }
  if (!without.empty())
    fail("controller.effort_limit",
         "controller.effort_limit = model: the URDF file gives no <limit effort> for each axis of " +
             without + "; give a list of torques, one for each velocity coordinate.");
}

}  // namespace

void check_against(const Experiment& experiment, const ArmDescription& arm) {
  const Check check{experiment, arm};
  check.lists();
  check.joints();
  check.rows();
  check.coordinates();
  check.null_space();
  check.effort_limit();
}

}  // namespace osculate
