// How much the program takes from outside. Everything read from a file or a command line that decides about
// memory or time is held to one of these numbers before it is believed; docs/experiment-file.md lists them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace osculate::limits {

// Text files.
inline constexpr std::uintmax_t experiment_bytes = std::uintmax_t{4} << 20;
inline constexpr std::uintmax_t urdf_bytes = std::uintmax_t{64} << 20;  // real files stay below 1 MB
inline constexpr std::uintmax_t waypoint_bytes = std::uintmax_t{64}
                                                 << 20;               // a CSV file, states of `terms` too
inline constexpr std::uintmax_t log_bytes = std::uintmax_t{1} << 30;  // of a log to be judged
inline constexpr int urdf_nesting = 1000;                             // levels of XML; real files have six

// Experiments.
inline constexpr int yaml_depth = 40;             // maps and lists in each other
inline constexpr int yaml_values = 200'000;       // aliases are copied, so a short text could ask for more
inline constexpr std::size_t variants = 1'000;    // runs of one sweep
inline constexpr double recorded_instants = 1e8;  // of one run; more is a slip of output.interval
inline constexpr double samples = 1e9;            // of one run of a sampled law
inline constexpr double restarts = 1e5;           // restart points of one run
inline constexpr double jumps = 1e6;  // of a reference: each is an instant where the integrator starts anew
inline constexpr std::size_t waypoints = 1'000'000;
/// Joints of a chain that is run or evaluated: the definitions that it is held to cost O(n^3) time and O(n^2)
/// memory. The recursions alone, through the library, have no such limit.
inline constexpr int joints = 5'000;
inline constexpr std::size_t urdf_links = 200'000;  // of a URDF file, on the chain or not

// Result files that are read.
inline constexpr std::size_t objects = 10'000;  // groups and variables of one file
inline constexpr int group_depth = 8;
inline constexpr std::size_t rank = 8;                 // dimensions of a variable
inline constexpr std::size_t labels = 1'000'000;       // of a fixed axis, or entries of a list
inline constexpr std::size_t row_values = 1'000'000;   // of one variable at one instant
inline constexpr std::size_t chunk_values = 1u << 24;  // of one chunk: 128 MB

}  // namespace osculate::limits
