// A force-controlled axis in contact with a plane that is at right angles to it is a linear system: its
// closed-form solution, and how far the run is from it.
#pragma once

#include "control/linear_response.hpp"

namespace osculate {

/// m pdd = desired - pressure - m D pd with pressure = k x + d xd, where p is the tip's way into the material
/// and x = p - p_surface. k N/m, d N s/m, m kg, D 1/s, desired N. With x = desired / k + e it is
/// edd + (D + d/m) ed + (k/m) e = 0.
struct ForceLoop {
  double stiffness = 0, damping = 0;    // of the surface; stiffness > 0
  double inertia = 1, law_damping = 0;  // of the law; inertia > 0
  double desired = 0;                   // N, positive into the material
};

/// Depth x (as e) and its rate (as ed), m and m/s, after `time` >= 0 s in contact, from the given depth and
/// rate.
ErrorState depth_response(const ForceLoop& loop, const ErrorState& start, double time);
/// Pressure at that depth and rate, N.
double pressure(const ForceLoop& loop, const ErrorState& depth);

}  // namespace osculate
