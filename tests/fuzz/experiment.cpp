// Fuzz target: the text of an experiment file. A line "#set key.path=value" is what --set would say too.
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "experiment/config.hpp"

namespace {

using namespace osculate;

/// An arm that many texts fit: six joints.
const ArmDescription& arm() {
  static const ArmDescription one = load_urdf(OSCULATE_SOURCE_DIR "/models/puma560.urdf", {.tip = "tool0"});
  return one;
}

[[noreturn]] void complain(const std::string& what, const std::string& text) {
  std::cerr << what << ":\n" << text << "\n";
  std::abort();
}

/// An accepted experiment, written out and read again, must be the same experiment.
void require_round_trip(const Experiment& experiment) {
  const std::string written = to_yaml(experiment);
  try {
    const std::string again = to_yaml(parse_experiment(written, "written.yaml", "/"));
    if (again != written) complain("read back, the experiment differs", written + "\n---\n" + again);
  } catch (const ConfigError& error) { complain(error.what(), written); }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> overrides;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("#set ")) overrides.push_back(line.substr(5));
  try {
    const Experiment experiment = parse_experiment(text, "fuzz.yaml", "/arms/lab", overrides);
    require_round_trip(experiment);
    check_against(experiment, arm());
  } catch (const ConfigError& error) {
    // Every message starts with a place.
    const std::string said = error.what();
    if (!said.starts_with("fuzz.yaml:") && !said.starts_with("--set ")) complain("no place", said);
  }
  return 0;
}
