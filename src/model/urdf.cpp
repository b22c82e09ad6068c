// Reads URDF text through urdfdom. What that library lets pass in silence, and what it only tells its log, is
// answered here; nothing beyond this file sees its types.
#include "model/urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <mutex>
#include <string_view>

#include "input/limits.hpp"
#include "input/read_text.hpp"
#include "model/tree.hpp"

namespace osculate {
using namespace internal;

namespace {

// ---- the log of urdfdom ----

/// Keeps errors. Never destroyed: console_bridge goes on knowing its address as the "previous" handler.
struct LogCapture final : console_bridge::OutputHandler {
  std::vector<std::string> errors;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors.push_back(text);
  }
};

/// While it lives, urdfdom's messages come here and nothing is printed. One at a time in a process.
class CapturedLog {
 public:
  CapturedLog() : lock_(mutex()), level_(console_bridge::getLogLevel()) {
    capture().errors.clear();
    console_bridge::useOutputHandler(&capture());
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~CapturedLog() {
    console_bridge::setLogLevel(level_);
    console_bridge::restorePreviousOutputHandler();
  }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;
  std::vector<std::string> errors() const { return capture().errors; }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  static LogCapture& capture() {
    static LogCapture& one = *new LogCapture;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  console_bridge::LogLevel level_;
};

/// The name in brackets if `line` is "<prefix> [name]".
std::optional<std::string> bracketed(std::string_view line, std::string_view prefix) {
  if (!line.starts_with(prefix) || !line.ends_with(']')) return std::nullopt;
  return std::string(line.substr(prefix.size(), line.size() - prefix.size() - 1));
}

/// Link -> why its <inertial> could not be read. urdfdom logs the reason first, then the link, and keeps the
/// link.
std::map<std::string, std::string> broken_inertials(const std::vector<std::string>& errors) {
  std::map<std::string, std::string> reasons;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (const auto link = bracketed(errors[i], "Could not parse inertial element for Link ["))
      reasons.emplace(*link, i > 0 ? errors[i - 1] : "no reason given");
  for (auto& [link, reason] : reasons) reason = printable(reason);
  return reasons;
}

/// The fatal lines: those after the last element that urdfdom gave up without refusing the file.
std::string refusal(const std::vector<std::string>& errors) {
  std::string text;
  for (const auto& line : errors) {
    if (line.starts_with("Could not parse inertial") || line.starts_with("Could not parse visual") ||
        line.starts_with("Could not parse collision")) {
      text.clear();
    } else if (line != "joint xml is not initialized correctly") {
      text += (text.empty() ? "" : "; ") + line;
    }
  }
  return text.empty() ? "no reason given" : printable(text);
}

/// What to do about a refusal, by the words of urdfdom 3.
std::string remedy(const std::string& reason, const std::string& text) {
  if (text.find("<xacro:") != std::string::npos && reason.find("link") != std::string::npos)
    return "This looks like a xacro file: expand it to URDF first.";
  struct Row {
    std::string_view words, advice;
  };
  constexpr std::array rows = {
      Row{"no known type", "Types are revolute, continuous, prismatic, fixed, planar and floating."},
      Row{"does not specify limits",
          "Add <limit lower=\"\" upper=\"\" effort=\"\" velocity=\"\"/>, or make the joint continuous."},
      Row{"without limits", "Add <limit lower=\"\" upper=\"\" effort=\"\" velocity=\"\"/>."},
      Row{"joint limit: no", "<limit> must give both effort and velocity."},
      Row{"Two root links", "Every link but one must be the child of a joint: connect them, or remove one."},
      Row{"missing a parent and/or child", "Every joint needs <parent link=\"\"/> and <child link=\"\"/>."},
      Row{"To fix this problem", ""},  // urdfdom says it itself
      Row{"child link [", "Define that link, or correct the joint."},
      Row{"vector value", "Separate three finite numbers by single spaces, not by tabs, newlines or commas."},
      Row{"3 expected", "Give exactly three numbers."},
      Row{"is not unique", "Give every link, joint and material a name of its own."},
      Row{"'robot' element",
          "A URDF file holds one <robot name=\"\">; document types and entities are not supported."},
      Row{"No name given for the robot", "Write <robot name=\"...\">."},
      Row{"No link elements", "Define at least two links and a joint inside <robot>."},
      Row{"unnamed joint", "Every joint needs a name."},
      Row{"Error ", "The file is not complete, well-formed XML in UTF-8."},
  };
  for (const auto& row : rows)
    if (reason.find(row.words) != std::string::npos) return std::string(row.advice);
  return "Correct the file.";
}

// ---- from urdfdom's types to ours ----

Vector3<double> vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Placement placement(const urdf::Pose& pose) {
  const auto& r = pose.rotation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix(), vector(pose.position)};
}

TreeLink tree_link(const urdf::Link& link) {
  TreeLink out;
  out.name = link.name;
  if (!link.inertial) return out;
  const auto& i = *link.inertial;
  out.has_inertial = true;
  RigidBody body;  // in the frame of <inertial><origin>, whose origin is the centre of mass
  body.mass = i.mass;
  body.inertia << i.ixx, i.ixy, i.ixz,  //
      i.ixy, i.iyy, i.iyz,              //
      i.ixz, i.iyz, i.izz;
  out.body = placed(placement(i.origin), body);
  return out;
}

TreeJointType tree_joint_type(const urdf::Joint& joint, const std::string& source) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return TreeJointType::revolute;
    case urdf::Joint::CONTINUOUS:
      return TreeJointType::continuous;
    case urdf::Joint::PRISMATIC:
      return TreeJointType::prismatic;
    case urdf::Joint::FIXED:
      return TreeJointType::fixed;
    case urdf::Joint::FLOATING:
      return TreeJointType::floating;
    case urdf::Joint::PLANAR:
      return TreeJointType::planar;
    default:
      throw ModelError(source + ": joint " + in_quotes(joint.name) + " has an unknown type.");
  }
}

TreeJoint tree_joint(const urdf::Joint& joint, const std::string& source) {
  TreeJoint out;
  out.name = joint.name;
  out.parent = joint.parent_link_name;
  out.child = joint.child_link_name;
  out.type = tree_joint_type(joint, source);
  out.origin = placement(joint.parent_to_joint_origin_transform);
  out.axis = vector(joint.axis);
  if (joint.limits) {
    out.lower = joint.limits->lower;
    out.upper = joint.limits->upper;
    out.velocity = joint.limits->velocity;
    out.effort = joint.limits->effort;
  }
  if (joint.dynamics) {
    out.damping = joint.dynamics->damping;
    out.friction = joint.dynamics->friction;
  }
  if (joint.mimic) out.mimics = joint.mimic->joint_name;
  return out;
}

Tree tree_of(const urdf::ModelInterface& model, const std::string& source,
             const std::map<std::string, std::string>& broken) {
  Tree tree;
  tree.source = source;
  tree.robot = model.getName();
  for (const auto& [name, link] : model.links_) {
    if (name.empty()) throw ModelError(source + ": a <link> has no name. Give every link a name.");
    auto& out = tree.links[name] = tree_link(*link);
    if (const auto reason = broken.find(name); reason != broken.end()) out.fault = reason->second;
  }
  for (const auto& [name, joint] : model.joints_) tree.joints.push_back(tree_joint(*joint, source));
  return tree;
}

struct Parsed {
  urdf::ModelInterfaceSharedPtr model;
  std::vector<std::string> errors;
};

Parsed parse(const std::string& text) {
  const CapturedLog log;
  try {
    auto model = urdf::parseURDF(text);
    if (model)  // not used here, and where there is a cycle it would keep the links alive for ever
      for (auto& [name, link] : model->links_) link->child_links.clear();
    return {model, log.errors()};
  } catch (const std::exception& failure) { return {nullptr, {failure.what()}}; }
}

/// Where every link has a parent joint urdfdom names none of them. With one free link added it loads the
/// file, and `connect` finds the cycle and throws.
void explain_missing_root(const std::string& text, const std::string& source) {
  const auto end = text.rfind("</robot>");
  if (end == std::string::npos) return;
  std::string with_root = text;
  with_root.insert(end, "<link name=\"added to have a root\"/>");
  const auto [model, errors] = parse(with_root);
  if (!model) return;
  auto tree = tree_of(*model, source, {});
  connect(tree);
}

/// How deep elements are nested, comments left out. The XML library calls itself once for each level.
int nesting(const std::string& text) {
  int depth = 0, deepest = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text.compare(i, 4, "<!--") == 0) {
      i = text.find("-->", i + 4);
      if (i == std::string::npos) break;
    } else if (text[i] == '<') {
      if (text[i + 1] == '/')
        --depth;
      else if (text[i + 1] != '?' && text[i + 1] != '!')
        deepest = std::max(deepest, ++depth);
    } else if (text[i] == '/' && text[i + 1] == '>') {
      --depth;
    }
  }
  return deepest;
}

std::string read_file(const std::filesystem::path& file) {
  auto [text, fault] = read_text(file, limits::urdf_bytes, "give a URDF file, without meshes in it");
  if (!fault.empty()) throw ModelError(fault);
  return text;
}

}  // namespace

Tree internal::read_tree(const std::string& text, const std::string& source) {
  if (const auto zero = text.find('\0'); zero != std::string::npos)
    throw ModelError(source + ": byte " + std::to_string(zero) +
                     " is zero: this is no UTF-8 text. Save the file as UTF-8.");
  if (const int depth = nesting(text); depth > limits::urdf_nesting)
    throw ModelError(source + ": elements are nested " + std::to_string(depth) + " deep, at most " +
                     std::to_string(limits::urdf_nesting) + " are read. A URDF file needs fewer than ten.");
  std::size_t links = 0;
  for (auto at = text.find("<link"); at != std::string::npos; at = text.find("<link", at + 1)) ++links;
  if (links > limits::urdf_links)
    throw ModelError(source + ": " + std::to_string(links) + " links, at most " +
                     std::to_string(limits::urdf_links) +
                     " are read. Leave out what does not belong to the arm.");
  const auto [model, errors] = parse(text);
  if (!model) {
    const std::string reason = refusal(errors);
    if (reason.find("No root link") != std::string::npos) explain_missing_root(text, source);
    const std::string advice = remedy(reason, text);
    throw ModelError(source + ": not a usable URDF file: " + reason + (reason.ends_with('.') ? "" : ".") +
                     (advice.empty() ? "" : " ") + advice);
  }
  auto tree = tree_of(*model, source, broken_inertials(errors));
  connect(tree);
  return tree;
}

ArmDescription parse_urdf(const std::string& text, const std::string& source, const ChainChoice& choice) {
  const auto tree = read_tree(text, source);
  std::string faults;
  for (const auto& fault : number_faults(tree))
    faults += (faults.empty() ? "" : "\n") + source + ": " + fault;
  if (!faults.empty()) throw ModelError(faults);
  auto arm = extract_chain(tree, choice);
  arm.urdf_text = text;
  return arm;
}

ArmDescription load_urdf(const std::filesystem::path& file, const ChainChoice& choice) {
  return parse_urdf(read_file(file), file.string(), choice);
}

std::vector<std::string> tip_candidates(const std::filesystem::path& file) {
  return leaves(read_tree(read_file(file), file.string()));
}

std::vector<std::string> list_urdf(const std::filesystem::path& file) {
  return list_tree(read_tree(read_file(file), file.string()));
}

}  // namespace osculate
