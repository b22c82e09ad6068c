// True error of the tip against right-hand sides and processor time, for every method over many tolerances:
// one CSV line for each run. work_precision.py makes page and figure of it.
//   work_precision [REPEATS [PROBLEM]]    times are the best of so many runs (default 5)
//   work_precision count PROBLEM RTOL     one run with the default settings and nothing else, for callgrind
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/anchor_peers.hpp"
#include "control/linear_response.hpp"
#include "experiment/make_loop.hpp"
#include "experiment/simulation.hpp"
#include "experiment/stops.hpp"
#include "jury/engines.hpp"

using namespace osculate;

namespace {

using Point = Vector3<double>;

/// Processor time of this program, s: other programs on the machine count less than in wall time.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Problem {
  const char* name;
  const char* file;
  std::vector<std::string> overrides;
  bool for_peers;            // the peers run it too
  bool closed_form;          // the tip's exact motion is known; otherwise two runs at tight_rtol stand for it
  double loosest, tightest;  // powers of ten of rtol
};

const Problem problems[] = {
    {"ur5e_circle", "ur5e_circle", {}, true, true, -3, -11.5},
    {"puma560_circle", "puma560_circle", {}, false, true, -3, -11.5},
    {"free_swing", "puma560_free_swing", {}, false, false, -3, -11},
    {"contact",
     "puma560_force",
     {"plant.environment.stiffness=1e6", "plant.environment.damping=2000"},
     false,
     false,
     -3,
     -9.5},
};
constexpr double tight_rtol = 1e-13;
constexpr double step_of_rtol = 0.25;  // powers of ten

struct Setting {
  const char* name;
  Method method;
  int max_order = 0;
  double fraction = 0;
  int remembered = -1;
  double atol = 1;  // position: times rtol, in rad; velocity: ten times that, in rad/s
  JacobianBy jacobian = JacobianBy::automatic;
};

const Setting settings[] = {
    {"adams", Method::adams},
    {"adams, order <= 8", Method::adams, 8},
    {"adams, order <= 5", Method::adams, 5},
    {"adams, no acceleration", Method::adams, 0, 0, 0},
    {"adams, CVODE's own corrector", Method::adams, 0, 0.1, 0},
    {"adams, atol = rtol / 100", Method::adams, 0, 0, -1, 0.01},
    {"bdf", Method::bdf},
    {"bdf, differences", Method::bdf, 0, 0, -1, 1, JacobianBy::differences},
    {"runge_kutta", Method::runge_kutta},
};

/// A problem, ready to run at any tolerance.
class Bench {
 public:
  explicit Bench(const Problem& problem)
      : experiment_(read_experiment(OSCULATE_SOURCE_DIR "/experiments/" + std::string(problem.file) + ".yaml",
                                    problem.overrides)),
        arms_(make_arms(experiment_)),
        loop_(make_loop(experiment_, arms_)),
        start_(initial_state(experiment_, loop_)) {}

  struct Run {
    long rhs = 0, steps = 0, failures = 0;
  };

  /// One run without checks. `out` is called with every output time and the interpolated state.
  template <class Out>
  Run run(const Setting& setting, double rtol, Out out) {
    IntegratorOptions options = integrator_options(experiment_.integrator, loop_, 1);
    options.method = setting.method;
    options.jacobian = setting.jacobian;
    options.max_order = setting.max_order;
    options.nonlinear_fraction = setting.fraction;
    options.remembered_iterates = setting.remembered;
    const auto positions = static_cast<std::size_t>(loop_.positions());
    const auto velocities = static_cast<std::size_t>(loop_.velocities());
    options.rtol = rtol;
    for (std::size_t i = 0; i < positions; ++i) options.atol[i] = setting.atol * rtol;
    for (std::size_t i = positions; i < positions + velocities; ++i)
      options.atol[i] = 10 * setting.atol * rtol;
    for (std::size_t i = positions + velocities; i < options.atol.size(); ++i) options.atol[i] = 1e5 * rtol;

    Simulation simulation(loop_, start_, options);
    Run result;
    Stops stops(experiment_, loop_.controller());
    long row = 0;
    while (const std::optional<Stop> stop = stops.next()) {
      simulation.limit = stop->jumps ? std::nextafter(stop->time, 0.0) : stop->time;
      while (simulation.integrator.t() < stop->time) {
        simulation.step(stop->time);
        ++result.steps;
        for (;; ++row) {
          const double t = static_cast<double>(row) * experiment_.output.interval;
          if (t > simulation.integrator.t()) break;
          simulation.integrator.interpolate(t, 0, state_);
          out(row, t, state_);
        }
      }
      simulation.limit = std::numeric_limits<double>::infinity();
      if (stop->kind != Stop::Kind::end) simulation.restart();
    }
    result.rhs = simulation.integrator.rhs_evaluations();
    result.failures = simulation.integrator.error_test_failures();
    return result;
  }

  /// Largest distance of the tip from the truth at the output times, m.
  double error(const Setting& setting, double rtol, Run& result) {
    double worst = 0;
    result = run(setting, rtol, [&](long row, double t, const std::vector<double>& y) {
      worst = std::max(worst, (tip(y) - truth(row, t)).norm());
    });
    return worst;
  }

  /// Processor time of one run with its outputs, s.
  double time(const Setting& setting, double rtol) {
    const double start = now();
    run(setting, rtol, [](long, double, const std::vector<double>&) {});
    return now() - start;
  }

  /// Processor time of one right-hand side, s.
  double time_of_right_side() {
    std::vector<double> yd(start_.size());
    constexpr int count = 500;
    double best = 1e9;
    for (int batch = 0; batch < 5; ++batch) {
      const double begin = now();
      for (int i = 0; i < count; ++i) loop_.right_side(1e-3 * i, start_.data(), yd.data());
      best = std::min(best, (now() - begin) / count);
    }
    return best;
  }

  /// Fills in the truth. Returns what two methods disagree by where it is not known in closed form, m.
  double find_truth(bool closed_form) {
    if (closed_form) return 0;
    const auto store = [](std::vector<Point>& points, const Point& p, long row) {
      points.resize(static_cast<std::size_t>(row) + 1);
      points.back() = p;
    };
    std::vector<Point> other;
    run({"", Method::runge_kutta}, tight_rtol,
        [&](long row, double, const std::vector<double>& y) { store(truth_, tip(y), row); });
    run({"", Method::adams}, tight_rtol,
        [&](long row, double, const std::vector<double>& y) { store(other, tip(y), row); });
    double apart = 0;
    for (std::size_t i = 0; i < truth_.size(); ++i) apart = std::max(apart, (truth_[i] - other[i]).norm());
    return apart;
  }

 private:
  Point tip(const std::vector<double>& y) const { return tip_pose(loop_.plant().chain, loop_.q(y.data())).p; }

  /// The arm starts at rest on the path, which moves: its first error rate is the path's velocity.
  Point truth(long row, double t) const {
    return truth_.empty() ? exact(t) : truth_[static_cast<std::size_t>(row)];
  }

 public:
  /// The tip's exact motion where it is known in closed form, m.
  Point exact(double t) const {
    const Controller& controller = loop_.controller();
    const PathPoint start = controller.path().at(0);
    Point p = tip_reference(controller.path(), controller.initial(), t).pose.p;
    for (int i = 0; i < 3; ++i)
      p[i] -= linear_response(experiment_.controller.stiffness[3 + i], experiment_.controller.damping[3 + i],
                              {0, start.yd[3 + i]}, t)
                  .e;
    return p;
  }

  /// The same problem for a peer: position and orientation of a path that does not turn, equal gains, no
  /// armature.
  bench::Anchor anchor() const {
    const Controller& controller = loop_.controller();
    const TipReference start = tip_reference(controller.path(), controller.initial(), 0);
    const auto q = loop_.q(start_.data());
    return {jury::arm_of(loop_.plant().chain),
            {q.begin(), q.end()},
            experiment_.duration,
            experiment_.output.interval,
            experiment_.controller.stiffness[3],
            experiment_.controller.damping[3],
            start.pose.R,
            [&controller](double t, double* p_v_a) {
              const TipReference now = tip_reference(controller.path(), controller.initial(), t);
              Eigen::Map<Matrix3<double>> out(p_v_a);
              out << now.pose.p, now.velocity.tail<3>(), now.acceleration.tail<3>();
            },
            {}};
  }

 private:
  Experiment experiment_;
  Arms arms_;
  ClosedLoop loop_;
  std::vector<double> start_, state_ = std::vector<double>(start_.size());
  std::vector<Point> truth_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) {
    for (const Problem& problem : problems)
      if (std::string(argv[2]) == problem.name) {
        Bench bench(problem);
        const auto run = bench.run(settings[0], std::atof(argv[3]), [](auto&&...) {});
        std::printf("%ld right-hand sides, %ld steps\n", run.rhs, run.steps);
        return 0;
      }
    return 2;
  }
  const int repeats = argc > 1 ? std::atoi(argv[1]) : 5;
  std::puts("problem,setting,rtol,error,floor,rhs,steps,failures,seconds,rhs_seconds");
  for (const Problem& problem : problems) {
    if (argc > 2 && std::string(argv[2]) != problem.name) continue;
    Bench bench(problem);
    const double floor = bench.find_truth(problem.closed_form);
    for (const Setting& setting : settings)
      for (double power = problem.loosest; power >= problem.tightest; power -= step_of_rtol) {
        const double rtol = std::pow(10, power);
        Bench::Run result;
        try {
          const double error = bench.error(setting, rtol, result);
          double seconds = 1e9;
          for (int i = 0; i < repeats; ++i) seconds = std::min(seconds, bench.time(setting, rtol));
          std::printf("%s,\"%s\",%.3e,%.4e,%.1e,%ld,%ld,%ld,%.5e,%.4e\n", problem.name, setting.name, rtol,
                      error, floor, result.rhs, result.steps, result.failures, seconds,
                      bench.time_of_right_side());
          std::fflush(stdout);
        } catch (const IntegrationStopped& stop) {
          std::fprintf(stderr, "%s, %s, rtol %.1e: %s\n", problem.name, setting.name, rtol, stop.what());
        }
      }
    if (problem.for_peers)
      bench::run_peers(
          bench.anchor(), problem.name, [&bench](double t) { return bench.exact(t); }, repeats);
  }
}
