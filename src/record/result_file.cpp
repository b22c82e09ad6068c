#include "record/result_file.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "record/ending.hpp"
#include "record/hdf5_create.hpp"

namespace osculate {
namespace {

using hdf5::Check;
using hdf5::Creator;
using hdf5::Handle;
using hdf5::stored_type;
using hdf5::tracked;
using std::filesystem::path;

using Clock = std::chrono::steady_clock;
/// Chunks that fill slowly are written as far as they have come this often: a killed run loses no more.
constexpr std::chrono::seconds flush_every{1};

/// Rows in a chunk: the power of two in [16, 256] that keeps a chunk of the widest variable within 64 KiB.
hsize_t rows_in_chunk(std::size_t widest_row_bytes) {
  hsize_t rows = 256;
  while (rows > 16 && rows * widest_row_bytes > 65536) rows /= 2;
  return rows;
}

/// One recorded variable: its place in an appended row and its dataset.
struct Column {
  std::string path;
  Handle dataset = {};
  Kind kind = Kind::real;
  bool may_be_missing = false;
  std::size_t first = 0;        // index in the row
  std::size_t count = 1;        // values in the row
  std::vector<hsize_t> extent;  // of one row: 1, then the fixed axes
};

/// Everything recorded along one unlimited axis. columns[0] is the axis itself.
struct Track {
  std::vector<Column> columns;
  std::size_t row_size = 0;
  hsize_t chunk_rows = 0;
  hsize_t written_rows = 0;    // in whole chunks
  std::vector<double> buffer;  // whole rows; never more than chunk_rows of them
  hsize_t flushed_rows = 0;    // of the buffer, in a part-full chunk

  hsize_t buffered_rows() const { return buffer.size() / row_size; }
};

void require_storable(const Column& column, std::span<const double> values) {
  for (const double value : values) {
    if (std::isnan(value) && !column.may_be_missing)
      throw std::invalid_argument(column.path +
                                  ": NaN, but this variable is not declared as one that may be missing");
    const double limit = column.kind == Kind::small ? 0x1p7 : 0x1p63;
    if (column.kind != Kind::real && !(value >= -limit && value < limit && value == std::trunc(value)))
      throw std::invalid_argument(column.path + ": " + std::to_string(value) +
                                  " does not fit its integer type");
  }
}

/// The rows of one column, contiguous, each value as `stored` makes it of a double.
template <class T, class Stored>
std::span<const T> gather(const Track& track, const Column& column, std::vector<T>& block,
                          const Stored& stored) {
  block.resize(track.buffered_rows() * column.count);
  const double* values = track.buffer.data() + column.first;
  for (auto at = block.begin(); at != block.end(); values += track.row_size)
    for (std::size_t i = 0; i < column.count; ++i) *at++ = stored(values[i]);
  return block;
}

/// How many values of a block of whole rows equal the one in the row before.
std::size_t repeated(std::span<const std::uint64_t> block, std::size_t row) {
  std::size_t count = 0;
  for (std::size_t i = row; i < block.size(); ++i) count += block[i] == block[i - row];
  return count;
}

/// Device and inode: tells whether a name still means the same file.
std::pair<dev_t, ino_t> identity(const path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino};
}

path temporary_name(const path& file) { return path(file) += ".tmp"; }

void rename_or_fail(const path& from, const path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error) throw FileError(to.string() + ": cannot rename " + from.string() + " to it: " + error.message());
}

}  // namespace

struct ResultFile::Impl {
  path name;
  Check check;
  Handle file;
  std::map<std::string, Track> tracks;
  FixedAxes fixed;
  std::pair<dev_t, ino_t> id;
  std::vector<std::uint64_t> words;  // one column of a chunk on its way
  std::vector<std::int8_t> bytes;
  Clock::time_point flushed_at = Clock::now();
  enum class State { writing, finished, write_failed } state = State::writing;

  Impl(const path& where, const Layout& layout, bool force);
  ~Impl();
  void create_objects(const Layout& layout);
  void write_rows(Track& track);
  void flush_rows(Track& track);
  void write_column(Track& track, Column& column, hsize_t rows);
  void close_file();
};

ResultFile::Impl::Impl(const path& where, const Layout& layout, bool force)
    : name(std::filesystem::absolute(where)), check{where, ""} {
  hdf5::prepare_library();
  std::error_code ignored;
  const path directory = name.parent_path();
  if (!std::filesystem::is_directory(directory, ignored))
    throw FileError(where.string() + ": no such directory: " + directory.string() +
                    "; make it or choose another output");
  if (std::filesystem::is_directory(name, ignored)) throw FileError(where.string() + ": is a directory");
  if (std::filesystem::exists(name, ignored) && !force)
    throw FileError(where.string() +
                    ": exists already; use --force to overwrite it, or choose another output");

  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);
  H5Pset_link_creation_order(creation, tracked);
  H5Pset_attr_creation_order(creation, tracked);
  const path temporary = temporary_name(name);
  file = check(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, creation, hdf5::file_access(true)), H5Fclose,
               "create");
  try {
    create_objects(layout);
    check(H5Fstart_swmr_write(file), "start single-writer-multiple-reader mode");
    id = identity(temporary);
    rename_or_fail(temporary, name);
  } catch (...) {
    tracks.clear();
    file.close();
    std::filesystem::remove(temporary, ignored);
    throw;
  }
  check.remedy = "what was written before is safe: 'osculate recover " + where.string() +
                 "' makes a finished file of it";
}

/// After a failed write HDF5 must not close the file: it would mark it as closed well while its end is
/// missing. Left as it is (one file descriptor stays open until the process ends) it is what a killed run
/// leaves.
ResultFile::Impl::~Impl() {
  if (state != State::write_failed) return;
  for (auto& [axis, track] : tracks)
    for (Column& column : track.columns) column.dataset.abandon();
  file.abandon();
}

void ResultFile::Impl::create_objects(const Layout& layout) {
  const Creator create(file, check);
  const Handle root = check(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "open the root group");
  create.text_attribute(root, "title", layout.title);
  create.text_attribute(root, "Conventions", "CF-1.8");
  create.text_attribute(root, "component_order", "angular,linear");
  create.text_attribute(root, "status", "running");

  std::map<std::string, const Axis*> axes;
  std::map<std::string, std::size_t> widest;  // values in a row of the widest variable, by unlimited axis
  for (const Axis& axis : layout.axes) {
    require(axes.emplace(axis.name, &axis).second, "axis '" + axis.name + "' given twice");
    require(axis.name.find('/') == std::string::npos, "axis '" + axis.name + "' is not in the root group");
    require_one_kind(axis);
    if (axis.fixed()) fixed[axis.name] = axis.size();
    if (!axis.fixed()) widest[axis.name] = 1;
  }
  const auto find_axis = [&](const std::string& axis, const std::string& user) -> const Axis& {
    require(axes.contains(axis), user + ": unknown axis '" + axis + "'");
    return *axes.at(axis);
  };
  for (const Variable& variable : layout.variables) {
    require(!variable.axes.empty(), variable.path + ": has no axis");
    require(!find_axis(variable.axes[0], variable.path).fixed(),
            variable.path + ": first axis is not unlimited");
    require(std::set(variable.axes.begin(), variable.axes.end()).size() == variable.axes.size(),
            variable.path + ": one axis twice; two equal axes need two names");
    require(!variable.may_be_missing || variable.kind == Kind::real,
            variable.path + ": an integer cannot be missing");
    std::size_t count = 1;
    for (std::size_t i = 1; i < variable.axes.size(); ++i) {
      const Axis& axis = find_axis(variable.axes[i], variable.path);
      require(axis.fixed(), variable.path + ": only the first axis may be unlimited");
      count *= axis.size();
    }
    widest[variable.axes[0]] = std::max(widest[variable.axes[0]], count);
  }

  std::map<std::string, Handle> scales;  // of the fixed axes
  for (const Axis& axis : layout.axes) {
    if (axis.fixed()) {
      scales.emplace(axis.name, create.fixed_axis(axis));
      continue;
    }
    Track& track = tracks[axis.name];
    track.chunk_rows = rows_in_chunk(widest[axis.name] * sizeof(double));
    track.row_size = 1;
    Column column{.path = axis.name, .extent = {1}};
    column.dataset =
        create.dataset(axis.name, H5T_IEEE_F64LE, {0}, {track.chunk_rows}, false, axis.unit, axis.long_name);
    create.make_scale(column.dataset, axis.name);
    track.columns.push_back(std::move(column));
  }
  const auto scale_of = [&](const std::string& axis) -> hid_t {
    return axes.at(axis)->fixed() ? scales.at(axis) : tracks.at(axis).columns[0].dataset;
  };

  for (const Variable& variable : layout.variables) {
    Track& track = tracks.at(variable.axes[0]);
    Column column{.path = variable.path,
                  .kind = variable.kind,
                  .may_be_missing = variable.may_be_missing,
                  .first = track.row_size,
                  .extent = {1}};
    for (std::size_t i = 1; i < variable.axes.size(); ++i) {
      column.extent.push_back(axes.at(variable.axes[i])->size());
      column.count *= column.extent.back();
    }
    std::vector<hsize_t> chunk = column.extent, extent = column.extent;
    chunk[0] = track.chunk_rows;
    extent[0] = 0;
    column.dataset = create.dataset(variable.path, stored_type(variable.kind), extent, chunk,
                                    variable.may_be_missing, variable.unit, variable.long_name);
    for (std::size_t i = 0; i < variable.axes.size(); ++i)
      create.attach(column.dataset, variable.path, scale_of(variable.axes[i]), i);
    track.row_size += column.count;
    track.columns.push_back(std::move(column));
  }
  for (const StringList& list : layout.lists) {
    require_fits(list, find_axis(list.axis, list.path).size());
    const Handle made = create.strings(list.path, list.values, false, list.long_name);
    create.attach(made, list.path, scale_of(list.axis), 0);
  }
  for (const Text& text : layout.texts) create.strings(text.path, {text.value}, true, text.long_name);
  for (auto& [axis, track] : tracks) track.buffer.reserve(track.chunk_rows * track.row_size);
}

void ResultFile::Impl::write_column(Track& track, Column& column, hsize_t rows) {
  std::vector<hsize_t> start(column.extent.size(), 0), count = column.extent, extent = column.extent;
  start[0] = track.written_rows;
  count[0] = rows;
  extent[0] = track.written_rows + rows;
  check(H5Dset_extent(column.dataset, extent.data()), "extend", column.path);
  const auto small = [](double x) { return static_cast<std::int8_t>(x); };
  const auto word = [&column](double x) {
    return column.kind == Kind::real ? std::bit_cast<std::uint64_t>(x)
                                     : static_cast<std::uint64_t>(static_cast<std::int64_t>(x));
  };
  // Compressing a smooth record costs more than simulating it and saves a third: a chunk in which few values
  // repeat those of the row before is stored as it is, past the filters. The last one is filled up with
  // zeros.
  // So is a chunk that is written part full: to fill it up then changes none of the bytes that are there, so
  // that a run that is killed meanwhile leaves the rows before whole.
  const auto store = [&](auto& block) {
    block.resize(track.chunk_rows * column.count);
    constexpr std::uint32_t no_filter = 0xffffffff;
    check(H5Dwrite_chunk(column.dataset, H5P_DEFAULT, no_filter, start.data(), block.size() * sizeof block[0],
                         block.data()),
          "write", column.path);
    check(H5Dflush(column.dataset), "write", column.path);
  };
  if (std::endian::native == std::endian::little) {
    if (column.kind != Kind::small) {
      const std::span<const std::uint64_t> block = gather(track, column, words, word);
      if (track.flushed_rows > 0 || 2 * repeated(block, column.count) < block.size()) return store(words);
    } else if (track.flushed_rows > 0) {
      gather(track, column, bytes, small);
      return store(bytes);
    }
  }
  const Handle target = check(H5Dget_space(column.dataset), H5Sclose, "write", column.path);
  check(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), "write",
        column.path);
  const Handle source(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
  const auto write = [&](hid_t type, const auto& block) {
    check(H5Dwrite(column.dataset, type, source, target, H5P_DEFAULT, block.data()), "write", column.path);
  };
  if (column.kind == Kind::small)
    write(H5T_NATIVE_INT8, gather(track, column, bytes, small));
  else
    write(column.kind == Kind::real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64,
          gather(track, column, words, word));
  check(H5Dflush(column.dataset), "write", column.path);
}

/// Writes the buffered rows of every variable of the track; the axis last, so that a reader who goes by its
/// length finds the others there.
void ResultFile::Impl::write_rows(Track& track) {
  state = State::write_failed;  // stays so if a write throws
  for (std::size_t i = track.columns.size(); i-- > 0;)
    write_column(track, track.columns[i], track.buffered_rows());
  state = State::writing;
}

void ResultFile::Impl::flush_rows(Track& track) {
  if (track.buffer.empty()) return;
  write_rows(track);
  track.written_rows += track.buffered_rows();
  track.flushed_rows = 0;
  track.buffer.clear();
}

void ResultFile::Impl::close_file() {
  for (auto& [axis, track] : tracks)
    for (Column& column : track.columns) column.dataset.close();
  check(file.close(), "close");
}

ResultFile::ResultFile(const path& file, const Layout& layout, bool force)
    : impl_(std::make_unique<Impl>(file, layout, force)) {}

ResultFile::~ResultFile() = default;
ResultFile::ResultFile(ResultFile&&) noexcept = default;

std::size_t ResultFile::rows(const std::string& axis) const {
  row_size(axis);
  const Track& track = impl_->tracks.at(axis);
  return track.written_rows + track.buffered_rows();
}

std::vector<std::string> ResultFile::variables(const std::string& axis) const {
  row_size(axis);
  std::vector<std::string> out;
  for (const Column& column : impl_->tracks.at(axis).columns) out.push_back(column.path);
  return out;
}

void ResultFile::flush(const std::string& axis) {
  row_size(axis);
  Track& track = impl_->tracks.at(axis);
  if (track.buffered_rows() == track.flushed_rows) return;
  track.flushed_rows = track.buffered_rows();
  impl_->write_rows(track);
}

std::size_t ResultFile::row_size(const std::string& axis) const {
  const auto track = impl_->tracks.find(axis);
  if (track == impl_->tracks.end())
    throw std::invalid_argument("'" + axis + "' is not an unlimited axis of this file");
  return track->second.row_size;
}

void ResultFile::append(const std::string& axis, std::span<const double> row) {
  const std::size_t expected = row_size(axis);
  if (impl_->state != Impl::State::writing)
    throw std::logic_error("append to a result file that is finished or could not be written");
  if (row.size() != expected)
    throw std::invalid_argument("row along '" + axis + "' has " + std::to_string(row.size()) +
                                " values, not " + std::to_string(expected));
  Track& track = impl_->tracks.at(axis);
  for (const Column& column : track.columns)
    require_storable(column, row.subspan(column.first, column.count));
  track.buffer.insert(track.buffer.end(), row.begin(), row.end());
  if (track.buffered_rows() == track.chunk_rows) impl_->flush_rows(track);
  if (Clock::now() - impl_->flushed_at < flush_every) return;
  for (const auto& [name, slow] : impl_->tracks) flush(name);
  impl_->flushed_at = Clock::now();
}

// The final changes are made in a copy that then takes the name, because HDF5 writes them in no safe order:
// whenever the process is killed, the name bears either the unfinished file (which `recover` reads) or the
// finished one. Where there is no room for a copy they are made in place.
void ResultFile::finish(const std::string& status, const std::string& verdict, const Ending& ending) {
  Impl& impl = *impl_;
  if (impl.state != Impl::State::writing)
    throw std::logic_error("finish of a result file that is finished or could not be written");
  const FixedAxes sizes = checked_axes(ending, impl.fixed);
  for (auto& [axis, track] : impl.tracks) impl.flush_rows(track);
  if (identity(impl.name) != impl.id)
    throw FileError(impl.check.file.string() + ": was replaced or removed by someone else during the run");
  impl.state = Impl::State::finished;
  impl.close_file();
  std::error_code error;
  const path temporary = temporary_name(impl.name);
  std::filesystem::copy_file(impl.name, temporary, std::filesystem::copy_options::overwrite_existing, error);
  const bool copied = !error;
  const auto remove_copy = [&] { std::filesystem::remove(temporary, error); };
  if (!copied) remove_copy();
  try {
    const path& target = copied ? temporary : impl.name;
    Handle file =
        impl.check(H5Fopen(target.c_str(), H5F_ACC_RDWR, hdf5::file_access(false)), H5Fclose, "reopen");
    write_ending(file, impl.check, status, verdict, ending, sizes);
    impl.check(file.close(), "close");
    if (copied) rename_or_fail(temporary, impl.name);
  } catch (...) {
    if (copied) remove_copy();
    throw;
  }
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  hdf5::prepare_library();
  H5get_libversion(&major, &minor, &release);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
}

}  // namespace osculate
