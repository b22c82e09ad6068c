#include "experiment/config.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "experiment/yaml_reader.hpp"

namespace osculate {
namespace {

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::either;
using yaml::entries;
using yaml::fail;
using yaml::fail_missing;
using yaml::Map;
using yaml::read;
using yaml::Setting;

const std::vector<std::string> row_names(task_row_names.begin(), task_row_names.end());
const std::vector<std::string> claim_ids{"omega",
                                         "lambda",
                                         "c",
                                         "g",
                                         "c_plus_g",
                                         "torque",
                                         "forward_dynamics",
                                         "linearization",
                                         "kinematics",
                                         "null_space",
                                         "coordinates",
                                         "energy",
                                         "analytic_response",
                                         "decoupling"};
constexpr double most_samples = 1e8;  // recorded instants of one run; more is a slip of the interval

// ---- parts that occur under `model` and under `plant`

std::filesystem::path resolve(const std::filesystem::path& directory, const std::string& text) {
  return std::filesystem::absolute(directory / text).lexically_normal();
}

/// One list of a friction map, checked to be as long as the lists before it.
void read_friction_list(const Setting& setting, const yaml::Range& range, double JointFriction::*part,
                        std::vector<JointFriction>& out, std::string& first) {
  if (!setting.given()) return;
  std::vector<double> values;
  read(setting, values, range);
  if (first.empty()) {
    first = setting.path;
    out.resize(values.size());
  }
  if (values.size() != out.size())
    fail(setting, "has " + std::to_string(values.size()) + " entries, " + first + " has " +
                      std::to_string(out.size()) + "; give one for each joint.");
  for (std::size_t i = 0; i < values.size(); ++i) out[i].*part = values[i];
}

std::vector<JointFriction> read_friction(const Setting& setting) {
  const Map map(setting, {"viscous", "coulomb", "coulomb_positive", "coulomb_negative", "v_s"});
  const auto both = map.at("coulomb"), positive = map.at("coulomb_positive"),
             negative = map.at("coulomb_negative");
  if (both.given() && positive.given()) fail(positive, "give this or coulomb, not both.");
  if (both.given() && negative.given()) fail(negative, "give this or coulomb, not both.");
  const std::string remedy = "give both directions, or coulomb where they are equal.";
  if (positive.given() && !negative.given()) fail_missing(negative, remedy);
  if (negative.given() && !positive.given()) fail_missing(positive, remedy);

  std::vector<JointFriction> out;
  std::string first;
  const auto magnitude = at_least_zero("give the magnitude, friction always opposes motion");
  read_friction_list(map.at("viscous"), at_least_zero(), &JointFriction::viscous, out, first);
  read_friction_list(both, magnitude, &JointFriction::coulomb_positive, out, first);
  read_friction_list(both, magnitude, &JointFriction::coulomb_negative, out, first);
  read_friction_list(positive, magnitude, &JointFriction::coulomb_positive, out, first);
  read_friction_list(negative, magnitude, &JointFriction::coulomb_negative, out, first);

  const auto speed = map.at("v_s");
  const auto range = above_zero("the speed that sets the width of the smoothed step");
  if (speed.given() && first.empty()) fail(speed, "has nothing to smooth: give viscous or coulomb as well.");
  if (yaml::is_scalar(speed)) {
    double v_s = 0;
    read(speed, v_s, range);
    for (auto& joint : out) joint.v_s = v_s;
  } else {
    read_friction_list(speed, range, &JointFriction::v_s, out, first);
  }
  return out;
}

/// Three rows, or [ixx, iyy, izz, ixy, ixz, iyz].
void read_inertia(const Setting& setting, Matrix3<double>& out) {
  if (!setting.given()) return;
  const std::string what = "three rows of three, or [ixx, iyy, izz, ixy, ixz, iyz]";
  const auto list = entries(setting, what);
  Matrix3<double> I;
  if (list.size() == 6) {
    Vector6 x;
    read(setting, x);
    I << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
  } else if (list.size() == 3) {
    for (int i = 0; i < 3; ++i) {
      Vector3<double> row;
      read(list[i], row);
      I.row(i) = row.transpose();
    }
  } else {
    fail(setting, "must be " + what + ".");
  }
  if (I != I.transpose()) fail(setting, "must be symmetric.");
  // The eigenvalues of a symmetric 3x3 matrix come out within a few eps of its largest entry.
  const double smallest =
      Eigen::SelfAdjointEigenSolver<Matrix3<double>>(I, Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (smallest < -16 * std::numeric_limits<double>::epsilon() * I.cwiseAbs().maxCoeff())
    fail(setting, "must have no negative principal moment; check the signs of the products of inertia.");
  out = I;
}

// ---- sections

ModelConfig read_model(const Setting& setting, const std::filesystem::path& directory) {
  const Map map(setting, {"urdf", "base", "tip", "gravity", "side_branches", "armature", "friction"});
  ModelConfig out;
  std::string urdf;
  if (!map.at("urdf").given()) fail_missing(map.at("urdf"), "give the URDF file of the arm.");
  if (!map.at("tip").given()) fail_missing(map.at("tip"), "give the link whose motion is controlled.");
  read(map.at("urdf"), urdf);
  out.urdf = resolve(directory, urdf);
  const auto base = map.at("base");
  if (!(yaml::is_scalar(base) && base.value->text.empty())) read(base, out.choice.base);  // "": the root
  read(map.at("tip"), out.choice.tip);
  read(map.at("gravity"), out.choice.gravity);
  read(map.at("side_branches"), out.choice.side_branches,
       {{"lump", SideBranches::lump}, {"drop", SideBranches::drop}});
  read(map.at("armature"), out.armature, at_least_zero());
  out.friction = read_friction(map.at("friction"));
  return out;
}

PlantConfig read_plant(const Setting& setting) {
  const Map map(setting, {"payload", "armature", "friction", "mass_scale", "tip_force"});
  const Map payload(map.at("payload"), {"mass", "com", "inertia"});
  PlantConfig out;
  read(payload.at("mass"), out.payload.mass, at_least_zero());
  read(payload.at("com"), out.payload.com);
  read_inertia(payload.at("inertia"), out.payload.inertia);
  if (map.at("armature").given()) read(map.at("armature"), out.armature.emplace(), at_least_zero());
  if (map.at("friction").given()) out.friction = read_friction(map.at("friction"));
  read(map.at("mass_scale"), out.mass_scale, above_zero("1 leaves the masses as they are"));
  read(map.at("tip_force"), out.tip_force);
  return out;
}

void read_initial(const Setting& setting, Experiment& out) {
  const Map map(setting, {"q", "qd"});
  const auto q = map.at("q"), qd = map.at("qd");
  if (!q.given())
    fail_missing(q, "give one number for each joint from base to tip (zero is singular for common arms).");
  read(q, out.q);
  if (out.q.empty()) fail(q, "must have one number for each joint from base to tip.");
  read(qd, out.qd);
}

const std::vector<std::pair<std::string, std::vector<std::string>>> reference_keys{
    {"hold", {}},
    {"step", {"offset", "at"}},
    {"line", {"offset", "start", "duration"}},
    {"circle", {"radius", "period", "plane"}},
    {"lissajous", {"amplitude", "period", "phase"}},
    {"waypoints", {"file"}},
};

/// The keys of `type` with "type" itself. Throws for a key that another type has and this one has not.
std::vector<std::string> keys_of_type(const Setting& setting, const std::string& type) {
  std::vector<std::string> keys{"type"};
  for (const auto& [name, own] : reference_keys)
    if (name == type) keys.insert(keys.end(), own.begin(), own.end());
  for (const auto& given : Map::keys_of(setting)) {
    if (std::find(keys.begin(), keys.end(), given) != keys.end()) continue;
    std::vector<std::string> owners;
    for (const auto& [name, own] : reference_keys)
      if (std::find(own.begin(), own.end(), given) != own.end()) owners.push_back(name);
    if (owners.empty()) continue;
    for (const auto& item : setting.value->items)
      if (item.key == given)
        throw ConfigError(item.key_place + ": unknown key '" + setting.path + "." + given +
                          "': it belongs to type " + either(owners) + ", the type here is " + type +
                          "; remove it, or replace the whole " + setting.path + " (--set \"" + setting.path +
                          "={type: " + type + "}\").");
  }
  return keys;
}

ReferenceConfig read_reference(const Setting& setting, const std::filesystem::path& directory) {
  std::vector<std::string> types;
  for (const auto& [name, own] : reference_keys) types.push_back(name);
  std::string type = "hold";
  if (yaml::is_map(setting)) {
    for (const auto& item : setting.value->items)
      if (item.key == "type") type = yaml::read_word({&item, setting.path + ".type", item.place}, types);
  }
  const Map map(setting, keys_of_type(setting, type));
  if (type == "step") {
    StepOptions out;
    read(map.at("offset"), out.offset);
    read(map.at("at"), out.at, at_least_zero());
    return out;
  }
  if (type == "line") {
    LineOptions out;
    read(map.at("offset"), out.offset);
    read(map.at("start"), out.start, at_least_zero());
    read(map.at("duration"), out.duration, above_zero("use type step for a jump"));
    return out;
  }
  if (type == "circle") {
    CircleOptions out;
    read(map.at("radius"), out.radius, above_zero("use type hold to stay"));
    read(map.at("period"), out.period, above_zero("exchange the letters of plane to turn the other way"));
    if (map.at("plane").given())
      out.plane = yaml::read_word(map.at("plane"), {"xy", "yx", "yz", "zy", "zx", "xz"});
    return out;
  }
  if (type == "lissajous") {
    LissajousOptions out;
    read(map.at("amplitude"), out.amplitude);
    yaml::read_one_or_six(map.at("period"), out.period, above_zero());
    yaml::read_one_or_six(map.at("phase"), out.phase);
    return out;
  }
  if (type == "waypoints") {
    std::string file;
    if (!map.at("file").given()) fail_missing(map.at("file"), "give a CSV file with the columns t,x,y,z.");
    read(map.at("file"), file);
    return WaypointsOptions{resolve(directory, file)};
  }
  return HoldOptions{};
}

void read_rows(const Setting& setting, std::vector<int>& out) {
  if (!setting.given()) return;
  const auto list = entries(setting, "a list of task rows out of wx, wy, wz, vx, vy, vz");
  if (list.empty()) fail(setting, "must name at least one of wx, wy, wz, vx, vy, vz.");
  out.clear();
  for (const auto& entry : list) {
    const auto name = yaml::read_word(entry, row_names);
    const auto row =
        static_cast<int>(std::find(row_names.begin(), row_names.end(), name) - row_names.begin());
    if (std::find(out.begin(), out.end(), row) != out.end()) fail(entry, "is named twice: remove one.");
    out.push_back(row);
  }
}

std::optional<Sampling> read_sampling(const Setting& setting, Law law) {
  if (!setting.given()) return std::nullopt;
  const Map map(setting, {"period", "delay", "extrapolate", "monitor_every"});
  Sampling out;
  if (law == Law::free) fail(setting, "a free swing has nothing to sample: remove it.");
  if (!map.at("period").given()) fail_missing(map.at("period"), "give the time between samples in s.");
  read(map.at("period"), out.period, above_zero("leave sampling out for a law that acts at every instant"));
  const auto delay = map.at("delay"), line = map.at("extrapolate"), monitor = map.at("monitor_every");
  read(
      delay, out.delay,
      {{"none", Delay::none}, {"velocity", Delay::velocity}, {"force", Delay::force}, {"both", Delay::both}});
  read(line, out.extrapolate);
  read(monitor, out.monitor_every, 1);
  if (out.delay != Delay::none && law != Law::operational_space)
    fail(delay, "only operational_space has delayed forms: use delay: none.");
  if (out.extrapolate && out.delay == Delay::none)
    fail(line, "there is nothing to extrapolate: give a delay.");
  if (out.monitor_every > 1 && law != Law::resolved_acceleration)
    fail(monitor, "operational_space computes Lambda, c and g at every sample: use resolved_acceleration.");
  return out;
}

ControllerConfig read_controller(const Setting& setting) {
  const Map map(setting, {"law", "coordinates", "rows", "orientation", "position", "gains", "null_space",
                          "compensate_friction", "compensate_tip_force", "sampling"});
  const Map gains(map.at("gains"), {"stiffness", "damping"});
  const Map null_space(map.at("null_space"), {"damping"});
  ControllerConfig out;
  if (!map.at("law").given())
    fail_missing(map.at("law"), "give operational_space, resolved_acceleration or free.");
  read(map.at("law"), out.law,
       {{"operational_space", Law::operational_space},
        {"resolved_acceleration", Law::resolved_acceleration},
        {"free", Law::free}});
  const std::vector<int> pose{0, 1, 2, 3, 4, 5}, position{3, 4, 5};
  read(map.at("coordinates"), out.rows, {{"pose", pose}, {"position", position}});
  read_rows(map.at("rows"), out.rows);
  yaml::read_one_or_six(gains.at("stiffness"), out.stiffness, at_least_zero());
  yaml::read_one_or_six(gains.at("damping"), out.damping, at_least_zero());
  read(null_space.at("damping"), out.null_space_damping, at_least_zero());
  if (out.law == Law::resolved_acceleration && out.null_space_damping > 0)
    fail(null_space.at("damping"),
         "resolved_acceleration has no null space: remove it, or use operational_space.");
  read(map.at("compensate_friction"), out.compensate_friction);
  read(map.at("compensate_tip_force"), out.compensate_tip_force);
  using Orientation = OrientationCoordinates;
  using Position = PositionCoordinates;
  read(map.at("orientation"), out.orientation,
       {{"rotation_vector", Orientation::rotation_vector},
        {"roll_pitch_yaw", Orientation::roll_pitch_yaw},
        {"zyz_euler", Orientation::zyz_euler},
        {"quaternion", Orientation::quaternion}});
  read(map.at("position"), out.position,
       {{"cartesian", Position::cartesian},
        {"cylindrical", Position::cylindrical},
        {"spherical", Position::spherical}});
  out.sampling = read_sampling(map.at("sampling"), out.law);
  return out;
}

IntegratorConfig read_integrator(const Setting& setting) {
  const Map map(setting, {"method", "rtol", "atol", "max_step", "max_steps"});
  IntegratorConfig out;
  read(map.at("method"), out.method, {{"adams", Method::adams}, {"bdf", Method::bdf}});
  read(map.at("rtol"), out.rtol,
       {.low = 1e-14, .high = 1, .high_open = true, .note = "a double resolves 2e-16"});
  const auto atol = map.at("atol");
  if (yaml::is_map(atol)) {
    const Map parts(atol, {"position", "velocity"});
    read(parts.at("position"), out.atol_position, above_zero());
    read(parts.at("velocity"), out.atol_velocity, above_zero());
  } else {
    read(atol, out.atol_position, above_zero());
    read(atol, out.atol_velocity, above_zero());
  }
  read(map.at("max_step"), out.max_step, at_least_zero("0 lets the program choose"));
  read(map.at("max_steps"), out.max_steps, 1);
  return out;
}

VerifyConfig read_verify(const Setting& setting) {
  const Map map(setting, {"every", "record", "shadow"});
  VerifyConfig out;
  const auto every = map.at("every"), record = map.at("record");
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
  return out;
}

ExpectConfig read_expect(const Setting& setting) {
  const Map map(setting, {"stop", "fails"});
  ExpectConfig out;
  const auto stop = map.at("stop"), fails = map.at("fails");
  if (stop.given() && !(yaml::is_scalar(stop) && stop.value->text.empty()))
    out.stop = yaml::read_word(stop, {"singular", "non_finite", "step_too_small", "too_many_steps"});
  if (!fails.given()) return out;
  for (const auto& entry : entries(fails, "a list of claims, for instance [linearization]")) {
    const auto claim = yaml::read_word(entry, claim_ids);
    if (std::find(out.fails.begin(), out.fails.end(), claim) != out.fails.end())
      fail(entry, "is named twice: remove one.");
    out.fails.push_back(claim);
  }
  return out;
}

/// Places of what `check_against` looks at.
std::map<std::string, std::string> places_of(const Map& root) {
  std::map<std::string, std::string> out;
  const auto note = [&out](const Setting& setting) {
    if (setting.given()) out[setting.path] = setting.place;
  };
  const Map initial(root.at("initial"), {"q", "qd"});
  for (const auto* key : {"q", "qd"}) note(initial.at(key));
  for (const auto* section : {"model", "plant"})
    if (yaml::is_map(root.at(section)))
      for (const auto& item : root.at(section).value->items)
        if (item.key == "armature" || item.key == "friction") out[section + ("." + item.key)] = item.place;
  note(root.at("controller"));
  if (yaml::is_map(root.at("controller")))
    for (const auto& item : root.at("controller").value->items) out["controller." + item.key] = item.place;
  return out;
}

}  // namespace

Experiment parse_experiment(const std::string& text, const std::string& source,
                            const std::filesystem::path& directory,
                            const std::vector<std::string>& overrides) {
  auto document = yaml::parse(text, source);
  for (const auto& override_text : overrides) yaml::apply_override(document, override_text);
  const Map root({&document, "", document.place},
                 {"name", "model", "plant", "initial", "reference", "base_motion", "controller", "integrator",
                  "duration", "output", "verify", "expect"});
  Experiment out;
  out.file = source;
  out.name = source.empty() ? "experiment" : out.file.stem().string();
  read(root.at("name"), out.name);
  if (out.name.find('/') != std::string::npos) fail(root.at("name"), "must not contain '/': it names files.");
  out.model = read_model(root.at("model"), directory);
  out.plant = read_plant(root.at("plant"));
  read_initial(root.at("initial"), out);
  out.reference = read_reference(root.at("reference"), directory);
  if (root.at("base_motion").given()) {
    out.base_motion = read_reference(root.at("base_motion"), directory);
    if (std::holds_alternative<WaypointsOptions>(*out.base_motion) ||
        std::holds_alternative<StepOptions>(*out.base_motion))
      fail(root.at("base_motion"), "a base moves along type line, circle or lissajous.");
  }
  out.controller = read_controller(root.at("controller"));
  out.integrator = read_integrator(root.at("integrator"));
  read(root.at("duration"), out.duration, above_zero());
  const Map output(root.at("output"), {"interval"});
  const auto interval = output.at("interval");
  read(interval, out.output.interval, above_zero());
  if (out.duration / out.output.interval > most_samples) {
    const std::string text_of_limit = "is too short for the duration: at most 1e8 instants are recorded.";
    if (interval.given()) fail(interval, text_of_limit);
    fail(root.at("duration"), "is too long for output.interval: at most 1e8 instants are recorded.");
  }
  out.verify = read_verify(root.at("verify"));
  out.expect = read_expect(root.at("expect"));
  out.places = places_of(root);
  return out;
}

Experiment read_experiment(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  const auto source = file.string();
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw ConfigError(source + ": is a directory; give an experiment file.");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw ConfigError(source + ": cannot be read: " + (errno != 0 ? std::strerror(errno) : "unknown reason") +
                      ".");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) throw ConfigError(source + ": cannot be read to its end.");
  return parse_experiment(text, source, file.parent_path(), overrides);
}

}  // namespace osculate
