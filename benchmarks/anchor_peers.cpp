#include "benchmarks/anchor_peers.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace osculate::bench {

namespace {

struct Peer {
  const char *module, *setting;
  double first, last, factor;  // of the number of steps
};
const Peer peers[] = {
    {"mujoco", "MuJoCo, RK4", 200, 8000, std::pow(10, 0.125)},
};

}  // namespace

void run_peers(Anchor anchor, const char* problem, const std::function<Eigen::Vector3d(double t)>& exact,
               int repeats) {
  for (const Peer& peer : peers) {
    const std::string file = std::string(OSCULATE_PEER_DIR "/peer_") + peer.module + ".so";
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* symbol = module ? dlsym(module, "run_anchor") : nullptr;
    if (!symbol) {
      std::fprintf(stderr, "%s is left out: %s\n", peer.setting, dlerror());
      continue;
    }
    auto* run = reinterpret_cast<RunAnchor*>(symbol);
    const int count = 1 + static_cast<int>(std::log(peer.last / peer.first) / std::log(peer.factor) + 0.5);
    for (int i = 0; i < count; ++i) {
      const double steps = peer.first * std::pow(peer.factor, i);
      try {
        double error = 0;
        anchor.observe = [&](double t, const double* p) {
          error = std::max(error, (Eigen::Map<const Eigen::Vector3d>(p) - exact(t)).norm());
        };
        AnchorRun result;
        run(anchor, steps, result);
        anchor.observe = {};
        double seconds = 1e9;
        for (int j = 0; j < repeats; ++j) {
          run(anchor, steps, result);
          seconds = std::min(seconds, result.seconds);
        }
        std::printf("%s,\"%s\",%.3e,%.4e,%.1e,%ld,%ld,%d,%.5e,%.4e\n", problem, peer.setting, steps, error,
                    0.0, result.rhs, result.steps, 0, seconds, seconds / static_cast<double>(result.rhs));
        std::fflush(stdout);
      } catch (const std::exception& stop) {
        std::fprintf(stderr, "%s, %.1e: %s\n", peer.setting, steps, stop.what());
      }
    }
  }
}

}  // namespace osculate::bench
