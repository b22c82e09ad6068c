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

/// "1,2,3" as numbers; `what` names the list in the ConfigError.
std::vector<double> parse_list(const std::string& text, const std::string& what);
/// "vx,vy,vz" as task rows; empty: all six. Throws ConfigError.
std::vector<int> parse_rows(const std::string& text);
/// "X,Y,Z" as a vector; `what` names it in the ConfigError.
Vector3<double> parse_vector3(const std::string& text, const std::string& what);

}  // namespace osculate
