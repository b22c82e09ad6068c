#include "record/difference.hpp"

#include <hdf5_hl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>

#include "record/hdf5_read.hpp"

namespace osculate {
namespace {

using hdf5::Check;
using hdf5::Handle;

constexpr std::uint64_t incomparable = std::numeric_limits<std::uint64_t>::max();

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

struct File {
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

std::string text_of(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string quoted(const std::string& text) {
  constexpr std::size_t longest = 60;
  return "'" + (text.size() <= longest ? text : text.substr(0, longest) + "...") + "'";
}

/// Texts and numbers; references to axes are compared by the names of the axes.
std::map<std::string, std::string> attributes_of(hid_t object) {
  std::map<std::string, std::string> out;
  const auto add = [](hid_t from, const char* name, const H5A_info_t*, void* into) -> herr_t {
    const Handle attribute(H5Aopen(from, name, H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    const H5T_class_t kind = H5Tget_class(type);
    std::string value;
    if (kind == H5T_STRING && H5Tis_variable_str(type) > 0) {
      value = quoted(hdf5::text_or_empty(from, name));
    } else if (kind == H5T_STRING) {
      value.resize(H5Tget_size(type));
      H5Aread(attribute, type, value.data());
      value = quoted(value.c_str());
    } else if (kind == H5T_INTEGER || kind == H5T_FLOAT) {
      std::vector<double> numbers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
      H5Aread(attribute, H5T_NATIVE_DOUBLE, numbers.data());
      for (const double x : numbers) value += (value.empty() ? "" : " ") + text_of(x);
    } else {
      return 0;
    }
    (*static_cast<std::map<std::string, std::string>*>(into))[name] = value;
    return 0;
  };
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &out);
  return out;
}

bool left_out(const std::string& path) {
  return path.starts_with("provenance/") || path.starts_with("timing/");
}

void add_dataset(Handle id, const std::string& path, File& file) {
  const Check& check = file.check;
  const Handle type = check(H5Dget_type(id), H5Tclose, "read", path);
  const Handle space = check(H5Dget_space(id), H5Sclose, "read", path);
  Dataset out{.path = path, .attributes = attributes_of(id)};
  const H5T_class_t kind = H5Tget_class(type);
  out.type = kind == H5T_FLOAT                                    ? Type::real
             : kind == H5T_INTEGER                                ? Type::whole
             : kind == H5T_STRING && H5Tis_variable_str(type) > 0 ? Type::text
                                                                  : Type::other;
  const auto rank = static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space), "read", path));
  out.extent.resize(rank);
  std::vector<hsize_t> largest(rank);
  check(H5Sget_simple_extent_dims(space, out.extent.data(), largest.data()), "read", path);
  out.grows = rank > 0 && largest[0] == H5S_UNLIMITED;
  out.axes = H5DSis_scale(id) > 0 ? std::vector<std::string>{path} : hdf5::axes_of(id, rank);
  out.id = std::move(id);
  file.datasets.push_back(std::move(out));
}

void add_group(hid_t group, const std::string& prefix, File& file) {
  for (const std::string& name : hdf5::children(group, prefix, file.check)) {
    const std::string path = prefix + name;
    if (left_out(path)) continue;
    Handle child = file.check(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "open", path);
    if (H5Iget_type(child) == H5I_GROUP) add_group(child, path + "/", file);
    if (H5Iget_type(child) == H5I_DATASET) add_dataset(std::move(child), path, file);
  }
}

File open(const std::filesystem::path& path) {
  File file{.check = {path, ""}};
  file.id = hdf5::open_result(path, file.check);
  const Handle root = file.check(H5Gopen2(file.id, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  file.attributes = attributes_of(root);
  add_group(root, "", file);
  // The axis is written after its variables: while a run goes on they may be longer.
  for (Dataset& dataset : file.datasets) {
    const Dataset* axis = dataset.grows ? file.find(dataset.axes[0]) : nullptr;
    if (axis && !axis->extent.empty()) dataset.extent[0] = std::min(dataset.extent[0], axis->extent[0]);
  }
  return file;
}

/// Rows [first, first + count) as they are stored: bits of doubles, or whole numbers.
std::vector<std::uint64_t> read_words(const Dataset& dataset, hsize_t first, hsize_t count,
                                      const Check& check) {
  std::vector<std::uint64_t> out(count * dataset.row_size());
  const hid_t type = dataset.type == Type::real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
  if (dataset.extent.empty()) {
    check(H5Dread(dataset.id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), "read", dataset.path);
    return out;
  }
  std::vector<hsize_t> start(dataset.extent.size(), 0), size = dataset.extent;
  start[0] = first;
  size[0] = count;
  const Handle stored = check(H5Dget_space(dataset.id), H5Sclose, "read", dataset.path);
  const Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  check(H5Sselect_hyperslab(stored, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr), "read",
        dataset.path);
  check(H5Dread(dataset.id, type, memory, stored, H5P_DEFAULT, out.data()), "read", dataset.path);
  return out;
}

/// The time of a row along a growing axis: the axis itself if it is in seconds, or a variable "<axis>_time".
std::optional<double> time_of(const File& file, const std::string& axis, hsize_t row) {
  const Dataset* dataset = file.find(axis);
  const auto in_seconds = [](const Dataset* d) {
    return d && d->type == Type::real && d->attributes.contains("units") &&
           d->attributes.at("units") == "'s'";
  };
  if (!in_seconds(dataset)) dataset = file.find(axis + "_time");
  if (!in_seconds(dataset) || row >= dataset->rows()) return std::nullopt;
  return std::bit_cast<double>(read_words(*dataset, row, 1, file.check).at(0));
}

/// Index of a value of a row-major dataset, by labels along axes of names.
std::string element_of(const File& file, const Dataset& dataset, std::size_t index) {
  std::string out;
  for (std::size_t i = dataset.extent.size(); i-- > 0;) {
    const std::size_t at = i > 0 ? index % dataset.extent[i] : index;
    if (i > 0) index /= dataset.extent[i];
    const Dataset* axis = file.find(dataset.axes[i]);
    std::string label = std::to_string(at);
    if (axis && axis != &dataset && axis->type == Type::text)
      label = hdf5::read_strings(axis->id, axis->path, file.check).at(at);
    out = label + (out.empty() ? "" : ", ") + out;
  }
  return out;
}

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
  DatasetComparison(const File& a, const File& b, const Dataset& in_a, const Dataset& in_b)
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

  const File &a_, &b_;
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
  const File a = open(path_a), b = open(path_b);
  Comparison out;
  const bool everything = what == Compared::everything;
  if (everything) {
    auto names = a.attributes;
    names.insert(b.attributes.begin(), b.attributes.end());
    for (const auto& [name, ignored] : names) {
      const auto in = [&name](const File& file) {
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
