// The rows of one growing axis on their way into a result file. Included by src/record/*.cpp only.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "record/hdf5_handles.hpp"

namespace osculate::hdf5 {

/// Rows in a chunk: the power of two in [16, 256] that keeps a chunk of the widest variable within 64 KiB.
hsize_t rows_in_chunk(std::size_t widest_row_bytes);

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

/// Throws std::invalid_argument.
void require_storable(const Column& column, std::span<const double> values);

/// Writes the buffered rows of columns.
class ColumnWriter {
 public:
  /// Reaches the disk before it returns. Throws FileError.
  void write(const Track& track, const Column& column, const Check& check);

 private:
  template <class T>
  void write(const Track& track, const Column& column, hid_t type, std::vector<T>& block, const Check& check);

  std::vector<std::uint64_t> words_;  // one column of a chunk on its way
  std::vector<std::int8_t> bytes_;
};

}  // namespace osculate::hdf5
