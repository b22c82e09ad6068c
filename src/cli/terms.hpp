// `osculate terms`: the operational-space terms of an arm at given states, by recursion and by definition.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "experiment/run.hpp"

namespace osculate {

struct TermsOptions {
  std::filesystem::path model;
  ChainChoice choice;
  std::string q, qd, u;                         // comma-separated lists; qd and u may be empty: zero
  std::optional<std::filesystem::path> states;  // CSV: q, or q and qd, or q, qd and u in each line
  std::string rows;                             // comma-separated names; empty: all six
  bool json = false;
};

/// Prints to `out`, warnings to `messages`. Throws ModelError or ConfigError.
Exit terms(const TermsOptions& options, std::ostream& out, std::ostream& messages);

}  // namespace osculate
