// How the error of a run grows with time: bounded, linear or worse, fitted in constant memory.
#pragma once

#include <string>
#include <vector>

#include "control/memory.hpp"

namespace osculate {

/// error ~ time^exponent, by least squares over the later half of log time, of the largest error so far: an
/// error that oscillates counts by its peaks, and one that decays as constant.
///
/// The words split what integration errors do. Where the loop contracts, old errors die out: exponent 0.
/// Where it does not, random errors add up to t^(1/2) and systematic ones to t; integrated once more, as the
/// phase is that follows from an energy, to t^(3/2) (Brouwer 1937) and t^2. The limits lie halfway: 1/4 and
/// 5/4. A single random walk scatters widely, 0.5 +- 0.3: of 3000 that were tried 79 % came out as "linear",
/// 20 % as "bounded" and 1 % as "worse".
struct GrowthFit {
  double exponent = 0;
  double spread = 0;  // root mean square of log10(error) about the fit
  std::string word;   // "bounded" | "linear" | "worse" | "" where there is too little to fit
};

/// Largest error in each of at most 128 bins of equal length; when they are full, neighbours are merged.
class ErrorGrowth {
 public:
  /// Times do not fall. Errors >= 0 in any unit; not-a-number counts as infinite.
  void add(double t, double error);
  /// Errors below `floor`, the unit of the errors, count as `floor`: growth within rounding is none.
  GrowthFit fit(double floor = 0) const;
  struct Bin {
    double end = 0;  // s; of the last bin: the last time so far
    /// Largest one since the end of the bin before, in the first bin since the start; 0 if there was none.
    double error = 0;
  };
  std::vector<Bin> bins() const;
  void remember(Memory& memory) { memory(worst_, width_, last_); }

 private:
  std::vector<double> worst_;
  double width_ = 0;  // s; 0 before the first positive time
  double last_ = 0;   // s
};

}  // namespace osculate
