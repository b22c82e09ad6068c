// SHA-256 (FIPS 180-4), to tell whether a file is the one that a run used.
#pragma once

#include <string>
#include <string_view>

namespace osculate {

/// 64 hexadecimal digits.
std::string sha256(std::string_view data);

}  // namespace osculate
