// y' = f(t, y) by SUNDIALS: CVODE (Adams, BDF) or ARKODE (explicit Runge-Kutta). All of SUNDIALS is behind
// this file; one context for each object.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "control/memory.hpp"

namespace osculate {

enum class Method {
  adams,        // CVODE, fixed point with Anderson's acceleration
  bdf,          // CVODE, Newton, dense
  runge_kutta,  // ARKODE, Dormand and Prince's explicit 5(4); a restart costs one evaluation
};

/// Where Newton's iteration of bdf takes df/dy from.
enum class JacobianBy {
  automatic,    // the function given to the integrator, where there is one
  differences,  // CVODE's difference quotient: one evaluation of f for each y_i
};

struct IntegratorOptions {
  Method method = Method::adams;
  double rtol = 1e-10;       // local error in each y_i, root mean square: |e_i| <= rtol |y_i| + atol_i
  std::vector<double> atol;  // one for each y_i, > 0
  double max_step = 0.1;     // s, > 0
  JacobianBy jacobian = JacobianBy::automatic;
  // For studies of the method; 0 or -1 is what docs/work-precision.md found to be best.
  int max_order = 0;              // of adams (up to 12) and bdf (up to 5); 0: these limits
  double nonlinear_fraction = 0;  // of the tolerance, to which the corrector is solved; CVODE's default: 0.1
  int remembered_iterates = -1;   // by Anderson's acceleration of the corrector of adams
};

/// Why an integration cannot go on. The states accepted so far stay valid.
struct IntegrationStopped : std::runtime_error {
  enum class Reason { singular, non_finite, step_too_small, law /* one of your own */, failed };
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
  bool at_event = false;   // t is a zero of an event function: the step was cut short there

  void remember(Memory& memory) { memory(t, h, order, local_error, at_stop, at_event); }
};

class Integrator {
 public:
  /// Writes y' for (t, y); no side effects: it is called for rejected and predicted states too. Throwing
  /// IntegrationStopped makes the method retry with a smaller step, and becomes the reason if that does not
  /// help.
  using RightSide = std::function<void(double t, const double* y, double* yd)>;
  /// Writes the event functions g(t, y). A step ends where one of them changes sign, at the first such place,
  /// with the state just past it: there g has its new sign and is not zero. A function that is zero where a
  /// step starts is watched from where it leaves zero. What they throw has the effects of f throwing.
  using Events = std::function<void(double t, const double* y, double* g)>;
  /// Writes columns[j size + i] = df_i/dy_j at (t, y). As f, what it throws included. Newton's iteration of
  /// bdf needs it roughly: an error costs evaluations of f, not accuracy.
  using Jacobian = std::function<void(double t, const double* y, double* columns)>;

  Integrator(RightSide f, double t0, std::span<const double> y0, const IntegratorOptions& options,
             int event_count = 0, Events events = {}, Jacobian jacobian = {});
  ~Integrator();
  Integrator(Integrator&&) noexcept;

  /// One accepted step that does not pass `stop_time`. Throws IntegrationStopped.
  StepInfo step(double stop_time);
  /// Starts anew from the present state: after a known jump in f or in a derivative of it. CVODE begins with
  /// order 1, a one-step method goes on with its step size. Wanted after an event too if f has changed;
  /// without it the next step ends where the one cut short by the event would have, so its stop time must not
  /// be nearer.
  void restart();

  double t() const;
  std::span<const double> state() const;
  /// y (derivative = 0) or its derivative at a time inside the last step, from the method's own polynomial.
  /// With runge_kutta the first use in a step may evaluate f: ask before f changes.
  void interpolate(double time, int derivative, std::span<double> out) const;
  /// Calls of f, those for a Jacobian or for interpolation too.
  long rhs_evaluations() const;
  /// Calls of the Jacobian.
  long jacobian_evaluations() const;
  long error_test_failures() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "6.4.1" and the like.
std::string sundials_version();

}  // namespace osculate
