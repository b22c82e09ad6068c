// A double that counts the arithmetic done with it, so that costs in comments can be checked by running.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <compare>
#include <concepts>
#include <cstdint>
#include <ostream>

#include "scalar/field.hpp"

namespace osculate {

/// Operations executed, by kind. Differences of tallies are tallies too: what one more link costs.
struct Tally {
  std::int64_t multiplications = 0;
  std::int64_t additions = 0;  // and subtractions
  std::int64_t negations = 0;
  std::int64_t divisions = 0;
  std::int64_t roots = 0;

  bool operator==(const Tally&) const = default;

  friend Tally operator-(const Tally& x, const Tally& y) {
    return {x.multiplications - y.multiplications, x.additions - y.additions, x.negations - y.negations,
            x.divisions - y.divisions, x.roots - y.roots};
  }
  friend std::ostream& operator<<(std::ostream& out, const Tally& x) {
    return out << x.multiplications << " mul, " << x.additions << " add, " << x.negations << " neg, "
               << x.divisions << " div, " << x.roots << " sqrt";
  }
};

/// While it lives, every operation on Counted numbers in this thread goes to `tally`. A scope inside another
/// takes over until it ends; the outer tally does not see what the inner one counts.
class CountingScope {
 public:
  explicit CountingScope(Tally& tally) : outer_(active_) { active_ = &tally; }
  ~CountingScope() { active_ = outer_; }
  CountingScope(const CountingScope&) = delete;
  CountingScope& operator=(const CountingScope&) = delete;

 private:
  friend struct Counted;
  // The one piece of state behind the arithmetic: operators have no argument through which a tally could be
  // passed. For each thread its own; null outside every scope.
  static inline thread_local Tally* active_ = nullptr;
  Tally* outer_;
};

/// A double whose arithmetic is counted inside a CountingScope, and just done outside. Construction, copies,
/// comparisons and abs cost nothing. What is executed is counted: a product with a constant, even with 0 or
/// 1, is a multiplication.
struct Counted {
  double value = 0;

  Counted() = default;
  template <std::integral I>
  Counted(I n) : value(static_cast<double>(n)) {}
  explicit Counted(double x) : value(x) {}
  explicit operator double() const { return value; }

  Counted& operator+=(const Counted& y) { return *this = *this + y; }
  Counted& operator-=(const Counted& y) { return *this = *this - y; }
  Counted& operator*=(const Counted& y) { return *this = *this * y; }
  Counted& operator/=(const Counted& y) { return *this = *this / y; }

  friend Counted operator-(const Counted& x) { return count(&Tally::negations), Counted(-x.value); }
  friend Counted operator+(const Counted& x, const Counted& y) {
    return count(&Tally::additions), Counted(x.value + y.value);
  }
  friend Counted operator-(const Counted& x, const Counted& y) {
    return count(&Tally::additions), Counted(x.value - y.value);
  }
  friend Counted operator*(const Counted& x, const Counted& y) {
    return count(&Tally::multiplications), Counted(x.value * y.value);
  }
  friend Counted operator/(const Counted& x, const Counted& y) {
    return count(&Tally::divisions), Counted(x.value / y.value);
  }

  bool operator==(const Counted&) const = default;
  std::partial_ordering operator<=>(const Counted&) const = default;

  friend Counted abs(const Counted& x) { return Counted(std::abs(x.value)); }
  friend Counted sqrt(const Counted& x) { return count(&Tally::roots), Counted(std::sqrt(x.value)); }
  friend std::ostream& operator<<(std::ostream& out, const Counted& x) { return out << x.value; }

 private:
  static void count(std::int64_t Tally::*kind) {
    if (CountingScope::active_ != nullptr) ++(CountingScope::active_->*kind);
  }
};

}  // namespace osculate

namespace Eigen {
template <>
struct NumTraits<osculate::Counted> : GenericNumTraits<osculate::Counted> {
  using Real = osculate::Counted;
  using NonInteger = osculate::Counted;
  using Nested = osculate::Counted;
  using Literal = osculate::Counted;
  static Real epsilon() { return osculate::Counted(NumTraits<double>::epsilon()); }
  static Real dummy_precision() { return osculate::Counted(NumTraits<double>::dummy_precision()); }
  static int digits10() { return NumTraits<double>::digits10(); }
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
}  // namespace Eigen
