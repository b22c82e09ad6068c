// osculate._core: the compiled part of the Python module.
#include "control/law.hpp"
#include "experiment/config.hpp"
#include "experiment/provenance.hpp"
#include "experiment/run.hpp"
#include "judge/log.hpp"
#include "python/bindings.hpp"
#include "record/result_file.hpp"

namespace py = pybind11;
using namespace osculate;

PYBIND11_MODULE(_core, module) {
  module.doc() = "Operational space control of serial arms: terms, torques, verified runs.";

  const auto error = [&module](const char* name, py::handle base, Exit code, const char* about) {
    const std::string full = std::string("osculate.") + name;
    py::object made = py::reinterpret_steal<py::object>(
        PyErr_NewExceptionWithDoc(full.c_str(), about, base.ptr(), nullptr));
    made.attr("exit_code") = static_cast<int>(code);
    module.attr(name) = made;
    return made.release();  // lives as long as the interpreter
  };
  static py::handle base, of_model, of_config, of_file, of_log, singular,
      stopped;  // the translator needs them
  base = error("Error", PyExc_Exception, Exit::bad_input,
               "What osculate refuses; exit_code is that of the program.");
  of_model = error("ModelError", base, Exit::bad_input, "A model file that cannot be used.");
  of_config = error("ConfigError", base, Exit::bad_input, "An experiment that cannot be used.");
  of_file = error("FileError", base, Exit::io_failure, "A result file that cannot be read or written.");
  of_log = error("LogError", base, Exit::bad_input, "A log that cannot be judged.");
  singular = error("SingularArm", base, Exit::stopped, "No finite force gives the commanded acceleration.");
  stopped = error("Stopped", base, Exit::stopped, "The integration cannot go on.");
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto set = [](py::handle type, const std::exception& e) { PyErr_SetString(type.ptr(), e.what()); };
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ModelError& e) { set(of_model, e); } catch (const ConfigError& e) {
      set(of_config, e);
    } catch (const ReferenceError& e) { set(of_config, e); } catch (const FileError& e) {
      set(of_file, e);
    } catch (const LogError& e) { set(of_log, e); } catch (const SingularArm& e) {
      set(singular, e);
    } catch (const IntegrationStopped& e) { set(stopped, e); }
  });

  module.def("version", &version_text, "Version and commit of osculate, versions of its libraries.");
  python::bind_chain(module);
  python::bind_experiment(module);
  python::bind_judge(module);
}
