#include "judge/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osculate {

namespace {

// A column whose part across the ones before it is shorter than this says nothing of its own.
constexpr double dependent = 1e-5;
constexpr int exhaustive = 4;  // groups

}  // namespace

Explanations::Explanations(Regression regression, std::vector<ColumnGroup> groups)
    : regression_(std::move(regression)), groups_(std::move(groups)) {
  const auto& [X, d] = regression_;
  scale_ = X.colwise().norm();
  MatrixX<double> scaled = X;
  for (Eigen::Index i = 0; i < X.cols(); ++i)
    if (scale_[i] > 0) scaled.col(i) /= scale_[i];
  gram_.noalias() = scaled.transpose() * scaled;
  moment_.noalias() = scaled.transpose() * d;
  dd_ = d.squaredNorm();
}

double Explanations::size(int column) const {
  return scale_[column] / std::sqrt(static_cast<double>(regression_.d.size()));
}

Fit Explanations::fit(const std::vector<int>& groups) const {
  std::vector<int> columns;
  for (const int g : groups)
    for (int i = 0; i < groups_[static_cast<std::size_t>(g)].columns; ++i)
      columns.push_back(groups_[static_cast<std::size_t>(g)].first + i);
  const auto k = static_cast<Eigen::Index>(columns.size());
  Fit out{groups, VectorX<double>::Zero(regression_.X.cols()), VectorX<double>::Zero(regression_.X.cols()),
          dd_, 0};
  // L D L^T of the scaled Gram matrix, leaving out the columns whose pivot is lost.
  MatrixX<double> L = MatrixX<double>::Identity(k, k);
  VectorX<double> D(k), y(k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const int cj = columns[static_cast<std::size_t>(j)];
    double pivot = gram_(cj, cj), moment = moment_[cj];
    for (Eigen::Index i = 0; i < j; ++i) {
      double entry = gram_(cj, columns[static_cast<std::size_t>(i)]);
      for (Eigen::Index l = 0; l < i; ++l) entry -= L(j, l) * D[l] * L(i, l);
      L(j, i) = D[i] > 0 ? entry / D[i] : 0;
      pivot -= L(j, i) * L(j, i) * D[i];
      moment -= L(j, i) * y[i];
    }
    D[j] = pivot > dependent * dependent ? pivot : 0;
    y[j] = D[j] > 0 ? moment : 0;
    if (D[j] > 0) out.rss -= moment * moment / D[j];
  }
  VectorX<double> beta = VectorX<double>::Zero(k);
  for (Eigen::Index j = k - 1; j >= 0; --j) {
    if (!(D[j] > 0)) continue;
    beta[j] = y[j] / D[j];
    for (Eigen::Index i = j + 1; i < k; ++i) beta[j] -= L(i, j) * beta[i];
  }
  MatrixX<double> inverse = L.triangularView<Eigen::UnitLower>().solve(MatrixX<double>::Identity(k, k));
  for (Eigen::Index j = 0; j < k; ++j) {
    const int c = columns[static_cast<std::size_t>(j)];
    if (!(D[j] > 0)) continue;
    double variance = 0;
    for (Eigen::Index i = j; i < k; ++i)
      if (D[i] > 0) variance += inverse(i, j) * inverse(i, j) / D[i];
    out.beta[c] = beta[j] / scale_[c];
    out.deviation[c] = std::sqrt(variance) / scale_[c];
  }
  out.rss = std::max(out.rss, 0.0);
  return out;
}

Fit Explanations::full() const {
  std::vector<int> all;
  for (std::size_t g = 0; g < groups_.size(); ++g) all.push_back(static_cast<int>(g));
  return fit(all);
}

VectorX<double> Explanations::rest(const Fit& fit) const { return regression_.d - regression_.X * fit.beta; }

std::vector<Fit> Explanations::search(const std::vector<int>& always, double price, double margin,
                                      const std::function<bool(const Fit&)>& sensible) const {
  std::vector<int> choice;
  for (int g = 0; g < static_cast<int>(groups_.size()); ++g) {
    const ColumnGroup& group = groups_[static_cast<std::size_t>(g)];
    const bool empty = scale_.segment(group.first, group.columns).maxCoeff() == 0;
    if (!empty && std::find(always.begin(), always.end(), g) == always.end()) choice.push_back(g);
  }
  const auto rated = [&](std::vector<int> groups) {
    std::sort(groups.begin(), groups.end());
    Fit out = fit(groups);
    out.score = out.rss;
    for (const int g : groups) out.score += price * groups_[static_cast<std::size_t>(g)].columns;
    return out;
  };
  std::vector<Fit> good{rated(always)};
  double best = good.front().score;
  const auto keep = [&](Fit fit) {
    if (fit.score > best + margin || (sensible && !sensible(fit))) return;
    best = std::min(best, fit.score);
    good.push_back(std::move(fit));
  };
  const auto extend = [&](const auto& self, std::vector<int>& set, std::size_t from, int left) -> void {
    if (left == 0) return;
    for (std::size_t i = from; i < choice.size(); ++i) {
      set.push_back(choice[i]);
      keep(rated(set));
      self(self, set, i + 1, left - 1);
      set.pop_back();
    }
  };
  std::vector<int> set = always;
  extend(extend, set, 0, exhaustive);
  const auto by_score = [](const Fit& a, const Fit& b) { return a.score < b.score; };
  // Larger sets: the best one grows while that pays.
  for (;;) {
    std::sort(good.begin(), good.end(), by_score);
    const Fit leader = good.front();
    for (const int g : choice)
      if (std::find(leader.groups.begin(), leader.groups.end(), g) == leader.groups.end()) {
        std::vector<int> larger = leader.groups;
        larger.push_back(g);
        if (larger.size() > always.size() + exhaustive) keep(rated(larger));
      }
    std::sort(good.begin(), good.end(), by_score);
    if (good.front().groups == leader.groups) break;
  }
  std::erase_if(good, [&](const Fit& fit) { return fit.score > best + margin; });
  return good;
}

}  // namespace osculate
