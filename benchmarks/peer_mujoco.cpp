// MuJoCo: the parts of mj_forward that rigid-body dynamics needs, without contacts, constraints and sensors.
// The arm is handed over as URDF: nested elements would end at 100 links.
#include <mujoco/mujoco.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cstring>
#include <ctime>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "benchmarks/anchor.hpp"
#include "benchmarks/dense_task.hpp"
#include "benchmarks/lists.hpp"

namespace osculate::bench {

namespace {

std::string triple(const Eigen::Vector3d& v) {
  std::ostringstream out;
  out.precision(17);
  out << v[0] << ' ' << v[1] << ' ' << v[2];
  return out.str();
}

/// Angles r p y with R = Rz(y) Ry(p) Rx(r).
Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) {
  const double c = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), c);
  if (c < 1e-12) return {std::atan2(-R(1, 2), R(1, 1)), pitch, 0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

std::string urdf(const Arm& arm) {
  std::ostringstream out;
  out.precision(17);
  out << "<robot name='arm'><mujoco><compiler fusestatic='false' balanceinertia='false' boundmass='0' "
         "boundinertia='0'/></mujoco><link name='link'/>";
  std::string inboard = "link";
  for (std::size_t i = 0; i < arm.links.size(); ++i) {
    const Arm::Link& link = arm.links[i];
    const std::string name = "link" + std::to_string(i);
    // Principal axes by us: its own reach only about 1e-8.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(link.inertia);
    Eigen::Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    const Eigen::Vector3d& I = principal.eigenvalues();
    out << "<joint name='joint" << i << "' type='" << (link.slides ? "prismatic" : "continuous")
        << "'><parent link='" << inboard << "'/><child link='" << name << "'/><origin xyz='"
        << triple(link.p_origin) << "' rpy='" << triple(roll_pitch_yaw(link.R_origin)) << "'/><axis xyz='"
        << triple(link.axis) << "'/></joint>"
        << "<link name='" << name << "'><inertial><origin xyz='" << triple(link.com) << "' rpy='"
        << triple(roll_pitch_yaw(axes)) << "'/><mass value='" << link.mass << "'/><inertia ixx='" << I[0]
        << "' iyy='" << I[1] << "' izz='" << I[2] << "' ixy='0' ixz='0' iyz='0'/></inertial></link>";
    inboard = name;
  }
  out << "</robot>";
  return out.str();
}

struct ModelDeleter {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct DataDeleter {
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using Model = std::unique_ptr<mjModel, ModelDeleter>;
using Data = std::unique_ptr<mjData, DataDeleter>;

Model load(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "arm.urdf", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char error[1000] = "";
  Model model(mj_loadXML("arm.urdf", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

struct Mujoco {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;

  explicit Mujoco(const Arm& arm)
      : tip_point(arm.p_tip),
        gravity(arm.gravity),
        model(load(urdf(arm))),
        n(arm.n()),
        body(model->nbody - 1),
        J(6, n),
        Y(6, n),
        x(n),
        task(n) {
    if (model->nv != n) throw std::runtime_error("MuJoCo: the arm has other joints");
    for (int i = 0; i < 3; ++i) model->opt.gravity[i] = gravity[i];
    data.reset(mj_makeData(model.get()));
  }

  /// Afterwards M is factored and qfrc_bias = C + G.
  void place(const State& state) {
    const mjModel* m = model.get();
    mjData* d = data.get();
    mju_copy(d->qpos, state.q.data(), n);
    mju_copy(d->qvel, state.qd.data(), n);
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_crb(m, d);
    mj_factorM(m, d);
    mj_comVel(m, d);
    mj_rne(m, d, 0, d->qfrc_bias);
  }

  void forward_dynamics(const State& state, Answer& answer) {
    place(state);
    mju_sub(x.data(), state.T.data(), data->qfrc_bias, n);
    mj_solveM(model.get(), data.get(), answer.qdd.data(), x.data(), 1);
  }

  /// Of the tip, which lies at r from its body's origin, under data->qacc; a weight counts as a rise.
  DenseTask::Six1 tip_acceleration(const Eigen::Vector3d& r) {
    mj_rnePostConstraint(model.get(), data.get());
    double at_origin[6], velocity[6];
    mj_objectAcceleration(model.get(), data.get(), mjOBJ_XBODY, body, at_origin, 0);
    mj_objectVelocity(model.get(), data.get(), mjOBJ_XBODY, body, velocity, 0);
    const Eigen::Map<const Eigen::Vector3d> wd(at_origin), vd(at_origin + 3), w(velocity);
    DenseTask::Six1 out;
    out << wd, vd + wd.cross(r) + w.cross(w.cross(r));
    return out;
  }

  void solve_task(const State& state, Answer& answer) {
    place(state);
    solve_placed(state, answer);
  }

  /// The same where M is factored and qfrc_bias = C + G.
  void solve_placed(const State& state, Answer& answer) {
    const mjModel* m = model.get();
    mjData* d = data.get();
    Eigen::Vector3d tip;
    mju_mulMatVec(tip.data(), d->xmat + 9 * body, tip_point.data(), 3, 3);
    const Eigen::Vector3d r = tip;
    mju_addTo3(tip.data(), d->xpos + 3 * body);
    mj_jac(m, d, J.data() + 3 * n, J.data(), tip.data(), body);
    // The free acceleration of the tip: all bodies' accelerations at qdd = - M^-1 (C + G).
    mju_scl(x.data(), d->qfrc_bias, -1, n);
    mj_solveM(m, d, d->qacc, x.data(), 1);
    task.free = tip_acceleration(r);
    task.free.tail<3>() += gravity;
    mj_solveM2(m, d, Y.data(), J.data(), 6);  // J by the square root of M^-1
    task.Omega.noalias() = Y * Y.transpose();
    task.force(state, answer);
    Eigen::Map<Eigen::VectorXd>(answer.T.data(), n).noalias() =
        J.transpose() * Eigen::Map<const DenseTask::Six1>(answer.F.data());
  }

  void answer(const jury::Question& asked, jury::Answer& said) {
    const mjModel* m = model.get();
    mjData* d = data.get();
    bench::Answer used;
    used.qdd.resize(asked.q.size());
    used.T.resize(asked.q.size());
    const State state{asked.q, asked.qd, asked.tau};
    forward_dynamics(state, used);
    said.qdd = used.qdd;
    said.M.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    mj_fullM(m, said.M.data(), d->qM);
    solve_task(state, used);
    said.Omega = jury::by_rows(task.Omega);
    said.J = jury::by_rows(J);
    place({asked.q, std::vector<double>(asked.q.size()), {}});
    said.G.assign(d->qfrc_bias, d->qfrc_bias + n);
    // Without weight: C, and the accelerations of the bodies while no joint accelerates.
    mju_zero3(model->opt.gravity);
    place(state);
    said.C.assign(d->qfrc_bias, d->qfrc_bias + n);
    mju_zero(d->qacc, n);
    Eigen::Vector3d r;
    mju_mulMatVec(r.data(), d->xmat + 9 * body, tip_point.data(), 3, 3);
    said.Jdot_qd = jury::by_rows(tip_acceleration(r));
    for (int i = 0; i < 3; ++i) model->opt.gravity[i] = gravity[i];
  }

  Eigen::Vector3d tip_point, gravity;
  Model model;
  Data data;
  int n, body;
  Rows J, Y;
  Eigen::VectorXd x;
  DenseTask task;
};

/// The law inside mj_step: MuJoCo calls it at every stage, when the stage's M is factored and its bias known.
struct ControlledMujoco : Mujoco {
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  ControlledMujoco(const Anchor& given, double steps)
      : Mujoco(given.arm), anchor(given), count(std::lround(steps)), answer{{}, {}, std::vector<double>(n)} {
    model->opt.integrator = mjINT_RK4;
    model->opt.timestep = anchor.duration / static_cast<double>(count);
    mju_copy(data->qpos, anchor.q.data(), n);
    acting = this;
    mjcb_control = [](const mjModel*, mjData*) { acting->control(); };
  }
  ~ControlledMujoco() { mjcb_control = nullptr; }

  Eigen::Vector3d tip_position() const {
    Eigen::Vector3d p;
    mju_mulMatVec(p.data(), data->xmat + 9 * body, tip_point.data(), 3, 3);
    mju_addTo3(p.data(), data->xpos + 3 * body);
    return p;
  }

  void control() {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 9 * body);
    const Eigen::Vector3d p = tip_position();
    mj_jac(model.get(), data.get(), J.data() + 3 * n, J.data(), p.data(), body);
    const Vector6 V = J * Eigen::Map<const Eigen::VectorXd>(data->qvel, n);
    command(anchor, data->time, R * anchor.arm.R_tip, p, V, state);
    solve_placed(state, answer);
    mju_copy(data->qfrc_applied, answer.T.data(), n);
    ++result.rhs;
  }

  void run() {
    for (long i = 0; i < count; ++i) {
      mj_step(model.get(), data.get());
      if (anchor.observe) {
        mj_kinematics(model.get(), data.get());
        anchor.observe(data->time, tip_position().data());
      }
    }
    result.steps = count;
  }

  static ControlledMujoco* acting;  // the callback takes no data of ours
  const Anchor& anchor;
  long count;
  State state;
  Answer answer;
  AnchorRun result;
};
ControlledMujoco* ControlledMujoco::acting = nullptr;

}  // namespace

/// Fixed steps of mjINT_RK4; `steps` of them.
extern "C" __attribute__((visibility("default"))) void run_anchor(const Anchor& anchor, double steps,
                                                                  AnchorRun& result) {
  ControlledMujoco mujoco(anchor, steps);
  const std::clock_t start = std::clock();
  mujoco.run();
  result = mujoco.result;
  result.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

extern "C" __attribute__((visibility("default"))) void add_routes(const Arm& arm,
                                                                  std::vector<Route>& routes) {
  const auto mujoco = std::make_shared<Mujoco>(arm);
  routes.push_back({"MuJoCo", "mj_crb, mj_rne, mj_jac, mj_solveM2, mj_rnePostConstraint", Call::task,
                    [mujoco](const State& s, Answer& a) { mujoco->solve_task(s, a); },
                    [mujoco](double* out) { mujoco->task.read_Omega(out); }});
  routes.push_back({"MuJoCo",
                    "mj_crb, mj_rne, mj_solveM",
                    Call::forward_dynamics,
                    [mujoco](const State& s, Answer& a) { mujoco->forward_dynamics(s, a); },
                    {}});
}

extern "C" __attribute__((visibility("default"))) void make_engine(const Arm& arm, jury::Engine& engine) {
  const auto mujoco = std::make_shared<Mujoco>(arm);
  engine = {"MuJoCo", mj_versionString(),
            [mujoco](const jury::Question& asked, jury::Answer& said) { mujoco->answer(asked, said); }};
}

}  // namespace osculate::bench
