// What the coordinates of joints are called, and their units.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "model/urdf.hpp"

namespace osculate {

/// Names of a joint's position coordinates with their units; of one coordinate, the joint's name.
std::vector<std::pair<std::string, std::string>> position_coordinates(const JointInfo& joint);

/// Names of its velocity coordinates, and whether they are angular.
std::vector<std::pair<std::string, bool>> velocity_coordinates(const JointInfo& joint);

/// Names and units of the coordinates of all joints, base to tip.
struct CoordinateNames {
  std::vector<std::string> joints, positions, velocities;
  std::vector<std::string> position_units, velocity_units, acceleration_units, effort_units;
};
CoordinateNames coordinate_names(const std::vector<JointInfo>& joints);

}  // namespace osculate
