// The closed loop that an experiment describes.
#pragma once

#include "experiment/arms.hpp"
#include "verification/departure.hpp"

namespace osculate {

/// Plant and controller of the experiment. Throws ConfigError or ReferenceError.
ClosedLoop make_loop(const Experiment& experiment, const Arms& arms);

/// y at t = 0.
std::vector<double> initial_state(const Experiment& experiment, const ClosedLoop& loop);

/// Limits of the URDF file for every coordinate, infinite where it gives none.
JointLimits joint_limits(const ArmDescription& arm);

}  // namespace osculate
