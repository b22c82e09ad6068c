// The section `controller`.
#include <algorithm>
#include <tuple>

#include "experiment/config_sections.hpp"

namespace osculate {
namespace {

constexpr double user_law_seconds = 1e6;  // that may be waited for

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::entries;
using yaml::fail;
using yaml::Map;
using yaml::read;
using yaml::Setting;

/// A law of the user's own: a map in place of a word.
UserLawOptions read_user_law(const Setting& setting, const std::filesystem::path& directory) {
  const Map map(setting,
                {{"plugin", "",
                  "[a law of your own](your-controller.md): a shared library with the interface of "
                  "`include/osculate/controller.h`"},
                 {"process", "",
                  "in its place a program and its arguments, [program, a, b], that answers lines of JSON"},
                 {"directory", "", "where the program runs", "the experiment's"},
                 {"options", "", "a text for the law"},
                 {"terms", "", "the law is given M, C, G, J and Jdot qd"},
                 {"time_limit", "s", "for each answer, > 0"},
                 {"start_limit", "s", "until it is ready, > 0"}});
  UserLawOptions out;
  std::string plugin, where = ".";
  const auto library = map.at("plugin"), program = map.at("process");
  read(library, plugin);
  if (program.given())
    for (const auto& word : entries(program, "a list of texts, the program and its arguments"))
      read(word, out.process.emplace_back());
  read(map.at("directory"), where);
  read(map.at("options"), out.options);
  read(map.at("terms"), out.terms);
  read(map.at("time_limit"), out.time_limit,
       {.low = 0, .low_open = true, .high = user_law_seconds, .note = "1 is enough for most"});
  read(map.at("start_limit"), out.start_limit,
       {.low = 0, .low_open = true, .high = user_law_seconds, .note = "30 is enough for most"});
  if (library.given() == program.given() || (program.given() && out.process.empty()))
    fail(setting, "give either plugin, a shared library, or process, a program and its arguments.");
  if (!plugin.empty()) out.plugin = resolve(directory, plugin).string();
  out.directory = resolve(directory, where).string();
  return out;
}

void read_law(const Setting& setting, const std::filesystem::path& directory, ControllerConfig& out) {
  yaml::require_given(setting, "give operational_space, resolved_acceleration or free.");
  using Choice = std::pair<Law, TextbookLaw>;
  std::vector<std::pair<std::string, Choice>> choices{
      {"operational_space", {Law::operational_space, out.textbook}},
      {"resolved_acceleration", {Law::resolved_acceleration, out.textbook}},
      {"free", {Law::free, out.textbook}}};
  for (const auto& info : textbook_laws()) choices.emplace_back(info.name, Choice{Law::textbook, info.law});
  if (yaml::is_map(setting)) {
    out.law = Law::user;
    out.user = read_user_law(setting, directory);
    return;
  }
  Choice chosen;
  read(setting, chosen, choices);
  std::tie(out.law, out.textbook) = chosen;
}

void read_rows(const Setting& setting, std::vector<int>& out) {
  if (!setting.given()) return;
  const auto list = entries(setting, "a list of task rows out of wx, wy, wz, vx, vy, vz");
  if (list.empty()) fail(setting, "must name at least one of wx, wy, wz, vx, vy, vz.");
  out.clear();
  for (const auto& entry : list) {
    const int row = read_row(entry);
    if (std::find(out.begin(), out.end(), row) != out.end()) fail(entry, "is named twice: remove one.");
    out.push_back(row);
  }
}

std::optional<Sampling> read_sampling(const Setting& setting, Law law) {
  if (!setting.given()) return std::nullopt;
  const Map map(setting,
                {{"period", "s", "time between samples, > 0"},
                 {"delay", "",
                  "what is one sample old: `none`, `velocity`, `force` or `both`; `operational_space` on a "
                  "base at rest only"},
                 {"extrapolate", "", "delayed values x(-1) become 2 x(-1) - x(-2); needs a delay"},
                 {"monitor_every", "",
                  "`resolved_acceleration`: Omega, Lambda, c and g are computed at every N-th sample"},
                 {"computation_time", "s",
                  "the torque of a sample acts so much later, >= 0 and < period; `delay: none` only"}});
  Sampling out;
  if (law == Law::free) fail(setting, "a free swing has nothing to sample: remove it.");
  yaml::require_given(map.at("period"), "give the time between samples in s.");
  read(map.at("period"), out.period, above_zero("leave sampling out for a law that acts at every instant"));
  const auto delay = map.at("delay"), line = map.at("extrapolate"), monitor = map.at("monitor_every"),
             computation = map.at("computation_time");
  read(
      delay, out.delay,
      {{"none", Delay::none}, {"velocity", Delay::velocity}, {"force", Delay::force}, {"both", Delay::both}});
  read(line, out.extrapolate);
  read(monitor, out.monitor_every, 1);
  read(computation, out.computation_time,
       {.low = 0,
        .high = out.period,
        .high_open = true,
        .note = "it must end before the next sample",
        .high_depends = true});
  if (out.delay != Delay::none && law != Law::operational_space)
    fail(delay, "only operational_space has delayed forms: use delay: none.");
  if (out.computation_time > 0 && out.delay != Delay::none)
    fail(computation, "goes with delay: none only; the delayed forms act at the instant of their sample.");
  if (out.extrapolate && out.delay == Delay::none)
    fail(line, "there is nothing to extrapolate: give a delay.");
  if (out.monitor_every > 1 && law != Law::resolved_acceleration)
    fail(monitor,
         "only resolved_acceleration can leave Lambda, c and g to some samples: use resolved_acceleration.");
  return out;
}

NullSpaceConfig read_null_space(const Setting& setting, Law law) {
  const Map map(
      setting,
      {{"damping", "N m s/rad, N s/m", "T0 -= damping qd, >= 0"},
       {"posture", "", "pull towards a posture; joints with one axis each", "none"},
       {"limits", "",
        "push away from the joint limits of the URDF file; joints with one axis each. The run must start "
        "between the limits",
        "none"},
       {"manipulability", "N m, N", "climb of log sqrt(det(J J*)), >= 0; joints with one axis each"}});
  const Map posture(map.at("posture"),
                    {{"stiffness", "N m/rad, N/m", ">= 0"}, {"q", "rad, m", "the posture", "`initial.q`"}});
  const Map limits(map.at("limits"),
                   {{"gain", "N m rad^3, N m^3", ">= 0"},
                    {"margin", "rad, m", "distance from a limit where the push begins, > 0"}});
  NullSpaceConfig out;
  read(map.at("damping"), out.damping, at_least_zero());
  if (map.at("posture").given())
    yaml::require_given(posture.at("stiffness"), "give the stiffness of the pull in N m/rad or N/m.");
  read(posture.at("stiffness"), out.posture_stiffness, at_least_zero());
  if (posture.at("q").given()) read(posture.at("q"), out.posture.emplace());
  if (map.at("limits").given())
    yaml::require_given(limits.at("gain"), "give the gain of the repulsion in N m rad^3 or N m^3.");
  read(limits.at("gain"), out.limit_gain, at_least_zero());
  read(limits.at("margin"), out.limit_margin, above_zero("the distance from a limit where repulsion begins"));
  read(map.at("manipulability"), out.manipulability, at_least_zero());

  if (law != Law::resolved_acceleration && law != Law::free) return out;
  const std::string name = law == Law::free ? "free" : "resolved_acceleration";
  for (const auto& [key, acts] : {std::pair{"damping", out.damping > 0},
                                  {"posture", out.posture_stiffness > 0},
                                  {"limits", out.limit_gain > 0},
                                  {"manipulability", out.manipulability > 0}})
    if (acts) fail(map.at(key), name + " has no null space: remove it, or use operational_space.");
  return out;
}

void read_impedance(const Setting& setting, ControllerConfig& out) {
  const Map map(
      setting,
      {{"inertia", "kg m^2, kg",
        "inertia that the tip shows to a wrench on it: a number or six, > 0. Stiffness and damping of "
        "`gains` are then those of the mechanical impedance"}});
  if (!setting.given()) return;
  const auto inertia = map.at("inertia");
  yaml::require_given(inertia, "give the inertia that the tip shall show, in kg m^2 and kg.");
  yaml::read_one_or_six(inertia, out.virtual_inertia.emplace(Vector6::Zero()), above_zero());
  if (out.orientation != OrientationCoordinates::rotation_vector ||
      out.position != PositionCoordinates::cartesian)
    fail(setting, "works with orientation: rotation_vector and position: cartesian: choose them.");
}

void read_force(const Setting& setting, ControllerConfig& out) {
  const Map map(setting, {{"rows", "",
                           "rows of the task whose force is controlled in place of their motion; needs "
                           "`compensate_tip_force: true`"},
                          {"desired", "N m, N",
                           "what the tip exerts on its surroundings, one number for each of these rows"},
                          {"inertia", "kg m^2, kg", "> 0"},
                          {"damping", "1/s", ">= 0"}});
  if (!setting.given()) return;
  ForceControl force;
  const auto rows = map.at("rows"), desired = map.at("desired");
  yaml::require_given(rows, "name the task rows whose force is controlled, for instance [vz].");
  yaml::require_given(desired, "give the force on the surroundings for each of controller.force.rows.");
  read_rows(rows, force.rows);
  const auto named = entries(rows, "");
  for (std::size_t i = 0; i < named.size(); ++i)
    if (std::find(out.rows.begin(), out.rows.end(), force.rows[i]) == out.rows.end())
      fail(named[i], "is not a task row here: add it to controller.rows.");
  read(desired, force.desired, {}, "a list of numbers, one for each of controller.force.rows");
  if (force.desired.size() != force.rows.size())
    fail(desired, "must have one number for each of controller.force.rows, which are " +
                      std::to_string(force.rows.size()) + ".");
  read(map.at("inertia"), force.inertia, above_zero());
  read(map.at("damping"), force.damping, at_least_zero());
  if (!out.compensate_tip_force)
    fail(setting, "needs the measured wrench on the tip: set controller.compensate_tip_force: true.");
  out.force = force;
}

std::vector<Obstacle> read_obstacles(const Setting& setting) {
  std::vector<Obstacle> out;
  if (!setting.given()) return out;
  for (const auto& entry : entries(setting, "a list of maps {centre, radius, influence, gain}")) {
    const Map map(entry, {{"centre", "m", "middle of the ball"},
                          {"radius", "m", "> 0"},
                          {"influence", "m", "distance from the surface where the push begins, > 0"},
                          {"gain", "m^4/s^2", ">= 0"}});
    yaml::require_given(map.at("centre"), "give the middle of the ball in m.");
    auto& ball = out.emplace_back();
    read(map.at("centre"), ball.centre);
    read(map.at("radius"), ball.radius, above_zero());
    read(map.at("influence"), ball.influence,
         above_zero("the distance from the surface where the field begins"));
    read(map.at("gain"), ball.gain, at_least_zero());
  }
  return out;
}

SingularityOptions read_singularity(const Setting& setting, const ControllerConfig& controller) {
  const Map map(
      setting,
      {{"policy", "",
        "`none`: the run stops; `damped`, `truncated` or `released`: what becomes of directions that "
        "the arm loses. `operational_space` without delay"},
       {"threshold", "", "of the eigenvalues of Omega, scaled to mean 1 in each block; > 0 and < 1",
        "1e-6; 1e-2 with a policy"},
       {"damping", "", "of `damped`, > 0"}});
  SingularityOptions out;
  const auto policy = map.at("policy");
  read(policy, out.policy,
       {{"none", SingularPolicy::none},
        {"damped", SingularPolicy::damped},
        {"truncated", SingularPolicy::truncated},
        {"released", SingularPolicy::released}});
  if (out.policy != SingularPolicy::none) out.threshold = 1e-2;
  read(map.at("threshold"), out.threshold,
       {.low = 0,
        .low_open = true,
        .high = 1,
        .high_open = true,
        .note = "it is a fraction of the mean eigenvalue"});
  read(map.at("damping"), out.damping, above_zero());
  const bool delayed = controller.sampling && controller.sampling->delay != Delay::none;
  if (out.policy != SingularPolicy::none && (controller.law != Law::operational_space || delayed))
    fail(policy, "only operational_space without delay has it: use policy: none.");
  return out;
}

std::optional<Sensors> read_sensors(const Setting& setting, const ControllerConfig& controller) {
  const Map map(setting,
                {{"resolution", "rad, m",
                  "joint positions are known in multiples of it, >= 0, 0: exact; joints with one axis each"},
                 {"velocity_cutoff", "Hz",
                  "velocities are differences of positions through a first-order low pass, >= 0, 0: exact"}});
  if (!setting.given()) return std::nullopt;
  Sensors out;
  read(map.at("resolution"), out.resolution, at_least_zero("0 is exact"));
  read(map.at("velocity_cutoff"), out.velocity_cutoff, at_least_zero("0 is exact"));
  if (!controller.sampling)
    fail(setting, "needs a law that samples: give controller.sampling.period, or remove it.");
  return out;
}

void read_effort_limit(const Setting& setting, ControllerConfig& out) {
  yaml::note_words(setting, {"none", "model"}, "none");
  if (!setting.given()) return;
  if (setting.value->kind == yaml::Value::Kind::list) {
    out.effort_limit = EffortLimit::list;
    read(setting, out.effort_limits, above_zero());
    return;
  }
  const bool word =
      yaml::is_scalar(setting) && (setting.value->text == "none" || setting.value->text == "model");
  if (!word) fail(setting, "must be none, model or a list of torques, one for each velocity coordinate.");
  out.effort_limit = setting.value->text == "none" ? EffortLimit::none : EffortLimit::model;
}

}  // namespace

ControllerConfig read_controller(const Setting& setting, const std::filesystem::path& directory) {
  const std::string one_or_six =
      "a number or six, >= 0; with `quaternion` the first three must be equal. With `impedance`: ";
  const Map map(
      setting,
      {{"law", "",
        "`operational_space`; `resolved_acceleration`: as many task rows as velocity coordinates; `free`: no "
        "torque; one of the laws in common use below; or a map: a law of your own"},
       {"coordinates", "", "`pose`: six task rows; `position`: vx, vy, vz"},
       {"rows", "",
        "task rows by name, for instance [vx, vy, vz]; overrides `coordinates`; at most as many as velocity "
        "coordinates",
        "from `coordinates`"},
       {"orientation", "",
        "what the law tracks of the orientation; all but the first need the rows wx, wy and wz"},
       {"position", "",
        "what it tracks of the position, about the origin and z axis of the frame in which the tip is given; "
        "all but "
        "the first need the rows vx, vy and vz"},
       {"gains", "", "of the error"},
       {"feedforward", "", "velocity and acceleration of the reference are part of u"},
       {"compensate_friction", "", "add the model's joint friction to the torque"},
       {"compensate_tip_force", "", "the law measures the wrench on the tip and takes it into account"},
       {"sampling", "",
        "without it the law acts at every instant; with it at t = 0, period, 2 period, ..., and the torque "
        "is held in "
        "between",
        "none"},
       {"null_space", "",
        "T0, of which the law lets through what the tip does not see; redundant arms; not for "
        "`resolved_acceleration` "
        "and `free`"},
       {"impedance", "", "impedance control; only with `rotation_vector` and `cartesian`", "none"},
       {"force", "", "force control", "none"},
       {"obstacles", "",
        "a list of balls that the tip point is pushed away from; needs the rows vx, vy and vz", "[]"},
       {"singularity", "", "what happens where the arm loses directions"},
       {"sensors", "", "what the law knows of the joints; needs `sampling`", "none"},
       {"effort_limit", "N m, N",
        "torques saturate: `none`; `model`: at the `<limit effort>` of the URDF file, which every joint must "
        "have; or "
        "a list, one for each velocity coordinate, > 0"}});
  const Map gains(map.at("gains"), {{"stiffness", "1/s^2", one_or_six + "N m/rad and N/m"},
                                    {"damping", "1/s", one_or_six + "N m s/rad and N s/m"}});
  ControllerConfig out;
  read_law(map.at("law"), directory, out);
  const std::vector<int> pose{0, 1, 2, 3, 4, 5}, position{3, 4, 5};
  read(map.at("coordinates"), out.rows, {{"pose", pose}, {"position", position}});
  read_rows(map.at("rows"), out.rows);
  yaml::read_one_or_six(gains.at("stiffness"), out.stiffness, at_least_zero());
  yaml::read_one_or_six(gains.at("damping"), out.damping, at_least_zero());
  out.null_space = read_null_space(map.at("null_space"), out.law);
  read(map.at("feedforward"), out.feedforward);
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
  read_impedance(map.at("impedance"), out);
  read_force(map.at("force"), out);
  out.obstacles = read_obstacles(map.at("obstacles"));
  out.sampling = read_sampling(map.at("sampling"), out.law);
  out.singularity = read_singularity(map.at("singularity"), out);
  out.sensors = read_sensors(map.at("sensors"), out);
  read_effort_limit(map.at("effort_limit"), out);
  if (out.law == Law::free)
    for (const auto& [key, acts] : {std::pair{"impedance", out.virtual_inertia.has_value()},
                                    {"force", out.force.has_value()},
                                    {"obstacles", !out.obstacles.empty()},
                                    {"effort_limit", out.effort_limit != EffortLimit::none}})
      if (acts) fail(map.at(key), "a free swing has no torque to shape: remove it.");
  return out;
}

}  // namespace osculate
