// As much of JSON as the line protocol of controllers needs.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace osculate {

struct JsonValue {
  enum class Kind { null, truth, number, text, list, object } kind = Kind::null;
  double number = 0;              // of a truth: 1 or 0
  std::string text;               // UTF-8
  std::vector<JsonValue> items;   // of a list or an object
  std::vector<std::string> keys;  // of an object, one for each item
};

/// The text is no JSON. The message says what was expected.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One value and nothing after it but spaces. NaN, Infinity and -Infinity count as numbers: programs do write
/// them. Throws JsonError.
JsonValue parse_json(std::string_view text);

/// With the fewest digits that read back to the same bits.
void add_json(std::string& out, double x);
void add_json(std::string& out, std::span<const double> numbers);
void add_json(std::string& out, std::string_view text);

}  // namespace osculate
