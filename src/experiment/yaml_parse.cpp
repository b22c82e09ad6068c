// YAML text to plain values: everything that touches yaml-cpp.
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "experiment/config.hpp"
#include "experiment/yaml_reader.hpp"
#include "input/limits.hpp"
#include "input/read_text.hpp"

namespace osculate::yaml {
namespace {

/// Makes places. A file has lines and columns, a --set is its own place.
struct Origin {
  std::string source;
  bool lines = true;
  std::string at(const YAML::Mark& mark) const {
    if (!lines || mark.is_null()) return source;
    return source + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
  }
};

Value* find(Value& map, const std::string& key) {
  for (auto& item : map.items)
    if (item.key == key) return &item;
  return nullptr;
}

class Builder {
 public:
  explicit Builder(Origin where) : origin(std::move(where)) {}

  Value build(const YAML::Node& node, int depth = 0) {
    const auto place = origin.at(node.Mark());
    if (depth > limits::yaml_depth)
      throw ConfigError(place + ": nested too deeply, or an alias that contains itself.");
    if (++count > limits::yaml_values) throw ConfigError(place + ": too many values; are aliases nested?");
    Value out;
    out.place = place;
    if (node.IsScalar()) {
      out.kind = Value::Kind::scalar;
      out.text = node.Scalar();
      out.quoted = node.Tag() == "!";  // yaml-cpp's tag of a scalar in quotes
    } else if (node.IsSequence()) {
      out.kind = Value::Kind::list;
      for (const auto& item : node) out.items.push_back(build(item, depth + 1));
    } else if (node.IsMap()) {
      out.kind = Value::Kind::map;
      build_map(node, out, depth);
    }
    return out;
  }

 private:
  Origin origin;
  int count = 0;

  void build_map(const YAML::Node& node, Value& out, int depth) {
    std::vector<Value> merged;
    bool merging = false;
    for (const auto& pair : node) {
      const auto key_place = origin.at(pair.first.Mark());
      if (!pair.first.IsScalar()) throw ConfigError(key_place + ": a key must be one word.");
      const auto key = pair.first.Scalar();
      if (key == "<<") {
        if (merging) throw ConfigError(key_place + ": key '<<' is given twice; merge a list: <<: [*a, *b].");
        merging = true;
        merged = merge_sources(pair.second, key_place, depth);
        continue;
      }
      if (const auto* first = find(out, key))
        throw ConfigError(key_place + ": key '" + key + "' is given twice, first at " + first->key_place +
                          ": remove one.");
      auto value = build(pair.second, depth + 1);
      value.key = key;
      value.key_place = key_place;
      if (value.kind == Value::Kind::null) value.place = key_place;
      out.items.push_back(std::move(value));
    }
    for (auto& source : merged)
      for (auto& item : source.items)
        if (!find(out, item.key)) out.items.push_back(std::move(item));
  }

  std::vector<Value> merge_sources(const YAML::Node& node, const std::string& key_place, int depth) {
    auto value = build(node, depth + 1);
    std::vector<Value> out;
    if (value.kind == Value::Kind::list)
      out = std::move(value.items);
    else
      out.push_back(std::move(value));
    for (const auto& source : out)
      if (source.kind != Value::Kind::map)
        throw ConfigError(key_place + ": '<<' merges a map or a list of maps: <<: *name.");
    return out;
  }
};

/// yaml-cpp takes byte 4 for the end of the file and would drop the rest without a word.
void require_text(const std::string& text, const Origin& origin) {
  YAML::Mark mark;
  const auto fault = first_fault_of_utf8(text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (i == fault)
      throw ConfigError(origin.at(mark) + ": byte " + std::to_string(static_cast<unsigned char>(c)) +
                        " is not UTF-8; save the file as UTF-8.");
    const bool blank = c == '\t' || c == '\n' || c == '\r';
    if ((static_cast<unsigned char>(c) < 0x20 && !blank) || c == 0x7f)
      throw ConfigError(origin.at(mark) + ": control character (byte " + std::to_string(static_cast<int>(c)) +
                        "); the file must be plain UTF-8 text.");
    mark.column = c == '\n' ? 0 : mark.column + 1;
    mark.line += c == '\n';
  }
}

/// Where documents start, and nothing else.
struct DocumentStarts : YAML::EventHandler {
  std::vector<YAML::Mark> marks;
  void OnDocumentStart(const YAML::Mark& mark) override { marks.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}
};

/// The one document of a text; a null value where it is empty.
Value parse_document(const std::string& text, const Origin& origin) {
  require_text(text, origin);
  // yaml-cpp 0.7 reports a quote that is never closed only where the text does not end in a line break.
  const auto trimmed = text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
  try {
    // Not YAML::LoadAll: it never ends on a text that starts with a comma. Two documents are enough to
    // refuse.
    std::istringstream stream(trimmed);
    YAML::Parser parser(stream);
    DocumentStarts starts;
    while (starts.marks.size() < 2 && parser.HandleNextDocument(starts)) continue;
    if (starts.marks.size() == 2) {
      const auto place = origin.at(starts.marks[1]);
      if (starts.marks[1].pos == starts.marks[0].pos)
        throw ConfigError(place + ": not valid YAML: a value cannot start here.");
      throw ConfigError(place + ": a second document or value starts here; remove it.");
    }
    return Builder(origin).build(YAML::Load(trimmed));
  } catch (const YAML::Exception& error) {
    throw ConfigError(origin.at(error.mark) + ": not valid YAML: " + error.msg + ".");
  }
}

bool is_index(const std::string& word) {
  return !word.empty() && word.size() < 9 &&
         std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c); });
}

}  // namespace

Value parse(const std::string& text, const std::string& source) {
  auto document = parse_document(text, {source});
  if (document.kind == Value::Kind::null)
    throw ConfigError(source + ": is empty; an experiment needs model, initial and controller.");
  if (document.kind != Value::Kind::map)
    throw ConfigError(document.place +
                      ": must be a map of keys (model: ..., initial: ..., controller: ...).");
  return document;
}

void apply_override(Value& root, const std::string& key_and_value, const std::string& place) {
  const auto equals = key_and_value.find('=');
  const auto path = key_and_value.substr(0, equals);
  std::vector<std::string> words(1);
  for (const char c : path) {
    if (c == '.')
      words.emplace_back();
    else
      words.back() += c;
  }
  if (equals == std::string::npos || std::find(words.begin(), words.end(), "") != words.end())
    throw ConfigError(place + ": must have the form key.path=value, for instance --set initial.q.2=0.5.");

  auto* here = &root;
  std::string reached;
  for (const auto& word : words) {
    if (here->kind == Value::Kind::list) {
      const auto size = here->items.size();
      if (size == 0)
        throw ConfigError(place + ": " + reached + " is empty; set the whole list: --set " + reached +
                          "=[...].");
      if (!is_index(word) || std::stoul(word) >= size)
        throw ConfigError(place + ": " + reached + " is a list of " + std::to_string(size) + ": '" + word +
                          "' must be an index from 0 to " + std::to_string(size - 1) + ".");
      here = &here->items[std::stoul(word)];
    } else {
      if (here->kind == Value::Kind::scalar)
        throw ConfigError(place + ": " + reached + " = " + show(*here) + " has no parts; set " + reached +
                          " itself.");
      if (here->kind == Value::Kind::null) {
        if (is_index(word))
          throw ConfigError(place + ": " + reached + " is not given; set the whole list: --set " + reached +
                            "=[...].");
        here->kind = Value::Kind::map;
      }
      if (!find(*here, word)) {
        Value created;
        created.key = word;
        created.place = created.key_place = place;
        here->items.push_back(created);
      }
      here = find(*here, word);
    }
    reached += (reached.empty() ? "" : ".") + word;
  }

  auto value = parse_document(key_and_value.substr(equals + 1), {place, false});
  value.key = here->key;
  value.place = value.key_place = place;
  *here = std::move(value);
}

}  // namespace osculate::yaml
