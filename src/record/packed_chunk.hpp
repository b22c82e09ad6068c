// A chunk of eight-byte values as HDF5's filters "shuffle" and "deflate" would store it, at a small part of
// their cost. Shuffled, the values' first bytes come first, then all second bytes, and so on: eight planes.
// In smooth records the planes of low digits are noise, which no compressor makes smaller: they are stored. A
// plane most of whose bytes equal those of the row above is written as matches at the distance of one row, in
// the fixed Huffman code. The result is an ordinary zlib stream (RFC 1950, 1951). Little-endian machines
// only.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace osculate {

namespace deflate {

/// The lowest `count` bits of `code`, highest first.
constexpr std::uint32_t reversed(std::uint32_t code, int count) {
  std::uint32_t out = 0;
  for (int i = 0; i < count; ++i) out |= (code >> i & 1) << (count - 1 - i);
  return out;
}

struct Word {
  std::uint32_t bits = 0;  // in the order in which they are written, lowest first
  int count = 0;
};
/// RFC 1951, 3.2.6: the fixed code, words of 7 to 9 bits.
constexpr Word fixed_word(std::uint32_t s) {
  if (s < 144) return {reversed(0x30 + s, 8), 8};
  if (s < 256) return {reversed(0x190 + s - 144, 9), 9};
  if (s < 280) return {reversed(s - 256, 7), 7};
  return {reversed(0xc0 + s - 280, 8), 8};
}
inline constexpr std::array<Word, 288> fixed_code = [] {
  std::array<Word, 288> all{};
  for (std::uint32_t s = 0; s < all.size(); ++s) all[s] = fixed_word(s);
  return all;
}();

}  // namespace deflate

/// Packs chunks; keeps its storage from call to call.
class ChunkPacker {
 public:
  /// `values`: whole rows of `row` values each. The result lasts until the next call.
  std::span<const std::uint8_t> pack(std::span<const std::uint64_t> values, std::size_t row) {
    const std::size_t n = values.size();
    // At most 9 bits for a byte, and a few bytes for each block.
    if (out_.size() < 9 * n + 256) out_.resize(9 * n + 256), planes_.resize(8 * n);
    next_ = out_.data();
    const std::array<std::size_t, 8> repeated = repeated_bytes(values, row);
    shuffle(values);
    *next_++ = 0x78, *next_++ = 0x01;
    bits_ = 0, held_ = 0;
    for (std::size_t p = 0; p < 8;) {
      const auto packs = [&](std::size_t plane) { return 2 * repeated[plane] > n && row <= 0x8000; };
      const std::size_t first = p;
      while (++p < 8 && packs(p) == packs(first)) {}
      const std::span<const std::uint8_t> bytes(planes_.data() + first * n, (p - first) * n);
      if (packs(first))
        write_matches(bytes, row, p == 8);
      else
        store(bytes, p == 8);
    }
    align();
    const std::uint32_t sum = adler32({planes_.data(), 8 * n});
    for (int shift = 24; shift >= 0; shift -= 8) *next_++ = static_cast<std::uint8_t>(sum >> shift);
    return {out_.data(), next_};
  }

 private:
  /// For each plane the number of bytes equal to those one row before.
  static std::array<std::size_t, 8> repeated_bytes(std::span<const std::uint64_t> values, std::size_t row) {
    constexpr std::uint64_t low = 0x7f7f7f7f7f7f7f7f, ones = 0x0101010101010101;
    std::array<std::size_t, 8> out{};
    for (std::size_t i = row; i < values.size();) {
      std::uint64_t equal = 0;  // eight counters of one byte
      for (const std::size_t end = std::min(values.size(), i + 255); i < end; ++i) {
        const std::uint64_t x = values[i] ^ values[i - row];
        equal += ~(((((x & low) + low) | x) >> 7)) & ones;
      }
      for (std::size_t p = 0; p < 8; ++p) out[p] += equal >> (8 * p) & 0xff;
    }
    return out;
  }

  /// Eight values at a time: the transpose of an 8 x 8 matrix of bytes, by halves, quarters and eighths.
  void shuffle(std::span<const std::uint64_t> values) {
    const std::size_t n = values.size();
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8) {
      std::array<std::uint64_t, 8> x;
      std::memcpy(x.data(), values.data() + i, sizeof x);
      const auto exchange = [&x](std::size_t a, std::size_t b, int shift, std::uint64_t mask) {
        const std::uint64_t change = ((x[a] >> shift) ^ x[b]) & mask;
        x[a] ^= change << shift;
        x[b] ^= change;
      };
      for (const std::size_t a : {0, 1, 2, 3}) exchange(a, a + 4, 32, 0x00000000ffffffff);
      for (const std::size_t a : {0, 1, 4, 5}) exchange(a, a + 2, 16, 0x0000ffff0000ffff);
      for (const std::size_t a : {0, 2, 4, 6}) exchange(a, a + 1, 8, 0x00ff00ff00ff00ff);
      for (std::size_t p = 0; p < 8; ++p) std::memcpy(planes_.data() + p * n + i, &x[p], 8);
    }
    for (; i < n; ++i)
      for (std::size_t p = 0; p < 8; ++p)
        planes_[p * n + i] = static_cast<std::uint8_t>(values[i] >> (8 * p));
  }

  /// The low `count` bits of `value`, lowest first. Keeps less than 32 bits back.
  void put(std::uint32_t value, int count) {
    held_ |= static_cast<std::uint64_t>(value) << bits_;
    bits_ += count;
    while (bits_ >= 8) {
      *next_++ = static_cast<std::uint8_t>(held_);
      held_ >>= 8;
      bits_ -= 8;
    }
  }
  void align() {
    if (bits_ > 0) put(0, 8 - bits_);
  }

  void store(std::span<const std::uint8_t> bytes, bool last) {
    while (!bytes.empty()) {
      const auto block = bytes.first(std::min<std::size_t>(bytes.size(), 0xffff));
      bytes = bytes.subspan(block.size());
      put(last && bytes.empty(), 1);
      put(0, 2);
      align();
      const auto size = static_cast<std::uint32_t>(block.size());
      put(size, 16);
      put(size ^ 0xffff, 16);
      next_ = std::copy(block.begin(), block.end(), next_);
    }
  }

  void write_matches(std::span<const std::uint8_t> bytes, std::size_t distance, bool last) {
    put(last, 1);
    put(1, 2);  // fixed code
    std::size_t i = 0;
    while (i < bytes.size()) {
      std::size_t length = 0;
      if (i >= distance) {
        const std::size_t longest = std::min<std::size_t>(258, bytes.size() - i);
        while (length < longest && bytes[i + length] == bytes[i + length - distance]) ++length;
      }
      if (length < 3) {
        put_symbol(bytes[i++]);
        continue;
      }
      put_length(static_cast<std::uint32_t>(length));
      put_distance(static_cast<std::uint32_t>(distance));
      i += length;
    }
    put_symbol(256);
  }
  void put_symbol(std::uint32_t s) {
    const deflate::Word& word = deflate::fixed_code[s];
    put(word.bits, word.count);
  }
  /// RFC 1951, 3.2.5: classes of lengths and distances with their extra bits.
  void put_length(std::uint32_t length) {
    const std::uint32_t l = length - 3;
    if (length == 258) return put_symbol(285);
    const int extra = l < 8 ? 0 : std::bit_width(l) - 3;
    put_symbol(257 + 4 * static_cast<std::uint32_t>(extra) + (l >> extra));
    put(l & ((1u << extra) - 1), extra);
  }
  void put_distance(std::uint32_t distance) {
    const std::uint32_t d = distance - 1;
    const int extra = d < 4 ? 0 : std::bit_width(d) - 2;
    put(deflate::reversed(2 * static_cast<std::uint32_t>(extra) + (d >> extra), 5), 5);
    put(d & ((1u << extra) - 1), extra);
  }
  /// RFC 1950, eight bytes at a time: a is the sum of all bytes and 1, b the sum of all values of a.
  static std::uint32_t adler32(std::span<const std::uint8_t> bytes) {
    constexpr std::uint64_t every_other = 0x00ff00ff00ff00ff, prime = 65521;
    std::uint64_t a = 1, b = 0;
    std::size_t i = 0;
    while (i + 8 <= bytes.size()) {
      for (const std::size_t end = std::min(bytes.size() - 7, i + 4096); i < end; i += 8) {
        std::uint64_t x;
        std::memcpy(&x, bytes.data() + i, 8);
        const std::uint64_t even = x & every_other, odd = x >> 8 & every_other;
        // highest sixteen bits: the sum of four bytes times their weights
        const std::uint64_t weighed =
            ((even * 0x0008000600040002) >> 48) + ((odd * 0x0007000500030001) >> 48);
        b += 8 * a + weighed;
        a += ((even + odd) * 0x0001000100010001) >> 48;
      }
      a %= prime, b %= prime;
    }
    for (; i < bytes.size(); ++i) a += bytes[i], b += a;
    return static_cast<std::uint32_t>(b % prime << 16 | a % prime);
  }

  std::vector<std::uint8_t> planes_, out_;
  std::uint8_t* next_ = nullptr;  // in out_
  std::uint64_t held_ = 0;
  int bits_ = 0;  // how many of held_ are not written yet
};

}  // namespace osculate
