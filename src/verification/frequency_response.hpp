// Gain and phase of the tip against a reference that is a sum of sines, measured over a whole run in constant
// memory.
#pragma once

#include <complex>
#include <vector>

#include "control/memory.hpp"
#include "model/chain.hpp"

namespace osculate {

/// Least squares fit of x(t) = sum_i a_i cos(w_i t) + b_i sin(w_i t) + constant to samples that come one by
/// one. The sums carry their own rounding (Kahan 1965), so that a long run is fitted as well as a short one.
class SineFit {
 public:
  explicit SineFit(std::vector<double> frequencies /* Hz, distinct, > 0 */);
  void add(double t, double x);
  long samples() const { return samples_; }
  const std::vector<double>& frequencies() const { return frequencies_; }
  /// Largest |t|, s.
  double latest() const { return latest_; }
  /// Complex amplitude a_i - j b_i of each frequency: x = Re(amplitude exp(j w t)). Throws std::domain_error
  /// where the samples do not tell the frequencies apart: fewer than 2 m + 1, or too short a time.
  std::vector<std::complex<double>> amplitudes() const;
  /// Condition number of the normal equations' square root, at most sqrt(2 m + 1) too large: how much an
  /// error in x grows. Errors of at most e in every x make at most sqrt(2) condition() e in an amplitude. 1
  /// at best, which many whole periods of all frequencies come near. Infinite where amplitudes() throws.
  double condition() const;
  void remember(Memory& memory) {
    memory(normal_, normal_rest_, right_, right_rest_, offset_, latest_, samples_);
  }

 private:
  /// The scaled equations: basis sqrt(2) cos, sqrt(2) sin, 1, divided by the number of samples.
  MatrixX<double> equations() const;

  std::vector<double> frequencies_;
  MatrixX<double> normal_, normal_rest_;  // lower triangle; what rounding took from it
  VectorX<double> right_, right_rest_, basis_;
  double offset_ = 0;  // the first x, which is taken from all: a large constant would cost digits
  double latest_ = 0;  // s
  long samples_ = 0;
};

/// Transfer from reference to tip on one axis of a law without feed-forward, u = K (r - x) - D xd:
/// K / (K - w^2 + j D w).
std::complex<double> designed_response(double stiffness, double damping, double frequency_hz);

/// Complex amplitude of A sin(w t + phase): -j A exp(j phase).
std::complex<double> sine_amplitude(double amplitude, double phase);

/// Time, s, after which e'' + D e' + K e = 0 has decayed to `share` of |e0| + |ed0| / sqrt(K), in e and in
/// ed / sqrt(K). Infinite for K = 0 or D = 0. A fit should begin after it, with a share below its error.
double settling_time(double stiffness, double damping, double share);

/// What one frequency shows. Gain: ratio of amplitudes; phase: rad, in (-pi, pi], negative where the tip is
/// late.
struct FrequencyPoint {
  double frequency = 0;  // Hz
  std::complex<double> measured, designed;
  double gain = 0, phase = 0, designed_gain = 0, designed_phase = 0;
  double error = 0;  // |measured - designed|
  double bound = 0;  // what a given error of the tip allows
};
struct FrequencyResponse {
  std::vector<FrequencyPoint> points;
  double worst = 0, bound = 0;  // error and bound of the point with the largest error / bound
  double at = 0;                // Hz
};

/// `tip`: fit of the tip's displacement along one row; `reference`: complex amplitude of the same frequencies
/// in the reference, rad or m, none of them 0; gains of that row. `tip_error`, rad or m: bound of the tip's
/// distance from the exact solution at every sample, the remains of the transient included.
FrequencyResponse compare(const SineFit& tip, const std::vector<std::complex<double>>& reference,
                          double stiffness, double damping, double tip_error);

/// Error of the complex gain that an error of at most `tip_error` at every sample can make, with the rounding
/// of the fit and of the angles w t in fit and reference, which grows with time: with |tip| the sum of the
/// amplitudes and w the highest frequency, (sqrt(2) condition (tip_error + 4 eps w t |tip|) + 16 (2 m + 1)
/// eps condition^2 |tip|) / |reference|.
double response_bound(const SineFit& tip, std::complex<double> reference, double tip_error);

}  // namespace osculate
