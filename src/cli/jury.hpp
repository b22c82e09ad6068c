// `osculate jury`: our recursions, our definitions and other libraries on the same arm.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "experiment/run.hpp"

namespace osculate {

struct JuryArguments {
  std::filesystem::path model;
  ChainChoice choice;
  std::string rows;     // comma-separated names; empty: all six
  std::string disturb;  // "KDL:1e-6": one mass is wrong by that much in one library; empty: none
  int states = 100;
  std::uint64_t seed = 1;
  bool solid = false;  // raise the numbers that no body has
  bool json = false;
};

/// Prints the differences of all pairs to `out`, warnings to `messages`. claim_failed if a pair differs by
/// more than its bound. Throws ModelError or ConfigError.
Exit print_jury(const JuryArguments& arguments, std::ostream& out, std::ostream& messages);

}  // namespace osculate
