// How far apart two correct answers may be at one state.
#pragma once

#include "jury/jury.hpp"
#include "verification/state_terms.hpp"

namespace osculate::jury {

/// The answer of one member at one state; empty matrices for terms that it does not give. Vectors are
/// columns; Omega, Lambda, c and g on the task rows.
using Testimony = std::array<MatrixX<double>, term_count>;

/// Weights and bounds at one state, from our dense side: the same for every pair.
class Yardstick {
 public:
  Yardstick(const Chain<double>& chain, const StateTerms& terms, const VectorX<double>& q);

  /// Difference of a term in units of its bound.
  double ratio(Term term, const MatrixX<double>& a, const MatrixX<double>& b) const;
  /// Relative to the scale; infinite where the term does not exist.
  double bound(Term term) const { return measure(term).bound; }

 private:
  struct Measure {
    MatrixX<double> weight;  // of each entry
    double scale = 0;        // of the weighted entries
    double bound = 0;
  };
  const Measure& measure(Term term) const { return measures_[static_cast<std::size_t>(term)]; }
  Measure& measure(Term term) { return measures_[static_cast<std::size_t>(term)]; }
  void joint_terms(const Chain<double>& chain, const Evidence& e, const VectorX<double>& q);
  void task_terms(const StateTerms& terms);

  std::array<Measure, term_count> measures_;
};

}  // namespace osculate::jury
