// A name for a text that changes with every byte of it.
#pragma once

#include <string>

namespace osculate {

/// SHA-256 (FIPS 180-4) of the bytes of `text`, 64 hexadecimal digits: what `sha256sum` prints of the file.
std::string sha256(const std::string& text);

}  // namespace osculate
