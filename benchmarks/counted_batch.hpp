// A batch of calls that callgrind counts alone (--toggle-collect) and reports by itself (--dump-after).
#pragma once

#include <cstdio>

#include "benchmarks/arms.hpp"

namespace osculate::bench {

/// The function that callgrind is told of. About ten instructions a call are its own.
extern "C" void osculate_counted_batch(int count, const std::function<void()>& run);

inline void counted(int count, const std::function<void()>& run) { osculate_counted_batch(count, run); }

/// One warm-up, then the batch over the arm's states; prints what was counted.
inline void count_route(const std::string& call, const std::string& arm_name, const Route& route, int n,
                        int count) {
  const std::vector<State> all = states(n);
  Answer answer;
  answer.qdd.resize(static_cast<std::size_t>(n));
  answer.T.resize(static_cast<std::size_t>(n));
  std::size_t next = 0;
  const auto run = [&] { route.run(all[next++ % state_count], answer); };
  run();
  counted(count, run);
  std::printf("%s %s %d\n", call.c_str(), arm_name.c_str(), count);
}

}  // namespace osculate::bench
