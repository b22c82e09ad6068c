// What the readers of an experiment say of their keys while they read: types, ranges, choices, defaults.
// schema.cpp has them read specimens and makes the schema and the tables of the documentation out of these
// notes, so that neither can disagree with the reading.
#pragma once

#include <map>

#include "experiment/yaml_reader.hpp"
#include "input/number_text.hpp"

namespace osculate::yaml {

/// One form that a value may have.
struct Form {
  enum class Kind { number, whole, word, text, list, map } kind = Kind::map;
  Range range = {};
  std::vector<std::string> words = {};
  std::size_t size = 0;  // of a list; 0: any
};

struct Note {
  Key key;
  bool required = false;
  std::vector<Form> forms;
  std::string fallback;             // the default, as YAML; empty: none
  std::vector<std::string> keys;    // of a map, in order
  bool open = false;                // a map with keys of any name
  std::vector<std::string> types;   // of a map with a type: notes of its keys are at "path<type>.key"
  std::string type_otherwise = {};  // the type where none is given; empty: it must be given
};

class Notes {
 public:
  Notes();
  ~Notes();
  Notes(const Notes&) = delete;
  Notes& operator=(const Notes&) = delete;
  /// Whoever takes notes now in this thread; null: nobody, which is the rule.
  static Notes* active();

  /// "a.b[3]" as "a.b[]", and "reference.radius" as "reference<circle>.radius" once the type is known.
  std::string place(const std::string& path) const;
  Note& at(const std::string& path) { return by_place[place(path)]; }
  void set_type(const std::string& path, const std::string& type) { types[path] = type; }

  std::map<std::string, Note> by_place;

 private:
  std::map<std::string, std::string> types;
};

/// Nothing where nobody takes notes. The first default that is noted of a place counts.
void note(const Setting&, const Form& form, const std::string& fallback = "");
void note_keys(const Setting&, const Keys& keys);
void note_types(const Setting&, const TypeKeys& types, const std::string& type, const std::string& otherwise);
void note_required(const Setting&);
void note_open_map(const Setting&);
template <class Numbers>
std::string shown_list(const Numbers& numbers) {
  std::string out;
  for (const double x : numbers) out += (out.empty() ? "" : ", ") + number_text(x);
  return "[" + out + "]";
}

}  // namespace osculate::yaml
