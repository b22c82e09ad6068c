// Numbers in named columns.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace osculate {

/// Columns of equal length.
struct NamedColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// A table, or what is wrong with its file: "FILE:LINE: fault; remedy".
struct ColumnsFile {
  NamedColumns table;
  std::string fault;
};

/// What spreadsheets put before a header.
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
/// Without blanks, tabs and returns around it.
std::string_view trimmed(std::string_view text);
/// The fields between the commas of a line, trimmed.
std::vector<std::string_view> fields_of(std::string_view line);

/// Reads comma-separated values under a header of names. Empty lines and lines that begin with # are left
/// out. Every field must be a number; nan and inf are read as such.
ColumnsFile read_csv(const std::filesystem::path& file);

}  // namespace osculate
