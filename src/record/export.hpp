// A result file as tables of text, for programs that read no HDF5.
#pragma once

#include <filesystem>
#include <vector>

namespace osculate {

/// Writes into `directory`, which it makes:
///   AXIS.csv      for each first axis (time, step, claim, ...), one line for each element of it: the axis,
///   then every
///                 dataset along it, one column for each value, named dataset[labels of the other axes];
///                 numbers with 17 significant digits, missing ones NaN; '/' in the name of an axis becomes
///                 '.'
///   values.csv    datasets of one number or text
///   columns.csv   what each column is: file, column, dataset, unit, long_name
///   NAME.txt      texts of more than one line (provenance.experiment.txt, ...)
/// Returns the files. Throws FileError, before anything is written if the directory has files and `force` is
/// false.
std::vector<std::filesystem::path> export_csv(const std::filesystem::path& file,
                                              const std::filesystem::path& directory, bool force);

}  // namespace osculate
