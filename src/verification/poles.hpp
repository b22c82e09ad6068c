// The closed loop linearised numerically at rest: its poles against those that the gains place.
#pragma once

#include <complex>
#include <vector>

#include "simulation/closed_loop.hpp"

namespace osculate {

/// d(qd, qdd)/d(q, qd) of the closed loop at (t, y) with y at rest, by central differences of sixth order.
/// One-axis joints: 2 n x 2 n; others throw std::domain_error. The energies are left out. 12 n right sides.
MatrixX<double> linearised(ClosedLoop& loop, double t, std::span<const double> y);

/// Poles of that matrix, 1/s, by real part, then imaginary part.
std::vector<std::complex<double>> poles(const MatrixX<double>& A);

/// Roots of s^2 + D s + K for each gain pair, in the same order; of the two the one further to the left, or
/// with negative imaginary part, first.
std::vector<std::complex<double>> designed_poles(std::span<const double> stiffness,
                                                 std::span<const double> damping);

struct PoleCheck {
  std::vector<std::complex<double>> found, designed;  // 1/s; a redundant arm has more found than designed
  /// Of the designed pole that its own found one comes nearest to, or furthest beyond, its bound: the
  /// distance and the bound, both relative to the magnitude of the pole. A pole at 0 is measured by its row's
  /// other pole, or else by 1/s. The theory holds where worst <= bound; a bound above `undecided_bound`
  /// decides nothing.
  double worst = 0;
  double bound = 0;
  std::size_t at = 0;  // which of `designed`
};

/// Every designed pole against its own found one. For laws that act at every instant and track the rotation
/// vector and the Cartesian position with constant gains, on arms with one-axis joints. Extra poles of a
/// redundant arm, those of its self-motion, are found and not judged. Without null-space damping a resting
/// self-motion drifts: those poles then are at 0, twice each, or are a pendulum's, and a double pole at 0 is
/// found as a pair at about the root of the error. Throws std::domain_error where the loop is not in
/// equilibrium at (t, y), with the acceleration found, and for other laws. A redundant arm under gravity is
/// in equilibrium only where its law or its posture makes it so.
PoleCheck check_poles(ClosedLoop& loop, double t, std::span<const double> y);
/// The same against the poles of gains that need not be the law's own.
PoleCheck check_poles(ClosedLoop& loop, double t, std::span<const double> y, const Vector6& stiffness,
                      const Vector6& damping);

}  // namespace osculate
