// The worst rounding error over many arms, in eps of a stated scale, with the arm it was seen on.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing {

/// Largest of error / (eps scale). A NaN is worse than everything.
struct Worst {
  double factor = 0;
  std::string where = "no arm";

  void see(double error, double scale, const std::string& arm) {
    const double now = error / (eps * scale);
    if (now <= factor || std::isnan(factor)) return;
    factor = now;
    where = arm;
  }
  /// Each error over its own scale; same shapes. An error of 0 fits every scale.
  void see_each(const Eigen::MatrixXd& error, const Eigen::MatrixXd& scale, const std::string& arm) {
    for (int i = 0; i < error.size(); ++i)
      if (error(i) != 0) see(std::abs(error(i)), scale(i), arm);
  }
};

/// `allowed` is at most 5 times the worst that was seen on these arms, which stands beside each use.
inline void check_within(const char* what, const Worst& worst, double allowed) {
  INFO(what << ": " << worst.factor << " eps on " << worst.where);
  CHECK(worst.factor <= allowed);
}

}  // namespace osculate::testing
