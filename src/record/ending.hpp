// What `finish` adds to a result file. Included by src/record/*.cpp only.
#pragma once

#include <map>

#include "record/hdf5_handles.hpp"

namespace osculate {

/// Length of each fixed axis.
using FixedAxes = std::map<std::string, std::size_t>;

/// Throws std::invalid_argument.
void require(bool good, const std::string& message);

/// Labels or coordinates, not both; finite coordinates.
void require_one_kind(const Axis& axis);

/// One string for each of the `size` elements of its axis; 0 means that the axis is not fixed.
void require_fits(const StringList& list, std::size_t size);

/// The fixed axes of the layout and of the ending. Throws std::invalid_argument if the ending does not fit
/// them.
FixedAxes checked_axes(const Ending& ending, const FixedAxes& layout);

/// Into a file that is open for writing; `sizes` of checked_axes. Throws FileError.
void write_ending(hid_t file, const hdf5::Check& check, const std::string& status, const std::string& verdict,
                  const Ending& ending, const FixedAxes& sizes);

}  // namespace osculate
