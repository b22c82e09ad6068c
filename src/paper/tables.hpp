// The paper as a table: every numbered equation that can be checked, at states of an arm in double, and over
// exact fractions. Equations: Kreutz-Delgado, Jain & Rodriguez (1992), corrected where the print is wrong.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/chain.hpp"

namespace osculate::paper {

/// One statement, as identities() and recursions() list them; identities of operators first.
struct Statement {
  const char* equation;
  const char* statement;
  const char* place;  // function under src/reference or src/recursion
};
const std::vector<Statement>& statements();
/// Forms that the paper prints and that do not hold.
const std::vector<Statement>& printed_forms();

/// Residuals of all statements at one state, in the order of `statements`: max |left - right| over the
/// largest magnitude of the terms that were added. NaN where a statement does not apply. q, qd base to tip;
/// the seed draws command, torques, forces and a moving base. Cost: some ms for six joints.
std::vector<double> residuals(const Chain<double>& chain, const VectorX<double>& q, const VectorX<double>& qd,
                              std::uint64_t seed);

/// A random state of the chain: angles anywhere, displacements within 0.5 m, rates within 2 rad/s or m/s.
struct RandomState {
  VectorX<double> q, qd;
};
RandomState random_state(const Chain<double>& chain, std::uint64_t seed);

/// A statement over some states of one arm. pass: worst <= bound in every state judged.
struct Row {
  Statement about;
  double worst = 0;
  double bound = 0;  // constant of paper/bounds.hpp times eps
  int judged = 0;    // 0: does not apply to this arm
  bool pass() const { return worst <= bound; }
};
std::vector<Row> check(const Chain<double>& chain, int states, std::uint64_t first_seed = 1);

/// A statement over exact fractions.
struct ProofRow {
  Statement about;
  int judged = 0, nonzero = 0;  // arms on which it was evaluated, and on which its sides differ
};
struct Proof {
  int arms = 0;
  std::vector<ProofRow> statements, printed;
};
/// `each` random arms of revolute and prismatic joints for every n = n_from ... n_to, and with `mixed` arms
/// of all other joint types too. Rotations, inertias, positions and rates are fractions; there is no
/// rounding. Cost: about 1 s for an arm of six joints.
Proof prove(int n_from, int n_to, int each, int mixed, std::uint64_t first_seed = 1);
/// The kinds of mixed arms that `prove` draws from, base to tip: R P C U L (planar) S F.
const std::vector<std::string>& mixed_kinds();

}  // namespace osculate::paper
