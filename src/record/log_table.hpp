// Logs in HDF5 that other programs wrote.
#pragma once

#include "input/named_columns.hpp"
#include "record/result_file.hpp"

namespace osculate {

/// Whether a file begins as HDF5 files do; false where it cannot be read.
bool is_hdf5(const std::filesystem::path& file);

/// All datasets of real or whole numbers with one or two dimensions, as columns: "group/name" for one
/// dimension, "group/name[0]", "group/name[1]", ... for two, the first dimension being time. `time`: names of
/// the dataset of instants, of which the file has one; datasets with another number of rows are left out.
/// Throws FileError.
NamedColumns read_log_table(const std::filesystem::path& file, const std::vector<std::string>& time);

}  // namespace osculate
