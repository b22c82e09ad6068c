#include "verification/verdict.hpp"

#include <cmath>
#include <cstdio>

namespace osculate {

bool Verdict::add(double t, const Residuals& residuals) {
  bool worse = false;
  for (std::size_t i = 0; i < claim_count; ++i) {
    const Residual& now = residuals[i];
    if (!now.applies) continue;
    ClaimResult& r = worst_[i];
    ++r.checked_steps;
    // A bound that is not a number decides nothing; a residual that is not a number is never below its bound.
    if (!(now.bound <= undecided_bound)) {
      ++r.undecided_steps;
      continue;
    }
    const bool first = r.checked_steps - r.undecided_steps == 1;
    const bool within = now.value <= now.bound;
    const double a = now.bound > 0 ? now.value / now.bound : (now.value == 0 ? 0 : INFINITY);
    const double b = r.worst.bound > 0 ? r.worst.value / r.worst.bound : (r.worst.value == 0 ? 0 : INFINITY);
    if (first || !(a <= b)) {
      if (first || !std::isnan(r.worst.value)) {
        r.worst = now;
        r.at_time = t;
        worse = true;
      }
    }
    if (!within) failed_[i] = true;
  }
  return worse;
}

std::array<ClaimResult, claim_count> Verdict::results(
    const std::array<std::string, claim_count>& reasons) const {
  auto out = worst_;
  for (std::size_t i = 0; i < claim_count; ++i) {
    ClaimResult& r = out[i];
    if (r.checked_steps == 0) {
      r.outcome = Outcome::not_applicable;
      r.reason = reasons[i].empty() ? "no checked step" : reasons[i];
    } else if (failed_[i]) {
      r.outcome = Outcome::fail;
      r.reason = "residual above its bound";
    } else if (static_cast<double>(r.undecided_steps) >
               undecided_share * static_cast<double>(r.checked_steps)) {
      r.outcome = Outcome::fail;
      r.reason = "more than 1 % of the steps are undecided";
    } else {
      r.outcome = Outcome::pass;
    }
  }
  return out;
}

void judge(ClaimResult& once) {
  once.outcome = Outcome::fail;
  once.reason.clear();
  if (!(once.worst.bound <= undecided_bound)) {
    once.reason = "undecided: the bound is above 1e-3";
    once.undecided_steps = 1;
  } else if (!(once.worst.value <= once.worst.bound)) {
    once.reason = "residual above its bound";
  } else {
    once.outcome = Outcome::pass;
  }
}

std::string verdict_table(const std::array<ClaimResult, claim_count>& results) {
  std::string out =
      "claim              equation                 worst      bound      at time   undecided  result\n";
  for (std::size_t i = 0; i < claim_count; ++i) {
    const ClaimResult& r = results[i];
    const ClaimInfo& about = claim_table[i];
    char line[256];
    if (r.outcome == Outcome::not_applicable) {
      std::snprintf(line, sizeof line, "%-18s %-24s %-9s  %-9s  %-9s %9s  n/a: %s\n", about.id.data(),
                    about.equation.data(), "-", "-", "-", "-", r.reason.c_str());
    } else {
      std::snprintf(line, sizeof line, "%-18s %-24s %-9.2e  %-9.2e  %-9.4f %9ld  %s%s%s\n", about.id.data(),
                    about.equation.data(), r.worst.value, r.worst.bound, r.at_time, r.undecided_steps,
                    r.outcome == Outcome::pass ? "pass" : "FAIL", r.reason.empty() ? "" : ": ",
                    r.reason.c_str());
    }
    out += line;
  }
  return out;
}

}  // namespace osculate
