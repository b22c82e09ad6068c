// Laws in common use, written from their equations with the dense terms: the whole of (16), and what is left
// of it when a term is dropped. They are here to be compared, not to be trusted.
#pragma once

#include <span>
#include <string_view>

#include "recursion/task.hpp"

namespace osculate {

enum class TextbookLaw {
  dense,           // (16): T = J* Lambda (u + J M^-1 (C + G - T0) - Jdot qd) + T0
  no_jdot_qd,      // without Jdot qd
  no_coriolis,     // without C: T = J* Lambda (u + J M^-1 (G - T0) - Jdot qd) + T0
  gravity_only,    // without both: T = J* Lambda (u - J M^-1 T0) + G + T0
  block_inertia,   // Lambda of the angular and of the linear rows apart: T = J* diag(L_w, L_v) u + C + G
                   //   + (1 - J* Lambda J M^-1) T0, no Jdot qd
  pseudo_inverse,  // T = M J^+ (u - Jdot qd) + C + G + (1 - J* J*^+) T0, J^+ by Moore and Penrose
  kinematic_null_space,  // as dense, but T0 projected by 1 - J* (J*)^+, which is not dynamically consistent
  jacobian_transpose,    // T = J* (B u) + G + T0 with a constant diagonal B, the diagonal of Lambda at the
                         // start
};

struct TextbookLawInfo {
  TextbookLaw law;
  std::string_view name, omits, source;
};
/// Every law with its name in experiments, what it leaves out in words, and where it is in use.
std::span<const TextbookLawInfo> textbook_laws();

/// J Jdot qd M C G of the model as the law needs them are computed inside. u: on the task rows, m numbers.
/// T: joint torques without friction, base to tip. Returns false, and leaves T, where the task rows are
/// singular; jacobian_transpose inverts nothing and always returns true. `B`: diagonal for
/// jacobian_transpose, m numbers, else unused. `F_known`: wrench on the tip that the law takes into account,
/// inertial frame: J* F_known is subtracted from T.
bool textbook_torque(TextbookLaw law, const Chain<double>& model,
                     const std::vector<JointPosition<double>>& joints, const BaseMotion<double>& base,
                     std::span<const double> qd, const TaskRows& rows, std::span<const double> u,
                     std::span<const double> T0, const Vec<Force, double>& F_known, std::span<const double> B,
                     std::span<double> T);

/// Diagonal of Lambda on the task rows at this configuration: kg m^2 and kg. Throws std::domain_error where
/// the task rows are singular. Of `base` the axes matter, which a turned base gives to the rows.
std::vector<double> inertia_diagonal(const Chain<double>& model,
                                     const std::vector<JointPosition<double>>& joints, const TaskRows& rows,
                                     const BaseMotion<double>& base = {});

}  // namespace osculate
