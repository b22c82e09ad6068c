#include "verification/error_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osculate {

namespace {

constexpr std::size_t most_bins = 128;
constexpr std::size_t fewest_points = 8;  // of a fit

void merge_neighbours(std::vector<double>& worst) {
  const std::size_t half = (worst.size() + 1) / 2;
  for (std::size_t i = 0; i < half; ++i)
    worst[i] = 2 * i + 1 < worst.size() ? std::max(worst[2 * i], worst[2 * i + 1]) : worst[2 * i];
  worst.resize(half);
}

}  // namespace

void ErrorGrowth::add(double t, double error) {
  if (std::isnan(error)) error = std::numeric_limits<double>::infinity();
  if (width_ == 0 && t > 0) width_ = t;
  std::size_t bin = 0;
  if (t > 0) {
    last_ = t;
    while (t > width_ * static_cast<double>(most_bins)) {
      merge_neighbours(worst_);
      width_ *= 2;
    }
    bin = static_cast<std::size_t>(std::ceil(t / width_)) - 1;
  }
  if (bin >= worst_.size()) worst_.resize(bin + 1, 0.0);
  worst_[bin] = std::max(worst_[bin], error);
}

std::vector<ErrorGrowth::Bin> ErrorGrowth::bins() const {
  std::vector<Bin> out;
  for (std::size_t i = 0; i < worst_.size(); ++i)
    out.push_back({std::min(static_cast<double>(i + 1) * width_, last_), worst_[i]});
  return out;
}

GrowthFit ErrorGrowth::fit(double floor) const {
  const std::vector<Bin> all = bins();
  if (all.empty() || width_ == 0) return {};
  const double start = std::sqrt(all.front().end * all.back().end);
  std::vector<std::pair<double, double>> points;  // log10 of time and of the largest error until then
  std::size_t later = 0;
  double peak = floor;
  for (const Bin& bin : all) {
    peak = std::max(peak, bin.error);
    if (bin.end < start) continue;
    ++later;
    if (peak > 0) points.emplace_back(std::log10(bin.end), std::log10(peak));
  }
  if (later < fewest_points) return {};
  if (std::isinf(peak)) return {std::numeric_limits<double>::infinity(), 0, "worse"};
  if (peak == 0) return {0, 0, "bounded"};
  if (points.size() < fewest_points) return {};

  const double n = static_cast<double>(points.size());
  double mean_t = 0, mean_e = 0, tt = 0, te = 0, squares = 0;
  for (const auto& [t, e] : points) mean_t += t / n, mean_e += e / n;
  for (const auto& [t, e] : points) tt += (t - mean_t) * (t - mean_t), te += (t - mean_t) * (e - mean_e);
  GrowthFit out;
  out.exponent = te / tt;
  for (const auto& [t, e] : points) {
    const double off = e - mean_e - out.exponent * (t - mean_t);
    squares += off * off;
  }
  out.spread = std::sqrt(squares / n);
  out.word = out.exponent < 0.25 ? "bounded" : out.exponent < 1.25 ? "linear" : "worse";
  return out;
}

}  // namespace osculate
