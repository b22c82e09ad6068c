// Which terms of the exact law a torque has, and which it lacks: a regression of the difference.
//
// The exact torque of (16), T = J* Lambda (u + J M^-1 (C + G) - Jdot qd) + friction, is computed at every
// sample by the dense definitions. tau - T is then explained by as few candidates as the noise of the log
// allows: each subset of up to four is fitted, larger ones are built from the best. With more joints than
// task rows only what the tip feels of the difference is judged; the rest is told apart, because any torque
// in the null space is right.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "control/reference.hpp"
#include "judge/log.hpp"
#include "model/friction.hpp"

namespace osculate {

/// What a law of pose tracking prescribes of the orientation, where a log has references in place of u.
enum class ErrorLaw {
  rotation_vector,   // e.. + D e. + K e = 0 for the rotation vector e of the error: what osculate does
  angular_velocity,  // omega. = omega_ref. + D (omega_ref - omega) + K e: what most programs do
};

/// Gains of pose tracking; for each row, angular first.
struct Gains {
  Vector6 stiffness = Vector6::Zero();  // 1/s^2
  Vector6 damping = Vector6::Zero();    // 1/s
};

struct JudgeOptions {
  std::vector<int> rows{0, 1, 2, 3, 4, 5};  // controlled task rows
  std::vector<JointFriction> friction;      // that the exact law compensates; empty: none
  std::optional<Gains> gains;               // with a reference in place of u; none: they are estimated
  // Declared by the user; where neither these nor the log say, both orders are tried.
  std::optional<RowOrder> u_order;
  std::optional<QuaternionOrder> quaternion_order;
  Acceleration acceleration = Acceleration::classical;  // of u
  Eigen::Index samples = 500;                           // used for the fit, evenly taken from the log
};

struct Coefficient {
  std::string name, unit;
  double value = 0, deviation = 0;  // one standard deviation
};

/// One explanation of the difference, or of a part of it.
struct Finding {
  std::string term;      // id: docs/judge.md
  std::string sentence;  // "omits J* Lambda Jdot qd (coefficient -1.00 +- 0.01; explains 99.8 %)"
  std::vector<Coefficient> coefficients;
  double explained = 0;  // by how much of the whole difference the rest grows without it, sums of squares
};

/// Another explanation that fits as well, and a motion whose log would decide.
struct Doubt {
  std::vector<std::string> terms;
  std::string sentence;
};

enum class Ruling { right, wrong, unexplained };

struct Judgement {
  Ruling ruling = Ruling::right;
  std::vector<Finding> findings;  // largest share first
  std::vector<Doubt> doubts;
  std::vector<Finding> null_space;         // torques that do not move the tip
  std::vector<Coefficient> gains;          // estimated, where they were not given
  std::vector<std::string> conventions;    // how the log was read where it did not say
  std::vector<std::string> unseen;         // terms whose lack this log would not show, with the reason
  double difference = 0;                   // rms of tau - T as far as it was judged, N m or N
  double noise = 0;                        // rms of the log's noise in it, from differences of neighbours
  double rest = 0;                         // part of the sum of squares that nothing explains
  Eigen::Index samples = 0, left_out = 0;  // used; singular or saturated
};

/// Throws LogError where the log cannot decide how it is to be read.
Judgement judge(const Chain<double>& model, const Log& log, const JudgeOptions& options = {});

/// The judgement in words; `source` names the log.
std::string report(const Judgement& judgement, const std::string& source);

}  // namespace osculate
