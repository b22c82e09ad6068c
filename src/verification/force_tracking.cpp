#include "verification/force_tracking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verification/step_check.hpp"

namespace osculate {

ForceTracking::ForceTracking(const ClosedLoop& loop) {
  const LawOptions& law = loop.controller().options();
  const auto& environment = loop.plant().environment;
  reach_ = reach(loop.plant().chain);
  rounding_ = 64 * (loop.velocities() + 1) * std::numeric_limits<double>::epsilon() * reach_;
  if (!law.force || !environment) {
    reason_ = "no force is controlled at a surface";
    return;
  }
  if (!loop.plant_is_model()) {
    reason_ = "plant and model differ on purpose";
    return;
  }
  if (const std::string part = omission(law); !part.empty()) {
    reason_ = "the law omits " + part + " on purpose";
    return;
  }
  if (law.sampling) {
    reason_ = "a sampled law is not the continuous one that the closed form solves";
    return;
  }
  const Plane* const plane = std::get_if<Plane>(&environment->surface);
  reason_ = "no controlled force is at right angles to a plane";
  if (!plane) return;
  const Vector3<double> n = plane->normal.normalized();
  for (std::size_t i = 0; i < law.force->rows.size(); ++i) {
    const int row = law.force->rows[i];
    if (row < 3 || std::abs(n[row - 3]) != 1) continue;
    loop_ = {environment->stiffness, environment->damping, law.force->inertia, law.force->damping,
             -n[row - 3] * law.force->desired[i]};
    reason_ = loop_.desired > 0 ? "" : "the desired force pulls";
    return;
  }
}

Residual ForceTracking::assess(const Observation& seen, bool contact, const GlobalError& error) {
  if (!reason_.empty() || !error.known) return {0, 0, false};
  if (!contact || seen.command.filtered || seen.command.saturated) {
    start_.reset();
    return {0, 0, false};
  }
  if (!start_) {
    start_ = {-seen.touch.gap, seen.touch.entry};
    start_time_ = seen.t;
    return {0, 0, false};
  }
  const ErrorState exact = depth_response(loop_, *start_, seen.t - start_time_);
  const double scale = loop_.desired;
  const double off = std::abs(seen.touch.pressure - pressure(loop_, exact));
  const double floor = rounding_ + error.tolerance * reach_;       // m
  const double rate = std::sqrt(loop_.stiffness / loop_.inertia);  // 1/s
  const double allowed = loop_.stiffness * (error_multiple * error.position + floor) +
                         loop_.damping * (error_multiple * error.velocity + floor * rate);
  return {off / scale, allowed / scale, true};
}

}  // namespace osculate
