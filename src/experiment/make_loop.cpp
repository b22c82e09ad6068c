#include "experiment/make_loop.hpp"

#include <limits>

namespace osculate {

namespace {

/// `initial`: where waypoints start from.
std::shared_ptr<const Path> path_of(const ReferenceConfig& config, const Pose& initial, double duration) {
  return std::visit(
      [&](const auto& reference) -> std::unique_ptr<Path> {
        using Type = std::decay_t<decltype(reference)>;
        if constexpr (std::is_same_v<Type, WaypointsOptions>)
          return make_path(reference, initial);
        else if constexpr (std::is_same_v<Type, EachAxisOptions>)
          return make_path(reference, duration);
        else
          return make_path(reference);
      },
      config);
}

NullSpaceOptions null_space(const NullSpaceConfig& config, const Experiment& experiment, const Arms& arms) {
  NullSpaceOptions out;
  out.damping = config.damping;
  out.manipulability = config.manipulability;
  if (config.posture_stiffness > 0)
    out.posture = {config.posture.value_or(experiment.q), config.posture_stiffness};
  if (config.limit_gain > 0) {
    const JointLimits limits = joint_limits(arms.description);
    out.limits = {limits.lower, limits.upper, config.limit_margin, config.limit_gain};
  }
  return out;
}

std::array<double, 6> six(const Vector6& x) {
  std::array<double, 6> out;
  std::copy_n(x.data(), 6, out.begin());
  return out;
}

/// What a law of the user's own is told of its arm and task.
UserLawModel user_law_model(const Experiment& experiment, const Arms& arms, const LawOptions& law) {
  const ArmDescription& arm = arms.description;
  UserLawModel out;
  out.urdf = arm.urdf_text;
  out.base = arm.base;
  out.tip = arm.tip;
  out.lump_side_branches = experiment.model.choice.side_branches == SideBranches::lump;
  std::copy_n(arms.model.gravity.data(), 3, out.gravity.begin());
  for (const JointInfo& joint : arm.joints) out.joints.push_back(joint.name);
  out.positions = arms.model.positions();
  out.velocities = arms.model.velocities();
  out.armature = experiment.model.armature;
  out.armature.resize(static_cast<std::size_t>(out.velocities), 0.0);
  out.rows = law.rows;
  out.stiffness = six(law.stiffness);
  out.damping = six(law.damping);
  out.period = law.sampling ? law.sampling->period : 0;
  return out;
}

LawOptions law_options(const Experiment& experiment, const Arms& arms) {
  const ControllerConfig& c = experiment.controller;
  LawOptions law;
  law.law = c.law;
  law.textbook = c.textbook;
  law.rows = c.rows;
  law.stiffness = c.stiffness;
  law.damping = c.damping;
  law.virtual_inertia = c.virtual_inertia;
  if (c.virtual_inertia) {  // the gains are given in N/m and N s/m
    law.stiffness = c.stiffness.cwiseQuotient(*c.virtual_inertia);
    law.damping = c.damping.cwiseQuotient(*c.virtual_inertia);
  }
  law.null_space = null_space(c.null_space, experiment, arms);
  law.compensate_friction = c.compensate_friction;
  law.orientation = c.orientation;
  law.position = c.position;
  law.sampling = c.sampling;
  law.feedforward = c.feedforward;
  law.know_tip_force = c.compensate_tip_force;
  law.force = c.force;
  law.obstacles = c.obstacles;
  law.singularity = c.singularity;
  law.sensors = c.sensors;
  if (c.effort_limit == EffortLimit::model) law.effort_limit = joint_limits(arms.description).effort;
  if (c.effort_limit == EffortLimit::list) law.effort_limit = c.effort_limits;
  if (experiment.base_motion && !std::holds_alternative<HoldOptions>(*experiment.base_motion))
    law.base_path = path_of(*experiment.base_motion, {}, experiment.duration);
  if (c.law == Law::textbook && c.textbook == TextbookLaw::jacobian_transpose)
    law.constant_inertia =
        inertia_diagonal(arms.model, positions(arms.model, std::span<const double>(experiment.q)), c.rows,
                         base_motion(law.base_path.get(), 0));
  if (c.law == Law::user)
    law.user =
        std::make_shared<const UserLawSetup>(UserLawSetup{c.user, user_law_model(experiment, arms, law)});
  return law;
}

}  // namespace

JointLimits joint_limits(const ArmDescription& arm) {
  constexpr double none = std::numeric_limits<double>::infinity();
  JointLimits out;
  for (const JointInfo& joint : arm.joints) {
    const auto positions = static_cast<std::size_t>(position_count(joint.type));
    const auto velocities = static_cast<std::size_t>(velocity_count(joint.type));
    const bool single = positions == 1;
    out.lower.insert(out.lower.end(), positions, single ? joint.lower.value_or(-none) : -none);
    out.upper.insert(out.upper.end(), positions, single ? joint.upper.value_or(none) : none);
    out.velocity.insert(out.velocity.end(), velocities, single ? joint.velocity.value_or(none) : none);
    out.effort.insert(out.effort.end(), velocities, single ? joint.effort.value_or(none) : none);
  }
  return out;
}

ClosedLoop make_loop(const Experiment& experiment, const Arms& arms) {
  const LawOptions law = law_options(experiment, arms);
  const Pose initial = tip_pose(arms.model, experiment.q, base_motion(law.base_path.get(), 0));
  std::shared_ptr<const Path> path = path_of(experiment.reference, initial, experiment.duration);
  try {
    return ClosedLoop(Controller(arms.model, arms.friction, law, std::move(path), initial), arms.plant);
  } catch (const UserLawFailed& error) {
    const auto place = experiment.places.find("controller.law");
    throw ConfigError((place == experiment.places.end() ? experiment.file.string() : place->second) + ": " +
                      error.what() + ".");
  }
}

std::vector<double> initial_state(const Experiment& experiment, const ClosedLoop& loop) {
  std::vector<double> y(loop.states(), 0.0);
  std::copy(experiment.q.begin(), experiment.q.end(), y.begin());
  std::copy(experiment.qd.begin(), experiment.qd.end(),
            y.begin() + static_cast<std::ptrdiff_t>(experiment.q.size()));
  return y;
}

}  // namespace osculate
