// Lists on the command line.
#pragma once

#include <string>
#include <vector>

#include "control/law.hpp"

namespace osculate {

inline constexpr const char* row_names[] = {"wx", "wy", "wz", "vx", "vy", "vz"};

/// Finite numbers separated by commas; `what` names the list in the ConfigError.
std::vector<double> parse_list(const std::string& text, const std::string& what);

/// "X,Y,Z" as a vector; `what` names it in the ConfigError.
Vector3<double> parse_vector3(const std::string& text, const std::string& what);

/// Names of task rows separated by commas; all six from an empty text. Throws ConfigError.
TaskRows parse_rows(const std::string& text);

/// Sets the armature of the joints with one axis from a list with one number for each joint, base to tip; an
/// empty text changes nothing. Throws ConfigError.
void set_armature(Chain<double>& chain, const std::string& text);

}  // namespace osculate
