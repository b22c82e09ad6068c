// DART: its own caches decide what a new state makes it compute again.
#include <dart/config.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <memory>
#include <string>

#include "benchmarks/dense_task.hpp"
#include "benchmarks/lists.hpp"

namespace osculate::bench {

namespace {

struct Dart {
  explicit Dart(const Arm& arm)
      : n(arm.n()),
        tip_point(arm.p_tip),
        skeleton(dart::dynamics::Skeleton::create("arm")),
        q(n),
        qd(n),
        T(n),
        none(Eigen::VectorXd::Zero(n)),
        task(n) {
    for (const Arm::Link& link : arm.links) {
      if (link.slides)
        add<dart::dynamics::PrismaticJoint>(link);
      else
        add<dart::dynamics::RevoluteJoint>(link);
    }
    skeleton->setGravity(arm.gravity);
  }

  template <class Joint>
  void add(const Arm::Link& link) {
    typename Joint::Properties joint;
    joint.mName = "joint" + std::to_string(skeleton->getNumJoints());
    joint.mAxis = link.axis;
    joint.mT_ParentBodyToJoint.linear() = link.R_origin;
    joint.mT_ParentBodyToJoint.translation() = link.p_origin;
    dart::dynamics::BodyNode::AspectProperties body;
    body.mName = "link" + std::to_string(skeleton->getNumBodyNodes());
    body.mInertia = dart::dynamics::Inertia(link.mass, link.com, link.inertia);
    last =
        skeleton->createJointAndBodyNodePair<Joint>(last, joint, dart::dynamics::BodyNode::Properties(body))
            .second;
  }

  void place(const State& state, const Eigen::VectorXd& torques) {
    std::copy_n(state.q.data(), n, q.data());
    std::copy_n(state.qd.data(), n, qd.data());
    skeleton->setPositions(q);
    skeleton->setVelocities(qd);
    skeleton->setForces(torques);
  }

  void forward_dynamics(const State& state, Answer& answer) {
    std::copy_n(state.T.data(), n, T.data());
    place(state, T);
    skeleton->computeForwardDynamics();
    for (std::size_t i = 0; i < answer.qdd.size(); ++i) answer.qdd[i] = skeleton->getAcceleration(i);
  }

  void task_dense(const State& state, Answer& answer) {
    place(state, none);
    task.J = last->getWorldJacobian(tip_point);
    task.Jdot_qd.noalias() = last->getJacobianClassicDeriv(tip_point) * qd;
    task.solve(skeleton->getMassMatrix(), skeleton->getCoriolisAndGravityForces(), state, answer);
  }

  /// O(n): the velocity changes that six unit impulses make, as its contact solver computes them.
  void task_by_impulses(const State& state, Answer& answer) {
    place(state, none);
    skeleton->computeForwardDynamics();
    task.free << last->getAngularAcceleration(), last->getLinearAcceleration(tip_point);
    const Eigen::Matrix3d R = last->getWorldTransform().linear();
    DenseTask::Six X, Omega_link;  // X: velocity of the link in its axes, about its origin -> the tip's
    X << R, Eigen::Matrix3d::Zero(), -R * dart::math::makeSkewSymmetric(tip_point), R;
    for (int i = 0; i < 6; ++i) {
      skeleton->clearConstraintImpulses();
      skeleton->updateBiasImpulse(last, DenseTask::Six1::Unit(i));
      skeleton->updateVelocityChange();
      Omega_link.col(i) = last->getBodyVelocityChange();
    }
    task.Omega.noalias() = X * Omega_link * X.transpose();
    task.J = last->getWorldJacobian(tip_point);
    task.finish(state, answer);
  }

  void answer(const jury::Question& asked, jury::Answer& said) {
    const State state{asked.q, asked.qd, asked.tau};
    bench::Answer used;
    used.qdd.resize(asked.q.size());
    used.T.resize(asked.q.size());
    forward_dynamics(state, used);
    said.qdd = used.qdd;
    said.M = jury::by_rows(skeleton->getMassMatrix());
    said.C = jury::by_rows(skeleton->getCoriolisForces());
    said.G = jury::by_rows(skeleton->getGravityForces());
    said.J = jury::by_rows(last->getWorldJacobian(tip_point));
    said.Jdot_qd = jury::by_rows(Eigen::VectorXd(last->getJacobianClassicDeriv(tip_point) * qd));
    task_by_impulses(state, used);
    said.Omega = jury::by_rows(task.Omega);
  }

  int n;
  Eigen::Vector3d tip_point;
  dart::dynamics::SkeletonPtr skeleton;
  dart::dynamics::BodyNode* last = nullptr;
  Eigen::VectorXd q, qd, T, none;
  DenseTask task;
};

}  // namespace

extern "C" __attribute__((visibility("default"))) void add_routes(const Arm& arm,
                                                                  std::vector<Route>& routes) {
  const auto dart = std::make_shared<Dart>(arm);
  const auto read_Omega = [dart](double* out) { dart->task.read_Omega(out); };
  routes.push_back({"DART", "getMassMatrix, getCoriolisAndGravityForces, Jacobians, Cholesky", Call::task,
                    [dart](const State& s, Answer& a) { dart->task_dense(s, a); }, read_Omega});
  routes.push_back({"DART", "computeForwardDynamics, updateBiasImpulse, updateVelocityChange", Call::task,
                    [dart](const State& s, Answer& a) { dart->task_by_impulses(s, a); }, read_Omega});
  routes.push_back({"DART",
                    "computeForwardDynamics",
                    Call::forward_dynamics,
                    [dart](const State& s, Answer& a) { dart->forward_dynamics(s, a); },
                    {}});
}

extern "C" __attribute__((visibility("default"))) void make_engine(const Arm& arm, jury::Engine& engine) {
  const auto dart = std::make_shared<Dart>(arm);
  engine = {"DART", DART_VERSION,
            [dart](const jury::Question& asked, jury::Answer& said) { dart->answer(asked, said); }};
}

}  // namespace osculate::bench
