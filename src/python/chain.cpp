// osculate.Chain: an arm from a URDF file and what it computes at given states.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <limits>

#include "control/law.hpp"
#include "experiment/arms.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "verification/state_terms.hpp"

namespace py = pybind11;

namespace osculate::python {

namespace {

/// Quantities that exist by recursion and by definition; as residuals, one number for each state.
struct Side {
  Array Omega, Lambda, c, g, F, T, qdd;
};

struct Terms {
  Array position, rotation, M, C, G, J, Jdot_qd;
  Side recursive, dense, residual;
  Array cond_Omega;
  py::array_t<int> rank;
};

using RowNames = std::optional<std::vector<std::string>>;

/// An arm of a URDF file with the states it is asked about.
class PythonChain {
 public:
  explicit PythonChain(ArmDescription arm, const py::object& armature) : arm_(std::move(arm)) {
    if (armature.is_none()) return;
    States states;
    const StateRows given =
        states.add(armature, "armature", chain().velocities(),
                   "kg m^2 or kg for each velocity coordinate, base to tip; 0 for joints of several axes");
    if (states.many()) throw py::value_error("armature has two axes: give one number for each joint");
    const std::vector<double> numbers(given[0].begin(), given[0].end());
    for (const double J : numbers)
      if (J < 0) throw py::value_error("armature has " + std::to_string(J) + ": give numbers >= 0");
    set_armature(arm_.chain, numbers);
  }

  const ArmDescription& arm() const { return arm_; }
  const Chain<double>& chain() const { return arm_.chain; }
  std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const auto& joint : arm_.joints) names.push_back(joint.name);
    return names;
  }

  std::pair<Array, Array> tip_pose(const py::object& q) const {
    States states;
    const StateRows at = q_of(states, q);
    Array p = states.result({3}), R = states.result({3, 3});
    {
      const py::gil_scoped_release released;
      for (std::size_t i = 0; i < states.count(); ++i) {
        const Pose tip = osculate::tip_pose(chain(), at[i]);
        set_entry(p, i, tip.p);
        set_entry(R, i, tip.R);
      }
    }
    return {p, R};
  }

  Array operational_space_torque(const py::object& q, const py::object& qd, const py::object& u,
                                 const RowNames& names, const py::object& T0) const {
    States states;
    const TaskRows rows = task_rows(names);
    const StateRows at = q_of(states, q), rates = qd_of(states, qd), command = u_of(states, u, rows);
    const StateRows others = states.add(T0, "T0", chain().velocities(), torque_meaning);
    Array T = states.result({chain().velocities()});
    double* const out = T.mutable_data();
    const py::gil_scoped_release released;
    require(states, at);
    operational_space_torques(chain(), states.count(), at, rates, command, rows, others, out);
    return T;
  }

  Array forward_dynamics(const py::object& q, const py::object& qd, const py::object& T,
                         const py::object& F_ext) const {
    States states;
    const StateRows at = q_of(states, q), rates = qd_of(states, qd);
    const StateRows torque = states.add(T, "T", chain().velocities(), torque_meaning);
    const StateRows push = states.add(
        F_ext, "F_ext", 6, "moment (N m) and force (N) on the tip, base frame, about the tip point");
    Array qdd = states.result({chain().velocities()});
    double* const out = qdd.mutable_data();
    const py::gil_scoped_release released;
    require(states, at);
    osculate::forward_dynamics(chain(), states.count(), at, rates, torque, push, out);
    return qdd;
  }

  Terms terms(const py::object& q, const py::object& qd, const py::object& u, const RowNames& names) const {
    require_simulable(arm_);
    States states;
    const TaskRows rows = task_rows(names);
    const StateRows at = q_of(states, q), rates = qd_of(states, qd), command = u_of(states, u, rows);
    const py::ssize_t n = chain().velocities(), m = static_cast<py::ssize_t>(rows.size());
    const auto array = [&states](std::vector<py::ssize_t> entry) { return states.result(entry); };
    const auto side = [&] {
      return Side{array({m, m}), array({m, m}), array({m}), array({m}), array({m}), array({n}), array({n})};
    };
    Terms out{
        array({3}),    array({3, 3}),
        array({n, n}), array({n}),
        array({n}),    array({m, n}),
        array({m}),    side(),
        side(),        Side{array({}), array({}), array({}), array({}), array({}), array({}), array({})},
        array({}),     states.result<int>({})};
    int* const rank = out.rank.mutable_data();
    const py::gil_scoped_release released;
    for (std::size_t i = 0; i < states.count(); ++i) {
      Vector6 wanted = Vector6::Zero();
      for (std::size_t k = 0; k < rows.size(); ++k) wanted[rows[k]] = command[i][k];
      require_articulated(chain(), arm_, at[i]);
      const StateTerms here = terms_at(chain(), at[i], rates[i], wanted, rows);
      write(out, i, here, rows);
      rank[i] = here.rank;
    }
    return out;
  }

 private:
  static constexpr const char* torque_meaning = "N m or N for each velocity coordinate, base to tip";
  StateRows q_of(States& states, const py::object& q) const {
    return states.add(q, "q", chain().positions(),
                      chain().one_axis_joints() ? "rad or m for each joint, base to tip"
                                                : "one number for each position coordinate, base to tip");
  }
  StateRows qd_of(States& states, const py::object& qd) const {
    return states.add(qd, "qd", chain().velocities(),
                      "rad/s or m/s for each velocity coordinate, base to tip");
  }
  static StateRows u_of(States& states, const py::object& u, const TaskRows& rows) {
    return states.add(u, "u", static_cast<int>(rows.size()),
                      "wanted acceleration of the tip on each task row, rad/s^2 and m/s^2");
  }
  /// At the first state: whether links have inertia enough is seldom a question of q.
  void require(const States& states, const StateRows& q) const {
    if (states.count() > 0) require_articulated(chain(), arm_, q[0]);
  }

  static void write(Terms& to, std::size_t i, const StateTerms& e, const TaskRows& rows) {
    const Evidence& v = e.evidence;
    set_entry(to.position, i, v.tip.p);
    set_entry(to.rotation, i, v.tip.R);
    set_entry(to.M, i, v.model.joint.M);
    set_entry(to.C, i, v.model.joint.C);
    set_entry(to.G, i, v.model.joint.G);
    set_entry(to.J, i, v.task.J);
    set_entry(to.Jdot_qd, i, v.task.Jdot_qd);
    to.cond_Omega.mutable_data()[i] = e.condition;
    const auto number = [](double x) { return MatrixX<double>::Constant(1, 1, x); };
    set_entry(to.recursive.Omega, i, v.recursive.Omega(rows, rows));
    set_entry(to.dense.Omega, i, v.task.Omega);
    set_entry(to.residual.Omega, i, number(e.residual(Claim::omega).value));
    if (!e.regular()) {
      for (Side* side : {&to.recursive, &to.dense, &to.residual})
        for (Array* a : {&side->Lambda, &side->c, &side->g, &side->F, &side->T, &side->qdd})
          fill(*a, i, to.rank.size());
      return;
    }
    const auto set = [i](Side& side, const auto& Lambda, const auto& c, const auto& g, const auto& F,
                         const auto& T, const auto& qdd) {
      set_entry(side.Lambda, i, Lambda);
      set_entry(side.c, i, c);
      set_entry(side.g, i, g);
      set_entry(side.F, i, F);
      set_entry(side.T, i, T);
      set_entry(side.qdd, i, qdd);
    };
    const auto [F, T, qdd] = dense_force(e);
    set(to.recursive, v.recursive.Lambda, v.recursive.c, v.recursive.g, v.F, v.T, v.qdd);
    set(to.dense, v.terms.Lambda, v.terms.c, v.terms.g, F, T, qdd);
    set(to.residual, number(e.residual(Claim::lambda).value), number(e.residual(Claim::c).value),
        number(e.residual(Claim::g).value), number(force_residual(v)),
        number(e.residual(Claim::torque).value), number(e.residual(Claim::forward_dynamics).value));
  }
  /// What does not exist is NaN.
  static void fill(Array& a, std::size_t state, py::ssize_t states) {
    const py::ssize_t size = a.size() / states;
    std::fill_n(a.mutable_data() + static_cast<py::ssize_t>(state) * size, size,
                std::numeric_limits<double>::quiet_NaN());
  }

  ArmDescription arm_;
};

ChainChoice choice(const std::string& tip, const std::string& base, const py::object& gravity,
                   const std::string& side_branches) {
  ChainChoice out;
  out.tip = tip;
  out.base = base;
  States states;
  const StateRows g = states.add(gravity, "gravity", 3, "m/s^2, acceleration of free fall, base frame");
  out.gravity = {g[0][0], g[0][1], g[0][2]};
  if (side_branches != "lump" && side_branches != "drop")
    throw py::value_error("side_branches is '" + side_branches + "': choose 'lump' or 'drop'");
  out.side_branches = side_branches == "drop" ? SideBranches::drop : SideBranches::lump;
  return out;
}

}  // namespace

const Chain<double>& chain_of(const py::object& chain) { return chain.cast<const PythonChain&>().chain(); }

TaskRows task_rows(const RowNames& names) {
  if (!names) return all_rows();
  TaskRows rows;
  for (const auto& name : *names) {
    const auto found = std::find(task_row_names.begin(), task_row_names.end(), name);
    if (found == task_row_names.end())
      throw py::value_error("rows: '" + name + "' is no task row: choose from wx, wy, wz, vx, vy, vz");
    const int row = static_cast<int>(found - task_row_names.begin());
    if (std::find(rows.begin(), rows.end(), row) != rows.end())
      throw py::value_error("rows: '" + name + "' is given twice");
    rows.push_back(row);
  }
  if (rows.empty()) throw py::value_error("rows is empty: give at least one of wx, wy, wz, vx, vy, vz");
  return rows;
}

void bind_chain(py::module_& module) {
  using namespace py::literals;
  const py::tuple gravity = py::make_tuple(0, 0, -9.80665);

  py::class_<Side>(module, "TermSide", R"(Terms by one of the two sides, or their residuals.

m: task rows, n: velocity coordinates; all with a first axis N where many states were given. As residuals, one
number for each state. Where Omega has not full rank, all but Omega is NaN.)")
      .def_readonly("Omega", &Side::Omega, "(m, m): J M^-1 J^T, 1/(kg m^2), 1/(kg m), 1/kg")
      .def_readonly("Lambda", &Side::Lambda, "(m, m): Omega^-1, the operational-space inertia")
      .def_readonly("c", &Side::c, "(m,): N m, N: Coriolis and centrifugal")
      .def_readonly("g", &Side::g, "(m,): N m, N: gravity")
      .def_readonly("F", &Side::F, "(m,): Lambda u + c + g, N m, N")
      .def_readonly("T", &Side::T, "(n,): J^T F, N m or N, base to tip")
      .def_readonly("qdd", &Side::qdd, "(n,): acceleration under T, rad/s^2 or m/s^2");

  py::class_<Terms>(module, "Terms", R"(The terms of an arm at one state or at N states, both ways.

Base frame, about the tip point, angular rows first; joints base to tip; SI units and radians.)")
      .def_readonly("position", &Terms::position, "(3,): tip point, m, base frame")
      .def_readonly("rotation", &Terms::rotation, "(3, 3): tip axes in the base frame, as columns")
      .def_readonly("M", &Terms::M, "(n, n): mass matrix, armature included, kg m^2 or kg")
      .def_readonly("C", &Terms::C, "(n,): vector C(q, qd) of equation (6), N m or N")
      .def_readonly("G", &Terms::G, "(n,): gravity vector, N m or N")
      .def_readonly("J", &Terms::J, "(m, n): Jacobian of the tip, chosen rows")
      .def_readonly("Jdot_qd", &Terms::Jdot_qd, "(m,): rad/s^2, m/s^2")
      .def_readonly("recursive", &Terms::recursive, "by the paper's recursions, O(n)")
      .def_readonly("dense", &Terms::dense, "by the definitions, O(n^3)")
      .def_readonly("residual", &Terms::residual, "relative differences of the two")
      .def_readonly("cond_Omega", &Terms::cond_Omega, "condition of Omega scaled to unit diagonal")
      .def_readonly("rank", &Terms::rank, "of Omega; below m only Omega exists");

  py::class_<PythonChain>(module, "Chain", R"(A serial arm of a URDF file, between its links base and tip.

q: (positions,) or (N, positions); qd, T: (velocities,) or (N, velocities), joints base to tip, rad or m. An
argument of one state stands for all N. Any real dtype and memory order; results are new float64 arrays. Base frame,
about the tip point, six-vectors angular part first. Objects never change: threads may share them.)")
      .def(py::init([](const std::filesystem::path& urdf, const std::string& tip, const std::string& base,
                       const py::object& g, const py::object& armature, const std::string& side_branches) {
             return PythonChain(load_urdf(urdf, choice(tip, base, g, side_branches)), armature);
           }),
           "urdf"_a, "tip"_a, "base"_a = "", py::kw_only(), "gravity"_a = gravity, "armature"_a = py::none(),
           "side_branches"_a = "lump",
           R"(Reads a URDF file.

base: a link, "" for the root. gravity: (3,) m/s^2, acceleration of free fall, base frame. armature: (velocities,)
reflected motor inertia, kg m^2 or kg. side_branches: "lump" or "drop". Raises ModelError.)")
      .def_static(
          "from_text",
          [](const std::string& text, const std::string& tip, const std::string& base, const py::object& g,
             const py::object& armature, const std::string& side_branches) {
            return PythonChain(parse_urdf(text, "text", choice(tip, base, g, side_branches)), armature);
          },
          "text"_a, "tip"_a, "base"_a = "", py::kw_only(), "gravity"_a = gravity, "armature"_a = py::none(),
          "side_branches"_a = "lump", "The same from the text of a URDF file.")
      .def_property_readonly(
          "robot", [](const PythonChain& c) { return c.arm().robot; }, "name in the file")
      .def_property_readonly(
          "base", [](const PythonChain& c) { return c.arm().base; }, "base link")
      .def_property_readonly(
          "tip", [](const PythonChain& c) { return c.arm().tip; }, "tip link")
      .def_property_readonly("joints", &PythonChain::joint_names, "names of the moving joints, base to tip")
      .def_property_readonly(
          "positions", [](const PythonChain& c) { return c.chain().positions(); },
          "number of position coordinates")
      .def_property_readonly(
          "velocities", [](const PythonChain& c) { return c.chain().velocities(); },
          "number of velocity coordinates: the degrees of freedom")
      .def_property_readonly(
          "gravity", [](const PythonChain& c) { return array_of(c.chain().gravity); },
          "(3,): m/s^2, base frame")
      .def_property_readonly(
          "warnings", [](const PythonChain& c) { return c.arm().warnings; }, "what reading the file found")
      .def("tip_pose", &PythonChain::tip_pose, "q"_a,
           "(position, rotation) of the tip in the base frame: (3,) m and (3, 3), or (N, 3) and (N, 3, 3).")
      .def("terms", &PythonChain::terms, "q"_a, "qd"_a = py::none(), "u"_a = py::none(), py::kw_only(),
           "rows"_a = py::none(),
           R"(Every term at the states, by recursion and by definition, with their differences.

u: (m,) or (N, m) wanted tip acceleration, rad/s^2 and m/s^2. rows: names of the m task rows, for instance
["vx", "vy", "vz"]; default all six. qd, u: default 0. Raises ModelError where the articulated inertia about a
joint is not positive.)")
      .def("operational_space_torque", &PythonChain::operational_space_torque, "q"_a, "qd"_a, "u"_a,
           py::kw_only(), "rows"_a = py::none(), "T0"_a = py::none(),
           R"(Joint torques that give the tip the acceleration u, by four sweeps: T = J^T (Lambda u + c + g).

u: (m,) or (N, m), rad/s^2 and m/s^2; rows as of terms(). T0: further joint torques that shall not move the tip, for
redundant arms: they are added, and what they would do to it is taken off. Returns (velocities,) or (N, velocities), N m
or N. Raises SingularArm.)")
      .def("forward_dynamics", &PythonChain::forward_dynamics, "q"_a, "qd"_a, "T"_a, "F_ext"_a = py::none(),
           R"(Joint accelerations under the torques T and a wrench F_ext on the tip, by the O(n) recursion.

F_ext: (6,) or (N, 6), N m and N, base frame, about the tip point. Returns rad/s^2 or m/s^2. T: without friction.)")
      .def("__repr__", [](const PythonChain& c) {
        return "<osculate.Chain " + c.arm().robot + ": " + c.arm().base + " to " + c.arm().tip + ", " +
               std::to_string(c.chain().n()) + " joints>";
      });
}

}  // namespace osculate::python
