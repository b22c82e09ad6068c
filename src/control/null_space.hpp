// What a redundant arm does with the freedom that the task leaves: a joint torque T0, of which the law lets
// through only what does not move the tip.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "recursion/task.hpp"

namespace osculate {

struct NullSpaceOptions {
  double damping = 0;  // N m s/rad or N s/m, >= 0: T0 -= damping qd

  struct Posture {
    std::vector<double> q;  // rad or m, one for each joint, base to tip
    double stiffness = 1;   // N m/rad or N/m, >= 0: T0 += stiffness (q_posture - q)
    bool operator==(const Posture&) const = default;
  };
  std::optional<Posture> posture;

  /// Repulsion from the joint limits (Khatib 1986): T0 += gain (1/d - 1/margin)/d^2 away from a limit nearer
  /// than `margin`, d the distance from it.
  struct Limits {
    std::vector<double> lower, upper;  // rad or m, one for each joint; infinite where there is none
    double margin = 0.2;               // rad or m, > 0
    double gain = 0.1;                 // N m rad^3 or N m^3, >= 0
    bool operator==(const Limits&) const = default;
  };
  std::optional<Limits> limits;

  double manipulability =
      0;  // N m or N, >= 0: T0 += manipulability d/dq log w, w = sqrt(det(J J*)) (Yoshikawa 1985)

  bool empty() const;
  bool operator==(const NullSpaceOptions&) const = default;
};

/// T0, base to tip, one entry for each velocity coordinate. Posture, limits and manipulability want joints
/// with one axis each, else std::invalid_argument. Throws std::domain_error where a joint stands at or beyond
/// a limit, and where manipulability has no gradient: its J on the task rows, in SI units and base axes, has
/// lost rank. `rows`: of the task. Only manipulability allocates.
void null_space_torque(const NullSpaceOptions& options, const Chain<double>& model, const TaskRows& rows,
                       std::span<const double> q, std::span<const double> qd, std::span<double> T0);

}  // namespace osculate
