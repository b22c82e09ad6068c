// The exact side of tables.hpp: the same functions over fractions. Slow to compile, so it stands alone.
#include "paper/question.hpp"
#include "paper/recursions.hpp"
#include "paper/tables.hpp"
#include "reference/exact.hpp"

namespace osculate::paper {

namespace {

using Q = Rational;

JointType type_of(char letter) {
  switch (letter) {
    case 'P':
      return JointType::prismatic;
    case 'C':
      return JointType::cylindrical;
    case 'U':
      return JointType::universal;
    case 'L':
      return JointType::planar;
    case 'S':
      return JointType::spherical;
    case 'F':
      return JointType::floating;
    default:
      return JointType::revolute;
  }
}

void judge(ProofRow& row, const Sides<Q>& sides) {
  ++row.judged;
  row.nonzero += dense::residual(sides) != 0;
}

void prove_on(const ExactArm& arm, std::uint64_t seed, Proof& proof) {
  ++proof.arms;
  const Trial<Q> t = trial(question(arm.chain, arm.positions, arm.qd, seed, Q(0)));
  std::size_t i = 0;
  for (const auto& identity : dense::identities<Q>()) {
    ProofRow& row = proof.statements[i++];
    if (!identity.regular_tip || t.ask.rows.size() == 6) judge(row, identity.sides(t.x));
  }
  for (const auto& recursion : recursions<Q>()) {
    ProofRow& row = proof.statements[i++];
    if (!recursion.square || t.swept.torque.resolved.size() > 0) judge(row, recursion.sides(t));
  }
  i = 0;
  for (const auto& printed : dense::printed_errors<Q>()) judge(proof.printed[i++], printed.sides(t.x));
  judge(proof.printed[i], printed_section_4_3(t));
}

}  // namespace

const std::vector<std::string>& mixed_kinds() {
  static const std::vector<std::string> kinds{"RSR", "RFR", "USU", "CCUU", "SPSR", "LRRR", "FRR", "RUSCP"};
  return kinds;
}

Proof prove(int n_from, int n_to, int each, int mixed, std::uint64_t first_seed) {
  Proof proof;
  for (const Statement& s : statements()) proof.statements.push_back({s});
  for (const Statement& s : printed_forms()) proof.printed.push_back({s});
  const auto seeds = [&](int count, const auto& make) {
    for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(count); ++seed)
      prove_on(make(seed), seed, proof);
  };
  // Rotations of small quaternions: the fractions stay short.
  for (int n = n_from; n <= n_to; ++n) seeds(each, [n](std::uint64_t seed) { return exact_arm(seed, n, 1); });
  for (const std::string& kind : mixed_kinds()) {
    std::vector<JointType> types;
    for (const char letter : kind) types.push_back(type_of(letter));
    seeds(mixed, [&types](std::uint64_t seed) { return exact_arm_of(seed, types, 1); });
  }
  return proof;
}

}  // namespace osculate::paper
