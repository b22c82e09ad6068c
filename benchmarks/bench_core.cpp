// Core calls on the PUMA 560, for ./dev bench.
//   bench_core                 wall time of one call, best of several batches
//   bench_core CALL COUNT      that many calls and nothing else, for counting instructions
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>

#include "model/urdf.hpp"
#include "reference/dense.hpp"
#include "simulation/closed_loop.hpp"

using namespace osculate;

namespace {

struct Call {
  const char* name;
  const char* what;
  std::function<void()> run;
};

double best_time(const std::function<void()>& run) {
  double best = 1e9;
  for (int batch = 0; batch < 7; ++batch) {
    constexpr int count = 2000;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) run();
    best = std::min(best,
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count);
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  ChainChoice choice;
  choice.tip = "tool0";
  const Chain<double> chain = load_urdf(OSCULATE_SOURCE_DIR "/models/puma560.urdf", choice).chain;
  const std::vector<double> q{0.1, -0.8, 0.4, 0.2, 0.9, 0.3}, qd{0.1, 0.2, -0.3, 0.4, 0.5, -0.6};
  const auto joints = positions<double>(chain, q);
  const VectorX<double> rates = Eigen::Map<const VectorX<double>>(qd.data(), 6);
  const TaskRows rows = all_rows();

  OperationalSpace<double> space(chain);
  ForwardDynamics<double> plant(chain);
  std::vector<double> T(6), qdd(6), y(15, 0.0), yd(15);
  std::copy(q.begin(), q.end(), y.begin());
  std::copy(qd.begin(), qd.end(), y.begin() + 6);
  ClosedLoop loop(Controller(chain, {}, LawOptions{}, make_path(CircleOptions{}), tip_pose(chain, q)),
                  Plant{chain, {}, Vector6::Zero()});

  const Call calls[] = {
      {"four_sweeps", "Omega, F_c and T by the four sweeps, kinematics included",
       [&] {
         space.place(joints);
         space.sweep(qd);
         const TaskFactor<double> Omega(space.Omega(), rows);
         space.torques(wrench(Omega.solve(restricted(space.right_side(), rows)), rows), T);
       }},
      {"forward_dynamics", "joint accelerations, kinematics included",
       [&] {
         plant.place(joints);
         plant.accelerations(qd, T, {}, qdd);
       }},
      {"right_side", "one closed-loop right-hand side: reference, law, plant",
       [&] { loop.right_side(0.3, y.data(), yd.data()); }},
      {"dense", "the dense side: M, C, G, J, Jdot qd, Omega, Lambda, c, g",
       [&] {
         const auto state = dense::state(chain, joints, rates);
         const auto terms = dense::task_terms(dense::mobility(state.tip, state.joint));
         T[0] = terms.c[0];
       }},
  };
  if (argc == 3) {
    for (const Call& call : calls)
      if (std::strcmp(call.name, argv[1]) == 0) {
        for (long i = std::atol(argv[2]); i > 0; --i) call.run();
        return 0;
      }
    std::fprintf(stderr, "no call is named %s\n", argv[1]);
    return 2;
  }
  const double unit = best_time(calls[0].run);
  for (const Call& call : calls) {
    const double time = best_time(call.run);
    std::printf("%-17s %8.2f us  %6.2f x four_sweeps   %s\n", call.name, time * 1e6, time / unit, call.what);
  }
}
