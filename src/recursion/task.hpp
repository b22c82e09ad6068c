// The one matrix that is factored: Omega(0), restricted to the controlled task rows, at most 6 x 6.
// F solves Omega F = u + rhs; Lambda, c and g come from the same factor.
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include "recursion/sweeps.hpp"

namespace osculate {

/// Rows of the six (wx wy wz vx vy vz) that the task controls, in order.
using TaskRows = std::vector<int>;
inline TaskRows all_rows() { return {0, 1, 2, 3, 4, 5}; }
/// All six in their own order: nothing has to be looked up.
inline bool are_all_rows(const TaskRows& rows) {
  static constexpr int order[] = {0, 1, 2, 3, 4, 5};
  return rows.size() == 6 && std::memcmp(rows.data(), order, sizeof order) == 0;
}

template <class Space, Field S>
constexpr const S& component(const Vec<Space, S>& v, int i) {
  const Vec3<S>& part = i < 3 ? v.ang : v.lin;
  return i % 3 == 0 ? part.x : i % 3 == 1 ? part.y : part.z;
}
template <class Space, Field S>
constexpr S& component(Vec<Space, S>& v, int i) {
  Vec3<S>& part = i < 3 ? v.ang : v.lin;
  return i % 3 == 0 ? part.x : i % 3 == 1 ? part.y : part.z;
}

template <Field S>
constexpr const S& component(const Vec3<S>& v, int i) {
  return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

/// Entry (i, j) of a symmetric map.
template <class To, Field S>
constexpr S component(const Symmetric<To, S>& a, int i, int j) {
  const auto row = [](const Mat3<S>& m, int r) -> const Vec3<S>& {
    return r == 0 ? m.x : r == 1 ? m.y : m.z;
  };
  if (i < 3 && j < 3) return entry(a.J, i, j);
  if (i >= 3 && j >= 3) return entry(a.A, i - 3, j - 3);
  return i < 3 ? component(row(a.B, i), j - 3) : component(row(a.B, j), i - 3);
}

/// Up to six numbers, one for each task row.
template <Field S>
using TaskVector = std::array<S, 6>;

template <Field S>
TaskVector<S> restricted(const Vec<Motion, S>& v, const TaskRows& rows) {
  if (are_all_rows(rows)) return {v.ang.x, v.ang.y, v.ang.z, v.lin.x, v.lin.y, v.lin.z};
  TaskVector<S> out{};
  for (std::size_t i = 0; i < rows.size(); ++i) out[i] = component(v, rows[i]);
  return out;
}

/// S^T F: the wrench with the given components on the task rows and none elsewhere.
template <Field S>
Vec<Force, S> wrench(const TaskVector<S>& F, const TaskRows& rows) {
  if (are_all_rows(rows)) return {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}};
  Vec<Force, S> f;
  for (std::size_t i = 0; i < rows.size(); ++i) component(f, rows[i]) = F[i];
  return f;
}

/// L D L^T of S Omega(0) S^T without pivoting: field operations only, no square root. Backward stable because
/// Omega is positive definite; a pivot that is not positive means that the arm has lost rank in these rows,
/// which the caller must look at (`pivots`), since a Field cannot compare.
template <Field S>
class TaskFactor {
 public:
  TaskFactor(const Compliance<S>& Omega, const TaskRows& rows) : m_(static_cast<int>(rows.size())) {
    if (are_all_rows(rows))
      factor([&](int i, int j) { return component(Omega, i, j); });
    else
      factor_chosen(Omega, rows);
  }

  int size() const { return m_; }
  /// Diagonal of D; entries from size() on are unused.
  const TaskVector<S>& pivots() const { return pivots_; }

  /// Omega^-1 right. Entries of `right` from size() on must be zero.
  TaskVector<S> solve(const TaskVector<S>& right) const {
    if (m_ == 6) return solved(right);
    const auto m = static_cast<std::size_t>(m_);
    TaskVector<S> padded{}, out{};
    for (std::size_t i = 0; i < m; ++i) padded[6 - m + i] = right[i];
    padded = solved(padded);
    for (std::size_t i = 0; i < m; ++i) out[i] = padded[6 - m + i];
    return out;
  }

 private:
  using Square = std::array<TaskVector<S>, 6>;

  TaskVector<S> solved(TaskVector<S> y) const {
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
      for (int p = 0; p < i; ++p) y[i] = y[i] - L_[i][p] * y[p];
#pragma GCC unroll 6
    for (int i = 0; i < 5; ++i) y[i] = y[i] * inverse_pivots_[i];
    y[5] = y[5] / last_pivot_;
#pragma GCC unroll 6
    for (int i = 5; i >= 0; --i)
#pragma GCC unroll 6
      for (int p = i + 1; p < 6; ++p) y[i] = y[i] - L_[p][i] * y[p];
    return y;
  }

  // Apart, so that the usual case stays small enough to be inlined.
  [[gnu::noinline]] void factor_chosen(const Compliance<S>& Omega, const TaskRows& rows) {
    const Square A = chosen(entries(Omega), rows);
    factor([&](int i, int j) { return A[i][j]; });
    const auto padding = static_cast<std::size_t>(6 - m_);
    for (std::size_t i = 0; i + padding < 6; ++i) pivots_[i] = pivots_[i + padding];
  }
  static Square entries(const Compliance<S>& Omega) {
    Square out;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
      for (int j = 0; j < 6; ++j) out[i][j] = component(Omega, i, j);
    return out;
  }

  /// The given rows and columns, after as many of the unit matrix as are missing: every loop has a fixed
  /// length, and the last row given is the last of all.
  static Square chosen(const Square& all, const TaskRows& rows) {
    Square A{};
    const std::size_t padding = 6 - rows.size();
    for (std::size_t i = 0; i < padding; ++i) A[i][i] = S(1);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j) A[padding + i][padding + j] = all[rows[i]][rows[j]];
    return A;
  }

  /// A(i, j) for i >= j.
  template <class Entries>
  void factor(const Entries& A) {
    Square scaled;  // scaled[j][i] = L(i,j) d(j)
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) {
#pragma GCC unroll 6
      for (int i = j; i < 6; ++i) {
        S t = A(i, j);
#pragma GCC unroll 6
        for (int p = 0; p < j; ++p) t = t - scaled[p][i] * L_[j][p];
        scaled[j][i] = t;
      }
      pivots_[j] = scaled[j][j];
      if (j == 5) break;  // the last pivot divides nothing here: it may be zero
      inverse_pivots_[j] = S(1) / pivots_[j];
#pragma GCC unroll 6
      for (int i = j + 1; i < 6; ++i) L_[i][j] = scaled[j][i] * inverse_pivots_[j];
    }
    last_pivot_ = pivots_[5];
  }

  int m_;
  Square L_;  // unit lower triangular: the strictly lower part
  TaskVector<S> pivots_, inverse_pivots_;
  S last_pivot_;
};

}  // namespace osculate
