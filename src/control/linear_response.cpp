#include "control/linear_response.hpp"

#include <cmath>

namespace osculate {

// Roots -alpha +- i omega, omega > 0:
//   e  = exp(-alpha t) (e0 cos(omega t) + (ed0 + alpha e0) s), s = sin(omega t) / omega, which tends to t as
//        omega -> 0, without cancellation
//   ed = exp(-alpha t) (ed0 cos(omega t) - (alpha ed0 + k e0) s)
// Real roots `slow` and slow - gap, gap >= 0. With h = (1 - exp(-gap t)) / gap, which tends to t as gap -> 0:
//   e  = exp(slow t) (e0 + (ed0 - slow e0) h)
//   ed = exp(slow t) (ed0 (exp(-gap t) + slow h) - k e0 h)
// One exponential is factored out, so none overflows, and nothing cancels where the roots meet.

LinearResponse::LinearResponse(double stiffness, double damping, double t) : stiffness_(stiffness) {
  const double alpha = damping / 2;
  const double discriminant =
      std::fma(alpha, alpha, -stiffness);  // rounded once: exact sense of which case it is
  oscillates_ = discriminant < 0;
  if (oscillates_) {
    const double omega = std::sqrt(-discriminant), angle = omega * t;
    rate_ = alpha;
    decay_ = std::exp(-alpha * t);
    kept_ = std::cos(angle);
    moved_ = std::sin(angle) / omega;
    return;
  }
  const double root = std::sqrt(discriminant), gap = 2 * root;
  const double sum = alpha + root;           // minus the fast root
  rate_ = sum > 0 ? -stiffness / sum : 0.0;  // product of the roots = k; alpha - root would cancel
  const double fading = -gap * t;
  decay_ = std::exp(rate_ * t);
  kept_ = std::exp(fading);
  moved_ = gap > 0 ? -std::expm1(fading) / gap : t;
}

ErrorState LinearResponse::from(ErrorState start) const {
  const auto [e, ed] = start;
  if (oscillates_)
    return {decay_ * (e * kept_ + (ed + rate_ * e) * moved_),
            decay_ * (ed * kept_ - (rate_ * ed + stiffness_ * e) * moved_)};
  return {decay_ * (e + (ed - rate_ * e) * moved_),
          decay_ * (ed * (kept_ + rate_ * moved_) - stiffness_ * e * moved_)};
}

}  // namespace osculate
