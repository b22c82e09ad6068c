#include "simulation/closed_loop_slopes.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "control/command_slope.hpp"
#include "simulation/arm_slopes.hpp"

namespace osculate {

// Along each coordinate of (q, qd), written as a column:
//   the law     M da = dT0 - dT_a + d(J* (F + W)) + J* (dF + dW),   J da + dA = du on the task rows,
//               dT = d(J* F) + J* dF + dT0 + friction
//   the plant   M dqdd = dT - friction - dT_qdd + d(J* W) + J* dW
// W is the wrench on the tip; dT_a, dT_qdd and dA are slopes at fixed joint accelerations, d(J* F) at a fixed
// wrench (ArmSlopes); a is the acceleration that the law's own model of the arm would have.

namespace {

using Matrix = MatrixX<double>;
using TaskColumns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, Eigen::Dynamic>;

/// d(friction_torque)/dqd
double friction_slope(const JointFriction& f, double qd) {
  const double step = std::tanh(qd / f.v_s);
  return f.viscous + (qd > 0 ? f.coulomb_positive : f.coulomb_negative) / f.v_s * (1 - step * step);
}

}  // namespace

bool ClosedLoopSlopes::exist(const ClosedLoop& loop) {
  const Plant& plant = loop.plant();
  const LawOptions& law = loop.controller().options();
  if (plant.dense || law.sampling || !plant.chain.one_axis_joints()) return false;
  if (law.law == Law::free) return true;
  return law.law == Law::operational_space && loop.controller().model().one_axis_joints() &&
         CommandSlope::exists(law) && law.singularity.policy == SingularPolicy::none &&
         !law.null_space.limits && law.null_space.manipulability == 0;
}

struct ClosedLoopSlopes::Work {
  ClosedLoop& loop;
  Eigen::Index n;
  ArmSlopes plant, model;
  ForwardDynamics<double> model_dynamics;
  std::vector<JointPosition<double>> joints;
  std::vector<double> yd, a;
  // Columns along q, then along qd.
  Matrix T, R;              // n x 2 n: the law's torque; what M da or M dqdd is
  ArmSlopes::Columns W, u;  // 6 x 2 n: wrench on the tip, command
  VectorX<double> lost;     // 2 n: power lost at the surface
  Vector6 push;             // W itself
  Eigen::LLT<Matrix> M;
  Matrix N;            // M^-1 J* on the task rows
  TaskColumns Jr, dF;  // task rows of J, change of F

  explicit Work(ClosedLoop& given)
      : loop(given),
        n(loop.velocities()),
        plant(loop.plant().chain),
        model(loop.controller().model()),
        model_dynamics(loop.controller().model()),
        joints(loop.plant().chain.links.size()),
        yd(loop.states()),
        a(joints.size()),
        T(Matrix::Zero(n, 2 * n)),
        R(T),
        W(ArmSlopes::Columns::Zero(6, 2 * n)),
        u(W),
        lost(VectorX<double>::Zero(2 * n)),
        M(n) {
    const auto rows = static_cast<Eigen::Index>(loop.controller().options().rows.size());
    N.resize(n, rows);
    Jr.resize(rows, n);
    dF.resize(rows, 2 * n);
  }

  void feel();
  void control(std::span<const double> qd, const BaseMotion<double>& base);
  TipChange tip_change(const ArmSlopes& arm, Eigen::Index j) const;
};

/// The change of the tip along coordinate j of (q, qd).
TipChange ClosedLoopSlopes::Work::tip_change(const ArmSlopes& arm, Eigen::Index j) const {
  if (j < n) return {arm.J.col(j), arm.V_q.col(j), W.col(j)};
  return {Vector6::Zero(), arm.J.col(j - n), W.col(j)};
}

/// W, its slopes and lost, where the plant has been looked at.
void ClosedLoopSlopes::Work::feel() {
  push = loop.plant().tip_force;
  if (!loop.plant().environment) return;
  const Environment& environment = *loop.plant().environment;
  const bool in_contact = loop.modes().contact;
  const Vector3<double> v = plant.tip_velocity.tail<3>();
  const Touch at = touch(environment, plant.tip_position, v, in_contact);
  push += at.wrench;
  for (Eigen::Index j = 0; j < 2 * n; ++j) {
    const TipChange tip = tip_change(plant, j);
    const TouchSlope along =
        touch_slope(environment, at, v, in_contact, tip.pose.tail<3>(), tip.velocity.tail<3>());
    W.col(j).tail<3>() = along.force;
    lost[j] = along.lost_power;
  }
}

/// T of the operational-space law, which has just acted.
void ClosedLoopSlopes::Work::control(std::span<const double> qd, const BaseMotion<double>& base) {
  const Controller& controller = loop.controller();
  const LawOptions& law = controller.options();
  const Vector6 &F = controller.last().F, &known = controller.known_tip_force();
  Vec<Force, double> known_push;
  for (int i = 0; i < 6; ++i) set_component(known_push, i, known[i]);
  model_dynamics.move_base(base);
  model_dynamics.place(controller.joints());
  model_dynamics.accelerations(qd, controller.rigid_torque(), known_push, a);
  model.look(controller.joints(), qd, a, base);

  const CommandSlope slope_of_u(law, controller.last(), known);
  for (Eigen::Index j = 0; j < 2 * n; ++j) {
    TipChange tip = tip_change(model, j);
    if (!law.know_tip_force) tip.force.setZero();
    u.col(j) = slope_of_u.along(tip);
  }
  u.leftCols(n) -= model.A_q;
  u.rightCols(n) -= model.A_qd;

  // T = dT0, then R = dT0 - dT_a + d(J* (F + W)) + J* dW
  T.setZero();
  T.rightCols(n).diagonal().setConstant(-law.null_space.damping);
  if (law.null_space.posture) T.leftCols(n).diagonal().setConstant(-law.null_space.posture->stiffness);
  R = T;
  R.leftCols(n) -= model.T_q;
  R.rightCols(n) -= model.T_qd;
  model.add_wrench_slopes(F + known, R.leftCols(n));
  if (law.know_tip_force) R.noalias() += model.J.transpose() * W;

  // Omega dF = du - dA - J M^-1 R
  const auto m = static_cast<Eigen::Index>(law.rows.size());
  for (Eigen::Index i = 0; i < m; ++i) {
    Jr.row(i) = model.J.row(law.rows[static_cast<std::size_t>(i)]);
    dF.row(i) = u.row(law.rows[static_cast<std::size_t>(i)]);
  }
  N = Jr.transpose();
  M.compute(model.M);
  M.solveInPlace(N);
  dF.noalias() -= N.transpose() * R;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6> Omega = Jr * N;
  Omega.llt().solveInPlace(dF);

  model.add_wrench_slopes(F, T.leftCols(n));
  T.noalias() += Jr.transpose() * dF;
  const std::vector<JointFriction>& friction = controller.friction();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    double torque = controller.rigid_torque()[at];
    if (law.compensate_friction && !friction.empty()) {
      T(i, n + i) += friction_slope(friction[at], qd[at]);
      torque += friction_torque(friction[at], qd[at]);
    }
    if (!law.effort_limit.empty() && std::abs(torque) > law.effort_limit[at]) T.row(i).setZero();
  }
}

ClosedLoopSlopes::ClosedLoopSlopes(ClosedLoop& loop) : work_(std::make_unique<Work>(loop)) {}
ClosedLoopSlopes::~ClosedLoopSlopes() = default;

void ClosedLoopSlopes::operator()(double t, const double* y, double* columns) {
  Work& w = *work_;
  const Eigen::Index n = w.n, states = 2 * n + 3;
  const Plant& plant = w.loop.plant();
  const std::span<const double> qd = w.loop.qd(y);
  const BaseMotion<double> base = w.loop.base(t);
  w.loop.right_side(t, y, w.yd.data());
  set_positions(plant.chain, w.loop.q(y), w.joints);
  w.plant.look(w.joints, qd, {w.yd.data() + n, static_cast<std::size_t>(n)}, base);
  w.feel();
  if (w.loop.controller().options().law != Law::free) w.control(qd, base);

  Eigen::Map<Matrix> out(columns, states, states);
  out.setZero();  // nothing depends on the energies
  out.topRows(n).middleCols(n, n).setIdentity();
  const Eigen::Map<const VectorX<double>> rates(qd.data(), n);

  // Work, loss and the constant wrench's work; W as the plant feels it.
  auto work = out.row(2 * n).head(2 * n), loss = out.row(2 * n + 1).head(2 * n),
       external = out.row(2 * n + 2).head(2 * n);
  work.noalias() = rates.transpose() * w.T;
  loss = w.lost.transpose();
  external.head(n).noalias() = plant.tip_force.transpose() * w.plant.V_q;
  external.tail(n).noalias() = plant.tip_force.transpose() * w.plant.J;
  w.R = w.T;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const bool rubs = !plant.friction.empty();
    const double friction = rubs ? friction_torque(plant.friction[at], qd[at]) : 0.0;
    const double slope = rubs ? friction_slope(plant.friction[at], qd[at]) : 0.0;
    work[n + i] += w.loop.net_torque()[at] + friction;
    loss[n + i] += friction + slope * qd[at];
    w.R(i, n + i) -= slope;
  }
  w.R.leftCols(n) -= w.plant.T_q;
  w.R.rightCols(n) -= w.plant.T_qd;
  w.plant.add_wrench_slopes(w.push, w.R.leftCols(n));
  w.R.noalias() += w.plant.J.transpose() * w.W;
  w.M.compute(w.plant.M);
  w.M.solveInPlace(w.R);
  out.middleRows(n, n).leftCols(2 * n) = w.R;
}

}  // namespace osculate
