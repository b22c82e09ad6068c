// Fuzz target: the text of a URDF file, from the XML to the terms of every chain in it, small ones only.
#include <cstdint>
#include <cstdlib>
#include <iostream>

#include "experiment/arms.hpp"
#include "model/tree.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"

namespace {

using namespace osculate;

constexpr std::size_t most_tips = 3;
constexpr int most_joints = 12;

/// Sweeps of an arm at rest. Their numbers may be anything, also infinite: what counts is that they come.
void evaluate(const ArmDescription& arm) {
  const Chain<double>& chain = arm.chain;
  std::vector<double> q;
  for (const auto& link : chain.links) {
    const bool quaternion = link.type == JointType::spherical || link.type == JointType::floating;
    for (int i = 0; i < position_count(link.type); ++i) q.push_back(quaternion && i == 0 ? 1 : 0.3);
  }
  require_articulated(chain, arm, q);
  const auto at = positions(chain, std::span<const double>(q));
  std::vector<double> qd(static_cast<std::size_t>(chain.velocities()), 0.1), qdd(qd.size()), T(qd.size());
  OperationalSpace<double> space(chain);
  space.place(at);
  space.sweep(qd);
  space.torques({}, T);
  ForwardDynamics<double> plant(chain);
  plant.place(at);
  plant.accelerations(qd, T, {}, qdd);
}

}  // namespace

// urdfdom does not free the links of a file that it refuses late: they hold each other.
extern "C" const char* __lsan_default_suppressions() { return "leak:liburdfdom_model\n"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const auto tree = internal::read_tree(text, "fuzz.urdf");
    internal::list_tree(tree);
    auto tips = internal::leaves(tree);
    tips.resize(std::min(tips.size(), most_tips));
    for (const auto& tip : tips)
      for (const auto branches : {SideBranches::lump, SideBranches::drop}) {
        ChainChoice choice;
        choice.tip = tip;
        choice.side_branches = branches;
        const ArmDescription arm = parse_urdf(text, "fuzz.urdf", choice);
        if (arm.chain.n() <= most_joints) evaluate(arm);
      }
  } catch (const ModelError& error) {
    if (!std::string(error.what()).starts_with("fuzz.urdf: ")) {
      std::cerr << "no place: " << error.what() << "\n";
      std::abort();
    }
  }
  return 0;
}
