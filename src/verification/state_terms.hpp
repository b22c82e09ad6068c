// The terms of one arm at one state, both ways, without a run: what `osculate terms` prints.
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "verification/claims.hpp"

namespace osculate {

/// Both sides at one state, by the lines that a run uses. Base frame, about the tip point; joints base to
/// tip; task quantities on the chosen rows.
struct StateTerms {
  Evidence evidence;
  Residuals residuals;
  int rank = 0;          // of Omega scaled to unit diagonal
  double condition = 0;  // of the same; infinite where the rank is lost
  std::vector<std::string> warnings;

  /// Lambda, c, g, F, T and qdd exist: Omega has full rank.
  bool regular() const { return evidence.terms.Lambda.size() > 0; }
  /// Residual and bound of one claim.
  const Residual& residual(Claim claim) const { return residuals[index(claim)]; }
};

/// The terms that are judged at a state, by their names in `osculate terms --json`.
inline constexpr std::array<std::pair<const char*, Claim>, 6> judged_terms{
    {{"Omega", Claim::omega},
     {"Lambda", Claim::lambda},
     {"c", Claim::c},
     {"g", Claim::g},
     {"T", Claim::torque},
     {"qdd", Claim::forward_dynamics}}};

/// Evaluates the law (4) with the command u (rad/s^2, m/s^2) at q (chain.positions() numbers) and qd
/// (chain.velocities() numbers), and judges it. rows: distinct, 0..5. Where Omega has not full rank, the
/// terms that need its inverse are empty and a warning says so.
StateTerms terms_at(const Chain<double>& chain, std::span<const double> q, std::span<const double> qd,
                    const Vector6& u, const TaskRows& rows);

/// True if a residual exceeds its bound.
bool fails(const StateTerms& terms);

/// F = Lambda u + c + g, T = J^T F and qdd under that T.
struct DenseForce {
  VectorX<double> F, T, qdd;  // m; n; n
};
/// By the definitions, where terms.regular().
DenseForce dense_force(const StateTerms& terms);

}  // namespace osculate
