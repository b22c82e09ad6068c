#include "simulation/integrator.hpp"

#include <arkode/arkode_erkstep.h>
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
#include <limits>
#include <optional>
#include <type_traits>

#include "simulation/small_vector.hpp"

namespace osculate {

static_assert(std::is_same_v<sunrealtype, double>, "osculate needs SUNDIALS in double precision");

namespace {

using Reason = IntegrationStopped::Reason;

// The nonlinear equation of each step is solved to this fraction of the local error tolerance; CVODE's
// default is 0.1. A corrector that stops early is less stable: Adams then takes shorter steps and needs more
// evaluations for the same true error (docs/work-precision.md). Solved so far, the derivative of the
// interpolant and the right-hand side agree to the tolerance too. Newton's iteration overshoots its goal.
constexpr double adams_fraction = 3e-3;
constexpr double bdf_fraction = 1e-1;
constexpr int nonlinear_iterations = 12;
// Anderson's acceleration of Adams' fixed point remembers one iterate: up to a sixth fewer evaluations; a
// second one changes nothing.
constexpr int remembered_iterates = 1;

// No arm has motions this short: a step below it means that the solution cannot be followed.
constexpr double smallest_step = 1e-11;  // s
// What stands for an event function of 0, with the sign it had before: small, but far enough from underflow
// for the secants of the root finder.
constexpr double as_good_as_zero = 1e-100;
// A step that shrinks to nothing within so many steps of a failed right-hand side shrank because of it.
constexpr long recent_steps = 100;

// Dormand and Prince's 5(4): the last stage of a step is the first of the next one, so it takes six
// evaluations a step and eight where f jumps; its interpolant (quartic Hermite) is about as accurate as the
// step. ARKODE's Fehlberg 7(8) takes 17 where f jumps and pays off on smooth motions only, where Adams is
// cheaper still.
constexpr ARKODE_ERKTableID runge_kutta_table = ARKODE_DORMAND_PRINCE_7_4_5;
constexpr int runge_kutta_order = 5;

#if SUNDIALS_VERSION_MAJOR >= 7
SUNErrCode create_context(SUNContext* context) { return SUNContext_Create(SUN_COMM_NULL, context); }
#else
int create_context(SUNContext* context) { return SUNContext_Create(nullptr, context); }
#endif

/// What both solvers offer under their own names.
struct Solver {
  int (*evolve)(void*, double tout, N_Vector y, double* t, int task);
  int (*reset)(void*, double t, N_Vector y);
  int (*tolerances)(void*, double rtol, N_Vector atol);
  int (*user_data)(void*, void*);
  int (*roots)(void*, int count, int (*g)(double, N_Vector, double*, void*));
  int (*max_step)(void*, double);
  int (*min_step)(void*, double);
  int (*stop_time)(void*, double);
  int (*derivative)(void*, double t, int k, N_Vector);
  int (*last_order)(void*, int*);
  int (*local_errors)(void*, N_Vector);
  int (*weights)(void*, N_Vector);
  int (*failures)(void*, long*);
  void (*free)(void**);
};

constexpr Solver cvode = {CVode,
                          CVodeReInit,
                          CVodeSVtolerances,
                          CVodeSetUserData,
                          CVodeRootInit,
                          CVodeSetMaxStep,
                          CVodeSetMinStep,
                          CVodeSetStopTime,
                          CVodeGetDky,
                          CVodeGetLastOrder,
                          CVodeGetEstLocalErrors,
                          CVodeGetErrWeights,
                          CVodeGetNumErrTestFails,
                          CVodeFree};

#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define OSCULATE_ARKODE(name) ARKode##name
#else
#define OSCULATE_ARKODE(name) ERKStep##name
#endif
constexpr Solver arkode = {OSCULATE_ARKODE(Evolve),
                           OSCULATE_ARKODE(Reset),
                           OSCULATE_ARKODE(SVtolerances),
                           OSCULATE_ARKODE(SetUserData),
                           OSCULATE_ARKODE(RootInit),
                           OSCULATE_ARKODE(SetMaxStep),
                           OSCULATE_ARKODE(SetMinStep),
                           OSCULATE_ARKODE(SetStopTime),
                           OSCULATE_ARKODE(GetDky),
                           [](void*, int* order) { return *order = runge_kutta_order, 0; },
                           OSCULATE_ARKODE(GetEstLocalErrors),
                           OSCULATE_ARKODE(GetErrWeights),
                           OSCULATE_ARKODE(GetNumErrTestFails),
                           OSCULATE_ARKODE(Free)};
#undef OSCULATE_ARKODE

static_assert(int{CV_ONE_STEP} == int{ARK_ONE_STEP} && CV_ROOT_RETURN == ARK_ROOT_RETURN &&
              CV_ERR_FAILURE == ARK_ERR_FAILURE && CV_CONV_FAILURE == ARK_CONV_FAILURE &&
              CV_RTFUNC_FAIL == ARK_RTFUNC_FAIL);

void require(int flag, const char* call) {
  if (flag < 0)
    throw IntegrationStopped(Reason::failed,
                             std::string(call) + " failed: SUNDIALS error " + std::to_string(flag));
}

}  // namespace

struct Integrator::Impl {
  RightSide f;
  Events events;
  Jacobian slopes;
  Solver solver;
  bool runge_kutta;
  SUNContext context = nullptr;
  N_Vector y = nullptr, start = nullptr, weights = nullptr, errors = nullptr;  // start: of the last step
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver nonlinear = nullptr;
  void* memory = nullptr;
  double t = 0;
  long evaluations = 0;
  long jacobian_evaluations = 0;
  long finished_failures = 0;  // forgotten by the solver at a reset
  std::string message;         // last error message of the solver

  // The last value of f. ARKODE asks for the same one again: for each use of its interpolant.
  double known_t = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> known_y, known_f;

  std::vector<int> sides;  // -1, 0, 1: signs of the events where the step starts
  std::vector<double> values;

  std::exception_ptr thrown;      // last exception of f or the events
  double thrown_at = 0;           // s, the time they were called for
  bool thrown_now = false;        // in the present call of the solver
  bool recoverable = false;       // it was IntegrationStopped
  long steps = 0, thrown_in = 0;  // steps tried; the one in which that happened

  ~Impl() {
    if (memory) solver.free(&memory);
    if (nonlinear) SUNNonlinSolFree(nonlinear);
    if (linear) SUNLinSolFree(linear);
    if (matrix) SUNMatDestroy(matrix);
    for (N_Vector v : {y, start, weights, errors})
      if (v) N_VDestroy(v);
    if (context) SUNContext_Free(&context);
  }

  void create_cvode(const IntegratorOptions& options, sunindextype size);
  void create_arkode();

  /// A call of f or the events at time `at`, in SUNDIALS' terms: 0, 1 (a smaller step may help) or -1.
  template <class Call>
  int guarded(double at, Call call) {
    try {
      call();
      return 0;
    } catch (const IntegrationStopped&) {
      remember_exception(at, true);
      return 1;
    } catch (...) {
      remember_exception(at, false);
      return -1;
    }
  }
  void remember_exception(double at, bool smaller_step_may_help) {
    thrown = std::current_exception();
    thrown_at = at;
    thrown_in = steps;
    thrown_now = true;
    recoverable = smaller_step_may_help;
  }

  static int right_side(sunrealtype t, N_Vector y_vector, N_Vector yd_vector, void* self_pointer) {
    auto& self = *static_cast<Impl*>(self_pointer);
    const double* y = N_VGetArrayPointer(y_vector);
    double* yd = N_VGetArrayPointer(yd_vector);
    if (t == self.known_t && std::equal(self.known_y.begin(), self.known_y.end(), y)) {
      std::copy(self.known_f.begin(), self.known_f.end(), yd);
      return 0;
    }
    ++self.evaluations;
    const int flag = self.guarded(t, [&] { self.f(t, y, yd); });
    if (flag != 0) return flag;
    self.known_t = t;
    std::copy_n(y, self.known_y.size(), self.known_y.begin());
    std::copy_n(yd, self.known_f.size(), self.known_f.begin());
    return 0;
  }

  static int jacobian(sunrealtype t, N_Vector y, N_Vector, SUNMatrix out, void* self_pointer, N_Vector,
                      N_Vector, N_Vector) {
    auto& self = *static_cast<Impl*>(self_pointer);
    ++self.jacobian_evaluations;
    return self.guarded(t, [&] { self.slopes(t, N_VGetArrayPointer(y), SUNDenseMatrix_Data(out)); });
  }

  /// A zero counts to the side that the step started on, so that the state at an event lies past it: there
  /// the caller can tell from the signs what comes next.
  static int event_functions(sunrealtype t, N_Vector y, sunrealtype* g, void* self_pointer) {
    auto& self = *static_cast<Impl*>(self_pointer);
    if (!std::isfinite(t)) return -1;
    const int flag = self.guarded(t, [&] { self.events(t, N_VGetArrayPointer(y), g); });
    for (std::size_t i = 0; i < self.sides.size(); ++i)
      if (g[i] == 0) g[i] = self.sides[i] * as_good_as_zero;
    return flag;
  }

  /// The sides at the start of a step.
  void set_sides() {
    if (sides.empty()) return;
    std::fill(sides.begin(), sides.end(), 0);
    thrown_now = false;
    if (event_functions(t, y, values.data(), this) != 0) stop(false, "");
    for (std::size_t i = 0; i < sides.size(); ++i) sides[i] = (values[i] > 0) - (values[i] < 0);
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

  long failures() const {
    long count = 0;
    solver.failures(memory, &count);
    return finished_failures + count;
  }

  /// Starts anew from (t, y). CVODE sets its counters to zero, ARKODE does not.
  void reset() {
    const long before = failures();
    require(solver.reset(memory, t, y), "reset");
    finished_failures += before - failures();
  }

  /// ARKODE does not retry where f throws, and no solver does where the events throw: then we do, from the
  /// start of the step and half as far. The new stop time, or nothing if that is not worth trying.
  std::optional<double> nearer_stop(int flag) const {
    const bool solver_retried = !runge_kutta && flag != CV_RTFUNC_FAIL;
    const double length = (thrown_at - t) / 2;
    if (!thrown_now || !recoverable || solver_retried || !(length > smallest_step)) return {};
    return t + length;
  }

  /// `small`: the step became too small, rather than anything else.
  [[noreturn]] void stop(bool small, const std::string& what) {
    if (thrown_now || (thrown && small && steps - thrown_in <= recent_steps)) std::rethrow_exception(thrown);
    throw IntegrationStopped(small ? Reason::step_too_small : Reason::failed,
                             "at t = " + std::to_string(t) + " s: " +
                                 (!what.empty() ? what
                                  : small       ? "the step became too small"
                                                : "SUNDIALS failed"));
  }
};

void Integrator::Impl::create_cvode(const IntegratorOptions& options, sunindextype size) {
  const bool adams = options.method == Method::adams;
  memory = CVodeCreate(adams ? CV_ADAMS : CV_BDF, context);
  if (!memory) throw IntegrationStopped(Reason::failed, "CVodeCreate failed");
#if SUNDIALS_VERSION_MAJOR < 7
  require(CVodeSetErrHandlerFn(memory, error_handler, this), "CVodeSetErrHandlerFn");
#endif
  require(CVodeInit(memory, right_side, t, y), "CVodeInit");
  if (adams) {
    nonlinear = SUNNonlinSol_FixedPoint(
        y, options.remembered_iterates < 0 ? remembered_iterates : options.remembered_iterates, context);
    require(CVodeSetNonlinearSolver(memory, nonlinear), "CVodeSetNonlinearSolver");
  } else {
    matrix = SUNDenseMatrix(size, size, context);
    linear = SUNLinSol_Dense(y, matrix, context);
    require(CVodeSetLinearSolver(memory, linear, matrix), "CVodeSetLinearSolver");
    if (slopes) require(CVodeSetJacFn(memory, jacobian), "CVodeSetJacFn");
  }
  const double fraction = options.nonlinear_fraction > 0 ? options.nonlinear_fraction
                          : adams                        ? adams_fraction
                                                         : bdf_fraction;
  require(CVodeSetNonlinConvCoef(memory, fraction), "CVodeSetNonlinConvCoef");
  if (options.max_order > 0) require(CVodeSetMaxOrd(memory, options.max_order), "CVodeSetMaxOrd");
  require(CVodeSetMaxNonlinIters(memory, nonlinear_iterations), "CVodeSetMaxNonlinIters");
}

void Integrator::Impl::create_arkode() {
  memory = ERKStepCreate(right_side, t, y, context);
  if (!memory) throw IntegrationStopped(Reason::failed, "ERKStepCreate failed");
#if SUNDIALS_VERSION_MAJOR < 7
  require(ERKStepSetErrHandlerFn(memory, error_handler, this), "ERKStepSetErrHandlerFn");
#endif
  require(ERKStepSetTableNum(memory, runge_kutta_table), "ERKStepSetTableNum");
#if SUNDIALS_VERSION_MAJOR < 6 || (SUNDIALS_VERSION_MAJOR == 6 && SUNDIALS_VERSION_MINOR < 6)
  // The elementary controller, h^5 proportional to the error: fewer evaluations than the default (PI) on
  // smooth problems and where stability limits the step. Later versions keep their default.
  require(ERKStepSetAdaptivityMethod(memory, ARK_ADAPT_I, 1, 1, nullptr), "ERKStepSetAdaptivityMethod");
#endif
}

Integrator::Integrator(RightSide f, double t0, std::span<const double> y0, const IntegratorOptions& options,
                       int event_count, Events events, Jacobian jacobian)
    : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  const auto size = static_cast<sunindextype>(y0.size());
  s.f = std::move(f);
  s.events = std::move(events);
  if (options.method == Method::bdf && options.jacobian == JacobianBy::automatic)
    s.slopes = std::move(jacobian);
  s.runge_kutta = options.method == Method::runge_kutta;
  s.solver = s.runge_kutta ? arkode : cvode;
  s.sides.resize(static_cast<std::size_t>(event_count));
  s.values.resize(s.sides.size());
  s.t = t0;
  s.known_y.resize(y0.size());
  s.known_f.resize(y0.size());
  require(static_cast<int>(create_context(&s.context)), "SUNContext_Create");
#if SUNDIALS_VERSION_MAJOR >= 7
  SUNContext_ClearErrHandlers(s.context);
  SUNContext_PushErrHandler(s.context, Impl::error_handler, &s);
#endif
  // The dense Newton solver makes vectors of the columns of its matrix, which have no filled blocks.
  s.y =
      options.method == Method::bdf ? N_VNew_Serial(size, s.context) : small_vector::create(size, s.context);
  for (N_Vector* v : {&s.start, &s.weights, &s.errors}) *v = N_VClone(s.y);
  std::copy(y0.begin(), y0.end(), N_VGetArrayPointer(s.y));
  if (s.runge_kutta)
    s.create_arkode();
  else
    s.create_cvode(options, size);
  require(s.solver.user_data(s.memory, &s), "SetUserData");
  std::copy(options.atol.begin(), options.atol.end(), N_VGetArrayPointer(s.errors));
  require(s.solver.tolerances(s.memory, options.rtol, s.errors), "SVtolerances");
  require(s.solver.max_step(s.memory, options.max_step), "SetMaxStep");
  require(s.solver.min_step(s.memory, smallest_step), "SetMinStep");
  if (event_count > 0) require(s.solver.roots(s.memory, event_count, Impl::event_functions), "RootInit");
}

Integrator::~Integrator() = default;
Integrator::Integrator(Integrator&&) noexcept = default;

StepInfo Integrator::step(double stop_time) {
  Impl& s = *impl_;
  ++s.steps;
  const double before = s.t;
  N_VScale(1, s.y, s.start);
  s.set_sides();
  double stop = stop_time;
  int flag = 0;
  for (;;) {
    s.message.clear();
    s.thrown_now = false;
    require(s.solver.stop_time(s.memory, stop), "SetStopTime");
    flag = s.solver.evolve(s.memory, stop, s.y, &s.t, CV_ONE_STEP);
    if (flag == CV_TOO_CLOSE) {  // CVODE does not begin a step of two bits; over those y is constant
      s.t = stop;
      s.reset();
      return {.t = s.t, .h = s.t - before, .order = 1, .at_stop = s.t == stop_time};
    }
    // ARKODE passes over what f throws when only its interpolant needs f.
    if (flag >= 0 && !(s.runge_kutta && s.thrown_now)) break;
    s.t = before;
    N_VScale(1, s.start, s.y);
    const std::optional<double> nearer = s.nearer_stop(flag);
    if (!nearer) s.stop(flag == CV_ERR_FAILURE || flag == CV_CONV_FAILURE, s.message);
    stop = *nearer;
    s.reset();
  }
  StepInfo info;
  info.t = s.t;
  info.h = s.t - before;
  info.at_stop = s.t == stop_time;
  info.at_event = flag == CV_ROOT_RETURN;
  s.solver.last_order(s.memory, &info.order);
  if (!(info.h > 0)) s.stop(true, "the step shrank to zero");
  for (const double value : state())
    if (!std::isfinite(value))
      throw IntegrationStopped(Reason::non_finite,
                               "at t = " + std::to_string(s.t) + " s: the state is not finite");
  s.solver.local_errors(s.memory, s.errors);
  s.solver.weights(s.memory, s.weights);
  const double* e = N_VGetArrayPointer(s.errors);
  const double* w = N_VGetArrayPointer(s.weights);
  for (std::size_t i = 0; i < state().size(); ++i)
    info.local_error = std::max(info.local_error, std::abs(e[i] * w[i]));
  return info;
}

void Integrator::restart() {
  impl_->known_t = std::numeric_limits<double>::quiet_NaN();
  impl_->reset();
}

double Integrator::t() const { return impl_->t; }

std::span<const double> Integrator::state() const {
  return {N_VGetArrayPointer(impl_->y), static_cast<std::size_t>(N_VGetLength(impl_->y))};
}

void Integrator::interpolate(double time, int derivative, std::span<double> out) const {
  Impl& s = *impl_;
  s.thrown_now = false;
  if (s.solver.derivative(s.memory, time, derivative, s.errors) < 0) s.stop(false, "interpolation failed");
  const double* values = N_VGetArrayPointer(s.errors);
  std::copy(values, values + out.size(), out.begin());
}

long Integrator::rhs_evaluations() const { return impl_->evaluations; }

long Integrator::jacobian_evaluations() const { return impl_->jacobian_evaluations; }

long Integrator::error_test_failures() const { return impl_->failures(); }

std::string sundials_version() {
  char text[32] = "";
  SUNDIALSGetVersion(text, sizeof text);
  return text;
}

}  // namespace osculate
