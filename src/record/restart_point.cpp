#include "record/restart_point.hpp"

#include <algorithm>

#include "record/hdf5_read.hpp"

namespace osculate {
namespace {

using hdf5::Check;
using hdf5::Handle;
using hdf5::Input;
using hdf5::Source;

const std::vector<std::string> counted_axes{"time", "step", "restart_value"};

std::string count_path(const std::string& axis) { return "restart/" + axis + "_rows"; }

Input open_input(const std::filesystem::path& file, Handle& opened, const Check& check) {
  opened = hdf5::open_result(file, check);
  const Handle root = check(H5Gopen2(opened, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  return hdf5::read_input(root, check);
}

const Source& source_of(const std::vector<Source>& sources, const std::string& path, const Check& check) {
  const auto found =
      std::find_if(sources.begin(), sources.end(), [&](const Source& s) { return s.path == path; });
  if (found == sources.end()) check.fail("find", path);
  return *found;
}

/// The variables of a file in the order in which another one wants them.
std::vector<Source> in_order(std::vector<Source>& sources, const std::vector<std::string>& wanted,
                             const Check& check) {
  const auto refuse = [&](const std::string& path) {
    throw FileError(
        check.file.string() + ": '" + path +
        "' is not in both layouts: another version of osculate wrote the file; resume it with that one");
  };
  std::vector<Source> out;
  for (const std::string& path : wanted) {
    const auto found =
        std::find_if(sources.begin(), sources.end(), [&](const Source& s) { return s.path == path; });
    if (found == sources.end()) refuse(path);
    out.push_back(std::move(*found));
    sources.erase(found);
  }
  if (!sources.empty()) refuse(sources.front().path);
  return out;
}

/// Rows of an axis that are on disk whole for every variable.
hsize_t whole_rows(const std::vector<Source>& sources) {
  hsize_t rows = sources.at(0).extent[0];
  for (const Source& source : sources) rows = std::min(rows, hdf5::readable_rows(source));
  return rows;
}

}  // namespace

void add_restart_points(Layout& layout) {
  layout.axes.push_back({"restart_time", {}, "s", "times from which a stopped run can go on"});
  layout.axes.push_back({"restart_value", {}, "1", "numbers that a run remembers, all points in a row"});
  for (const std::string& axis : counted_axes)
    layout.variables.push_back({count_path(axis),
                                {"restart_time"},
                                "1",
                                "rows along " + axis + " until then",
                                Kind::integer,
                                false});
  layout.variables.push_back({"restart/memory",
                              {"restart_value"},
                              "",
                              "what the run remembers at its restart points",
                              Kind::real,
                              true});
}

void append_restart_point(double t, const std::vector<double>& memory, ResultFile& file) {
  for (const double number : memory) {
    const double row[] = {static_cast<double>(file.rows("restart_value")), number};
    file.append("restart_value", row);
  }
  std::vector<double> row{t};
  for (const std::string& axis : counted_axes) {
    file.flush(axis);
    row.push_back(static_cast<double>(file.rows(axis)));
  }
  file.append("restart_time", row);
  file.flush("restart_time");
}

std::optional<RestartPoint> last_restart_point(const std::filesystem::path& file) {
  const Check check{file, ""};
  Handle opened;
  const Input input = open_input(file, opened, check);
  const auto points = input.sources.find("restart_time");
  if (points == input.sources.end()) return std::nullopt;

  std::map<std::string, hsize_t> whole;
  for (const std::string& axis : counted_axes) {
    if (!input.sources.contains(axis)) check.fail("find the axis", axis);
    whole[axis] = whole_rows(input.sources.at(axis));
  }
  const auto value = [&](const std::string& path, hsize_t row) {
    std::vector<double> out;
    if (!hdf5::read_rows(source_of(points->second, path, check), row, 1, out)) check.fail("read", path);
    return out.at(0);
  };
  for (hsize_t i = whole_rows(points->second); i-- > 0;) {
    RestartPoint point{file, value("restart_time", i), {}, {{"restart_time", i + 1}}};
    bool usable = true;
    for (const std::string& axis : counted_axes) {
      const double rows = value(count_path(axis), i);
      usable = usable && rows >= 0 && rows <= static_cast<double>(whole.at(axis));
      point.rows[axis] = usable ? static_cast<std::size_t>(rows) : 0;
    }
    if (!usable) continue;
    const double before = i == 0 ? 0 : value(count_path("restart_value"), i - 1);
    const auto first = static_cast<hsize_t>(before), end = static_cast<hsize_t>(point.rows["restart_value"]);
    const Source& memory = source_of(input.sources.at("restart_value"), "restart/memory", check);
    if (!(before >= 0) || first > end || !hdf5::read_rows(memory, first, end - first, point.memory))
      check.fail("read", "restart/memory");
    return point;
  }
  return std::nullopt;
}

void copy_until(const RestartPoint& point, ResultFile& file) {
  const Check check{point.file, ""};
  Handle opened;
  Input input = open_input(point.file, opened, check);
  for (const auto& [axis, rows] : point.rows)
    hdf5::copy_rows(in_order(input.sources.at(axis), file.variables(axis), check), axis, rows, check, file);
}

}  // namespace osculate
