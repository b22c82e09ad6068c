// What the law does where the arm is about to lose directions of its task: a filter on the eigenvalues of
// Omega(0), scaled so that radians and metres can be compared.
#pragma once

#include <optional>

#include "control/spectrum.hpp"
#include "recursion/task.hpp"

namespace osculate {

enum class SingularPolicy {
  none,       // stop
  damped,     // damped least squares near the singularity (Nakamura and Hanafusa 1986, Wampler 1986)
  truncated,  // directions below the threshold are left out of F
  released,   // directions are released with a smooth weight; their motion is left to the null space
};

struct SingularityOptions {
  SingularPolicy policy = SingularPolicy::none;
  /// Of the scaled eigenvalues. none: the run stops where the smooth measure falls below it. The others: the
  /// policy acts on directions below it.
  double threshold = 1e-6;
  /// Damped: sigma / (sigma^2 + damping^2 (1 - (sigma/threshold)^2)^2) in place of 1 / sigma. > 0. Choose it
  /// no larger than the threshold: at r = damping/threshold > 1 nearly all of the change happens within the
  /// last 1 / (2 r) below the threshold, which is a cliff to an integrator.
  double damping = 1e-3;
  bool operator==(const SingularityOptions&) const = default;
};

/// Smallest-eigenvalue measure of Omega on the task rows, without kinks: 1 / trace(S^-1), where S is Omega
/// scaled by the mean diagonal entry of each block (angular, linear). Between sigma_min / m and sigma_min,
/// an analytic function of the state, 0 at a singularity. Returns 0 where a pivot is not positive.
double smooth_measure(const Compliance<double>& Omega, const TaskRows& rows);

/// What stands for 1 / sigma, x = sigma / threshold < 1; 1 / sigma itself from the threshold on.
///   damped: see `damping`. Value and slope are continuous at the threshold, the curvature jumps; at most
///     1 / (2 lambda), lambda = damping (1 - x^2), where sigma = lambda.
///   released: h(x) / sigma with the step h = x^3 (10 - 15 x + 6 x^2) from 0 to 1, so x^2 (10 - 15 x + 6 x^2)
///     / threshold: at most 1.2 / threshold, curvature continuous, 0 at and below sigma = 0.
///   none, truncated: 1 / sigma, which is all that they do to a direction that they keep.
double filtered_inverse(const SingularityOptions& options, double sigma);

/// The filtered inverse of Omega applied to a right side: W^-1 V f(sigma) V* W^-1, with S = W^-1 Omega W^-1 =
/// V sigma V* and W the roots of the scales of `smooth_measure`. Eigenvalues are found only where the policy
/// may act, or when they are asked for.
class SingularTask {
 public:
  /// `truncated`: number of directions that policy truncated leaves out, a mode that changes at events only.
  SingularTask(const SingularityOptions& options, const Compliance<double>& Omega, const TaskRows& rows,
               int truncated = 0);

  /// Whether the filter differs from the inverse here. If not, an L D L^T of Omega gives the same, sooner.
  bool active() const { return active_; }
  /// Entries from rows.size() on are zero.
  TaskVector<double> solve(const TaskVector<double>& right) const;
  /// Which of the task rows the direction of the smallest eigenvalue points along most: 0 .. rows.size() - 1.
  int weakest_row() const;
  /// Scaled eigenvalues, ascending; only the first rows.size(). Their errors are a few eps, and their mean
  /// is 1.
  const TaskVector<double>& eigenvalues() const;

 private:
  const Spectrum& spectrum() const;

  SingularityOptions options_;
  int m_ = 0, truncated_ = 0;
  bool active_ = false;
  TaskVector<double> w_{};
  std::array<TaskVector<double>, 6> S_{};
  // of S_, once they have been asked for
  mutable std::optional<Spectrum> spectrum_;
  mutable std::optional<TaskVector<double>> eigenvalues_;
};

}  // namespace osculate
