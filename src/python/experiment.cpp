// osculate.Experiment: an experiment file or text, checked or run, and the verdict of the run.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <csignal>
#include <limits>

#include "experiment/run.hpp"
#include "python/bindings.hpp"

namespace py = pybind11;

namespace osculate::python {

namespace {

struct Claim {
  std::string id, equation, compared_with, result, reason;
  double worst, bound, at_time;
  long undecided_steps, checked_steps;
};

struct Run {
  std::string name, status, verdict, message, report;
  int exit_code;
  std::optional<std::filesystem::path> output;
  std::vector<Claim> claims;
  double end_time;
  long steps;
  std::vector<std::string> warnings;
};

/// {"key.path": value} as the program's --set takes it; JSON is YAML on one line.
std::vector<std::string> settings(const py::dict& overrides) {
  const py::object dumps = py::module_::import("json").attr("dumps");
  std::vector<std::string> out;
  for (const auto& [key, value] : overrides)
    out.push_back(py::str(key).cast<std::string>() + "=" + dumps(value).cast<std::string>());
  return out;
}

Claim claim_row(const ClaimInfo& info, const ClaimResult& r) {
  const bool applies = r.outcome != Outcome::not_applicable;
  const auto number = [applies](double x) { return applies ? x : std::numeric_limits<double>::quiet_NaN(); };
  return {std::string(info.id),
          std::string(info.equation),
          std::string(info.compared_with),
          !applies                     ? "not_applicable"
          : r.outcome == Outcome::pass ? "pass"
                                       : "fail",
          r.reason,
          number(r.worst.value),
          number(r.worst.bound),
          number(r.at_time),
          r.undecided_steps,
          r.checked_steps};
}

/// Runs without Python's lock. Ctrl-C finishes the file properly and then raises KeyboardInterrupt.
Run run_one(const Experiment& experiment, const std::optional<std::filesystem::path>& output, bool force) {
  RunOptions options;
  options.output = output;
  options.force = force;
  options.command = "osculate.Experiment.run";
  volatile std::sig_atomic_t signal = 0;
  std::optional<py::error_already_set> raised;
  options.signal = &signal;
  options.progress = [&](double, double, double) {
    const py::gil_scoped_acquire held;
    if (!raised && PyErr_CheckSignals() != 0) {
      raised.emplace();
      signal = SIGINT;
    }
  };
  RunResult result;
  {
    const py::gil_scoped_release released;
    result = run(experiment, options);
  }
  if (raised) throw *raised;
  Run out{experiment.name,
          result.status,
          result.verdict,
          result.message,
          report(experiment, result),
          static_cast<int>(result.exit),
          output,
          {},
          result.end_time,
          result.steps,
          result.warnings};
  for (std::size_t i = 0; i < claim_count; ++i)
    out.claims.push_back(claim_row(claim_table[i], result.claims[i]));
  return out;
}

}  // namespace

void bind_experiment(py::module_& module) {
  using namespace py::literals;

  py::class_<Claim>(module, "Claim", "One row of a verdict. Numbers are NaN where the claim does not apply.")
      .def_readonly("id", &Claim::id, "name in result files")
      .def_readonly("equation", &Claim::equation, "of the paper")
      .def_readonly("compared_with", &Claim::compared_with, "the definition on the other side")
      .def_readonly("result", &Claim::result, "'pass', 'fail' or 'not_applicable'")
      .def_readonly("reason", &Claim::reason, "why it failed or does not apply, or ''")
      .def_readonly("worst", &Claim::worst, "residual of the step nearest to its bound or farthest above it")
      .def_readonly("bound", &Claim::bound, "allowed residual at that step")
      .def_readonly("at_time", &Claim::at_time, "s, of that step")
      .def_readonly("undecided_steps", &Claim::undecided_steps, "steps whose bound was too large to decide")
      .def_readonly("checked_steps", &Claim::checked_steps, "steps that were judged")
      .def("__repr__", [](const Claim& c) { return "<osculate.Claim " + c.id + ": " + c.result + ">"; });

  py::class_<Run>(module, "Run", "What a run came to.")
      .def_readonly("name", &Run::name, "of the experiment")
      .def_readonly("exit_code", &Run::exit_code, "0 as expected, 1 a claim fails, 3 stopped early")
      .def_readonly("status", &Run::status, "'complete', 'failed' or 'interrupted'")
      .def_readonly("verdict", &Run::verdict, "'pass', 'fail' or 'as_expected'")
      .def_readonly("message", &Run::message, "why it stopped or was not as expected, or ''")
      .def_readonly("claims", &Run::claims, "rows of the verdict")
      .def_readonly("output", &Run::output, "the result file, or None")
      .def_readonly("end_time", &Run::end_time, "s, simulated")
      .def_readonly("steps", &Run::steps, "accepted steps of the integrator")
      .def_readonly("warnings", &Run::warnings, "what reading the model and the run found")
      .def_readonly("report", &Run::report, "the table and the summary that the program prints")
      .def("__repr__", [](const Run& r) {
        return "<osculate.Run " + r.name + ": " + r.status + ", verdict " + r.verdict + ">";
      });

  py::class_<Experiment>(module, "Experiment", R"(An experiment: docs/experiment-file.md.

Objects never change: threads may run one at the same time.)")
      .def(py::init([](const std::filesystem::path& file, const py::dict& overrides) {
             return read_experiment(file, settings(overrides));
           }),
           "file"_a, "overrides"_a = py::dict(),
           R"(Reads a file. overrides: {"key.path": value}, as --set of the program. Raises ConfigError.)")
      .def_static(
          "from_text",
          [](const std::string& text, const std::filesystem::path& directory, const py::dict& overrides) {
            return parse_experiment(text, "text", std::filesystem::absolute(directory), settings(overrides));
          },
          "text"_a, "directory"_a = std::filesystem::path("."), "overrides"_a = py::dict(),
          "The same from YAML; relative paths start at directory.")
      .def_readonly("name", &Experiment::name, "of the experiment")
      .def_property_readonly("yaml", &to_yaml, "the resolved experiment, every default filled in")
      .def("check", &check, py::call_guard<py::gil_scoped_release>(),
           "Reads and validates all that a run would. Raises ModelError or ConfigError.")
      .def("run", &run_one, "output"_a = py::none(), "force"_a = false,
           R"(Runs it and records it in output, a path; None: records nothing. force: overwrite a file.

Other threads go on meanwhile. A claim that fails or a run that stops is a result, not an exception: see exit_code.
Raises ModelError or ConfigError where nothing could be run, FileError where the file cannot be written.)")
      .def("__repr__", [](const Experiment& e) { return "<osculate.Experiment " + e.name + ">"; });
}

}  // namespace osculate::python
