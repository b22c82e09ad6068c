// Creation of datasets, strings, attributes and axes in the form that HDF5 and netCDF-4 readers both
// understand. Included by src/record/*.cpp only.
#pragma once

#include <hdf5_hl.h>

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "record/hdf5_handles.hpp"

namespace osculate::hdf5 {

constexpr unsigned tracked = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;

/// Of the root and of other groups. Their links lie in their headers, which are made large enough: that costs
/// half of what HDF5's other form does, a heap with two trees for each group.
inline void set_group_properties(hid_t creation) {
  H5Pset_link_creation_order(creation, tracked);
  H5Pset_attr_creation_order(creation, tracked);
  H5Pset_link_phase_change(creation, 200, 100);
  H5Pset_est_link_info(creation, 40, 16);
}

inline hid_t stored_type(Kind kind) {
  if (kind == Kind::integer) return H5T_STD_I64LE;
  if (kind == Kind::small) return H5T_STD_I8LE;
  return H5T_IEEE_F64LE;
}

/// Creates objects in an open file, all with creation order tracked and without time stamps. Whoever attaches
/// axes calls `write_references` when all is created.
class Creator {
 public:
  Creator(hid_t file, const Check& check)
      : file_(file),
        check_(check),
        transfer_(H5Pcreate(H5P_DATASET_XFER), H5Pclose),
        group_creation_(H5Pcreate(H5P_GROUP_CREATE), H5Pclose),
        text_(string_type()),
        scalar_(H5Screate(H5S_SCALAR), H5Sclose),
        references_(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose) {
    // HDF5 clears its conversion buffer, of 1 MiB unless told, for every write of strings.
    H5Pset_buffer(transfer_, 16384, nullptr, nullptr);
    H5Pset_obj_track_times(group_creation_, false);
    set_group_properties(group_creation_);
  }

  void text_attribute(hid_t object, const std::string& name, const std::string& value) const {
    const char* const text = value.c_str();
    attribute(object, name.c_str(), text_, text_, scalar_, &text);
  }

  template <std::size_t N>
  void number_attribute(hid_t object, const char* name, hid_t stored, hid_t native,
                        const auto(&values)[N]) const {
    const hsize_t size = N;
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    attribute(object, name, stored, native, space, values);
  }

  /// A dataset of the given extent, with its groups. `chunk` empty: contiguous; else unlimited along the
  /// first axis.
  Handle dataset(const std::string& where, hid_t type, const std::vector<hsize_t>& extent,
                 const std::vector<hsize_t>& chunk, bool may_be_missing, const std::string& unit,
                 const std::string& long_name) {
    std::vector<hsize_t> largest = extent;
    if (!chunk.empty()) largest.front() = H5S_UNLIMITED;
    const Handle space(extent.empty()
                           ? H5Screate(H5S_SCALAR)
                           : H5Screate_simple(static_cast<int>(extent.size()), extent.data(), largest.data()),
                       H5Sclose);
    Handle made = check_(H5Dcreate2(group_of(where), last_part(where), type, space, H5P_DEFAULT,
                                    creation(chunk, may_be_missing), H5P_DEFAULT),
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
                 const std::string& long_name) {
    const std::vector<hsize_t> extent = scalar ? std::vector<hsize_t>{} : std::vector<hsize_t>{values.size()};
    Handle made = dataset(where, text_, extent, {}, false, "", long_name);
    write(made, where, text_, pointers(values).data());
    return made;
  }

  /// Writes a whole dataset, and at once (file_access has no buffer for raw data): closing a dataset would
  /// drop what the disk refuses then.
  void write(hid_t dataset, const std::string& where, hid_t type, const void* values) const {
    check_(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, transfer_, values), "write", where);
  }

  /// A fixed axis: labels or coordinates, as a dimension scale.
  void fixed_axis(const Axis& axis) {
    Handle made;
    if (axis.coordinates.empty()) {
      made = strings(axis.name, axis.labels, false, axis.long_name);
    } else {
      made =
          dataset(axis.name, H5T_IEEE_F64LE, {axis.coordinates.size()}, {}, false, axis.unit, axis.long_name);
      write(made, axis.name, H5T_NATIVE_DOUBLE, axis.coordinates.data());
    }
    make_scale(made, axis.name);
  }

  void make_scale(hid_t dataset, const std::string& where) const {
    check_(H5DSset_scale(dataset, last_part(where)), "make a dimension scale of", where);
  }

  /// The axes of all dimensions of a dataset, by their paths. What HDF5's own H5DSattach_scale writes, but in
  /// one piece: that opens and rewrites the axis for each of its users, at a cost that grows with their
  /// square.
  void attach(hid_t dataset, const std::string& where, const std::vector<std::string>& axes) {
    const hobj_ref_t user = reference(dataset, ".", where);
    std::vector<hvl_t> lists;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      auto& [axis, users] = users_of(axes[i]);
      users.push_back({user, static_cast<int>(i)});
      lists.push_back({1, &axis});
    }
    const hsize_t size = lists.size();
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    attribute(dataset, "DIMENSION_LIST", references_, references_, space, lists.data());
  }

  /// The list of its users at every axis that got some, those before included.
  void write_references() {
    const Handle stored = use_type(H5T_STD_REF_OBJ, H5T_STD_I32LE, sizeof(hobj_ref_t), 12);
    const Handle native = use_type(H5T_STD_REF_OBJ, H5T_NATIVE_INT, offsetof(Use, dimension), sizeof(Use));
    constexpr const char* name = "REFERENCE_LIST";
    for (auto& [path, axis] : axes_) {
      const Handle dataset = check_(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open", path);
      std::vector<Use> users;
      if (check_(H5Aexists(dataset, name), "look for attribute", name) > 0) {
        const Handle before = check_(H5Aopen(dataset, name, H5P_DEFAULT), H5Aclose, "open attribute", name);
        const Handle space(H5Aget_space(before), H5Sclose);
        users.resize(static_cast<std::size_t>(check_(H5Sget_simple_extent_npoints(space), "read", name)));
        check_(H5Aread(before, native, users.data()), "read attribute", name);
        check_(H5Adelete(dataset, name), "delete attribute", name);
      }
      users.insert(users.end(), axis.users.begin(), axis.users.end());
      const hsize_t size = users.size();
      const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
      attribute(dataset, name, stored, native, space, users.data());
    }
    axes_.clear();
  }

 private:
  /// A dimension of a dataset along an axis, as HDF5's dimension scales keep it.
  struct Use {
    hobj_ref_t dataset;
    int dimension;
  };
  struct Users {
    hobj_ref_t axis;
    std::vector<Use> users;
  };

  static const char* last_part(const std::string& where) {
    return where.c_str() + (where.rfind('/') + 1);  // npos + 1 = 0
  }

  static Handle use_type(hid_t reference, hid_t number, std::size_t second, std::size_t size) {
    Handle type(H5Tcreate(H5T_COMPOUND, size), H5Tclose);
    H5Tinsert(type, "dataset", 0, reference);
    H5Tinsert(type, "dimension", second, number);
    return type;
  }

  void attribute(hid_t object, const char* name, hid_t stored, hid_t native, hid_t space,
                 const void* values) const {
    const Handle made = check_(H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                               "create attribute", name);
    check_(H5Awrite(made, native, values), "write attribute", name);
  }

  hobj_ref_t reference(hid_t from, const char* name, const std::string& where) const {
    hobj_ref_t made = 0;
    check_(H5Rcreate(&made, from, name, H5R_OBJECT, -1), "refer to", where);
    return made;
  }

  Users& users_of(const std::string& axis) {
    const auto [found, first] = axes_.try_emplace(axis);
    if (first) found->second.axis = reference(file_, axis.c_str(), axis);
    return found->second;
  }

  /// Properties of datasets, one list for all of a kind.
  hid_t creation(const std::vector<hsize_t>& chunk, bool may_be_missing) {
    Handle& made = creations_[{chunk, may_be_missing}];
    if (made >= 0) return made;
    made = Handle(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(made, false);
    H5Pset_attr_creation_order(made, tracked);
    if (may_be_missing) H5Pset_fill_value(made, H5T_NATIVE_DOUBLE, &missing);
    if (!chunk.empty()) {
      H5Pset_chunk(made, static_cast<int>(chunk.size()), chunk.data());
      H5Pset_shuffle(made);
      H5Pset_deflate(made, 1);
    }
    return made;
  }

  /// The group that a path lies in, made with those around it unless it is there.
  hid_t group_of(const std::string& where) {
    const auto slash = where.rfind('/');
    if (slash == std::string::npos) return file_;
    const std::string path = where.substr(0, slash);
    Handle& group = groups_[path];
    if (group >= 0) return group;
    const hid_t around = group_of(path);
    const char* const name = last_part(path);
    group = check_(H5Lexists(around, name, H5P_DEFAULT), "look for", path) > 0
                ? check_(H5Gopen2(around, name, H5P_DEFAULT), H5Gclose, "open group", path)
                : check_(H5Gcreate2(around, name, H5P_DEFAULT, group_creation_, H5P_DEFAULT), H5Gclose,
                         "create group", path);
    return group;
  }

  hid_t file_;
  const Check& check_;
  Handle transfer_, group_creation_, text_, scalar_, references_;
  std::map<std::pair<std::vector<hsize_t>, bool>, Handle> creations_;
  std::map<std::string, Handle> groups_;  // by path
  std::map<std::string, Users> axes_;     // by path: those that got users
};

}  // namespace osculate::hdf5
