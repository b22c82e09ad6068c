// Error of the found poles.
//
// The differences. f'(x) = (45 (f1 - f-1) - 9 (f2 - f-2) + (f3 - f-3)) / (60 h) + h^6 f^(7) / 140, fk = f(x +
// k h). With f of size F that changes over a size L, and its values known to eps F, the two errors are
// (h/L)^6 F/(140 L) and 11/6 eps F/h; they balance at h near 2 eps^(1/7) L, and h = eps^(1/7) L is within a
// few of the best. The error left is eps^(6/7) F/L = 4e-14 F/L. L: 1 rad or the reach, divided by the
// condition of the Jacobian, which says how near the arm is to a singularity. Velocities take the same step
// times the natural frequency, and no more than eps^(1/7) v_s under friction that the law leaves. F is not
// known, so the error is measured: the differences are taken again with 3/4 of the step. Rounding then
// differs and is a third larger, and of the truncation 1 - (3/4)^6 = 0.82 shows. `difference_factor` covers
// the rest.
//
// The poles. In y = (w J dq, J dqd), w the natural frequency of each row, the designed matrix is C, one block
// [0 w; -K/w -D] for each row, and what the differences and the eigenvalue solver add is a matrix of norm f.
// (Null space: J* and a basis of the null space of J make the change of coordinates square; the task drives
// the null space, never the other way, so that it enters as F11 + F12 (s - Z)^-1 X.) If s is a pole of C plus
// such a matrix, the smallest singular value of s - C_r is <= f for one row r, hence
//   |s - s1| |s - s2| <= f |s - C_r|_F = delta      with the row's designed poles s1, s2.
// With the gap |s1 - s2| the nearer root is at most
//   2 delta / (gap + sqrt(gap^2 - 4 delta))   where gap^2 > 4 delta,   sqrt(delta) otherwise.
// Equal rows do no harm; a critically damped row costs the square root. Poles of different rows that are
// closer than their bounds may share them: `shared_factor` covers two such neighbours.
#include "verification/poles.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scalar/eps.hpp"
#include "verification/step_check.hpp"

namespace osculate {

namespace {

using Complex = std::complex<double>;
using Matrix = MatrixX<double>;

constexpr double difference_factor = 4;
constexpr double shared_factor = 2;
const double at_rest = std::sqrt(eps);  // of the sizes of error, velocity and acceleration

/// Size over which each joint's motion changes the arm: 1 rad or the reach, m.
VectorX<double> joint_sizes(const Chain<double>& chain) {
  VectorX<double> sizes(chain.n());
  for (int i = 0; i < chain.n(); ++i)
    sizes[i] = chain.links[static_cast<std::size_t>(i)].type == JointType::revolute ? 1.0 : reach(chain);
  return sizes;
}

/// Angular frequency, 1/s, that goes with a gain pair.
double natural(double stiffness, double damping) {
  return stiffness > 0 ? std::sqrt(stiffness) : damping > 0 ? damping : 1.0;
}

/// The highest of them among the law's task rows.
double highest_natural(const LawOptions& law) {
  double highest = 0;
  for (const int row : law.rows) highest = std::max(highest, natural(law.stiffness[row], law.damping[row]));
  return highest;
}

double power_of_two_near(double x) {
  return x > 0 && std::isfinite(x) ? std::exp2(std::round(std::log2(x))) : 1.0;
}

void require_one_axis_joints(const ClosedLoop& loop) {
  if (!loop.plant().chain.one_axis_joints())
    throw std::domain_error("poles: joints with more than one axis are not linearised");
}

/// Task rows of J, angular rows by 1 rad and linear rows by the reach, for joints by their sizes: no unit.
/// From the tip velocities of the plant at unit rates; V is linear in qd.
Matrix scaled_jacobian(ClosedLoop& loop, double t, std::span<const double> y) {
  const Chain<double>& chain = loop.plant().chain;
  const TaskRows& rows = loop.controller().options().rows;
  const VectorX<double> sizes = joint_sizes(chain);
  const int n = loop.velocities();
  std::vector<double> at(y.begin(), y.end()), yd(loop.states());
  const auto tip_velocity = [&](int moving) {
    for (int i = 0; i < n; ++i) at[static_cast<std::size_t>(n + i)] = i == moving ? sizes[i] : 0.0;
    loop.right_side(t, at.data(), yd.data());
    return loop.plant_tip_velocity();
  };
  const Vector6 of_base = tip_velocity(-1);
  Matrix J(static_cast<int>(rows.size()), n);
  for (int j = 0; j < n; ++j) {
    const Vector6 V = tip_velocity(j) - of_base;
    for (int i = 0; i < J.rows(); ++i) {
      const int row = rows[static_cast<std::size_t>(i)];
      J(i, j) = V[row] / (row < 3 ? 1.0 : reach(chain));
    }
  }
  return J;
}

/// J with an orthonormal basis of its null space below it: square. Gram-Schmidt with pivots, each projection
/// twice.
Matrix completed(const Matrix& J) {
  const auto m = J.rows(), n = J.cols();
  Matrix basis(n, n);  // rows: of J made orthonormal, then of the null space
  Matrix left = Matrix::Identity(n, n);
  Matrix T(n, n);
  T.topRows(m) = J;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Index pivot = 0;
    VectorX<double> v = i < m ? VectorX<double>(J.row(i).transpose()) : VectorX<double>();
    if (i >= m) {
      left.colwise().squaredNorm().maxCoeff(&pivot);
      v = left.col(pivot);
    }
    for (int twice = 0; twice < 2; ++twice)
      for (Eigen::Index k = 0; k < i; ++k) v -= basis.row(k).dot(v) * basis.row(k).transpose();
    basis.row(i) = v.normalized().transpose();
    if (i >= m) T.row(i) = basis.row(i);
    for (Eigen::Index k = 0; k < n; ++k)
      left.col(k) -= basis.row(i).dot(left.col(k)) * basis.row(i).transpose();
  }
  return T;
}

/// Speed below which friction that the law does not take away exactly changes its slope; infinite without
/// any.
double friction_speed(const ClosedLoop& loop) {
  double speed = std::numeric_limits<double>::infinity();
  if (loop.plant_is_model()) return speed;
  for (const auto* friction : {&loop.plant().friction, &loop.controller().friction()})
    for (const JointFriction& f : *friction)
      if (f.coulomb_positive > 0 || f.coulomb_negative > 0) speed = std::min(speed, f.v_s);
  return speed;
}

/// Step of each state. Powers of two, so that y + h is exact for all but the smallest y.
std::vector<double> steps(ClosedLoop& loop, double t, std::span<const double> y) {
  const Matrix T = completed(scaled_jacobian(loop, t, y));
  const double condition = T.norm() * T.inverse().norm() / static_cast<double>(T.rows());
  const VectorX<double> sizes = joint_sizes(loop.plant().chain);
  const double base = std::pow(eps, 1.0 / 7), rate = highest_natural(loop.controller().options());
  const auto n = static_cast<std::size_t>(loop.velocities());
  std::vector<double> h(2 * n);
  for (std::size_t i = 0; i < n; ++i) {
    const double size = sizes[static_cast<int>(i)];
    h[i] = power_of_two_near(base * size / condition);
    h[n + i] = power_of_two_near(base * std::min(size * rate, friction_speed(loop)));
  }
  return h;
}

Matrix differences(ClosedLoop& loop, double t, std::span<const double> y, const std::vector<double>& h) {
  const int size = static_cast<int>(h.size());
  std::vector<double> at(y.begin(), y.end()), yd(loop.states());
  Matrix A(size, size);
  const auto moved = [&](std::size_t j, double by) {
    at[j] = y[j] + by;
    loop.right_side(t, at.data(), yd.data());
    at[j] = y[j];
    return VectorX<double>(Eigen::Map<const VectorX<double>>(yd.data(), size));
  };
  for (std::size_t j = 0; j < h.size(); ++j) {
    const auto pair = [&](int k) { return VectorX<double>(moved(j, k * h[j]) - moved(j, -k * h[j])); };
    A.col(static_cast<int>(j)) = (45 * pair(1) - 9 * pair(2) + pair(3)) / (60 * h[j]);
  }
  return A;
}

/// Power of two that makes velocities (lower half) and positions of one size: A12 times it, A21 divided by
/// it. Not far below the damping, since the stiffness may be 0.
double balance(const Matrix& A) {
  const auto n = A.rows() / 2;
  return power_of_two_near(
      std::max(std::sqrt(A.bottomLeftCorner(n, n).norm()), 1e-3 * A.bottomRightCorner(n, n).norm()));
}

/// diag(upper, lower) on the two halves of a state, times a square matrix for each half.
Matrix both_halves(const Matrix& T, const VectorX<double>& upper, const VectorX<double>& lower) {
  const auto n = T.rows();
  Matrix out = Matrix::Zero(2 * n, 2 * n);
  out.topLeftCorner(n, n) = upper.asDiagonal() * T;
  out.bottomRightCorner(n, n) = lower.asDiagonal() * T;
  return out;
}

/// Throws where the loop at (t, y) is not in equilibrium; otherwise the largest of error, velocity and
/// acceleration relative to their sizes, which are the joints' sizes, 1 rad and the reach, and the highest
/// natural frequency.
double imbalance(ClosedLoop& loop, double t, std::span<const double> y) {
  const Chain<double>& chain = loop.plant().chain;
  const LawOptions& law = loop.controller().options();
  const VectorX<double> sizes = joint_sizes(chain);
  const double rate = highest_natural(law);
  const int n = loop.velocities();
  std::vector<double> yd(loop.states());
  loop.right_side(t, y.data(), yd.data());
  const PoseError error = loop.controller().last().error;
  double worst = 0, acceleration = 0;
  int joint = 0;
  const auto raise = [&worst](double by) {
    if (!(by <= worst) && !std::isnan(worst)) worst = by;  // not-a-number stays
  };
  for (int i = 0; i < n; ++i) {
    const double qd = y[static_cast<std::size_t>(n + i)], qdd = yd[static_cast<std::size_t>(n + i)];
    raise(std::abs(qd) / (sizes[i] * rate));
    raise(std::abs(qdd) / (sizes[i] * rate * rate));
    if (std::abs(qdd) > std::abs(acceleration)) acceleration = qdd, joint = i;
  }
  for (const int row : law.rows) {
    const double size = row < 3 ? 1.0 : reach(chain);
    raise(std::abs(error.e[row]) / size);
    raise(std::abs(error.ed[row]) / (size * rate));
  }
  if (!(worst <= at_rest))
    throw std::domain_error("poles: the loop is not in equilibrium at t = " + std::to_string(t) +
                            " s: error, velocity or acceleration is " + std::to_string(worst) +
                            " of its size; the largest acceleration is " + std::to_string(acceleration) +
                            " rad/s^2 or m/s^2, of joint " + std::to_string(joint + 1) +
                            " from the base. Start it at rest on a reference that rests.");
  return worst;
}

/// Largest distance from the nearer of two poles with |s - s1| |s - s2| <= delta.
double nearer_root(double gap, double delta) {
  const double rest = gap * gap - 4 * delta;
  return rest > 0 ? 2 * delta / (gap + std::sqrt(rest)) : std::sqrt(delta);
}

/// What disturbs the designed matrix, in its own coordinates, split into task and null space.
struct Disturbance {
  double task = 0, from_null = 0;  // norms of F11, F12
  Matrix X, Z;                     // null space driven by the task, and by itself

  /// Norm of F11 + F12 (s - Z)^-1 X, at most; infinite where s is a pole of the null space. The complex
  /// system is solved as a real one of twice the size.
  double at(Complex s) const {
    const auto k = Z.rows();
    if (k == 0) return task;
    Matrix resolvent(2 * k, 2 * k), right = Matrix::Zero(2 * k, X.cols());
    const Matrix one = Matrix::Identity(k, k);
    resolvent << s.real() * one - Z, -s.imag() * one, s.imag() * one, s.real() * one - Z;
    right.topRows(k) = X;
    const Matrix driven = resolvent.partialPivLu().solve(right);
    const double f = task + from_null * driven.norm();
    return std::isfinite(f) ? f : std::numeric_limits<double>::infinity();
  }
};

Disturbance disturbance(ClosedLoop& loop, double t, std::span<const double> y, const std::vector<double>& h,
                        const Matrix& A, double off_balance, const Vector6& stiffness,
                        const Vector6& damping) {
  const LawOptions& law = loop.controller().options();
  const int n = loop.velocities(), m = static_cast<int>(law.rows.size());
  std::vector<double> shorter = h;
  for (double& step : shorter) step *= 0.75;
  const Matrix error = A - differences(loop, t, y, shorter);

  const VectorX<double> one = VectorX<double>::Ones(n);
  VectorX<double> w = highest_natural(law) * one;
  for (int i = 0; i < m; ++i) {
    const int row = law.rows[static_cast<std::size_t>(i)];
    w[i] = natural(stiffness[row], damping[row]);
  }
  Matrix T = completed(scaled_jacobian(loop, t, y));
  const VectorX<double> sizes = joint_sizes(loop.plant().chain);
  for (int j = 0; j < n; ++j) T.col(j) /= sizes[j];
  const Matrix Y = both_halves(T, w, one), back = Y.inverse();

  // The eigenvalue solver: the poles of a matrix that differs by 2 n eps of its norm, in balanced
  // coordinates.
  const double s = balance(A);
  const Matrix by = both_halves(Matrix::Identity(n, n), s * one, one),
               off = both_halves(Matrix::Identity(n, n), one / s, one);
  const double condition = (Y * off).norm() * (by * back).norm();
  const double solver = 2 * n * eps * (by * A * off).norm() * condition;
  // Not quite in equilibrium: J changes by its own size along a joint's.
  const double rest = 2 * n * off_balance * highest_natural(law) * condition;

  std::vector<int> task, null;
  for (int i = 0; i < 2 * n; ++i) (i % n < m ? task : null).push_back(i);
  const Matrix F = difference_factor * (Y * error * back), G = Y * A * back;
  Disturbance out;
  out.task = F(task, task).norm() + solver + rest;
  out.from_null = F(task, null).norm() + solver + rest;
  out.X = G(null, task);
  out.Z = G(null, null);
  return out;
}

/// The assignment of a column of its own to every row whose largest cost is smallest. Rows <= columns.
std::vector<int> assignment(const Matrix& cost) {
  const auto rows = static_cast<std::size_t>(cost.rows()), columns = static_cast<std::size_t>(cost.cols());
  std::vector<int> owner(columns, -1);
  std::vector<char> seen(columns);
  const auto assign = [&](const auto& self, int row, double limit) -> bool {
    for (std::size_t j = 0; j < columns; ++j) {
      if (seen[j] || !(cost(row, static_cast<int>(j)) <= limit)) continue;
      seen[j] = 1;
      if (owner[j] >= 0 && !self(self, owner[j], limit)) continue;
      owner[j] = row;
      return true;
    }
    return false;
  };
  const auto possible = [&](double limit) {
    std::fill(owner.begin(), owner.end(), -1);
    for (std::size_t i = 0; i < rows; ++i) {
      std::fill(seen.begin(), seen.end(), 0);
      if (!assign(assign, static_cast<int>(i), limit)) return false;
    }
    return true;
  };
  std::vector<double> limits(cost.data(), cost.data() + cost.size());
  std::sort(limits.begin(), limits.end());
  const auto least =
      std::partition_point(limits.begin(), limits.end(), [&](double limit) { return !possible(limit); });
  if (least == limits.end() || !possible(*least))
    throw std::domain_error("poles: the poles found are not numbers");
  std::vector<int> out(rows);
  for (std::size_t j = 0; j < columns; ++j)
    if (owner[j] >= 0) out[static_cast<std::size_t>(owner[j])] = static_cast<int>(j);
  return out;
}

void require_continuous_tracking(const ClosedLoop& loop) {
  const LawOptions& law = loop.controller().options();
  if (law.law == Law::free) throw std::domain_error("poles: a free swing has no designed poles");
  if (law.sampling) throw std::domain_error("poles: the poles of a sampled law are not those of its gains");
  if (law.constant_command) throw std::domain_error("poles: a constant command has no designed poles");
  if (loop.controller().chart())
    throw std::domain_error("poles: designed poles are those of rotation vector and Cartesian position");
}

}  // namespace

MatrixX<double> linearised(ClosedLoop& loop, double t, std::span<const double> y) {
  require_one_axis_joints(loop);
  return differences(loop, t, y, steps(loop, t, y));
}

std::vector<Complex> poles(const MatrixX<double>& A) {
  const auto n = A.rows() / 2;
  Matrix balanced = A;
  if (A.rows() == 2 * n) {
    const double s = balance(A);
    balanced.topRightCorner(n, n) *= s;
    balanced.bottomLeftCorner(n, n) /= s;
  }
  const Eigen::EigenSolver<Matrix> solver(balanced, false);
  if (solver.info() != Eigen::Success) throw std::domain_error("poles: the eigenvalues were not found");
  const auto& values = solver.eigenvalues();
  std::vector<Complex> out(values.data(), values.data() + values.size());
  std::sort(out.begin(), out.end(), [](Complex a, Complex b) {
    return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
  });
  return out;
}

std::vector<Complex> designed_poles(std::span<const double> stiffness, std::span<const double> damping) {
  std::vector<Complex> out;
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    const double K = stiffness[i], alpha = damping[i] / 2;
    const double discriminant = std::fma(alpha, alpha, -K);
    const double root = std::sqrt(std::abs(discriminant));
    if (discriminant < 0) {
      out.insert(out.end(), {Complex(-alpha, -root), Complex(-alpha, root)});
      continue;
    }
    const double fast = alpha + root;
    out.insert(out.end(),
               {Complex(-fast), Complex(fast > 0 ? -K / fast : 0.0)});  // alpha - root would cancel
  }
  return out;
}

PoleCheck check_poles(ClosedLoop& loop, double t, std::span<const double> y) {
  const LawOptions& law = loop.controller().options();
  return check_poles(loop, t, y, law.stiffness, law.damping);
}

PoleCheck check_poles(ClosedLoop& loop, double t, std::span<const double> y, const Vector6& stiffness,
                      const Vector6& damping) {
  require_one_axis_joints(loop);
  require_continuous_tracking(loop);
  const double off_balance = imbalance(loop, t, y);
  const std::vector<double> h = steps(loop, t, y);
  const Matrix A = differences(loop, t, y, h);
  const Disturbance disturbed = disturbance(loop, t, y, h, A, off_balance, stiffness, damping);

  std::vector<double> K, D;
  for (const int row : loop.controller().options().rows)
    K.push_back(stiffness[row]), D.push_back(damping[row]);
  PoleCheck out;
  out.found = poles(A);
  out.designed = designed_poles(K, D);

  std::vector<double> bounds(out.designed.size());  // 1/s
  Matrix cost(static_cast<int>(out.designed.size()), static_cast<int>(out.found.size()));
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const std::size_t row = i / 2;
    const Complex s = out.designed[i];
    const double w = natural(K[row], D[row]), block = std::hypot(w, K[row] / w, D[row]);  // |C_r|_F
    const double gap = std::abs(s - out.designed[i ^ 1]);
    bounds[i] = shared_factor * nearer_root(gap, disturbed.at(s) * (std::sqrt(2.0) * std::abs(s) + block));
    for (std::size_t j = 0; j < out.found.size(); ++j)
      cost(static_cast<int>(i), static_cast<int>(j)) = std::abs(out.found[j] - s) / bounds[i];
  }
  const std::vector<int> own = assignment(cost);
  double nearest = -1;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const double ratio = cost(static_cast<int>(i), own[i]);
    if (ratio <= nearest) continue;
    nearest = ratio;
    const double pair = std::max(std::abs(out.designed[i]), std::abs(out.designed[i ^ 1]));
    const double size = std::abs(out.designed[i]) > 0 ? std::abs(out.designed[i]) : pair > 0 ? pair : 1.0;
    const Complex found = out.found[static_cast<std::size_t>(own[i])];
    out.at = i;
    out.worst = std::abs(found - out.designed[i]) / size;
    out.bound = bounds[i] / size;
  }
  return out;
}

}  // namespace osculate
