// Reads what a killed run left, as a single-writer-multiple-reader reader does, and writes it as a new
// finished file.
#include "record/hdf5_read.hpp"

namespace osculate {
namespace {

using hdf5::Check;
using hdf5::Handle;
using hdf5::Input;
using hdf5::Source;
using hdf5::text_attribute;
using hdf5::text_or_empty;
using std::filesystem::path;

path default_output(const path& in) {
  path out = in;
  if (out.extension() == ".h5") out.replace_extension();
  return out += ".recovered.h5";
}

void require_recoverable_name(const path& in) {
  std::error_code ignored;
  if (in.extension() == ".tmp") {
    throw FileError(in.string() +
                    ": is a temporary name: the run or recovery was stopped before its first or in its " +
                    "last moment; if " + path(in).replace_extension().string() +
                    " exists, recover that; else nothing was recorded; then delete the temporary");
  }
  if (!std::filesystem::exists(in, ignored)) {
    const path temporary = path(in) += ".tmp";
    if (std::filesystem::exists(temporary, ignored))
      throw FileError(in.string() + ": does not exist, only " + temporary.string() +
                      ": the run was stopped before its first row; delete that file and run again");
    throw FileError(in.string() + ": no such file");
  }
  if (std::filesystem::is_directory(in, ignored)) throw FileError(in.string() + ": is a directory");
  if (!std::filesystem::is_regular_file(in, ignored))
    throw FileError(in.string() + ": is a pipe or a device, not a regular file");
}

void require_unfinished(hid_t root, const path& in) {
  const auto status = text_attribute(root, "status");
  if (!status || text_or_empty(root, "component_order").empty())
    throw FileError(in.string() +
                    ": is not a result file of osculate: it has no root attributes 'status' and " +
                    "'component_order'");
  if (*status != "running")
    throw FileError(in.string() + ": is a finished file (status " + *status +
                    "): there is nothing to recover");
}

path copy(const path& in, const path& out, bool force, const std::function<void()>& alive) {
  const Check check{in, ""};
  const Handle file = hdf5::open_result(in, check);
  const Handle root = check(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  require_unfinished(root, in);
  Input input = hdf5::read_input(root, check);

  std::map<std::string, hsize_t> kept;
  std::string note;
  for (const auto& [axis, sources] : input.sources) {
    hsize_t shortest = sources.at(0).extent[0], longest = 0;
    for (const Source& source : sources) {
      shortest = std::min(shortest, hdf5::readable_rows(source, alive));
      longest = std::max(longest, source.extent[0]);
    }
    kept[axis] = shortest;
    note += axis + ": " + std::to_string(shortest) + " rows kept of " + std::to_string(longest) + " begun\n";
  }
  input.layout.texts.push_back(
      {"provenance/recovery", note, "rows that were on disk whole for every variable"});

  const path target = std::filesystem::absolute(out.empty() ? default_output(in) : out);
  std::error_code error;
  if (std::filesystem::equivalent(in, target, error))
    throw FileError(in.string() + ": cannot be recovered onto itself; choose another output");
  if (std::filesystem::exists(target, error) && !force)
    throw FileError(target.string() +
                    ": exists already; use --force to overwrite it, or choose another output");
  const path unfinished = path(target) += ".tmp";  // so that the final name never bears half of the rows
  try {
    ResultFile output(unfinished, input.layout, true);
    for (const auto& [axis, sources] : input.sources)
      hdf5::copy_rows(sources, axis, kept.at(axis), check, output, alive);
    output.finish("recovered", "");
    std::filesystem::rename(unfinished, target);
  } catch (const std::filesystem::filesystem_error& failure) {
    throw FileError(target.string() + ": " + failure.code().message());
  } catch (...) {
    std::filesystem::remove(unfinished, error);
    throw;
  }
  return target;
}

}  // namespace

path recover(const path& in, const path& out, bool force, const std::function<void()>& alive) {
  hdf5::prepare_library();
  require_recoverable_name(in);
  try {
    return copy(in, out, force, alive);
  } catch (const std::invalid_argument& fault) {  // what it says of itself cannot be written again
    throw FileError(in.string() + ": is not a result file of osculate, or a damaged one: " + fault.what());
  }
}

}  // namespace osculate
