// Runs our core calls for benchmarks/instructions.py: each runs once to warm up, then a batch that is
// counted.
//   bench_core           the batches, under callgrind; prints "CALL ARM COUNT" for each, in order
//   bench_core --build   what the counts depend on: compiler and flags
#include <cstdio>
#include <cstring>
#include <exception>

#include "benchmarks/arms.hpp"
#include "benchmarks/counted_batch.hpp"
#include "benchmarks/ours.hpp"

using namespace osculate::bench;

namespace {

/// `names`: of the task and of forward dynamics.
void count_routes(const std::string& name, void (*add)(const osculate::Chain<double>&, std::vector<Route>&),
                  const char* task, const char* forward_dynamics, int count) {
  const osculate::Chain<double> chain = chain_named(name);
  std::vector<Route> routes;
  add(chain, routes);
  for (const Route& route : routes)
    if (const char* call = route.call == Call::task ? task : forward_dynamics)
      count_route(call, name, route, chain.n(), count);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--build") == 0) {
    std::puts(OSCULATE_BUILD);
    return 0;
  }
  try {
    for (const char* name : {"random7", "random100"}) {
      count_routes(name, add_recursions, "four_sweeps", "forward_dynamics", 50);
      count_routes(name, add_column_form, "column_form", nullptr, 50);
      count_routes(name, add_dense, "dense", nullptr, 2);
    }
    const auto right_side = puma560_right_side();
    right_side();
    counted(50, right_side);
    std::puts("right_side puma560 50");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
