// Ours and the peers on the same arms, timed by Google Benchmark in one run.
//   bench_peers [--benchmark_...]   times every route that agrees with ours
//   bench_peers --count             the batches that callgrind counts, as bench_core does
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <deque>
#include <exception>

#include "benchmarks/agreement.hpp"
#include "benchmarks/arms.hpp"
#include "benchmarks/counted_batch.hpp"
#include "benchmarks/ours.hpp"
#include "benchmarks/peers.hpp"
#include "jury/engines.hpp"

using namespace osculate;
using namespace osculate::bench;

namespace {

/// One arm with everything that runs on it.
struct Subject {
  explicit Subject(const std::string& arm_name)
      : name(arm_name), chain(chain_named(arm_name)), states(bench::states(chain.n())) {
    add_recursions(chain, routes);
    const std::size_t reference = routes.size();
    add_column_form(chain, routes);
    if (chain.n() <= 100) add_dense(chain, routes);
    add_peers(jury::arm_of(chain), routes);
    for (std::size_t i = 0; i < routes.size(); ++i) judge(routes[i], i < reference);
  }

  /// Keeps a route that agrees with our recursion of the same call.
  void judge(const Route& route, bool is_reference) {
    const std::string key = name + '|' + call_name(route) + '|' + route.system + '|' + route.name;
    if (!is_reference) {
      const Agreement found = compare(route, routes[route.call == Call::task ? 0 : 1], states);
      char text[100];
      if (route.call == Call::task)
        std::snprintf(text, sizeof text, "Omega %.1e F %.1e T %.1e", found.Omega, found.F, found.T);
      else
        std::snprintf(text, sizeof text, "qdd %.1e", found.qdd);
      const bool agrees = found.worst() <= agreement_bound;
      if (!agrees) std::fprintf(stderr, "refused: %s differs from ours: %s\n", key.c_str(), text);
      benchmark::AddCustomContext((agrees ? "agrees|" : "refused|") + key, text);
      if (!agrees) return;
    }
    kept.push_back({key, &route});
  }

  static const char* call_name(const Route& route) {
    return route.call == Call::task ? "task" : "forward dynamics";
  }

  std::string name;
  Chain<double> chain;
  std::vector<State> states;
  std::vector<Route> routes;
  struct Kept {
    std::string key;
    const Route* route;
  };
  std::vector<Kept> kept;
};

void time_route(benchmark::State& timer, const Route& route, const std::vector<bench::State>& states) {
  Answer answer;
  answer.qdd.resize(states.front().q.size());
  answer.T.resize(states.front().q.size());
  std::size_t next = 0;
  for (auto _ : timer) route.run(states[next++ % state_count], answer);
}

void count_all() {
  for (const char* name : {"random7", "random100"}) {
    const Subject subject(name);
    for (const auto& [key, route] : subject.kept) {
      std::string joined = key.substr(key.find('|') + 1);
      for (char& c : joined)
        if (c == ' ') c = '_';
      count_route(joined, name, *route, subject.chain.n(), subject.chain.n() > 50 ? 3 : 16);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 2 && std::strcmp(argv[1], "--count") == 0) {
      count_all();
      return 0;
    }
    std::deque<Subject> subjects;
    for (const char* name : {"random7", "random100", "puma560", "arm7", "random12", "random25", "random50"})
      subjects.emplace_back(name);
    for (const Subject& subject : subjects)
      for (const auto& [key, route] : subject.kept)
        benchmark::RegisterBenchmark(key.c_str(), [&subject, route = route](benchmark::State& timer) {
          time_route(timer, *route, subject.states);
        });
    const auto right_side = puma560_right_side();
    benchmark::RegisterBenchmark("puma560|right side|ours|reference, law, plant",
                                 [&right_side](benchmark::State& timer) {
                                   for (auto _ : timer) right_side();
                                 });
    benchmark::AddCustomContext("build", OSCULATE_BUILD);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
