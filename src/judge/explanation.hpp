// Least squares over subsets of groups of columns: which few of many explain a difference.
#pragma once

#include <functional>
#include <vector>

#include "model/chain.hpp"

namespace osculate {

/// X beta = d in the sense of least squares; every row has noise of deviation 1.
struct Regression {
  MatrixX<double> X;  // rows x columns
  VectorX<double> d;  // rows
};

/// Consecutive columns that come and go together.
struct ColumnGroup {
  int first = 0, columns = 1;
};

struct Fit {
  std::vector<int> groups;    // rising
  VectorX<double> beta;       // columns, zero outside the groups
  VectorX<double> deviation;  // columns; one standard deviation for noise of deviation 1
  double rss = 0;             // sum of squares that is left
  double score = 0;           // rss plus a price for each column
};

/// All subsets of groups on one regression.
class Explanations {
 public:
  Explanations(Regression regression, std::vector<ColumnGroup> groups);

  /// The fit of one subset. Columns that depend on others before them get beta 0.
  Fit fit(const std::vector<int>& groups) const;
  /// The fit of everything.
  Fit full() const;
  /// The subsets that contain `always` and score within `margin` of the best one, the best first; every
  /// subset of up to four more groups is tried, larger ones from the best of those. `price`: of one column.
  /// `sensible`: fits that it refuses do not count.
  std::vector<Fit> search(const std::vector<int>& always, double price, double margin,
                          const std::function<bool(const Fit&)>& sensible = {}) const;
  /// The part of d that a fit leaves.
  VectorX<double> rest(const Fit& fit) const;
  /// Root of the mean square of what column would do at beta = 1, over the rows.
  double size(int column) const;

  const Regression& regression() const { return regression_; }
  const std::vector<ColumnGroup>& groups() const { return groups_; }

 private:
  Regression regression_;
  std::vector<ColumnGroup> groups_;
  VectorX<double> scale_;   // norm of each column; 0: empty
  MatrixX<double> gram_;    // of the scaled columns
  VectorX<double> moment_;  // scaled columns times d
  double dd_;
};

}  // namespace osculate
