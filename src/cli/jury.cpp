#include "cli/jury.hpp"

#include <cstdio>
#include <iomanip>
#include <ostream>

#include "cli/json.hpp"
#include "cli/lists.hpp"
#include "experiment/arms.hpp"
#include "jury/jury.hpp"

namespace osculate {

namespace {

using jury::Difference;
using jury::Finding;
using jury::term_count;
using jury::term_names;

/// What is to be said of one term, empty where all agree.
std::string remark(const jury::Verdict& verdict, std::size_t term) {
  const Finding& finding = verdict.findings[term];
  if (finding.agree) return "";
  const Difference* worst = &finding.pairs.front();
  for (const Difference& pair : finding.pairs)
    if (!(pair.ratio <= worst->ratio)) worst = &pair;
  char size[64];
  std::snprintf(size, sizeof size, "%.3g times the bound at state %d", worst->ratio, worst->state);
  const std::string name = std::string(term_names[term]) + ": ";
  if (finding.alone)
    return name + verdict.members[*finding.alone] + " stands alone; it differs by up to " + size;
  return name + verdict.members[worst->a] + " and " + verdict.members[worst->b] + " differ by " + size +
         (finding.pairs.size() < 3 ? "; two members cannot tell who is wrong"
                                   : "; no single member stands alone");
}

void print_text(const ArmDescription& arm, const JuryArguments& arguments, const jury::Verdict& verdict,
                const std::vector<std::string>& notes, std::ostream& out) {
  out << arm.robot << ": " << arm.base << " to " << arm.tip << ", " << arm.chain.n() << " joints; "
      << arguments.states << " random states, seed " << arguments.seed << "\n";
  for (const auto& note : notes) out << "made solid: " << note << "\n";
  for (const auto& [name, reason] : verdict.absent) out << "left out: " << name << ": " << reason << "\n";
  out << "\nlargest difference of each pair in units of its bound; above 1 they differ\n\n" << std::left;
  std::size_t width = 0;
  for (const auto& member : verdict.members) width = std::max(width, member.size());
  const int column = static_cast<int>(2 * width + 4);
  out << std::setw(column) << "pair";
  for (const char* name : term_names) out << std::setw(9) << name;
  out << "\n";
  for (std::size_t a = 0; a < verdict.members.size(); ++a)
    for (std::size_t b = a + 1; b < verdict.members.size(); ++b) {
      out << std::setw(column) << verdict.members[a] + ", " + verdict.members[b];
      for (const Finding& finding : verdict.findings) {
        char text[16] = "-";
        for (const Difference& pair : finding.pairs)
          if (pair.a == a && pair.b == b && pair.state >= 0)
            std::snprintf(text, sizeof text, "%.2g", pair.ratio);
        out << std::setw(9) << text;
      }
      out << "\n";
    }
  out << "\n";
  for (std::size_t term = 0; term < term_count; ++term) {
    if (const int lost = verdict.findings[term].undecided; lost > 0)
      out << term_names[term] << ": not judged at " << lost
          << " states: no full rank, or a bound above 1e-3\n";
    if (const std::string text = remark(verdict, term); !text.empty()) out << text << "\n";
  }
  out << (verdict.agree() ? "all agree" : "they do not agree") << "\n";
}

void print_json(const ArmDescription& arm, const JuryArguments& arguments, const jury::Verdict& verdict,
                const std::vector<std::string>& notes, std::ostream& out) {
  Json json(out);
  const auto list = [&json](const std::vector<std::string>& texts) {
    json.begin_array();
    for (const std::string& text : texts) json.value(text);
    json.end_array();
  };
  json.begin_object();
  json.key("robot").value(arm.robot);
  json.key("n").value(arm.chain.n());
  json.key("states").value(arguments.states);
  json.key("made_solid"), list(notes);
  json.key("members"), list(verdict.members);
  json.key("absent").begin_object();
  for (const auto& [name, reason] : verdict.absent) json.key(name).value(reason);
  json.end_object();
  json.key("terms").begin_object();
  for (std::size_t term = 0; term < term_count; ++term) {
    const Finding& finding = verdict.findings[term];
    json.key(term_names[term]).begin_object();
    json.key("pairs").begin_array();
    for (const Difference& pair : finding.pairs) {
      json.begin_object();
      json.key("a").value(verdict.members[pair.a]);
      json.key("b").value(verdict.members[pair.b]);
      json.key("ratio");
      pair.state >= 0 ? json.value(pair.ratio) : json.null();
      json.key("state").value(pair.state);
      json.end_object();
    }
    json.end_array();
    json.key("undecided").value(finding.undecided);
    json.key("largest_bound").value(finding.largest_bound);
    json.key("agree").value(finding.agree ? 1 : 0);
    json.key("alone");
    finding.alone ? json.value(verdict.members[*finding.alone]) : json.null();
    json.key("remark").value(remark(verdict, term));
    json.end_object();
  }
  json.end_object();
  json.key("agree").value(verdict.agree() ? 1 : 0);
  json.end_object();
  out << "\n";
}

jury::Disturbance parse_disturbance(const std::string& text) {
  if (text.empty()) return {};
  const auto colon = text.find(':');
  const std::string name = text.substr(0, colon);
  if (colon == std::string::npos ||
      (name != "KDL" && name != "MuJoCo" && name != "Simbody" && name != "DART"))
    throw ConfigError("--disturb " + text + ": give KDL, MuJoCo, Simbody or DART, a colon and a number");
  const auto size = parse_list(text.substr(colon + 1), "--disturb");
  if (size.size() != 1 || size[0] <= -1)
    throw ConfigError("--disturb " + text + ": give one number above -1");
  return {name, size[0]};
}

}  // namespace

Exit print_jury(const JuryArguments& arguments, std::ostream& out, std::ostream& messages) {
  ChainChoice choice = arguments.choice;
  if (choice.tip.empty())
    if (const auto tips = tip_candidates(arguments.model); tips.size() == 1) choice.tip = tips.front();
  ArmDescription arm = load_urdf(arguments.model, choice);
  require_simulable(arm);
  for (const auto& warning : arm.warnings) messages << "warning: " << warning << "\n";
  std::vector<std::string> notes;
  if (arguments.solid) notes = jury::make_solid(arm);
  const jury::JuryOptions options{parse_rows(arguments.rows), arguments.states, arguments.seed,
                                  parse_disturbance(arguments.disturb)};
  for (const auto& state : jury::random_states(arm, options.states, options.seed))
    require_articulated(arm.chain, arm, {state.q.data(), static_cast<std::size_t>(state.q.size())});
  const jury::Verdict verdict = jury::hear(arm, options);
  (arguments.json ? print_json : print_text)(arm, arguments, verdict, notes, out);
  if (verdict.members.size() == 2)
    messages
        << "osculate: no other library takes part: our recursions are held against our definitions only\n";
  return verdict.agree() ? Exit::ok : Exit::claim_failed;
}

}  // namespace osculate
