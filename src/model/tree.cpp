// The tree of a URDF file: is it one, and what does it look like.
#include "model/tree.hpp"

#include <algorithm>

namespace osculate::internal {
namespace {

[[noreturn]] void refuse_second_parent(const Tree& tree, const TreeJoint& one, const TreeJoint& other) {
  throw ModelError(tree.source + ": link " + in_quotes(one.child) + " has two parent joints, " +
                   in_quotes(one.name) + " (from link " + in_quotes(one.parent) + ") and " +
                   in_quotes(other.name) + " (from link " + in_quotes(other.parent) +
                   "). A URDF file describes a tree: remove one of them, closed loops cannot be described.");
}

/// `link` is known to lie on a cycle.
[[noreturn]] void refuse_cycle(const Tree& tree, const std::string& link) {
  std::string way = in_quotes(link);
  std::string at = link;
  int shown = 0;
  do {
    const auto& joint = tree.joints[tree.joint_into.at(at)];
    at = joint.parent;
    if (++shown <= 8) way += " <- joint " + in_quotes(joint.name) + " <- link " + in_quotes(at);
  } while (at != link);
  if (shown > 8) way += " (" + std::to_string(shown) + " joints in all)";
  throw ModelError(tree.source + ": link " + in_quotes(link) + " is its own ancestor: link " + way +
                   ". A URDF file describes a tree: correct the <parent> or <child> of one of these joints.");
}

const char* name_of(TreeJointType type) {
  switch (type) {
    case TreeJointType::revolute:
      return "revolute";
    case TreeJointType::continuous:
      return "continuous";
    case TreeJointType::prismatic:
      return "prismatic";
    case TreeJointType::fixed:
      return "fixed";
    case TreeJointType::floating:
      return "floating";
    case TreeJointType::planar:
      return "planar";
  }
  return "";
}

std::string describe(const TreeLink& link) {
  std::string line = "link " + in_quotes(link.name) + ": ";
  if (link.fault) return line + "<inertial> cannot be read";
  if (!link.has_inertial) return line + "no <inertial>";
  const auto& com = link.body.com;
  return line + "mass " + short_number(link.body.mass) + " kg, centre of mass (" + short_number(com[0]) +
         ", " + short_number(com[1]) + ", " + short_number(com[2]) + ") m";
}

std::string describe(const TreeJoint& joint) {
  std::string line = "joint " + in_quotes(joint.name) + ": " + name_of(joint.type);
  const bool prismatic = joint.type == TreeJointType::prismatic;
  if (prismatic || joint.type == TreeJointType::revolute || joint.type == TreeJointType::continuous)
    line += ", axis (" + short_number(joint.axis[0]) + ", " + short_number(joint.axis[1]) + ", " +
            short_number(joint.axis[2]) + ")";
  if (joint.lower && joint.upper)
    line +=
        ", " + short_number(*joint.lower) + " to " + short_number(*joint.upper) + (prismatic ? " m" : " rad");
  if (joint.velocity) line += ", at most " + short_number(*joint.velocity) + (prismatic ? " m/s" : " rad/s");
  if (joint.effort) line += ", at most " + short_number(*joint.effort) + (prismatic ? " N" : " N m");
  if (joint.damping != 0) line += ", damping " + short_number(joint.damping);
  if (joint.friction != 0) line += ", friction " + short_number(joint.friction);
  if (joint.mimics) line += ", mimics " + in_quotes(*joint.mimics);
  return line;
}

}  // namespace

std::string printable(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\t')
      out += "\\t";
    else if (c == '\n')
      out += "\\n";
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return out;
}

std::string in_quotes(const std::string& name) { return "'" + printable(name) + "'"; }

void connect(Tree& tree) {
  tree.joint_into.clear();
  tree.joints_out_of.clear();
  for (int i = 0; i < static_cast<int>(tree.joints.size()); ++i) {
    const auto& joint = tree.joints[i];
    const auto [first, is_new] = tree.joint_into.try_emplace(joint.child, i);
    if (!is_new) refuse_second_parent(tree, tree.joints[first->second], joint);
    tree.joints_out_of[joint.parent].push_back(i);
  }

  // Every link has at most one joint into it now, so the walk to the root meets a link of the same walk again
  // exactly where there is a cycle. Each link is walked over once: linear cost.
  std::map<std::string, int> walk_of;
  int walk = 0;
  for (const auto& [name, link] : tree.links) {
    ++walk;
    std::string at = name;
    while (true) {
      const auto [seen, is_new] = walk_of.try_emplace(at, walk);
      if (!is_new) {
        if (seen->second == walk) refuse_cycle(tree, at);
        break;
      }
      const auto into = tree.joint_into.find(at);
      if (into == tree.joint_into.end()) {
        tree.root = at;
        break;
      }
      at = tree.joints[into->second].parent;
    }
  }
}

std::vector<std::string> number_faults(const Tree& tree) {
  std::vector<std::string> faults;
  for (const auto& [name, link] : tree.links) {
    if (link.fault)
      faults.push_back("link " + in_quotes(name) + ": <inertial> cannot be read: " + *link.fault +
                       ". Correct it; remove <inertial> only if the link has no mass.");
    else if (const auto fault = body_fault(link.body))
      faults.push_back("link " + in_quotes(name) + ": " + *fault);
  }
  return faults;
}

std::vector<std::string> list_tree(const Tree& tree) {
  constexpr std::size_t deepest = 30;  // indentation of a long chain stops here
  std::vector<std::string> lines;
  lines.push_back("robot " + in_quotes(tree.robot) + ": " + std::to_string(tree.links.size()) + " links, " +
                  std::to_string(tree.joints.size()) + " joints");
  struct Step {
    const TreeJoint* joint;
    std::string link;
    std::size_t depth;
  };
  std::vector<Step> to_do{{nullptr, tree.root, 0}};
  while (!to_do.empty()) {
    const Step at = to_do.back();
    to_do.pop_back();
    const std::string indent(2 * std::min(at.depth, deepest), ' ');
    if (at.joint) lines.push_back(indent + describe(*at.joint));
    lines.push_back(indent + describe(tree.links.at(at.link)));
    const auto out = tree.joints_out_of.find(at.link);
    if (out == tree.joints_out_of.end()) continue;
    for (auto i = out->second.rbegin(); i != out->second.rend(); ++i)
      to_do.push_back({&tree.joints[*i], tree.joints[*i].child, at.depth + 1});
  }
  for (const auto& fault : number_faults(tree)) lines.push_back("problem: " + fault);
  return lines;
}

}  // namespace osculate::internal
