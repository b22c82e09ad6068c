#include <algorithm>

#include "experiment/config.hpp"

namespace osculate {

void check_against(const Experiment& experiment, const ArmDescription& arm) {
  const auto n = arm.joints.size();
  const auto place_of = [&](std::string path) {
    for (; !path.empty();
         path.resize(path.find_last_of('.') == std::string::npos ? 0 : path.find_last_of('.')))
      if (const auto found = experiment.places.find(path); found != experiment.places.end())
        return found->second;
    return experiment.file.string();
  };
  std::string names;
  for (const auto& joint : arm.joints) names += (names.empty() ? "" : " ") + joint.name;
  const auto positions = static_cast<std::size_t>(arm.chain.positions());
  const auto velocities = static_cast<std::size_t>(arm.chain.velocities());
  const auto require_size = [&](const std::string& path, std::size_t size, std::size_t wanted) {
    if (size == wanted) return;
    const bool one_each = arm.chain.one_axis_joints();
    const std::string counted = wanted == positions ? "position coordinates" : "velocity coordinates";
    throw ConfigError(place_of(path) + ": " + path + " has " + std::to_string(size) +
                      " entries, the chain has " + std::to_string(wanted) +
                      (one_each ? " joints: " : " " + counted + " in its joints ") + names + ".");
  };
  const auto require_rates = [&](const std::string& path, std::size_t size) {
    if (size > 0) require_size(path, size, velocities);
  };
  const auto& plant = experiment.plant;
  require_size("initial.q", experiment.q.size(), positions);
  require_rates("initial.qd", experiment.qd.size());
  require_rates("model.armature", experiment.model.armature.size());
  require_rates("model.friction", experiment.model.friction.size());
  if (plant.armature) require_rates("plant.armature", plant.armature->size());
  if (plant.friction) require_rates("plant.friction", plant.friction->size());
  std::size_t first = 0;
  std::size_t first_position = 0;
  const std::vector<double> none;
  for (std::size_t i = 0; i < n; ++i) {
    const auto type = arm.chain.links[i].type;
    for (const auto& [path, armature] : {std::pair{"model.armature", &experiment.model.armature},
                                         {"plant.armature", plant.armature ? &*plant.armature : &none}})
      if (!armature->empty() && !one_axis(type))
        for (int j = 0; j < velocity_count(type); ++j)
          if ((*armature)[first + static_cast<std::size_t>(j)] != 0)
            throw ConfigError(place_of(path) + ": joint " + arm.joints[i].name +
                              " has several axes and no motor of its own: its armature must be 0.");
    const auto q = experiment.q.begin() + static_cast<std::ptrdiff_t>(first_position);
    if ((type == JointType::spherical || type == JointType::floating) &&
        std::all_of(q, q + 4, [](double x) { return x == 0; }))
      throw ConfigError(
          place_of("initial.q") + ": initial.q: joint " + arm.joints[i].name +
          " starts with the quaternion w x y z = 0 0 0 0, which is no orientation; 1 0 0 0 is that "
          "of the joint frame.");
    first += static_cast<std::size_t>(velocity_count(type));
    first_position += static_cast<std::size_t>(position_count(type));
  }

  const ControllerConfig& controller = experiment.controller;
  const auto rows = controller.rows.size();
  if (controller.law != Law::free && rows > velocities) {
    std::string some;
    for (std::size_t i = 0; i < std::min<std::size_t>(velocities, 3); ++i)
      some += std::string(i == 0 ? "" : ", ") + task_row_names[3 + i];
    throw ConfigError(place_of("controller.rows") + ": controller.rows has " + std::to_string(rows) +
                      " task rows, the chain has only " + std::to_string(velocities) +
                      (arm.chain.one_axis_joints() ? " joints (" : " coordinates in its joints (") + names +
                      "); choose at most " + std::to_string(velocities) +
                      ", for instance controller.rows: [" + some + "].");
  }
  if (controller.law == Law::resolved_acceleration && rows != velocities)
    throw ConfigError(place_of("controller.law") +
                      ": controller.law = resolved_acceleration solves J qdd = u - "
                      "Jdot qd, so it needs as many task rows as joint coordinates; here are " +
                      std::to_string(rows) + " and " + std::to_string(velocities) +
                      ". Choose controller.rows, or operational_space.");
  const auto controls = [&](int from) {
    for (int row = from; row < from + 3; ++row)
      if (std::find(controller.rows.begin(), controller.rows.end(), row) == controller.rows.end())
        return false;
    return true;
  };
  if (controller.orientation != OrientationCoordinates::rotation_vector && !controls(0))
    throw ConfigError(place_of("controller.orientation") +
                      ": controller.orientation needs the task rows wx, wy and wz: choose rotation_vector.");
  if (controller.position != PositionCoordinates::cartesian && !controls(3))
    throw ConfigError(place_of("controller.position") +
                      ": controller.position needs the task rows vx, vy and vz: choose cartesian.");
  const auto equal = [](const Vector6& gain) { return gain[0] == gain[1] && gain[1] == gain[2]; };
  if (controller.orientation == OrientationCoordinates::quaternion &&
      !(equal(controller.stiffness) && equal(controller.damping)))
    throw ConfigError(place_of("controller.gains") +
                      ": controller.gains must be equal for wx, wy and wz: the four numbers of a quaternion "
                      "share one gain.");
  const bool base_moves =
      experiment.base_motion && !std::holds_alternative<HoldOptions>(*experiment.base_motion);
  if (base_moves && controller.sampling && controller.sampling->delay != Delay::none)
    throw ConfigError(
        place_of("controller.sampling") +
        ": controller.sampling.delay: the delayed forms are for a base at rest; use delay: none "
        "or remove base_motion.");
}

}  // namespace osculate
