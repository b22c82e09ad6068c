// The states from which the bounds of the verdict are measured: random arms of every kind, at random states,
// evaluated by the lines that a run evaluates. A seed names one state.
#pragma once

#include "control/rotation.hpp"
#include "model/urdf.hpp"
#include "simulation/cvode.hpp"
#include "support/random_arm.hpp"
#include "verification/step_check.hpp"

namespace osculate::testing {

/// One of the arms in models/ that can hold a pose, without motors or with the inertia of some, in a random
/// state.
inline RandomArm shipped_arm(Random& random) {
  static const std::vector<Chain<double>> arms = [] {
    std::vector<Chain<double>> out;
    for (const char* name : {"puma560", "puma560_akb86", "arm7", "prismatic_arm"}) {
      ChainChoice choice;
      choice.tip = "tool0";
      out.push_back(
          load_urdf(std::filesystem::path(OSCULATE_SOURCE_DIR) / "models" / (std::string(name) + ".urdf"),
                    choice)
              .chain);
    }
    return out;
  }();
  RandomArm arm;
  arm.chain = arms[static_cast<std::size_t>(random.integer(0, 3))];
  const bool motors = random.integer(0, 1) == 0;
  arm.q.resize(arm.chain.n());
  arm.qd.resize(arm.chain.n());
  for (int i = 0; i < arm.chain.n(); ++i) {
    Link<double>& link = arm.chain.links[static_cast<std::size_t>(i)];
    if (motors) link.armature = random.uniform(0.1, 2);
    arm.q[i] = link.type == JointType::revolute ? random.uniform(-3.14, 3.14) : random.uniform(0, 0.5);
    arm.qd[i] = random.uniform(-2, 2);
  }
  return arm;
}

/// One state in four is of a shipped arm. The others have n = 6..9 links; in half of them the masses fall
/// along the chain, as in real arms, by up to 1000 from base to tip; one in eight is nearly singular. One in
/// eight of all is slow. u comes from a random pose error.
inline Evidence sample_state(std::uint64_t seed) {
  Random random(seed ^ 0x05c111a7e);
  RandomArm arm;
  if (random.integer(0, 3) == 0) {
    arm = shipped_arm(random);
  } else {
    const Regime regime = random.integer(0, 7) == 0 ? Regime::nearly_singular : Regime::generic;
    arm = random_arm(seed, random.integer(6, 9), regime);
    if (random.integer(0, 1) == 0) {
      const double per_link = std::pow(10.0, random.uniform(-3, 0) / (arm.chain.n() - 1));
      double factor = 1;
      for (auto& link : arm.chain.links) {
        link.mass *= factor;
        link.inertia *= factor;
        link.armature *= factor;
        factor *= per_link;
      }
    }
  }
  const int n = arm.chain.n();
  if (random.integer(0, 7) == 0) arm.qd *= 1e-3;

  LawOptions options;
  if (n > 6) options.null_space_damping = random.integer(0, 1);
  const std::span<const double> q{arm.q.data(), static_cast<std::size_t>(n)};
  Pose target = tip_pose(arm.chain, q);
  target.p += random.uniform(0, 0.1) * random.direction();
  target.R = exp_rotation(random.uniform(0, 0.5) * random.direction()) * target.R;
  Controller controller(arm.chain, {}, options, make_path(HoldOptions{}), target);
  ClosedLoop loop(std::move(controller), Plant{arm.chain, {}, Vector6::Zero()});
  std::vector<double> y(loop.states(), 0.0);
  for (int i = 0; i < n; ++i) {
    y[static_cast<std::size_t>(i)] = arm.q[i];
    y[static_cast<std::size_t>(n + i)] = arm.qd[i];
  }
  return gather(loop, 0, y);
}

}  // namespace osculate::testing
