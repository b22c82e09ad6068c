// What a run measures besides its claims, in constant memory: how far the tip is from what was commanded,
// what the joints are asked for, and how long they are beyond their limits.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "control/memory.hpp"
#include "control/reference.hpp"
#include "recursion/task.hpp"

namespace osculate {

/// Largest value and the first time it occurred, s. Not-a-number counts as infinite.
struct Peak {
  double value = 0;
  double time = std::numeric_limits<double>::quiet_NaN();

  void add(double t, double x);
  void remember(Memory& memory) { memory(value, time); }
};

/// Time for which something held, s, and when it held first and last.
struct TimeSpent {
  double total = 0;
  std::optional<double> first, last;

  /// The step of length h that ends at t.
  void add(double t, double h);
  void remember(Memory& memory) { memory(total, first, last); }
};

/// Limits of the joints, base to tip; infinite where there is none, an empty list where there are none at
/// all.
struct JointLimits {
  std::vector<double> lower, upper;  // rad or m, one for each position coordinate
  std::vector<double> velocity;      // rad/s or m/s, one for each velocity coordinate
  std::vector<double> effort;        // N m or N, one for each velocity coordinate
};

/// One instant of a run. Inertial frame, about the tip point, angular part first; joints base to tip.
struct DepartureInput {
  Vector6 tip_acceleration = Vector6::Zero();  // rad/s^2, m/s^2, of the plant
  Vector6 u = Vector6::Zero();                 // commanded
  Vector6 error = Vector6::Zero();             // rad, m, tracking error
  std::span<const double> q, qd, torque;       // rad or m and their rates; N m or N
  bool singularity_policy = false;             // the law's task is not the one asked for
  bool saturated = false;                      // a torque limit acts
  bool acts = true;  // u is the command of this instant; false between the samples of a sampled law
};

/// The results of it all.
struct DepartureResult {
  Peak angular_acceleration,
      linear_acceleration;     // rad/s^2, m/s^2: length of tip acceleration - u on the task rows
  Peak orientation, position;  // rad, m: length of the tracking error on the task rows
  double orientation_rms = 0, position_rms = 0;  // rad, m: root mean square over time, by trapezoids
  std::vector<Peak> torque;                      // N m or N, |T| of each velocity coordinate
  TimeSpent singularity_policy, saturated;
  std::vector<TimeSpent> beyond_position;                 // for each position coordinate
  std::vector<TimeSpent> beyond_velocity, beyond_effort;  // for each velocity coordinate

  /// Without the root mean squares, which are found at the end.
  void remember(Memory& memory) {
    memory(angular_acceleration, linear_acceleration, orientation, position, torque, singularity_policy,
           saturated, beyond_position, beyond_velocity, beyond_effort);
  }
};

class Departure {
 public:
  /// `rows`: on which acceleration follows u; `tracked`: those of them that follow the reference's pose.
  Departure(TaskRows rows, TaskRows tracked, JointLimits limits = {});

  /// The end, at t, of a step of length h, s; the start of the run with h = 0. What holds at the end of a
  /// step counts for all of it.
  void add(double t, double h, const DepartureInput& at);
  DepartureResult result() const;
  void remember(Memory& memory) {
    memory(so_far_, last_error_.angular, last_error_.linear, duration_, orientation_squares_,
           position_squares_);
  }

 private:
  /// Lengths of a vector on the angular and on the linear task rows.
  struct Lengths {
    double angular = 0, linear = 0;
  };
  static Lengths lengths(const Vector6& v, const TaskRows& rows);

  TaskRows rows_, tracked_;
  JointLimits limits_;
  DepartureResult so_far_;
  Lengths last_error_;
  double duration_ = 0;                                    // s
  double orientation_squares_ = 0, position_squares_ = 0;  // rad^2 s, m^2 s
};

}  // namespace osculate
