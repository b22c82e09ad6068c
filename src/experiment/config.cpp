#include "experiment/config.hpp"

#include <algorithm>
#include <cctype>

#include "experiment/config_sections.hpp"
#include "experiment/yaml_notes.hpp"
#include "input/limits.hpp"
#include "input/read_text.hpp"
#include "verification/claims.hpp"

namespace osculate {
namespace {

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::entries;
using yaml::fail;
using yaml::Map;
using yaml::read;
using yaml::Setting;

const yaml::Keys sections{
    {"name", "", "name of the run", "file name"},
    {"model", "", "the arm, as controller and plant know it"},
    {"plant", "", "how the true arm differs from the model that the controller knows, and what it meets"},
    {"initial", "", "the state at t = 0"},
    {"reference", "", "what the tip is asked to do"},
    {"base_motion", "",
     "how the base moves in the inertial frame: a map like `reference`, type `line`, `circle`, `lissajous` "
     "or `hold`; "
     "relative to where the base stands at t = 0",
     "none: at rest"},
    {"controller", "", "the law"},
    {"integrator", "", "method and tolerances"},
    {"duration", "s", "> 0"},
    {"output", "", "what is recorded"},
    {"verify", "", "what is checked"},
    {"expect", "", "what must come true for exit code 0"},
    {"sweep", "", "what changes from run to run, see [sweeps](#sweeps)", "none"}};

void read_initial(const Setting& setting, Experiment& out) {
  const Map map(
      setting,
      {{"q", "rad, m, 1", "position coordinates at t = 0. A quaternion w, x, y, z may have any length but 0"},
       {"qd", "rad/s, m/s", "velocity coordinates at t = 0", "zeros"}});
  const auto q = map.at("q"), qd = map.at("qd");
  yaml::require_given(q,
                      "give one number for each joint from base to tip (zero is singular for common arms).");
  read(q, out.q);
  if (out.q.empty()) fail(q, "must have one number for each joint from base to tip.");
  read(qd, out.qd);
}

IntegratorConfig read_integrator(const Setting& setting) {
  const Map map(setting,
                {{"method", "",
                  "`adams` (fixed point), `bdf` (Newton; for stiff runs) or `runge_kutta` "
                  "(explicit; for runs with many samples or "
                  "contacts)"},
                 {"rtol", "", "relative local error, 1e-14 <= rtol < 1"},
                 {"atol", "rad, m; per s",
                  "absolute local error, > 0: a number, or {position: x, velocity: y}", "1e-12"},
                 {"max_step", "s", "longest step; 0: chosen by the program"},
                 {"max_steps", "", "a run that needs more stops early"},
                 {"jacobian", "",
                  "of bdf: `automatic` (in closed form, where arm and law have one, or else differences) "
                  "or `differences`"}});
  IntegratorConfig out;
  read(map.at("method"), out.method,
       {{"adams", Method::adams}, {"bdf", Method::bdf}, {"runge_kutta", Method::runge_kutta}});
  read(map.at("rtol"), out.rtol,
       {.low = 1e-14, .high = 1, .high_open = true, .note = "a double resolves 2e-16"});
  const auto atol = map.at("atol");
  if (yaml::is_map(atol)) {
    const Map parts(atol, {{"position", "rad, m", "> 0"}, {"velocity", "rad/s, m/s", "> 0"}});
    read(parts.at("position"), out.atol_position, above_zero());
    read(parts.at("velocity"), out.atol_velocity, above_zero());
  } else {
    read(atol, out.atol_position, above_zero());
    read(atol, out.atol_velocity, above_zero());
  }
  read(map.at("max_step"), out.max_step, at_least_zero("0 lets the program choose"));
  read(map.at("max_steps"), out.max_steps, 1);
  read(map.at("jacobian"), out.jacobian,
       {{"automatic", JacobianBy::automatic}, {"differences", JacobianBy::differences}});
  return out;
}

VerifyConfig read_verify(const Setting& setting) {
  const Map map(
      setting,
      {{"every", "", "check every accepted step, or every N-th. The samples of a sampled law are all checked",
        "step"},
       {"record", "", "record `all` checks, only the `worst`, or every N-th", "all"},
       {"shadow", "", "repeat the run at tolerance / 100 to estimate the global error"},
       {"poles", "", "linearize the closed loop at the start and judge its poles"}});
  VerifyConfig out;
  const auto every = map.at("every"), record = map.at("record");
  yaml::note_words(every, {"step"});
  yaml::note_words(record, {"all", "worst"});
  const auto is_word = [](const Setting& given, const std::string& word) {
    return yaml::is_scalar(given) && given.value->text == word;
  };
  const auto looks_like_word = [](const Setting& given) {
    return yaml::is_scalar(given) && std::isalpha(static_cast<unsigned char>(given.value->text[0]));
  };
  if (is_word(every, "step"))
    out.every = 1;
  else if (looks_like_word(every))
    fail(every, "must be step or a whole number >= 1.");
  else
    read(every, out.every, 1);
  if (is_word(record, "all"))
    out.record = VerifyConfig::Record::all;
  else if (is_word(record, "worst"))
    out.record = VerifyConfig::Record::worst;
  else if (looks_like_word(record))
    fail(record, "must be all, worst or a whole number >= 1.");
  else if (record.given()) {
    read(record, out.record_every, 1);
    out.record = VerifyConfig::Record::every;
  }
  read(map.at("shadow"), out.shadow);
  read(map.at("poles"), out.poles);
  return out;
}

ExpectConfig read_expect(const Setting& setting) {
  std::string all_claims;
  for (const auto& info : claim_table) all_claims += " " + std::string(info.id);
  const Map map(setting,
                {{"stop", "",
                  "`singular` (the arm, or the coordinates of the law), `non_finite`, `step_too_small`, "
                  "`too_many_steps` or `law` (one of your own failed): the run must stop so",
                  "\"\""},
                 {"fails", "", "claims that must fail:" + all_claims, "[]"}});
  ExpectConfig out;
  const auto stop = map.at("stop"), fails = map.at("fails");
  yaml::note_words(stop, {""});
  if (stop.given() && !(yaml::is_scalar(stop) && stop.value->text.empty()))
    out.stop = yaml::read_word(stop, {"singular", "non_finite", "step_too_small", "too_many_steps", "law"});
  if (!fails.given()) return out;
  std::vector<std::string> claims;
  for (const auto& info : claim_table) claims.emplace_back(info.id);
  for (const auto& entry : entries(fails, "a list of claims, for instance [linearization]")) {
    const auto claim = yaml::read_word(entry, claims);
    if (std::find(out.fails.begin(), out.fails.end(), claim) != out.fails.end())
      fail(entry, "is named twice: remove one.");
    out.fails.push_back(claim);
  }
  return out;
}

/// Places of all settings in maps, for `check_against`.
void note_places(const yaml::Value& map, const std::string& path, std::map<std::string, std::string>& out) {
  if (map.kind != yaml::Value::Kind::map) return;
  for (const auto& item : map.items) {
    const auto own = path.empty() ? item.key : path + "." + item.key;
    out[own] = item.place;
    note_places(item, own, out);
  }
}

/// The experiment of a document, without its sweep.
Experiment read_document(const yaml::Value& document, const std::string& source,
                         const std::filesystem::path& directory) {
  const Map root({&document, "", document.place}, sections);
  Experiment out;
  out.file = source;
  out.directory = resolve(directory, ".").parent_path();
  out.name = source.empty() ? "experiment" : out.file.stem().string();
  read(root.at("name"), out.name);
  if (out.name.find('/') != std::string::npos) fail(root.at("name"), "must not contain '/': it names files.");
  for (const auto* section : {"model", "initial", "controller"}) yaml::note_required(root.at(section));
  out.model = read_model(root.at("model"), directory);
  out.plant = read_plant(root.at("plant"));
  read_initial(root.at("initial"), out);
  out.reference = read_reference(root.at("reference"), directory);
  if (root.at("base_motion").given()) out.base_motion = read_base_motion(root.at("base_motion"), directory);
  out.controller = read_controller(root.at("controller"), directory);
  out.integrator = read_integrator(root.at("integrator"));
  read(root.at("duration"), out.duration, above_zero());
  if (const auto* axes = std::get_if<EachAxisOptions>(&out.reference);
      axes != nullptr && out.duration / axes->period > limits::jumps)
    fail(root.at("reference"), "period is too short for the duration: at most 1e6 axes are moved in a run.");
  const Map output(root.at("output"),
                   {{"interval", "s", "time between recorded instants, > 0; at most 1e8 instants"},
                    {"restart_interval", "s",
                     "simulated time between points from which a stopped run can be [resumed](replay.md), >= "
                     "0; 0: none; at "
                     "most 1e5 points"}});
  const auto interval = output.at("interval");
  read(interval, out.output.interval, above_zero());
  if (out.duration / out.output.interval > limits::recorded_instants) {
    const std::string text_of_limit = "is too short for the duration: at most 1e8 instants are recorded.";
    if (interval.given()) fail(interval, text_of_limit);
    fail(root.at("duration"), "is too long for output.interval: at most 1e8 instants are recorded.");
  }
  const auto restarts = output.at("restart_interval");
  read(restarts, out.output.restart_interval, at_least_zero("0 makes no restart points"));
  if (out.controller.law == Law::user && out.controller.sampling) {
    if (restarts.given() && out.output.restart_interval > 0)
      fail(restarts, "a sampled law of your own may have a memory that osculate cannot write down: set 0.");
    out.output.restart_interval = 0;
  }
  if (out.output.restart_interval > 0 && out.duration / out.output.restart_interval > limits::restarts)
    fail(restarts.given() ? restarts : root.at("duration"),
         "gives more than 1e5 restart points: set output.restart_interval to at least duration / 1e5, or 0.");
  if (const auto& sampling = out.controller.sampling;
      sampling && out.duration / sampling->period > limits::samples)
    fail(root.at("controller"),
         "sampling.period is too short for the duration: at most 1e9 samples are taken in a run.");
  out.verify = read_verify(root.at("verify"));
  out.expect = read_expect(root.at("expect"));
  note_places(document, "", out.places);
  return out;
}

/// Throws where a variant is no experiment: better now than after the runs of those before it.
void try_variants(const yaml::Value& document, const PlacedSweep& swept, const std::string& source,
                  const std::filesystem::path& directory) {
  auto plain = document;  // a long sweep would be copied for each of its runs
  std::erase_if(plain.items, [](const yaml::Value& item) { return item.key == "sweep"; });
  for (std::size_t i = 0; i < swept.places.size(); ++i) {
    const auto& variant = swept.sweep.variants[i];
    auto changed = plain;
    try {
      for (std::size_t j = 0; j < variant.overrides.size(); ++j)
        yaml::apply_override(changed, variant.overrides[j], swept.places[i][j]);
      read_document(changed, source, directory);
    } catch (const ConfigError& error) {
      throw ConfigError(std::string(error.what()) + " (Variant " + variant.name + " of sweep.)");
    }
  }
}

}  // namespace

Experiment parse_experiment(const std::string& text, const std::string& source,
                            const std::filesystem::path& directory,
                            const std::vector<std::string>& overrides) {
  auto document = yaml::parse(text, source);
  constexpr std::size_t longest_place = 200;  // what messages repeat of an override
  for (const auto& change : overrides) {
    std::string place = "--set " + change;
    if (place.size() > longest_place) place.replace(longest_place, std::string::npos, "...");
    yaml::apply_override(document, change, place);
  }
  auto out = read_document(document, source, directory);
  const Map root({&document, "", document.place}, sections);
  const auto swept = read_sweep(root.at("sweep"));
  try_variants(document, swept, source, directory);
  out.sweep = swept.sweep;
  return out;
}

Experiment read_experiment(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  const auto source = file.string();
  const auto [text, fault] = read_text(file, limits::experiment_bytes, "give an experiment file");
  if (!fault.empty()) throw ConfigError(fault);
  return parse_experiment(text, source, file.parent_path(), overrides);
}

}  // namespace osculate
