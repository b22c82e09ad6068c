// The serial chain between a base and a tip link of a tree, and the lumping of everything that hangs off it.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "input/number_text.hpp"
#include "model/tree.hpp"

namespace osculate::internal {
namespace {

bool moves(TreeJointType type) { return type != TreeJointType::fixed; }

/// Number of single-character edits between two names.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      diagonal = above;
    }
  }
  return row.back();
}

std::string joined(const std::vector<std::string>& names, std::size_t at_most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), at_most); ++i)
    text += (i ? ", " : "") + in_quotes(names[i]);
  return names.size() > at_most ? text + ", ..." : text;
}

void require_link(const Tree& tree, const std::string& role, const std::string& name) {
  if (tree.links.contains(name)) return;
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const auto& [other, link] : tree.links) near.emplace_back(edit_distance(name, other), other);
  std::sort(near.begin(), near.end());
  std::vector<std::string> nearest;
  for (const auto& candidate : near) nearest.push_back(candidate.second);
  throw ModelError(tree.source + ": " + role + " link " + in_quotes(name) +
                   " is not in the file. Nearest names: " + joined(nearest, 3) + ".");
}

/// Joint indices from base to tip.
std::vector<int> path(const Tree& tree, const std::string& base, const std::string& tip) {
  std::vector<int> joints;
  std::vector<std::string> ancestors;
  for (std::string at = tip; at != base;) {
    const auto into = tree.joint_into.find(at);
    if (into == tree.joint_into.end())
      throw ModelError(tree.source + ": tip link " + in_quotes(tip) + " does not descend from base link " +
                       in_quotes(base) +
                       (ancestors.empty()
                            ? ": it is the root of the tree."
                            : ". Choose a base among its ancestors: " + joined(ancestors, 12) + "."));
    joints.push_back(into->second);
    at = tree.joints[into->second].parent;
    ancestors.push_back(at);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

void require_supported(const Tree& tree, const TreeJoint& joint) {
  const std::string where = tree.source + ": joint " + in_quotes(joint.name);
  if (joint.mimics)
    throw ModelError(
        where + " on the chain mimics joint " + in_quotes(*joint.mimics) +
        ": the equations of motion used here need every joint of the chain to move independently. Choose "
        "a tip before it, or make it fixed or independent in the file.");
}

JointType type_of(const TreeJoint& joint) {
  switch (joint.type) {
    case TreeJointType::prismatic:
      return JointType::prismatic;
    case TreeJointType::planar:
      return JointType::planar;
    case TreeJointType::floating:
      return JointType::floating;
    default:
      return JointType::revolute;
  }
}

/// The first direction of a planar joint: the joint's x axis laid into the plane, or its y axis where x is
/// nearly the normal.
Vector3<double> in_plane(const Vector3<double>& normal) {
  const Vector3<double> x = std::abs(normal[0]) < 0.9 ? Vector3<double>::UnitX() : Vector3<double>::UnitY();
  return (x - normal * normal.dot(x)).normalized();
}

/// Unit vector along the file's axis. Scaled first, so that no length overflows or vanishes.
Vector3<double> unit_axis(const Tree& tree, const TreeJoint& joint, std::vector<std::string>& warnings) {
  const double largest = joint.axis.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest))
    throw ModelError(tree.source + ": joint " + in_quotes(joint.name) + ": axis (" +
                     number_text(joint.axis[0]) + " " + number_text(joint.axis[1]) + " " +
                     number_text(joint.axis[2]) +
                     ") has no direction. Give <axis xyz=\"...\"/> a non-zero vector.");
  const Vector3<double> scaled = joint.axis / largest;
  const double length = largest * scaled.norm();
  constexpr double rounded = 1e-3;  // what files with few digits miss a unit length by
  if (std::abs(length - 1) > rounded)
    warnings.push_back(tree.source + ": joint " + in_quotes(joint.name) + ": axis of length " +
                       short_number(length) + " is normalised; displacements are in rad or m all the same.");
  return scaled / scaled.norm();
}

JointInfo info(const Tree& tree, const TreeJoint& joint, std::vector<std::string>& warnings) {
  JointInfo out;
  out.name = joint.name;
  out.link = joint.child;
  out.type = type_of(joint);
  out.continuous = joint.type == TreeJointType::continuous;
  out.velocity = joint.velocity;
  out.effort = joint.effort;
  out.damping = joint.damping;
  out.friction = joint.friction;
  if (out.continuous || !joint.lower || !joint.upper) return out;
  if (*joint.lower < *joint.upper) {
    out.lower = joint.lower;
    out.upper = joint.upper;
  } else {
    warnings.push_back(tree.source + ": joint " + in_quotes(joint.name) + ": limits lower " +
                       number_text(*joint.lower) + ", upper " + number_text(*joint.upper) +
                       " leave no room to move; they are ignored.");
  }
  return out;
}

/// Collects what each moving link carries while the chain is walked from the base to the tip.
struct Collector {
  const Tree& tree;
  SideBranches side_branches;
  ArmDescription& arm;
  std::string carrier;            // the link that carries what is met now
  bool on_base = true;            // and whether that is the base
  std::vector<RigidBody> bodies;  // of the carrier, in its frame
  Placement at;                   // of the chain link met last, in the carrier's frame

  void take(const std::string& name, const Placement& pose) {
    const auto& link = tree.links.at(name);
    if (on_base || !link.has_inertial) return;
    bodies.push_back(placed(pose, link.body));
    if (const auto fault = triangle_fault(link.body))
      arm.warnings.push_back(tree.source + ": link " + in_quotes(name) + ": " + *fault);
  }

  void report(const std::string& name, LumpedLink::Why why) {
    arm.lumped.push_back({name, carrier, tree.links.at(name).body.mass, why});
  }

  /// Everything on `link` but the joint `along` that continues the chain (-1 at the tip).
  void take_side_branches(const std::string& link, int along) {
    struct Step {
      int joint;
      Placement parent;
      bool movable;
    };
    std::vector<Step> to_do;
    const auto push_joints_of = [&](const std::string& parent, const Placement& pose, bool movable) {
      const auto out = tree.joints_out_of.find(parent);
      if (out == tree.joints_out_of.end()) return;
      for (auto i = out->second.rbegin(); i != out->second.rend(); ++i)
        if (*i != along) to_do.push_back({*i, pose, movable});
    };
    push_joints_of(link, at, false);
    while (!to_do.empty()) {
      const Step step = to_do.back();
      to_do.pop_back();
      const auto& joint = tree.joints[step.joint];
      const Placement pose = step.parent * joint.origin;  // a movable joint stands at zero
      const bool movable = step.movable || moves(joint.type);
      if (side_branches == SideBranches::drop) {
        report(joint.child, LumpedLink::Why::dropped);
      } else if (on_base) {
        report(joint.child, LumpedLink::Why::to_base);
      } else {
        report(joint.child, movable ? LumpedLink::Why::side_movable : LumpedLink::Why::side_fixed);
        take(joint.child, pose);
        if (moves(joint.type))
          arm.warnings.push_back(tree.source + ": joint " + in_quotes(joint.name) +
                                 " is not on the chain: frozen at zero, link " + in_quotes(joint.child) +
                                 " (" + short_number(tree.links.at(joint.child).body.mass) +
                                 " kg) is lumped into link " + in_quotes(carrier) + ".");
      }
      push_joints_of(joint.child, pose, movable);
    }
  }

  /// The carrier has everything now: its numbers go into the chain.
  void close_carrier() {
    if (on_base) return;
    const RigidBody body = lump(bodies);
    const std::string where = "link " + in_quotes(carrier);
    if (const auto fault = body_fault(body))
      throw ModelError(tree.source + ": " + where + " with what is lumped into it: " + *fault);
    auto& link = arm.chain.links.back();
    link.mass = body.mass;
    link.com = body.com;
    link.inertia = body.inertia;
    const bool inert = link.inertia.isZero(0);
    if (bodies.empty())
      arm.inertia_concerns.push_back(where + ": no <inertial>, so no mass and no inertia");
    else if (link.mass == 0)
      arm.inertia_concerns.push_back(where + ": mass 0 kg" + (inert ? ", inertia 0" : ", inertia only"));
    else if (inert)
      arm.inertia_concerns.push_back(where + ": point mass of " + short_number(link.mass) + " kg, inertia 0");
  }

  void step(int joint_index, int next) {
    const auto& joint = tree.joints[joint_index];
    at = at * joint.origin;
    if (!at.p.allFinite() || !at.R.allFinite())
      throw ModelError(tree.source + ": joint " + in_quotes(joint.name) +
                       ": origin is not finite. Check the units.");
    if (joint.type == TreeJointType::fixed) {
      report(joint.child, on_base ? LumpedLink::Why::to_base : LumpedLink::Why::fixed_on_chain);
    } else {
      require_supported(tree, joint);
      close_carrier();
      Link<double> link;
      link.type = type_of(joint);
      link.R_origin = at.R;
      link.p_origin = at.p;
      if (link.type != JointType::floating) link.axis = unit_axis(tree, joint, arm.warnings);
      if (link.type == JointType::planar) link.axis2 = in_plane(link.axis);
      arm.chain.links.push_back(link);
      arm.joints.push_back(info(tree, joint, arm.warnings));
      carrier = joint.child;
      on_base = false;
      bodies.clear();
      at = {};
    }
    take(joint.child, at);
    take_side_branches(joint.child, next);
  }
};

}  // namespace

std::vector<std::string> leaves(const Tree& tree) {
  std::vector<std::string> names;
  for (const auto& [name, link] : tree.links)
    if (!tree.joints_out_of.contains(name)) names.push_back(name);
  return names;
}

ArmDescription extract_chain(const Tree& tree, const ChainChoice& choice) {
  ArmDescription arm;
  arm.source = tree.source;
  arm.robot = tree.robot;
  arm.base = choice.base.empty() ? tree.root : choice.base;
  arm.tip = choice.tip;
  arm.chain.gravity = choice.gravity;
  if (choice.tip.empty())
    throw ModelError(tree.source +
                     ": no tip link is given. Links that end a branch: " + joined(leaves(tree), 12) + ".");
  require_link(tree, "base", arm.base);
  require_link(tree, "tip", arm.tip);

  const auto joints = path(tree, arm.base, arm.tip);
  Collector collector{tree, choice.side_branches, arm, arm.base, true, {}, {}};
  collector.take_side_branches(arm.base, joints.empty() ? -1 : joints.front());
  for (std::size_t i = 0; i < joints.size(); ++i)
    collector.step(joints[i], i + 1 < joints.size() ? joints[i + 1] : -1);
  collector.close_carrier();
  if (arm.chain.links.empty())
    throw ModelError(tree.source + ": no movable joint between base link " + in_quotes(arm.base) +
                     " and tip link " + in_quotes(arm.tip) +
                     ": there is nothing to control. Choose links with a movable joint "
                     "between them.");
  arm.chain.R_tip = collector.at.R;
  arm.chain.p_tip = collector.at.p;
  return arm;
}

}  // namespace osculate::internal
