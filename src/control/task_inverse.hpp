// Omega(0)^-1 on the task rows in double, for a law that asks at every instant: solution, pivots and the
// smooth measure (singular_task.hpp) from one factorisation.
#pragma once

#include "recursion/task.hpp"

namespace osculate {

/// TaskFactor with what a law looks at before it trusts the solution. No allocation.
class TaskInverse {
 public:
  TaskInverse(const Compliance<double>& Omega, const TaskRows& rows) : factor_(Omega, rows) {
    if (are_all_rows(rows)) {  // nothing has to be looked up
      diagonal_ = {component(Omega, 0, 0), component(Omega, 1, 1), component(Omega, 2, 2),
                   component(Omega, 3, 3), component(Omega, 4, 4), component(Omega, 5, 5)};
      weight_[0] = weight_[1] = weight_[2] = scale(diagonal_[0] + diagonal_[1] + diagonal_[2], 3);
      weight_[3] = weight_[4] = weight_[5] = scale(diagonal_[3] + diagonal_[4] + diagonal_[5], 3);
      return;
    }
    double sum[2] = {0, 0};  // angular, linear
    int count[2] = {0, 0};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      diagonal_[i] = component(Omega, rows[i], rows[i]);
      const bool linear = rows[i] >= 3;
      sum[linear] += diagonal_[i];
      ++count[linear];
    }
    const double mean[2] = {scale(sum[0], count[0]), scale(sum[1], count[1])};
    for (std::size_t i = 0; i < rows.size(); ++i) weight_[i] = mean[rows[i] >= 3];
  }

  /// First task row whose pivot is not above `floor` times its diagonal entry of Omega, as index into the
  /// task rows; -1: none. Such a row depends on the rows before it.
  int lost(double floor) const {
    const TaskVector<double> pivots = factor_.pivots();
    for (std::size_t i = 0; i < static_cast<std::size_t>(factor_.size()); ++i)
      if (!(pivots[i] > floor * diagonal_[i])) return static_cast<int>(i);
    return -1;
  }
  /// w^2 of each task row: the mean diagonal entry of Omega among the task rows of its block (angular,
  /// linear), 1 where the block does not move at all; 0 from the number of task rows on.
  const TaskVector<double>& squared_scale() const { return weight_; }

  /// 1 / trace(S^-1), S = W^-1 Omega W^-1; 0 where a pivot is not positive.
  double measure() const {
    if (lost(0) >= 0) return 0;
    return 1 / factor_.inverse_trace(weight_);
  }

  /// Omega^-1 right. Entries of `right` from the number of task rows on must be zero.
  TaskVector<double> solve(const TaskVector<double>& right) const { return factor_.solve(right); }

 private:
  static double scale(double sum, int count) { return sum == 0 ? 1.0 : sum / count; }

  TaskFactor<double> factor_;
  TaskVector<double> weight_{};  // w^2
  TaskVector<double> diagonal_{};
};

}  // namespace osculate
