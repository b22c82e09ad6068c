// The one place that knows how HDF5 reports errors and how its handles are closed. Included by
// src/record/*.cpp only.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "record/result_file.hpp"

namespace osculate::hdf5 {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// An HDF5 identifier and the function that closes it. Closing in the destructor ignores errors: files are
/// closed by `close`, which tells of them.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { close(); }

  operator hid_t() const { return id_; }

  /// Forgets the identifier without closing it.
  void abandon() { id_ = H5I_INVALID_HID; }

  herr_t close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 ? 0 : close_(id);
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Why the last HDF5 call failed: the operating system's words if it was asked ("No space left on device"),
/// else what the innermost HDF5 function said.
inline std::string last_reason() {
  std::vector<std::string> said;
  const auto collect = [](unsigned, const H5E_error2_t* error, void* into) -> herr_t {
    if (error->desc) static_cast<std::vector<std::string>*>(into)->emplace_back(error->desc);
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &said);
  constexpr std::string_view before = "error message = '";
  for (const std::string& text : said) {
    const auto found = text.find(before);
    if (found == std::string::npos) continue;
    const auto start = found + before.size();
    return text.substr(start, text.find('\'', start) - start);
  }
  return said.empty() ? "HDF5 gave no reason" : said.front();
}

/// Turns negative HDF5 return values into a FileError: "FILE: cannot WHAT OBJECT: REASON".
struct Check {
  std::filesystem::path file;
  std::string remedy;  // appended to every message if not empty

  std::int64_t operator()(std::int64_t returned, std::string_view what, std::string_view object = "") const {
    if (returned < 0) fail(what, object);
    return returned;
  }
  Handle operator()(hid_t id, Handle::Close closer, std::string_view what,
                    std::string_view object = "") const {
    if (id < 0) fail(what, object);
    return Handle(id, closer);
  }

  [[noreturn]] void fail(std::string_view what, std::string_view object) const {
    std::string message = file.string() + ": cannot ";
    message += what;
    if (!object.empty()) message += " '" + std::string(object) + "'";
    message += ": " + last_reason();
    if (!remedy.empty()) message += "; " + remedy;
    throw FileError(message);
  }
};

/// Once, before the first HDF5 call: no error stacks on stderr, and no second attempt to flush at exit what a
/// full disk has already refused.
inline void prepare_library() {
  static const bool done = [] {
    H5dont_atexit();
    H5open();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    return true;
  }();
  static_cast<void>(done);
}

/// Variable-length UTF-8, the only string type of our files.
inline Handle string_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

/// File format of HDF5 1.10, which single-writer-multiple-reader mode needs. Locks are taken where the file
/// system has them.
inline Handle file_access(bool lock) {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  H5Pset_sieve_buf_size(access, 0);        // what is written reaches the file, or fails, at once
  H5Pset_cache(access, 0, 7, 65536, 1.0);  // one chunk of each variable: they are written once, never read
  H5Pset_file_locking(access, lock, true);
  return access;
}

/// The same for a file that is made in memory and written, in one piece, when it is closed.
inline Handle file_access_in_memory(bool lock) {
  Handle access = file_access(lock);
  H5Pset_fapl_core(access, 1u << 14, true);
  return access;
}

inline std::vector<const char*> pointers(const std::vector<std::string>& texts) {
  std::vector<const char*> result;
  for (const std::string& text : texts) result.push_back(text.c_str());
  return result;
}

}  // namespace osculate::hdf5
