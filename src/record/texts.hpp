// What a result file says of itself in words.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "record/result_file.hpp"

namespace osculate {

struct ResultTexts {
  std::string status;                                     // root attribute
  std::map<std::string, std::string> texts;               // by path: "provenance/experiment"
  std::map<std::string, std::vector<std::string>> lists;  // along an axis, and names of axes

  /// A text. Throws std::out_of_range.
  const std::string& at(const std::string& path) const { return texts.at(path); }
  bool has(const std::string& path) const { return texts.contains(path); }
};

/// Reads them, from a finished file or what a killed run left. Throws FileError, also where it is no result
/// file of osculate.
ResultTexts read_texts(const std::filesystem::path& file);

/// Reads every attribute and value of a result file and forgets them: what can be read once can be read
/// again. `alive` is called after each block of rows. Throws FileError.
void read_all(const std::filesystem::path& file, const std::function<void()>& alive);

}  // namespace osculate
