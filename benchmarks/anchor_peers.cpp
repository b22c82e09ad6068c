#include "benchmarks/anchor_peers.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace osculate::bench {

namespace {

struct Peer {
  const char *module, *setting;
  bool adaptive;
  double first, last;  // power of ten of the tolerance if adaptive, of the number of steps otherwise
  double step;
};
const Peer peers[] = {
    {"mujoco", "MuJoCo, RK4", false, 2.3, 3.925, 0.125},
    {"simbody", "Simbody, CPodes Adams", true, -2, -10.5, -0.25},
};

}  // namespace

void run_peers(Anchor anchor, const char* problem, const std::function<Eigen::Vector3d(double t)>& exact,
               int repeats) {
  for (const Peer& peer : peers) {
    const std::string file = std::string(OSCULATE_PEER_DIR "/peer_") + peer.module + ".so";
    // Simbody's library has an old SUNDIALS in it, whose functions bear the names of those that this program
    // is linked with: each must find its own.
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
    void* symbol = module ? dlsym(module, "run_anchor") : nullptr;
    if (!symbol) {
      std::fprintf(stderr, "%s is left out: %s\n", peer.setting, dlerror());
      continue;
    }
    auto* run = reinterpret_cast<RunAnchor*>(symbol);
    const int count = 1 + static_cast<int>(std::lround((peer.last - peer.first) / peer.step));
    for (int i = 0; i < count; ++i) {
      const double steps_or_tolerance = std::pow(10, peer.first + i * peer.step);
      try {
        double error = 0;
        anchor.observe = [&](double t, const double* p) {
          error = std::max(error, (Eigen::Map<const Eigen::Vector3d>(p) - exact(t)).norm());
        };
        AnchorRun result;
        run(anchor, steps_or_tolerance, result);
        anchor.observe = {};
        double seconds = 1e9;
        for (int j = 0; j < repeats; ++j) {
          run(anchor, steps_or_tolerance, result);
          seconds = std::min(seconds, result.seconds);
        }
        std::printf("%s,\"%s\",", problem, peer.setting);
        if (peer.adaptive) std::printf("%.3e", steps_or_tolerance);
        std::printf(",%.4e,%.1e,%ld,%ld,%ld,%.5e,%.4e\n", error, 0.0, result.rhs, result.steps,
                    result.failures, seconds, seconds / static_cast<double>(result.rhs));
        std::fflush(stdout);
      } catch (const std::exception& stop) {
        std::fprintf(stderr, "%s, %.1e: %s\n", peer.setting, steps_or_tolerance, stop.what());
      }
    }
  }
}

}  // namespace osculate::bench
