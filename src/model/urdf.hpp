// A serial arm from a URDF file: the chain between a base and a tip link, with everything that hangs off it
// lumped.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/chain.hpp"

namespace osculate {

/// A model file that cannot be used. The message names file, link or joint, value and remedy.
struct ModelError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class SideBranches { lump /* rigidly, movable joints frozen at zero */, drop };

struct ChainChoice {
  std::string base;                         // link; empty: the root of the file
  std::string tip;                          // link; must descend from base
  Vector3<double> gravity{0, 0, -9.80665};  // m/s^2, acceleration of free fall, base frame
  SideBranches side_branches = SideBranches::lump;
};

/// What the file says of one joint on the chain; limits and dynamics are reported, and used only when asked.
struct JointInfo {
  std::string name;
  std::string link;  // the link it carries
  JointType type = JointType::revolute;
  bool continuous = false;
  std::optional<double> lower, upper;      // rad or m
  std::optional<double> velocity, effort;  // rad/s or m/s; N m or N
  double damping = 0, friction = 0;        // <dynamics>: N m s/rad or N s/m; N m or N
};

/// A link that does not move by itself on this chain.
struct LumpedLink {
  enum class Why { fixed_on_chain, side_fixed, side_movable, dropped, to_base };
  std::string link, into;  // `into`: the moving link (or the base) that carries its mass
  double mass = 0;         // kg
  Why why = Why::fixed_on_chain;
};

/// Everything the program knows of an arm. `chain` holds the numbers; the rest explains where they came from.
struct ArmDescription {
  std::string source;  // file name as given, for messages
  std::string robot, base, tip;
  std::vector<JointInfo> joints;  // base to tip
  Chain<double> chain;
  std::vector<LumpedLink> lumped;
  std::vector<std::string> warnings;
  /// Moving links without usable inertia of their own, "link 'x': reason". Legal while the articulated
  /// inertia about every joint stays positive; who evaluates the recursions quotes them when it does not.
  std::vector<std::string> inertia_concerns;
  std::string urdf_text;
};

/// The chain that `choice` names, from a file. Throws ModelError.
ArmDescription load_urdf(const std::filesystem::path& file, const ChainChoice& choice);
/// The same from text already in memory; `source` is what messages call it.
ArmDescription parse_urdf(const std::string& text, const std::string& source, const ChainChoice& choice);

/// Links of a file that end a branch: the candidates for a tip.
std::vector<std::string> tip_candidates(const std::filesystem::path& file);

/// The whole tree of a file, for `osculate info` without a chain: one printable line for each link and joint.
std::vector<std::string> list_urdf(const std::filesystem::path& file);

}  // namespace osculate
