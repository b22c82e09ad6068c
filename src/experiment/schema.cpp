#include "experiment/schema.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiment/config.hpp"
#include "experiment/yaml_notes.hpp"
#include "input/number_text.hpp"

namespace osculate {
namespace {

using yaml::Form;
using yaml::Note;
using yaml::Notes;

// ---- specimens: between them they have every section, type and form that a reader looks at only where it is
// given

constexpr const char* everything = R"(
model: {urdf: arm.urdf, tip: tool, friction: {viscous: [0], v_s: [1]}}
plant:
  payload: {inertia: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}
  armature: [0]
  friction: {viscous: [0], v_s: 1}
  mass_scale: 1
initial: {q: [0]}
controller:
  law: operational_space
  rows: [vx]
  compensate_tip_force: true
  null_space: {posture: {stiffness: 1, q: [0]}, limits: {gain: 1}}
  impedance: {inertia: 1}
  force: {rows: [vx], desired: [0]}
  obstacles: [{centre: [0, 0, 1]}]
  sampling: {period: 1}
  sensors: {}
  effort_limit: [1]
integrator: {atol: {position: 1, velocity: 1}}
verify: {every: 2, record: 2}
expect: {stop: singular, fails: [omega]}
sweep: {key: duration, values: [1]}
)";
constexpr const char* other_forms = R"(
model: {urdf: arm.urdf, tip: tool, friction: {viscous: [0], v_s: 1}}
plant: {payload: {inertia: [1, 1, 1, 0, 0, 0]}, friction: {viscous: [0], v_s: [1]}, mass_scale: [1]}
initial: {q: [0]}
controller: {law: {process: [program]}}
integrator: {atol: 1}
sweep: {variants: {one: {}}}
)";
struct TypeSpecimen {
  const char *section, *type, *more;
};
constexpr TypeSpecimen types[] = {
    {"reference", "hold", ""},         {"reference", "step", ""},
    {"reference", "line", ""},         {"reference", "circle", ""},
    {"reference", "lissajous", ""},    {"reference", "waypoints", ", file: a.csv"},
    {"reference", "multisine", ""},    {"reference", "each_axis", ", amplitude: [1, 0, 0, 0, 0, 0]"},
    {"base_motion", "hold", ""},       {"base_motion", "line", ""},
    {"base_motion", "circle", ""},     {"base_motion", "lissajous", ""},
    {"plant.environment", "ball", ""}, {"plant.environment", "plane", ""},
};

/// Reads all specimens. Throws std::logic_error for a key or type that none of them shows to its reader.
void take(Notes& notes) {
  const auto read = [](const std::string& text, const std::vector<std::string>& changes = {}) {
    parse_experiment(text, "specimen", "/", changes);
  };
  read(everything);
  read(other_forms);
  for (const auto& [section, type, more] : types)
    read(other_forms, {std::string(section) + "={type: " + type + more + "}"});
  for (const auto& [place, note] : notes.by_place) {
    for (const auto& type : note.types)
      if (!notes.by_place.contains(place + "<" + type + ">"))
        throw std::logic_error("schema: no specimen has " + place + ".type = " + type);
    if (note.forms.empty() && !note.key.name.empty())
      throw std::logic_error("schema: no specimen has " + place);
  }
}

std::string below(const std::string& place, const std::string& key) {
  return place.empty() ? key : place + "." + key;
}
const Note& note_at(const Notes& notes, const std::string& place) { return notes.by_place.at(place); }
bool is_truth(const Form& form) { return form.words == std::vector<std::string>{"true", "false"}; }

// ---- JSON

/// Members of a JSON object; values are JSON already.
using Members = std::vector<std::pair<std::string, std::string>>;

std::string indented(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? std::string("\n  ") : std::string(1, c);
  return out;
}
std::string object(const Members& members) {
  std::string out;
  for (const auto& [key, value] : members)
    out += (out.empty() ? "\n  " : ",\n  ") + yaml::quoted(key) + ": " + indented(value);
  return out.empty() ? "{}" : "{" + out + "\n}";
}
std::string array(const std::vector<std::string>& items) {
  std::string out;
  for (const auto& item : items) out += (out.empty() ? "" : ", ") + item;
  return "[" + out + "]";
}
std::string array_of_texts(std::vector<std::string> texts) {
  for (auto& text : texts) text = yaml::quoted(text);
  return array(texts);
}

class Schema {
 public:
  explicit Schema(const Notes& taken) : notes(taken) {}

  Members value(const std::string& place) const {
    const Note& note = note_at(notes, place);
    Members out;
    const auto& key = note.key;
    const std::string unit = key.unit.empty() ? "" : " [" + key.unit + "]";
    if (!key.meaning.empty()) out.emplace_back("description", yaml::quoted(key.meaning + unit));
    std::vector<std::string> forms;
    for (const Form& form : note.forms) forms.push_back(object(of(form, note, place)));
    if (forms.size() > 1) out.emplace_back("anyOf", array(forms));
    if (forms.size() == 1)
      for (const auto& member : of(note.forms.front(), note, place)) out.push_back(member);
    if (const auto fallback = json_default(note); !fallback.empty()) out.emplace_back("default", fallback);
    return out;
  }

 private:
  const Notes& notes;

  /// The default where it is one number, truth or word.
  static std::string json_default(const Note& note) {
    if (note.required || note.fallback.empty() || !note.key.otherwise.empty()) return "";
    const Form& form = note.forms.front();
    if (form.kind == Form::Kind::word) return is_truth(form) ? note.fallback : yaml::quoted(note.fallback);
    return form.kind == Form::Kind::number || form.kind == Form::Kind::whole ? note.fallback : "";
  }

  Members of(const Form& form, const Note& note, const std::string& place) const {
    switch (form.kind) {
      case Form::Kind::number: {
        Members out{{"type", yaml::quoted("number")}};
        const auto& range = form.range;
        if (std::isfinite(range.low))
          out.emplace_back(range.low_open ? "exclusiveMinimum" : "minimum", number_text(range.low));
        if (std::isfinite(range.high) && !range.high_depends)
          out.emplace_back(range.high_open ? "exclusiveMaximum" : "maximum", number_text(range.high));
        return out;
      }
      case Form::Kind::whole:
        return {{"type", yaml::quoted("integer")}, {"minimum", number_text(form.range.low)}};
      case Form::Kind::word:
        if (is_truth(form)) return {{"type", yaml::quoted("boolean")}};
        return {{"enum", array_of_texts(form.words)}};
      case Form::Kind::text:  // any scalar is a text
        return {{"type", array_of_texts({"string", "number", "boolean"})}, {"minLength", "1"}};
      case Form::Kind::list: {
        Members out{{"type", yaml::quoted("array")}};
        if (form.size > 0) {
          out.emplace_back("minItems", std::to_string(form.size));
          out.emplace_back("maxItems", std::to_string(form.size));
        }
        if (notes.by_place.contains(place + "[]")) out.emplace_back("items", object(value(place + "[]")));
        return out;
      }
      case Form::Kind::map:
        break;
    }
    if (note.open)
      return {{"type", yaml::quoted("object")},
              {"additionalProperties", object({{"type", array_of_texts({"object", "null"})}})}};
    if (note.types.empty()) return map(note, place);
    std::vector<std::string> branches;
    for (const auto& type : note.types)
      branches.push_back(object(of_type(place, type, type == note.type_otherwise)));
    const std::vector<std::string> kinds{"object", "null"};
    return {{"type", note.type_otherwise.empty() ? yaml::quoted("object") : array_of_texts(kinds)},
            {"anyOf", array(branches)}};
  }

  Members map(const Note& note, const std::string& place) const {
    Members properties;
    std::vector<std::string> required;
    for (const auto& key : note.keys) {
      const std::string own = below(place, key);
      properties.emplace_back(key, object(value(own)));
      if (note_at(notes, own).required) required.push_back(key);
    }
    Members out{{"type", required.empty() ? array_of_texts({"object", "null"}) : yaml::quoted("object")},
                {"properties", object(properties)},
                {"additionalProperties", "false"}};
    if (!required.empty()) out.emplace_back("required", array_of_texts(required));
    return out;
  }

  Members of_type(const std::string& place, const std::string& type, bool otherwise) const {
    const std::string typed = place + "<" + type + ">";
    Members properties{{"type", object({{"const", yaml::quoted(type)}})}};
    std::vector<std::string> required;
    if (!otherwise) required.emplace_back("type");
    for (const auto& key : note_at(notes, typed).keys) {
      if (key == "type") continue;
      properties.emplace_back(key, object(value(below(typed, key))));
      if (note_at(notes, below(typed, key)).required) required.push_back(key);
    }
    return {{"properties", object(properties)},
            {"required", array_of_texts(required)},
            {"additionalProperties", "false"}};
  }
};

// ---- tables

class Tables {
 public:
  explicit Tables(const Notes& taken) : notes(taken) {}

  std::string all() const {
    std::string out = table("top", [&] {
      std::string rows;
      for (const auto& key : note_at(notes, "").keys)
        if (note_at(notes, key).keys.empty() && note_at(notes, key).types.empty())
          rows += row(key, key, "", true);
      return rows + row("base_motion", "base_motion", "", true);
    });
    for (const auto& key : note_at(notes, "").keys)
      if (key != "base_motion" && !(note_at(notes, key).keys.empty() && note_at(notes, key).types.empty()))
        out += table(key, [&] { return children(key, key, note_at(notes, key).required); });
    return out;
  }

 private:
  const Notes& notes;

  template <class Rows>
  static std::string table(const std::string& name, const Rows& rows) {
    return "<!-- keys of " + name +
           ": osculate schema --markdown -->\n| key | unit | default | meaning |\n|---|---|---|---|\n" +
           rows() + "<!-- end of keys -->\n";
  }

  /// `shown`: the path as --set knows it. `must`: everything around it must be given.
  std::string children(const std::string& place, const std::string& shown, bool must) const {
    std::string out;
    const Note& note = note_at(notes, place);
    for (const auto& key : note.keys) {
      const std::string own = below(place, key), path = below(shown, key);
      out += row(own, path, "", must) + children(own, path, must && note_at(notes, own).required);
    }
    if (!note.types.empty()) out += row(place + ".type", shown + ".type", "", must);
    for (const auto& type : note.types)
      for (const auto& key : note_at(notes, place + "<" + type + ">").keys)
        if (key != "type") out += row(place + "<" + type + ">." + key, shown + "." + key, type + ": ", false);
    if (notes.by_place.contains(place + "[]")) out += children(place + "[]", shown + ".N", false);
    return out;
  }

  std::string row(const std::string& place, const std::string& shown, const std::string& before,
                  bool must) const {
    const Note& note = note_at(notes, place);
    const std::string name = "`" + shown + "`";
    const std::string fallback = !note.key.otherwise.empty() ? note.key.otherwise : note.fallback;
    std::string meaning = note.key.meaning;
    for (const Form& form : note.forms) {
      if (form.kind != Form::Kind::word || is_truth(form)) continue;
      std::vector<std::string> words;
      for (const auto& word : form.words)
        if (!word.empty()) words.push_back("`" + word + "`");
      const bool said = words.empty() || meaning.find(words.front()) != std::string::npos;
      if (!said && place != "controller.law")
        meaning = yaml::either(words) + (meaning.empty() ? "" : "; ") + meaning;
    }
    return "| " + (must && note.required ? "**" + name + "**" : name) + " | " + note.key.unit + " | " +
           (note.required ? "required" : fallback) + " | " + before + meaning + " |\n";
  }
};

}  // namespace

std::string experiment_schema() {
  Notes notes;
  take(notes);
  Members out{{"$schema", yaml::quoted("http://json-schema.org/draft-07/schema#")},
              {"title", yaml::quoted("osculate experiment")}};
  for (const auto& member : Schema(notes).value("")) out.push_back(member);
  return object(out) + "\n";
}

std::string key_tables() {
  Notes notes;
  take(notes);
  return Tables(notes).all();
}

}  // namespace osculate
