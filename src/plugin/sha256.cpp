#include "plugin/sha256.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace osculate {

namespace {

using Word = std::uint32_t;

/// The first 32 bits of the fractional part of a root of a prime, found in whole numbers: the largest r with
/// r^power <= p 2^(32 power), modulo 2^32.
Word fraction_of_root(unsigned p, int power) {
  __extension__ using Wide = unsigned __int128;
  std::uint64_t root = 0;
  for (int bit = 36; bit >= 0; --bit) {
    const std::uint64_t trial = root | (std::uint64_t{1} << bit);
    Wide raised = 1;
    for (int i = 0; i < power; ++i) raised *= trial;
    if (raised <= Wide{p} << (32 * power)) root = trial;
  }
  return static_cast<Word>(root);
}

struct Constants {
  std::array<Word, 8> start;   // of square roots
  std::array<Word, 64> round;  // of cube roots
  Constants() {
    std::size_t found = 0;
    for (unsigned p = 2; found < 64; ++p) {
      bool prime = true;
      for (unsigned d = 2; d * d <= p; ++d) prime = prime && p % d != 0;
      if (!prime) continue;
      if (found < 8) start[found] = fraction_of_root(p, 2);
      round[found++] = fraction_of_root(p, 3);
    }
  }
};

void compress(const Constants& constants, const unsigned char* block, std::array<Word, 8>& state) {
  std::array<Word, 64> w;
  for (std::size_t i = 0; i < 16; ++i)
    w[i] = Word{block[4 * i]} << 24 | Word{block[4 * i + 1]} << 16 | Word{block[4 * i + 2]} << 8 |
           Word{block[4 * i + 3]};
  for (std::size_t i = 16; i < 64; ++i) {
    const Word a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3)) + w[i - 7] +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10));
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t i = 0; i < 64; ++i) {
    const Word t1 = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) +
                    constants.round[i] + w[i];
    const Word t2 = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
  }
  const std::array<Word, 8> added{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < 8; ++i) state[i] += added[i];
}

}  // namespace

std::string sha256(std::string_view data) {
  static const Constants constants;
  std::array<Word, 8> state = constants.start;
  std::string padded(data.substr(data.size() - data.size() % 64));
  padded += '\x80';
  while (padded.size() % 64 != 56) padded += '\0';
  const std::uint64_t bits = std::uint64_t{data.size()} * 8;
  for (int shift = 56; shift >= 0; shift -= 8) padded += static_cast<char>(bits >> shift & 255);
  const auto run = [&state](std::string_view text) {
    for (std::size_t i = 0; i + 64 <= text.size(); i += 64)
      compress(constants, reinterpret_cast<const unsigned char*>(text.data()) + i, state);
  };
  run(data);
  run(padded);
  std::string out;
  for (const Word word : state)
    for (int shift = 28; shift >= 0; shift -= 4) out += "0123456789abcdef"[word >> shift & 15];
  return out;
}

}  // namespace osculate
