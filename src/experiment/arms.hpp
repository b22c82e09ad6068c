// The two arms of an experiment: what the controller believes, and what is true.
#pragma once

#include "experiment/config.hpp"
#include "simulation/closed_loop.hpp"

namespace osculate {

struct Arms {
  ArmDescription description;  // of the model's file
  Chain<double> model;         // with the armature that both know
  std::vector<JointFriction> friction;
  Plant plant;
  std::vector<std::string> warnings;
};

/// The arm of a model's file or embedded text. Throws ModelError.
ArmDescription describe(const ModelConfig& model);

/// Reads the model file, checks the experiment against it and builds both arms. Throws ModelError or
/// ConfigError.
Arms make_arms(const Experiment& experiment);

/// Gives revolute and prismatic joints their armature. One number for each velocity coordinate, base to tip,
/// kg m^2 or kg; an empty list changes nothing.
void set_armature(Chain<double>& chain, const std::vector<double>& armature);

/// Throws ModelError for a chain of more joints than limits::joints.
void require_simulable(const ArmDescription& description);

/// Throws ModelError if the articulated inertia D(k) about some joint is not positive at q (base to tip):
/// then the links outboard of it have no inertia about its axis, and the file's own concerns about link
/// inertias are quoted.
void require_articulated(const Chain<double>& chain, const ArmDescription& description,
                         std::span<const double> q);

}  // namespace osculate
