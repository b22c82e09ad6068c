#include "verification/claims.hpp"

#include <cmath>
#include <limits>

#include "model/pose.hpp"
#include "scalar/eps.hpp"
#include "verification/bounds.hpp"

namespace osculate {

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// difference / scale, where a zero scale demands a zero difference.
double ratio(double difference, double scale) {
  if (scale > 0) return difference / scale;
  return difference == 0 ? 0 : std::numeric_limits<double>::infinity();
}

/// max |x - y| w / max scale w, with the weights w of the rows.
double weighted(const Vector6& x, const Vector6& y, const Vector6& scale, const Vector6& weights) {
  return ratio((x - y).cwiseAbs().cwiseProduct(weights).maxCoeff<Eigen::PropagateNaN>(),
               scale.cwiseProduct(weights).maxCoeff());
}

/// The larger one; not-a-number if one of them is.
double largest(double x, double y) { return x >= y ? x : y > x ? y : x + y; }

/// Task quantities on all six rows: 0 on those that the task does not control.
template <int most>
Vector6 spatial(const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>& x, const TaskRows& rows) {
  if (are_all_rows(rows)) return Eigen::Map<const Vector6>(x.data());
  Vector6 out = Vector6::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) out[rows[i]] = x[static_cast<Eigen::Index>(i)];
  return out;
}
template <int most>
Matrix6 spatial(const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>& A,
                const TaskRows& rows) {
  if (are_all_rows(rows)) return Eigen::Map<const Matrix6>(A.data());
  Matrix6 out = Matrix6::Zero();
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i)
      out(rows[i], rows[j]) = A(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return out;
}
/// x on the rows that the task controls, 0 on the others.
Vector6 controlled(const Vector6& x, const TaskRows& rows) {
  if (are_all_rows(rows)) return x;
  Vector6 out = Vector6::Zero();
  for (const int row : rows) out[row] = x[row];
  return out;
}

/// |A| |x|, column by column.
Vector6 sizes_of_product(const dense::Jacobian<double>& A, const Vector& x) {
  Vector6 sum = Vector6::Zero();
  for (Eigen::Index k = 0; k < A.cols(); ++k) sum += A.col(k).cwiseAbs() * std::abs(x[k]);
  return sum;
}
Vector6 product(const dense::Jacobian<double>& A, const Vector& x) {
  Vector6 sum = Vector6::Zero();
  for (Eigen::Index k = 0; k < A.cols(); ++k) sum += A.col(k) * x[k];
  return sum;
}

/// For each task row the root of the largest diagonal entry of Omega among the rows of its kind, angular or
/// linear; 0 for rows that the task does not control. A scale that knows neither how the base frame is turned
/// nor the units; rounding in Omega is relative to it.
Vector6 block_weights(const Matrix6& Omega, const TaskRows& rows) {
  double largest[2] = {0, 0};
  for (const int row : rows) largest[row / 3] = std::max(largest[row / 3], Omega(row, row));
  Vector6 out = Vector6::Zero();
  for (const int row : rows) out[row] = std::sqrt(largest[row / 3]);
  return out;
}

/// How much larger than Omega the numbers are that Omega is the outcome of. Rounding in Omega is eps times
/// this, relative to the weights d of its rows. The largest of
///  - the mobility of every inner link over that of the tip. A light link inboard of a heavy tip yields more
///    than the tip does, and sweep 3 subtracts the difference. Its turning counts with the whole lever from
///    the link's origin to the tip, because the sweep goes that way in steps which may cancel;
///  - sum_i (J M^-1)(r,i)^2 M(i,i): what a relative error of eps in the entries of M does to row r of (11).
/// Both are 1 to 10 for most arms, and grow like the mass of a heavy tip over that of the arm.
double spread(const Evidence& e, const Matrix& Minv, const Vector6& d) {
  const dense::Jacobian<double>& J = e.model.tip.J;
  Vector6 inner = Vector6::Zero(), of_M = inner;
  double angular = 0, linear = 0;  // of the inner links, at the tip
  for (Eigen::Index i = 0; i < J.cols(); ++i) {
    // inner = diagonal of J M^-1 J*, both cut off after column i
    Vector6 sum = J.col(i) * (Minv(i, i) / 2);
    for (Eigen::Index k = 0; k < i; ++k) sum += J.col(k) * Minv(k, i);
    inner += 2 * J.col(i).cwiseProduct(sum);
    of_M += e.J_Minv.col(i).cwiseAbs2() * e.model.joint.M(i, i);
    const double turning = inner.head<3>().maxCoeff(), lever = e.levers[i];
    angular = std::max(angular, turning);
    linear = std::max(linear, inner.tail<3>().maxCoeff() + turning * lever * lever);
  }
  double out = 1;
  for (const int row : e.rows)
    out = std::max(out, std::max(row < 3 ? angular : linear, of_M[row]) / (d[row] * d[row]));
  return out;
}

Residual bounded(Claim claim, double value, double condition) {
  const double bound = measured_bounds[index(claim)].constant * eps * condition;
  return {value, bound, true};
}

Residual not_applicable() { return {0, 0, false}; }

/// Scales of the dense side's sums, on the task rows; 0 on the others.
struct Scales {
  Matrix6 Lambda;   // |Lambda|
  Vector6 c, g, u;  // right sides before the solve
  explicit Scales(const Evidence& e) {
    Lambda = spatial(e.terms.Lambda, e.rows).cwiseAbs();
    c = spatial(e.task.J_Minv_C, e.rows).cwiseAbs() + spatial(e.task.Jdot_qd, e.rows).cwiseAbs();
    g = spatial(e.task.J_Minv_G, e.rows).cwiseAbs();
    const double gravity = e.gravity.norm();
    for (const int row : e.rows)
      if (row >= 3) g[row] += gravity;
    u = spatial(e.u, e.rows).cwiseAbs();
  }
};

/// The largest |eigenvalue| of the symmetric n x n matrix A, or up to n^(1/8) times as much: the eighth root
/// of the sum of their eighth powers, which is the trace of A^8.
template <class Square>
double largest_eigenvalue(const Square& A) {
  const Square A2 = A * A;
  const Square A4 = A2 * A2;
  return std::sqrt(std::sqrt(std::sqrt(A4.squaredNorm())));
}
/// Condition number of A in the 2-norm, or up to n^(1/4) times as much (1.6 at n = 6); infinite where a pivot
/// of A is not positive.
template <class Square>
double condition(const Square& A, const Square& A_inv, const dense::Ldlt<double>& factor) {
  if (!(factor.D.minCoeff() > 0)) return std::numeric_limits<double>::infinity();
  return largest_eigenvalue(A) * largest_eigenvalue(A_inv);
}

/// Sizes of the motions that joint rates (or accelerations) x and the motion `base` of the base add up to at
/// the tip: angular, and linear with every lever as long as the reach, because the sum goes through the
/// joints in between.
std::pair<double, double> sizes(const Evidence& e, const Vector& x, const Vector6& base) {
  const Vector6 sum = sizes_of_product(e.plant.tip.J, x) + base.cwiseAbs();
  const double angular = sum.head<3>().maxCoeff();
  return {angular, sum.tail<3>().maxCoeff() + angular * e.reach};
}

Residual kinematics(const Evidence& e) {
  const auto& tip = e.plant.tip;
  const auto [spin, pace] = sizes(e, e.qd, e.base.velocity);
  const auto [turn, push] = sizes(e, e.qdd, e.base.acceleration);
  double worst = ratio((e.tip.R - tip.R).cwiseAbs().maxCoeff(), 1.0);
  worst = largest(worst, ratio((e.tip.p - tip.p).cwiseAbs().maxCoeff(), e.reach));
  for (const Vector6* V : {&e.tip_velocity, &e.pose_rate}) {
    const Vector6 off = (*V - tip.tip_velocity).cwiseAbs();
    worst = largest(worst, ratio(off.head<3>().maxCoeff(), spin));
    worst = largest(worst, ratio(off.tail<3>().maxCoeff(), pace));
  }
  const Vector6 off = (e.tip_acceleration - (product(tip.J, e.qdd) + tip.Jdot_qd)).cwiseAbs();
  worst = largest(worst, ratio(off.head<3>().maxCoeff(), turn + spin * spin));
  worst = largest(worst, ratio(off.tail<3>().maxCoeff(), push + spin * pace + e.gravity.norm()));
  return bounded(Claim::kinematics, worst, 1);
}

/// The plant's accelerations against M^-1 (T - C - G + J* F_ext). joints: how many, or Eigen::Dynamic.
template <int joints>
Residual forward_dynamics(const Evidence& e) {
  using Column = Eigen::Matrix<double, joints, 1>;
  using Square = Eigen::Matrix<double, joints, joints>;
  const auto& [tip, joint] = e.plant;
  const Eigen::Index n = joint.C.size();
  const Eigen::Map<const Square> M(joint.M.data(), n, n), Minv(e.plant_Minv.data(), n, n);
  Column right(n), sizes(n);
  const Vector6 push = e.tip_force.cwiseAbs();
  for (Eigen::Index k = 0; k < n; ++k) {
    right[k] = e.net_torque[k] - joint.C[k] - joint.G[k] + tip.J.col(k).dot(e.tip_force);
    sizes[k] = std::abs(e.net_torque[k]) + std::abs(joint.C[k]) + std::abs(joint.G[k]) +
               tip.J.col(k).cwiseAbs().dot(push);
  }
  dense::solve_in_place(e.plant_M, right.data());
  const Column& qdd = right;
  const Column s = M.diagonal().cwiseSqrt(), s_inv = s.cwiseInverse();
  double off = 0, scale = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    double size = 0;
    for (Eigen::Index i = 0; i < n; ++i) size += std::abs(Minv(i, k)) * sizes[i];
    off = largest(off, std::abs(e.qdd[k] - qdd[k]) * s[k]);
    scale = largest(scale, size * s[k]);
  }
  // of M scaled to unit diagonal
  const double scaled_condition = condition<Square>(s_inv.asDiagonal() * M * s_inv.asDiagonal(),
                                                    s.asDiagonal() * Minv * s.asDiagonal(), e.plant_M);
  return bounded(Claim::forward_dynamics, ratio(off, scale), scaled_condition);
}

/// Second derivatives of the tip's coordinates: those commanded, those reached and those that the tracking
/// law makes due; orientation and position apart. Errors of the tip's acceleration pass through Pi^-1, those
/// of its pose through the derivative of Pi^-1: near a singular pose 1/sigma and 1/sigma^2.
Residual coordinates(const Evidence& e, const Vector6& reach_scale, double spread_of_Omega) {
  const ChartEvidence& chart = *e.chart;
  const double sigma = std::min(1.0, chart.smallest_singular_value);
  double worst = 0;
  const auto judge = [&](int first, int count, int block) {
    if (count == 0) return;
    double push = 0;
    for (const int row : e.rows)
      if (row / 3 == block) push = std::max(push, reach_scale[row]);
    const double speed = chart.yd.segment(first, count).cwiseAbs().maxCoeff();
    const double scale = (push + speed * speed) / (sigma * sigma);
    const double missed = (chart.ydd - chart.v).segment(first, count).cwiseAbs().maxCoeff();
    worst = std::max(worst, ratio(missed, scale));
    // v itself: its terms grow from the poses as those of ydd do
    const double due = chart.due.segment(first, count).cwiseAbs().maxCoeff();
    const double off = (chart.due - chart.v).segment(first, count).cwiseAbs().maxCoeff();
    worst = std::max(worst, ratio(off, scale + due));
  };
  const int size = static_cast<int>(chart.v.size());
  judge(0, chart.turning, 0);
  judge(chart.turning, size - chart.turning, 1);
  return bounded(Claim::coordinates, worst, spread_of_Omega);
}

}  // namespace

void fill_dense_side(Evidence& e, const Chain<double>& model, const Chain<double>& plant,
                     std::span<const double> q, bool full_rank) {
  set_positions(model, q, e.joints);
  e.gravity = plant.gravity;
  e.equal_arms = &plant == &model || plant == model;
  if (!e.equal_arms) {
    dense::state(model, e.joints, e.qd, e.base, e.moving, e.model);
    dense::factor(e.model.joint.M, e.model_M);
    dense::inverse(e.model_M, e.model_Minv);
  }
  dense::state(plant, e.joints, e.qd, e.base, e.moving, e.plant);
  dense::factor(e.plant.joint.M, e.plant_M);
  dense::inverse(e.plant_M, e.plant_Minv);
  if (e.equal_arms) {  // the dense side's own work, shared with itself
    e.model = e.plant;
    e.model_M = e.plant_M;
  }
  dense::mobility(e.model.tip, e.model.joint, e.model_M, e.rows, e.J_Minv, e.task);
  if (full_rank) {
    dense::factor(e.task.Omega, e.Omega);
    dense::task_terms(e.task, e.Omega, e.terms);
  } else {
    e.terms = {};
  }

  const auto& [R, Rd] = e.moving.R_tip;
  const Matrix3<double> spin = Rd * R.transpose();  // omega~
  e.pose_rate << (spin(2, 1) - spin(1, 2)) / 2, (spin(0, 2) - spin(2, 0)) / 2, (spin(1, 0) - spin(0, 1)) / 2,
      e.moving.tip.rate;
  e.levers.resize(e.qd.size());
  for (const auto& link : e.moving.links)
    for (int c = link.first; c < link.first + link.columns; ++c)
      e.levers[c] = (e.moving.tip.value - link.origin.value).norm();
}

double force_residual(const Evidence& e) {
  const Scales scale(e);
  const Vector6 F = spatial(Vector(e.terms.Lambda * e.u + e.terms.c + e.terms.g), e.rows);
  return weighted(spatial(e.F, e.rows), F - controlled(e.known_tip_force, e.rows),
                  scale.Lambda * (scale.u + scale.c + scale.g),
                  block_weights(spatial(e.task.Omega, e.rows), e.rows));
}

Residuals assess(const Evidence& e) {
  Residuals out;
  out.fill(not_applicable());
  const auto at = [&out](Claim claim) -> Residual& { return out[index(claim)]; };
  at(Claim::kinematics) = kinematics(e);
  at(Claim::forward_dynamics) =
      e.qdd.size() == 6 ? forward_dynamics<6>(e) : forward_dynamics<Eigen::Dynamic>(e);

  // the task: Omega, then everything that its inverse multiplies
  const Matrix6 Omega = spatial(e.task.Omega, e.rows);
  const Vector6 d = block_weights(Omega, e.rows);
  Vector6 d_inv = Vector6::Zero();
  for (const int row : e.rows) {
    if (!(d[row] > 0)) return out;
    d_inv[row] = 1 / d[row];
  }
  const Matrix& Minv = e.equal_arms ? e.plant_Minv : e.model_Minv;
  const double spread_of_Omega = spread(e, Minv, d);
  const Matrix6 dd = d * d.transpose();
  if (e.recursive.Omega.size() > 0) {
    const Matrix6 off = (e.recursive.Omega - Omega).cwiseAbs().cwiseProduct(d_inv * d_inv.transpose());
    at(Claim::omega) = bounded(Claim::omega, off.maxCoeff(), spread_of_Omega);
  }

  if (e.terms.Lambda.size() == 0) return out;
  const Matrix6 Lambda = spatial(e.terms.Lambda, e.rows);
  const double condition_alone =
      condition<Matrix6>(Omega.cwiseProduct(d_inv * d_inv.transpose()), Lambda.cwiseProduct(dd), e.Omega);
  const double condition = condition_alone * spread_of_Omega;
  const Scales scale(e);
  const Vector6 c = spatial(e.terms.c, e.rows), g = spatial(e.terms.g, e.rows);
  if (e.recursive.Lambda.size() > 0) {
    const RecursiveTerms& r = e.recursive;
    at(Claim::lambda) =
        bounded(Claim::lambda,
                ratio((spatial(r.Lambda, e.rows) - Lambda).cwiseAbs().cwiseProduct(dd).maxCoeff(),
                      scale.Lambda.cwiseProduct(dd).maxCoeff()),
                condition);
    const Vector6 c_scale = scale.Lambda * scale.c, g_scale = scale.Lambda * scale.g;
    at(Claim::c) = bounded(Claim::c, weighted(spatial(r.c, e.rows), c, c_scale, d), condition);
    at(Claim::g) = bounded(Claim::g, weighted(spatial(r.g, e.rows), g, g_scale, d), condition);
    at(Claim::c_plus_g) = bounded(
        Claim::c_plus_g, weighted(spatial(r.c_plus_g, e.rows), c + g, c_scale + g_scale, d), condition);
    for (const Claim claim : {Claim::lambda, Claim::c, Claim::g, Claim::c_plus_g})
      if (e.filtered && !(at(claim).bound <= undecided_bound)) at(claim) = not_applicable();
  }
  if (!e.controlled && !e.linearized) return out;

  // torque (16), with the null-space torque T0 projected: T = T0 + J* Lambda (u + right side - J M^-1 T0)
  const auto& [tip, model] = e.model;
  const bool pushed_aside = e.T0.cwiseAbs().maxCoeff() > 0;
  const Vector6 known = controlled(e.known_tip_force, e.rows), u = spatial(e.u, e.rows);
  Vector6 t = Vector6::Zero(), t_scale = t;  // J M^-1 T0
  if (pushed_aside) {
    t = controlled(product(e.J_Minv, e.T0), e.rows);
    t_scale = controlled(sizes_of_product(tip.J, Minv.cwiseAbs() * e.T0.cwiseAbs()), e.rows);
  }
  const Vector6 F = Lambda * (u - t) + c + g - known;
  const Vector6 right = scale.u + scale.c + scale.g + t_scale;
  const Vector6 F_scale = scale.Lambda * right + known.cwiseAbs();
  const auto T_scale = [&](Eigen::Index k) {
    return std::abs(e.T0[k]) + tip.J.col(k).cwiseAbs().dot(F_scale);
  };
  double off = 0, largest_T = 0;
  for (Eigen::Index k = 0; k < e.T0.size(); ++k) {
    const double weight = 1 / std::sqrt(model.M(k, k));
    const double T = e.delayed_torque.size() > 0 ? e.delayed_torque[k] : e.T0[k] + tip.J.col(k).dot(F);
    off = largest(off, std::abs(e.T[k] - T) * weight);
    largest_T = largest(largest_T, T_scale(k) * weight);
  }
  const Residual torque = bounded(Claim::torque, ratio(off, largest_T), condition);
  if (e.controlled) at(Claim::torque) = torque;

  // What the torque adds to J* (Lambda u + c + g) must not move the tip: J M^-1 (T - J* F) = 0
  if (e.controlled && pushed_aside && e.delayed_torque.size() == 0) {
    const Vector6 task_force = Lambda * u + c + g - known;
    const Vector6 rest = controlled(product(e.J_Minv, e.T - tip.J.transpose() * task_force), e.rows);
    const Vector sizes =
        Vector::NullaryExpr(e.T0.size(), [&](Eigen::Index k) { return std::abs(e.T0[k]) + T_scale(k); });
    const Vector6 rest_scale = controlled(sizes_of_product(tip.J, Minv.cwiseAbs() * sizes), e.rows);
    at(Claim::null_space) =
        bounded(Claim::null_space, weighted(rest, Vector6::Zero(), rest_scale, d_inv), condition_alone);
  }

  // tip acceleration of the plant = u, and in coordinates ydd = v
  if (!e.linearized) return out;
  const Vector6 reach_scale =
      d * d.dot(F.cwiseAbs()) + right;  // rounding in Omega(i,j) is relative to d_i d_j
  // Where the condition of Omega leaves no digit of F, (5) says nothing: undecided, as the torque is.
  if (!(torque.bound <= undecided_bound)) {
    at(Claim::linearization) = {0, torque.bound, true};
    return out;
  }
  at(Claim::linearization) =
      bounded(Claim::linearization, weighted(e.tip_acceleration, u, reach_scale, d_inv),
              e.one_solve ? spread_of_Omega : condition);
  if (e.chart) at(Claim::coordinates) = coordinates(e, reach_scale, spread_of_Omega);
  return out;
}

}  // namespace osculate
