// A sampled controller with named mistakes, the arm that it moves, and the log of both.
#pragma once

#include <random>
#include <set>
#include <string>

#include "control/pose_error.hpp"
#include "judge/judge.hpp"
#include "model/pose.hpp"
#include "model/urdf.hpp"
#include "reference/dense.hpp"

namespace osculate {

/// An arm as its controller should know it.
struct JudgedArm {
  std::string name;
  Chain<double> chain;
  std::vector<double> viscous;  // N m s/rad or N s/m: of the true arm, to be compensated
  std::vector<double> q;        // where it starts
  std::vector<int> rows{0, 1, 2, 3, 4, 5};
  ErrorLaw error_law = ErrorLaw::rotation_vector;  // of its controller: no mistake
};

inline JudgedArm judged_arm(const std::string& name) {
  ChainChoice choice;
  choice.tip = "tool0";
  JudgedArm out;
  out.name = name;
  if (name == "puma560") choice.base = "base_link", out.q = {0, -0.8, 0.4, 0.3, 0.9, 0.2};
  if (name == "ur5e_like") out.q = {0.2, -1.3, 1.6, -1.2, -1.4, 0.3};
  if (name == "arm7") out.q = {0.3, 0.6, -0.2, 1.2, 0.3, 0.9, 0.1};
  out.chain = load_urdf(std::string(OSCULATE_SOURCE_DIR) + "/models/" + name + ".urdf", choice).chain;
  for (std::size_t i = 0; i < out.chain.links.size(); ++i) {
    out.chain.links[i].armature = 0.1 / (1 + static_cast<double>(i));
    out.viscous.push_back(2.0 / (1 + static_cast<double>(i)));
  }
  return out;
}

/// The mistakes that wrong_torque() knows, by the terms that judge() should name.
using Mistakes = std::set<std::string>;

inline constexpr double stiffness = 100, damping = 20;      // 1/s^2, 1/s
inline const Vector3<double> wrong_tip{0.03, -0.02, 0.05};  // m, tip axes
inline constexpr double delay = 0.004;                      // s
inline constexpr double weak_joint = -0.1;                  // of joint 2's torque
inline const Vector3<double> wrong_gravity{0.3, 0, -0.2};   // m/s^2

/// Mass at the tip, unknown to who omits it, kg: half of the last link's.
inline double payload_of(const JudgedArm& arm) { return std::min(0.8, arm.chain.links.back().mass / 2); }

/// u of pose tracking, with what may go wrong in it.
inline Vector6 tracking(const JudgedArm& arm, const TipReference& reference,
                        const dense::Kinematics<double>& tip, const Mistakes& mistakes) {
  const auto misread = [](const Matrix3<double>& R) {
    const Eigen::Vector4d x = quaternion(R);
    return Eigen::Quaterniond(x[3], x[0], x[1], x[2]).toRotationMatrix();
  };
  TipReference asked = reference;
  if (mistakes.contains("quaternion_reference")) asked.pose.R = misread(reference.pose.R);
  if (mistakes.contains("feedforward")) asked.acceleration.setZero();
  const PoseError error = pose_error(asked, {tip.R, tip.p}, tip.tip_velocity);
  Vector6 D = Vector6::Constant(damping);
  if (mistakes.contains("gains")) D.tail<3>() *= -1;
  if (arm.error_law == ErrorLaw::angular_velocity)
    return asked.acceleration + D.cwiseProduct(asked.velocity - tip.tip_velocity) + stiffness * error.e;
  return pose_command(asked, {tip.R, tip.p}, tip.tip_velocity, error,
                      -D.cwiseProduct(error.ed) - stiffness * error.e);
}

/// (16) with mistakes. `u`: what was commanded, as a log would have it.
inline VectorX<double> wrong_torque(const JudgedArm& arm, const std::vector<double>& q,
                                    const VectorX<double>& qd, const TipReference& reference,
                                    const Mistakes& mistakes, Vector6& u) {
  const auto made = [&](const char* id) { return mistakes.contains(id); };
  Chain<double> chain = arm.chain;
  auto& last = chain.links.back();
  if (made("payload")) {  // the true arm has it, the controller does not
    const double payload_mass = payload_of(arm), mass = last.mass - payload_mass;
    const Vector3<double> p = chain.p_tip, c = (last.mass * last.com - payload_mass * p) / mass;
    const auto about = [](double m, const Vector3<double>& x) -> Matrix3<double> {
      return m * (x.squaredNorm() * Matrix3<double>::Identity() - x * x.transpose());
    };
    last.inertia = last.inertia + about(last.mass, last.com) - about(payload_mass, p) - about(mass, c);
    last.mass = mass, last.com = c;
  }
  if (made("armature"))
    for (auto& link : chain.links) link.armature = 0;
  if (made("gravity_vector")) chain.gravity += wrong_gravity;
  if (made("tip_point")) chain.p_tip += chain.R_tip * wrong_tip;
  const auto joints = positions(chain, std::span<const double>(q));
  const auto [tip, joint] = dense::state(chain, joints, qd, {});
  const auto task = dense::mobility(tip, joint, arm.rows);
  const auto Omega = dense::factor(task.Omega);
  u = tracking(arm, reference, dense::state(arm.chain, joints, qd, {}).tip, mistakes);
  Vector6 used = u;
  if (made("swapped_rows")) used << u.tail<3>(), u.head<3>();
  if (made("u_in_tip_frame")) used << tip.R * u.head<3>(), tip.R * u.tail<3>();
  if (made("u_turned_to_tip")) used << tip.R.transpose() * u.head<3>(), tip.R.transpose() * u.tail<3>();
  if (made("spatial_acceleration"))
    used.tail<3>() += tip.tip_velocity.head<3>().cross(tip.tip_velocity.tail<3>());
  const VectorX<double> u_task = used(arm.rows);
  VectorX<double> wanted = VectorX<double>::Zero(u_task.size());  // of the tip, but for u
  if (!made("jdot_qd")) wanted -= task.Jdot_qd;
  if (!made("coriolis")) wanted += task.J_Minv_C;
  if (!made("gravity")) wanted += task.J_Minv_G;
  MatrixX<double> blocks = task.Omega;
  if (made("uncoupled_lambda")) {
    blocks.topRightCorner(3, 3).setZero();
    blocks.bottomLeftCorner(3, 3).setZero();
  }
  VectorX<double> T =
      task.J.transpose() * VectorX<double>(solve(dense::factor(blocks), u_task) + solve(Omega, wanted));
  if (T.size() > u_task.size()) {  // damps what the tip does not feel
    const VectorX<double> T0 = -5 * qd;
    T += T0 - task.J.transpose() *
                  VectorX<double>(solve(Omega, VectorX<double>(task.J * solve(dense::factor(joint.M), T0))));
  }
  if (!made("viscous"))
    for (Eigen::Index i = 0; i < T.size(); ++i) T[i] += arm.viscous[static_cast<std::size_t>(i)] * qd[i];
  if (made("torque_scale")) T[1] *= 1 + weak_joint;
  return T;
}

struct LogChoice {
  double seconds = 2, interval = 0.001;  // s; the law acts at each
  double noise = 1e-4;                   // of each signal's root mean square
  bool with_reference = false;           // in place of u
  bool in_charge = true;                 // false: the right law moves the arm, the other's torque is logged
};

/// The arm under this law from rest, on a path that turns and slides the tip along all axes.
inline Log simulate(const JudgedArm& arm, const Mistakes& mistakes, const LogChoice& choice = {}) {
  JudgedArm truth = arm;
  const auto n = static_cast<Eigen::Index>(arm.q.size()),
             N = static_cast<Eigen::Index>(choice.seconds / choice.interval);
  LissajousOptions lissajous;
  lissajous.amplitude << 0.2, 0.25, 0.3, 0.06, 0.05, 0.07;
  lissajous.period << 1.1, 0.9, 1.3, 0.8, 1.2, 1.0;
  const auto path = make_path(lissajous);
  const auto start = dense::kinematics(arm.chain, positions(arm.chain, std::span<const double>(arm.q)),
                                       VectorX<double>(VectorX<double>::Zero(n)));
  VectorX<double> y(2 * n);
  y << Eigen::Map<const VectorX<double>>(arm.q.data(), n), VectorX<double>::Zero(n);
  const auto slope = [&](const VectorX<double>& at, const VectorX<double>& T) {
    const std::vector<double> q(at.data(), at.data() + n);
    const VectorX<double> qd = at.tail(n);
    const auto [tip, joint] =
        dense::state(arm.chain, positions(arm.chain, std::span<const double>(q)), qd, {});
    VectorX<double> net = T;
    for (Eigen::Index i = 0; i < n; ++i) net[i] -= arm.viscous[static_cast<std::size_t>(i)] * qd[i];
    VectorX<double> out(2 * n);
    out << qd, dense::forward_dynamics(joint, tip.J, net);
    return out;
  };
  Log log;
  log.source = arm.name;
  log.q.resize(N, n), log.qd.resize(N, n), log.tau.resize(N, n);
  MatrixX<double> u(N, 6);
  LoggedReference reference{MatrixX<double>(N, 3), MatrixX<double>(N, 4), u, u};
  Eigen::Vector4d last = Eigen::Vector4d::Zero();
  std::vector<VectorX<double>> decided;
  for (Eigen::Index k = 0; k < N; ++k) {
    const double t = static_cast<double>(k) * choice.interval;
    const std::vector<double> q(y.data(), y.data() + n);
    const TipReference asked = tip_reference(*path, {start.R, start.p}, t);
    Vector6 commanded;
    decided.push_back(wrong_torque(arm, q, y.tail(n), asked, mistakes, commanded));
    const auto late = static_cast<std::size_t>(std::llround(delay / choice.interval));
    const VectorX<double> T = mistakes.contains("delay") && decided.size() > late
                                  ? decided[decided.size() - 1 - late]
                                  : decided.back();
    const VectorX<double> moves =
        choice.in_charge ? T : wrong_torque(arm, q, y.tail(n), asked, {}, commanded);
    log.t.push_back(t);
    log.q.row(k) = y.head(n), log.qd.row(k) = y.tail(n), log.tau.row(k) = T, u.row(k) = commanded;
    last = quaternion(asked.pose.R, last);
    reference.position.row(k) = asked.pose.p, reference.quaternion.row(k) = last;
    reference.velocity.row(k) = asked.velocity, reference.acceleration.row(k) = asked.acceleration;
    const double h = choice.interval;  // one step of Runge and Kutta for each sample
    const VectorX<double> k1 = slope(y, moves), k2 = slope(y + h / 2 * k1, moves),
                          k3 = slope(y + h / 2 * k2, moves), k4 = slope(y + h * k3, moves);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  std::mt19937_64 random(20261122);
  std::normal_distribution<double> normal;
  const auto blur = [&](MatrixX<double>& signal) {
    for (Eigen::Index j = 0; j < signal.cols(); ++j) {
      const double size = choice.noise * signal.col(j).norm() / std::sqrt(static_cast<double>(N));
      for (Eigen::Index k = 0; k < N; ++k) signal(k, j) += size * normal(random);
    }
  };
  blur(log.q), blur(log.qd), blur(log.tau), blur(u);
  if (choice.with_reference) {
    log.reference = reference;
    log.quaternion_order = QuaternionOrder::w_first;
  } else {
    log.u = u;
    log.u_order = RowOrder::angular_first;
  }
  return log;
}

/// What the exact law of this arm is.
inline JudgeOptions judge_options(const JudgedArm& arm) {
  JudgeOptions out;
  out.rows = arm.rows;
  for (const double viscous : arm.viscous) out.friction.push_back({viscous, 0, 0, 1e-2});
  return out;
}

/// The mistakes found; friction that is wholly omitted is found as a term of the model.
inline Mistakes named(const Judgement& judgement) {
  Mistakes out;
  for (const Finding& finding : judgement.findings)
    out.insert(finding.term == "friction_model" ? "viscous" : finding.term);
  return out;
}

}  // namespace osculate
