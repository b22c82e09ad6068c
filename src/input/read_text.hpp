// Text files from outside.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace osculate {

/// What a file holds, or what is wrong with it: "FILE: fault; remedy.", empty where it could be read.
struct TextFile {
  std::string text;
  std::string fault;
};

/// Reads a regular file of at most `most` bytes (limits.hpp). Its size is looked at before anything is read;
/// directories, pipes and devices are refused unopened, as they may have no end. `remedy` completes every
/// message.
TextFile read_text(const std::filesystem::path& file, std::uintmax_t most, const std::string& remedy);

/// Index of the first byte that does not belong to UTF-8; npos where all do.
std::size_t first_fault_of_utf8(const std::string& text);

}  // namespace osculate
