// The verdict of a run: worst residual of each claim, when it occurred, its bound, pass or fail.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "verification/claims.hpp"

namespace osculate {

enum class Outcome { pass = 1, fail = 0, not_applicable = -1 };

struct ClaimResult {
  Outcome outcome = Outcome::not_applicable;
  std::string reason;  // why not applicable, or why failed
  Residual worst;      // of the step with the largest residual / bound
  double at_time = 0;  // s
  long undecided_steps = 0, checked_steps = 0;

  /// Outcome and reason are found at the end.
  void remember(Memory& memory) { memory(worst, at_time, undecided_steps, checked_steps); }
};

class Verdict {
 public:
  /// Residuals of one accepted step. True if any claim came nearer to its bound than at any step before.
  bool add(double t, const Residuals& residuals);
  /// Final results; `reasons[i]` says why claim i never applied.
  std::array<ClaimResult, claim_count> results(
      const std::array<std::string, claim_count>& reasons = {}) const;
  void remember(Memory& memory) { memory(worst_, failed_); }

 private:
  std::array<ClaimResult, claim_count> worst_{};
  std::array<bool, claim_count> failed_{};
};

/// More than this share of undecided steps fails a claim.
inline constexpr double undecided_share = 0.01;

/// Outcome and reason of a claim that was judged once, from its worst residual and bound.
void judge(ClaimResult& once);

/// The table as text, one line for each claim.
std::string verdict_table(const std::array<ClaimResult, claim_count>& results);

}  // namespace osculate
