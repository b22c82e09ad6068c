// Claims about the whole trajectory, bounded by the run's own global error estimate.
//
// A local tolerance bounds no global error. The estimate is the largest difference so far between the run and
// its shadow, the same problem at a hundredth of the tolerances: their errors differ by so much more than the
// shadow's own that the difference is the run's error. A claim is bounded by `error_multiple` times it, plus
// rounding, plus the local error that the integrator is allowed in one step: in the first steps after a start
// the shadow is no better than the run.
#pragma once

#include <map>
#include <optional>

#include "control/linear_response.hpp"
#include "simulation/closed_loop.hpp"
#include "verification/verdict.hpp"

namespace osculate {

/// Estimate of the run's true error: the largest difference from the shadow so far.
struct GlobalError {
  double position = 0;      // m, tip point
  double orientation = 0;   // rad, tip
  double velocity = 0;      // m/s, tip point
  double joints = 0;        // rad and m together: largest difference of a joint position
  double position_now = 0;  // m, tip point, at the last checked step alone
  double energy = 0;        // J, sum over kinetic + potential, work, dissipated and external work
  double imbalance = 0;     // J, of their balance, in which the errors of work and loss mostly cancel
  bool known = false;       // false without a shadow run
  double tolerance = 0;     // local error that the integrator allows in a joint of the size of 1 rad or 1 m

  void add(const Observation& run, const Whereabouts& shadow);
  void remember(Memory& memory) {
    memory(position, orientation, velocity, joints, position_now, energy, imbalance, known);
  }
};

/// Multiple of the estimate that bounds a claim. The estimate misses the shadow's own error (a few per cent)
/// and is a difference at accepted steps only.
inline constexpr double error_multiple = 4;

class TrajectoryClaims {
 public:
  /// `start` is the observation at t = 0; reach in m.
  TrajectoryClaims(const ClosedLoop& loop, const Observation& start);

  /// Residuals of energy, analytic_response and decoupling at this instant, the others left empty. The energy
  /// residual is relative to the energies moved so far; energy_result() judges it against those of the whole
  /// run.
  Residuals assess(const Observation& seen, const GlobalError& error);

  /// Call at a time where the reference jumps, before the next assess: the closed-form solution goes on from
  /// there.
  void restart_at(double t);

  /// The energy claim over the run so far.
  ClaimResult energy_result() const;

  /// Why a claim does not apply, or "".
  std::string reason(Claim claim) const;

  /// Rows that the reference moves in the present segment.
  const std::array<bool, 6>& commanded() const { return commanded_; }
  /// Error minus the error of the closed-form solution, at the last assessed instant; rad, m. Nothing where
  /// the claim analytic_response does not apply.
  const std::optional<Vector6>& off() const { return off_; }

  /// Largest distance of the tip from the closed-form solution so far: m, rad.
  double worst_position() const { return worst_position_; }
  double worst_orientation() const { return worst_orientation_; }

  void remember(Memory& memory) {
    memory(left_the_law_, commanded_, clean_, segment_start_, segment_.e, segment_.ed, energy_start_,
           potential_start_, energy_scale_, worst_imbalance_, widest_bound_, tolerance_, energy_steps_,
           worst_position_, worst_orientation_);
  }

 private:
  /// Rounding of forward kinematics and energies, relative to 1 rad, to the reach and to the terms summed.
  double rounding() const;
  /// Controlled rows that the reference does not move now and that started with no error.
  std::array<bool, 6> uncommanded() const;
  /// Error that the closed-form solution has at time t.
  PoseError exact_error(double t) const;
  Residual energy(const Observation& seen, const GlobalError& error);
  /// Largest |difference| of the given rows against the global error, angular and linear apart.
  Residual pose_residual(const Vector6& difference, const std::array<bool, 6>& rows,
                         const GlobalError& error) const;

  LawOptions options_;
  std::shared_ptr<const Path> path_;
  Pose initial_;
  double reach_ = 1;
  int joints_ = 1;
  bool controlled_ = true, plant_is_model_ = true, pushed_ = false, angular_ = true;
  bool left_the_law_ = false;  // a singularity policy or a torque limit has acted
  std::array<bool, 6> controlled_rows_{}, commanded_{};
  std::array<bool, 6> clean_{};  // rows that start with no error
  std::optional<Vector6> off_;
  double segment_start_ = 0;
  PoseError segment_;
  double energy_start_ = 0, potential_start_ = 0;  // J
  double energy_scale_ = 0;                        // J, largest energy moved so far
  double energy_floor_ = 0;                        // J, energies below this are those of an arm at rest
  struct Imbalance {
    double value = 0, bound = 0, time = 0;  // J, J, s

    void remember(Memory& memory) { memory(value, bound, time); }
  };
  /// The instant with the largest ratio, for each power of ten of the energy moved until then.
  std::map<int, Imbalance> worst_imbalance_;
  double widest_bound_ = 0;  // J
  double tolerance_ = 0;     // of GlobalError
  long energy_steps_ = 0;
  double worst_position_ = 0, worst_orientation_ = 0;
};

}  // namespace osculate
