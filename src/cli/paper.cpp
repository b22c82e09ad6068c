#include "cli/paper.hpp"

#include <cstdio>
#include <ostream>

#include "experiment/arms.hpp"
#include "paper/tables.hpp"

namespace osculate {

namespace {

std::string padded(const std::string& text, std::size_t width) {
  return text.size() >= width ? text + " " : text + std::string(width - text.size(), ' ');
}

void heading(std::ostream& out, const std::string& last) {
  out << padded("equation", 16) << padded("statement", 98) << last << "\n";
}

bool check_arm(const ArmDescription& arm, int states, std::ostream& out) {
  out << arm.robot << ": " << arm.base << " to " << arm.tip << ", " << arm.chain.n() << " joints; " << states
      << " random states\n\n";
  heading(out, "residual  bound     result");
  bool fine = true;
  for (const paper::Row& row : paper::check(arm.chain, states)) {
    out << padded(row.about.equation, 16) << padded(row.about.statement, 98);
    if (row.judged == 0) {
      out << "-         -         n/a\n";
      continue;
    }
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "%-9.1e %-9.1e %s\n", row.worst, row.bound,
                  row.pass() ? "pass" : "FAIL");
    out << numbers;
    fine = fine && row.pass();
  }
  return fine;
}

bool prove(int arms, std::ostream& out) {
  const paper::Proof proof = paper::prove(1, 6, arms, 2);
  out << "\nover exact fractions: " << arms
      << " arms of revolute and prismatic joints for each n = 1 ... 6, and 2 of each kind of";
  for (const auto& kind : paper::mixed_kinds()) out << " " << kind;
  out << "; " << proof.arms
      << " in all\n(R revolute, P prismatic, C cylindrical, U universal, L planar, S spherical, F "
         "floating)\n\n";
  heading(out, "arms  residual");
  bool fine = true;
  const auto print = [&out](const paper::ProofRow& row, const std::string& result) {
    char count[16];
    std::snprintf(count, sizeof count, "%-6d", row.judged);
    out << padded(row.about.equation, 16) << padded(row.about.statement, 98) << count << result << "\n";
  };
  for (const paper::ProofRow& row : proof.statements) {
    const bool zero = row.judged > 0 && row.nonzero == 0;
    print(row, row.judged == 0 ? "not evaluated"
               : zero          ? "exactly 0"
                               : "NOT ZERO on " + std::to_string(row.nonzero) + " arms");
    fine = fine && zero;
  }
  out << "\nas printed, which is wrong\n\n";
  for (const paper::ProofRow& row : proof.printed) {
    print(row, "not 0 on " + std::to_string(row.nonzero) + " arms");
    fine = fine && row.nonzero > 0;
  }
  return fine;
}

}  // namespace

Exit print_paper(const PaperOptions& options, std::ostream& out, std::ostream& messages) {
  ChainChoice choice = options.choice;
  if (choice.tip.empty())
    if (const auto tips = tip_candidates(options.model); tips.size() == 1) choice.tip = tips.front();
  const ArmDescription arm = load_urdf(options.model, choice);
  require_simulable(arm);
  for (const auto& warning : arm.warnings) messages << "warning: " << warning << "\n";
  bool fine = check_arm(arm, options.states, out);
  if (options.exact) fine = prove(options.arms, out) && fine;
  return fine ? Exit::ok : Exit::claim_failed;
}

}  // namespace osculate
