// What an experiment file may say, made of the readers' own notes (yaml_notes.hpp).
#pragma once

#include <string>

namespace osculate {

/// A JSON Schema (draft 7) of experiment files.
std::string experiment_schema();
/// The tables of keys in docs/experiment-file.md, one for each section, each between two comments.
std::string key_tables();

}  // namespace osculate
