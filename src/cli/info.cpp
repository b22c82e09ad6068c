#include "cli/info.hpp"

#include <iomanip>
#include <ostream>

#include "model/urdf.hpp"

namespace osculate {

namespace {

const char* fate(LumpedLink::Why why) {
  switch (why) {
    case LumpedLink::Why::fixed_on_chain:
      return "fixed on the chain, lumped into";
    case LumpedLink::Why::side_fixed:
      return "side branch on fixed joints, lumped into";
    case LumpedLink::Why::side_movable:
      return "side branch on a movable joint, frozen at zero, lumped into";
    case LumpedLink::Why::dropped:
      return "side branch, dropped from";
    case LumpedLink::Why::to_base:
      return "does not move, part of";
  }
  return "";
}

const char* type_name(JointType type) {
  switch (type) {
    case JointType::revolute:
      return "revolute";
    case JointType::prismatic:
      return "prismatic";
    case JointType::cylindrical:
      return "cylindrical";
    case JointType::universal:
      return "universal";
    case JointType::planar:
      return "planar";
    case JointType::spherical:
      return "spherical";
    case JointType::floating:
      return "floating";
  }
  return "";
}

}  // namespace

Exit print_info(const std::filesystem::path& model, const ChainChoice& choice, std::ostream& out) {
  if (choice.tip.empty()) {
    for (const auto& line : list_urdf(model)) out << line << "\n";
    out << "choose a chain with --base LINK --tip LINK\n";
    return Exit::ok;
  }
  const ArmDescription arm = load_urdf(model, choice);
  out << arm.robot << ": " << arm.base << " to " << arm.tip << ", " << arm.chain.n() << " joints\n\n";
  double total = 0;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const JointInfo& joint = arm.joints[i];
    const Link<double>& link = arm.chain.links[i];
    const bool turns = joint.type == JointType::revolute;
    total += link.mass;
    out << std::setw(2) << i + 1 << "  " << joint.name << ": "
        << (joint.continuous ? "continuous" : type_name(joint.type));
    if (link.type != JointType::floating) out << ", axis " << link.axis.transpose();
    out << ", carries " << joint.link << "\n      mass " << link.mass << " kg, centre of mass "
        << link.com.transpose() << " m (with what is lumped into it)\n";
    if (joint.lower || joint.upper) {
      out << "      limits " << joint.lower.value_or(0) << " to " << joint.upper.value_or(0)
          << (turns ? " rad" : " m");
      if (joint.velocity) out << ", velocity " << *joint.velocity << (turns ? " rad/s" : " m/s");
      if (joint.effort) out << ", effort " << *joint.effort << (turns ? " N m" : " N");
      out << " (reported, not enforced)\n";
    }
    if (joint.damping != 0 || joint.friction != 0)
      out << "      <dynamics> damping " << joint.damping << ", friction " << joint.friction
          << " (reported; an experiment must state friction to use it)\n";
  }
  out << "\nmoving mass " << total << " kg\n";
  for (const LumpedLink& l : arm.lumped)
    out << "  " << l.link << " (" << l.mass << " kg): " << fate(l.why) << " " << l.into << "\n";
  for (const auto& concern : arm.inertia_concerns) out << "note: " << concern << "\n";
  for (const auto& warning : arm.warnings) out << "warning: " << warning << "\n";
  return Exit::ok;
}

}  // namespace osculate
