#include "verification/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/rotation.hpp"
#include "scalar/eps.hpp"
#include "verification/step_check.hpp"

namespace osculate {

namespace {

constexpr int nothing_moved = -1000;  // below every power of ten of a double

/// value / bound, where 0 / 0 is 0.
double ratio(double value, double bound) {
  if (bound > 0) return value / bound;
  return value == 0 ? 0 : std::numeric_limits<double>::infinity();
}

bool none_of(const std::array<bool, 6>& rows) {
  return std::none_of(rows.begin(), rows.end(), [](bool b) { return b; });
}

double total_energy(const auto& seen) { return seen.kinetic + seen.potential; }
double supplied(const auto& seen) { return seen.work - seen.dissipated + seen.external_work; }

}  // namespace

void GlobalError::add(const Observation& run, const Whereabouts& shadow) {
  known = true;
  const Pose &a = run.command.tip, &b = shadow.tip.pose;
  position_now = (a.p - b.p).norm();
  position = std::max(position, position_now);
  velocity = std::max(velocity, (run.command.tip_velocity - shadow.tip.velocity).tail<3>().norm());
  for (std::size_t i = 0; i < run.q.size(); ++i) joints = std::max(joints, std::abs(run.q[i] - shadow.q[i]));
  orientation = std::max(orientation, log_rotation(a.R * b.R.transpose()).norm());
  energy =
      std::max(energy, std::abs(total_energy(run) - total_energy(shadow)) + std::abs(run.work - shadow.work) +
                           std::abs(run.dissipated - shadow.dissipated) +
                           std::abs(run.external_work - shadow.external_work));
  imbalance = std::max(
      imbalance, std::abs(total_energy(run) - supplied(run) - (total_energy(shadow) - supplied(shadow))));
}

TrajectoryClaims::TrajectoryClaims(const ClosedLoop& loop, const Observation& start)
    : options_(loop.controller().options()),
      path_(loop.controller().shared_path()),
      initial_(loop.controller().initial()),
      reach_(reach(loop.plant().chain)),
      joints_(loop.velocities()),
      controlled_(options_.law != Law::free),
      segment_(start.command.error),
      energy_start_(total_energy(start)),
      potential_start_(start.potential) {
  plant_is_model_ = loop.plant_is_model();
  const double gravity = std::max(1.0, loop.plant().chain.gravity.norm());  // m/s^2; some arms float in space
  double weight = 0;                                                        // N
  for (const auto& link : loop.plant().chain.links) weight += link.mass * gravity;
  energy_floor_ = 1e-9 * weight * reach_;
  const bool own[] = {options_.orientation != OrientationCoordinates::rotation_vector,
                      options_.position != PositionCoordinates::cartesian};
  for (const int row : options_.rows) controlled_rows_[static_cast<std::size_t>(row)] = !own[row / 3];
  if (options_.force)
    for (const int row : options_.force->rows) controlled_rows_[static_cast<std::size_t>(row)] = false;
  pushed_ = loop.plant().environment || !loop.plant().tip_force.isZero(0);
  const int angular = controlled_rows_[0] + controlled_rows_[1] + controlled_rows_[2];
  angular_ = angular == 0 || angular == 3;
  commanded_ = path_->commanded_from(0);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double zero = rounding() * (i < 3 ? 1 : reach_);  // rad, m, and per second
    clean_[i] = commanded_[i] || (std::abs(segment_.e[row]) <= zero && std::abs(segment_.ed[row]) <= zero);
  }
}

std::array<bool, 6> TrajectoryClaims::uncommanded() const {
  std::array<bool, 6> out{};
  for (std::size_t i = 0; i < 6; ++i) out[i] = controlled_rows_[i] && !commanded_[i] && clean_[i];
  return out;
}

double TrajectoryClaims::rounding() const { return 16 * (joints_ + 1) * eps; }

std::string TrajectoryClaims::reason(Claim claim) const {
  if (claim == Claim::energy)
    return options_.base_path ? "the drive of the moving base does work that is not measured" : "";
  if (!controlled_) return "no tip command in a free swing";
  if (options_.sampling) return "a sampled law is not the continuous one that the closed form solves";
  if (none_of(controlled_rows_))
    return options_.force ? "no row is under position control"
                          : "the law tracks coordinates of its own: see the claim coordinates";
  if (!plant_is_model_) return "plant and model differ on purpose";
  if (const std::string part = omission(options_); !part.empty())
    return "the law omits " + part + " on purpose";
  if (!options_.feedforward && path_->moves()) return "without feed-forward the reference drives the error";
  if (!options_.obstacles.empty()) return "the field of an obstacle acts on u";
  if (options_.virtual_inertia && pushed_) return "the wrench on the tip acts on u";
  if (left_the_law_) return "a singularity policy or a torque limit acted";
  if (!angular_) return "only part of the rotation is controlled: its rows do not decouple";
  if (claim == Claim::decoupling && none_of(uncommanded())) return "every controlled axis is commanded";
  return "";
}

PoseError TrajectoryClaims::exact_error(double t) const {
  const Vector6 &K = options_.stiffness, &D = options_.damping;
  const double since = t - segment_start_;
  LinearResponse response(K[0], D[0], since);
  PoseError out;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (i > 0 && !(K[i] == K[i - 1] && D[i] == D[i - 1])) response = LinearResponse(K[i], D[i], since);
    const ErrorState s = response.from({segment_.e[i], segment_.ed[i]});
    out.e[i] = s.e;
    out.ed[i] = s.ed;
  }
  return out;
}

void TrajectoryClaims::restart_at(double t) {
  // The tip goes on from where the closed form has it; only the reference may jump.
  const PoseError exact = exact_error(t);
  const TipReference before = tip_reference(*path_, initial_, std::nextafter(t, 0.0));
  const TipReference after = tip_reference(*path_, initial_, t);
  const Pose tip = exact_tip(before, exact.e);
  Vector6 velocity = before.velocity - exact.ed;  // linear part: v = v_ref - ed
  // angular part: delta = omega_ref - E omega, with E = R_ref R^T and delta = J_l(e) ed
  const Matrix3<double> E = before.pose.R * tip.R.transpose();
  velocity.head(3) =
      E.transpose() * (before.velocity.head(3) - left_jacobian(exact.e.head(3)) * exact.ed.head(3));
  segment_ = pose_error(after, tip, velocity);
  segment_start_ = t;
  commanded_ = path_->commanded_from(t);
}

Residual TrajectoryClaims::energy(const Observation& seen, const GlobalError& error) {
  const double imbalance = std::abs(total_energy(seen) - energy_start_ - supplied(seen));
  energy_scale_ =
      std::max(energy_scale_, seen.kinetic + std::abs(seen.work) + seen.dissipated +
                                  std::abs(seen.external_work) + std::abs(seen.potential - potential_start_));
  // Each energy is a sum of n products, rounded relative to its own size, the potential to that of its terms.
  const double terms = energy_scale_ + std::abs(seen.potential) + std::abs(energy_start_);
  const double bound = error_multiple * error.imbalance + rounding() * terms;
  if (!error.known) return {0, 0, false};
  tolerance_ = error.tolerance;
  ++energy_steps_;
  widest_bound_ = std::max(widest_bound_, bound);
  const int decade =
      energy_scale_ > 0 ? static_cast<int>(std::floor(std::log10(energy_scale_))) : nothing_moved;
  Imbalance& worst = worst_imbalance_[decade];
  if (worst.bound == 0 || !(ratio(imbalance, bound) < ratio(worst.value, worst.bound)))
    worst = {imbalance, bound, seen.t};
  if (energy_scale_ == 0) return {imbalance == 0 ? 0 : std::numeric_limits<double>::infinity(), 0, true};
  return {imbalance / energy_scale_, bound / energy_scale_, true};
}

ClaimResult TrajectoryClaims::energy_result() const {
  ClaimResult out;
  out.checked_steps = energy_steps_;
  if (energy_steps_ == 0) {
    out.reason = options_.base_path ? reason(Claim::energy) : "no shadow run: verify.shadow is false";
    return out;
  }
  // Before the energies reach a millionth of what the run moves there is nothing to balance yet.
  const int last =
      energy_scale_ > 0 ? static_cast<int>(std::floor(std::log10(energy_scale_))) : nothing_moved;
  Imbalance worst;
  const double allowed = tolerance_ * energy_scale_;  // J, by the tolerance of one step
  for (const auto& [decade, instant] : worst_imbalance_)
    if (decade >= last - 6 &&
        !(ratio(instant.value, instant.bound + allowed) < ratio(worst.value, worst.bound))) {
      worst = instant;
      worst.bound += allowed;
    }
  if (energy_scale_ <= energy_floor_ && worst.value <= worst.bound) {
    out.reason = "the arm rests: it moves no energy to balance";
    return out;
  }
  out.at_time = worst.time;
  out.worst = {worst.value / energy_scale_, worst.bound / energy_scale_, true};
  if (!(worst.value <= worst.bound)) {
    out.outcome = Outcome::fail;
    out.reason = "residual above its bound";
  } else if (!(widest_bound_ <= undecided_bound * energy_scale_)) {
    out.outcome = Outcome::fail;
    out.reason = "undecided: the global error of the energies is above 1e-3 of what moved";
    out.undecided_steps = energy_steps_;
  } else {
    out.outcome = Outcome::pass;
  }
  return out;
}

Residual TrajectoryClaims::pose_residual(const Vector6& difference, const std::array<bool, 6>& rows,
                                         const GlobalError& error) const {
  double angle = 0, distance = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!rows[i]) continue;
    double& largest = i < 3 ? angle : distance;
    largest = std::max(largest, std::abs(difference[static_cast<Eigen::Index>(i)]));
  }
  const double floor = rounding() + error.tolerance;
  const Residual turned{angle, error_multiple * error.orientation + floor, error.known};
  const Residual moved{distance / reach_, error_multiple * error.position / reach_ + floor, error.known};
  return turned.value * moved.bound > moved.value * turned.bound ? turned : moved;
}

Residuals TrajectoryClaims::assess(const Observation& seen, const GlobalError& error) {
  Residuals out;
  out.fill({0, 0, false});
  if (reason(Claim::energy).empty()) out[index(Claim::energy)] = energy(seen, error);
  left_the_law_ = left_the_law_ || seen.command.filtered || seen.command.saturated;
  off_.reset();
  if (!reason(Claim::analytic_response).empty()) return out;
  const Vector6 off = seen.command.error.e - exact_error(seen.t).e;
  off_ = off;
  out[index(Claim::analytic_response)] = pose_residual(off, controlled_rows_, error);
  if (controlled_rows_[3] || controlled_rows_[4] || controlled_rows_[5]) {
    double squares = 0;
    for (int i = 3; i < 6; ++i)
      if (controlled_rows_[static_cast<std::size_t>(i)]) squares += off[i] * off[i];
    worst_position_ = std::max(worst_position_, std::sqrt(squares));
  }
  if (controlled_rows_[0]) worst_orientation_ = std::max(worst_orientation_, off.head(3).norm());
  if (reason(Claim::decoupling).empty())
    out[index(Claim::decoupling)] = pose_residual(off, uncommanded(), error);
  return out;
}

}  // namespace osculate
