#include "experiment/yaml_reader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include "experiment/config.hpp"
#include "experiment/yaml_notes.hpp"

namespace osculate::yaml {
namespace {

std::string describe(const Range& range) {
  std::string out;
  if (std::isfinite(range.low)) out += (range.low_open ? "> " : ">= ") + number_text(range.low);
  if (std::isfinite(range.high))
    out +=
        (out.empty() ? "" : " and ") + std::string(range.high_open ? "< " : "<= ") + number_text(range.high);
  return out;
}

std::string with_note(std::string text, const std::string& note) {
  return "must be " + text + (note.empty() ? "." : ": " + note + ".");
}

double number(const Setting& setting) {
  const auto& value = *setting.value;
  if (value.kind != Value::Kind::scalar) fail(setting, "must be one number.");
  if (value.quoted) fail(setting, "must be a number: remove the quotes.");
  const auto& text = value.text;
  std::string plain = text.starts_with('+') ? text.substr(1) : text;
  std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const auto* word : {".nan", "nan", "-nan", ".inf", "-.inf", "inf", "-inf", "infinity", "-infinity"})
    if (plain == word) fail(setting, "must be a finite number.");
  double out = 0;
  const auto [end, code] = std::from_chars(plain.data(), plain.data() + plain.size(), out);
  if (code == std::errc::result_out_of_range) fail(setting, "does not fit in a double.");
  if (code != std::errc() || end != plain.data() + plain.size() || text.starts_with("+-"))
    fail(setting, "must be a number; write its value, expressions and units are not read.");
  return out;
}

void require(const Setting& setting, double x, const Range& range) {
  const bool low_ok = range.low_open ? x > range.low : x >= range.low;
  const bool high_ok = range.high_open ? x < range.high : x <= range.high;
  if (!(low_ok && high_ok)) fail(setting, with_note(describe(range), range.note));
}

std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    auto diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const auto changed = diagonal + (std::tolower(a[i - 1]) != std::tolower(b[j - 1]));
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row.back();
}

}  // namespace

// ---- settings

std::string show(const Value& value) {
  if (value.kind == Value::Kind::null) return "(nothing)";
  if (value.kind == Value::Kind::scalar) return value.quoted ? "\"" + value.text + "\"" : value.text;
  std::string out;
  for (const auto& item : value.items) {
    if (!out.empty()) out += ", ";
    if (out.size() > 60) {
      out += "...";
      break;
    }
    out += (value.kind == Value::Kind::map ? item.key + ": " : "") + show(item);
  }
  return value.kind == Value::Kind::map ? "{" + out + "}" : "[" + out + "]";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      const char* digits = "0123456789abcdef";
      out += std::string("\\x") + digits[(c >> 4) & 15] + digits[c & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

namespace {

/// The text as a scalar without quotes, where nothing in it means anything to YAML; else with quotes.
std::string scalar(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) ||
                        std::string_view("_.+-/").find(static_cast<char>(c)) != std::string_view::npos);
  };
  auto first = text.begin();
  if (first != text.end() && (*first == '+' || *first == '-')) ++first;
  if (first != text.end() && *first == '.') ++first;
  const bool starts_well = first != text.end() && std::isalnum(static_cast<unsigned char>(*first));
  return starts_well && std::all_of(text.begin(), text.end(), plain) ? text : quoted(text);
}

}  // namespace

std::string flow(const Value& value) {
  if (value.kind == Value::Kind::null) return "~";
  if (value.kind == Value::Kind::scalar) return value.quoted ? quoted(value.text) : scalar(value.text);
  std::string out;
  for (const auto& item : value.items)
    out += (out.empty() ? "" : ", ") + (value.kind == Value::Kind::map ? scalar(item.key) + ": " : "") +
           flow(item);
  return value.kind == Value::Kind::map ? "{" + out + "}" : "[" + out + "]";
}

void fail(const Setting& setting, const std::string& text) {
  throw ConfigError(setting.place + ": " + setting.path + " = " + show(*setting.value) + ": " + text);
}

void fail_missing(const Setting& setting, const std::string& remedy) {
  throw ConfigError(setting.place + ": " + setting.path + " is missing: " + remedy);
}

void require_given(const Setting& setting, const std::string& remedy) {
  note_required(setting);
  if (!setting.given()) fail_missing(setting, remedy);
}

Map::Map(const Setting& whole, const Keys& known) : setting(whole) {
  for (const Key& key : known) keys.push_back(key.name);
  note_keys(setting, known);
  if (!setting.given() || setting.value->kind == Value::Kind::null) return;
  if (!is_map(setting)) fail(setting, "must be a map with the keys " + either(keys) + ".");
  for (const auto& item : setting.value->items) {
    if (std::find(keys.begin(), keys.end(), item.key) != keys.end()) continue;
    const auto near = nearest(item.key, keys);
    const auto path = (setting.path.empty() ? "" : setting.path + ".") + item.key;
    throw ConfigError(
        item.key_place + ": unknown key '" + path +
        "': " + (near.empty() ? "the keys here are " + either(keys) + "." : "did you mean '" + near + "'?"));
  }
}

Setting Map::at(const std::string& key) const {
  Setting out{nullptr, (setting.path.empty() ? "" : setting.path + ".") + key, setting.place};
  if (!setting.given()) return out;
  for (const auto& item : setting.value->items)
    if (item.key == key) {
      out.value = &item;
      out.place = item.place;
    }
  return out;
}

std::vector<std::string> Map::keys_of(const Setting& setting) {
  std::vector<std::string> out;
  if (is_map(setting))
    for (const auto& item : setting.value->items) out.push_back(item.key);
  return out;
}

TypedMap typed_map(const Setting& setting, const TypeKeys& types, const std::string& otherwise) {
  std::vector<std::string> names;
  for (const auto& [name, own] : types) names.push_back(name);
  std::string type = otherwise;
  if (is_map(setting))
    for (const auto& item : setting.value->items)
      if (item.key == "type") type = read_word({&item, setting.path + ".type", item.place}, names);
  if (setting.given() && setting.value->kind != Value::Kind::null && !is_map(setting))
    fail(setting, "must be a map with the key type and those of its type.");
  if (type.empty())
    fail_missing({nullptr, setting.path + ".type", setting.place}, "give " + either(names) + ".");

  note_types(setting, types, type, otherwise);
  note_words({nullptr, setting.path + ".type", ""}, names, otherwise);
  Keys keys{{"type", "", "only the keys of that type are allowed"}};
  for (const auto& [name, own] : types)
    if (name == type) keys.insert(keys.end(), own.begin(), own.end());
  for (const auto& given : Map::keys_of(setting)) {
    const auto has = [&given](const Keys& own) {
      return std::any_of(own.begin(), own.end(), [&](const Key& key) { return key.name == given; });
    };
    if (has(keys)) continue;
    std::vector<std::string> owners;
    for (const auto& [name, own] : types)
      if (has(own)) owners.push_back(name);
    if (owners.empty()) continue;
    for (const auto& item : setting.value->items)
      if (item.key == given)
        throw ConfigError(item.key_place + ": unknown key '" + setting.path + "." + given +
                          "': it belongs to type " + either(owners) + ", the type here is " + type +
                          "; remove it, or replace the whole " + setting.path + " (--set \"" + setting.path +
                          "={type: " + type + "}\").");
  }
  return {type, Map(setting, keys)};
}

namespace {

/// The entries of a list, without a note.
std::vector<Setting> items(const Setting& setting, const std::string& what);

/// `size` numbers; 0: any.
void note_list(const Setting& setting, std::size_t size, const Range& range,
               const std::string& fallback = "") {
  note(setting, {.kind = Form::Kind::list, .size = size}, fallback);
  note({nullptr, setting.path + "[]", ""}, {.kind = Form::Kind::number, .range = range});
}

}  // namespace

Range at_least_zero(std::string note) { return {.low = 0, .note = std::move(note)}; }
Range above_zero(std::string note) { return {.low = 0, .low_open = true, .note = std::move(note)}; }

void read(const Setting& setting, double& out, const Range& range) {
  note(setting, {.kind = Form::Kind::number, .range = range}, number_text(out));
  if (!setting.given()) return;
  const double x = number(setting);
  require(setting, x, range);
  out = x;
}

void read(const Setting& setting, long& out, long low) {
  note(setting, {.kind = Form::Kind::whole, .range = {.low = static_cast<double>(low)}}, std::to_string(out));
  if (!setting.given()) return;
  const double x = number(setting);
  constexpr double exact = 9007199254740992.0;  // 2^53: above it a double skips integers
  if (x != std::floor(x) || x < static_cast<double>(low) || x > exact)
    fail(setting, "must be a whole number >= " + std::to_string(low) + ".");
  out = static_cast<long>(x);
}

void read(const Setting& setting, bool& out) { read<bool>(setting, out, {{"true", true}, {"false", false}}); }

void read(const Setting& setting, std::string& out) {
  note(setting, {.kind = Form::Kind::text});
  if (!setting.given()) return;
  if (!is_scalar(setting) || setting.value->text.empty()) fail(setting, "must be a text that is not empty.");
  out = setting.value->text;
}

void read(const Setting& setting, Vector3<double>& out) {
  note_list(setting, 3, {}, shown_list(out));
  if (!setting.given()) return;
  const auto list = items(setting, "a list of three numbers [x, y, z]");
  if (list.size() != 3) fail(setting, "must be a list of three numbers [x, y, z].");
  for (int i = 0; i < 3; ++i) read(list[i], out[i]);
}

void read(const Setting& setting, Vector6& out, const Range& range) {
  note_list(setting, 6, range, out.isZero(0) ? "zeros" : shown_list(out));
  if (!setting.given()) return;
  const std::string what = "a list of six numbers, one for each of wx, wy, wz, vx, vy, vz";
  const auto list = items(setting, what);
  if (list.size() != 6) fail(setting, "must be " + what + ".");
  for (int i = 0; i < 6; ++i) read(list[i], out[i], range);
}

void read_one_or_six(const Setting& setting, Vector6& out, const Range& range) {
  note(setting, {.kind = Form::Kind::number, .range = range}, number_text(out[0]));
  note_list(setting, 6, range);
  if (!setting.given()) return;
  if (is_scalar(setting)) {
    double x = 0;
    read(setting, x, range);
    out.setConstant(x);
    return;
  }
  const std::string what = "one number, or a list of six for wx, wy, wz, vx, vy, vz";
  const auto list = items(setting, what);
  if (list.size() != 6) fail(setting, "must be " + what + ".");
  for (int i = 0; i < 6; ++i) read(list[i], out[i], range);
}

void read(const Setting& setting, std::vector<double>& out, const Range& range, const std::string& what) {
  note_list(setting, 0, range, shown_list(out));
  if (!setting.given()) return;
  out.clear();
  for (const auto& entry : entries(setting, what)) read(entry, out.emplace_back(), range);
}

std::vector<Setting> entries(const Setting& setting, const std::string& what) {
  note(setting, {.kind = Form::Kind::list});
  return items(setting, what);
}

namespace {
std::vector<Setting> items(const Setting& setting, const std::string& what) {
  if (setting.value->kind != Value::Kind::list) fail(setting, "must be " + what + ".");
  std::vector<Setting> out;
  for (const auto& item : setting.value->items)
    out.push_back({&item, setting.path + "[" + std::to_string(out.size()) + "]", item.place});
  return out;
}
}  // namespace

bool is_scalar(const Setting& setting) {
  return setting.given() && setting.value->kind == Value::Kind::scalar;
}
bool is_number(const Value& value) {
  if (value.kind != Value::Kind::scalar) return false;
  try {
    number({&value, "", ""});
  } catch (const ConfigError&) { return false; }
  return true;
}
bool is_map(const Setting& setting) { return setting.given() && setting.value->kind == Value::Kind::map; }

// ---- words

std::string nearest(const std::string& word, const std::vector<std::string>& words) {
  std::string best;
  std::size_t fewest = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const auto& candidate : words) {
    const bool abbreviated = word.size() >= 3 && candidate.starts_with(word);
    const auto distance = abbreviated ? 1 : edits(word, candidate);
    if (distance < fewest && distance < std::min(word.size(), candidate.size())) {
      fewest = distance;
      best = candidate;
    }
  }
  return best;
}

std::string either(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return out;
}

std::string read_word(const Setting& setting, const std::vector<std::string>& words) {
  note_words(setting, words);
  if (is_scalar(setting) && std::find(words.begin(), words.end(), setting.value->text) != words.end())
    return setting.value->text;
  const auto near = is_scalar(setting) ? nearest(setting.value->text, words) : "";
  fail(setting, "must be " + either(words) + (near.empty() ? "." : "; did you mean '" + near + "'?"));
}

}  // namespace osculate::yaml
