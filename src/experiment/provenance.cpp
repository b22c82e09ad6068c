#include "experiment/provenance.hpp"

#include <elf.h>
#include <link.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cstdio>
#include <cstring>
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

/// Whether a loaded file has this address.
bool holds(const dl_phdr_info& file, ElfW(Addr) address) {
  for (int i = 0; i < file.dlpi_phnum; ++i) {
    const auto& segment = file.dlpi_phdr[i];
    const ElfW(Addr) start = file.dlpi_addr + segment.p_vaddr;
    if (segment.p_type == PT_LOAD && address >= start && address - start < segment.p_memsz) return true;
  }
  return false;
}

/// The hash that the linker put into the program, or into the library that holds this code, in hexadecimal
/// digits; "" if it put none.
std::string build_id() {
  const auto look = [](dl_phdr_info* program, std::size_t, void* into) {
    if (!holds(*program, reinterpret_cast<ElfW(Addr)>(&provenance))) return 0;
    for (int i = 0; i < program->dlpi_phnum; ++i) {
      const auto& segment = program->dlpi_phdr[i];
      if (segment.p_type != PT_NOTE) continue;
      const char* at = reinterpret_cast<const char*>(program->dlpi_addr + segment.p_vaddr);
      const char* const end = at + segment.p_memsz;
      while (at + sizeof(ElfW(Nhdr)) <= end) {
        ElfW(Nhdr) note;
        std::memcpy(&note, at, sizeof note);
        const auto padded = [](std::size_t size) { return (size + 3) / 4 * 4; };
        const char* const name = at + sizeof note;
        const char* const text = name + padded(note.n_namesz);
        at = text + padded(note.n_descsz);
        if (note.n_type != NT_GNU_BUILD_ID || at > end || std::memcmp(name, ELF_NOTE_GNU, 4) != 0) continue;
        for (std::size_t k = 0; k < note.n_descsz; ++k) {
          char digits[3];
          std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned char>(text[k]));
          *static_cast<std::string*>(into) += digits;
        }
        return 1;
      }
    }
    return 1;
  };
  std::string out;
  dl_iterate_phdr(look, &out);
  return out;
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

std::string version() { return OSCULATE_VERSION " (commit " OSCULATE_COMMIT ")"; }

std::string version_text() {
  return "osculate " + version() + "\nSUNDIALS " + sundials_version() + "\nHDF5 " + hdf5_version() +
         "\nEigen " + eigen_version() + "\nurdfdom " OSCULATE_URDFDOM "\nyaml-cpp " OSCULATE_YAML_CPP "\n";
}

std::vector<Text> provenance(const Experiment& experiment, const std::string& urdf_text,
                             const std::string& command) {
  std::vector<Text> out{
      {"provenance/experiment", to_yaml(experiment), "resolved experiment, YAML"},
      {"provenance/model", urdf_text, "model file, URDF"},
      {"provenance/command", command, "command line"},
      {"provenance/program_version", OSCULATE_VERSION, "version of osculate"},
      {"provenance/git_commit", OSCULATE_COMMIT, "source it was built from"},
      {"provenance/build_id", build_id(), "hash of the program by its linker"},
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
  const auto* waypoints = std::get_if<WaypointsOptions>(&experiment.reference);
  if (waypoints && waypoints->text)
    out.insert(out.begin() + 2, {"provenance/waypoints", *waypoints->text, "file of waypoints, CSV"});
  if (experiment.controller.law == Law::user)
    out.insert(out.begin() + 2, {"provenance/controller", fingerprint(experiment.controller.user),
                                 "files of the law of the user's own: SHA-256 and path"});
  return out;
}

}  // namespace osculate
