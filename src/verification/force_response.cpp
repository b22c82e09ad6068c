#include "verification/force_response.hpp"

namespace osculate {

ErrorState depth_response(const ForceLoop& loop, const ErrorState& start, double time) {
  const double rest = loop.desired / loop.stiffness;
  const double stiffness = loop.stiffness / loop.inertia;
  const double damping = loop.law_damping + loop.damping / loop.inertia;
  const ErrorState error = linear_response(stiffness, damping, {start.e - rest, start.ed}, time);
  return {rest + error.e, error.ed};
}

double pressure(const ForceLoop& loop, const ErrorState& depth) {
  return loop.stiffness * depth.e + loop.damping * depth.ed;
}

}  // namespace osculate
