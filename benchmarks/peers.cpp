#include "benchmarks/peers.hpp"

#include <dlfcn.h>

#include <cstdio>
#include <exception>

namespace osculate::bench {

void add_peers(const Arm& arm, std::vector<Route>& routes) {
  for (const char* name : {"kdl", "mujoco", "simbody", "dart"}) {
    const std::string file = std::string(OSCULATE_PEER_DIR "/peer_") + name + ".so";
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!module) {
      std::fprintf(stderr, "%s is not there: %s\n", name, dlerror());
      continue;
    }
    try {
      reinterpret_cast<AddRoutes*>(dlsym(module, "add_routes"))(arm, routes);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s cannot take the arm: %s\n", name, error.what());
    }
  }
}

}  // namespace osculate::bench
