// Creation of datasets, strings, attributes and axes in the form that HDF5 and netCDF-4 readers both
// understand. Included by src/record/*.cpp only.
#pragma once

#include <hdf5_hl.h>

#include <limits>
#include <string>
#include <vector>

#include "record/hdf5_handles.hpp"

namespace osculate::hdf5 {

constexpr unsigned tracked = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;

inline hid_t stored_type(Kind kind) {
  if (kind == Kind::integer) return H5T_STD_I64LE;
  if (kind == Kind::small) return H5T_STD_I8LE;
  return H5T_IEEE_F64LE;
}

/// Creates objects in an open file, all with creation order tracked and without time stamps.
class Creator {
 public:
  Creator(hid_t file, const Check& check)
      : file_(file), check_(check), transfer_(H5Pcreate(H5P_DATASET_XFER), H5Pclose) {
    // HDF5 clears its conversion buffer, of 1 MiB unless told, for every write of strings.
    H5Pset_buffer(transfer_, 16384, nullptr, nullptr);
  }

  void text_attribute(hid_t object, const std::string& name, const std::string& value) const {
    const Handle type = string_type();
    const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute = check_(H5Acreate2(object, name.c_str(), type, scalar, H5P_DEFAULT, H5P_DEFAULT),
                                    H5Aclose, "create attribute", name);
    const char* const text = value.c_str();
    check_(H5Awrite(attribute, type, &text), "write attribute", name);
  }

  template <std::size_t N>
  void number_attribute(hid_t object, const char* name, hid_t stored, hid_t native,
                        const auto(&values)[N]) const {
    const hsize_t size = N;
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle attribute = check_(H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT),
                                    H5Aclose, "create attribute", name);
    check_(H5Awrite(attribute, native, values), "write attribute", name);
  }

  /// A dataset of the given extent, with its groups. `chunk` empty: contiguous; else unlimited along the
  /// first axis.
  Handle dataset(const std::string& where, hid_t type, const std::vector<hsize_t>& extent,
                 const std::vector<hsize_t>& chunk, bool may_be_missing, const std::string& unit,
                 const std::string& long_name) const {
    make_groups(where);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation, false);
    H5Pset_attr_creation_order(creation, tracked);
    if (may_be_missing) H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &missing);
    const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    std::vector<hsize_t> largest = extent;
    if (!chunk.empty()) {
      largest.front() = H5S_UNLIMITED;
      H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
      H5Pset_shuffle(creation);
      H5Pset_deflate(creation, 1);
      std::size_t bytes = H5Tget_size(type);
      for (const hsize_t n : chunk) bytes *= n;
      H5Pset_chunk_cache(access, 7, bytes, 1.0);  // one chunk: whole chunks are written once and never read
    }
    const Handle space(extent.empty()
                           ? H5Screate(H5S_SCALAR)
                           : H5Screate_simple(static_cast<int>(extent.size()), extent.data(), largest.data()),
                       H5Sclose);
    Handle made = check_(H5Dcreate2(file_, where.c_str(), type, space, H5P_DEFAULT, creation, access),
                         H5Dclose, "create", where);
    if (!long_name.empty()) text_attribute(made, "long_name", long_name);
    if (!unit.empty()) text_attribute(made, "units", unit);
    if (may_be_missing) {
      const double fill[] = {missing};
      number_attribute(made, "_FillValue", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, fill);
    }
    return made;
  }

  /// Strings along one axis, or a scalar string if `scalar`.
  Handle strings(const std::string& where, const std::vector<std::string>& values, bool scalar,
                 const std::string& long_name) const {
    const Handle type = string_type();
    const std::vector<hsize_t> extent = scalar ? std::vector<hsize_t>{} : std::vector<hsize_t>{values.size()};
    Handle made = dataset(where, type, extent, {}, false, "", long_name);
    write(made, where, type, pointers(values).data());
    return made;
  }

  /// Writes a whole dataset, and at once (file_access has no buffer for raw data): closing a dataset would
  /// drop what the disk refuses then.
  void write(hid_t dataset, const std::string& where, hid_t type, const void* values) const {
    check_(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, transfer_, values), "write", where);
  }

  /// A fixed axis: labels or coordinates, as a dimension scale.
  Handle fixed_axis(const Axis& axis) const {
    Handle made;
    if (axis.coordinates.empty()) {
      made = strings(axis.name, axis.labels, false, axis.long_name);
    } else {
      made =
          dataset(axis.name, H5T_IEEE_F64LE, {axis.coordinates.size()}, {}, false, axis.unit, axis.long_name);
      write(made, axis.name, H5T_NATIVE_DOUBLE, axis.coordinates.data());
    }
    make_scale(made, axis.name.substr(axis.name.rfind('/') + 1));  // netCDF's name is the last part
    return made;
  }

  void make_scale(hid_t dataset, const std::string& name) const {
    check_(H5DSset_scale(dataset, name.c_str()), "make a dimension scale of", name);
  }

  void attach(hid_t dataset, const std::string& where, hid_t scale, std::size_t dimension) const {
    check_(H5DSattach_scale(dataset, scale, static_cast<unsigned>(dimension)), "attach an axis to", where);
  }

 private:
  void make_groups(const std::string& where) const {
    for (auto slash = where.find('/'); slash != std::string::npos; slash = where.find('/', slash + 1)) {
      const std::string group = where.substr(0, slash);
      if (group.empty() || check_(H5Lexists(file_, group.c_str(), H5P_DEFAULT), "look for", group) > 0)
        continue;
      const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
      H5Pset_obj_track_times(creation, false);
      H5Pset_link_creation_order(creation, tracked);
      H5Pset_attr_creation_order(creation, tracked);
      check_(H5Gcreate2(file_, group.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, "create group",
             group);
    }
  }

  hid_t file_;
  const Check& check_;
  Handle transfer_;
};

}  // namespace osculate::hdf5
