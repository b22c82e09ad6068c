#include "record/track.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace osculate::hdf5 {
namespace {

/// The rows of one column, contiguous, each value as `stored` makes it of a double.
template <class T, class Stored>
void gather(const Track& track, const Column& column, std::vector<T>& block, const Stored& stored) {
  block.resize(track.buffered_rows() * column.count);
  const double* values = track.buffer.data() + column.first;
  for (auto at = block.begin(); at != block.end(); values += track.row_size)
    for (std::size_t i = 0; i < column.count; ++i) *at++ = stored(values[i]);
}

/// Whether a block holds nothing but what HDF5 reads where no chunk is stored: missing values, or zeros.
template <class T>
bool is_fill(std::span<const T> block, const Column& column) {
  const T fill = column.may_be_missing ? static_cast<T>(std::bit_cast<std::uint64_t>(missing)) : T{0};
  return std::all_of(block.begin(), block.end(), [fill](T x) { return x == fill; });
}

/// How many values of a block of whole rows equal the one in the row before.
template <class T>
std::size_t repeated(std::span<const T> block, std::size_t row) {
  std::size_t count = 0;
  for (std::size_t i = row; i < block.size(); ++i) count += block[i] == block[i - row];
  return count;
}

}  // namespace

hsize_t rows_in_chunk(std::size_t widest_row_bytes) {
  hsize_t rows = 256;
  while (rows > 16 && rows * widest_row_bytes > 65536) rows /= 2;
  return rows;
}

void require_storable(const Column& column, std::span<const double> values) {
  if (!column.may_be_missing) {
    bool complete = true;
    for (const double value : values) complete &= !std::isnan(value);
    if (!complete)
      throw std::invalid_argument(column.path +
                                  ": NaN, but this variable is not declared as one that may be missing");
  }
  if (column.kind == Kind::real) return;
  const double limit = column.kind == Kind::small ? 0x1p7 : 0x1p63;
  for (const double value : values)
    if (!(value >= -limit && value < limit && value == std::trunc(value)))
      throw std::invalid_argument(column.path + ": " + std::to_string(value) +
                                  " does not fit its integer type");
}

void ColumnWriter::write(const Track& track, const Column& column, const Check& check) {
  std::vector<hsize_t> extent = column.extent;
  extent[0] = track.written_rows + track.buffered_rows();
  check(H5Dset_extent(column.dataset, extent.data()), "extend", column.path);
  if (column.kind == Kind::small) {
    gather(track, column, bytes_, [](double x) { return static_cast<std::int8_t>(x); });
    write(track, column, H5T_NATIVE_INT8, bytes_, check);
  } else if (column.kind == Kind::integer) {
    gather(track, column, words_,
           [](double x) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(x)); });
    write(track, column, H5T_NATIVE_INT64, words_, check);
  } else {
    gather(track, column, words_, [](double x) { return std::bit_cast<std::uint64_t>(x); });
    write(track, column, H5T_NATIVE_DOUBLE, words_, check);
  }
  check(H5Dflush(column.dataset), "write", column.path);
}

// Compressing a smooth record costs more than simulating it and saves a third: a chunk in which few values
// repeat those of the row before is stored as it is, past the filters. The last one is filled up with zeros.
// So is a chunk that is written part full: to fill it up then changes none of the bytes that are there, so
// that a run that is killed meanwhile leaves the rows before whole.
// A chunk that holds nothing but the fill value is not stored. That of an axis always is: it tells that those
// of its variables were written before.
template <class T>
void ColumnWriter::write(const Track& track, const Column& column, hid_t type, std::vector<T>& block,
                         const Check& check) {
  const std::span<const T> values = block;
  const bool is_axis = column.first == 0;
  if (!is_axis && is_fill(values, column)) return;
  std::vector<hsize_t> start(column.extent.size(), 0), count = column.extent;
  start[0] = track.written_rows;
  count[0] = track.buffered_rows();
  const bool repeats = sizeof(T) == 1 || 4 * repeated(values, column.count) >= 3 * values.size();
  if (std::endian::native == std::endian::little && (track.flushed_rows > 0 || !repeats)) {
    block.resize(track.chunk_rows * column.count);
    constexpr std::uint32_t no_filter = 0xffffffff;
    check(H5Dwrite_chunk(column.dataset, H5P_DEFAULT, no_filter, start.data(), block.size() * sizeof(T),
                         block.data()),
          "write", column.path);
    return;
  }
  const Handle target = check(H5Dget_space(column.dataset), H5Sclose, "write", column.path);
  check(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), "write",
        column.path);
  const Handle source(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
  check(H5Dwrite(column.dataset, type, source, target, H5P_DEFAULT, values.data()), "write", column.path);
}

}  // namespace osculate::hdf5
