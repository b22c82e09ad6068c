#include "record/log_table.hpp"

#include <algorithm>
#include <fstream>

#include "input/limits.hpp"
#include "record/hdf5_read.hpp"

namespace osculate {

namespace {

using hdf5::Check;
using hdf5::Handle;

struct Block {
  std::string path;
  hsize_t rows = 0, columns = 1;
  bool flat = true;  // one dimension
  std::vector<double> values;
};

/// Names of the links of a group; other programs' files need not know the order of their creation.
std::vector<std::string> names_in(hid_t group, const std::string& where, const Check& check) {
  H5G_info_t info;
  check(H5Gget_info(group, &info), "list the objects in", where);
  std::vector<std::string> out;
  for (hsize_t i = 0; i < std::min<hsize_t>(info.nlinks, limits::objects); ++i) {
    char name[256] = "";
    check(H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT),
          "list the objects in", where);
    out.emplace_back(name);
  }
  return out;
}

void read_group(hid_t group, const std::string& where, int depth, const Check& check,
                std::vector<Block>& blocks) {
  if (depth > limits::group_depth) return;
  for (const std::string& name : names_in(group, where.empty() ? "/" : where, check)) {
    const std::string path = where.empty() ? name : where + "/" + name;
    if (blocks.size() > limits::objects)
      throw FileError(check.file.string() + ": holds more than " + std::to_string(limits::objects) +
                      " datasets: this is no log");
    const Handle object = check(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "open", path);
    const H5I_type_t kind = H5Iget_type(object);
    if (kind == H5I_GROUP) read_group(object, path, depth + 1, check, blocks);
    if (kind != H5I_DATASET) continue;
    const Handle type = check(H5Dget_type(object), H5Tclose, "read the type of", path);
    const Handle space = check(H5Dget_space(object), H5Sclose, "read the size of", path);
    const int rank = H5Sget_simple_extent_ndims(space);
    const H5T_class_t sort = H5Tget_class(type);
    if ((sort != H5T_FLOAT && sort != H5T_INTEGER) || rank < 1 || rank > 2) continue;
    hsize_t extent[2] = {0, 1};
    H5Sget_simple_extent_dims(space, extent, nullptr);
    const hsize_t most = limits::log_bytes / sizeof(double);
    if (extent[0] == 0 || extent[1] == 0 || extent[0] > most / extent[1]) continue;
    Block block{path, extent[0], extent[1], rank == 1, {}};
    block.values.resize(extent[0] * extent[1]);
    check(H5Dread(object, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, block.values.data()), "read",
          path);
    blocks.push_back(std::move(block));
  }
}

}  // namespace

bool is_hdf5(const std::filesystem::path& file) {
  char begin[8] = {};
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored))  // to open a pipe would wait for its writer
    std::ifstream(file, std::ios::binary).read(begin, sizeof begin);
  return std::equal(begin, begin + 8, "\x89HDF\r\n\x1a\n");
}

NamedColumns read_log_table(const std::filesystem::path& file, const std::vector<std::string>& time) {
  hdf5::prepare_library();
  const Check check{file, "give an HDF5 or CSV file with the log of a controller"};
  const Handle opened = check(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open");
  const Handle root = check(H5Gopen2(opened, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  std::vector<Block> blocks;
  read_group(root, "", 0, check, blocks);
  const auto instants = std::find_if(blocks.begin(), blocks.end(), [&](const Block& block) {
    return std::find(time.begin(), time.end(), block.path) != time.end();
  });
  if (instants == blocks.end())
    throw FileError(file.string() + ": has no dataset of instants; name it '" + time.front() + "', in s");
  NamedColumns out;
  for (const Block& block : blocks) {
    if (block.rows != instants->rows) continue;
    for (hsize_t i = 0; i < block.columns; ++i) {
      out.names.push_back(block.flat ? block.path : block.path + "[" + std::to_string(i) + "]");
      std::vector<double>& column = out.columns.emplace_back(block.rows);
      for (hsize_t k = 0; k < block.rows; ++k) column[k] = block.values[k * block.columns + i];
    }
  }
  return out;
}

}  // namespace osculate
