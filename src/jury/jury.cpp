#include "jury/jury.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "jury/yardstick.hpp"

namespace osculate::jury {

namespace {

using Matrix = MatrixX<double>;
using Vector = VectorX<double>;

MatrixX<double>& of(Testimony& x, Term term) { return x[static_cast<std::size_t>(term)]; }

Testimony of_recursions(const Evidence& e) {
  Testimony out;
  of(out, Term::qdd) = e.qdd;
  of(out, Term::Omega) = e.recursive.Omega(e.rows, e.rows);
  of(out, Term::Lambda) = e.recursive.Lambda;
  of(out, Term::c) = e.recursive.c;
  of(out, Term::g) = e.recursive.g;
  return out;
}

Testimony of_definitions(const Evidence& e) {
  const auto& [tip, joint] = e.plant;
  return {joint.M,      joint.C,        joint.G,
          tip.J,        tip.Jdot_qd,    dense::forward_dynamics(joint, tip.J, e.net_torque),
          e.task.Omega, e.terms.Lambda, e.terms.c,
          e.terms.g};
}

Matrix by_rows(const std::vector<double>& list, Eigen::Index rows) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = static_cast<Eigen::Index>(list.size());
  if (size % rows != 0 || size == 0) throw std::logic_error("an engine gave a list of the wrong length");
  return Eigen::Map<const Rows>(list.data(), rows, size / rows);
}

std::vector<double> list_of(const Vector& x) { return {x.data(), x.data() + x.size()}; }

/// What a library says, and what follows from it: Omega where it has no call of its own, Lambda, c and g.
Testimony of_engine(const Engine& engine, const Evidence& e, const Vector& q, bool regular) {
  Answer answer;
  engine.answer({list_of(q), list_of(e.qd), list_of(e.net_torque)}, answer);
  const Eigen::Index n = e.qd.size();
  Testimony out;
  of(out, Term::M) = by_rows(answer.M, n);
  of(out, Term::C) = by_rows(answer.C, n);
  of(out, Term::G) = by_rows(answer.G, n);
  of(out, Term::J) = by_rows(answer.J, 6);
  of(out, Term::Jdot_qd) = by_rows(answer.Jdot_qd, 6);
  of(out, Term::qdd) = by_rows(answer.qdd, n);
  const Matrix J = of(out, Term::J)(e.rows, Eigen::all);
  const Eigen::LLT<Matrix> M(of(out, Term::M));
  const Matrix Omega = answer.Omega.empty() ? Matrix(J * M.solve(J.transpose()))
                                            : Matrix(by_rows(answer.Omega, 6)(e.rows, e.rows));
  of(out, Term::Omega) = Omega;
  if (!regular) return out;
  const Eigen::LLT<Matrix> factor(Omega);
  const Vector Jdot_qd = of(out, Term::Jdot_qd)(e.rows, 0);
  of(out, Term::Lambda) = factor.solve(Matrix::Identity(Omega.rows(), Omega.rows()));
  of(out, Term::c) = factor.solve(J * M.solve(of(out, Term::C)) - Jdot_qd);
  of(out, Term::g) = factor.solve(J * M.solve(of(out, Term::G)));
  return out;
}

void compare(const std::vector<Testimony>& all, const Yardstick& yardstick, int state, Verdict& verdict) {
  for (std::size_t t = 0; t < term_count; ++t) {
    const auto term = static_cast<Term>(t);
    Finding& finding = verdict.findings[t];
    const double bound = yardstick.bound(term);
    if (!(bound <= undecided_bound)) {
      ++finding.undecided;
      continue;
    }
    finding.largest_bound = std::max(finding.largest_bound, bound);
    for (Difference& pair : finding.pairs) {
      const double ratio = yardstick.ratio(term, all[pair.a][t], all[pair.b][t]);
      if (!(ratio <= pair.ratio) || pair.state < 0) pair.ratio = ratio, pair.state = state;
    }
  }
}

/// Who stands alone: everybody else agrees without that member, and does not with it.
void conclude(Finding& finding, std::size_t members) {
  std::vector<std::size_t> suspects;
  for (std::size_t member = 0; member < members; ++member) {
    bool others_agree = true, differs = false;
    std::size_t others = 0;
    for (const Difference& pair : finding.pairs) {
      const bool apart = !(pair.ratio <= 1), own = pair.a == member || pair.b == member;
      differs = differs || (own && apart);
      others += !own;
      others_agree = others_agree && (own || !apart);
    }
    if (differs && others_agree && others > 0) suspects.push_back(member);
  }
  for (const Difference& pair : finding.pairs) finding.agree = finding.agree && pair.ratio <= 1;
  if (suspects.size() == 1) finding.alone = suspects.front();
}

}  // namespace

bool Verdict::agree() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.agree; });
}

Verdict hear(const ArmDescription& arm, const JuryOptions& options) {
  Engines engines = load_engines(arm, options.disturbance);
  Verdict out;
  out.absent = engines.absent;
  out.members = {"recursions", "dense"};
  for (const Engine& engine : engines.present) out.members.push_back(engine.name + " " + engine.version);
  const auto forms = [](std::size_t member, Term term) { return member != 0 || term >= Term::qdd; };
  for (std::size_t t = 0; t < term_count; ++t)
    for (std::size_t a = 0; a < out.members.size(); ++a)
      for (std::size_t b = a + 1; b < out.members.size(); ++b)
        if (forms(a, static_cast<Term>(t))) out.findings[t].pairs.push_back({a, b});

  const auto states = random_states(arm, options.states, options.seed);
  for (std::size_t i = 0; i < states.size(); ++i) {
    const VectorX<double>&q = states[i].q, &qd = states[i].qd;
    const auto span = [](const VectorX<double>& x) {
      return std::span<const double>(x.data(), static_cast<std::size_t>(x.size()));
    };
    const StateTerms terms = terms_at(arm.chain, span(q), span(qd), states[i].u, options.rows);
    std::vector<Testimony> all{of_recursions(terms.evidence), of_definitions(terms.evidence)};
    for (const Engine& engine : engines.present)
      all.push_back(of_engine(engine, terms.evidence, q, terms.regular()));
    compare(all, Yardstick(arm.chain, terms, q), static_cast<int>(i), out);
  }
  for (Finding& finding : out.findings) conclude(finding, out.members.size());
  return out;
}

}  // namespace osculate::jury
