#include "experiment/embedded.hpp"

#include <algorithm>
#include <sstream>

#include "experiment/arms.hpp"
#include "plugin/user_law.hpp"

namespace osculate {

namespace {

constexpr const char* build_texts[] = {
    "program_version", "git_commit",      "build_id",         "sundials_version", "hdf5_version",
    "eigen_version",   "urdfdom_version", "yaml_cpp_version", "compiler",         "cpu_features"};

NamedFiles files_of(const ResultTexts& texts) {
  NamedFiles out;
  const auto names = texts.lists.find("file"), contents = texts.lists.find("provenance/file_text");
  if (names == texts.lists.end() || contents == texts.lists.end()) return out;
  for (std::size_t i = 0; i < std::min(names->second.size(), contents->second.size()); ++i)
    out[names->second[i]] = contents->second[i];
  return out;
}

}  // namespace

void add_files(const Experiment& experiment, NamedFiles& files) {
  const ModelConfig& model = experiment.model;
  files[model.urdf.string()] = describe(model).urdf_text;
  const auto* waypoints = std::get_if<WaypointsOptions>(&experiment.reference);
  if (waypoints && waypoints->text) files[waypoints->file.string()] = *waypoints->text;
}

Experiment embedded_experiment(const ResultTexts& texts, const std::filesystem::path& file,
                               const std::vector<std::string>& overrides) {
  const auto require = [&](const std::string& path) {
    if (!texts.has(path))
      throw ConfigError(file.string() + ": has no /" + path +
                        ": it cannot be run again. Files of osculate run and sweep can.");
    return texts.at(path);
  };
  const std::string text = require("provenance/experiment");
  const std::string directory =
      texts.has("provenance/directory") ? texts.at("provenance/directory") : file.parent_path().string();
  Experiment out = parse_experiment(text, file.string() + ":/provenance/experiment", directory, overrides);
  const NamedFiles files = files_of(texts);
  const auto content = [&](const std::filesystem::path& named, const std::string& path) {
    const auto found = files.find(named.string());
    return found != files.end() ? found->second : require(path);
  };
  out.model.urdf_text = content(out.model.urdf, "provenance/model");
  if (auto* waypoints = std::get_if<WaypointsOptions>(&out.reference))
    waypoints->text = content(waypoints->file, "provenance/waypoints");
  return out;
}

std::vector<std::string> controller_changes(const ResultTexts& texts, const std::filesystem::path& file,
                                            const Experiment& experiment) {
  const std::string path = "provenance/controller";
  if (!texts.has(path)) return {};
  const std::string now = fingerprint(experiment.controller.user);
  std::vector<std::string> out;
  std::istringstream recorded(texts.at(path));
  for (std::string line; std::getline(recorded, line);) {
    const auto gap = line.find("  ");
    const std::string name = gap == std::string::npos ? "" : line.substr(gap + 2);
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored))
      throw ConfigError(file.string() + ": its run needs the controller's file " + name + " (SHA-256 " +
                        line.substr(0, gap) + "), which is not there: put it back.");
    if (now.find(line) == std::string::npos)
      out.push_back(name + " is not what it was, SHA-256 " + line.substr(0, gap));
  }
  return out;
}

bool is_sweep(const ResultTexts& texts) { return texts.has("provenance/swept_key"); }

std::vector<std::string> build_differences(const ResultTexts& a, const ResultTexts& b) {
  std::vector<std::string> out;
  for (const std::string name : build_texts) {
    const auto in = [&name](const ResultTexts& texts) {
      const std::string path = "provenance/" + name;
      return texts.has(path) ? "'" + texts.at(path) + "'" : std::string("not recorded");
    };
    if (in(a) != in(b)) out.push_back(name + ": " + in(a) + " against " + in(b));
  }
  return out;
}

}  // namespace osculate
