#include "control/singular_task.hpp"

#include <cmath>

#include "control/task_inverse.hpp"

namespace osculate {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

double smooth_measure(const Compliance<double>& Omega, const TaskRows& rows) {
  return TaskInverse(Omega, rows).measure();
}

double filtered_inverse(const SingularityOptions& options, double sigma) {
  const double x = sigma / options.threshold;
  if (x < 1 && options.policy == SingularPolicy::damped) {
    const double lambda = options.damping * (1 - x * x);
    return sigma / (sigma * sigma + lambda * lambda);
  }
  if (x < 1 && options.policy == SingularPolicy::released)  // x^3 (10 - 15 x + 6 x^2) / sigma
    return x > 0 ? x * x * (10 + x * (6 * x - 15)) / options.threshold : 0.0;
  return 1 / sigma;
}

SingularTask::SingularTask(const SingularityOptions& options, const Compliance<double>& Omega,
                           const TaskRows& rows, int truncated)
    : options_(options), m_(static_cast<int>(rows.size())), truncated_(truncated) {
  const TaskInverse inverse(Omega, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) w_[i] = std::sqrt(inverse.squared_scale()[i]);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows.size(); ++j)
      S_[i][j] = component(Omega, rows[i], rows[j]) / (w_[i] * w_[j]);
  switch (options.policy) {
    case SingularPolicy::none:
      return;
    case SingularPolicy::truncated:
      active_ = truncated > 0;
      return;
    case SingularPolicy::damped:
    case SingularPolicy::released:
      // The measure never exceeds the smallest eigenvalue, and costs less.
      if (inverse.measure() >= options.threshold) return;
      for (int k = 0; k < m_; ++k) active_ |= !(eigenvalues()[index(k)] >= options.threshold);  // NaN too
  }
}

const TaskVector<double>& SingularTask::eigenvalues() const {
  if (spectrum_) return spectrum_->values;
  if (!eigenvalues_) eigenvalues_ = osculate::eigenvalues(S_, m_);
  return *eigenvalues_;
}

const Spectrum& SingularTask::spectrum() const {
  if (!spectrum_) spectrum_ = osculate::spectrum(S_, m_);
  return *spectrum_;
}

TaskVector<double> SingularTask::solve(const TaskVector<double>& right) const {
  const auto& [sigma, v] = spectrum();
  TaskVector<double> out{};
  // W^-1 V f(sigma) V* W^-1 right
  for (int k = options_.policy == SingularPolicy::truncated ? truncated_ : 0; k < m_; ++k) {
    double along = 0;
    for (int i = 0; i < m_; ++i) along += v[index(k)][index(i)] * right[index(i)] / w_[index(i)];
    along *= filtered_inverse(options_, sigma[index(k)]);
    for (int i = 0; i < m_; ++i) out[index(i)] += v[index(k)][index(i)] * along / w_[index(i)];
  }
  return out;
}

int SingularTask::weakest_row() const {
  const TaskVector<double>& v = spectrum().vectors[0];
  int out = 0;
  for (int i = 1; i < m_; ++i)
    if (std::abs(v[static_cast<std::size_t>(i)]) > std::abs(v[static_cast<std::size_t>(out)])) out = i;
  return out;
}

}  // namespace osculate
