// Exact rational numbers of any size, for runs in which every identity must hold without a tolerance.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <concepts>
#include <memory>
#include <ostream>

#include "scalar/exact_product.hpp"
#include "scalar/field.hpp"

namespace osculate {

class Rational;
template <>
inline constexpr bool exact_numbers<Rational> = true;
using MatrixOfFractions = Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic>;

/// A fraction in lowest terms. Slow, and slower as numerators grow: keep inputs to small integers over small
/// integers. The arithmetic is compiled once, in rational.cpp: Boost's header takes longer than most files
/// here.
class Rational {
 public:
  Rational() = default;
  template <std::integral I>
  Rational(I n) {
    if constexpr (std::is_signed_v<I>)
      assign(static_cast<long long>(n));
    else
      assign(static_cast<unsigned long long>(n));
  }
  /// n / d. Throws std::overflow_error for d = 0, as division does.
  Rational(int n, int d);
  /// The value of the double itself, without rounding: Rational(0.1) is not 1/10. Finite arguments only.
  explicit Rational(double x);
  Rational(const Rational& x);
  Rational(Rational&& x) noexcept = default;
  Rational& operator=(const Rational& x);
  Rational& operator=(Rational&& x) noexcept = default;
  explicit operator double() const;

  Rational& operator+=(const Rational& y);
  Rational& operator-=(const Rational& y);
  Rational& operator*=(const Rational& y);
  /// Throws std::overflow_error for y = 0.
  Rational& operator/=(const Rational& y);

  friend Rational operator-(Rational x) { return x.negate(), x; }
  friend Rational operator+(const Rational& x, const Rational& y);
  friend Rational operator-(const Rational& x, const Rational& y);
  friend Rational operator*(const Rational& x, const Rational& y);
  friend Rational operator/(const Rational& x, const Rational& y);

  friend bool operator==(const Rational& x, const Rational& y);
  friend std::strong_ordering operator<=>(const Rational& x, const Rational& y);
  friend Rational abs(Rational x) { return x < Rational() ? -x : x; }
  /// As "3/2", or "3" where the denominator is 1.
  friend std::ostream& operator<<(std::ostream& out, const Rational& x);
  friend MatrixOfFractions product(const MatrixOfFractions& A, const MatrixOfFractions& B);

 private:
  struct Fraction;
  struct Delete {
    void operator()(Fraction* fraction) const noexcept;
  };
  std::unique_ptr<Fraction, Delete> fraction_;  // none for 0: zeros, most of a block matrix, cost nothing

  void assign(long long n);
  void assign(unsigned long long n);
  void negate();
  void make(Fraction value);
  static const Fraction& fraction(const Rational& x);
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
