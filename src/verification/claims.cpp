#include "verification/claims.hpp"

#include <Eigen/Eigenvalues>
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

/// 2-norm condition number of a symmetric positive definite matrix; infinite if it is not.
double condition_number(const Matrix& A) {
  const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(A, Eigen::EigenvaluesOnly).eigenvalues();
  return values[0] > 0 ? values[values.size() - 1] / values[0] : std::numeric_limits<double>::infinity();
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
  explicit Scales(const Evidence& e) {
    const auto& M = e.model.joint.M;
    Minv = dense::solve(dense::factor(M), Matrix(Matrix::Identity(M.rows(), M.cols()))).cwiseAbs();
    Lambda = e.terms.Lambda.cwiseAbs();
    c = e.task.J_Minv_C.cwiseAbs() + e.task.Jdot_qd.cwiseAbs();
    g = e.task.J_Minv_G.cwiseAbs();
    for (Eigen::Index i = 0; i < g.size(); ++i)
      if (e.rows[static_cast<std::size_t>(i)] >= 3) g[i] += e.gravity.norm();
    u = e.u.cwiseAbs();
  }
};

/// Sizes of the motions that joint rates (or accelerations) x add up to at the tip: angular, and linear with
/// every lever as long as the reach, because the sum goes through the joints in between.
std::pair<double, double> sizes(const Evidence& e, const Vector& x) {
  const Vector sum = e.plant.tip.J.cwiseAbs() * x.cwiseAbs();
  const double angular = sum.head(3).maxCoeff();
  return {angular, sum.tail(3).maxCoeff() + angular * e.reach};
}

Residual kinematics(const Evidence& e) {
  const auto& tip = e.plant.tip;
  const auto [spin, pace] = sizes(e, e.qd);
  const auto [turn, push] = sizes(e, e.qdd);
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

}  // namespace

void fill_dense_side(Evidence& e, const Chain<double>& model, const Chain<double>& plant,
                     std::span<const double> q, bool full_rank) {
  const auto joints = positions(model, q);
  e.gravity = plant.gravity;
  e.model = dense::state(model, joints, e.qd);
  e.plant = plant == model ? e.model : dense::state(plant, joints, e.qd);
  e.task = dense::mobility(e.model.tip, e.model.joint, e.rows);
  if (full_rank) e.terms = dense::task_terms(e.task);

  const auto at = dense::places(plant, dense::moving(plant, joints, e.qd));
  const Matrix3<double> R = values(at.tip.R), Rd = derivatives(at.tip.R);
  const Matrix3<double> spin = Rd * R.transpose();  // omega~
  e.pose_rate.head(3) << (spin(2, 1) - spin(1, 2)) / 2, (spin(0, 2) - spin(2, 0)) / 2,
      (spin(1, 0) - spin(0, 1)) / 2;
  e.pose_rate.tail(3) = derivatives(at.tip.p);
}

double scaled_condition(const Matrix& A) {
  const Vector d = A.diagonal().cwiseSqrt();
  if (!(d.minCoeff() > 0)) return std::numeric_limits<double>::infinity();
  return condition_number(d.cwiseInverse().asDiagonal() * A * d.cwiseInverse().asDiagonal());
}

int scaled_rank(const Matrix& A) {
  Vector d = A.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (auto& x : d) x = x > 0 ? 1 / x : 0;
  const Matrix scaled = d.asDiagonal() * A * d.asDiagonal();
  const Vector values =
      Eigen::SelfAdjointEigenSolver<Matrix>(scaled, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs();
  return static_cast<int>((values.array() > 1e-13 * values.maxCoeff()).count());
}

double force_residual(const Evidence& e) {
  const Scales scale(e);
  const Vector F = e.terms.Lambda * e.u + e.terms.c + e.terms.g;
  return weighted(e.F, F, scale.Lambda * (scale.u + scale.c + scale.g), block_weights(e.task.Omega, e.rows));
}

Residuals assess(const Evidence& e) {
  Residuals out;
  out.fill(not_applicable());
  const auto at = [&out](Claim claim) -> Residual& { return out[index(claim)]; };
  at(Claim::kinematics) = kinematics(e);

  // forward dynamics: the plant against M^-1 (T - C - G + J* F_ext)
  const auto& plant = e.plant.joint;
  const Vector s = plant.M.diagonal().cwiseSqrt();
  const Matrix plant_Minv =
      dense::solve(dense::factor(plant.M), Matrix(Matrix::Identity(s.size(), s.size())));
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
  Matrix Omega(m, m);
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index j = 0; j < m; ++j)
      Omega(i, j) =
          e.recursive.Omega(e.rows[static_cast<std::size_t>(i)], e.rows[static_cast<std::size_t>(j)]);
  at(Claim::omega) = bounded(Claim::omega, (Omega - e.task.Omega).cwiseAbs().cwiseQuotient(dd).maxCoeff(), 1);

  if (e.terms.Lambda.size() == 0) return out;
  const double condition = condition_number(e.task.Omega.cwiseQuotient(dd));
  const Scales scale(e);
  at(Claim::lambda) =
      bounded(Claim::lambda,
              ratio((e.recursive.Lambda - e.terms.Lambda).cwiseAbs().cwiseProduct(dd).maxCoeff(),
                    scale.Lambda.cwiseProduct(dd).maxCoeff()),
              condition);
  at(Claim::c) = bounded(Claim::c, weighted(e.recursive.c, e.terms.c, scale.Lambda * scale.c, d), condition);
  at(Claim::g) = bounded(Claim::g, weighted(e.recursive.g, e.terms.g, scale.Lambda * scale.g, d), condition);
  at(Claim::c_plus_g) =
      bounded(Claim::c_plus_g,
              weighted(e.recursive.c_plus_g, e.terms.c + e.terms.g, scale.Lambda * (scale.c + scale.g), d),
              condition);
  if (!e.controlled) return out;

  // torque (16), with the null-space torque T0 projected: T = T0 + J* Lambda (u + right side - J M^-1 T0)
  const auto& model = e.model.joint;
  const Matrix Jt = e.task.J.transpose();
  const Vector t = e.task.J * dense::solve(dense::factor(model.M), e.T0);
  const Vector F = e.terms.Lambda * (e.u - t) + e.terms.c + e.terms.g;
  const Vector t_scale = e.task.J.cwiseAbs() * scale.Minv * e.T0.cwiseAbs();
  const Vector right = scale.u + scale.c + scale.g + t_scale;
  const Vector T_scale = e.T0.cwiseAbs() + Jt.cwiseAbs() * scale.Lambda * right;
  const Vector joint_weight = model.M.diagonal().cwiseSqrt().cwiseInverse();
  at(Claim::torque) = bounded(Claim::torque, weighted(e.T, e.T0 + Jt * F, T_scale, joint_weight), condition);

  // What the torque adds to J* (Lambda u + c + g) must not move the tip: J M^-1 (T - J* F) = 0
  if (e.T0.cwiseAbs().maxCoeff() > 0) {
    const Vector task_force = e.terms.Lambda * e.u + e.terms.c + e.terms.g;
    const Vector rest = e.task.J * dense::solve(dense::factor(model.M), Vector(e.T - Jt * task_force));
    const Vector rest_scale = e.task.J.cwiseAbs() * scale.Minv * (e.T0.cwiseAbs() + T_scale);
    at(Claim::null_space) =
        bounded(Claim::null_space, weighted(rest, Vector::Zero(m), rest_scale, d.cwiseInverse()), condition);
  }

  // tip acceleration of the plant = u
  if (e.plant_is_model) {
    Vector reached(m);
    for (Eigen::Index i = 0; i < m; ++i) reached[i] = e.tip_acceleration[e.rows[static_cast<std::size_t>(i)]];
    const Vector reach_scale =
        d * d.dot(e.F.cwiseAbs()) + right;  // rounding in Omega(i,j) is relative to d_i d_j
    at(Claim::linearization) =
        bounded(Claim::linearization, weighted(reached, e.u, reach_scale, d.cwiseInverse()), 1);
  }
  return out;
}

}  // namespace osculate
