// Numbers as texts.
#pragma once

#include <charconv>
#include <string>

namespace osculate {

/// The shortest decimal that reads back to the same bits; nan, inf and -inf where it is no number.
inline std::string number_text(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

}  // namespace osculate
