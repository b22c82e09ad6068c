// Runs a sweep with every call in it inlined, where numbers live in registers. A function that returns an
// inertia through memory costs more than its arithmetic; over fractions or counted numbers inlining only
// costs compile time.
#pragma once

#include <concepts>
#include <utility>

#include "scalar/field.hpp"

namespace osculate {

/// Numbers that live in a register: double; a packet says so itself.
template <class S>
inline constexpr bool in_register = std::same_as<S, double>;

namespace internal {
template <class Work>
[[gnu::flatten, gnu::noinline]] void flattened(Work&& work) {
  work();
}
}  // namespace internal

template <Field S, class Work>
void inlined(Work&& work) {
  if constexpr (in_register<S>)
    internal::flattened(std::forward<Work>(work));
  else
    work();
}

}  // namespace osculate
