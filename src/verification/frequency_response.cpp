#include "verification/frequency_response.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "scalar/eps.hpp"

namespace osculate {

namespace {

constexpr double root2 = std::numbers::sqrt2;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// sum += x, with what rounding takes kept in `rest`.
void add_exactly(double& sum, double& rest, double x) {
  const double due = x - rest, next = sum + due;
  rest = (next - sum) - due;
  sum = next;
}

}  // namespace

SineFit::SineFit(std::vector<double> frequencies) : frequencies_(std::move(frequencies)) {
  for (const double f : frequencies_)
    if (!(f > 0))
      throw std::domain_error("a frequency of a fit is " + std::to_string(f) + " Hz: must be > 0");
  const auto size = static_cast<Eigen::Index>(2 * frequencies_.size() + 1);
  normal_ = normal_rest_ = MatrixX<double>::Zero(size, size);
  right_ = right_rest_ = basis_ = VectorX<double>::Zero(size);
}

void SineFit::add(double t, double x) {
  if (samples_ == 0) offset_ = x;
  ++samples_;
  latest_ = std::max(latest_, std::abs(t));
  Eigen::Index i = 0;
  for (const double f : frequencies_) {
    const double angle = 2 * std::numbers::pi * f * t;
    basis_[i++] = root2 * std::cos(angle);
    basis_[i++] = root2 * std::sin(angle);
  }
  basis_[i] = 1;
  for (Eigen::Index row = 0; row < basis_.size(); ++row) {
    add_exactly(right_[row], right_rest_[row], basis_[row] * (x - offset_));
    for (Eigen::Index column = 0; column <= row; ++column)
      add_exactly(normal_(row, column), normal_rest_(row, column), basis_[row] * basis_[column]);
  }
}

MatrixX<double> SineFit::equations() const {
  MatrixX<double> out = normal_ / static_cast<double>(samples_);
  for (Eigen::Index row = 0; row < out.rows(); ++row)
    for (Eigen::Index column = 0; column < row; ++column) out(column, row) = out(row, column);
  return out;
}

double SineFit::condition() const {
  const auto size = normal_.rows();
  if (samples_ < size) return infinity;
  const MatrixX<double> G = equations();
  const Eigen::LDLT<MatrixX<double>> factor(G);
  // A pivot below this has lost its digits to the rounding of the sums.
  if (!(factor.vectorD().minCoeff() > static_cast<double>(size) * eps)) return infinity;
  const MatrixX<double> inverse = factor.solve(MatrixX<double>::Identity(size, size));
  const auto norm = [](const MatrixX<double>& A) { return A.cwiseAbs().rowwise().sum().maxCoeff(); };
  return std::sqrt(norm(G) * norm(inverse));
}

std::vector<std::complex<double>> SineFit::amplitudes() const {
  if (!std::isfinite(condition()))
    throw std::domain_error("sine fit: " + std::to_string(samples_) + " samples do not tell " +
                            std::to_string(frequencies_.size()) + " frequencies apart; fit a longer time");
  const VectorX<double> c =
      Eigen::LDLT<MatrixX<double>>(equations()).solve(right_ / static_cast<double>(samples_));
  std::vector<std::complex<double>> out;
  for (Eigen::Index i = 0; i + 1 < c.size(); i += 2) out.emplace_back(root2 * c[i], -root2 * c[i + 1]);
  return out;
}

std::complex<double> designed_response(double stiffness, double damping, double frequency_hz) {
  const double w = 2 * std::numbers::pi * frequency_hz;
  return stiffness / std::complex<double>(stiffness - w * w, damping * w);
}

std::complex<double> sine_amplitude(double amplitude, double phase) {
  return {amplitude * std::sin(phase), -amplitude * std::cos(phase)};
}

double settling_time(double stiffness, double damping, double share) {
  if (!(stiffness > 0) || !(damping > 0)) return infinity;
  if (share >= 1) return 0;
  const double w = std::sqrt(stiffness), alpha = damping / 2;
  const double root = alpha > w ? std::sqrt((alpha - w) * (alpha + w)) : 0;
  const double rate = stiffness < alpha * alpha ? stiffness / (alpha + root) : alpha;  // of the slowest pole
  // |e|, |ed| / w <= (1 + w t) exp(-rate t) of the start: neither sin(x) / x nor (1 - exp(-x)) / x exceeds 1.
  // Found by fixed point from above, where it falls: t = (log(1/share) + log(1 + w t)) / rate.
  const double due = -std::log(share);
  double t = 2 * (due + 2 + std::log1p(w / rate)) / rate;
  for (int i = 0; i < 100; ++i) t = (due + std::log1p(w * t)) / rate;
  return t;
}

double response_bound(const SineFit& tip, std::complex<double> reference, double tip_error) {
  const double condition = tip.condition();
  if (!std::isfinite(condition)) return infinity;
  double size = tip_error, highest = 0;
  for (const auto& amplitude : tip.amplitudes()) size += std::abs(amplitude);
  for (const double f : tip.frequencies()) highest = std::max(highest, 2 * std::numbers::pi * f);
  const double terms = static_cast<double>(2 * tip.frequencies().size() + 1);
  const double angles = 4 * eps * highest * tip.latest() * size;
  const double rounding = 16 * terms * eps * condition * condition * size;
  return (root2 * condition * (tip_error + angles) + rounding) / std::abs(reference);
}

FrequencyResponse compare(const SineFit& tip, const std::vector<std::complex<double>>& reference,
                          double stiffness, double damping, double tip_error) {
  if (reference.size() != tip.frequencies().size())
    throw std::domain_error("frequency response: one reference amplitude for each frequency is needed");
  const auto amplitudes = tip.amplitudes();
  FrequencyResponse out;
  double nearest = -1;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    FrequencyPoint p;
    p.frequency = tip.frequencies()[i];
    p.measured = amplitudes[i] / reference[i];
    p.designed = designed_response(stiffness, damping, p.frequency);
    p.gain = std::abs(p.measured), p.phase = std::arg(p.measured);
    p.designed_gain = std::abs(p.designed), p.designed_phase = std::arg(p.designed);
    p.error = std::abs(p.measured - p.designed);
    p.bound = response_bound(tip, reference[i], tip_error);
    const double ratio = std::isnan(p.error) ? infinity : p.error / p.bound;
    if (ratio > nearest) nearest = ratio, out.worst = p.error, out.bound = p.bound, out.at = p.frequency;
    out.points.push_back(p);
  }
  return out;
}

}  // namespace osculate
