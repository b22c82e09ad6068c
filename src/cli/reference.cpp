#include "cli/reference.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <ostream>

#include "cli/json.hpp"
#include "cli/lists.hpp"
#include "experiment/arms.hpp"
#include "experiment/provenance.hpp"
#include "input/sha256.hpp"
#include "jury/reference_data.hpp"
#include "model/coordinate_names.hpp"
#include "record/result_file.hpp"

namespace osculate {

namespace {

using jury::Constant;
using jury::JointState;
using jury::Quantity;
using jury::ReferenceData;

/// Entries of M that a file may have: 40 MB; all quantities together take about 12 times as much.
constexpr double most_numbers = 5e6;

/// What a reader has to know, in the order of writing: name and sentence.
std::vector<std::array<std::string, 2>> conventions() {
  return {
      {"component_order", "spatial vectors and rows of J: angular x y z, then linear x y z"},
      {"frame", "tip quantities in the axes of the base link, about the origin of the tip link"},
      {"accelerations", "ordinary (classical): the second derivative of the tip point's position"},
      {"joint_order", "base to tip; names along the axes joint, position_coordinate, velocity_coordinate"},
      {"gravity", "given as the acceleration of free fall; G is added on the left: M qdd + C + G = tau"},
      {"quaternion", "w x y z, w >= 0, turns vectors of the tip's axes into base axes"},
      {"velocities",
       "qd is the derivative of q, but for floating joints: angular velocity in link axes, then "
       "velocity of the link's origin in joint axes"},
      {"task", "Omega = J M^-1 J* on the task rows, Lambda its inverse, T = J* (Lambda u + c + g)"},
      {"missing", "Lambda, c, g, F, T and cond_Omega are NaN (HDF5) or null (JSON) where rank < task rows"},
      {"units", "SI units and radians"},
      {"accuracy",
       "computed with 113-bit numbers and rounded once to double; `difference` is what that leaves unsure, "
       "relative to the largest entry"},
  };
}

std::vector<Text> descriptions(const ReferenceOptions& options, const ArmDescription& arm) {
  std::vector<Text> out;
  for (const auto& [name, sentence] : conventions()) out.push_back({"conventions/" + name, sentence, ""});
  out.push_back({"generator/definition", jury::definition(), "how the states were drawn"});
  out.push_back({"generator/seed", std::to_string(options.seed), "start of the random numbers"});
  out.push_back({"provenance/model", arm.urdf_text, "model file, URDF"});
  out.push_back({"provenance/model_sha256", sha256(arm.urdf_text), "SHA-256 of the model file"});
  out.push_back({"provenance/robot", arm.robot, "robot of the model file"});
  out.push_back({"provenance/base", arm.base, "base link"});
  out.push_back({"provenance/tip", arm.tip, "tip link"});
  out.push_back({"provenance/side_branches",
                 options.choice.side_branches == SideBranches::drop ? "drop" : "lump",
                 "links beside the chain: lumped into it, or left out"});
  out.push_back({"provenance/program_version", version(), "version of osculate"});
  return out;
}

std::vector<std::string> joint_types(const ArmDescription& arm) {
  constexpr const char* names[] = {"revolute", "prismatic", "cylindrical", "universal",
                                   "planar",   "spherical", "floating"};
  std::vector<std::string> out;
  for (const JointInfo& joint : arm.joints) out.emplace_back(names[static_cast<std::size_t>(joint.type)]);
  return out;
}

std::vector<std::string> state_kinds(const ReferenceData& data) {
  std::vector<std::string> out;
  for (const JointState& state : data.states) out.push_back(name_of(state.kind));
  return out;
}

void write_hdf5_file(const ReferenceOptions& options, const ArmDescription& arm, const TaskRows& rows,
                     const ReferenceData& data) {
  const CoordinateNames names = coordinate_names(arm.joints);
  const std::vector<std::string> spatial(std::begin(row_names), std::end(row_names)), xyz{"x", "y", "z"};
  std::vector<std::string> task;
  for (const int row : rows) task.emplace_back(row_names[row]);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < data.states.size(); ++i) numbers.push_back(static_cast<double>(i));

  Layout layout;
  layout.title = arm.robot + ": reference data for tests";
  layout.axes = {
      {"state", {}, "1", "number of the state", numbers},
      {"joint", names.joints, "", "joints, base to tip"},
      {"position_coordinate", names.positions, "", "joint position coordinates, base to tip"},
      {"velocity_coordinate", names.velocities, "", "joint velocity coordinates, base to tip"},
      {"velocity_coordinate_column", names.velocities, "", "columns of M"},
      {"spatial", spatial, "", "spatial components, angular first, base frame, about the tip point"},
      {"task_row", task, "", "task rows"},
      {"task_row_column", task, "", "columns of Omega and Lambda"},
      {"xyz", xyz, "", "components in the base frame, or where said otherwise"},
      {"xyz_column", xyz, "", "columns of a 3 x 3 matrix"},
      {"tip_axis", xyz, "", "axes of the tip link"},
      {"quaternion_component", {"w", "x", "y", "z"}, "", "quaternion components"},
  };
  std::vector<std::string> quantities;
  for (const Quantity& quantity : data.quantities) quantities.push_back(quantity.name);
  layout.axes.push_back({"quantity", quantities, "", "names of the datasets along state"});
  layout.lists = {
      {"kind", "state", state_kinds(data), "random, nearly_singular or at_rest"},
      {"joint_type", "joint", joint_types(arm), "how the joint moves"},
      {"position_unit", "position_coordinate", names.position_units, "unit of joint positions"},
      {"velocity_unit", "velocity_coordinate", names.velocity_units, "unit of joint velocities"},
      {"acceleration_unit", "velocity_coordinate", names.acceleration_units, "unit of joint accelerations"},
      {"effort_unit", "velocity_coordinate", names.effort_units, "unit of joint torques and forces"},
  };
  layout.texts = descriptions(options, arm);

  Ending ending;
  std::vector<double> difference;
  for (const Quantity& quantity : data.quantities) {
    std::vector<std::string> axes{"state"};
    axes.insert(axes.end(), quantity.axes.begin(), quantity.axes.end());
    const std::string units = quantity.units.empty() ? "" : "; unit: " + quantity.units;
    ending.tables.push_back({quantity.name, axes, quantity.unit, quantity.meaning + units, quantity.values});
    difference.push_back(quantity.difference >= 0 ? quantity.difference
                                                  : std::numeric_limits<double>::quiet_NaN());
  }
  ending.tables.push_back({"rank",
                           {"state"},
                           "1",
                           "rank of Omega scaled to unit diagonal",
                           std::vector<double>(data.rank.begin(), data.rank.end())});
  ending.tables.push_back({"difference",
                           {"quantity"},
                           "1",
                           "largest difference of definitions and recursions over 113 bits, relative to the "
                           "largest entry at the state",
                           difference});
  for (const Constant& constant : data.arm)
    ending.tables.push_back(
        {"arm/" + constant.name, constant.axes, constant.unit, constant.meaning, constant.values});
  ResultFile file(options.output, layout, options.force);
  file.finish("complete", "", ending);
}

/// Nested arrays of the given extents from a flat list, by rows.
const double* nested(Json& json, const double* at, const std::vector<std::size_t>& extent,
                     std::size_t level) {
  if (level == extent.size()) {
    json.value(*at);
    return at + 1;
  }
  json.begin_array();
  for (std::size_t i = 0; i < extent[level]; ++i) at = nested(json, at, extent, level + 1);
  json.end_array();
  return at;
}

void write_json_file(const ReferenceOptions& options, const ArmDescription& arm, const TaskRows& rows,
                     const ReferenceData& data) {
  if (std::filesystem::exists(options.output) && !options.force)
    throw FileError(options.output.string() +
                    ": exists already; use --force to overwrite it, or choose another output");
  // Under another name until it is complete.
  const std::filesystem::path unfinished = std::filesystem::path(options.output) += ".tmp";
  std::ofstream file(unfinished);
  if (!file) throw FileError(unfinished.string() + ": cannot be written; choose another output");
  const CoordinateNames names = coordinate_names(arm.joints);
  std::map<std::string, std::size_t> sizes{{"joint", names.joints.size()},
                                           {"position_coordinate", names.positions.size()},
                                           {"velocity_coordinate", names.velocities.size()},
                                           {"velocity_coordinate_column", names.velocities.size()},
                                           {"spatial", 6},
                                           {"task_row", rows.size()},
                                           {"task_row_column", rows.size()},
                                           {"xyz", 3},
                                           {"xyz_column", 3},
                                           {"tip_axis", 3},
                                           {"quaternion_component", 4}};
  const auto extent = [&sizes](const std::vector<std::string>& axes) {
    std::vector<std::size_t> out;
    for (const std::string& axis : axes) out.push_back(sizes.at(axis));
    return out;
  };
  Json json(file);
  const auto list = [&json](const std::vector<std::string>& texts) {
    json.begin_array();
    for (const std::string& text : texts) json.value(text);
    json.end_array();
  };
  json.begin_object();
  std::string group;  // texts come in groups: "conventions/frame"
  for (const Text& text : descriptions(options, arm)) {
    const auto slash = text.path.find('/');
    if (text.path.substr(0, slash) != group) {
      if (!group.empty()) json.end_object();
      group = text.path.substr(0, slash);
      json.key(group).begin_object();
    }
    json.key(text.path.substr(slash + 1)).value(text.value);
  }
  json.end_object();
  json.key("joint"), list(names.joints);
  json.key("joint_type"), list(joint_types(arm));
  json.key("position_coordinate"), list(names.positions);
  json.key("velocity_coordinate"), list(names.velocities);
  json.key("position_unit"), list(names.position_units);
  json.key("velocity_unit"), list(names.velocity_units);
  json.key("acceleration_unit"), list(names.acceleration_units);
  json.key("effort_unit"), list(names.effort_units);
  json.key("task_row").begin_array();
  for (const int row : rows) json.value(std::string(row_names[row]));
  json.end_array();
  json.key("arm").begin_object();
  for (const Constant& constant : data.arm) {
    json.key(constant.name);
    nested(json, constant.values.data(), extent(constant.axes), 0);
  }
  json.end_object();
  json.key("quantities").begin_object();
  for (const Quantity& quantity : data.quantities) {
    json.key(quantity.name).begin_object();
    json.key("meaning").value(quantity.meaning);
    json.key("unit").value(quantity.unit.empty() ? quantity.units : quantity.unit);
    json.key("axes"), list(quantity.axes);
    json.key("difference");
    quantity.difference >= 0 ? json.value(quantity.difference) : json.null();
    json.end_object();
  }
  json.end_object();
  json.key("states").begin_array();
  const std::vector<std::string> kinds = state_kinds(data);
  for (std::size_t state = 0; state < kinds.size(); ++state) {
    json.begin_object();
    json.key("kind").value(kinds[state]);
    json.key("rank").value(data.rank[state]);
    for (const Quantity& quantity : data.quantities) {
      json.key(quantity.name);
      const std::size_t size = quantity.values.size() / kinds.size();
      nested(json, quantity.values.data() + state * size, extent(quantity.axes), 0);
    }
    json.end_object();
  }
  json.end_array();
  json.end_object();
  file << "\n";
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(unfinished, options.output, error);
  if (file && !error) return;
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  throw FileError(options.output.string() + ": could not be written to its end" +
                  (error ? ": " + error.message() : "; is the disk full?"));
}

}  // namespace

Exit reference(const ReferenceOptions& options, std::ostream& out, std::ostream& messages) {
  const std::string kind = options.output.extension().string();
  if (kind != ".h5" && kind != ".json")
    throw ConfigError("-o " + options.output.string() + ": name a file that ends in .h5 or .json");
  ArmDescription arm = load_urdf(options.model, options.choice);
  require_simulable(arm);
  set_armature(arm.chain, options.armature);
  for (const auto& warning : arm.warnings) messages << "warning: " << warning << "\n";
  const double widest = arm.chain.velocities() * std::max(6.0, 1.0 * arm.chain.velocities());
  if (options.states * widest > most_numbers)
    throw ConfigError("--states " + std::to_string(options.states) + ": too many for " +
                      std::to_string(arm.chain.velocities()) + " coordinates; at most " +
                      std::to_string(static_cast<long>(most_numbers / widest)));
  const TaskRows rows = parse_rows(options.rows);
  auto states = jury::reference_states(arm, rows, options.states, options.seed);
  for (const JointState& state : states)
    require_articulated(arm.chain, arm, {state.q.data(), static_cast<std::size_t>(state.q.size())});
  const ReferenceData data = jury::reference_data(arm, rows, std::move(states));

  (kind == ".h5" ? write_hdf5_file : write_json_file)(options, arm, rows, data);
  long singular = 0;
  for (const int rank : data.rank) singular += rank < static_cast<int>(rows.size());
  char worst[32];
  std::snprintf(worst, sizeof worst, "%.1e", data.worst);
  out << arm.robot << ": " << arm.base << " to " << arm.tip << ", " << arm.chain.n() << " joints; "
      << data.states.size() << " states, seed " << options.seed << ", " << singular
      << " without full rank; definitions and recursions over 113 bits differ by " << worst << " at most ("
      << data.worst_of << "); written to " << options.output.string() << "\n";
  if (data.worst <= jury::rounding_difference) return Exit::ok;
  messages << "osculate: the rounded digits of " << data.worst_of
           << " are not sure: the dataset 'difference' says how many are\n";
  return Exit::claim_failed;
}

}  // namespace osculate
