// DART: its own caches decide what a new state makes it compute again.
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <memory>
#include <string>

#include "benchmarks/dense_task.hpp"

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
      dart::dynamics::RevoluteJoint::Properties joint;
      joint.mName = "joint" + std::to_string(skeleton->getNumJoints());
      joint.mAxis = link.axis;
      joint.mT_ParentBodyToJoint.linear() = link.R_origin;
      joint.mT_ParentBodyToJoint.translation() = link.p_origin;
      dart::dynamics::BodyNode::AspectProperties body;
      body.mName = "link" + std::to_string(skeleton->getNumBodyNodes());
      const Eigen::Matrix3d& I = link.inertia;
      body.mInertia = dart::dynamics::Inertia(link.mass, link.com, I);
      last = skeleton
                 ->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(
                     last, joint, dart::dynamics::BodyNode::Properties(body))
                 .second;
    }
    skeleton->setGravity(arm.gravity);
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

}  // namespace osculate::bench
