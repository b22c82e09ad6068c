// What a URDF file says, in plain structs, whichever library read it; and the serial chain taken out of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/lumping.hpp"
#include "model/urdf.hpp"

namespace osculate::internal {

enum class TreeJointType { revolute, continuous, prismatic, fixed, floating, planar };

struct TreeJoint {
  std::string name, parent, child;  // parent and child are links
  TreeJointType type = TreeJointType::fixed;
  Placement origin;                                // child link frame at zero, in the parent link frame
  Vector3<double> axis = Vector3<double>::Zero();  // joint frame, as the file gives it: not normalised
  std::optional<double> lower, upper, velocity, effort;
  double damping = 0, friction = 0;
  std::optional<std::string> mimics;  // the joint that <mimic> names
};

struct TreeLink {
  std::string name;
  bool has_inertial = false;
  RigidBody body;                    // link frame
  std::optional<std::string> fault;  // why <inertial> could not be read
};

/// Links by name, joints in name order. `connect` fills the rest.
struct Tree {
  std::string source, robot;
  std::map<std::string, TreeLink> links;
  std::vector<TreeJoint> joints;
  std::string root;
  std::map<std::string, int> joint_into;                  // child link -> the joint that carries it
  std::map<std::string, std::vector<int>> joints_out_of;  // parent link -> joints it carries
};

/// Control characters of a file's text made visible, so that it can be printed.
std::string printable(const std::string& text);
/// A name between quotes, printable.
std::string in_quotes(const std::string& name);

/// The connected tree of a URDF text; `source` is what messages call it. Numbers are not checked yet. Throws
/// ModelError for a text that is no usable URDF.
Tree read_tree(const std::string& text, const std::string& source);

/// Finds the way from every link to the root. Throws ModelError where a link has two parent joints or a cycle
/// exists.
void connect(Tree& tree);

/// One sentence for every link whose numbers cannot be used, "link 'x': reason". Empty: all is well.
std::vector<std::string> number_faults(const Tree& tree);

/// Links that carry no joint: the candidates for a tip.
std::vector<std::string> leaves(const Tree& tree);

/// The chain from base to tip with everything else lumped. Needs a connected tree without number faults.
/// Throws ModelError for names, joints and axes that make no chain.
ArmDescription extract_chain(const Tree& tree, const ChainChoice& choice);

/// One line for each link and joint of a connected tree, indented by depth, then one for each number fault.
std::vector<std::string> list_tree(const Tree& tree);

}  // namespace osculate::internal
