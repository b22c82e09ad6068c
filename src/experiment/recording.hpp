// What a run records: the layout of its result file and the rows that go into it.
#pragma once

#include <filesystem>
#include <vector>

#include "experiment/arms.hpp"
#include "experiment/run.hpp"
#include "record/result_file.hpp"

namespace osculate {

class Recording {
 public:
  Recording(const std::filesystem::path& file, const Experiment& experiment, const Arms& arms,
            const std::string& command, bool force);

  /// One output instant. Without Lambda in `terms` (the arm is singular) what depends on it is missing.
  void output(const Observation& seen, const TaskRows& rows, const RecursiveTerms& terms, double condition);

  struct Step {
    long number = 0;
    double t = 0, h = 0, local_error = 0;
    int order = 0;
    long rhs_evaluations = 0;
    GlobalError error;
  };
  void step(const Step& step, const Residuals& residuals);

  void finish(const RunResult& result);

 private:
  ResultFile file_;
  std::vector<double> row_;
  Eigen::Vector4d tip_quaternion_ = Eigen::Vector4d::Zero(), reference_quaternion_ = Eigen::Vector4d::Zero();
};

}  // namespace osculate
