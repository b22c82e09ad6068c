// Simbody: O(n) operators, and its dense matrices. C++17.
#include <Simbody.h>

#include <Eigen/Geometry>
#include <ctime>
#include <memory>

#include "benchmarks/anchor.hpp"
#include "benchmarks/dense_task.hpp"
#include "benchmarks/lists.hpp"

namespace osculate::bench {

namespace {

SimTK::Vec3 vec3(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

SimTK::Rotation rotation_of(const Eigen::Matrix3d& R) {
  return SimTK::Rotation(
      SimTK::Mat33(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
      true);  // as it is: orthogonal already
}

DenseTask::Six1 six(const SimTK::SpatialVec& v) {
  DenseTask::Six1 out;
  for (int i = 0; i < 3; ++i) out[i] = v[0][i], out[3 + i] = v[1][i];
  return out;
}

struct Simbody {
  explicit Simbody(const Arm& arm)
      : n(arm.n()),
        matter(system),
        gravity(vec3(arm.gravity)),
        tip_point(vec3(arm.p_tip)),
        T(n, 0.0),
        none(n, 0.0),
        udot(n, 0.0),
        columns(n, 6),
        solved(n, 6),
        task(n) {
    SimTK::MobilizedBody inboard = matter.Ground();
    for (const Arm::Link& link : arm.links) {
      const Eigen::Vector3d& r = link.com;
      const Eigen::Matrix3d I =
          link.inertia + link.mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
      const SimTK::MassProperties mass(link.mass, vec3(r),
                                       SimTK::Inertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
      // A pin turns about z of both joint frames, a slider moves along x.
      const Eigen::Vector3d along = link.slides ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
      const Eigen::Matrix3d A = Eigen::Quaterniond::FromTwoVectors(along, link.axis).toRotationMatrix();
      const SimTK::Transform inner(rotation_of(link.R_origin * A), vec3(link.p_origin)),
          outer(rotation_of(A));
      SimTK::MobilizedBody body;
      if (link.slides)
        body = SimTK::MobilizedBody::Slider(inboard, inner, SimTK::Body::Rigid(mass), outer);
      else
        body = SimTK::MobilizedBody::Pin(inboard, inner, SimTK::Body::Rigid(mass), outer);
      masses.push_back({body.getMobilizedBodyIndex(), vec3(r), link.mass * gravity});
      inboard = body;
    }
    last = inboard.getMobilizedBodyIndex();
    system.realizeTopology();
    state = system.getDefaultState();
    system.realize(state, SimTK::Stage::Instance);
  }

  /// Afterwards `weights` holds gravity on every body.
  void place(const State& given) {
    std::copy_n(given.q.data(), n, &state.updQ()[0]);
    std::copy_n(given.qd.data(), n, &state.updU()[0]);
    system.realize(state, SimTK::Stage::Dynamics);
    weigh(state);
  }

  void weigh(const SimTK::State& at) {
    weights.resize(matter.getNumBodies());
    weights.setToZero();
    for (const auto& [body, com, weight] : masses) matter.addInStationForce(at, body, com, weight, weights);
  }

  void forward_dynamics(const State& given, Answer& answer) {
    place(given);
    std::copy_n(given.T.data(), n, &T[0]);
    matter.calcAccelerationIgnoringConstraints(state, T, weights, udot, accelerations);
    std::copy_n(&udot[0], n, answer.qdd.data());
  }

  void task_by_operators(const State& given, Answer& answer) {
    place(given);
    for (int i = 0; i < 6; ++i) {
      SimTK::SpatialVec unit(SimTK::Vec3(0), SimTK::Vec3(0));
      unit[i / 3][i % 3] = 1;
      matter.multiplyByFrameJacobianTranspose(state, last, tip_point, unit, udot);
      std::copy_n(&udot[0], n, columns.col(i).data());
      matter.multiplyByMInv(state, udot, T);
      std::copy_n(&T[0], n, solved.col(i).data());
    }
    task.Omega.noalias() = columns.transpose() * solved;
    matter.calcAccelerationIgnoringConstraints(state, none, weights, udot, accelerations);
    const SimTK::MobilizedBody& body = matter.getMobilizedBody(last);
    const SimTK::SpatialVec& A = accelerations[last];
    const SimTK::Vec3 r = body.expressVectorInGroundFrame(state, tip_point);
    const SimTK::Vec3& w = body.getBodyAngularVelocity(state);
    task.free = six({A[0], A[1] + A[0] % r + w % (w % r)});
    task.force(given, answer);
    Eigen::Map<Eigen::VectorXd>(answer.T.data(), n).noalias() =
        columns * Eigen::Map<const DenseTask::Six1>(answer.F.data());
  }

  void task_dense(const State& given, Answer& answer) {
    place(given);
    solve_dense(state, given, answer);
  }

  /// The same where velocities are realized and `weights` known.
  void solve_dense(const SimTK::State& at, const State& given, Answer& answer) {
    matter.calcM(at, M);
    matter.calcResidualForceIgnoringConstraints(at, none, weights, none, udot);
    matter.calcFrameJacobian(at, last, tip_point, J);
    for (int j = 0; j < n; ++j) task.J.col(j) = six(J[j]);
    task.Jdot_qd = six(matter.calcBiasForFrameJacobian(at, last, tip_point));
    task.solve(Eigen::Map<const Eigen::MatrixXd>(&M(0, 0), n, n),
               Eigen::Map<const Eigen::VectorXd>(&udot[0], n), given, answer);
  }

  void answer(const jury::Question& asked, jury::Answer& said) {
    const State given{asked.q, asked.qd, asked.tau},
        at_rest{asked.q, std::vector<double>(asked.q.size()), {}};
    const auto list = [this](const SimTK::Vector& x) { return std::vector<double>(&x[0], &x[0] + n); };
    bench::Answer used;
    used.qdd.resize(asked.q.size());
    used.T.resize(asked.q.size());
    forward_dynamics(given, used);
    said.qdd = used.qdd;
    const SimTK::Vector_<SimTK::SpatialVec> weightless;
    matter.calcResidualForceIgnoringConstraints(state, none, weightless, none, udot);
    said.C = list(udot);
    task_by_operators(given, used);
    said.Omega = jury::by_rows(task.Omega);
    matter.calcM(state, M);
    said.M = jury::by_rows(Eigen::Map<const Eigen::MatrixXd>(&M(0, 0), n, n));
    matter.calcFrameJacobian(state, last, tip_point, J);
    Eigen::MatrixXd rows(6, n);
    for (int j = 0; j < n; ++j) rows.col(j) = six(J[j]);
    said.J = jury::by_rows(rows);
    said.Jdot_qd = jury::by_rows(six(matter.calcBiasForFrameJacobian(state, last, tip_point)));
    place(at_rest);
    matter.calcResidualForceIgnoringConstraints(state, none, weights, none, udot);
    said.G = list(udot);
  }

  struct Mass {
    SimTK::MobilizedBodyIndex body;
    SimTK::Vec3 com, weight;
  };

  int n;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::Vec3 gravity, tip_point;
  std::vector<Mass> masses;
  SimTK::MobilizedBodyIndex last;
  SimTK::State state;
  SimTK::Vector T, none, udot;
  SimTK::Vector_<SimTK::SpatialVec> weights, accelerations;
  SimTK::Matrix M;
  SimTK::RowVector_<SimTK::SpatialVec> J;
  Eigen::Matrix<double, Eigen::Dynamic, 6> columns, solved;
  DenseTask task;
};

/// The arm with its weight and the law as forces, which Simbody asks for at every evaluation.
struct ControlledSimbody : Simbody {
  explicit ControlledSimbody(const Anchor& given)
      : Simbody(given.arm),
        anchor(given),
        forces(system),
        answer{{}, {}, std::vector<double>(anchor.q.size())} {
    SimTK::Force::Gravity(forces, matter, gravity);
    SimTK::Force::Custom(forces, new Law(*this));  // the subsystem owns it
    system.realizeTopology();
    state = system.getDefaultState();
    std::copy_n(anchor.q.data(), n, &state.updQ()[0]);
  }

  struct Law : SimTK::Force::Custom::Implementation {
    explicit Law(ControlledSimbody& arm) : controlled(arm) {}
    void calcForce(const SimTK::State& at, SimTK::Vector_<SimTK::SpatialVec>&, SimTK::Vector_<SimTK::Vec3>&,
                   SimTK::Vector& torques) const override {
      controlled.control(at, torques);
    }
    SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0; }
    ControlledSimbody& controlled;
  };

  SimTK::Vec3 tip_position(const SimTK::State& at) const {
    return matter.getMobilizedBody(last).findStationLocationInGround(at, tip_point);
  }

  void control(const SimTK::State& at, SimTK::Vector& torques) {
    const SimTK::MobilizedBody& body = matter.getMobilizedBody(last);
    const SimTK::Mat33& axes = body.getBodyRotation(at).asMat33();
    Eigen::Matrix3d R;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R(i, j) = axes(i, j);
    const SimTK::Vec3 p = tip_position(at), v = body.findStationVelocityInGround(at, tip_point);
    command(anchor, at.getTime(), R * anchor.arm.R_tip, {p[0], p[1], p[2]},
            six({body.getBodyAngularVelocity(at), v}), asked);
    weigh(at);
    solve_dense(at, asked, answer);
    for (int i = 0; i < n; ++i) torques[i] += answer.T[static_cast<std::size_t>(i)];
    ++result.rhs;
  }

  /// Nothing is asked of it before the end unless somebody observes: each output costs it all forces.
  void run(double accuracy) {
    SimTK::CPodesIntegrator integrator(system, SimTK::CPodes::Adams, SimTK::CPodes::Functional);
    integrator.setAccuracy(accuracy);
    integrator.setInternalStepLimit(100000);  // it warns of every 500 otherwise
    SimTK::TimeStepper stepper(system, integrator);
    stepper.initialize(state);
    const long rows = anchor.observe ? std::lround(anchor.duration / anchor.interval) : 1;
    for (long row = 1; row <= rows; ++row) {
      stepper.stepTo(anchor.duration * static_cast<double>(row) / static_cast<double>(rows));
      const SimTK::State& at = stepper.getState();
      if (anchor.observe) anchor.observe(at.getTime(), &tip_position(at)[0]);
    }
    result.steps = integrator.getNumStepsTaken();
    result.failures = integrator.getNumErrorTestFailures();
  }

  const Anchor& anchor;
  SimTK::GeneralForceSubsystem forces;
  State asked;
  Answer answer;
  AnchorRun result;
};

}  // namespace

/// CPodesIntegrator: Adams with functional iteration, at an accuracy.
extern "C" __attribute__((visibility("default"))) void run_anchor(const Anchor& anchor, double accuracy,
                                                                  AnchorRun& result) {
  ControlledSimbody simbody(anchor);
  const std::clock_t start = std::clock();
  simbody.run(accuracy);
  result = simbody.result;
  result.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

extern "C" __attribute__((visibility("default"))) void add_routes(const Arm& arm,
                                                                  std::vector<Route>& routes) {
  const auto simbody = std::make_shared<Simbody>(arm);
  routes.push_back({"Simbody", "multiplyByFrameJacobianTranspose, multiplyByMInv, calcAcceleration",
                    Call::task, [simbody](const State& s, Answer& a) { simbody->task_by_operators(s, a); },
                    [simbody](double* out) { simbody->task.read_Omega(out); }});
  routes.push_back({"Simbody", "calcM, calcResidualForce, calcFrameJacobian, calcBias, Cholesky", Call::task,
                    [simbody](const State& s, Answer& a) { simbody->task_dense(s, a); },
                    [simbody](double* out) { simbody->task.read_Omega(out); }});
  routes.push_back({"Simbody",
                    "calcAccelerationIgnoringConstraints",
                    Call::forward_dynamics,
                    [simbody](const State& s, Answer& a) { simbody->forward_dynamics(s, a); },
                    {}});
}

extern "C" __attribute__((visibility("default"))) void make_engine(const Arm& arm, jury::Engine& engine) {
  const auto simbody = std::make_shared<Simbody>(arm);
  int major = 0, minor = 0, build = 0;
  SimTK_version_simbody(&major, &minor, &build);
  engine = {"Simbody", std::to_string(major) + "." + std::to_string(minor),
            [simbody](const jury::Question& asked, jury::Answer& said) { simbody->answer(asked, said); }};
}

}  // namespace osculate::bench
