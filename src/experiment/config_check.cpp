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
  const auto require_size = [&](const std::string& path, std::size_t size) {
    if (size == n) return;
    throw ConfigError(place_of(path) + ": " + path + " has " + std::to_string(size) +
                      " entries, the chain has " + std::to_string(n) + " joints: " + names + ".");
  };
  require_size("initial.q", experiment.q.size());
  if (!experiment.qd.empty()) require_size("initial.qd", experiment.qd.size());
  if (!experiment.model.armature.empty()) require_size("model.armature", experiment.model.armature.size());
  if (!experiment.model.friction.empty()) require_size("model.friction", experiment.model.friction.size());
  const auto& plant = experiment.plant;
  if (plant.armature && !plant.armature->empty()) require_size("plant.armature", plant.armature->size());
  if (plant.friction && !plant.friction->empty()) require_size("plant.friction", plant.friction->size());

  const auto rows = experiment.controller.rows.size();
  if (experiment.controller.law == Law::operational_space && rows > n) {
    std::string some;
    for (std::size_t i = 0; i < std::min<std::size_t>(n, 3); ++i)
      some += std::string(i == 0 ? "" : ", ") + task_row_names[3 + i];
    throw ConfigError(place_of("controller.rows") + ": controller.rows has " + std::to_string(rows) +
                      " task rows, the chain has only " + std::to_string(n) + " joints (" + names +
                      "); choose at most " + std::to_string(n) + ", for instance controller.rows: [" + some +
                      "].");
  }
}

}  // namespace osculate
