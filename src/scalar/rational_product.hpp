// Products of matrices of fractions. A sum of fractions reduces after every term; over a common denominator
// for each row and column it reduces once.
#pragma once

#include <numeric>
#include <vector>

#include "scalar/rational.hpp"

namespace osculate {

/// A B, exactly. Zeros cost nothing.
inline Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic> product(
    const Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic>& A,
    const Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic>& B) {
  using Integer = boost::multiprecision::cpp_int;
  using Fraction = boost::multiprecision::cpp_rational;
  struct Term {
    Eigen::Index at;
    Integer numerator;
  };
  struct Line {  // the entries of a row or column that are not 0, over one denominator
    Integer denominator = 1;
    std::vector<Term> terms;
  };
  const auto line = [](Eigen::Index n, const auto& entry) {
    Line out;
    for (Eigen::Index k = 0; k < n; ++k)
      if (!entry(k).is_zero()) {
        const Integer d = denominator(entry(k));
        if (out.denominator != d && out.denominator % d != 0) out.denominator = lcm(out.denominator, d);
      }
    for (Eigen::Index k = 0; k < n; ++k)
      if (!entry(k).is_zero())
        out.terms.push_back({k, numerator(entry(k)) * (out.denominator / denominator(entry(k)))});
    return out;
  };
  std::vector<Line> columns;
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    columns.push_back(line(B.rows(), [&](Eigen::Index k) -> const Fraction& { return B(k, j).number; }));
  Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic> C(A.rows(), B.cols());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const Line row = line(A.cols(), [&](Eigen::Index k) -> const Fraction& { return A(i, k).number; });
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      const Line& column = columns[static_cast<std::size_t>(j)];
      Integer sum = 0;
      auto a = row.terms.begin();
      for (const Term& b : column.terms) {
        while (a != row.terms.end() && a->at < b.at) ++a;
        if (a == row.terms.end()) break;
        if (a->at == b.at) sum += a->numerator * b.numerator;
      }
      if (sum != 0) C(i, j).number = Fraction(sum, Integer(row.denominator * column.denominator));
    }
  }
  return C;
}

}  // namespace osculate
