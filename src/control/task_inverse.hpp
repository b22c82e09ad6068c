// Omega(0)^-1 on the task rows in double, for a law that asks at every instant: solution, pivots and the
// smooth measure (singular_task.hpp) from one factorisation.
#pragma once

#include <array>

#include "recursion/task.hpp"

namespace osculate {

/// L D L^T of the task rows of Omega, as TaskFactor, with reciprocals of the pivots. Rows that the task lacks
/// are those of the unit matrix, so that every loop has a fixed length. About 250 operations with the
/// measure. No allocation.
class TaskInverse {
 public:
  TaskInverse(const Compliance<double>& Omega, const TaskRows& rows) : m_(static_cast<int>(rows.size())) {
    if (!are_all_rows(rows)) {
      factor(gathered(lower(Omega), rows));
      return;
    }
    const auto diagonal = [&Omega](int i) { return component(Omega, i, i); };
    weight_[0] = weight_[1] = weight_[2] = scale(diagonal(0) + diagonal(1) + diagonal(2), 3);
    weight_[3] = weight_[4] = weight_[5] = scale(diagonal(3) + diagonal(4) + diagonal(5), 3);
    factor(lower(Omega));
  }

  /// Diagonal of D; entries from the number of task rows on are 1.
  const TaskVector<double>& pivots() const { return pivots_; }
  /// First task row whose pivot is not above `floor` times its diagonal entry of Omega, as index into the
  /// task rows; -1: none. Such a row depends on the rows before it.
  int lost(double floor) const {
    for (int i = 0; i < m_; ++i)
      if (!(pivots_[static_cast<std::size_t>(i)] > floor * diagonal_[static_cast<std::size_t>(i)])) return i;
    return -1;
  }
  /// w^2 of each task row: the mean diagonal entry of Omega among the task rows of its block (angular,
  /// linear), 1 where the block does not move at all; 0 from the number of task rows on.
  const TaskVector<double>& squared_scale() const { return weight_; }

  /// 1 / trace(S^-1), S = W^-1 Omega W^-1; 0 where a pivot is not positive.
  double measure() const {
    bool positive = true;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < 6; ++i) positive = positive && pivots_[i] > 0;
    return positive ? 1 / trace() : 0.0;
  }

  /// Omega^-1 right. Entries of `right` from the number of task rows on must be zero.
  TaskVector<double> solve(const TaskVector<double>& right) const {
    TaskVector<double> y = right;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < 6; ++i)
#pragma GCC unroll 6
      for (std::size_t p = 0; p < i; ++p) y[i] -= L_[i][p] * y[p];
#pragma GCC unroll 6
    for (std::size_t i = 0; i < 6; ++i) y[i] *= reciprocal_[i];
#pragma GCC unroll 6
    for (std::size_t i = 6; i-- > 0;)
#pragma GCC unroll 6
      for (std::size_t p = i + 1; p < 6; ++p) y[i] -= L_[p][i] * y[p];
    return y;
  }

 private:
  using Square = std::array<TaskVector<double>, 6>;

  static double scale(double sum, int count) { return sum == 0 ? 1.0 : sum / count; }

  /// The lower triangle, all six rows.
  static Square lower(const Compliance<double>& Omega) {
    Square out{};
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j)
        out[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = component(Omega, i, j);
    return out;
  }

  /// The task rows, in their order, of which none stands twice.
  Square gathered(const Square& all, const TaskRows& rows) {
    Square A{};
    double sum[2] = {0, 0};  // angular, linear
    int count[2] = {0, 0};
    for (std::size_t i = 0; i < 6; ++i) {
      if (i >= rows.size()) {
        A[i][i] = 1;
        continue;
      }
      const auto row = static_cast<std::size_t>(rows[i]);
      for (std::size_t j = 0; j <= i; ++j) {
        const auto column = static_cast<std::size_t>(rows[j]);
        A[i][j] = row < column ? all[column][row] : all[row][column];
      }
      sum[row / 3] += A[i][i];
      ++count[row / 3];
    }
    for (std::size_t i = 0; i < rows.size(); ++i) weight_[i] = scale(sum[rows[i] / 3], count[rows[i] / 3]);
    return A;
  }

  void factor(const Square& A) {
    Square scaled;  // scaled[j][i] = L(i,j) d(j)
#pragma GCC unroll 6
    for (std::size_t j = 0; j < 6; ++j) {
      diagonal_[j] = A[j][j];
#pragma GCC unroll 6
      for (std::size_t i = j; i < 6; ++i) {
        double t = A[i][j];
#pragma GCC unroll 6
        for (std::size_t p = 0; p < j; ++p) t -= scaled[p][i] * L_[j][p];
        scaled[j][i] = t;
      }
      pivots_[j] = scaled[j][j];
      reciprocal_[j] = 1 / pivots_[j];
#pragma GCC unroll 6
      for (std::size_t i = j + 1; i < 6; ++i) L_[i][j] = scaled[j][i] * reciprocal_[j];
    }
  }

  /// Of W Omega^-1 W = (L^-1 W)* D^-1 (L^-1 W): a sum of squares.
  double trace() const {
    Square N;  // L^-1, unit lower triangular
    double sum = 0;
#pragma GCC unroll 6
    for (std::size_t i = 0; i < 6; ++i) {
      double row = weight_[i];
#pragma GCC unroll 6
      for (std::size_t j = 0; j < i; ++j) {
        double t = L_[i][j];
#pragma GCC unroll 6
        for (std::size_t p = j + 1; p < i; ++p) t += L_[i][p] * N[p][j];
        N[i][j] = -t;
        row += weight_[j] * (t * t);
      }
      sum += row * reciprocal_[i];
    }
    return sum;
  }

  int m_;
  Square L_;                     // the strictly lower part
  TaskVector<double> weight_{};  // w^2
  TaskVector<double> diagonal_, pivots_, reciprocal_;
};

}  // namespace osculate
