// Several formulations of the same dynamics, each asked at the same states, and compared pair by pair in
// units of what rounding allows.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "jury/engines.hpp"
#include "jury/states.hpp"

namespace osculate::jury {

enum class Term { M, C, G, J, Jdot_qd, qdd, Omega, Lambda, c, g };
inline constexpr std::size_t term_count = 10;
inline constexpr std::array<const char*, term_count> term_names{"M",   "C",     "G",      "J", "Jdot_qd",
                                                                "qdd", "Omega", "Lambda", "c", "g"};

/// The largest difference of two members in one term, in units of its bound; above 1 they differ.
struct Difference {
  std::size_t a, b;  // members
  double ratio = 0;  // infinite where one gives no number
  int state = -1;    // where it was seen
};

/// What was found on one term.
struct Finding {
  std::vector<Difference> pairs;  // of the members that give the term
  int undecided = 0;              // states whose bound exceeds 1e-3 or that have no rank: not judged
  double largest_bound = 0;       // of the states that were judged
  bool agree = true;
  /// The one member that every difference above 1 belongs to, if there is exactly one and at least two others
  /// agree among themselves.
  std::optional<std::size_t> alone;
};

struct JuryOptions {
  TaskRows rows = all_rows();
  int states = 100;
  std::uint64_t seed = 1;
  Disturbance disturbance;
};

struct Verdict {
  std::vector<std::string> members;  // "recursions", "dense", then the libraries with their versions
  std::vector<Absent> absent;
  std::array<Finding, term_count> findings;
  bool agree() const;
};

/// Asks everybody. The members are our recursions (Omega, Lambda, c, g, qdd; they form nothing else), our
/// dense side, and each library present. tau is the torque of the law (4) for a random command, or 0 where
/// Omega has no full rank. Of a library M, C, G, J, Jdot qd, qdd and where it has it Omega are its own calls;
/// the rest is composed from these by Cholesky factors.
///
/// Bounds. Omega, Lambda, c, g, qdd: those of the verdict (docs/claims.md). The others: 10 n eps times a
/// scale that is the size of the terms that are added (docs/jury.md).
Verdict hear(const ArmDescription& arm, const JuryOptions& options);

}  // namespace osculate::jury
