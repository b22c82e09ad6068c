// The states from which the bounds of the verdict are measured: random arms of every kind, at random states, evaluated
// by the lines that a run evaluates. A seed names one state.
#pragma once

#include "support/random_arm.hpp"
#include "control/rotation.hpp"
#include "simulation/cvode.hpp"
#include "verification/step_check.hpp"

namespace osculate::testing {

/// n = 6..9 links; in half of the arms the masses fall or rise along the chain, as in real arms, by up to 1000 from base
/// to tip (or 10 the other way); one in eight is slow, one in eight nearly singular. u comes from a random pose error.
inline Evidence sample_state(std::uint64_t seed) {
  Random random(seed ^ 0x05c111a7e);
  const int n = random.integer(6, 9);
  const Regime regime = random.integer(0, 7) == 0 ? Regime::nearly_singular : Regime::generic;
  RandomArm arm = random_arm(seed, n, regime);
  if (random.integer(0, 1) == 0) {
    const double per_link = std::pow(10.0, random.uniform(-3, 0) / (n - 1));
    double factor = 1;
    for (auto& link : arm.chain.links) {
      link.mass *= factor;
      link.inertia *= factor;
      link.armature *= factor;
      factor *= per_link;
    }
  }
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
