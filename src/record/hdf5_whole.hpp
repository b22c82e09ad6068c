// All datasets of a result file, finished or not, with what describes them. Included by src/record/*.cpp
// only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>

#include "record/hdf5_read.hpp"

namespace osculate::hdf5 {

enum class Type { real, whole, text, other };

/// One dataset of one file.
struct Dataset {
  Handle id = {};
  std::string path = {};
  Type type = Type::other;
  std::vector<hsize_t> extent = {};  // rows that count: of a growing one, those of its axis
  std::vector<std::string> axes = {};
  std::map<std::string, std::string> attributes = {};
  bool grows = false;

  std::size_t row_size() const {
    std::size_t n = 1;
    for (std::size_t i = 1; i < extent.size(); ++i) n *= extent[i];
    return n;
  }
  hsize_t rows() const { return extent.empty() ? 1 : extent[0]; }
};

struct WholeFile {
  Check check;
  Handle id = {};
  std::map<std::string, std::string> attributes = {};  // of the root
  std::vector<Dataset> datasets = {};                  // in the order of their creation

  const Dataset* find(const std::string& path) const {
    const auto found = std::find_if(datasets.begin(), datasets.end(),
                                    [&](const Dataset& dataset) { return dataset.path == path; });
    return found == datasets.end() ? nullptr : &*found;
  }
};

/// 17 significant digits.
std::string text_of(double x);
/// In quotes, and cut where it is long.
std::string quoted(const std::string& text);

enum class Part {
  everything,
  results,  // without /provenance and /timing
};
/// Throws FileError.
WholeFile open_whole(const std::filesystem::path& path, Part part);

/// Rows [first, first + count) as they are stored: bits of doubles, or whole numbers.
std::vector<std::uint64_t> read_words(const Dataset& dataset, hsize_t first, hsize_t count,
                                      const Check& check);

/// The time of a row along a growing axis: the axis itself if it is in seconds, or a variable "<axis>_time".
std::optional<double> time_of(const WholeFile& file, const std::string& axis, hsize_t row);

/// Index of a value of a row-major dataset, by labels along axes of names; from the axis `first` on.
std::string element_of(const WholeFile& file, const Dataset& dataset, std::size_t index,
                       std::size_t first = 0);

}  // namespace osculate::hdf5
