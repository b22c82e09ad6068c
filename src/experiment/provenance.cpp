#include "experiment/provenance.hpp"

#include <unistd.h>

#include <Eigen/Core>
#include <ctime>
#include <fstream>
#include <sstream>

#include "simulation/integrator.hpp"

// OSCULATE_VERSION, OSCULATE_COMMIT, OSCULATE_URDFDOM, OSCULATE_YAML_CPP and OSCULATE_FLAGS come from CMake.

namespace osculate {

namespace {

std::string eigen_version() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

/// What of the processor can change the last bits of libm or of compiled code.
std::string cpu_features() {
  std::ifstream file("/proc/cpuinfo");
  std::string line, out;
  while (std::getline(file, line)) {
    if (line.rfind("flags", 0) != 0 && line.rfind("Features", 0) != 0) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    for (std::string word; words >> word;)
      if (word == "sse4_2" || word == "avx" || word == "avx2" || word == "fma" ||
          word.rfind("avx512f", 0) == 0 || word == "asimd")
        out += (out.empty() ? "" : " ") + word;
    break;
  }
  return out.empty() ? "unknown" : out;
}

std::string host() {
  char name[256] = "";
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace

std::string version_text() {
  return "osculate " OSCULATE_VERSION " (commit " OSCULATE_COMMIT ")\nSUNDIALS " + sundials_version() +
         "\nHDF5 " + hdf5_version() + "\nEigen " + eigen_version() +
         "\nurdfdom " OSCULATE_URDFDOM "\nyaml-cpp " OSCULATE_YAML_CPP "\n";
}

std::vector<Text> provenance(const Experiment& experiment, const std::string& urdf_text,
                             const std::string& command) {
  return {
      {"provenance/experiment", to_yaml(experiment), "resolved experiment, YAML"},
      {"provenance/model", urdf_text, "model file, URDF"},
      {"provenance/command", command, "command line"},
      {"provenance/program_version", OSCULATE_VERSION, "version of osculate"},
      {"provenance/git_commit", OSCULATE_COMMIT, "source it was built from"},
      {"provenance/sundials_version", sundials_version(), "version of SUNDIALS"},
      {"provenance/hdf5_version", hdf5_version(), "version of HDF5"},
      {"provenance/eigen_version", eigen_version(), "version of Eigen"},
      {"provenance/urdfdom_version", OSCULATE_URDFDOM, "version of urdfdom"},
      {"provenance/yaml_cpp_version", OSCULATE_YAML_CPP, "version of yaml-cpp"},
      {"provenance/compiler", "g++ " __VERSION__ ", " OSCULATE_FLAGS, "compiler and flags"},
      {"provenance/cpu_features", cpu_features(), "processor features that can change last bits"},
      {"provenance/host", host(), "machine"},
      {"provenance/created", now(), "time of creation, UTC"},
  };
}

}  // namespace osculate
