#include "record/hdf5_read.hpp"

#include <hdf5_hl.h>

#include <algorithm>
#include <array>

#include "input/limits.hpp"

namespace osculate::hdf5 {
namespace {

constexpr std::size_t block_values = 1u << 22;  // numbers read at a time

/// A file is believed only within limits.hpp, as its sizes become memory.
void require(bool good, const std::string& where, const std::string& what, const Check& check) {
  if (!good)
    throw FileError(check.file.string() + ": is not a result file of osculate, or a damaged one: '" + where +
                    "' " + what);
}
/// The product of sizes, at most `most`. Throws where it is more.
std::size_t product(const std::vector<hsize_t>& sizes, std::size_t from, std::size_t most,
                    const std::string& where, const Check& check) {
  std::size_t n = 1;
  for (std::size_t i = from; i < sizes.size(); ++i) {
    require(sizes[i] <= most && n * sizes[i] <= most, where, "is larger than any variable of a result file",
            check);
    n *= sizes[i];
  }
  return n;
}

/// Whether the references to axes are what HDF5's own function takes them for: it does not look.
bool has_axes(hid_t dataset, std::size_t rank) {
  if (H5Aexists(dataset, "DIMENSION_LIST") <= 0) return false;
  const Handle attribute(H5Aopen(dataset, "DIMENSION_LIST", H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute), H5Sclose), type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_class(type) != H5T_VLEN || H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(rank))
    return false;
  const Handle element(H5Tget_super(type), H5Tclose);
  return H5Tequal(element, H5T_STD_REF_OBJ) > 0;
}

}  // namespace

Handle open_result(const std::filesystem::path& file, const Check& check) {
  prepare_library();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) throw FileError(file.string() + ": no such file");
  if (std::filesystem::is_directory(file, ignored)) throw FileError(file.string() + ": is a directory");
  if (H5Fis_hdf5(file.c_str()) == 0) throw FileError(file.string() + ": is not an HDF5 file");
  const Handle access = file_access(false);
  H5Pset_metadata_read_attempts(
      access, 10);  // the default of 100 waits for hours before it gives up on a damaged file
  Handle finished(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (finished >= 0) return finished;
  return check(H5Fopen(file.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access), H5Fclose, "open");
}

std::vector<std::string> read_strings(hid_t dataset, const std::string& where, const Check& check) {
  const Handle space = check(H5Dget_space(dataset), H5Sclose, "read", where);
  const auto count = static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space), "read", where));
  require(count > 0 && count <= limits::labels, where, "has no texts, or too many", check);
  std::vector<char*> texts(count, nullptr);
  const Handle type = string_type();
  check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), "read", where);
  std::vector<std::string> result;
  for (const char* text : texts) result.emplace_back(text ? text : "");
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, texts.data());
  return result;
}

std::optional<std::string> text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  char* text = nullptr;
  if (H5Tis_variable_str(stored) <= 0 || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(attribute, string_type(), &text) < 0)
    return std::nullopt;
  const std::string result = text ? text : "";
  H5free_memory(text);
  return result;
}

std::string text_or_empty(hid_t object, const char* name) {
  return text_attribute(object, name).value_or("");
}

std::vector<std::string> children(hid_t group, const std::string& where, const Check& check) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t* link, void* into) -> herr_t {
    auto& found = *static_cast<std::vector<std::string>*>(into);
    if (link->type != H5L_TYPE_HARD || found.size() >= limits::objects) return -1;
    found.emplace_back(name);
    return 0;
  };
  check(H5Literate(group, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, collect, &names), "list the objects in",
        "/" + where);
  return names;
}

std::vector<std::string> axes_of(hid_t dataset, std::size_t rank) {
  const auto take_name = [](hid_t, unsigned, hid_t scale, void* into) -> herr_t {
    char name[256] = "";
    if (H5DSget_scale_name(scale, name, sizeof name) > 0) *static_cast<std::string*>(into) = name;
    return 1;
  };
  std::vector<std::string> names(rank);
  if (!has_axes(dataset, rank)) return names;
  for (std::size_t i = 0; i < rank; ++i)
    H5DSiterate_scales(dataset, static_cast<unsigned>(i), nullptr, take_name, &names[i]);
  return names;
}

bool read_rows(const Source& source, hsize_t first, hsize_t count, std::vector<double>& values) {
  std::vector<hsize_t> start(source.extent.size(), 0), size = source.extent;
  start[0] = first;
  size[0] = count;
  values.resize(count * source.count());
  const Handle file_space(H5Dget_space(source.dataset), H5Sclose);
  const Handle memory_space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  return H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) >= 0 &&
         H5Dread(source.dataset, H5T_NATIVE_DOUBLE, memory_space, file_space, H5P_DEFAULT, values.data()) >=
             0;
}

hsize_t readable_rows(const Source& source, const std::function<void()>& alive) {
  std::vector<double> values;
  std::array<hsize_t, H5S_MAX_RANK> corner{};
  for (hsize_t row = 0; row < source.extent[0]; row += source.chunk_rows) {
    corner[0] = row;
    alive();
    unsigned filters = 0;
    haddr_t address = HADDR_UNDEF;
    hsize_t bytes = 0;
    const hsize_t count = std::min(source.chunk_rows, source.extent[0] - row);
    if (H5Dget_chunk_info_by_coord(source.dataset, corner.data(), &filters, &address, &bytes) < 0 ||
        (source.is_axis && address == HADDR_UNDEF) || !read_rows(source, row, count, values))
      return row;
  }
  return source.extent[0];
}

void copy_rows(const std::vector<Source>& sources, const std::string& axis, hsize_t rows, const Check& check,
               ResultFile& output, const std::function<void()>& alive) {
  std::vector<std::vector<double>> blocks(sources.size());
  std::vector<double> row;
  std::size_t row_size = 1;
  for (const Source& source : sources) row_size += source.count();
  const hsize_t at_a_time = std::clamp<hsize_t>(block_values / row_size, 1, block_rows);
  for (hsize_t first = 0; first < rows; first += at_a_time) {
    const hsize_t count = std::min(at_a_time, rows - first);
    alive();
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (!read_rows(sources[i], first, count, blocks[i])) check.fail("read", sources[i].path);
    for (std::size_t k = 0; k < count; ++k) {
      row.clear();
      for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto from = blocks[i].begin() + static_cast<std::ptrdiff_t>(k * sources[i].count());
        row.insert(row.end(), from, from + static_cast<std::ptrdiff_t>(sources[i].count()));
      }
      output.append(axis, row);
    }
  }
}

namespace {

void read_dataset(Handle dataset, const std::string& where, const Check& check, Input& input) {
  const Handle space = check(H5Dget_space(dataset), H5Sclose, "read", where);
  const auto rank = static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space), "read", where));
  require(rank <= limits::rank, where, "has too many dimensions", check);
  Source source{.extent = std::vector<hsize_t>(rank), .path = where};
  std::vector<hsize_t> largest(rank);
  check(H5Sget_simple_extent_dims(space, source.extent.data(), largest.data()), "read", where);
  const Handle type = check(H5Dget_type(dataset), H5Tclose, "read", where);
  const std::string unit = text_or_empty(dataset, "units");
  const std::string long_name = text_or_empty(dataset, "long_name");
  const bool grows = rank > 0 && largest[0] == H5S_UNLIMITED;
  const bool is_axis = H5DSis_scale(dataset) > 0;
  source.is_axis = is_axis;
  const auto axes = is_axis ? std::vector<std::string>{where} : axes_of(dataset, rank);
  require(!is_axis || rank == 1, where, "is an axis of more than one dimension", check);
  product(source.extent, 1, limits::row_values, where, check);

  if (grows) {
    const Handle creation = check(H5Dget_create_plist(dataset), H5Pclose, "read", where);
    std::vector<hsize_t> chunk(rank);
    check(H5Pget_chunk(creation, static_cast<int>(rank), chunk.data()), "read", where);
    source.chunk_rows = chunk[0];
    product(chunk, 0, limits::chunk_values, where, check);
    require(chunk[0] <= limits::chunk_values / std::max<std::size_t>(1, source.count()), where,
            "has huge chunks", check);
    const H5T_class_t kind_of_type = H5Tget_class(type);
    require(kind_of_type == H5T_FLOAT || kind_of_type == H5T_INTEGER, where, "grows and holds no numbers",
            check);
    if (is_axis) {
      input.layout.axes.push_back({where, {}, unit, long_name});
    } else {
      const bool real = kind_of_type == H5T_FLOAT;
      const Kind kind = real ? Kind::real : H5Tget_size(type) == 1 ? Kind::small : Kind::integer;
      input.layout.variables.push_back(
          {where, axes, unit, long_name, kind, H5Aexists(dataset, "_FillValue") > 0});
    }
    source.dataset = std::move(dataset);
    auto& sources = input.sources[axes[0]];
    require(is_axis == sources.empty(), where, "does not come after the axis that it grows along", check);
    sources.push_back(std::move(source));
  } else if (H5Tis_variable_str(type) > 0) {
    const auto texts = read_strings(dataset, where, check);
    if (is_axis) input.layout.axes.push_back({where, texts, "", long_name});
    if (!is_axis && rank == 0) input.layout.texts.push_back({where, texts.at(0), long_name});
    if (!is_axis && rank == 1) input.layout.lists.push_back({where, axes[0], texts, long_name});
  } else if (is_axis && rank == 1) {
    std::vector<double> coordinates(product(source.extent, 0, limits::labels, where, check));
    check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, coordinates.data()), "read",
          where);
    input.layout.axes.push_back({where, {}, unit, long_name, coordinates});
  }
}

void read_group(hid_t group, const std::string& prefix, const Check& check, Input& input, int depth) {
  require(depth <= limits::group_depth, prefix, "lies too deep", check);
  for (const std::string& name : children(group, prefix, check)) {
    const std::string where = prefix + name;
    require(++input.objects <= limits::objects, where, "is one object too many", check);
    Handle child = check(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "open", where);
    if (H5Iget_type(child) == H5I_GROUP) read_group(child, where + "/", check, input, depth + 1);
    if (H5Iget_type(child) == H5I_DATASET) read_dataset(std::move(child), where, check, input);
  }
}

}  // namespace

Input read_input(hid_t root, const Check& check) {
  Input input;
  input.layout.title = text_or_empty(root, "title");
  read_group(root, "", check, input, 0);
  return input;
}

}  // namespace osculate::hdf5
