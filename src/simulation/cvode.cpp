#include "simulation/cvode.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <type_traits>

namespace osculate {

static_assert(std::is_same_v<sunrealtype, double>, "osculate needs SUNDIALS in double precision");

namespace {

using Reason = IntegrationStopped::Reason;

// The nonlinear equation of each step is solved to this fraction of the local error tolerance (CVODE's
// default is 0.1), so that the derivative of the interpolant and the right-hand side agree to the tolerance.
constexpr double nonlinear_fraction = 1e-2;
constexpr int nonlinear_iterations = 12;

// No arm has motions this short: a step below it means that the solution cannot be followed.
constexpr double smallest_step = 1e-11;  // s
// A step that shrinks to nothing within so many steps of a failed right-hand side shrank because of it.
constexpr long recent_steps = 100;

#if SUNDIALS_VERSION_MAJOR >= 7
SUNErrCode create_context(SUNContext* context) { return SUNContext_Create(SUN_COMM_NULL, context); }
#else
int create_context(SUNContext* context) { return SUNContext_Create(nullptr, context); }
#endif

void require(int flag, const char* call) {
  if (flag < 0)
    throw IntegrationStopped(Reason::failed,
                             std::string(call) + " failed: SUNDIALS error " + std::to_string(flag));
}

}  // namespace

struct Cvode::Impl {
  RightSide f;
  SUNContext context = nullptr;
  N_Vector y = nullptr, weights = nullptr, errors = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver nonlinear = nullptr;
  void* memory = nullptr;
  double t = 0;
  long finished_evaluations = 0, finished_failures = 0;  // before the last restart
  std::string message;                                   // last error message of CVODE
  std::exception_ptr thrown;                             // last exception of the right-hand side
  long steps = 0, thrown_in = 0;                         // steps tried; the one in which that happened

  ~Impl() {
    if (memory) CVodeFree(&memory);
    if (nonlinear) SUNNonlinSolFree(nonlinear);
    if (linear) SUNLinSolFree(linear);
    if (matrix) SUNMatDestroy(matrix);
    for (N_Vector v : {y, weights, errors})
      if (v) N_VDestroy(v);
    if (context) SUNContext_Free(&context);
  }

  static int right_side(sunrealtype t, N_Vector y, N_Vector yd, void* self_pointer) {
    auto& self = *static_cast<Impl*>(self_pointer);
    try {
      self.f(t, N_VGetArrayPointer(y), N_VGetArrayPointer(yd));
      return 0;
    } catch (const IntegrationStopped&) {
      self.thrown = std::current_exception();
      self.thrown_in = self.steps;
      return 1;  // recoverable: a smaller step may not reach the bad state
    } catch (...) {
      self.thrown = std::current_exception();
      return -1;
    }
  }

#if SUNDIALS_VERSION_MAJOR >= 7
  static void error_handler(int, const char*, const char*, const char* text, SUNErrCode, void* self,
                            SUNContext) {
    static_cast<Impl*>(self)->message = text ? text : "";
  }
#else
  static void error_handler(int, const char*, const char*, char* text, void* self) {
    static_cast<Impl*>(self)->message = text ? text : "";
  }
#endif

  /// `small`: the step became too small, rather than anything else.
  [[noreturn]] void stop(bool small, const std::string& what) {
    if (thrown && (!small || steps - thrown_in <= recent_steps)) std::rethrow_exception(thrown);
    throw IntegrationStopped(small ? Reason::step_too_small : Reason::failed,
                             "at t = " + std::to_string(t) + " s: " + what);
  }
};

Cvode::Cvode(RightSide f, double t0, std::span<const double> y0, const IntegratorOptions& options)
    : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  const auto size = static_cast<sunindextype>(y0.size());
  s.f = std::move(f);
  s.t = t0;
  require(static_cast<int>(create_context(&s.context)), "SUNContext_Create");
  s.y = N_VNew_Serial(size, s.context);
  N_VEnableFusedOps_Serial(s.y, SUNTRUE);
  s.weights = N_VNew_Serial(size, s.context);
  s.errors = N_VNew_Serial(size, s.context);
  std::copy(y0.begin(), y0.end(), N_VGetArrayPointer(s.y));
  s.memory = CVodeCreate(options.method == Method::adams ? CV_ADAMS : CV_BDF, s.context);
  if (!s.memory) throw IntegrationStopped(Reason::failed, "CVodeCreate failed");
#if SUNDIALS_VERSION_MAJOR >= 7
  SUNContext_ClearErrHandlers(s.context);
  SUNContext_PushErrHandler(s.context, Impl::error_handler, &s);
#else
  require(CVodeSetErrHandlerFn(s.memory, Impl::error_handler, &s), "CVodeSetErrHandlerFn");
#endif
  require(CVodeInit(s.memory, Impl::right_side, t0, s.y), "CVodeInit");
  require(CVodeSetUserData(s.memory, &s), "CVodeSetUserData");
  std::copy(options.atol.begin(), options.atol.end(), N_VGetArrayPointer(s.errors));
  require(CVodeSVtolerances(s.memory, options.rtol, s.errors), "CVodeSVtolerances");
  if (options.method == Method::adams) {
    s.nonlinear = SUNNonlinSol_FixedPoint(s.y, 0, s.context);
    require(CVodeSetNonlinearSolver(s.memory, s.nonlinear), "CVodeSetNonlinearSolver");
  } else {
    s.matrix = SUNDenseMatrix(size, size, s.context);
    s.linear = SUNLinSol_Dense(s.y, s.matrix, s.context);
    require(CVodeSetLinearSolver(s.memory, s.linear, s.matrix), "CVodeSetLinearSolver");
  }
  require(CVodeSetNonlinConvCoef(s.memory, nonlinear_fraction), "CVodeSetNonlinConvCoef");
  require(CVodeSetMaxNonlinIters(s.memory, nonlinear_iterations), "CVodeSetMaxNonlinIters");
  require(CVodeSetMaxStep(s.memory, options.max_step), "CVodeSetMaxStep");
  require(CVodeSetMinStep(s.memory, smallest_step), "CVodeSetMinStep");
}

Cvode::~Cvode() = default;
Cvode::Cvode(Cvode&&) noexcept = default;

StepInfo Cvode::step(double stop_time) {
  Impl& s = *impl_;
  ++s.steps;
  s.message.clear();
  require(CVodeSetStopTime(s.memory, stop_time), "CVodeSetStopTime");
  const double before = s.t;
  const int flag = CVode(s.memory, stop_time, s.y, &s.t, CV_ONE_STEP);
  if (flag < 0) {
    s.t = before;
    s.stop(flag == CV_ERR_FAILURE || flag == CV_CONV_FAILURE, s.message);
  }
  StepInfo info;
  info.t = s.t;
  info.at_stop = flag == CV_TSTOP_RETURN;
  CVodeGetLastStep(s.memory, &info.h);
  CVodeGetLastOrder(s.memory, &info.order);
  if (!(s.t > before) || !(info.h > 0)) s.stop(true, "the step shrank to zero");
  for (const double value : state())
    if (!std::isfinite(value))
      throw IntegrationStopped(Reason::non_finite,
                               "at t = " + std::to_string(s.t) + " s: the state is not finite");
  CVodeGetEstLocalErrors(s.memory, s.errors);
  CVodeGetErrWeights(s.memory, s.weights);
  const double* e = N_VGetArrayPointer(s.errors);
  const double* w = N_VGetArrayPointer(s.weights);
  for (std::size_t i = 0; i < state().size(); ++i)
    info.local_error = std::max(info.local_error, std::abs(e[i] * w[i]));
  return info;
}

void Cvode::restart() {
  Impl& s = *impl_;
  s.finished_evaluations = rhs_evaluations();
  s.finished_failures = error_test_failures();
  require(CVodeReInit(s.memory, s.t, s.y), "CVodeReInit");
}

double Cvode::t() const { return impl_->t; }

std::span<const double> Cvode::state() const {
  return {N_VGetArrayPointer(impl_->y), static_cast<std::size_t>(N_VGetLength(impl_->y))};
}

void Cvode::interpolate(double time, int derivative, std::span<double> out) const {
  Impl& s = *impl_;
  require(CVodeGetDky(s.memory, time, derivative, s.errors), "CVodeGetDky");
  const double* values = N_VGetArrayPointer(s.errors);
  std::copy(values, values + out.size(), out.begin());
}

long Cvode::rhs_evaluations() const {
  long count = 0;
  CVodeGetNumRhsEvals(impl_->memory, &count);
  return impl_->finished_evaluations + count;
}

long Cvode::error_test_failures() const {
  long count = 0;
  CVodeGetNumErrTestFails(impl_->memory, &count);
  return impl_->finished_failures + count;
}

std::string sundials_version() {
  char text[32] = "";
  SUNDIALSGetVersion(text, sizeof text);
  return text;
}

}  // namespace osculate
