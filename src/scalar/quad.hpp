// Floating point with 113 significant bits (binary128): eps is 2^-112, 2^60 times below that of double. Wide
// enough to call rounding in double an error of known size.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <concepts>
#include <ostream>

#include "scalar/field.hpp"

// Which type carries the bits is settled here and nowhere else:
//   long double            where it has 113 bits (aarch64, riscv64 under Linux): software in the C library
//   __float128, libquadmath on x86-64 with GCC's header: link with -lquadmath
//   cpp_bin_float_quad     elsewhere, or on request by OSCULATE_WITHOUT_QUADMATH: Boost, half as fast
#if __LDBL_MANT_DIG__ == 113
#include <cmath>
namespace osculate::quad_backend {
using Number = long double;
inline Number root(Number x) { return std::sqrt(x); }
inline Number sine(Number x) { return std::sin(x); }
inline Number cosine(Number x) { return std::cos(x); }
}  // namespace osculate::quad_backend
#elif defined(__x86_64__) && __has_include(<quadmath.h>) && !defined(OSCULATE_WITHOUT_QUADMATH)
#include <quadmath.h>
namespace osculate::quad_backend {
__extension__ typedef __float128 Number;
inline Number root(Number x) { return sqrtq(x); }
inline Number sine(Number x) { return sinq(x); }
inline Number cosine(Number x) { return cosq(x); }
}  // namespace osculate::quad_backend
#else
#include <boost/multiprecision/cpp_bin_float.hpp>
namespace osculate::quad_backend {
using Number = boost::multiprecision::cpp_bin_float_quad;
inline Number root(const Number& x) { return sqrt(x); }
inline Number sine(const Number& x) { return sin(x); }
inline Number cosine(const Number& x) { return cos(x); }
}  // namespace osculate::quad_backend
#endif

namespace osculate {

/// A number of 113 significant bits. A plain struct on purpose: Eigen then asks it for nothing but what is
/// declared here, whichever type is underneath.
struct Quad {
  quad_backend::Number number = 0;

  Quad() = default;
  template <std::integral I>
  Quad(I n) : number(n) {}
  /// Exact.
  explicit Quad(double x) : number(x) {}
  explicit Quad(const quad_backend::Number& x) : number(x) {}
  /// Rounded to nearest.
  explicit operator double() const { return static_cast<double>(number); }

  Quad& operator+=(const Quad& y) { return number += y.number, *this; }
  Quad& operator-=(const Quad& y) { return number -= y.number, *this; }
  Quad& operator*=(const Quad& y) { return number *= y.number, *this; }
  Quad& operator/=(const Quad& y) { return number /= y.number, *this; }

  friend Quad operator-(Quad x) { return x.number = -x.number, x; }
  friend Quad operator+(Quad x, const Quad& y) { return x += y; }
  friend Quad operator-(Quad x, const Quad& y) { return x -= y; }
  friend Quad operator*(Quad x, const Quad& y) { return x *= y; }
  friend Quad operator/(Quad x, const Quad& y) { return x /= y; }

  friend bool operator==(const Quad& x, const Quad& y) { return x.number == y.number; }
  friend std::partial_ordering operator<=>(const Quad& x, const Quad& y) {
    if (x.number < y.number) return std::partial_ordering::less;
    if (x.number > y.number) return std::partial_ordering::greater;
    return x.number == y.number ? std::partial_ordering::equivalent : std::partial_ordering::unordered;
  }

  friend Quad abs(const Quad& x) { return x.number < 0 ? -x : x; }
  /// Not a number for x < 0.
  friend Quad sqrt(const Quad& x) { return Quad(quad_backend::root(x.number)); }
  /// x in rad.
  friend Quad sin(const Quad& x) { return Quad(quad_backend::sine(x.number)); }
  friend Quad cos(const Quad& x) { return Quad(quad_backend::cosine(x.number)); }

  /// As a double and what is left of the number, so that nothing is hidden.
  friend std::ostream& operator<<(std::ostream& out, const Quad& x) {
    const double high(x);
    return out << high << " + " << double(x - Quad(high));
  }
};

/// 2^-112, the distance from 1 to the next number.
inline Quad quad_epsilon() { return Quad(0x1p-112); }

}  // namespace osculate

namespace Eigen {
template <>
struct NumTraits<osculate::Quad> : GenericNumTraits<osculate::Quad> {
  using Real = osculate::Quad;
  using NonInteger = osculate::Quad;
  using Nested = osculate::Quad;
  using Literal = osculate::Quad;
  static Real epsilon() { return osculate::quad_epsilon(); }
  static Real dummy_precision() { return osculate::Quad(0x1p-100); }
  static int digits10() { return 33; }
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 40,
    MulCost = 40
  };
};
}  // namespace Eigen
