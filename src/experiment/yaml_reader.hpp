// Typed reading of YAML with a place for every value. yaml-cpp is behind yaml_parse.cpp only.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "control/reference.hpp"

namespace osculate::yaml {

/// A YAML value as plain data: aliases are copied, merge keys (`<<`) are resolved, keys are unique.
struct Value {
  enum class Kind { null, scalar, list, map } kind = Kind::null;
  std::string text;          // of a scalar
  bool quoted = false;       // a quoted scalar is a string, never a number
  std::vector<Value> items;  // of a list or a map
  std::string key;           // when it stands in a map
  std::string place;         // "file:line:column" or "--set key.path=value"
  std::string key_place;     // the same, of the key
};

/// Reads one document whose root is a map. Throws ConfigError for bad syntax, a repeated key, an empty
/// document.
Value parse(const std::string& text, const std::string& source);

/// Applies one "key.path=value" of --set; list entries go by index from 0, missing maps are created.
/// `place` is what messages call it.
void apply_override(Value& root, const std::string& key_and_value, const std::string& place);

/// A text in double quotes, as YAML and JSON escape it.
std::string quoted(const std::string& text);
/// A value on one line, fit to stand in a list, in a map or behind "key.path=".
std::string flow(const Value& value);

/// One setting: its value where it is given, its key path, and the place a message should name.
struct Setting {
  const Value* value = nullptr;  // null: not given
  std::string path;
  std::string place;
  bool given() const { return value != nullptr; }
};

/// The value as a message shows it, long lists cut.
std::string show(const Value& value);
/// Throws ConfigError "place: path = value: text".
[[noreturn]] void fail(const Setting& setting, const std::string& text);
/// Throws ConfigError "place: path is missing: remedy".
[[noreturn]] void fail_missing(const Setting& setting, const std::string& remedy);
/// The same unless the setting is given: one that every map of its kind must have.
void require_given(const Setting& setting, const std::string& remedy);

/// A key as the documentation and an editor show it. It stands where the key is read, so that both know every
/// key.
struct Key {
  std::string name;
  std::string unit = {};
  std::string meaning = {};
  std::string otherwise = {};  // the default in words, where the number that is left as it is does not tell
};
using Keys = std::vector<Key>;

/// The settings of one map. Construction throws for a key that is not in `keys`. An absent or empty map has
/// no settings given.
class Map {
 public:
  Map(const Setting& setting, const Keys& keys);
  Setting at(const std::string& key) const;
  /// Keys that are there, without looking at what they may be.
  static std::vector<std::string> keys_of(const Setting& setting);

 private:
  Setting setting;
  std::vector<std::string> keys;
};

/// A map whose keys depend on its `type`: "type" itself, and those that `types` lists for it.
using TypeKeys = std::vector<std::pair<std::string, Keys>>;
struct TypedMap {
  std::string type;
  Map map;
};
/// Throws for a key that only other types have. `otherwise`: the type where none is given; empty: it must be
/// given.
TypedMap typed_map(const Setting&, const TypeKeys& types, const std::string& otherwise);

/// Interval of numbers that are allowed; an open end excludes the bound itself.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  bool low_open = false;
  double high = std::numeric_limits<double>::infinity();
  bool high_open = false;
  std::string note = {};      // remedy, appended to the message
  bool high_depends = false;  // `high` is another setting: the schema cannot know it
};
Range at_least_zero(std::string note = {});
Range above_zero(std::string note = {});

// Each `read` leaves `out` as it is where the setting is not given: the default stays in the struct that
// holds it.
void read(const Setting&, double& out, const Range& = {});
void read(const Setting&, long& out, long low);
void read(const Setting&, bool& out);
void read(const Setting&, std::string& out);  // not empty
void read(const Setting&, Vector3<double>& out);
void read(const Setting&, Vector6& out, const Range& = {});
/// `what` completes "must be ...".
void read(const Setting&, std::vector<double>& out, const Range& = {},
          const std::string& what = "a list of numbers, one for each joint from base to tip");
/// A number for all six rows, or a list of six.
void read_one_or_six(const Setting&, Vector6& out, const Range& = {});

/// The entries of a list as settings "path[i]". `what` completes "must be ...".
std::vector<Setting> entries(const Setting&, const std::string& what);
bool is_scalar(const Setting&);
/// An unquoted scalar that is a finite number.
bool is_number(const Value&);
bool is_map(const Setting&);

/// The word nearest to `word` by edits, empty when none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& words);
/// "a, b or c"
std::string either(const std::vector<std::string>& words);
/// Throws "must be a, b or c", with the nearest of them, unless the setting is one of `words`.
std::string read_word(const Setting&, const std::vector<std::string>& words);

/// For the schema: these words are allowed, besides what else is read from the setting.
void note_words(const Setting&, const std::vector<std::string>& words, const std::string& fallback = "");

template <class Choice>
void read(const Setting& setting, Choice& out, const std::vector<std::pair<std::string, Choice>>& choices) {
  std::vector<std::string> words;
  std::string fallback;
  for (const auto& [word, choice] : choices) {
    words.push_back(word);
    if (choice == out) fallback = word;
  }
  note_words(setting, words, fallback);
  if (!setting.given()) return;
  const auto chosen = read_word(setting, words);
  for (const auto& [word, choice] : choices)
    if (word == chosen) out = choice;
}

}  // namespace osculate::yaml
