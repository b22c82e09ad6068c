// Restart points in a result file: the instants from which a stopped run can go on. Each is one row along the
// axis restart_time; the numbers that the run remembers follow each other along the axis restart_value.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "record/result_file.hpp"

namespace osculate {

/// Axes and variables of restart points, for the layout of a file that gets some.
void add_restart_points(Layout& layout);

/// Appends a restart point at time t, s. Afterwards every row that the file was given so far is on disk, and
/// then the point itself. Throws FileError.
void append_restart_point(double t, const std::vector<double>& memory, ResultFile& file);

struct RestartPoint {
  std::filesystem::path file;
  double time = 0;                          // s
  std::vector<double> memory;               // as given to append_restart_point
  std::map<std::string, std::size_t> rows;  // of each growing axis until then, this point included
};

/// The last restart point of a file, finished or as a killed run left it, whose rows are all there; none if
/// it has none. Throws FileError.
std::optional<RestartPoint> last_restart_point(const std::filesystem::path& file);

/// Appends the rows that the point's file holds until then to a new file with the same layout. Throws
/// FileError.
void copy_until(const RestartPoint& point, ResultFile& file);

}  // namespace osculate
