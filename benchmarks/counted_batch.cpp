#include "benchmarks/counted_batch.hpp"

extern "C" __attribute__((noinline)) void osculate_counted_batch(int count,
                                                                 const std::function<void()>& run) {
  for (int i = 0; i < count; ++i) run();
}
