#include "verification/cross_coupling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osculate {

CrossCoupling::CrossCoupling() {
  worst_.setConstant(std::numeric_limits<double>::quiet_NaN());
  time_ = worst_;
}

void CrossCoupling::add(const std::array<bool, 6>& commanded, double t, const Vector6& off) {
  if (std::count(commanded.begin(), commanded.end(), true) != 1) return;
  const auto row = std::find(commanded.begin(), commanded.end(), true) - commanded.begin();
  for (int column = 0; column < 6; ++column) {
    const double size =
        std::isnan(off[column]) ? std::numeric_limits<double>::infinity() : std::abs(off[column]);
    if (size <= worst_(row, column)) continue;  // false before the first
    worst_(row, column) = size;
    time_(row, column) = t;
  }
}

}  // namespace osculate
