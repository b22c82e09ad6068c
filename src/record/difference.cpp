#include "record/difference.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "record/hdf5_whole.hpp"

namespace osculate {
namespace {

using hdf5::Dataset;
using hdf5::quoted;
using hdf5::text_of;
using hdf5::Type;
using hdf5::WholeFile;

constexpr std::uint64_t incomparable = std::numeric_limits<std::uint64_t>::max();

std::string size_of(double a, double b) {
  const std::uint64_t ulps = ulps_between(a, b);
  if (ulps == incomparable) return "not a number";
  if (ulps == 0) return "the sign of zero";
  return std::to_string(ulps) + (ulps == 1 ? " ulp" : " ulps");
}

std::string shape(const std::vector<hsize_t>& extent) {
  std::string out;
  for (const hsize_t n : extent) out += (out.empty() ? "" : " x ") + std::to_string(n);
  return out.empty() ? "one value" : out;
}

/// Compares one dataset that both files have.
class DatasetComparison {
 public:
  DatasetComparison(const WholeFile& a, const WholeFile& b, const Dataset& in_a, const Dataset& in_b)
      : a_(a), b_(b), in_a_(in_a), in_b_(in_b) {
    out_.path = in_a.path;
  }

  DatasetDifference run(Compared what) {
    if (in_a_.type != in_b_.type || in_a_.type == Type::other) {
      out_.remarks.push_back("the types differ");
      return out_;
    }
    if (in_a_.attributes != in_b_.attributes) compare_attributes();
    if (in_a_.axes != in_b_.axes) out_.remarks.push_back("the axes differ");
    std::vector<hsize_t> tail_a = in_a_.extent, tail_b = in_b_.extent;
    const bool grow = in_a_.grows && in_b_.grows && tail_a.size() == tail_b.size();
    if (grow) tail_a[0] = tail_b[0] = 0;
    if (tail_a != tail_b) {
      out_.remarks.push_back(shape(in_a_.extent) + " against " + shape(in_b_.extent));
      return out_;
    }
    if (in_a_.type == Type::text)
      compare_texts();
    else
      compare_numbers();
    const hsize_t rows_a = in_a_.rows(), rows_b = in_b_.rows();
    const bool cut = what == Compared::first_rows && rows_a < rows_b;
    if (rows_a != rows_b && !cut) compare_lengths();
    return out_;
  }

 private:
  void compare_attributes() {
    const auto in = [](const std::map<std::string, std::string>& list, const std::string& name) {
      return list.contains(name) ? list.at(name) : std::string("none");
    };
    auto names = in_a_.attributes;
    names.insert(in_b_.attributes.begin(), in_b_.attributes.end());
    for (const auto& [name, ignored] : names)
      if (in(in_a_.attributes, name) != in(in_b_.attributes, name))
        out_.remarks.push_back("attribute " + name + ": " + in(in_a_.attributes, name) + " against " +
                               in(in_b_.attributes, name));
  }

  void compare_texts() {
    const auto a = hdf5::read_strings(in_a_.id, in_a_.path, a_.check),
               b = hdf5::read_strings(in_b_.id, in_b_.path, b_.check);
    out_.of = std::min(a.size(), b.size());
    for (std::size_t i = 0; i < out_.of; ++i) {
      if (a[i] == b[i]) continue;
      if (++out_.values == 1) set_first(i, quoted(a[i]), quoted(b[i]), "");
    }
  }

  void compare_numbers() {
    const hsize_t rows = std::min(in_a_.rows(), in_b_.rows());
    out_.of = rows * in_a_.row_size();
    for (hsize_t first = 0; first < rows; first += hdf5::block_rows) {
      const hsize_t count = std::min(hdf5::block_rows, rows - first);
      const auto a = read_words(in_a_, first, count, a_.check), b = read_words(in_b_, first, count, b_.check);
      for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i] != b[i]) add(first * in_a_.row_size() + i, a[i], b[i]);
    }
  }

  void add(std::size_t index, std::uint64_t a, std::uint64_t b) {
    ++out_.values;
    if (in_a_.type == Type::whole) {
      const auto x = static_cast<std::int64_t>(a), y = static_cast<std::int64_t>(b);
      out_.largest = std::max(out_.largest, std::abs(static_cast<double>(x) - static_cast<double>(y)));
      if (out_.values == 1) set_first(index, std::to_string(x), std::to_string(y), "");
      return;
    }
    const double x = std::bit_cast<double>(a), y = std::bit_cast<double>(b);
    const double off = std::abs(x - y);
    out_.largest = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(out_.largest, off);
    out_.ulps = std::max(out_.ulps, ulps_between(x, y));
    if (out_.values == 1) set_first(index, text_of(x), text_of(y), size_of(x, y));
  }

  /// One file has rows that the other has not.
  void compare_lengths() {
    out_.remarks.push_back(std::to_string(in_a_.rows()) + " against " + std::to_string(in_b_.rows()) +
                           " rows");
    if (out_.first) return;
    const bool a_ends = in_a_.rows() < in_b_.rows();
    const hsize_t row = std::min(in_a_.rows(), in_b_.rows());
    out_.first = {.path = in_a_.path,
                  .element = std::to_string(row),
                  .axis = in_a_.axes[0],
                  .row = row,
                  .time = time_of(a_ends ? b_ : a_, in_a_.axes[0], row),
                  .a = a_ends ? "missing" : "there",
                  .b = a_ends ? "there" : "missing",
                  .size = ""};
  }

  void set_first(std::size_t index, const std::string& a, const std::string& b, const std::string& size) {
    Divergence first{
        .path = in_a_.path, .element = element_of(a_, in_a_, index), .a = a, .b = b, .size = size};
    if (in_a_.grows) {
      first.axis = in_a_.axes[0];
      first.row = index / in_a_.row_size();
      first.time = time_of(a_, first.axis, first.row);
    }
    out_.first = first;
  }

  const WholeFile &a_, &b_;
  const Dataset &in_a_, &in_b_;
  DatasetDifference out_;
};

/// The earlier one; one without a time comes after all that have one.
bool earlier(const Divergence& a, const Divergence& b) {
  if (a.time && b.time) return *a.time < *b.time;
  return a.time.has_value() && !b.time;
}

}  // namespace

std::uint64_t ulps_between(double a, double b) {
  const auto bits_a = std::bit_cast<std::uint64_t>(a), bits_b = std::bit_cast<std::uint64_t>(b);
  if (bits_a == bits_b) return 0;
  if (std::isnan(a) || std::isnan(b)) return incomparable;
  // Doubles in order as whole numbers in order, the two zeros alike.
  constexpr std::uint64_t sign = std::uint64_t{1} << 63;
  const auto place = [](std::uint64_t bits) { return bits & sign ? sign - (bits & ~sign) : sign + bits; };
  const std::uint64_t x = place(bits_a), y = place(bits_b);
  return x > y ? x - y : y - x;
}

Comparison compare(const std::filesystem::path& path_a, const std::filesystem::path& path_b, Compared what) {
  const WholeFile a = hdf5::open_whole(path_a, hdf5::Part::results),
                  b = hdf5::open_whole(path_b, hdf5::Part::results);
  Comparison out;
  const bool everything = what == Compared::everything;
  if (everything) {
    auto names = a.attributes;
    names.insert(b.attributes.begin(), b.attributes.end());
    for (const auto& [name, ignored] : names) {
      const auto in = [&name = name](const WholeFile& file) {
        return file.attributes.contains(name) ? file.attributes.at(name) : std::string("none");
      };
      if (in(a) != in(b)) out.remarks.push_back("attribute " + name + ": " + in(a) + " against " + in(b));
    }
  }
  for (const Dataset& in_a : a.datasets) {
    if (!everything && !in_a.grows) continue;
    const Dataset* const in_b = b.find(in_a.path);
    DatasetDifference difference{.path = in_a.path};
    if (in_b)
      difference = DatasetComparison(a, b, in_a, *in_b).run(what);
    else
      difference.remarks = {"only in the first file"};
    ++out.datasets;
    out.values += difference.of;
    if (difference.first && (!out.first || earlier(*difference.first, *out.first)))
      out.first = difference.first;
    if (difference.values > 0 || !difference.remarks.empty()) out.differences.push_back(difference);
  }
  for (const Dataset& in_b : b.datasets)
    if (everything && !a.find(in_b.path))
      out.differences.push_back({.path = in_b.path, .remarks = {"only in the second file"}});
  return out;
}

std::string report(const Comparison& c, const std::string& a, const std::string& b) {
  if (c.identical())
    return "identical, bit for bit: " + std::to_string(c.datasets) + " datasets, " +
           std::to_string(c.values) + " values\n";
  std::string out;
  char line[256];
  if (const auto& first = c.first) {
    out += "first divergence:";
    if (first->time) out += " t = " + text_of(*first->time) + " s,";
    if (!first->axis.empty()) out += " row " + std::to_string(first->row) + " along " + first->axis + ",";
    out += " " + first->path + (first->element.empty() ? "" : "[" + first->element + "]") +
           (first->size.empty() ? "" : ", " + first->size) + "\n";
    out += "  " + first->a + "  in " + a + "\n  " + first->b + "  in " + b + "\n";
  }
  for (const std::string& remark : c.remarks) out += remark + "\n";
  std::size_t width = 7;
  for (const DatasetDifference& d : c.differences) width = std::max(width, d.path.size());
  const auto padded = [&width](const std::string& text) {
    return text + std::string(width - text.size(), ' ');
  };
  if (!c.differences.empty())
    out += padded("dataset") + "   differing          of  largest difference                 ulps\n";
  for (const DatasetDifference& d : c.differences) {
    out += padded(d.path);
    if (d.of > 0) {
      const std::string ulps = d.ulps == 0 ? "-" : d.ulps == incomparable ? "NaN" : std::to_string(d.ulps);
      std::snprintf(line, sizeof line, "  %10zu  %10zu  %18.3g  %20s", d.values, d.of, d.largest,
                    ulps.c_str());
      out += line;
    }
    for (std::size_t i = 0; i < d.remarks.size(); ++i) out += (i == 0 ? "  " : "; ") + d.remarks[i];
    out += "\n";
  }
  return out;
}

}  // namespace osculate
