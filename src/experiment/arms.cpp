#include "experiment/arms.hpp"

#include <limits>

#include "input/limits.hpp"
#include "reference/dense.hpp"

namespace osculate {

namespace {

/// The tip link with a payload rigidly added. Inertias about the common centre of mass, link axes.
void add_payload(Chain<double>& chain, const Payload& payload) {
  if (payload.mass == 0) return;
  Link<double>& link = chain.links.back();
  const Vector3<double> com = chain.p_tip + chain.R_tip * payload.com;
  const Matrix3<double> inertia = chain.R_tip * payload.inertia * chain.R_tip.transpose();
  const double mass = link.mass + payload.mass;
  const Vector3<double> common = (link.mass * link.com + payload.mass * com) / mass;
  const auto about_common = [&common](double m, const Vector3<double>& r) -> Matrix3<double> {
    const Vector3<double> d = r - common;
    return m * (d.squaredNorm() * Matrix3<double>::Identity() - d * d.transpose());
  };
  link.inertia += about_common(link.mass, link.com) + inertia + about_common(payload.mass, com);
  link.mass = mass;
  link.com = common;
}

}  // namespace

void set_armature(Chain<double>& chain, const std::vector<double>& armature) {
  std::size_t first = 0;  // velocity coordinate; joints with several have no armature
  for (auto& link : chain.links) {
    if (first < armature.size() && one_axis(link.type)) link.armature = armature[first];
    first += static_cast<std::size_t>(velocity_count(link.type));
  }
}

void require_articulated(const Chain<double>& chain, const ArmDescription& description,
                         std::span<const double> q) {
  // M = (1 + H phi K) D (1 + H phi K)* (49): eliminating the joints from the tip inwards leaves D(1), D(2),
  // ... as pivots.
  const VectorX<double> still = VectorX<double>::Zero(chain.velocities());
  const MatrixX<double> M = dense::joint_space(chain, positions(chain, q), still).M;
  const VectorX<double> D_of = dense::factor(MatrixX<double>(M.reverse())).D;
  double mass = 0, size = chain.p_tip.norm();
  for (const auto& link : chain.links) {
    mass += link.mass;
    size += link.p_origin.norm();
  }
  Eigen::Index eliminated = 0;
  for (int k = 1; k <= chain.n(); ++k) {
    const auto i = static_cast<std::size_t>(chain.n() - k);
    const JointType type = chain.links[i].type;
    const bool turns = type == JointType::revolute;
    // D below the rounding of the sums it is made of means that nothing outboard resists this joint.
    const double floor =
        16 * chain.n() * std::numeric_limits<double>::epsilon() * mass * (turns ? size * size : 1);
    const double D = D_of.segment(eliminated, velocity_count(type)).minCoeff();
    eliminated += velocity_count(type);
    if (D > floor) continue;
    std::string text =
        description.source + ": joint '" + description.joints[i].name + "': D(" + std::to_string(k) +
        ") = " + std::to_string(D) + (turns ? " kg m^2" : " kg") +
        ": links outboard of it have no inertia about its axis. Give them inertia, or armature to the joint.";
    for (const auto& concern : description.inertia_concerns) text += "\n  " + concern;
    throw ModelError(text);
  }
}

ArmDescription describe(const ModelConfig& model) {
  return model.urdf_text ? parse_urdf(*model.urdf_text, model.urdf.string(), model.choice)
                         : load_urdf(model.urdf, model.choice);
}

void require_simulable(const ArmDescription& description) {
  if (const int n = description.chain.n(); n > limits::joints)
    throw ModelError(
        description.source + ": the chain from '" + description.base + "' to '" + description.tip + "' has " +
        std::to_string(n) + " joints: at most " + std::to_string(limits::joints) +
        " are simulated, as every state is held against definitions that cost O(n^3); choose a shorter "
        "chain.");
}

Arms make_arms(const Experiment& experiment) {
  Arms arms;
  arms.description = describe(experiment.model);
  require_simulable(arms.description);
  check_against(experiment, arms.description);
  arms.warnings = arms.description.warnings;

  arms.model = arms.description.chain;
  set_armature(arms.model, experiment.model.armature);
  arms.friction = experiment.model.friction;

  const PlantConfig& config = experiment.plant;
  arms.plant.chain = arms.model;
  if (config.armature) set_armature(arms.plant.chain, *config.armature);
  for (std::size_t i = 0; i < arms.plant.chain.links.size(); ++i) {
    Link<double>& link = arms.plant.chain.links[i];
    const double scale = config.mass_scale * (config.link_mass_scale.empty() ? 1 : config.link_mass_scale[i]);
    link.mass *= scale;
    link.inertia *= scale * config.inertia_scale;
  }
  add_payload(arms.plant.chain, config.payload);
  arms.plant.friction = config.friction.value_or(arms.friction);
  arms.plant.tip_force = config.tip_force;
  arms.plant.environment = config.environment;
  arms.plant.dense = config.dynamics == PlantDynamics::dense;
  arms.plant.share_kinematics = config.share_kinematics;

  for (const auto* chain : {&arms.model, &arms.plant.chain})
    require_articulated(*chain, arms.description, experiment.q);
  return arms;
}

}  // namespace osculate
