// osculate.judge: which terms of the exact law a logged torque lacks.
#include "judge/judge.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "python/bindings.hpp"

namespace py = pybind11;

namespace osculate::python {

namespace {

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

MatrixX<double> matrix(const Rows& array, const char* name, py::ssize_t samples, py::ssize_t columns,
                       py::ssize_t or_columns = -1) {
  const bool fits = array.ndim() == 2 && array.shape(0) == samples &&
                    (array.shape(1) == columns || array.shape(1) == or_columns);
  if (!fits) {
    std::string shape;
    for (py::ssize_t i = 0; i < array.ndim(); ++i) shape += (i ? ", " : "") + std::to_string(array.shape(i));
    throw py::value_error(std::string(name) + " has shape (" + shape + "): give (" + std::to_string(samples) +
                          ", " + std::to_string(columns) + "), one row for each sample");
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(array.data(), array.shape(0), array.shape(1));
}

using Six = std::array<double, 6>;

template <class Choice>
std::optional<Choice> chosen(const std::optional<std::string>& name, const char* argument, const char* first,
                             const char* second) {
  if (!name) return std::nullopt;
  if (*name == first) return Choice{0};
  if (*name == second) return Choice{1};
  throw py::value_error(std::string(argument) + " is '" + *name + "': choose '" + first + "', '" + second +
                        "' or None");
}

Judgement judge_arrays(const py::object& chain, const Rows& t, const Rows& q, const Rows& qd, const Rows& tau,
                       const std::optional<Rows>& u, const std::optional<std::array<Rows, 4>>& reference,
                       const std::optional<std::pair<Six, Six>>& gains,
                       const std::optional<std::vector<std::string>>& rows,
                       const std::optional<std::vector<double>>& viscous,
                       const std::optional<std::string>& u_order,
                       const std::optional<std::string>& quaternion, const std::string& acceleration,
                       Eigen::Index samples) {
  const Chain<double>& model = chain_of(chain);
  if (t.ndim() != 1) throw py::value_error("t has more than one axis: give one instant for each sample, s");
  const py::ssize_t N = t.shape(0), n = model.velocities();
  JudgeOptions options;
  options.rows = task_rows(rows);
  options.samples = samples;
  if (viscous) {
    if (static_cast<py::ssize_t>(viscous->size()) != n)
      throw py::value_error("viscous has " + std::to_string(viscous->size()) + " numbers: give " +
                            std::to_string(n) + ", one for each velocity coordinate");
    for (const double b : *viscous) options.friction.push_back({b, 0, 0, 1e-2});
  }
  if (gains) {
    options.gains.emplace();
    for (int i = 0; i < 6; ++i) {
      options.gains->stiffness[i] = gains->first[static_cast<std::size_t>(i)];
      options.gains->damping[i] = gains->second[static_cast<std::size_t>(i)];
    }
  }
  options.u_order = chosen<RowOrder>(u_order, "u_order", "angular", "linear");
  options.quaternion_order = chosen<QuaternionOrder>(quaternion, "quaternion", "wxyz", "xyzw");
  options.acceleration = chosen<Acceleration>(acceleration, "acceleration", "classical", "spatial")
                             .value_or(Acceleration::classical);
  Log log;
  log.source = "log";
  log.t.assign(t.data(), t.data() + N);
  log.q = matrix(q, "q", N, model.positions());
  log.qd = matrix(qd, "qd", N, n);
  log.tau = matrix(tau, "tau", N, n);
  if (u.has_value() == reference.has_value())
    throw py::value_error("give either u or reference: without them any torque could be right");
  if (u) log.u = matrix(*u, "u", N, 6, static_cast<py::ssize_t>(options.rows.size()));
  if (reference)
    log.reference = {
        matrix((*reference)[0], "reference[0]", N, 3), matrix((*reference)[1], "reference[1]", N, 4),
        matrix((*reference)[2], "reference[2]", N, 6), matrix((*reference)[3], "reference[3]", N, 6)};
  check(log);
  const py::gil_scoped_release released;
  return judge(model, log, options);
}

std::string ruling_name(const Judgement& j) {
  constexpr const char* names[] = {"right", "wrong", "unexplained"};
  return names[static_cast<int>(j.ruling)];
}

}  // namespace

void bind_judge(py::module_& module) {
  using namespace py::literals;
  py::class_<Coefficient>(module, "Coefficient", "A number of a finding, with its uncertainty.")
      .def_readonly("name", &Coefficient::name, "what it is of")
      .def_readonly("unit", &Coefficient::unit, "its unit; 1 for a share of a term")
      .def_readonly("value", &Coefficient::value, "-1 for a term that is omitted")
      .def_readonly("deviation", &Coefficient::deviation, "one standard deviation");
  py::class_<Finding>(module, "Finding", "One explanation of the difference, or of a part of it.")
      .def_readonly("term", &Finding::term, "id: docs/judge.md")
      .def_readonly("sentence", &Finding::sentence, "the same in words")
      .def_readonly("coefficients", &Finding::coefficients, "its numbers")
      .def_readonly("explained", &Finding::explained, "part of the difference, in sums of squares");
  py::class_<Doubt>(module, "Doubt", "Another explanation that fits as well.")
      .def_readonly("terms", &Doubt::terms, "what it has in place of findings")
      .def_readonly("sentence", &Doubt::sentence, "the same in words, with a motion that would decide");
  py::class_<Judgement>(module, "Judgement", "What judge() found.")
      .def_property_readonly("ruling", &ruling_name, "'right', 'wrong' or 'unexplained'")
      .def_readonly("findings", &Judgement::findings, "largest share first")
      .def_readonly("doubts", &Judgement::doubts, "where the log cannot decide")
      .def_readonly("null_space", &Judgement::null_space, "torques that do not move the tip")
      .def_readonly("gains", &Judgement::gains, "found, where they were not given")
      .def_readonly("conventions", &Judgement::conventions, "how the log was read where nobody said")
      .def_readonly("unseen", &Judgement::unseen, "terms whose lack the log would not show")
      .def_readonly("difference", &Judgement::difference, "rms of tau minus the exact torque, N m or N")
      .def_readonly("noise", &Judgement::noise, "rms of the log's noise in it, N m or N")
      .def_readonly("rest", &Judgement::rest, "part that nothing explains, in sums of squares")
      .def_readonly("samples", &Judgement::samples, "used")
      .def_readonly("left_out", &Judgement::left_out, "singular or saturated")
      .def_property_readonly(
          "report", [](const Judgement& j) { return report(j, "log"); }, "the judgement in words");
  module.def("judge", &judge_arrays, "chain"_a, "t"_a, "q"_a, "qd"_a, "tau"_a, "u"_a = py::none(),
             "reference"_a = py::none(), py::kw_only(), "gains"_a = py::none(), "rows"_a = py::none(),
             "viscous"_a = py::none(), "u_order"_a = "angular", "quaternion"_a = "wxyz",
             "acceleration"_a = "classical", "samples"_a = 500,
             R"(Which terms of the exact law a logged torque lacks.

t: (N,) s, increasing. q: (N, positions), qd, tau: (N, velocities), joints base to tip. u: (N, 6) or (N, task rows),
commanded tip acceleration; or reference: position (N, 3), quaternion (N, 4), velocity (N, 6), acceleration (N, 6),
base frame, angular part first. gains: stiffness and damping (6,) each, with a reference; None: they are found.
viscous: (velocities,), friction that the exact law compensates, N m s/rad or N s/m. u_order: 'angular' or 'linear'
rows first; quaternion: 'wxyz' or 'xyzw'; None: recognised. acceleration: of u, 'classical' or 'spatial'. samples:
used for the fit. Raises LogError where the log cannot decide how it is to be read.)");
}

}  // namespace osculate::python
