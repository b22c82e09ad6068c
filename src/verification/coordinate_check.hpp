// Operational coordinates judged: what their second derivative is, by differentiating the definition of each
// coordinate along the motion of the tip, beside what the law commanded. No Pi appears.
#pragma once

#include <optional>

#include "control/coordinates.hpp"
#include "reference/dense.hpp"

namespace osculate {

/// One instant of a law that tracks coordinates y of its own (1).
struct ChartEvidence {
  int turning = 0;                     // number of orientation coordinates; the others are positions
  Coordinates v;                       // commanded y..
  Coordinates due;                     // what the tracking law says it should be, from the definitions
  Coordinates ydd;                     // reached y..
  Coordinates yd;                      // y., for the scale
  double smallest_singular_value = 1;  // of Pi, at the tip or at its reference
};

/// A tracking law in coordinates: v = ydd_ref + D (yd_ref - yd) + K (y_ref - y). Gains by task row; a
/// quaternion takes the first.
struct ChartLaw {
  const CoordinateChart& chart;
  Vector6 stiffness, damping;  // 1/s^2, 1/s
  TipReference reference;
};

/// v: what the law commanded. `tip` and `betad` (rad/s^2, m/s^2): pose, velocity and acceleration of the
/// plant's tip by the dense side.
ChartEvidence judge_chart(const ChartLaw& law, const Coordinates& v, const dense::Kinematics<double>& tip,
                          const dense::Vector6<double>& betad);

}  // namespace osculate
