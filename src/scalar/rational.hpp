// Exact rational numbers of any size, for runs in which every identity must hold without a tolerance.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <concepts>
#include <ostream>

#include "scalar/field.hpp"

// GCC 12 at -O1 warns, wrongly, of an uninitialised number where Boost's assignment is inlined into Eigen.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wunknown-warning-option"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <boost/multiprecision/cpp_int.hpp>
#pragma GCC diagnostic pop

namespace osculate {

/// A fraction in lowest terms. A plain struct on purpose: Boost's expression-template number does not compile
/// with Eigen 3.4 in C++20. Slow, and slower as numerators grow: keep inputs to small integers over small
/// integers.
struct Rational {
  boost::multiprecision::cpp_rational number;

  Rational() = default;
  template <std::integral I>
  Rational(I n) : number(n) {}
  /// n / d. Throws std::overflow_error for d = 0, as division does.
  Rational(int n, int d) : number(n) { number /= d; }
  /// The value of the double itself, without rounding: Rational(0.1) is not 1/10. Finite arguments only.
  explicit Rational(double x) : number(x) {}
  explicit operator double() const { return number.convert_to<double>(); }

  Rational& operator+=(const Rational& y) { return number += y.number, *this; }
  Rational& operator-=(const Rational& y) { return number -= y.number, *this; }
  Rational& operator*=(const Rational& y) { return number *= y.number, *this; }
  /// Throws std::overflow_error for y = 0.
  Rational& operator/=(const Rational& y) { return number /= y.number, *this; }

  friend Rational operator-(Rational x) { return x.number = -x.number, x; }
  friend Rational operator+(Rational x, const Rational& y) { return x += y; }
  friend Rational operator-(Rational x, const Rational& y) { return x -= y; }
  friend Rational operator*(Rational x, const Rational& y) { return x *= y; }
  friend Rational operator/(Rational x, const Rational& y) { return x /= y; }

  friend bool operator==(const Rational& x, const Rational& y) { return x.number == y.number; }
  friend std::strong_ordering operator<=>(const Rational& x, const Rational& y) {
    return x.number.compare(y.number) <=> 0;
  }
  friend Rational abs(Rational x) { return x.number < 0 ? -x : x; }
  friend std::ostream& operator<<(std::ostream& out, const Rational& x) { return out << x.number.str(); }
};

}  // namespace osculate

namespace Eigen {
template <>
struct NumTraits<osculate::Rational> : GenericNumTraits<osculate::Rational> {
  using Real = osculate::Rational;
  using NonInteger = osculate::Rational;
  using Nested = osculate::Rational;
  using Literal = osculate::Rational;
  static Real epsilon() { return 0; }
  static Real dummy_precision() { return 0; }
  static int digits10() { return 0; }
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 1,
    ReadCost = 10,
    AddCost = 100,
    MulCost = 100
  };
};
}  // namespace Eigen
