#include "record/export.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <system_error>

#include "record/hdf5_whole.hpp"

namespace osculate {
namespace {

using hdf5::Dataset;
using hdf5::WholeFile;
using std::filesystem::path;

/// A field of comma-separated values, quoted where it has to be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string number(double x) {
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x > 0 ? "Inf" : "-Inf";
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string file_name(std::string name, const char* extension) {
  for (char& c : name)
    if (c == '/') c = '.';
  return name + extension;
}

class TextFile {
 public:
  TextFile(const path& directory, const std::string& name) : path_(directory / name), out_(path_) { check(); }
  void write(const std::string& text) {
    out_ << text;
    check();
  }
  void line(const std::vector<std::string>& fields) {
    std::string text;
    for (const std::string& f : fields) text += (&f == fields.data() ? "" : ",") + field(f);
    write(text + "\n");
  }
  path close() {
    out_.close();
    check();
    return path_;
  }

 private:
  void check() const {
    if (!out_)
      throw FileError(path_.string() + ": cannot write: " + std::generic_category().message(errno) +
                      "; choose another directory");
  }
  path path_;
  std::ofstream out_;
};

/// The values of rows [first, first + count) of a dataset, as fields.
std::vector<std::string> fields(const WholeFile& file, const Dataset& dataset, hsize_t first, hsize_t count) {
  std::vector<std::string> out;
  if (dataset.type == hdf5::Type::text) {
    const auto all = hdf5::read_strings(dataset.id, dataset.path, file.check);
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first * dataset.row_size());
    return {begin, begin + static_cast<std::ptrdiff_t>(count * dataset.row_size())};
  }
  for (const std::uint64_t word : hdf5::read_words(dataset, first, count, file.check))
    out.push_back(dataset.type == hdf5::Type::real ? number(std::bit_cast<double>(word))
                                                   : std::to_string(static_cast<std::int64_t>(word)));
  return out;
}

}  // namespace

std::vector<path> export_csv(const path& from, const path& directory, bool force) {
  const WholeFile file = hdf5::open_whole(from, hdf5::Part::everything);
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw FileError(directory.string() + ": cannot make this directory: " + error.message());
  if (!force && !std::filesystem::is_empty(directory, error))
    throw FileError(directory.string() +
                    ": has files already; use --force to write among them, or choose another directory");

  std::vector<path> written;
  TextFile columns(directory, "columns.csv"), values(directory, "values.csv");
  columns.line({"file", "column", "dataset", "unit", "long_name"});
  values.line({"dataset", "value", "unit", "long_name"});
  const auto unit = [](const Dataset& d) { return hdf5::text_or_empty(d.id, "units"); };
  const auto long_name = [](const Dataset& d) { return hdf5::text_or_empty(d.id, "long_name"); };

  std::vector<std::string> axes;  // in the order of the file
  std::map<std::string, std::vector<const Dataset*>> along;
  for (const Dataset& dataset : file.datasets) {
    if (dataset.type == hdf5::Type::other) continue;
    if (!dataset.extent.empty()) {
      auto& list = along[dataset.axes[0]];
      if (list.empty()) axes.push_back(dataset.axes[0]);
      list.push_back(&dataset);
      continue;
    }
    const std::string value = fields(file, dataset, 0, 1).at(0);
    if (value.find('\n') == std::string::npos) {
      values.line({dataset.path, value, unit(dataset), long_name(dataset)});
    } else {
      TextFile text(directory, file_name(dataset.path, ".txt"));
      text.write(value);
      written.push_back(text.close());
    }
  }

  for (const std::string& axis : axes) {
    TextFile table(directory, file_name(axis, ".csv"));
    std::vector<std::string> header;
    hsize_t rows = 0;
    for (const Dataset* dataset : along[axis]) {
      rows = std::max(rows, dataset->rows());
      for (std::size_t i = 0; i < dataset->row_size(); ++i) {
        const std::string labels = hdf5::element_of(file, *dataset, i, 1);
        header.push_back(dataset->path + (labels.empty() ? "" : "[" + labels + "]"));
        columns.line(
            {file_name(axis, ".csv"), header.back(), dataset->path, unit(*dataset), long_name(*dataset)});
      }
    }
    table.line(header);
    for (hsize_t first = 0; first < rows; first += hdf5::block_rows) {
      const hsize_t count = std::min(hdf5::block_rows, rows - first);
      std::vector<std::vector<std::string>> blocks;
      for (const Dataset* dataset : along[axis]) blocks.push_back(fields(file, *dataset, first, count));
      for (std::size_t row = 0; row < count; ++row) {
        std::vector<std::string> line;
        for (const auto& block : blocks) {
          const std::size_t width = block.size() / count;
          line.insert(line.end(), block.begin() + static_cast<std::ptrdiff_t>(row * width),
                      block.begin() + static_cast<std::ptrdiff_t>((row + 1) * width));
        }
        table.line(line);
      }
    }
    written.push_back(table.close());
  }
  written.push_back(values.close());
  written.push_back(columns.close());
  return written;
}

}  // namespace osculate
