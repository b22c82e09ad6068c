// The unit in which tolerances are stated.
#pragma once

#include <limits>

namespace osculate {

/// The distance from 1 to the next double; one rounding errs by at most half of it.
inline constexpr double eps = std::numeric_limits<double>::epsilon();

}  // namespace osculate
