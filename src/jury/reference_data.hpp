// All terms of an arm at given states, good to the last bit of a double: evaluated by the definitions
// (src/reference) over numbers of 113 bits, compared there with the recursions over the same numbers, and
// rounded once at the end.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "jury/states.hpp"

namespace osculate::jury {

/// One quantity at all states, row-major, state after state. Base frame, about the tip point, angular rows
/// first, joints base to tip.
struct Quantity {
  std::string name;
  std::vector<std::string> axes;  // after the axis `state`; names as in docs/result-file.md
  std::string unit;               // "" where `units` says it
  std::string units;              // in words, where the entries have different ones
  std::string meaning;
  std::vector<double> values;  // NaN where it does not exist: the task rows are singular
  /// Largest difference of the definitions from the recursions over 113 bits, divided by the largest entry of
  /// the quantity at that state; -1 where the recursions do not give it.
  double difference = -1;
};

/// A number of the arm that does not change with the state: one value for each joint or three or nine.
struct Constant {
  std::string name;
  std::vector<std::string> axes;
  std::string unit, meaning;
  std::vector<double> values;
};

struct ReferenceData {
  std::vector<JointState> states;
  std::vector<Quantity> quantities;
  std::vector<Constant> arm;
  std::vector<int> rank;  // of Omega, scaled to unit diagonal, at each state
  double worst = 0;       // largest difference of all
  std::string worst_of;   // the quantity it was seen in
};

/// A difference above this may change the rounded doubles: half a unit in their last place.
inline constexpr double rounding_difference = 0x1p-54;

/// The arm that the doubles of `arm.chain` stand for: rotations made orthonormal and axes made of length 1
/// over 113 bits, every other number as it is. About 4 ms a state for six joints on x86-64.
ReferenceData reference_data(const ArmDescription& arm, const TaskRows& rows, std::vector<JointState> states);

}  // namespace osculate::jury
