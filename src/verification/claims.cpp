#include "verification/claims.hpp"

#include <cmath>
#include <limits>

#include "model/pose.hpp"
#include "verification/bounds.hpp"

namespace osculate {

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

constexpr double eps = std::numeric_limits<double>::epsilon();

/// difference / scale, where a zero scale demands a zero difference.
double ratio(double difference, double scale) {
  if (scale > 0) return difference / scale;
  return difference == 0 ? 0 : std::numeric_limits<double>::infinity();
}

/// max |x - y| w / max scale w, with the weights w of the rows.
double weighted(const Vector& x, const Vector& y, const Vector& scale, const Vector& weights) {
  return ratio((x - y).cwiseAbs().cwiseProduct(weights).maxCoeff(), scale.cwiseProduct(weights).maxCoeff());
}

/// For each task row the root of the largest diagonal entry of Omega among the rows of its kind, angular or
/// linear. A scale that knows neither how the base frame is turned nor the units; rounding in Omega is
/// relative to it.
Vector block_weights(const Matrix& Omega, const TaskRows& rows) {
  double largest[2] = {0, 0};
  for (std::size_t i = 0; i < rows.size(); ++i)
    largest[rows[i] / 3] =
        std::max(largest[rows[i] / 3], Omega(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
  Vector out(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    out[static_cast<Eigen::Index>(i)] = std::sqrt(largest[rows[i] / 3]);
  return out;
}

Matrix inverse(const Matrix& M) {
  return dense::solve(dense::factor(M), Matrix(Matrix::Identity(M.rows(), M.cols())));
}

/// How much larger than Omega the numbers are that Omega is the outcome of. Rounding in Omega is eps times
/// this, relative to the weights d of its rows. The largest of
///  - the mobility of every inner link over that of the tip. A light link inboard of a heavy tip yields more
///    than the tip does, and sweep 3 subtracts the difference. Its turning counts with the whole lever from
///    the link's origin to the tip, because the sweep goes that way in steps which may cancel;
///  - sum_i (J M^-1)(r,i)^2 M(i,i): what a relative error of eps in the entries of M does to row r of (11).
/// Both are 1 to 10 for most arms, and grow like the mass of a heavy tip over that of the arm.
double spread(const Evidence& e, const Matrix& Minv, const Vector& d) {
  const Matrix& M = e.model.joint.M;
  double angular = 0, linear = 0;  // of the inner links, at the tip
  for (Eigen::Index i = 1; i <= M.rows(); ++i) {
    const Matrix J = e.model.tip.J.leftCols(i);
    const Vector inner = (J * Minv.topLeftCorner(i, i) * J.transpose()).diagonal();
    const double turning = inner.head(3).maxCoeff(), lever = e.levers[i - 1];
    angular = std::max(angular, turning);
    linear = std::max(linear, inner.tail(3).maxCoeff() + turning * lever * lever);
  }
  const Vector of_M = (e.task.J * Minv).cwiseAbs2() * M.diagonal();
  double out = 1;
  for (Eigen::Index r = 0; r < d.size(); ++r) {
    const double inner = e.rows[static_cast<std::size_t>(r)] < 3 ? angular : linear;
    out = std::max({out, inner / (d[r] * d[r]), of_M[r] / (d[r] * d[r])});
  }
  return out;
}

Residual bounded(Claim claim, double value, double condition) {
  const double bound = measured_bounds[index(claim)].constant * eps * condition;
  return {value, bound, true};
}

Residual not_applicable() { return {0, 0, false}; }

/// Scales of the dense side's sums, on the task rows.
struct Scales {
  Matrix Minv, Lambda;  // |M^-1|, |Lambda|
  Vector c, g, u;       // right sides before the solve
  Scales(const Evidence& e, const Matrix& inverse_of_M) {
    Minv = inverse_of_M.cwiseAbs();
    Lambda = e.terms.Lambda.cwiseAbs();
    c = e.task.J_Minv_C.cwiseAbs() + e.task.Jdot_qd.cwiseAbs();
    g = e.task.J_Minv_G.cwiseAbs();
    for (Eigen::Index i = 0; i < g.size(); ++i)
      if (e.rows[static_cast<std::size_t>(i)] >= 3) g[i] += e.gravity.norm();
    u = e.u.cwiseAbs();
  }
};

/// Sizes of the motions that joint rates (or accelerations) x and the motion `base` of the base add up to at
/// the tip: angular, and linear with every lever as long as the reach, because the sum goes through the
/// joints in between.
std::pair<double, double> sizes(const Evidence& e, const Vector& x, const Vector6& base) {
  const Vector sum = e.plant.tip.J.cwiseAbs() * x.cwiseAbs() + base.cwiseAbs();
  const double angular = sum.head(3).maxCoeff();
  return {angular, sum.tail(3).maxCoeff() + angular * e.reach};
}

Residual kinematics(const Evidence& e) {
  const auto& tip = e.plant.tip;
  const auto [spin, pace] = sizes(e, e.qd, e.base.velocity);
  const auto [turn, push] = sizes(e, e.qdd, e.base.acceleration);
  double worst = ratio((e.tip.R - tip.R).cwiseAbs().maxCoeff(), 1.0);
  worst = std::max(worst, ratio((e.tip.p - tip.p).cwiseAbs().maxCoeff(), e.reach));
  for (const Vector6& V : {e.tip_velocity, e.pose_rate}) {
    worst = std::max(worst, ratio((V - tip.tip_velocity).head(3).cwiseAbs().maxCoeff(), spin));
    worst = std::max(worst, ratio((V - tip.tip_velocity).tail(3).cwiseAbs().maxCoeff(), pace));
  }
  const Vector6 off = (e.tip_acceleration - (tip.J * e.qdd + tip.Jdot_qd)).cwiseAbs();
  worst = std::max(worst, ratio(off.head(3).maxCoeff(), turn + spin * spin));
  worst = std::max(worst, ratio(off.tail(3).maxCoeff(), push + spin * pace + e.gravity.norm()));
  return bounded(Claim::kinematics, worst, 1);
}

/// Second derivatives of the tip's coordinates: those commanded, those reached and those that the tracking
/// law makes due; orientation and position apart. Errors of the tip's acceleration pass through Pi^-1, those
/// of its pose through the derivative of Pi^-1: near a singular pose 1/sigma and 1/sigma^2.
Residual coordinates(const Evidence& e, const Vector& reach_scale, double spread_of_Omega) {
  const ChartEvidence& chart = *e.chart;
  const double sigma = std::min(1.0, chart.smallest_singular_value);
  double worst = 0;
  const auto judge = [&](int first, int count, int block) {
    if (count == 0) return;
    double push = 0;
    for (std::size_t i = 0; i < e.rows.size(); ++i)
      if (e.rows[i] / 3 == block) push = std::max(push, reach_scale[static_cast<Eigen::Index>(i)]);
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
  const auto joints = positions(model, q);
  e.gravity = plant.gravity;
  e.model = dense::state(model, joints, e.qd, e.base);
  e.plant = plant == model ? e.model : dense::state(plant, joints, e.qd, e.base);
  e.task = dense::mobility(e.model.tip, e.model.joint, e.rows);
  if (full_rank) e.terms = dense::task_terms(e.task);

  const auto at = dense::moving_places(plant, joints, e.qd, e.base);
  const Matrix3<double> R = values(at.tip.R), Rd = derivatives(at.tip.R);
  const Matrix3<double> spin = Rd * R.transpose();  // omega~
  e.pose_rate.head(3) << (spin(2, 1) - spin(1, 2)) / 2, (spin(0, 2) - spin(2, 0)) / 2,
      (spin(1, 0) - spin(0, 1)) / 2;
  e.pose_rate.tail(3) = derivatives(at.tip.p);
  e.levers.resize(e.qd.size());
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < at.links.size(); ++i)
    for (int j = 0; j < velocity_count(plant.links[i].type); ++j)
      e.levers[column++] = values(at.tip.p - at.links[i].origin).norm();
}

double force_residual(const Evidence& e) {
  const Scales scale(e, inverse(e.model.joint.M));
  const Vector F = e.terms.Lambda * e.u + e.terms.c + e.terms.g;
  return weighted(e.F, F - Vector(e.known_tip_force(e.rows)), scale.Lambda * (scale.u + scale.c + scale.g),
                  block_weights(e.task.Omega, e.rows));
}

Residuals assess(const Evidence& e) {
  Residuals out;
  out.fill(not_applicable());
  const auto at = [&out](Claim claim) -> Residual& { return out[index(claim)]; };
  at(Claim::kinematics) = kinematics(e);

  // forward dynamics: the plant against M^-1 (T - C - G + J* F_ext)
  const auto& plant = e.plant.joint;
  const Vector s = plant.M.diagonal().cwiseSqrt();
  const Matrix plant_Minv = inverse(plant.M);
  const Vector forces = e.net_torque.cwiseAbs() + plant.C.cwiseAbs() + plant.G.cwiseAbs() +
                        e.plant.tip.J.transpose().cwiseAbs() * e.tip_force.cwiseAbs();
  const Vector qdd = dense::forward_dynamics(plant, e.plant.tip.J, e.net_torque, e.tip_force);
  at(Claim::forward_dynamics) =
      bounded(Claim::forward_dynamics, weighted(e.qdd, qdd, plant_Minv.cwiseAbs() * forces, s),
              scaled_condition(plant.M));

  // the task: Omega, then everything that its inverse multiplies
  const auto m = static_cast<Eigen::Index>(e.rows.size());
  const Vector d = block_weights(e.task.Omega, e.rows);
  if (!(d.minCoeff() > 0)) return out;
  const Matrix dd = d * d.transpose();
  const Matrix Minv = inverse(e.model.joint.M);
  const double spread_of_Omega = spread(e, Minv, d);
  if (e.recursive.Omega.size() > 0) {
    const Matrix Omega = e.recursive.Omega(e.rows, e.rows);
    at(Claim::omega) = bounded(Claim::omega, (Omega - e.task.Omega).cwiseAbs().cwiseQuotient(dd).maxCoeff(),
                               spread_of_Omega);
  }

  if (e.terms.Lambda.size() == 0) return out;
  const double condition_alone = condition_number(e.task.Omega.cwiseQuotient(dd));
  const double condition = condition_alone * spread_of_Omega;
  const Scales scale(e, Minv);
  if (e.recursive.Lambda.size() > 0) {
    const RecursiveTerms& r = e.recursive;
    at(Claim::lambda) = bounded(Claim::lambda,
                                ratio((r.Lambda - e.terms.Lambda).cwiseAbs().cwiseProduct(dd).maxCoeff(),
                                      scale.Lambda.cwiseProduct(dd).maxCoeff()),
                                condition);
    at(Claim::c) = bounded(Claim::c, weighted(r.c, e.terms.c, scale.Lambda * scale.c, d), condition);
    at(Claim::g) = bounded(Claim::g, weighted(r.g, e.terms.g, scale.Lambda * scale.g, d), condition);
    at(Claim::c_plus_g) = bounded(
        Claim::c_plus_g, weighted(r.c_plus_g, e.terms.c + e.terms.g, scale.Lambda * (scale.c + scale.g), d),
        condition);
    for (const Claim claim : {Claim::lambda, Claim::c, Claim::g, Claim::c_plus_g})
      if (e.filtered && !(at(claim).bound <= undecided_bound)) at(claim) = not_applicable();
  }
  if (!e.controlled && !e.linearized) return out;

  // torque (16), with the null-space torque T0 projected: T = T0 + J* Lambda (u + right side - J M^-1 T0)
  const auto& model = e.model.joint;
  const Matrix Jt = e.task.J.transpose();
  const Vector t = e.task.J * dense::solve(dense::factor(model.M), e.T0);
  const Vector known = e.known_tip_force(e.rows);
  const Vector F = e.terms.Lambda * (e.u - t) + e.terms.c + e.terms.g - known;
  const Vector t_scale = e.task.J.cwiseAbs() * scale.Minv * e.T0.cwiseAbs();
  const Vector right = scale.u + scale.c + scale.g + t_scale;
  const Vector T_scale = e.T0.cwiseAbs() + Jt.cwiseAbs() * (scale.Lambda * right + known.cwiseAbs());
  const Vector joint_weight = model.M.diagonal().cwiseSqrt().cwiseInverse();
  const Vector T = e.delayed_torque.size() > 0 ? e.delayed_torque : Vector(e.T0 + Jt * F);
  const Residual torque = bounded(Claim::torque, weighted(e.T, T, T_scale, joint_weight), condition);
  if (e.controlled) at(Claim::torque) = torque;

  // What the torque adds to J* (Lambda u + c + g) must not move the tip: J M^-1 (T - J* F) = 0
  if (e.controlled && e.T0.cwiseAbs().maxCoeff() > 0 && e.delayed_torque.size() == 0) {
    const Vector task_force = e.terms.Lambda * e.u + e.terms.c + e.terms.g - known;
    const Vector rest = e.task.J * dense::solve(dense::factor(model.M), Vector(e.T - Jt * task_force));
    const Vector rest_scale = e.task.J.cwiseAbs() * scale.Minv * (e.T0.cwiseAbs() + T_scale);
    at(Claim::null_space) = bounded(
        Claim::null_space, weighted(rest, Vector::Zero(m), rest_scale, d.cwiseInverse()), condition_alone);
  }

  // tip acceleration of the plant = u, and in coordinates ydd = v
  if (!e.linearized) return out;
  const Vector reached = e.tip_acceleration(e.rows);
  const Vector reach_scale =
      d * d.dot(F.cwiseAbs()) + right;  // rounding in Omega(i,j) is relative to d_i d_j
  // Where the condition of Omega leaves no digit of F, (5) says nothing: undecided, as the torque is.
  if (!(torque.bound <= undecided_bound)) {
    at(Claim::linearization) = {0, torque.bound, true};
    return out;
  }
  at(Claim::linearization) =
      bounded(Claim::linearization, weighted(reached, e.u, reach_scale, d.cwiseInverse()),
              e.one_solve ? spread_of_Omega : condition);
  if (e.chart) at(Claim::coordinates) = coordinates(e, reach_scale, spread_of_Omega);
  return out;
}

}  // namespace osculate
