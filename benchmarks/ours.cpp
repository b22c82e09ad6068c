#include "benchmarks/ours.hpp"

#include <memory>

#include "model/urdf.hpp"
#include "reference/dense.hpp"
#include "simulation/closed_loop.hpp"

namespace osculate::bench {

namespace {

struct Recursions {
  explicit Recursions(const Chain<double>& c) : space(c), plant(c) {}

  void forward_dynamics(const State& state, Answer& answer) {
    plant.place(state.q);
    plant.accelerations(state.qd, state.T, {}, answer.qdd);
  }

  /// sweep(): those before the solve.
  template <class Sweep>
  void task(const State& state, Answer& answer, const Sweep& sweep) {
    space.place(state.q);
    sweep();
    const auto& u = state.u;
    const Vec<Motion, double> right =
        space.right_side() + Vec<Motion, double>{{u[0], u[1], u[2]}, {u[3], u[4], u[5]}};
    const Vec<Force, double> F = TaskFactor<double>(space.Omega(), rows).solve(right);  // (65)
    answer.F = {F.ang.x, F.ang.y, F.ang.z, F.lin.x, F.lin.y, F.lin.z};
    space.torques(F, answer.T);
  }

  void read_Omega(double* out) const {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) *out++ = component(space.Omega(), i, j);
  }

  const TaskRows rows = all_rows();
  OperationalSpace<double> space;
  ForwardDynamics<double> plant;
};

VectorX<double> vector_of(const std::vector<double>& list) {
  return Eigen::Map<const VectorX<double>>(list.data(), static_cast<Eigen::Index>(list.size()));
}

}  // namespace

void add_recursions(const Chain<double>& chain, std::vector<Route>& routes) {
  const auto ours = std::make_shared<Recursions>(chain);
  routes.push_back({"ours", "four sweeps", Call::task,
                    [ours](const State& s, Answer& a) { ours->task(s, a, [&] { ours->space.sweep(s.qd); }); },
                    [ours](double* out) { ours->read_Omega(out); }});
  routes.push_back({"ours",
                    "sweeps 1, 2, accelerations",
                    Call::forward_dynamics,
                    [ours](const State& s, Answer& a) { ours->forward_dynamics(s, a); },
                    {}});
}

void add_column_form(const Chain<double>& chain, std::vector<Route>& routes) {
  const auto ours = std::make_shared<Recursions>(chain);
  routes.push_back(
      {"ours", "columns for sweep 3", Call::task,
       [ours](const State& s, Answer& a) { ours->task(s, a, [&] { ours->space.sweep_from_tip(s.qd); }); },
       [ours](double* out) { ours->read_Omega(out); }});
}

void add_dense(const Chain<double>& chain, std::vector<Route>& routes) {
  const auto Omega = std::make_shared<MatrixX<double>>();
  routes.push_back(
      {"ours", "dense side", Call::task,
       [&chain, Omega](const State& s, Answer& a) {
         const auto joints = positions<double>(chain, s.q);
         const auto state = dense::state(chain, joints, vector_of(s.qd));
         const auto mobility = dense::mobility(state.tip, state.joint);
         const auto terms = dense::task_terms(mobility);
         const VectorX<double> u = Eigen::Map<const VectorX<double>>(s.u.data(), 6);
         const auto force = dense::task_force(mobility, terms, u);
         std::copy_n(force.F.data(), 6, a.F.data());
         std::copy_n(force.T.data(), force.T.size(), a.T.data());
         *Omega = mobility.Omega;
       },
       [Omega](double* out) { Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{out} = *Omega; }});
  routes.push_back({"ours",
                    "dense side",
                    Call::forward_dynamics,
                    [&chain](const State& s, Answer& a) {
                      const auto joints = positions<double>(chain, s.q);
                      const auto state = dense::state(chain, joints, vector_of(s.qd));
                      const auto qdd = dense::forward_dynamics(state.joint, state.tip.J, vector_of(s.T));
                      std::copy_n(qdd.data(), qdd.size(), a.qdd.data());
                    },
                    {}});
}

std::function<void()> puma560_right_side() {
  ChainChoice choice;
  choice.tip = "tool0";
  const Chain<double> chain = load_urdf(OSCULATE_SOURCE_DIR "/models/puma560.urdf", choice).chain;
  const std::vector<double> q{0.1, -0.8, 0.4, 0.2, 0.9, 0.3}, qd{0.1, 0.2, -0.3, 0.4, 0.5, -0.6};
  const auto loop = std::make_shared<ClosedLoop>(
      Controller(chain, {}, LawOptions{}, make_path(CircleOptions{}), tip_pose(chain, q)),
      Plant{chain, {}, Vector6::Zero()});
  std::vector<double> y(loop->states(), 0.0), yd(loop->states());
  std::copy(q.begin(), q.end(), y.begin());
  std::copy(qd.begin(), qd.end(), y.begin() + 6);
  return [loop, y, yd]() mutable { loop->right_side(0.3, y.data(), yd.data()); };
}

}  // namespace osculate::bench
