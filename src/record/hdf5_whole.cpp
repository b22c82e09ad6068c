#include "record/hdf5_whole.hpp"

#include <hdf5_hl.h>

#include <algorithm>
#include <bit>
#include <cstdio>

namespace osculate::hdf5 {
namespace {

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
      value = quoted(text_or_empty(from, name));
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

bool is_about_the_run(const std::string& path) {
  return path.starts_with("provenance/") || path.starts_with("timing/");
}

void add_dataset(Handle id, const std::string& path, WholeFile& file) {
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
  out.axes = H5DSis_scale(id) > 0 ? std::vector<std::string>{path} : axes_of(id, rank);
  out.id = std::move(id);
  file.datasets.push_back(std::move(out));
}

void add_group(hid_t group, const std::string& prefix, Part part, WholeFile& file) {
  for (const std::string& name : children(group, prefix, file.check)) {
    const std::string path = prefix + name;
    if (part == Part::results && is_about_the_run(path)) continue;
    Handle child = file.check(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "open", path);
    if (H5Iget_type(child) == H5I_GROUP) add_group(child, path + "/", part, file);
    if (H5Iget_type(child) == H5I_DATASET) add_dataset(std::move(child), path, file);
  }
}

}  // namespace

std::string text_of(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string quoted(const std::string& text) {
  constexpr std::size_t longest = 60;
  return "'" + (text.size() <= longest ? text : text.substr(0, longest) + "...") + "'";
}

WholeFile open_whole(const std::filesystem::path& path, Part part) {
  WholeFile file{.check = {path, ""}};
  file.id = open_result(path, file.check);
  const Handle root = file.check(H5Gopen2(file.id, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  file.attributes = attributes_of(root);
  add_group(root, "", part, file);
  // The axis is written after its variables: while a run goes on they may be longer.
  for (Dataset& dataset : file.datasets) {
    const Dataset* axis = dataset.grows ? file.find(dataset.axes[0]) : nullptr;
    if (axis && !axis->extent.empty()) dataset.extent[0] = std::min(dataset.extent[0], axis->extent[0]);
  }
  return file;
}

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

std::optional<double> time_of(const WholeFile& file, const std::string& axis, hsize_t row) {
  const Dataset* dataset = file.find(axis);
  const auto in_seconds = [](const Dataset* d) {
    return d && d->type == Type::real && d->attributes.contains("units") &&
           d->attributes.at("units") == "'s'";
  };
  if (!in_seconds(dataset)) dataset = file.find(axis + "_time");
  if (!in_seconds(dataset) || row >= dataset->rows()) return std::nullopt;
  return std::bit_cast<double>(read_words(*dataset, row, 1, file.check).at(0));
}

std::string element_of(const WholeFile& file, const Dataset& dataset, std::size_t index, std::size_t first) {
  std::string out;
  for (std::size_t i = dataset.extent.size(); i-- > first;) {
    const std::size_t at = i > 0 ? index % dataset.extent[i] : index;
    if (i > 0) index /= dataset.extent[i];
    const Dataset* axis = file.find(dataset.axes[i]);
    std::string label = std::to_string(at);
    if (axis && axis != &dataset && axis->type == Type::text)
      label = read_strings(axis->id, axis->path, file.check).at(at);
    out = label + (out.empty() ? "" : ", ") + out;
  }
  return out;
}

}  // namespace osculate::hdf5
