// `osculate reference`: all terms of an arm at seeded states, for the tests of other libraries.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "experiment/run.hpp"

namespace osculate {

struct ReferenceOptions {
  std::filesystem::path model;
  ChainChoice choice;
  std::string rows;      // comma-separated names; empty: all six
  std::string armature;  // one number for each joint; empty: none
  int states = 0;        // two of them special; at least 2
  std::uint64_t seed = 1;
  std::filesystem::path output;  // FILE.h5 or FILE.json
  bool force = false;            // overwrite
};

/// Writes the file; a summary to `out`, warnings to `messages`. claim_failed if the two formulations differ
/// by so much that some rounded digit is not sure. Throws ModelError, ConfigError or FileError.
Exit reference(const ReferenceOptions& options, std::ostream& out, std::ostream& messages);

}  // namespace osculate
