// Orocos KDL: joint-space solvers, each with its own pass over the chain. Linear rows first there.
#include <kdl/config.h>

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainhdsolver_vereshchagin.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <memory>
#include <string>

#include "benchmarks/dense_task.hpp"
#include "benchmarks/lists.hpp"

namespace osculate::bench {

namespace {

KDL::Vector vector_of(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
KDL::Rotation rotation_of(const Eigen::Matrix3d& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

/// The tip's frame is that of the last segment: one segment for each joint, as one of the solvers asks.
KDL::Chain kdl_chain(const Arm& arm) {
  KDL::Chain out;
  for (std::size_t i = 0; i < arm.links.size(); ++i) {
    const Arm::Link& link = arm.links[i];
    const bool last = i + 1 == arm.links.size();
    const Eigen::Matrix3d R = last ? arm.R_tip : Eigen::Matrix3d::Identity();
    const Eigen::Vector3d p = last ? arm.p_tip : Eigen::Vector3d::Zero();
    const Eigen::Matrix3d I = R.transpose() * link.inertia * R;
    const KDL::RigidBodyInertia inertia(
        link.mass, vector_of(R.transpose() * (link.com - p)),
        KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
    const KDL::Frame joint_frame(rotation_of(link.R_origin), vector_of(link.p_origin));
    const KDL::Joint joint("joint" + std::to_string(i), vector_of(link.p_origin),
                           vector_of(link.R_origin * link.axis),
                           link.slides ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
    out.addSegment(KDL::Segment("link" + std::to_string(i), joint,
                                joint_frame * KDL::Frame(rotation_of(R), vector_of(p)), inertia));
  }
  return out;
}

struct Kdl {
  explicit Kdl(const Arm& arm)
      : chain(kdl_chain(arm)),
        n(static_cast<unsigned>(arm.n())),
        gravity(vector_of(arm.gravity)),
        mass(chain, gravity),
        inverse(chain, gravity),
        jacobian(chain),
        jacobian_rate(chain),
        forward_dense(chain, gravity),
        forward_linear(chain, KDL::Twist(-gravity, KDL::Vector::Zero()), 1),
        q(n),
        qd(n),
        zero(n),
        bias(n),
        T(n),
        qdd(n),
        moving(n),
        M(n),
        J(n),
        no_constraint(1),
        setpoint(1),
        constraint_torques(n),
        wrenches(n, KDL::Wrench::Zero()),
        task(arm.n()) {
    SetToZero(zero);
    SetToZero(no_constraint);
    SetToZero(setpoint);
  }

  void take(const State& state) {
    std::copy_n(state.q.data(), n, q.data.data());
    std::copy_n(state.qd.data(), n, qd.data.data());
    std::copy_n(state.T.data(), n, T.data.data());
  }
  void give(Answer& answer) const { std::copy_n(qdd.data.data(), n, answer.qdd.data()); }

  void dynamics_dense(const State& state, Answer& answer) {
    take(state);
    forward_dense.CartToJnt(q, qd, T, wrenches, qdd);
    give(answer);
  }
  void dynamics_linear(const State& state, Answer& answer) {
    take(state);
    forward_linear.CartToJnt(q, qd, qdd, no_constraint, setpoint, wrenches, T, constraint_torques);
    give(answer);
  }
  void task_dense(const State& state, Answer& answer) {
    take(state);
    moving.q.data = q.data;
    moving.qdot.data = qd.data;
    mass.JntToMass(q, M);
    inverse.CartToJnt(q, qd, zero, wrenches, bias);  // C + G in one pass
    jacobian.JntToJac(q, J);
    KDL::Twist Jdot_qd;
    jacobian_rate.JntToJacDot(moving, Jdot_qd);
    for (int i = 0; i < 3; ++i) {
      task.J.row(i) = J.data.row(3 + i);
      task.J.row(3 + i) = J.data.row(i);
      task.Jdot_qd[i] = Jdot_qd.rot[i];
      task.Jdot_qd[3 + i] = Jdot_qd.vel[i];
    }
    task.solve(M.data, bias.data, state, answer);
  }

  void answer(const jury::Question& asked, jury::Answer& said) {
    take({asked.q, asked.qd, asked.tau});
    moving.q.data = q.data;
    moving.qdot.data = qd.data;
    mass.JntToMass(q, M);
    said.M = jury::by_rows(M.data);
    mass.JntToCoriolis(q, qd, bias);
    said.C = jury::by_rows(bias.data);
    mass.JntToGravity(q, bias);
    said.G = jury::by_rows(bias.data);
    jacobian.JntToJac(q, J);
    Eigen::MatrixXd angular_first(6, n);
    angular_first << J.data.bottomRows<3>(), J.data.topRows<3>();
    said.J = jury::by_rows(angular_first);
    KDL::Twist Jdot_qd;
    jacobian_rate.JntToJacDot(moving, Jdot_qd);
    said.Jdot_qd.resize(6);
    for (int i = 0; i < 3; ++i) {
      said.Jdot_qd[i] = Jdot_qd.rot[i];
      said.Jdot_qd[3 + i] = Jdot_qd.vel[i];
    }
    forward_dense.CartToJnt(q, qd, T, wrenches, qdd);
    said.qdd = jury::by_rows(qdd.data);
  }

  KDL::Chain chain;
  unsigned n;
  KDL::Vector gravity;
  KDL::ChainDynParam mass;
  KDL::ChainIdSolver_RNE inverse;
  KDL::ChainJntToJacSolver jacobian;
  KDL::ChainJntToJacDotSolver jacobian_rate;
  KDL::ChainFdSolver_RNE forward_dense;
  KDL::ChainHdSolver_Vereshchagin forward_linear;
  KDL::JntArray q, qd, zero, bias, T, qdd;
  KDL::JntArrayVel moving;
  KDL::JntSpaceInertiaMatrix M;
  KDL::Jacobian J, no_constraint;
  KDL::JntArray setpoint, constraint_torques;
  KDL::Wrenches wrenches;
  DenseTask task;
};

}  // namespace

extern "C" __attribute__((visibility("default"))) void add_routes(const Arm& arm,
                                                                  std::vector<Route>& routes) {
  const auto kdl = std::make_shared<Kdl>(arm);
  routes.push_back({"KDL", "JntToMass, RNE, JntToJac, JntToJacDot, Cholesky", Call::task,
                    [kdl](const State& s, Answer& a) { kdl->task_dense(s, a); },
                    [kdl](double* out) { kdl->task.read_Omega(out); }});
  routes.push_back({"KDL",
                    "ChainFdSolver_RNE",
                    Call::forward_dynamics,
                    [kdl](const State& s, Answer& a) { kdl->dynamics_dense(s, a); },
                    {}});
  routes.push_back({"KDL",
                    "ChainHdSolver_Vereshchagin",
                    Call::forward_dynamics,
                    [kdl](const State& s, Answer& a) { kdl->dynamics_linear(s, a); },
                    {}});
}

extern "C" __attribute__((visibility("default"))) void make_engine(const Arm& arm, jury::Engine& engine) {
  const auto kdl = std::make_shared<Kdl>(arm);
  engine = {"KDL", KDL_VERSION_STRING,
            [kdl](const jury::Question& asked, jury::Answer& said) { kdl->answer(asked, said); }};
}

}  // namespace osculate::bench
