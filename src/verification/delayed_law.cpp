#include "verification/delayed_law.hpp"

namespace osculate {

namespace {

/// Both halves of a spatial vector turned.
Vector6 turned(const Matrix3<double>& R, const Vector6& v) {
  Vector6 out;
  out << R * v.head<3>(), R * v.tail<3>();
  return out;
}

}  // namespace

VectorX<double> DelayedLaw::torque(std::span<const double> q, const VectorX<double>& qd,
                                   const VectorX<double>& u, const VectorX<double>& T0,
                                   const Vector6& tip_force) {
  const auto joints = positions(model_, q);
  const dense::Operators<double> x = dense::operators(model_, joints, qd);
  const auto state = dense::state(model_, joints, qd);
  const auto at = dense::places(model_, joints);
  const int n = model_.n();
  const auto R = [&](int k) -> const Matrix3<double>& {  // axes of link k, of the tip for k = 0
    return k == 0 ? at.tip.R : at.links[static_cast<std::size_t>(n - k)].R;
  };

  // The biases of this sample, in link axes.
  Biases now;
  for (int k = 0; k <= n; ++k) {
    const Vector6 a = k == 0 ? x.a_tip.value : x.a.value.middleRows(6 * (k - 1), 6);
    now.a.push_back(turned(R(k).transpose(), a));
    if (k > 0) now.b.push_back(turned(R(k).transpose(), x.b.value.middleRows(6 * (k - 1), 6)));
  }

  // Those that the law uses, in inertial axes.
  const Sampling& sampling = *options_.sampling;
  const bool old_velocities =
      samples_ > 0 && (sampling.delay == Delay::velocity || sampling.delay == Delay::both);
  const bool old_force = samples_ > 0 && (sampling.delay == Delay::force || sampling.delay == Delay::both);
  const bool line = sampling.extrapolate && samples_ > 1;
  const auto used = [&](const std::vector<Vector6>& present, const std::vector<Vector6>& last,
                        const std::vector<Vector6>& before, std::size_t i) -> Vector6 {
    if (!old_velocities) return present[i];
    return line ? Vector6(2 * last[i] - before[i]) : last[i];
  };
  VectorX<double> a(6 * n), b(6 * n);
  for (int k = 1; k <= n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    a.segment<6>(6 * (k - 1)) = turned(R(k), used(now.a, last_.a, before_.a, i));
    b.segment<6>(6 * (k - 1)) = turned(R(k), used(now.b, last_.b, before_.b, i - 1));
  }
  const Vector6 a_tip = turned(R(0), used(now.a, last_.a, before_.a, 0));

  // (43), (46) with them, and (16); joint lists of the operators run tip first, as do a link's own rows.
  const MatrixX<double>&H = x.H.value, &phi = x.phi.value, &M = x.M.value, &B = x.B.value;
  const VectorX<double> phi_a = phi.transpose() * a;
  const VectorX<double> C_tip_first = H * (phi * (M * phi_a + b));
  const Vector6 Jdot_qd = B.transpose() * phi_a + a_tip;
  const auto base_first = [&](const VectorX<double>& list) {
    VectorX<double> out(list.size());
    Eigen::Index to = 0;
    for (int k = n; k >= 1; --k) {
      out.segment(to, x.rows_of(k)) = list.segment(x.first(k), x.rows_of(k));
      to += x.rows_of(k);
    }
    return out;
  };
  const VectorX<double> forces =
      base_first(C_tip_first) + state.joint.G - T0 - state.tip.J.transpose() * tip_force;
  const auto task = dense::mobility(state.tip, state.joint, options_.rows);
  const VectorX<double> right =
      u + task.J * dense::solve(dense::factor(state.joint.M), forces) - Jdot_qd(options_.rows);
  Vector6 F = Vector6::Zero();
  F(options_.rows) = dense::solve(dense::factor(task.Omega), right);

  const Vector6 F_now = turned(R(0).transpose(), F);
  if (old_force) F = turned(R(0), line ? Vector6(2 * last_F_ - before_F_) : last_F_);
  before_ = std::move(last_);
  last_ = std::move(now);
  before_F_ = last_F_;
  last_F_ = F_now;
  ++samples_;
  return state.tip.J.transpose() * F + T0;
}

}  // namespace osculate
