// Result files: HDF5 that is also valid netCDF-4, written crash-safely in single-writer-multiple-reader mode.
// Nothing numeric happens here; what the variables mean is decided by the caller's Layout.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace osculate {

/// Input/output failure (exit code 4). The message names file, operation, system reason and remedy.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A dimension. A fixed one has one label or one number for each element, which its scale variable holds; an
/// unlimited one has neither and is itself a recorded variable, for instance /time.
struct Axis {
  std::string name;                      // "joint"; in an Ending it may lie in a group: "growth/bin_end"
  std::vector<std::string> labels = {};  // fixed axis of names
  std::string unit = {};                 // of coordinates, or of an unlimited axis
  std::string long_name = {};
  std::vector<double> coordinates = {};  // fixed axis of numbers, for instance frequencies in Hz

  bool fixed() const { return size() > 0; }
  std::size_t size() const { return labels.size() + coordinates.size(); }  // one of them is empty
};

/// Stands for a value that is not there.
inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

enum class Kind { real /* float64 */, integer /* int64 */, small /* int8 */ };

/// One recorded variable. axes[0] is an unlimited axis; the others are fixed.
struct Variable {
  std::string path;               // "trajectory/joint_position"
  std::vector<std::string> axes;  // {"time", "joint"}
  std::string unit;  // "" where companion unit variables say it, or where it has none ("1" if dimensionless)
  std::string long_name;
  Kind kind = Kind::real;
  bool may_be_missing = false;  // NaN allowed, declared as _FillValue
};

/// Fixed content: text scalars (provenance), and string lists along a fixed axis (companion units).
struct Text {
  std::string path, value, long_name;
};
struct StringList {
  std::string path, axis;
  std::vector<std::string> values;
  std::string long_name;
};

struct Layout {
  std::string title;
  std::vector<Axis> axes;  // all in the root group; there may be no unlimited one
  std::vector<Variable> variables;
  std::vector<Text> texts;
  std::vector<StringList> lists;
};

/// One row of /verdict, written by `finish`.
struct VerdictRow {
  std::string claim, equation, reason;
  double worst = 0, bound = 0, at_time = 0;  // NaN where it does not exist
  int result = 0;                            // 1 pass, 0 fail, -1 not applicable
  long undecided_steps = 0, checked_steps = 0;
};

/// A scalar written by `finish` (wall times, counts, error estimates).
struct Scalar {
  std::string path;
  double value = 0;
  std::string unit, long_name;
};

/// Numbers along fixed axes, of the layout or of the same Ending.
struct Table {
  std::string path;
  std::vector<std::string> axes;
  std::string unit, long_name;
  std::vector<double> values;  // row-major; NaN: missing, and if there is one, declared as _FillValue
};

/// What is known at the end only.
struct Ending {
  std::vector<VerdictRow> rows = {};
  std::vector<Scalar> scalars = {};
  std::vector<Axis> axes = {};  // fixed ones
  std::vector<Table> tables = {};
  std::vector<StringList> lists = {};  // along fixed axes, as the tables
};

class ResultFile {
 public:
  /// Creates the file. Throws FileError if it exists and `force` is false, or if it cannot be written.
  ResultFile(const std::filesystem::path& file, const Layout& layout, bool force);
  ~ResultFile();  // leaves an unfinished file as a killed run would; never throws
  ResultFile(ResultFile&&) noexcept;

  /// Appends one row along an unlimited axis: the axis value, then the values of every variable on that axis
  /// in the order of the layout, each row-major. Rows are buffered and written as whole chunks, and once a
  /// second as far as they have come. Constant memory. Throws std::invalid_argument, and keeps nothing of the
  /// row, if it has the wrong size, NaN where nothing may be missing, or a number that an integer variable
  /// cannot hold; FileError if it cannot be written.
  void append(const std::string& axis, std::span<const double> row);

  /// Writes the rows along this axis that are still in memory, in a chunk that is part full: for rows that
  /// others will refer to. What is appended later fills that chunk up, which then stays uncompressed. Throws
  /// FileError.
  void flush(const std::string& axis);

  /// Rows appended along this axis.
  std::size_t rows(const std::string& axis) const;

  /// The axis and its variables, in the order of `append`.
  std::vector<std::string> variables(const std::string& axis) const;

  /// Values in one row of `append` along this axis.
  std::size_t row_size(const std::string& axis) const;

  /// Writes the tail, leaves SWMR mode, reopens, writes /verdict, the rest of the ending and the final root
  /// attributes (status: complete | failed | interrupted; verdict: pass | fail | as_expected), closes. Throws
  /// std::invalid_argument, and changes nothing, if the ending does not fit the layout or itself.
  void finish(const std::string& status, const std::string& verdict, const Ending& ending = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Copies what a killed run left into a new, finished file (status "recovered"). Empty `out`: next to the
/// input as NAME.recovered.h5. Returns the path written. The input is not changed. `alive` is called after
/// each variable and block of rows. Throws FileError. Bytes that were damaged on purpose can crash HDF5
/// itself: cli/contained.hpp.
std::filesystem::path recover(
    const std::filesystem::path& in, const std::filesystem::path& out = {}, bool force = false,
    const std::function<void()>& alive = [] {});

/// "1.10.8" and the like.
std::string hdf5_version();

}  // namespace osculate
