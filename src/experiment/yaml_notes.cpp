#include "experiment/yaml_notes.hpp"

#include <algorithm>

namespace osculate::yaml {
namespace {

thread_local Notes* taking = nullptr;

bool same(const Form& a, const Form& b) {
  return a.kind == b.kind && a.words == b.words && a.size == b.size && a.range.low == b.range.low &&
         a.range.high == b.range.high;
}

}  // namespace

Notes::Notes() { taking = this; }
Notes::~Notes() { taking = nullptr; }
Notes* Notes::active() { return taking; }

std::string Notes::place(const std::string& path) const {
  std::string out;
  for (const char c : path) {
    const bool index = !out.empty() && out.back() == '[' && c != ']';
    if (!index) out += c;
  }
  for (const auto& [typed, type] : types)
    if (out.starts_with(typed + ".") && out != typed + ".type")
      return typed + "<" + type + ">" + out.substr(typed.size());
  return out;
}

void note(const Setting& setting, const Form& form, const std::string& fallback) {
  if (taking == nullptr) return;
  Note& note = taking->at(setting.path);
  if (std::none_of(note.forms.begin(), note.forms.end(), [&](const Form& f) { return same(f, form); }))
    note.forms.push_back(form);
  if (note.fallback.empty()) note.fallback = fallback;
}

void note_words(const Setting& setting, const std::vector<std::string>& words, const std::string& fallback) {
  note(setting, {.kind = Form::Kind::word, .words = words}, fallback);
}

void note_keys(const Setting& setting, const Keys& keys) {
  if (taking == nullptr) return;
  note(setting, {.kind = Form::Kind::map});
  const std::string prefix = setting.path.empty() ? "" : setting.path + ".";
  std::vector<std::string> names;
  for (const Key& key : keys) {
    names.push_back(key.name);
    taking->at(prefix + key.name).key = key;
  }
  Note& note = taking->at(setting.path);
  if (note.types.empty()) {
    note.keys = names;
  } else {
    const std::string some_key = taking->place(setting.path + ".x");
    taking->by_place[some_key.substr(0, some_key.size() - 2)].keys = names;
  }
}

void note_types(const Setting& setting, const TypeKeys& types, const std::string& type,
                const std::string& otherwise) {
  if (taking == nullptr) return;
  note(setting, {.kind = Form::Kind::map});
  taking->set_type(setting.path, type);
  Note& note = taking->at(setting.path);
  note.types.clear();
  for (const auto& [name, keys] : types) note.types.push_back(name);
  note.type_otherwise = otherwise;
}

void note_required(const Setting& setting) {
  if (taking != nullptr) taking->at(setting.path).required = true;
}

void note_open_map(const Setting& setting) {
  if (taking == nullptr) return;
  note(setting, {.kind = Form::Kind::map});
  taking->at(setting.path).open = true;
}

}  // namespace osculate::yaml
