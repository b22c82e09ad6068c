// Several doubles side by side, by the vector extensions that GCC and Clang share: the compiler chooses the
// instructions, so the same lines run on SSE2, AVX2, AVX-512 and NEON.
#pragma once

#include <cstdint>

/// Forces inlining. A function that returns several vector registers through memory costs more than its
/// arithmetic. Used where it was measured to matter, and nowhere else.
#define OSCULATE_INLINE [[gnu::always_inline]] inline

namespace osculate {

/// Doubles that one register holds in this build. Chosen at build time by the target: -march=x86-64-v4 gives
/// 8, -march=x86-64-v3 gives 4, and any x86-64 or 64-bit Arm without a switch 2.
#if defined(__AVX512F__)
inline constexpr int native_lanes = 8;
#elif defined(__AVX__)
inline constexpr int native_lanes = 4;
#else
inline constexpr int native_lanes = 2;
#endif

/// N doubles, and N whole numbers of 64 bits as comparisons give them: -1 for true, 0 for false.
template <int N>
struct LanesOf {
  typedef double Numbers __attribute__((vector_size(N * 8)));
  typedef std::int64_t Words __attribute__((vector_size(N * 8)));
};

}  // namespace osculate
