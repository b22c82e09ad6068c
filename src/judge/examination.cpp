#include "judge/examination.hpp"

#include <algorithm>
#include <cmath>

namespace osculate {

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;
using Eigen::Index;

Eigen::Vector4d w_first(const Eigen::Vector4d& x, QuaternionOrder order) {
  return order == QuaternionOrder::w_first ? x : Eigen::Vector4d(x[3], x[0], x[1], x[2]);
}

/// Rows of u as the log has them: all six, or the controlled ones; in task rows.
std::vector<int> logged_rows(const JudgeOptions& options, Index columns, RowOrder order) {
  std::vector<int> rows{0, 1, 2, 3, 4, 5};
  if (columns != 6) rows = options.rows;
  if (order == RowOrder::linear_first)
    std::stable_sort(rows.begin(), rows.end(), [](int a, int b) { return (a >= 3) > (b >= 3); });
  return rows;
}

/// tau at t_k + delay, by the cubic through four neighbours. False outside the log.
bool torque_at(const Log& log, Index k, double delay, Vector& out) {
  if (delay == 0) {
    out = log.tau.row(k);
    return true;
  }
  const double t = log.t[static_cast<std::size_t>(k)] + delay;
  const auto after = std::upper_bound(log.t.begin(), log.t.end(), t);
  const Index i = after - log.t.begin() - 2;
  if (i < 0 || i + 4 > log.samples()) return false;
  out.setZero(log.tau.cols());
  for (Index a = i; a < i + 4; ++a) {
    double weight = 1;
    for (Index b = i; b < i + 4; ++b)
      if (b != a)
        weight *= (t - log.t[static_cast<std::size_t>(b)]) /
                  (log.t[static_cast<std::size_t>(a)] - log.t[static_cast<std::size_t>(b)]);
    out += weight * log.tau.row(a).transpose();
  }
  return true;
}

/// Slope at row k of a series of rows, by a straight line through the rows up to `half` away.
Vector slope_at(const Log& log, const Matrix& series, Index k, Index half) {
  const Index from = std::max<Index>(0, k - half), to = std::min(log.samples() - 1, k + half);
  double mean = 0, square = 0;
  for (Index i = from; i <= to; ++i) mean += log.t[static_cast<std::size_t>(i)];
  mean /= static_cast<double>(to - from + 1);
  Vector sum = Vector::Zero(series.cols());
  for (Index i = from; i <= to; ++i) {
    const double dt = log.t[static_cast<std::size_t>(i)] - mean;
    sum += dt * series.row(i).transpose();
    square += dt * dt;
  }
  return sum / square;
}

/// Rows where a torque stands at its largest value, as a saturated one does.
std::vector<bool> saturated_rows(const Log& log) {
  std::vector<bool> out(log.t.size(), false);
  for (Index j = 0; j < log.tau.cols(); ++j) {
    const double most = log.tau.col(j).cwiseAbs().maxCoeff();
    std::vector<std::size_t> there;
    for (Index k = 0; k < log.samples(); ++k)
      if (most > 0 && std::abs(log.tau(k, j)) == most) there.push_back(static_cast<std::size_t>(k));
    if (there.size() < 3) continue;
    for (const std::size_t k : there) out[k] = true;
  }
  return out;
}

/// Standard deviation of white noise on a smooth series, from fourth differences; robust against jumps.
double noise_of(const Vector& series) {
  std::vector<double> size;
  for (Index k = 2; k + 2 < series.size(); ++k)
    size.push_back(
        std::abs(series[k - 2] - 4 * series[k - 1] + 6 * series[k] - 4 * series[k + 1] + series[k + 2]));
  if (size.empty()) return 0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  return 1.4826 * *middle / std::sqrt(70.0);  // median to deviation of a normal law; 1 + 16 + 36 + 16 + 1
}

Vector finite(const Vector& x) {
  std::vector<double> out;
  for (const double v : x)
    if (std::isfinite(v)) out.push_back(v);
  return Eigen::Map<Vector>(out.data(), static_cast<Index>(out.size()));
}

double rms(const Vector& x) {
  const Vector known = finite(x);
  return known.size() > 0 ? known.norm() / std::sqrt(static_cast<double>(known.size())) : 0;
}

constexpr double hopeless = 20;      // scores: so much above its rival an attempt is given up
constexpr int rounds = 8;            // of Gauss and Newton
constexpr double doubt_margin = 12;  // of twice the log-likelihood: odds of 400 to 1
constexpr Index fewest_samples = 20;
constexpr double least_share = 2e-3;  // of a term
constexpr double least_part = 1e-7;   // of the squares of the difference: what noise in the columns makes up

}  // namespace

Sample Samples::at(Index k) const {
  Sample out;
  const Vector q = log_.q.row(k);
  out.q.assign(q.begin(), q.end());
  out.qd = log_.qd.row(k);
  if (log_.u) {
    const auto rows = logged_rows(options_, log_.u->cols(), reading_.u_order);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double value = (*log_.u)(k, static_cast<Index>(i));
      if (std::find(options_.rows.begin(), options_.rows.end(), rows[i]) != options_.rows.end())
        out.u[rows[i]] = value;
    }
  } else {
    const LoggedReference& r = *log_.reference;
    out.quaternion = w_first(r.quaternion.row(k), reading_.quaternion_order);
    out.reference.pose.p = r.position.row(k);
    out.reference.pose.R =
        Eigen::Quaterniond(out.quaternion[0], out.quaternion[1], out.quaternion[2], out.quaternion[3])
            .normalized()
            .toRotationMatrix();
    out.reference.velocity = r.velocity.row(k);
    out.reference.acceleration = r.acceleration.row(k);
  }
  return out;
}

Examination::Examination(const Chain<double>& model, const Log& log, const JudgeOptions& options,
                         const Reading& reading, bool order_known)
    : log_(log),
      options_(options),
      samples_(log, options, reading),
      candidates_(model, options, !log.u, order_known, reading.error_law),
      n_(model.velocities()) {
  for (const Candidate& c : candidates_.list()) groups_.push_back({c.first, c.columns});
  groups_.push_back({candidates_.columns(), 1});
  const std::vector<bool> saturated = saturated_rows(log);
  const Index every = std::max<Index>(1, log.samples() / options.samples);
  for (Index k = every / 2; k < log.samples(); k += every)
    if (saturated[static_cast<std::size_t>(k)])
      ++saturated_;
    else
      chosen_.push_back(k);
}

bool Examination::weigh(const Deviation& none) {
  now_ = {};
  now_.deviation = none;
  now_.difference = gather(none);
  asked_ = std::pow(now_.difference.size, 2);
  weighed_ = now_.difference.regression.d.squaredNorm();
  const Eigen::Index columns = now_.difference.regression.X.cols();
  now_.fits = {{{}, Vector::Zero(columns), Vector::Zero(columns), weighed_, weighed_}};
  // White noise is never larger than what it is part of: then the noise is the floor that rounding sets.
  return now_.difference.size > 0.5 * now_.difference.noise;
}

void Examination::glance() {
  Deviation none;
  none.belief.armature.setZero(n_);
  if (weigh(none)) now_ = solve(none, {}, nullptr, 1);
}

void Examination::explain() {
  Deviation none;
  none.belief.armature.setZero(n_);
  if (!weigh(none)) return;
  std::vector<int> banned;
  now_ = solve(none, banned, nullptr, rounds);
  // An armature that is left out whole changes the arm too much for the first step to find it.
  for (int g = 0; g < delay_group(); ++g) {
    if (id_of(g) != "armature" || candidates_.armature().maxCoeff() == 0) continue;
    Deviation omitted = none;
    omitted.belief.armature = -candidates_.armature();
    omitted.moved = {g};
    Attempt other = solve(omitted, banned, &now_, rounds);
    if (!other.fits.empty() && other.fits.front().score < now_.fits.front().score) now_ = std::move(other);
  }
  while (drop_one(banned)) continue;
}

bool Examination::drop_one(std::vector<int>& banned) {
  const std::vector<int>& moved = now_.deviation.moved;
  for (const int g : best().groups) {
    const bool is_moved = std::find(moved.begin(), moved.end(), g) != moved.end();
    const bool is_gains =
        g != delay_group() && candidates_.list()[static_cast<std::size_t>(g)].kind == CandidateKind::gains;
    const bool idle = !is_gains && explained_by(g) < least_part;
    if (!idle && !is_moved) continue;
    std::vector<int> more = banned;
    more.push_back(g);
    Attempt simpler = solve(without(g, now_.deviation), more, &now_, rounds);
    const double allowed = (idle ? hopeless : 1) * best().score;
    if (simpler.fits.empty() || simpler.fits.front().score > allowed) continue;
    now_ = std::move(simpler);
    banned = std::move(more);
    return true;
  }
  return false;
}

Examination::Attempt Examination::solve(const Deviation& start, const std::vector<int>& banned,
                                        const Attempt* rival, int most) const {
  Attempt out;
  Deviation next = start;
  for (int round = 0; round < most; ++round) {
    Difference difference;
    try {
      difference = gather(next);
    } catch (const LogError&) {
      if (!rival && round == 0) throw;
      break;  // a step into an arm that cannot be
    }
    out.deviation = next;
    out.difference = std::move(difference);
    const Explanations all(out.difference.regression, groups_);
    set_price(all, out);
    std::vector<int> always = out.deviation.moved;
    for (std::size_t g = 0; g < candidates_.list().size(); ++g)
      if (candidates_.list()[g].kind == CandidateKind::gains) always.push_back(static_cast<int>(g));
    out.fits =
        all.search(always, out.price, std::max(doubt_margin * out.noise_square, 1e-2 * least_part * weighed_),
                   [&](const Fit& fit) { return sensible(fit, out.deviation, banned); });
    if (rival && round >= 1 && out.fits.front().score > hopeless * rival->fits.front().score) break;
    bool moved = false;
    for (const int g : out.fits.front().groups) moved = take(g, out, next) || moved;
    if (!moved) break;
  }
  return out;
}

Difference Examination::gather(const Deviation& deviation) const {
  const Index N = log_.samples();
  // The exact torque along the whole log: for its slope and for the noise of the difference.
  Matrix exact = Matrix::Constant(N, n_, std::nan(""));
  Matrix d = exact;
  Vector tau, row;
  for (Index k = 0; k < N; ++k) {
    if (!candidates_.exact(deviation.belief, samples_.at(k), row)) continue;
    exact.row(k) = row;
    if (torque_at(log_, k, deviation.delay, tau)) d.row(k) = tau - row;
  }
  Difference out;
  out.left_out = saturated_;
  out.sigma.resize(n_);
  // Rounding of the largest torques reaches all joints.
  const double rounding = 1e-10 * log_.tau.norm() / std::sqrt(static_cast<double>(log_.tau.size()));
  for (Index j = 0; j < n_; ++j)
    out.sigma[j] = std::max({noise_of(finite(d.col(j))), 3e-7 * rms(d.col(j)), rounding, 1e-300});
  const auto rows = static_cast<Index>(chosen_.size()) * n_;
  const int columns = candidates_.columns() + 1, null_columns = candidates_.null_columns();
  Regression& r = out.regression;
  r.X.resize(rows, columns), r.d.resize(rows);
  out.null.X.resize(null_columns > 0 ? rows : 0, null_columns),
      out.null.d.resize(null_columns > 0 ? rows : 0);
  double squares = 0, noise = 0;
  Index at = 0;
  Candidates::Columns c;
  const Index half = std::max<Index>(2, std::min<Index>(10, N / 20));
  for (const Index k : chosen_) {
    const bool usable =
        d.row(k).allFinite() && exact
                                    .middleRows(std::max<Index>(0, k - half),
                                                std::min(N, k + half + 1) - std::max<Index>(0, k - half))
                                    .allFinite();
    if (!usable || !candidates_.evaluate(deviation.belief, samples_.at(k), c)) {
      ++out.left_out;
      continue;
    }
    const Vector difference = d.row(k), felt = c.P * difference;
    const Vector weight = out.sigma.cwiseInverse();
    squares += felt.squaredNorm(), noise += out.sigma.squaredNorm();
    r.d.segment(at, n_) = weight.cwiseProduct(felt);
    r.X.middleRows(at, n_).leftCols(columns - 1) = weight.asDiagonal() * c.X;
    r.X.col(columns - 1).segment(at, n_) = -weight.cwiseProduct(c.P * slope_at(log_, exact, k, half));
    if (null_columns > 0) {
      out.null.d.segment(at, n_) = weight.cwiseProduct(difference - felt);
      out.null.X.middleRows(at, n_) = weight.asDiagonal() * c.null;
    }
    at += n_;
    ++out.samples;
  }
  if (out.samples < fewest_samples)
    throw LogError(
        log_.source + ": only " + std::to_string(out.samples) + " samples can be used (" +
        std::to_string(out.left_out) + " are singular on the task rows, saturated or not finite); at least " +
        std::to_string(fewest_samples) + " are needed: log a longer motion away from singular poses");
  r.X.conservativeResize(at, Eigen::NoChange), r.d.conservativeResize(at);
  if (null_columns > 0) out.null.X.conservativeResize(at, Eigen::NoChange), out.null.d.conservativeResize(at);
  out.size = std::sqrt(squares / static_cast<double>(at));
  out.noise = std::sqrt(noise / static_cast<double>(at));
  return out;
}

void Examination::set_price(const Explanations& all, Attempt& attempt) const {
  const Fit full = all.full();
  const Vector rest = all.rest(full);
  const auto rows = static_cast<double>(rest.size());
  const double left = rest.squaredNorm() / std::max(1.0, rows - static_cast<double>(full.beta.size()));
  double along = 0;
  for (Index i = 0; i + n_ < rest.size(); ++i) along += rest[i] * rest[i + n_];
  const double rho = std::clamp(along / std::max(rest.squaredNorm(), 1e-300), 0.0, 0.98);
  attempt.noise_square = std::max(1e-4, left) * (1 + rho) / (1 - rho);
  attempt.price = std::max((6 + 2 * std::log(rows)) * attempt.noise_square, least_part * weighed_);
}

bool Examination::sensible(const Fit& fit, const Deviation& deviation, const std::vector<int>& banned) const {
  Deviation there = deviation;
  for (const int g : fit.groups) {
    if (std::find(banned.begin(), banned.end(), g) != banned.end()) return false;
    add_step(g, fit, there);
    if (g == delay_group()) continue;
    const Candidate& c = candidates_.list()[static_cast<std::size_t>(g)];
    const double first = fit.beta[c.first];
    // A constant inertia in place of Lambda means that Lambda is gone.
    if (c.id == "constant_lambda" && std::abs(first - 1) > 0.1) return false;
    // Noise in the columns bends coefficients by its share of them, which is no mistake.
    const double least = c.id == "gravity" ? least_share / 20 : least_share;  // others' g differs by 3e-4
    if ((c.kind == CandidateKind::term || c.kind == CandidateKind::mistake) && c.columns == 1 &&
        std::abs(first) < least)
      return false;
  }
  const double seconds = log_.t.back() - log_.t.front();
  return candidates_.possible(there.belief) && there.delay >= -1e-4 * seconds && there.delay < 0.1 * seconds;
}

bool Examination::add_step(int g, const Fit& fit, Deviation& deviation) const {
  const ColumnGroup& group = groups_[static_cast<std::size_t>(g)];
  const Vector step = fit.beta.segment(group.first, group.columns);
  const std::string id = id_of(g);
  if (id == "delay") {
    deviation.delay += step[0];
  } else if (id == "armature") {
    deviation.belief.armature =
        (deviation.belief.armature + step).cwiseMax(-candidates_.armature());  // none is negative
  } else if (id == "payload") {
    deviation.belief.payload += step;
  } else if (id == "tip_point") {
    deviation.belief.tip_offset += step;
  } else {
    return false;
  }
  return true;
}

double Examination::left(const Difference& difference, const Fit& fit) const {
  const Vector rest = difference.regression.d - difference.regression.X * fit.beta;
  double squares = 0;
  for (Index i = 0; i < rest.size(); ++i) squares += std::pow(rest[i] * difference.sigma[i % n_], 2);
  return squares / static_cast<double>(rest.size());
}

double Examination::rest() const { return asked_ > 0 ? left(now_.difference, best()) / asked_ : 0; }

double Examination::explained_by(int g) const {
  std::vector<int> others = best().groups;
  std::erase(others, g);
  const std::vector<int>& moved = now_.deviation.moved;
  const bool in_deviation = std::find(moved.begin(), moved.end(), g) != moved.end();
  Difference there;
  try {
    there = in_deviation ? gather(without(g, now_.deviation)) : now_.difference;
  } catch (const LogError&) {
    return 1;  // without it the rest is no arm
  }
  const double more =
      left(there, Explanations(there.regression, groups_).fit(others)) - left(now_.difference, best());
  return asked_ > 0 ? std::clamp(more / asked_, 0.0, 1.0) : 0;
}

std::string Examination::id_of(int g) const {
  return g == delay_group() ? "delay" : candidates_.list()[static_cast<std::size_t>(g)].id;
}

bool Examination::take(int g, const Attempt& attempt, Deviation& deviation) const {
  const ColumnGroup& group = groups_[static_cast<std::size_t>(g)];
  const Fit& fit = attempt.fits.front();
  if (!add_step(g, fit, deviation)) return false;
  if (std::find(deviation.moved.begin(), deviation.moved.end(), g) == deviation.moved.end())
    deviation.moved.push_back(g);
  const Vector step = fit.beta.segment(group.first, group.columns);
  const Vector uncertain =
      fit.deviation.segment(group.first, group.columns) * std::sqrt(attempt.noise_square);
  return (step.cwiseAbs() - 0.1 * uncertain).maxCoeff() > 0;
}

Deviation Examination::without(int g, Deviation deviation) const {
  const std::string id = id_of(g);
  if (id == "delay") deviation.delay = 0;
  if (id == "armature") deviation.belief.armature.setZero();
  if (id == "payload") deviation.belief.payload.setZero();
  if (id == "tip_point") deviation.belief.tip_offset.setZero();
  std::erase(deviation.moved, g);
  return deviation;
}

}  // namespace osculate
