#include "scalar/rational.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <vector>

#include "scalar/rational_product.hpp"

namespace osculate {

namespace {

using Integer = boost::multiprecision::cpp_int;
using Number = boost::multiprecision::cpp_rational;

}  // namespace

struct Rational::Fraction {
  Number number;
};

void Rational::Delete::operator()(Fraction* fraction) const noexcept { delete fraction; }

void Rational::make(Fraction value) {
  if (value.number.is_zero())
    fraction_.reset();
  else if (fraction_)
    *fraction_ = std::move(value);
  else
    fraction_.reset(new Fraction(std::move(value)));
}
void Rational::assign(long long n) { make({Number(n)}); }
void Rational::assign(unsigned long long n) { make({Number(n)}); }
void Rational::negate() {
  if (fraction_) fraction_->number.backend().negate();
}
const Rational::Fraction& Rational::fraction(const Rational& x) {
  static const Fraction zero;
  return x.fraction_ ? *x.fraction_ : zero;
}

Rational::Rational(int n, int d) : Rational(n) { *this /= Rational(d); }
Rational::Rational(double x) { make({Number(x)}); }
Rational::Rational(const Rational& x) {
  if (x.fraction_) fraction_.reset(new Fraction(*x.fraction_));
}
Rational& Rational::operator=(const Rational& x) {
  if (!x.fraction_)
    fraction_.reset();
  else if (this != &x)
    make(*x.fraction_);
  return *this;
}
Rational::operator double() const { return fraction_ ? fraction_->number.convert_to<double>() : 0; }

Rational operator+(const Rational& x, const Rational& y) {
  if (!x.fraction_) return y;
  if (!y.fraction_) return x;
  Rational out;
  out.make({x.fraction_->number + y.fraction_->number});
  return out;
}
Rational operator-(const Rational& x, const Rational& y) {
  if (!y.fraction_) return x;
  Rational out;
  out.make({Rational::fraction(x).number - y.fraction_->number});
  return out;
}
Rational operator*(const Rational& x, const Rational& y) {
  Rational out;
  if (x.fraction_ && y.fraction_) out.make({x.fraction_->number * y.fraction_->number});
  return out;
}
Rational operator/(const Rational& x, const Rational& y) {
  Rational out;
  out.make({Rational::fraction(x).number / Rational::fraction(y).number});
  return out;
}
Rational& Rational::operator+=(const Rational& y) { return *this = *this + y; }
Rational& Rational::operator-=(const Rational& y) { return *this = *this - y; }
Rational& Rational::operator*=(const Rational& y) { return *this = *this * y; }
Rational& Rational::operator/=(const Rational& y) { return *this = *this / y; }

bool operator==(const Rational& x, const Rational& y) {
  if (!x.fraction_ || !y.fraction_) return !x.fraction_ && !y.fraction_;
  return x.fraction_->number == y.fraction_->number;
}
std::strong_ordering operator<=>(const Rational& x, const Rational& y) {
  return Rational::fraction(x).number.compare(Rational::fraction(y).number) <=> 0;
}
std::ostream& operator<<(std::ostream& out, const Rational& x) {
  return out << Rational::fraction(x).number.str();
}

MatrixOfFractions product(const MatrixOfFractions& A, const MatrixOfFractions& B) {
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
      if (entry(k)) {
        const Integer d = denominator(entry(k)->number);
        if (out.denominator != d && out.denominator % d != 0) out.denominator = lcm(out.denominator, d);
      }
    for (Eigen::Index k = 0; k < n; ++k)
      if (entry(k)) {
        const Number& x = entry(k)->number;
        out.terms.push_back({k, numerator(x) * (out.denominator / denominator(x))});
      }
    return out;
  };
  std::vector<Line> columns;
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    columns.push_back(line(B.rows(), [&](Eigen::Index k) { return B(k, j).fraction_.get(); }));
  MatrixOfFractions C(A.rows(), B.cols());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const Line row = line(A.cols(), [&](Eigen::Index k) { return A(i, k).fraction_.get(); });
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      const Line& column = columns[static_cast<std::size_t>(j)];
      Integer sum = 0;
      auto a = row.terms.begin();
      for (const Term& b : column.terms) {
        while (a != row.terms.end() && a->at < b.at) ++a;
        if (a == row.terms.end()) break;
        if (a->at == b.at) sum += a->numerator * b.numerator;
      }
      if (sum != 0) C(i, j).make({Number(sum, Integer(row.denominator * column.denominator))});
    }
  }
  return C;
}

}  // namespace osculate
