#include "plugin/json.hpp"

#include <charconv>
#include <limits>

#include "input/number_text.hpp"

namespace osculate {

namespace {

constexpr int deepest = 30;

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  JsonValue whole() {
    JsonValue out = value(0);
    skip();
    if (at_ != text_.size()) fail("nothing more");
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& wanted) const {
    throw JsonError("expected " + wanted + " at byte " + std::to_string(at_ + 1));
  }
  void skip() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r' || text_[at_] == '\n'))
      ++at_;
  }
  bool take(std::string_view word) {
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  bool take_after_spaces(char c) {
    skip();
    return take({&c, 1});
  }

  JsonValue value(int depth) {
    if (depth > deepest) fail("fewer brackets");
    skip();
    JsonValue out;
    if (take("null")) return out;
    if (take("true") || take("false")) {
      out.kind = JsonValue::Kind::truth;
      out.number = text_[at_ - 2] == 'u';
      return out;
    }
    if (at_ < text_.size() && text_[at_] == '"') {
      out.kind = JsonValue::Kind::text;
      out.text = text();
    } else if (take("[")) {
      out.kind = JsonValue::Kind::list;
      if (take_after_spaces(']')) return out;
      do out.items.push_back(value(depth + 1));
      while (take_after_spaces(','));
      if (!take_after_spaces(']')) fail("',' or ']'");
    } else if (take("{")) {
      out.kind = JsonValue::Kind::object;
      if (take_after_spaces('}')) return out;
      do {
        skip();
        out.keys.push_back(text());
        if (!take_after_spaces(':')) fail("':'");
        out.items.push_back(value(depth + 1));
      } while (take_after_spaces(','));
      if (!take_after_spaces('}')) fail("',' or '}'");
    } else {
      out.kind = JsonValue::Kind::number;
      out.number = number();
    }
    return out;
  }

  double number() {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (take("NaN")) return std::numeric_limits<double>::quiet_NaN();
    if (take("Infinity")) return infinite;
    if (take("-Infinity")) return -infinite;
    double out = 0;
    const char* const begin = text_.data() + at_;
    const auto [end, code] = std::from_chars(begin, text_.data() + text_.size(), out);
    if (code == std::errc::result_out_of_range)
      out = infinite;
    else if (code != std::errc())
      fail("a JSON value");
    at_ += static_cast<std::size_t>(end - begin);
    return out;
  }

  std::string text() {
    if (!take("\"")) fail("a text in double quotes");
    std::string out;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (text_[at_] != '\\') {
        out += text_[at_++];
        continue;
      }
      if (++at_ == text_.size()) break;
      const char c = text_[at_++];
      const std::string_view names = "\"\\/bfnrt", meanings = "\"\\/\b\f\n\r\t";
      if (c == 'u')
        add_utf8(out, code_point());
      else if (const auto i = names.find(c); i != std::string_view::npos)
        out += meanings[i];
      else
        fail("an escape sequence");
    }
    if (!take("\"")) fail("the closing '\"'");
    return out;
  }

  unsigned four_digits() {
    unsigned out = 0;
    const std::string_view digits = text_.substr(at_, 4);
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), out, 16);
    if (digits.size() != 4 || code != std::errc() || end != digits.data() + 4)
      fail("four hexadecimal digits");
    at_ += 4;
    return out;
  }
  unsigned code_point() {
    const unsigned first = four_digits();
    const bool pair = first >= 0xd800 && first < 0xdc00 && take("\\u");
    return pair ? 0x10000 + ((first - 0xd800) << 10) + ((four_digits() - 0xdc00) & 0x3ff) : first;
  }
  static void add_utf8(std::string& out, unsigned c) {
    const auto tail = [&](int shift) { out += static_cast<char>(0x80 | ((c >> shift) & 0x3f)); };
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if (c < 0x800) {
      out += static_cast<char>(0xc0 | (c >> 6)), tail(0);
    } else if (c < 0x10000) {
      out += static_cast<char>(0xe0 | (c >> 12)), tail(6), tail(0);
    } else {
      out += static_cast<char>(0xf0 | (c >> 18)), tail(12), tail(6), tail(0);
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

JsonValue parse_json(std::string_view text) { return Reader(text).whole(); }

void add_json(std::string& out, double x) { out += number_text(x); }

void add_json(std::string& out, std::span<const double> numbers) {
  out += '[';
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) out += ", ";
    add_json(out, numbers[i]);
  }
  out += ']';
}

void add_json(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (code < 0x20) {
      const char* digits = "0123456789abcdef";
      out += std::string("\\u00") + digits[code >> 4] + digits[code & 15];
    } else {
      out += c;
    }
  }
  out += '"';
}

}  // namespace osculate
