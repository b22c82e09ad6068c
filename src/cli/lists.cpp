#include "cli/lists.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

#include "experiment/config.hpp"

namespace osculate {

std::vector<double> parse_list(const std::string& text, const std::string& what) {
  std::vector<double> out;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    std::string item = text.substr(from, to - from);
    item.erase(0, item.find_first_not_of(" \t"));
    item.erase(item.find_last_not_of(" \t\r") + 1);
    double value = 0;
    const char* begin = item.data() + (item.rfind('+', 0) == 0 ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, item.data() + item.size(), value);
    if (item.empty() || error != std::errc() || end != item.data() + item.size() || !std::isfinite(value))
      throw ConfigError(what + ": entry " + std::to_string(out.size() + 1) + " is '" + item +
                        "': give finite numbers separated by commas");
    out.push_back(value);
    from = to + 1;
  }
  return out;
}

TaskRows parse_rows(const std::string& text) {
  if (text.empty()) return all_rows();
  TaskRows rows;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    int row = 0;
    while (row < 6 && item != row_names[row]) ++row;
    if (row == 6) throw ConfigError("--rows: '" + item + "' is no task row: choose from wx,wy,wz,vx,vy,vz");
    if (std::find(rows.begin(), rows.end(), row) != rows.end())
      throw ConfigError("--rows: '" + item + "' is given twice");
    rows.push_back(row);
  }
  return rows;
}

Vector3<double> parse_vector3(const std::string& text, const std::string& what) {
  const std::vector<double> values = parse_list(text, what);
  if (values.size() != 3)
    throw ConfigError(what + " has " + std::to_string(values.size()) + " entries, needs 3: X,Y,Z");
  return {values[0], values[1], values[2]};
}

void set_armature(Chain<double>& chain, const std::string& text) {
  if (text.empty()) return;
  const std::vector<double> values = parse_list(text, "--armature");
  if (values.size() != chain.links.size())
    throw ConfigError("--armature has " + std::to_string(values.size()) + " entries, needs " +
                      std::to_string(chain.links.size()) + " (one for each joint, base to tip)");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string entry = "--armature: entry " + std::to_string(i + 1);
    if (values[i] < 0) throw ConfigError(entry + " is negative: give a moment of inertia or a mass");
    if (values[i] != 0 && !one_axis(chain.links[i].type))
      throw ConfigError(entry + " belongs to a joint with several axes, which has no rotor: give 0");
    chain.links[i].armature = values[i];
  }
}

}  // namespace osculate
