// Products of matrices of exact numbers by plain loops. Eigen's blocked kernels gain nothing where numbers
// are no machine numbers, and for each pair of operands they make dozens of types: loops compile sooner.
// Exact sums do not depend on their order, so the results are those of Eigen's kernels. Numbers that round
// keep Eigen's.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace osculate {

/// Whether field operations on S are exact: true for fractions and for dual numbers over them.
template <class S>
inline constexpr bool exact_numbers = false;

/// What Eigen asks of a product: dst = A B, dst += A B, dst -= A B, dst += alpha A B. dst has the product's
/// shape.
template <class Left, class Right>
struct ProductOfExactNumbers {
  using S = typename Left::Scalar;

  template <class Out>
  static void evalTo(Out& dst, const Left& A, const Right& B) {
    each(dst, A, B, [](S& out, const S& sum) { out = sum; });
  }
  template <class Out>
  static void addTo(Out& dst, const Left& A, const Right& B) {
    each(dst, A, B, [](S& out, const S& sum) { out += sum; });
  }
  template <class Out>
  static void subTo(Out& dst, const Left& A, const Right& B) {
    each(dst, A, B, [](S& out, const S& sum) { out -= sum; });
  }
  template <class Out>
  static void scaleAndAddTo(Out& dst, const Left& A, const Right& B, const S& alpha) {
    each(dst, A, B, [&](S& out, const S& sum) { out += alpha * sum; });
  }

 private:
  template <class Out, class Put>
  static void each(Out& dst, const Left& A, const Right& B, Put put) {
    // Expressions that are dear to evaluate are evaluated once.
    using A_once = typename Eigen::internal::nested_eval<Left, Eigen::Dynamic>::type;
    using B_once = typename Eigen::internal::nested_eval<Right, Eigen::Dynamic>::type;
    A_once a(A);
    B_once b(B);
    const Eigen::internal::evaluator<std::remove_cvref_t<A_once>> left(a);
    const Eigen::internal::evaluator<std::remove_cvref_t<B_once>> right(b);
    for (Eigen::Index j = 0; j < dst.cols(); ++j)
      for (Eigen::Index i = 0; i < dst.rows(); ++i) {
        S sum(0);
        for (Eigen::Index k = 0; k < A.cols(); ++k) sum += left.coeff(i, k) * right.coeff(k, j);
        put(dst.coeffRef(i, j), sum);
      }
  }
};

}  // namespace osculate

namespace Eigen::internal {
template <class L, class R>
requires osculate::exact_numbers<typename L::Scalar>
struct generic_product_impl<L, R, DenseShape, DenseShape, GemmProduct>
    : osculate::ProductOfExactNumbers<L, R> {
};
template <class L, class R>
requires osculate::exact_numbers<typename L::Scalar>
struct generic_product_impl<L, R, DenseShape, DenseShape, GemvProduct>
    : osculate::ProductOfExactNumbers<L, R> {
};
template <class L, class R>
requires osculate::exact_numbers<typename L::Scalar>
struct generic_product_impl<L, R, DenseShape, DenseShape, CoeffBasedProductMode>
    : osculate::ProductOfExactNumbers<L, R> {
};
}  // namespace Eigen::internal
