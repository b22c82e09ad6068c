// How result files are read, finished or as a killed run left them. Included by src/record/*.cpp only.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "record/hdf5_handles.hpp"

namespace osculate::hdf5 {

inline constexpr hsize_t block_rows = 256;  // rows read at a time

/// A variable of the input, open for reading.
struct Source {
  Handle dataset = {};
  std::vector<hsize_t> extent = {};
  hsize_t chunk_rows = 1;
  std::string path = {};
  bool is_axis = false;

  std::size_t count() const {
    std::size_t n = 1;
    for (std::size_t i = 1; i < extent.size(); ++i) n *= extent[i];
    return n;
  }
};

struct Input {
  Layout layout;
  std::size_t objects = 0;
  std::map<std::string, std::vector<Source>>
      sources;  // by unlimited axis: the axis, then its variables as in the layout
};

// These functions throw FileError for what is no result file although it is HDF5. `alive` is called now and
// then.

/// Opens a file for reading: one that is finished, or as a single-writer-multiple-reader reader does. Throws
/// FileError.
Handle open_result(const std::filesystem::path& file, const Check& check);

/// The layout of a file and its growing variables, from its root group.
Input read_input(hid_t root, const Check& check);

/// Names of the links in a group, in the order of creation. `where`: its path, for messages.
std::vector<std::string> children(hid_t group, const std::string& where, const Check& check);
/// Names of the axes attached to a dataset, one for each dimension ("" where there is none).
std::vector<std::string> axes_of(hid_t dataset, std::size_t rank);
/// All strings of a dataset of variable-length strings.
std::vector<std::string> read_strings(hid_t dataset, const std::string& where, const Check& check);
/// The text of an attribute; none if it does not exist or is no variable-length string.
std::optional<std::string> text_attribute(hid_t object, const char* name);
std::string text_or_empty(hid_t object, const char* name);

/// Reads rows [first, first + count) as doubles. False if the disk does not have them whole.
bool read_rows(const Source& source, hsize_t first, hsize_t count, std::vector<double>& values);
/// Rows whose chunks are on disk and can be read, counted from the first. The extent of an axis may be ahead
/// of its chunks; a variable has none where it holds nothing but its fill value.
hsize_t readable_rows(
    const Source& source, const std::function<void()>& alive = [] {});
/// Appends the first rows of an axis and its variables to a file with the same layout.
void copy_rows(
    const std::vector<Source>& sources, const std::string& axis, hsize_t rows, const Check& check,
    ResultFile& output, const std::function<void()>& alive = [] {});

}  // namespace osculate::hdf5
