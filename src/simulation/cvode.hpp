// y' = f(t, y) by SUNDIALS CVODE. All of SUNDIALS is behind this file; one context for each object.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace osculate {

enum class Method { adams /* fixed point */, bdf /* Newton, dense */ };

struct IntegratorOptions {
  Method method = Method::adams;
  double rtol = 1e-10;       // local error in each y_i, root mean square: |e_i| <= rtol |y_i| + atol_i
  std::vector<double> atol;  // one for each y_i, > 0
  double max_step = 0.1;     // s, > 0
};

/// Why an integration cannot go on. The states accepted so far stay valid.
struct IntegrationStopped : std::runtime_error {
  enum class Reason { singular, non_finite, step_too_small, failed };
  IntegrationStopped(Reason why, const std::string& what) : std::runtime_error(what), reason(why) {}
  Reason reason;
};

/// One accepted step.
struct StepInfo {
  double t = 0;            // s, end of the step
  double h = 0;            // s, its length
  int order = 0;           // of the method in this step
  double local_error = 0;  // largest estimated local error in units of its tolerance
  bool at_stop = false;    // t is the stop time
};

class Cvode {
 public:
  /// Writes y' for (t, y); no side effects: CVODE calls it for rejected and predicted states too. Throwing
  /// IntegrationStopped makes CVODE retry with a smaller step, and becomes the reason if that does not help.
  using RightSide = std::function<void(double t, const double* y, double* yd)>;

  Cvode(RightSide f, double t0, std::span<const double> y0, const IntegratorOptions& options);
  ~Cvode();
  Cvode(Cvode&&) noexcept;

  /// One accepted step that does not pass `stop_time`. Throws IntegrationStopped.
  StepInfo step(double stop_time);
  /// Starts anew from the present state (order 1): after a known jump in a derivative of f.
  void restart();

  double t() const;
  std::span<const double> state() const;
  /// y (derivative = 0) or its derivative at a time inside the last step, from the method's own polynomial.
  void interpolate(double time, int derivative, std::span<double> out) const;
  long rhs_evaluations() const;
  long error_test_failures() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "6.4.1" and the like.
std::string sundials_version();

}  // namespace osculate
