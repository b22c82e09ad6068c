#include "input/read_text.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace osculate {

TextFile read_text(const std::filesystem::path& file, std::uintmax_t most, const std::string& remedy) {
  namespace fs = std::filesystem;
  const auto fault = [&](const std::string& what) {
    return TextFile{"", file.string() + ": " + what + "; " + remedy + "."};
  };
  const auto too_large = [&](const std::string& size) {
    return fault(size + "larger than " + std::to_string(most >> 20) + " MB, the most that is read");
  };
  std::error_code error;
  const auto status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) return fault("no such file");
  if (status.type() == fs::file_type::none) return fault("cannot be read: " + error.message());
  if (fs::is_directory(status)) return fault("is a directory");
  if (!fs::is_regular_file(status)) return fault("is a pipe or a device, not a regular file");
  if (const auto size = fs::file_size(file, error); !error && size > most)
    return too_large("has " + std::to_string(size) + " bytes, ");

  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in)
    return fault(std::string("cannot be read: ") + (errno != 0 ? std::strerror(errno) : "unknown reason"));
  TextFile out;
  std::array<char, 1 << 16> block;
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    out.text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (out.text.size() > most) return too_large("");  // a file that grows, or one that has no size
  }
  if (in.bad()) return fault("reading failed after " + std::to_string(out.text.size()) + " bytes");
  return out;
}

std::size_t first_fault_of_utf8(const std::string& text) {
  const auto byte = [&text](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(i);
    const std::size_t length = first < 0x80   ? 1
                               : first < 0xc2 ? 0
                               : first < 0xe0 ? 2
                               : first < 0xf0 ? 3
                               : first < 0xf5 ? 4
                                              : 0;
    if (length == 0) return i;
    unsigned code = first & (0xffu >> (length + 1));
    for (std::size_t k = 1; k < length; ++k) {
      if ((byte(i + k) & 0xc0) != 0x80) return i;
      code = code << 6 | (byte(i + k) & 0x3f);
    }
    const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    if (overlong || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return i;
    i += length;
  }
  return std::string::npos;
}

}  // namespace osculate
