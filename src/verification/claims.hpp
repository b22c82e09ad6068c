// What the verdict claims, and how far each claim is from true at one state: residual and bound.
//
// A residual is the largest |x - y| divided by the scale of the terms that were added to form y, never by y
// alone. Joint quantities are weighed by sqrt(diag M), task quantities by the root of the largest diagonal
// entry of Omega in their block, angular or linear, so that radians and metres, N m and N are never compared.
// A bound is a measured constant (bounds.hpp) times eps times the condition number that governs the quantity:
// of M scaled to unit diagonal, or of Omega scaled by those weights. Unit diagonal would hide a direction
// that the arm is about to lose: rounding in Omega is relative to its block. Omega itself is known to eps
// times its spread only, which every bound on a task quantity takes as a second factor (see `spread`).
#pragma once

#include <array>
#include <string_view>

#include "control/law.hpp"
#include "control/memory.hpp"
#include "reference/conditioning.hpp"
#include "reference/dense.hpp"
#include "verification/coordinate_check.hpp"

namespace osculate {

enum class Claim {
  omega,
  lambda,
  c,
  g,
  c_plus_g,
  torque,
  forward_dynamics,
  linearization,
  kinematics,
  null_space,
  coordinates,
  // along the trajectory
  energy,
  analytic_response,
  decoupling,
  frequency_response,
  poles,
  force_response,
};
inline constexpr std::size_t claim_count = 17;

struct ClaimInfo {
  std::string_view id, equation, compared_with;
};
inline constexpr std::array<ClaimInfo, claim_count> claim_table{{
    {"omega", "(58), (60)", "J M^-1 J* (11)"},
    {"lambda", "(61)", "(J M^-1 J*)^-1 (12)"},
    {"c", "(65)-(68)", "Lambda (J M^-1 C - Jdot qd) (14)"},
    {"g", "(72)-(74)", "Lambda J M^-1 G (15)"},
    {"c_plus_g", "section 4.3, corrected", "(14) + (15)"},
    {"torque", "(4), (39)", "J* Lambda (u + J M^-1 (C + G) - Jdot qd) (16)"},
    {"forward_dynamics", "(51)", "M^-1 (T - C - G) (6)"},
    {"linearization", "(5)", "tip acceleration of the plant = u"},
    {"kinematics", "(7), (8), (41)", "J qd, J qdd + Jdot qd, derivative of the pose"},
    {"null_space", "(13)", "J M^-1 (T - J* F) = 0"},
    {"coordinates", "(1)", "second derivative of the tip's coordinates = v"},
    {"energy", "power balance", "E - E(0) = work - dissipation"},
    {"analytic_response", "(5) with the error law", "closed-form solution of the commanded linear system"},
    {"decoupling", "(5) with the error law", "no motion along axes that were not commanded"},
    {"frequency_response", "(5) without feed-forward", "K / (K - w^2 + j D w) at every frequency"},
    {"poles", "(5) with the error law", "roots of s^2 + D s + K"},
    {"force_response", "(5) in contact", "closed-form depth and pressure of the commanded linear system"},
}};
/// Place of a claim in claim_table and in every list of claims.
constexpr std::size_t index(Claim claim) { return static_cast<std::size_t>(claim); }

/// A bound above this decides nothing: the step is undecided, never passed.
inline constexpr double undecided_bound = 1e-3;

/// value <= bound is what the claim says at this state.
struct Residual {
  double value = 0;
  double bound = 0;
  bool applies = true;

  void remember(Memory& memory) { memory(value, bound, applies); }
};
using Residuals =
    std::array<Residual, claim_count>;  // by Claim; the trajectory claims are left empty by `assess`

/// One state as both sides see it. Joints base to tip; base frame, about the tip point; task quantities on
/// `rows`.
struct Evidence {
  // given to both sides
  TaskRows rows;
  VectorX<double> qd, u;                      // velocity coordinates; m
  VectorX<double> T0, net_torque;             // null-space torque; torque on the plant without friction
  Vector6 tip_force = Vector6::Zero();        // on the plant
  Vector6 known_tip_force = Vector6::Zero();  // what the law knows of it
  bool controlled = true;   // false: the law does not act at this instant, or never, or not by (4)
  bool linearized = true;   // false: (5) need not hold
  bool filtered = false;    // a singularity policy acts: where Lambda is out of reach, nobody asked for it
  bool one_solve = true;    // F comes from one solve with Omega, (4); false: from an explicit inverse
  BaseMotion<double> base;  // at rest unless the experiment moves it
  double reach = 1;         // m, sum of the link offsets
  Vector3<double> gravity = Vector3<double>::Zero();  // m/s^2

  // from the recursions
  RecursiveTerms recursive;   // empty where the law did not compute them
  VectorX<double> F, T, qdd;  // m, empty if the law forms none; J* F + null space; of the plant
  Vector6 tip_velocity = Vector6::Zero(), tip_acceleration = Vector6::Zero();
  Pose tip;

  // from the definitions
  dense::State<double> model, plant;
  dense::Mobility<double> task;
  dense::TaskTerms<double> terms;
  VectorX<double> delayed_torque;       // of a law with delay, by its definition; else empty
  std::optional<ChartEvidence> chart;   // of a law in coordinates of its own
  VectorX<double> levers;               // m, for each column of J: from the origin of its link to the tip
  Vector6 pose_rate = Vector6::Zero();  // derivative of the tip pose along qd
  // what they were made of, and is needed again
  bool equal_arms = false;                      // model and plant are the same chain
  dense::Ldlt<double> model_M, plant_M, Omega;  // factors of the model's M, the plant's M, the task's Omega
  MatrixX<double> model_Minv, plant_Minv;       // M^-1 of both; of equal arms the plant's alone
  dense::Jacobian<double> J_Minv;               // J M^-1 of the model, all six rows
  dense::Moving<double> moving;                 // the plant's links
  std::vector<JointPosition<double>> joints;
};

/// Fills the dense side from the models' numbers, the state and e.base alone. q: base to tip. `terms` need
/// full rank.
void fill_dense_side(Evidence& evidence, const Chain<double>& model, const Chain<double>& plant,
                     std::span<const double> q, bool full_rank = true);

/// Difference of the commanded tip force F_c (4) from Lambda u + c + g, as a residual; F is judged through
/// the torque claim.
double force_residual(const Evidence& evidence);

/// Residual and bound of every claim that can be judged at one state.
Residuals assess(const Evidence& evidence);

}  // namespace osculate
