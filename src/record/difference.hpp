// Two result files compared value by value, bit for bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace osculate {

/// Units in the last place between two doubles: how many steps to the next double lead from one to the other.
/// 0 for equal bits and for the two zeros; the largest value where one of them is NaN and their bits differ.
std::uint64_t ulps_between(double a, double b);

/// A value that is not the same in both files.
struct Divergence {
  std::string path;                 // of the dataset
  std::string element = {};         // "412, elbow": indices, labels along axes of names; "" of one value
  std::string axis = {};            // growing axis, or ""
  std::size_t row = 0;              // along it, from 0
  std::optional<double> time = {};  // s, of that row
  std::string a = {}, b = {};       // the values, numbers with 17 digits; "missing" past the end of a file
  std::string size = {};            // "3 ulps"; "" where that has no meaning
};

/// What is not the same in one dataset.
struct DatasetDifference {
  std::string path;
  std::vector<std::string> remarks = {};  // shape, type, attributes, axes, or that one file lacks it
  std::size_t values = 0, of = 0;         // that differ, that were compared
  double largest = 0;                     // largest |a - b|; infinite where one is NaN
  std::uint64_t ulps = 0;                 // largest number of them
  std::optional<Divergence> first = {};
};

struct Comparison {
  std::size_t datasets = 0, values = 0;  // compared
  std::vector<std::string> remarks;      // about attributes of the root
  std::vector<DatasetDifference> differences;
  /// The one at the earliest time; if none has a time, the first in the order of the file.
  std::optional<Divergence> first;

  bool identical() const { return remarks.empty() && differences.empty(); }
};

enum class Compared {
  everything,  // all datasets outside /provenance and /timing, with their attributes and axes
  first_rows,  // of the growing datasets of `a`, the rows that it has: `a` is of a run that was stopped
};

/// NaN equals NaN where all bits are the same; 0 and -0 differ. Throws FileError where a file cannot be read.
Comparison compare(const std::filesystem::path& a, const std::filesystem::path& b,
                   Compared what = Compared::everything);

/// What differs, for a reader; the files by these names.
std::string report(const Comparison& comparison, const std::string& a, const std::string& b);

}  // namespace osculate
