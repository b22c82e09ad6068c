// Chunks as the recorder packs them, unpacked by the filters of HDF5 themselves.
#include "record/packed_chunk.hpp"

#include <hdf5.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "support/catch.hpp"

namespace {

/// What HDF5 reads of a chunk of rows x row values that was written as packed.
std::vector<double> read_back(std::span<const std::uint8_t> packed, hsize_t rows, hsize_t row) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 20, false);  // in memory
  const hid_t file = H5Fcreate("packed_chunk", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t size[2] = {rows, row}, start[2] = {0, 0};
  H5Pset_chunk(creation, 2, size);
  H5Pset_shuffle(creation);
  H5Pset_deflate(creation, 1);
  const hid_t space = H5Screate_simple(2, size, nullptr);
  const hid_t data = H5Dcreate2(file, "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  std::vector<double> out(rows * row);
  const bool written = H5Dwrite_chunk(data, H5P_DEFAULT, 0, start, packed.size(), packed.data()) >= 0;
  const bool read = H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) >= 0;
  for (const hid_t object : {data, space, creation}) H5Idec_ref(object);
  H5Fclose(file);
  H5Pclose(access);
  REQUIRE(written);
  REQUIRE(read);
  return out;
}

}  // namespace

TEST_CASE("HDF5 reads a packed chunk bit by bit", "[record]") {
  std::mt19937_64 random(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  osculate::ChunkPacker packer;
  const std::pair<std::size_t, std::size_t> shapes[] = {{1, 1},   {2, 1},   {16, 3},   {128, 36},
                                                        {256, 1}, {256, 7}, {100, 11}, {64, 300}};
  for (const auto& [rows, row] : shapes)
    for (int kind = 0; kind < 5; ++kind) {
      CAPTURE(rows, row, kind);
      std::vector<std::uint64_t> values(rows * row);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double t = 0.01 * static_cast<double>(i / row), phase = static_cast<double>(i % row);
        if (kind == 0) values[i] = random();                                           // noise
        if (kind == 1) values[i] = std::bit_cast<std::uint64_t>(nan);                  // missing throughout
        if (kind == 2) values[i] = std::bit_cast<std::uint64_t>(std::sin(t + phase));  // smooth
        if (kind == 3) values[i] = static_cast<std::uint64_t>(i);                      // a counter
        if (kind == 4) values[i] = random() % 3 == 0 ? random() : ~std::uint64_t{0};   // runs of all lengths
      }
      const auto packed = packer.pack(values, row);
      CHECK(packed.size() <= 8 * values.size() + 64);
      if (kind == 1 && rows >= 16) CHECK(packed.size() < 8 * values.size() / 4 + 64 * row);
      const std::vector<double> read = read_back(packed, rows, row);
      std::size_t different = 0;
      for (std::size_t i = 0; i < values.size(); ++i)
        different += std::bit_cast<std::uint64_t>(read[i]) != values[i];
      CHECK(different == 0);
    }
}
