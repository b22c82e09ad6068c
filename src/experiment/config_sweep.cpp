// The section `sweep`.
#include <set>

#include "experiment/config_sections.hpp"
#include "experiment/yaml_notes.hpp"
#include "input/limits.hpp"

namespace osculate {
namespace {

using yaml::entries;
using yaml::fail;
using yaml::fail_missing;
using yaml::Map;
using yaml::Setting;
using yaml::Value;

/// What may be swept is what --set may change, but for the sweep itself.
void require_sweepable(const std::string& key, const std::string& place, const std::string& path) {
  const auto dots_around = "." + key + ".";
  if (dots_around.find("..") != std::string::npos || key.find('=') != std::string::npos)
    throw ConfigError(place + ": " + path + " = " + key +
                      ": must be a key path, for instance controller.gains.damping or initial.q.2.");
  if (dots_around.starts_with(".sweep."))
    throw ConfigError(place + ": " + path + " = " + key +
                      ": a sweep cannot change sweep; choose another key.");
}

void require_name(const std::string& name, const std::string& place, const std::string& path) {
  if (name.empty() || name.find('/') != std::string::npos)
    throw ConfigError(place + ": " + path + " = " + yaml::quoted(name) +
                      ": the name of a variant must not be empty and must not contain '/': name the variants "
                      "in sweep.variants.");
}

void require_few(std::size_t runs, const Setting& setting) {
  if (runs > limits::variants)
    fail(setting, "has " + std::to_string(runs) + " runs, at most " + std::to_string(limits::variants) +
                      " are made in one sweep: make several.");
}

void read_values(const Map& map, PlacedSweep& out) {
  const auto key = map.at("key"), values = map.at("values");
  if (!key.given()) fail_missing(key, "give the key path whose values are in sweep.values.");
  if (!values.given()) fail_missing(values, "give the values of sweep.key.");
  yaml::read(key, out.sweep.key);
  require_sweepable(out.sweep.key, key.place, key.path);
  const auto given = entries(values, "a list of values of sweep.key");
  require_few(given.size(), values);
  std::set<std::string> names;
  for (const auto& entry : given) {
    yaml::note(entry, {.kind = yaml::Form::Kind::text});
    if (entry.value->kind != Value::Kind::scalar)
      fail(entry, "must be one number or word; give lists and maps as sweep.variants.");
    SweepConfig::Variant variant{entry.value->text, {out.sweep.key + "=" + yaml::flow(*entry.value)}, {}};
    require_name(variant.name, entry.place, entry.path);
    if (!names.insert(variant.name).second) fail(entry, "is given twice: remove one.");
    if (yaml::is_number(*entry.value)) yaml::read(entry, variant.value.emplace());
    out.sweep.variants.push_back(std::move(variant));
    out.places.push_back({entry.place});
  }
  if (out.sweep.variants.empty()) fail(values, "must have at least one value.");
}

void read_variants(const Setting& setting, PlacedSweep& out) {
  if (!yaml::is_map(setting)) fail(setting, "must be a map: {name: {key.path: value, ...}, ...}.");
  yaml::note_open_map(setting);
  require_few(setting.value->items.size(), setting);
  if (setting.value->items.empty()) fail(setting, "must have at least one variant.");
  for (const auto& item : setting.value->items) {
    const Setting own{&item, setting.path + "." + item.key, item.place};
    require_name(item.key, item.key_place, setting.path);
    if (item.kind != Value::Kind::map && item.kind != Value::Kind::null)
      fail(own, "must be a map: {key.path: value, ...}; {} changes nothing.");
    SweepConfig::Variant variant{item.key, {}, {}};
    auto& places = out.places.emplace_back();
    for (const auto& change : item.items) {
      require_sweepable(change.key, change.key_place, own.path);
      variant.overrides.push_back(change.key + "=" + yaml::flow(change));
      places.push_back(change.place);
    }
    out.sweep.variants.push_back(std::move(variant));
  }
}

}  // namespace

PlacedSweep read_sweep(const Setting& setting) {
  const Map map(setting,
                {{"key", "", "a key path, and"},
                 {"values", "", "its value in each run"},
                 {"variants", "", "instead of them: a map from the name of each run to what it changes"}});
  PlacedSweep out;
  const auto variants = map.at("variants");
  const bool by_value = map.at("key").given() || map.at("values").given();
  if (variants.given() && by_value) fail(variants, "give this or key and values, not both.");
  if (variants.given()) read_variants(variants, out);
  if (by_value) read_values(map, out);
  return out;
}

std::vector<std::string> overrides_of(const SweepConfig::Variant& variant,
                                      const std::vector<std::string>& overrides) {
  auto out = overrides;
  out.emplace_back("sweep={}");
  out.insert(out.end(), variant.overrides.begin(), variant.overrides.end());
  return out;
}

}  // namespace osculate
