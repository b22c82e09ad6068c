// Fuzz target: the reader of unfinished result files. Bytes that start with HDF5's signature are the file
// itself. All others are a recipe for a file that is valid HDF5 and hardly ever what osculate writes: what
// happens then is our reader's doing, not the library's.
#include <hdf5.h>
#include <hdf5_hl.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef OSCULATE_SANITIZED
#include <sanitizer/asan_interface.h>
#endif

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "record/result_file.hpp"

namespace {

namespace fs = std::filesystem;

/// The bytes of a recipe, one number after the other; 0 when they are used up.
struct Bytes {
  const std::uint8_t* at;
  const std::uint8_t* end;
  bool empty() const { return at == end; }
  unsigned below(unsigned n) { return empty() ? 0 : *at++ % n; }
};

constexpr std::array names{"time",  "step",         "joint",          "a/x", "a/y", "a",
                           "b/c/d", "solver/order", "provenance/text"};
constexpr std::array attributes{"units",           "long_name", "_FillValue", "status",        "title",
                                "component_order", "CLASS",     "NAME",       "DIMENSION_LIST"};
constexpr std::array<hsize_t, 9> extents{0, 1, 2, 3, 7, 300, 1u << 20, hsize_t(1) << 40, hsize_t(1) << 62};

hid_t text_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  return type;
}

void write_text(hid_t object, const char* name, const char* text) {
  const hid_t type = text_type(), space = H5Screate(H5S_SCALAR);
  const hid_t made = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (made >= 0) H5Awrite(made, type, &text), H5Aclose(made);
  H5Sclose(space), H5Tclose(type);
}

hid_t some_type(Bytes& bytes) {
  switch (bytes.below(10)) {
    default:
      return H5Tcopy(H5T_IEEE_F64LE);
    case 4:
      return H5Tcopy(H5T_STD_I64LE);
    case 5:
      return H5Tcopy(H5T_STD_I8LE);
    case 6:
      return text_type();
    case 7:
      return H5Tcopy(H5T_C_S1);
    case 8:
      return H5Tenum_create(H5T_NATIVE_INT);
    case 9: {
      const hid_t pair = H5Tcreate(H5T_COMPOUND, 16);
      H5Tinsert(pair, "r", 0, H5T_NATIVE_DOUBLE);
      return pair;
    }
  }
}

class Recipe {
 public:
  Recipe(hid_t file, Bytes bytes) : file_(file), bytes_(bytes) {
    for (int steps = 0; !bytes_.empty() && steps < 24; ++steps) step();
    for (const hid_t set : sets_) H5Dclose(set);
  }

 private:
  void step() {
    switch (bytes_.below(8)) {
      default:
        return make_set();
      case 3:
        return attach();
      case 4:
        return give_attribute();
      case 5:
        return link();
      case 6:
        return write();
    }
  }
  hid_t some_set() {
    return sets_.empty() ? file_ : sets_[bytes_.below(static_cast<unsigned>(sets_.size()))];
  }

  void make_set() {
    const char* name = names[bytes_.below(names.size())];
    const hid_t type = some_type(bytes_);
    const unsigned rank = bytes_.below(5), kind = bytes_.below(4);  // 0, 1: grows; 2: fixed; 3: no space
    std::vector<hsize_t> size, most, chunk;
    for (unsigned i = 0; i < rank; ++i) {
      size.push_back(extents[bytes_.below(extents.size())]);
      most.push_back((i == 0 || kind == 1) && kind < 2 ? H5S_UNLIMITED : size.back());
      chunk.push_back(1 + bytes_.below(64));
    }
    const hid_t space = kind == 3   ? H5Screate(H5S_NULL)
                        : rank == 0 ? H5Screate(H5S_SCALAR)
                                    : H5Screate_simple(static_cast<int>(rank), size.data(), most.data());
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE), links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    if (rank > 0 && kind < 2) H5Pset_chunk(creation, static_cast<int>(rank), chunk.data());
    H5Pset_alloc_time(creation, H5D_ALLOC_TIME_INCR);
    const hid_t set = H5Dcreate2(file_, name, type, space, links, creation, H5P_DEFAULT);
    if (set >= 0) {
      sets_.push_back(set);
      if (!tampered_ && bytes_.below(2)) H5DSset_scale(set, bytes_.below(2) ? name : "elsewhere");
    }
    H5Pclose(links), H5Pclose(creation), H5Sclose(space), H5Tclose(type);
  }
  void attach() {
    const hid_t set = some_set(), scale = some_set();
    if (tampered_) return;  // the library would crash here, while the file is made
    H5DSattach_scale(set, scale, bytes_.below(5));
  }
  void give_attribute() {
    const hid_t object = bytes_.below(3) ? some_set() : file_;
    const char* name = attributes[bytes_.below(attributes.size())];
    H5Adelete(object, name);
    tampered_ = tampered_ || std::string(name) == "DIMENSION_LIST";
    if (bytes_.below(2)) return write_text(object, name, bytes_.below(2) ? "running" : "");
    const hid_t type = some_type(bytes_), space = some_space();
    const hid_t made = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const std::array<const char*, 3> texts{"one", "two", "three"};
    const std::array<char, 64> zeros{};
    if (made >= 0)
      H5Awrite(made, type,
               H5Tis_variable_str(type) > 0 ? static_cast<const void*>(texts.data()) : zeros.data());
    if (made >= 0) H5Aclose(made);
    H5Sclose(space), H5Tclose(type);
  }
  hid_t some_space() {
    const hsize_t three = 3;
    const unsigned kind = bytes_.below(3);
    return kind == 2 ? H5Screate_simple(1, &three, nullptr) : H5Screate(kind == 1 ? H5S_NULL : H5S_SCALAR);
  }
  void link() {
    const char* name = names[bytes_.below(names.size())];
    const hid_t properties = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(properties, 1);
    switch (bytes_.below(4)) {
      case 0:
        H5Lcreate_hard(file_, "/", file_, name, properties, H5P_DEFAULT);
        break;
      case 1:
        H5Lcreate_soft(bytes_.below(2) ? "/a" : "/nowhere", file_, name, properties, H5P_DEFAULT);
        break;
      case 2:
        H5Lcreate_external("/nowhere.h5", "/", file_, name, properties, H5P_DEFAULT);
        break;
      case 3:
        H5Lcreate_hard(file_, names[bytes_.below(names.size())], file_, "again", properties, H5P_DEFAULT);
    }
    H5Pclose(properties);
  }
  /// Where a set is small: all of its values, as doubles.
  void write() {
    const hid_t set = some_set();
    const hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    const hssize_t count = space < 0 ? 0 : H5Sget_simple_extent_npoints(space);
    if (count > 0 && count < 4096 && H5Tget_class(type) <= H5T_FLOAT) {
      std::vector<double> values(static_cast<std::size_t>(count), bytes_.below(256) - 128.0);
      if (bytes_.below(4) == 0) values.front() = std::numeric_limits<double>::quiet_NaN();
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
  }

  hid_t file_;
  Bytes bytes_;
  std::vector<hid_t> sets_;
  bool tampered_ = false;
};

void cook(const fs::path& target, const std::uint8_t* data, std::size_t size) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const hid_t file = H5Fcreate(target.c_str(), H5F_ACC_TRUNC, creation, access);
  write_text(file, "status", "running");
  write_text(file, "component_order", "angular,linear");
  Recipe(file, {data, data + size});
  H5Fclose(file), H5Pclose(creation), H5Pclose(access);
}

bool in_child = false;

[[noreturn]] void complain(const std::string& what) {
  std::cerr << what << std::endl;
  if (in_child) _exit(1);  // abort() there is the library's, out of free()
  std::abort();
}

void recover(const fs::path& in, const fs::path& out) {
  try {
    osculate::recover(in, out, true);
    if (H5Fis_hdf5(out.c_str()) <= 0) complain("what was recovered is no HDF5 file");
  } catch (const osculate::FileError& error) {
    if (!std::string(error.what()).starts_with(in.parent_path().string())) complain(error.what());
  }
}

/// Whether the first function in a sanitizer's report that is not the sanitizer's own is the library's.
bool library_is_to_blame(const char* report) {
  const std::string_view text = report;
  return text.find("libhdf5") < text.find(" osculate::");
}

/// As the program does it (cli/contained.hpp): HDF5 may crash on such bytes, or take for ever, and only the
/// child ends.
void recover_in_child(const fs::path& in, const fs::path& out) {
  constexpr int blamed_on_library = 98;
  const pid_t child = fork();
  if (child == 0) {
    in_child = true;
    alarm(5);
#ifdef OSCULATE_SANITIZED
    __asan_set_error_report_callback([](const char* report) {
      if (library_is_to_blame(report)) _exit(blamed_on_library);
    });
#endif
    recover(in, out);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
#ifdef OSCULATE_SANITIZED
  const bool fine = signal == SIGALRM;  // the sanitizer turns all others into exit codes, but for abort()
#else
  const bool fine =
      signal == SIGALRM || signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGABRT;
#endif
  const bool ended =
      WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == blamed_on_library);
  if (!fine && !ended) complain("the child failed: signal " + std::to_string(signal));
}

}  // namespace

// HDF5 loses some memory of objects that it refuses.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fs::path folder = [] {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    return fs::temp_directory_path() / ("osculate_fuzz_" + std::to_string(getpid()));
  }();
  fs::create_directories(folder);
  const fs::path in = folder / "in.h5", out = folder / "out.h5";
  constexpr std::array<std::uint8_t, 4> signature{0x89, 'H', 'D', 'F'};
  if (size >= signature.size() && std::equal(signature.begin(), signature.end(), data)) {
    std::ofstream(in, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    recover_in_child(in, out);
  } else {
    cook(in, data, size);
    recover(in, out);
  }
  fs::remove_all(folder);
  return 0;
}
