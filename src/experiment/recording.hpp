// What a run records: the layout of its result file and the rows that go into it.
#pragma once

#include <filesystem>
#include <vector>

#include "experiment/arms.hpp"
#include "experiment/run.hpp"
#include "record/restart_point.hpp"
#include "record/result_file.hpp"

namespace osculate {

/// What is written when a run is over: the verdict, what was measured, wall times (ending_of.cpp).
Ending ending_of(const RunResult& result);

class Recording {
 public:
  Recording(const std::filesystem::path& file, const Experiment& experiment, const Arms& arms,
            const std::string& command, bool force);

  /// Copies what the run behind `point` had recorded until then. Throws FileError.
  void go_on_from(const RestartPoint& point);
  /// A restart point at time t, s: afterwards all rows so far and these numbers are on disk.
  void restart_point(double t, const std::vector<double>& memory);

  /// One output instant. Without Lambda in `terms` (the arm is singular) what depends on it is missing.
  void output(const Observation& seen, const TaskRows& rows, const RecursiveTerms& terms);

  struct Step {
    long number = 0;
    StepInfo info;
    long rhs_evaluations = 0;
    GlobalError error;
    Modes modes;
    Vector6 missed;  // rad/s^2, m/s^2: tip acceleration - u
  };
  void step(const Step& step, const Residuals& residuals);

  void finish(const RunResult& result);

  /// The signs of the recorded quaternions go on.
  void remember(Memory& memory) { memory(tip_quaternion_, reference_quaternion_); }

 private:
  ResultFile file_;
  TaskRows rows_;
  bool controlled_ = true, contact_ = false;
  std::vector<double> row_;
  Eigen::Vector4d tip_quaternion_ = Eigen::Vector4d::Zero(), reference_quaternion_ = Eigen::Vector4d::Zero();
};

}  // namespace osculate
