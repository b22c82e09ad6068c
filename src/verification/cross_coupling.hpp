// What a motion that is commanded along one axis does along the other five.
#pragma once

#include <array>

#include "control/memory.hpp"
#include "control/reference.hpp"

namespace osculate {

/// 6 x 6: row = commanded axis, column = responding axis; angular axes first, inertial frame, about the tip
/// point.
class CrossCoupling {
 public:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  CrossCoupling();
  /// `commanded`: axes that the reference moves at t, s; counts where it is one alone. `off`: error minus the
  /// error of the closed-form solution, rad and m; not-a-number counts as infinite.
  void add(const std::array<bool, 6>& commanded, double t, const Vector6& off);

  /// Largest |off| of the column's axis while the row's axis alone was commanded, rad (columns 0..2) or m
  /// (3..5). Not-a-number in rows that never were.
  const Matrix6& worst() const { return worst_; }
  /// First time of each of these, s.
  const Matrix6& time() const { return time_; }
  void remember(Memory& memory) { memory(worst_, time_); }

 private:
  Matrix6 worst_, time_;
};

}  // namespace osculate
