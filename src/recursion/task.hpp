// The one matrix that is factored: Omega(0), restricted to the controlled task rows, at most 6 x 6.
// F solves Omega F = u + rhs; Lambda, c and g come from the same factor.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "recursion/sweeps.hpp"

namespace osculate {

/// Rows of the six (wx wy wz vx vy vz) that the task controls, in order.
using TaskRows = std::vector<int>;
/// All six in their own order.
inline TaskRows all_rows() { return {0, 1, 2, 3, 4, 5}; }
/// All six in their own order: nothing has to be looked up.
inline bool are_all_rows(std::span<const int> rows) {
  static constexpr int order[] = {0, 1, 2, 3, 4, 5};
  return rows.size() == 6 && std::memcmp(rows.data(), order, sizeof order) == 0;
}

/// Entry i of the six, angular part first.
template <class Space, Field S>
constexpr const S& component(const Vec<Space, S>& v, int i) {
  const Vec3<S>& part = i < 3 ? v.ang : v.lin;
  return i % 3 == 0 ? part.x : i % 3 == 1 ? part.y : part.z;
}
/// Writes entry i of the six.
template <class Space, Field S>
constexpr void set_component(Vec<Space, S>& v, int i, const S& value) {
  Vec3<S>& part = i < 3 ? v.ang : v.lin;
  part = {i % 3 == 0 ? value : part.x, i % 3 == 1 ? value : part.y, i % 3 == 2 ? value : part.z};
}

/// Entry i of three.
template <Field S>
constexpr const S& component(const Vec3<S>& v, int i) {
  return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

/// Entry (i, j) of a symmetric map.
template <class To, Field S>
constexpr S component(const Symmetric<To, S>& a, int i, int j) {
  if (i < 3 && j < 3) return entry(a.J, i, j);
  if (i >= 3 && j >= 3) return entry(a.A, i - 3, j - 3);
  return i < 3 ? entry(a.B, i, j - 3) : entry(a.B, j, i - 3);
}

/// Up to six numbers, one for each task row.
template <Field S>
using TaskVector = std::array<S, 6>;

/// The chosen rows of v.
template <Field S>
TaskVector<S> restricted(const Vec<Motion, S>& v, std::span<const int> rows) {
  if (are_all_rows(rows)) return {v.ang.x, v.ang.y, v.ang.z, v.lin.x, v.lin.y, v.lin.z};
  TaskVector<S> out{};
  for (std::size_t i = 0; i < rows.size(); ++i) out[i] = component(v, rows[i]);
  return out;
}

/// S^T F: the wrench with the given components on the task rows and none elsewhere.
template <Field S>
Vec<Force, S> wrench(const TaskVector<S>& F, std::span<const int> rows) {
  if (are_all_rows(rows)) return {{F[0], F[1], F[2]}, {F[3], F[4], F[5]}};
  Vec<Force, S> f;
  for (std::size_t i = 0; i < rows.size(); ++i) set_component(f, rows[i], F[i]);
  return f;
}

/// A = L D L^T of a symmetric 3 x 3 block, L unit lower triangular. The last pivot divides nothing here: it
/// may be zero.
template <Field S>
struct BlockFactor {
  S yx, zx, zy;  // L below its diagonal
  S dx, dy, dz;  // D
  S ix, iy;      // 1 / dx, 1 / dy
  BlockFactor() = default;
  /// Factors A; nothing is compared.
  constexpr explicit BlockFactor(const Sym3<S>& A)
      : dx(entry(A, 0, 0)), dy(entry(A, 1, 1)), dz(entry(A, 2, 2)) {
    const S x = entry(A, 0, 1), y = entry(A, 0, 2);
    ix = S(1) / dx;
    yx = x * ix;
    zx = y * ix;
    dy = dy - x * yx;
    const S z = entry(A, 1, 2) - y * yx;
    iy = S(1) / dy;
    zy = z * iy;
    dz = dz - y * zx - z * zy;
  }
  /// L^-1 rows
  template <class T>
  constexpr void forward(const T& x, T& y, T& z) const {
    y = y - x * yx;
    z = z - x * zx - y * zy;
  }
  /// L^-T rows
  template <class T>
  constexpr void backward(T& x, T& y, const T& z) const {
    y = y - z * zy;
    x = x - y * yx - z * zx;
  }
};

/// L D L^T of S Omega(0) S^T without pivoting: field operations only, no square root. Backward stable because
/// Omega is positive definite; a pivot that is not positive means that the arm has lost rank in these rows,
/// which the caller must look at (`pivots`), since a Field cannot compare. In blocks of three rows:
///   | J   B |   | L1    |  | D1    |  | L1*  C |
///   | B*  A | = | C* L2 |  |    D2 |  |    L2* |
/// Fewer than six rows stand after as many of the unit matrix as are missing: the last row given is the last
/// of all.
template <Field S>
class TaskFactor {
 public:
  /// Factors the chosen rows and columns of Omega.
  OSCULATE_INLINE TaskFactor(const Compliance<S>& Omega, std::span<const int> rows)
      : m_(static_cast<int>(rows.size())) {
    if (are_all_rows(rows))
      factor(Omega);
    else
      factor_chosen(Omega, rows);
  }

  /// Number of task rows.
  int size() const { return m_; }
  /// Diagonal of D; entries from size() on are unused.
  TaskVector<S> pivots() const {
    const TaskVector<S> all = {upper_.dx, upper_.dy, upper_.dz, lower_.dx, lower_.dy, lower_.dz};
    return m_ == 6 ? all : moved_to_start(all);
  }

  /// The wrench F on the task rows, none elsewhere, with S Omega F = S right.
  Vec<Force, S> solve(const Vec<Motion, S>& right) const {
    return m_ == 6 ? solved(right) : solved_chosen(right);
  }
  /// Omega^-1 right. Entries of `right` from size() on must be zero.
  TaskVector<S> solve(const TaskVector<S>& right) const {
    const auto solved_list = [this](const TaskVector<S>& x) {
      const auto [f, l] = solved({{x[0], x[1], x[2]}, {x[3], x[4], x[5]}});
      return TaskVector<S>{f.x, f.y, f.z, l.x, l.y, l.z};
    };
    return m_ == 6 ? solved_list(right) : moved_to_start(solved_list(moved_to_end(right)));
  }

  /// trace(W Omega^-1 W) for the squares w^2 of the diagonal of W: (L^-1 W)* D^-1 (L^-1 W), a sum of squares
  /// over pivots. Entries from size() on must be zero. About 90 operations.
  S inverse_trace(const TaskVector<S>& w2) const {
    const auto [a, b, c, d, e, f] = m_ == 6 ? w2 : moved_to_end(w2);
    const Vec3<S> w{a, b, c};
    const S yx = -upper_.yx, zy = -upper_.zy, zx = upper_.yx * upper_.zy - upper_.zx;  // of L1^-1
    const S in_upper = a * upper_.ix + (a * yx * yx + b) * upper_.iy + (a * zx * zx + b * zy * zy + c) * iz_;
    // rows of C* L1^-1, then of L2^-1 C* L1^-1
    Vec3<S> x = Cx_, y = Cy_;
    upper_.backward(x, y, Cz_);
    auto [X, Y, Z] = rows_of(transpose(Mat3<S>{x, y, Cz_}));
    lower_.forward(X, Y, Z);
    const S yx2 = -lower_.yx, zy2 = -lower_.zy, zx2 = lower_.yx * lower_.zy - lower_.zx;  // of L2^-1
    const auto squares = [&w](const Vec3<S>& v) {
      return w.x * v.x * v.x + w.y * v.y * v.y + w.z * v.z * v.z;
    };
    return in_upper + (squares(X) + d) * lower_.ix + (squares(Y) + d * yx2 * yx2 + e) * lower_.iy +
           (squares(Z) + d * zx2 * zx2 + e * zy2 * zy2 + f) / lower_.dz;
  }

 private:
  using Square = std::array<TaskVector<S>, 6>;

  constexpr Vec<Force, S> solved(const Vec<Motion, S>& right) const {
    S a = right.ang.x, b = right.ang.y, c = right.ang.z;
    upper_.forward(a, b, c);
    const Vec3<S> below = right.lin - (Cx_ * a + Cy_ * b + Cz_ * c);
    S d = below.x, e = below.y, f = below.z;
    lower_.forward(d, e, f);
    d = d * lower_.ix, e = e * lower_.iy, f = f / lower_.dz;
    lower_.backward(d, e, f);
    const Vec3<S> linear{d, e, f};
    a = a * upper_.ix - dot(Cx_, linear);
    b = b * upper_.iy - dot(Cy_, linear);
    c = c * iz_ - dot(Cz_, linear);
    upper_.backward(a, b, c);
    return {{a, b, c}, linear};
  }

  // These two apart, so that the usual case stays small enough to be inlined.
  [[gnu::noinline]] Vec<Force, S> solved_chosen(const Vec<Motion, S>& right) const {
    return wrench(solve(restricted(right, rows())), rows());
  }
  [[gnu::noinline]] void factor_chosen(const Compliance<S>& Omega, std::span<const int> rows) {
    std::copy(rows.begin(), rows.end(), rows_.begin());
    Square A{};
    const std::size_t padding = 6 - rows.size();
    for (std::size_t i = 0; i < padding; ++i) A[i][i] = S(1);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j)
        A[padding + i][padding + j] = A[padding + j][padding + i] = component(Omega, rows[i], rows[j]);
    const auto block = [&A](std::size_t i, std::size_t j) {
      const auto row = [&](std::size_t r) { return Vec3<S>{A[i + r][j], A[i + r][j + 1], A[i + r][j + 2]}; };
      return Mat3<S>{row(0), row(1), row(2)};
    };
    factor({upper(block(0, 0)), block(0, 3), upper(block(3, 3))});
  }

  OSCULATE_INLINE void factor(const Compliance<S>& Omega) {
    const auto& [J, B, A] = Omega;
    upper_ = BlockFactor<S>(J);
    iz_ = S(1) / upper_.dz;
    auto [x, y, z] = rows_of(B);
    upper_.forward(x, y, z);
    Cx_ = x * upper_.ix, Cy_ = y * upper_.iy, Cz_ = z * iz_;
    lower_ = BlockFactor<S>(less_outers(A - symmetric_outer(x, Cx_), y, Cy_, z, Cz_));
  }

  TaskVector<S> moved_to_end(const TaskVector<S>& x) const {
    TaskVector<S> out{};
    for (int i = 0; i < m_; ++i) out[6 - m_ + i] = x[i];
    return out;
  }
  TaskVector<S> moved_to_start(const TaskVector<S>& x) const {
    TaskVector<S> out{};
    for (int i = 0; i < m_; ++i) out[i] = x[6 - m_ + i];
    return out;
  }

  std::span<const int> rows() const { return {rows_.data(), static_cast<std::size_t>(m_)}; }

  int m_;
  std::array<int, 6> rows_;  // set where they are not all six in order
  BlockFactor<S> upper_, lower_;
  S iz_;                  // 1 / upper_.dz
  Vec3<S> Cx_, Cy_, Cz_;  // rows of D1^-1 L1^-1 B
};

}  // namespace osculate
