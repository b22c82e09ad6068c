#include "control/null_space.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "reference/dense.hpp"

namespace osculate {

namespace {

[[noreturn]] void beyond(const Chain<double>& model, std::size_t i, double q, const char* which,
                         double limit) {
  const std::string unit = model.links[i].type == JointType::prismatic ? " m" : " rad";
  throw std::domain_error("joint " + std::to_string(i + 1) + " (1 is next to the base) stands at " +
                          std::to_string(q) + unit + ", at or beyond its " + which + " limit of " +
                          std::to_string(limit) + unit + ": the null-space repulsion is not defined there");
}

/// Magnitude of the repulsion at a distance d > 0 from a limit, N m or N.
double repulsion_at(double d, const NullSpaceOptions::Limits& limits) {
  return d < limits.margin ? limits.gain * (1 / d - 1 / limits.margin) / (d * d) : 0.0;
}

void add_limits(const NullSpaceOptions::Limits& limits, const Chain<double>& model, std::span<const double> q,
                std::span<double> T0) {
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double below = q[i] - limits.lower[i], above = limits.upper[i] - q[i];
    if (!(below > 0)) beyond(model, i, q[i], "lower", limits.lower[i]);
    if (!(above > 0)) beyond(model, i, q[i], "upper", limits.upper[i]);
    T0[i] += repulsion_at(below, limits) - repulsion_at(above, limits);
  }
}

/// T0 += gain d/dq log w. With J^+ = J* (J J*)^-1, d log w / dq_i = 1/2 tr((J J*)^-1 d(J J*)/dq_i) =
/// tr(J^+ dJ/dq_i). Cost n^2 columns and n products of transforms for each of n joints.
void add_manipulability(double gain, const Chain<double>& model, const TaskRows& rows,
                        std::span<const double> q, std::span<double> T0) {
  using D = Dual<double>;
  const auto at_rest = positions<double>(model, q);
  const Eigen::Index n = model.n(), m = static_cast<Eigen::Index>(rows.size());
  MatrixX<double> J(m, n);
  std::vector<MatrixX<double>> dJ(q.size(), J);  // along each joint
  for (Eigen::Index i = 0; i < n; ++i) {
    // The derivative of every dual number below is that along q_i.
    const VectorX<double> along = VectorX<double>::Unit(n, i);
    const dense::Places<D> at = dense::places(model, dense::moving(model, at_rest, along));
    for (Eigen::Index j = 0; j < n; ++j) {
      const dense::LinkPlace<D>& link = at.links[static_cast<std::size_t>(j)];
      dense::Vector6<D> column = dense::unit_motion(link, 0);
      if (link.type == JointType::revolute)
        column.tail<3>() += column.head<3>().cross(at.tip.p - link.origin);
      for (Eigen::Index r = 0; r < m; ++r) {
        const D& entry = column[rows[static_cast<std::size_t>(r)]];
        J(r, j) = entry.value;
        dJ[static_cast<std::size_t>(i)](r, j) = entry.derivative;
      }
    }
  }
  const MatrixX<double> JJt = J * J.transpose();
  const auto factor = dense::factor(JJt);
  for (Eigen::Index r = 0; r < m; ++r)  // a pivot below this fraction of its diagonal entry is rank loss
    if (!(factor.D[r] > 1e-13 * JJt(r, r)))
      throw std::domain_error("manipulability has no gradient where the arm is singular on the task rows");
  const MatrixX<double> J_plus = dense::solve(factor, J).transpose();
  for (std::size_t i = 0; i < T0.size(); ++i) T0[i] += gain * (J_plus * dJ[i]).trace();
}

}  // namespace

bool NullSpaceOptions::empty() const { return damping == 0 && !posture && !limits && manipulability == 0; }

void null_space_torque(const NullSpaceOptions& options, const Chain<double>& model, const TaskRows& rows,
                       std::span<const double> q, std::span<const double> qd, std::span<double> T0) {
  if ((options.posture || options.limits || options.manipulability != 0) && !model.one_axis_joints())
    throw std::invalid_argument(
        "null-space posture, limits and manipulability want joints with one axis each");
  for (std::size_t i = 0; i < T0.size(); ++i) T0[i] = -options.damping * qd[i];
  if (options.posture)
    for (std::size_t i = 0; i < T0.size(); ++i)
      T0[i] += options.posture->stiffness * (options.posture->q[i] - q[i]);
  if (options.limits) add_limits(*options.limits, model, q, T0);
  if (options.manipulability != 0) add_manipulability(options.manipulability, model, rows, q, T0);
}

}  // namespace osculate
