// States at which formulations of the same dynamics are compared: seeded, within the limits of the arm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "control/law.hpp"
#include "model/urdf.hpp"

namespace osculate::jury {

enum class StateKind { random, nearly_singular, at_rest };
std::string name_of(StateKind kind);

/// Joint lists base to tip.
struct JointState {
  StateKind kind = StateKind::random;
  VectorX<double> q;    // chain.positions(): rad, m; quaternions w x y z of length 1 up to rounding
  VectorX<double> qd;   // chain.velocities(): rad/s, m/s
  VectorX<double> tau;  // chain.velocities(): N m, N; a torque to accelerate under
  VectorX<double> qdd;  // chain.velocities(): rad/s^2, m/s^2; an acceleration to find the torque of
  Vector6 u;            // tip acceleration asked for, all six rows: rad/s^2, m/s^2
};

/// `count` states from one stream of random numbers; which numbers they are: `definition`. The same bits with
/// every compiler and library.
std::vector<JointState> random_states(const ArmDescription& arm, int count, std::uint64_t seed);

/// The same, with the first two changed: state 0 is at rest (qd = 0); state 1 is moved towards a singularity
/// of the task rows until Omega, scaled to unit diagonal, has a condition number near 1e8 or the search ends.
/// count >= 2.
std::vector<JointState> reference_states(const ArmDescription& arm, const TaskRows& rows, int count,
                                         std::uint64_t seed);

/// The generator and the ranges in words, for whoever wants to draw the same states.
std::string definition();

}  // namespace osculate::jury
