#include "cli/terms.hpp"

#include <cmath>
#include <cstdio>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "cli/json.hpp"
#include "cli/lists.hpp"
#include "experiment/arms.hpp"
#include "input/limits.hpp"
#include "input/read_text.hpp"
#include "verification/state_terms.hpp"

namespace osculate {

namespace {

struct State {
  std::vector<double> q, qd;
  Vector6 u = Vector6::Zero();
};

State make_state(const std::vector<double>& q, const std::vector<double>& qd, const std::vector<double>& u,
                 const TaskRows& rows, const ArmDescription& arm, const std::string& where) {
  const auto np = static_cast<std::size_t>(arm.chain.positions());
  const auto nv = static_cast<std::size_t>(arm.chain.velocities());
  const auto count = [&](const std::vector<double>& list, std::size_t wanted, const char* name,
                         const char* each) {
    if (list.size() != wanted)
      throw ConfigError(where + name + " has " + std::to_string(list.size()) + " entries, needs " +
                        std::to_string(wanted) + " (one for each " + each + ")");
  };
  const bool one_axis_joints = arm.chain.one_axis_joints();
  count(q, np, "q", one_axis_joints ? "joint, base to tip" : "position coordinate, base to tip");
  State state{q, qd.empty() ? std::vector<double>(nv, 0.0) : qd};
  count(state.qd, nv, "qd", one_axis_joints ? "joint, base to tip" : "velocity coordinate, base to tip");
  if (!u.empty()) {
    count(u, rows.size(), "u", "task row");
    for (std::size_t i = 0; i < rows.size(); ++i) state.u[rows[i]] = u[i];
  }
  return state;
}

std::vector<State> read_states(const std::filesystem::path& file, const TaskRows& rows,
                               const ArmDescription& arm) {
  const auto [text, fault] = read_text(file, limits::waypoint_bytes, "give a CSV file of states");
  if (!fault.empty()) throw ConfigError(fault);
  std::istringstream in(text);
  const auto np = static_cast<std::size_t>(arm.chain.positions());
  const auto nv = static_cast<std::size_t>(arm.chain.velocities());
  std::vector<State> states;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    line.erase(0, line.find_first_not_of(" \t\r"));
    const bool heading = states.empty() && !line.empty() && std::isalpha(static_cast<unsigned char>(line[0]));
    if (line.empty() || line[0] == '#' || heading) continue;
    const std::string where = file.string() + ":" + std::to_string(number) + ": ";
    const std::vector<double> all = parse_list(line, where + "state");
    const std::size_t m = rows.size();
    if (all.size() != np && all.size() != np + nv && all.size() != np + nv + m)
      throw ConfigError(where + "a state has " + std::to_string(np) + " numbers (q), " +
                        std::to_string(np + nv) + " (q, qd) or " + std::to_string(np + nv + m) +
                        " (q, qd, u), this line " + std::to_string(all.size()));
    const auto part = [&all](std::size_t from, std::size_t to) {
      return from < all.size() ? std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(from),
                                                     all.begin() + static_cast<std::ptrdiff_t>(to))
                               : std::vector<double>();
    };
    states.push_back(make_state(part(0, np), part(np, np + nv), part(np + nv, all.size()), rows, arm, where));
  }
  if (states.empty()) throw ConfigError(file.string() + ": no states in the file");
  return states;
}

void write_json(Json& json, const ArmDescription& arm, const StateTerms& e, const TaskRows& rows) {
  const Evidence& v = e.evidence;
  json.begin_object();
  json.key("joints").begin_array();
  for (const auto& joint : arm.joints) json.value(joint.name);
  json.end_array();
  json.key("n").value(arm.chain.n());
  json.key("tip").begin_object();
  json.key("position").value(VectorX<double>(v.tip.p));
  json.key("rotation").value(MatrixX<double>(v.tip.R));
  json.end_object();
  json.key("M").value(v.model.joint.M);
  json.key("C").value(v.model.joint.C);
  json.key("G").value(v.model.joint.G);
  json.key("J").value(MatrixX<double>(v.task.J));
  json.key("Jdot_qd").value(v.task.Jdot_qd);

  const MatrixX<double> Omega = v.recursive.Omega(rows, rows);
  const auto nulls = [&json] {
    for (const char* key : {"Lambda", "c", "g", "F", "T", "qdd"}) json.key(key).null();
  };
  json.key("recursive").begin_object();
  json.key("Omega").value(Omega);
  if (e.regular()) {
    json.key("Lambda").value(MatrixX<double>(v.recursive.Lambda));
    json.key("c").value(VectorX<double>(v.recursive.c));
    json.key("g").value(VectorX<double>(v.recursive.g));
    json.key("F").value(v.F);
    json.key("T").value(v.T);
    json.key("qdd").value(v.qdd);
  } else {
    nulls();
  }
  json.end_object();
  json.key("dense").begin_object();
  json.key("Omega").value(v.task.Omega);
  if (e.regular()) {
    const auto [F, T, qdd] = dense_force(e);
    json.key("Lambda").value(v.terms.Lambda);
    json.key("c").value(v.terms.c);
    json.key("g").value(v.terms.g);
    json.key("F").value(F);
    json.key("T").value(T);
    json.key("qdd").value(qdd);
  } else {
    nulls();
  }
  json.end_object();
  json.key("residual").begin_object();
  json.key("Omega").value(e.residual(Claim::omega).value);
  if (e.regular()) {
    json.key("Lambda").value(e.residual(Claim::lambda).value);
    json.key("c").value(e.residual(Claim::c).value);
    json.key("g").value(e.residual(Claim::g).value);
    json.key("F").value(force_residual(v));
    json.key("T").value(e.residual(Claim::torque).value);
    json.key("qdd").value(e.residual(Claim::forward_dynamics).value);
  } else {
    nulls();
  }
  json.end_object();
  json.key("bound").begin_object();
  for (const auto& [key, claim] : judged_terms) {
    const Residual& r = e.residual(claim);
    if (r.applies && (e.regular() || claim == Claim::omega))
      json.key(key).value(r.bound);
    else
      json.key(key).null();
  }
  json.end_object();
  if (std::isfinite(e.condition))
    json.key("cond_Omega").value(e.condition);
  else
    json.key("cond_Omega").null();
  json.key("rank").value(e.rank);
  json.key("warnings").begin_array();
  for (const auto& w : arm.warnings) json.value(w);
  for (const auto& w : e.warnings) json.value(w);
  json.end_array();
  json.end_object();
}

void write_text(std::ostream& out, const ArmDescription& arm, const StateTerms& e, const TaskRows& rows) {
  const Evidence& v = e.evidence;
  const Eigen::IOFormat format(6, 0, "  ", "\n", "  ", "");
  const auto row = [&](const char* name, const VectorX<double>& x) {
    out << std::left << std::setw(8) << name << std::right << x.transpose().format(format) << "\n";
  };
  out << arm.robot << ": " << arm.base << " to " << arm.tip << ", " << arm.chain.n() << " joints; rows";
  for (const int r : rows) out << " " << row_names[r];
  out << "; base frame, about the tip point, SI units\n";
  row("tip", v.tip.p);
  out << "Omega (recursive)\n";
  const MatrixX<double> Omega = v.recursive.Omega(rows, rows);
  out << Omega.format(format) << "\n";
  if (e.regular()) {
    out << "Lambda (recursive)\n" << v.recursive.Lambda.format(format) << "\n";
    row("c", v.recursive.c);
    row("g", v.recursive.g);
    row("F", v.F);
    row("T", v.T);
    row("qdd", v.qdd);
  }
  out << "cond(Omega), unit diagonal: " << e.condition << ", rank " << e.rank << "\n";
}

}  // namespace

Exit terms(const TermsOptions& options, std::ostream& out, std::ostream& messages) {
  const ArmDescription arm = load_urdf(options.model, options.choice);
  require_simulable(arm);
  const TaskRows rows = parse_rows(options.rows);
  std::vector<State> states;
  if (options.states) {
    states = read_states(*options.states, rows, arm);
  } else {
    const auto list = [](const std::string& text, const char* name) {
      return text.empty() ? std::vector<double>() : parse_list(text, name);
    };
    states.push_back(make_state(list(options.q, "--q"), list(options.qd, "--qd"), list(options.u, "--u"),
                                rows, arm, "--"));
  }
  for (const auto& w : arm.warnings) messages << "warning: " << w << "\n";

  Json json(out);
  if (options.json && options.states) json.begin_array();
  bool failed = false;
  std::size_t singular = 0;
  std::array<Residual, judged_terms.size()> worst{};
  for (const State& state : states) {
    require_articulated(arm.chain, arm, state.q);
    const StateTerms e = terms_at(arm.chain, state.q, state.qd, state.u, rows);
    failed = failed || fails(e);
    singular += e.regular() ? 0 : 1;
    for (std::size_t i = 0; i < judged_terms.size(); ++i) {
      const Residual& r = e.residual(judged_terms[i].second);
      if (r.applies && r.bound <= undecided_bound && r.value * worst[i].bound >= worst[i].value * r.bound)
        worst[i] = r;
    }
    if (options.json) {
      write_json(json, arm, e, rows);
    } else if (!options.states) {
      write_text(out, arm, e, rows);
    }
    if (!options.states)
      for (const auto& w : e.warnings) messages << "warning: " << w << "\n";
  }
  if (options.json && options.states) json.end_array();
  if (options.json) {
    out << "\n";
  } else {
    out << states.size() << " states, " << singular
        << " without full rank; worst residual against the dense formulas, and its bound\n";
    for (std::size_t i = 0; i < judged_terms.size(); ++i) {
      char line[96];
      std::snprintf(line, sizeof line, "  %-8s %9.2e  %9.2e\n", judged_terms[i].first, worst[i].value,
                    worst[i].bound);
      out << line;
    }
  }
  return failed ? Exit::claim_failed : Exit::ok;
}

}  // namespace osculate
