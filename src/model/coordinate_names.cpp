#include "model/coordinate_names.hpp"

namespace osculate {

std::vector<std::pair<std::string, std::string>> position_coordinates(const JointInfo& joint) {
  const auto named = [&joint](std::vector<std::pair<std::string, std::string>> list) {
    for (auto& entry : list) entry.first = joint.name + "." + entry.first;
    return list;
  };
  switch (joint.type) {
    case JointType::revolute:
      return {{joint.name, "rad"}};
    case JointType::prismatic:
      return {{joint.name, "m"}};
    case JointType::cylindrical:
      return named({{"angle", "rad"}, {"displacement", "m"}});
    case JointType::universal:
      return named({{"angle1", "rad"}, {"angle2", "rad"}});
    case JointType::planar:
      return named({{"x", "m"}, {"y", "m"}, {"angle", "rad"}});
    case JointType::spherical:
      return named({{"qw", "1"}, {"qx", "1"}, {"qy", "1"}, {"qz", "1"}});
    case JointType::floating:
      return named({{"qw", "1"}, {"qx", "1"}, {"qy", "1"}, {"qz", "1"}, {"x", "m"}, {"y", "m"}, {"z", "m"}});
  }
  return {};
}

std::vector<std::pair<std::string, bool>> velocity_coordinates(const JointInfo& joint) {
  std::vector<std::pair<std::string, bool>> out;
  if (joint.type == JointType::spherical || joint.type == JointType::floating) {
    for (const char* name : {"wx", "wy", "wz"}) out.emplace_back(joint.name + "." + name, true);
    if (joint.type == JointType::floating)
      for (const char* name : {"vx", "vy", "vz"}) out.emplace_back(joint.name + "." + name, false);
    return out;
  }
  for (const auto& [name, unit] : position_coordinates(joint)) out.emplace_back(name, unit == "rad");
  return out;
}

CoordinateNames coordinate_names(const std::vector<JointInfo>& joints) {
  CoordinateNames out;
  for (const JointInfo& joint : joints) {
    out.joints.push_back(joint.name);
    for (const auto& [name, unit] : position_coordinates(joint)) {
      out.positions.push_back(name);
      out.position_units.push_back(unit);
    }
    for (const auto& [name, turns] : velocity_coordinates(joint)) {
      out.velocities.push_back(name);
      out.velocity_units.push_back(turns ? "rad/s" : "m/s");
      out.acceleration_units.push_back(turns ? "rad/s^2" : "m/s^2");
      out.effort_units.push_back(turns ? "N m" : "N");
    }
  }
  return out;
}

}  // namespace osculate
