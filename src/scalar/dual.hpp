// First-order forward differentiation: x + x' e with e e = 0. One direction at a time, nested for higher
// orders.
#pragma once

#include <Eigen/Core>
#include <concepts>

#include "scalar/exact_product.hpp"
#include "scalar/field.hpp"

namespace osculate {

/// A number and its derivative along one direction. Field operations only, over any field S, Dual itself
/// included.
template <Field S>
struct Dual {
  S value = S(0);
  S derivative = S(0);

  Dual() = default;
  Dual(const S& v, const S& d) : value(v), derivative(d) {}
  /// A constant: derivative 0.
  Dual(const S& v) : value(v) {}
  template <std::integral I>
  requires(!std::same_as<I, S>) Dual(I v) : value(static_cast<int>(v)) {}

  Dual& operator+=(const Dual& y) { return *this = *this + y; }
  Dual& operator-=(const Dual& y) { return *this = *this - y; }
  Dual& operator*=(const Dual& y) { return *this = *this * y; }
  Dual& operator/=(const Dual& y) { return *this = *this / y; }

  friend Dual operator-(const Dual& x) { return {-x.value, -x.derivative}; }
  friend Dual operator+(const Dual& x, const Dual& y) {
    return {x.value + y.value, x.derivative + y.derivative};
  }
  friend Dual operator-(const Dual& x, const Dual& y) {
    return {x.value - y.value, x.derivative - y.derivative};
  }
  friend Dual operator*(const Dual& x, const Dual& y) {
    return {x.value * y.value, x.value * y.derivative + x.derivative * y.value};
  }
  /// y.value must not be 0.
  friend Dual operator/(const Dual& x, const Dual& y) {
    const S quotient = x.value / y.value;
    return {quotient, (x.derivative - quotient * y.derivative) / y.value};
  }
};

template <class S>
inline constexpr bool exact_numbers<Dual<S>> = exact_numbers<S>;

/// The values of a matrix of dual numbers, same shape.
template <class Derived>
auto values(const Eigen::MatrixBase<Derived>& x) {
  using S = decltype(Derived::Scalar::value);
  using Plain = Eigen::Matrix<S, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime>;
  return Plain(x.unaryExpr([](const Dual<S>& e) { return e.value; }));
}

/// The derivatives of a matrix of dual numbers, same shape.
template <class Derived>
auto derivatives(const Eigen::MatrixBase<Derived>& x) {
  using S = decltype(Derived::Scalar::value);
  using Plain = Eigen::Matrix<S, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime>;
  return Plain(x.unaryExpr([](const Dual<S>& e) { return e.derivative; }));
}

}  // namespace osculate

namespace Eigen {
template <class S>
struct NumTraits<osculate::Dual<S>> : GenericNumTraits<osculate::Dual<S>> {
  using Real = osculate::Dual<S>;
  using NonInteger = osculate::Dual<S>;
  using Nested = osculate::Dual<S>;
  using Literal = osculate::Dual<S>;
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 1,
    ReadCost = 2 * NumTraits<S>::ReadCost,
    AddCost = 2 * NumTraits<S>::AddCost,
    MulCost = 3 * NumTraits<S>::MulCost + NumTraits<S>::AddCost
  };
};
}  // namespace Eigen
