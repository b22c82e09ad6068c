#include "control/linear_response.hpp"

#include <cmath>

namespace osculate {

namespace {

/// Roots -alpha +- i omega, omega > 0.
ErrorState under_damped(double stiffness, double alpha, double omega, ErrorState start, double t) {
  const double angle = omega * t;
  const double decay = std::exp(-alpha * t);
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle) / omega;  // tends to t as omega -> 0, without cancellation
  return {decay * (start.e * cosine + (start.ed + alpha * start.e) * sine),
          decay * (start.ed * cosine - (alpha * start.ed + stiffness * start.e) * sine)};
}

/// Real roots `slow` and slow - gap, gap >= 0. With h = (1 - exp(-gap t)) / gap, which tends to t as gap ->
/// 0:
///   e  = exp(slow t) (e0 + (ed0 - slow e0) h)
///   ed = exp(slow t) (ed0 (exp(-gap t) + slow h) - k e0 h)
/// One exponential is factored out, so none overflows, and nothing cancels where the roots meet.
ErrorState real_roots(double stiffness, double slow, double gap, ErrorState start, double t) {
  const double fading = -gap * t;
  const double h = gap > 0 ? -std::expm1(fading) / gap : t;
  const double decay = std::exp(slow * t);
  return {decay * (start.e + (start.ed - slow * start.e) * h),
          decay * (start.ed * (std::exp(fading) + slow * h) - stiffness * start.e * h)};
}

}  // namespace

ErrorState linear_response(double stiffness, double damping, ErrorState start, double t) {
  const double alpha = damping / 2;
  const double discriminant =
      std::fma(alpha, alpha, -stiffness);  // rounded once: exact sense of which case it is
  if (discriminant < 0) return under_damped(stiffness, alpha, std::sqrt(-discriminant), start, t);
  const double root = std::sqrt(discriminant);
  const double sum = alpha + root;  // minus the fast root
  const double slow =
      sum > 0 ? -stiffness / sum : 0.0;  // product of the roots = k; alpha - root would cancel
  return real_roots(stiffness, slow, 2 * root, start, t);
}

}  // namespace osculate
