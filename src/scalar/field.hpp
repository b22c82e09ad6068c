// What a number must be able to do. Everything in spatial/, recursion/ and reference/ asks for a Field only,
// so that double, exact rationals, wider floats, SIMD packets and counted operations can run the same lines.
#pragma once

#include <concepts>

namespace osculate {

/// Closed under + - * / with constants from int. No comparison: a packet of lanes has no single truth value.
template <class S>
concept Field = requires(S x) {
  S(0);
  S(1);
  {S(-x)};
  {S(x + x)};
  {S(x - x)};
  {S(x * x)};
  {S(x / x)};
};

/// A field whose values can be ordered; checks and thresholds need it, the sweeps do not.
template <class S>
concept Ordered = Field<S> && requires(S x) {
  { x < x } -> std::convertible_to<bool>;
};

}  // namespace osculate
