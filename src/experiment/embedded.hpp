// The experiment that a result file was made by, from the file alone.
#pragma once

#include "experiment/config.hpp"
#include "record/texts.hpp"

namespace osculate {

/// The texts of all files that experiments name, by absolute path.
using NamedFiles = std::map<std::string, std::string>;

/// Adds the model and the waypoints of an experiment. Throws ModelError where the model cannot be read.
void add_files(const Experiment& experiment, NamedFiles& files);

/// Reads the experiment of /provenance with its model and its waypoints, changed by `overrides`; no other
/// file is needed. `file` is for messages. Throws ConfigError where something is missing.
Experiment embedded_experiment(const ResultTexts& texts, const std::filesystem::path& file,
                               const std::vector<std::string>& overrides = {});

/// A result file holds the name and SHA-256 of the files of a law of the user's own, not the files: one
/// sentence for each that is not what it was. Throws ConfigError where one is missing.
std::vector<std::string> controller_changes(const ResultTexts& texts, const std::filesystem::path& file,
                                            const Experiment& experiment);

/// Whether the file is one of `osculate sweep`.
bool is_sweep(const ResultTexts& texts);

/// What differs in build and processor, one line each: "compiler: 'x' against 'y'". Then the last digits of
/// results may differ.
std::vector<std::string> build_differences(const ResultTexts& a, const ResultTexts& b);

}  // namespace osculate
