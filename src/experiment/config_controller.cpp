// The section `controller`.
#include <algorithm>
#include <tuple>

#include "experiment/config_sections.hpp"

namespace osculate {
namespace {

using yaml::above_zero;
using yaml::at_least_zero;
using yaml::entries;
using yaml::fail;
using yaml::fail_missing;
using yaml::Map;
using yaml::read;
using yaml::Setting;

void read_law(const Setting& setting, ControllerConfig& out) {
  if (!setting.given()) fail_missing(setting, "give operational_space, resolved_acceleration or free.");
  using Choice = std::pair<Law, TextbookLaw>;
  std::vector<std::pair<std::string, Choice>> choices{
      {"operational_space", {Law::operational_space, out.textbook}},
      {"resolved_acceleration", {Law::resolved_acceleration, out.textbook}},
      {"free", {Law::free, out.textbook}}};
  for (const auto& info : textbook_laws()) choices.emplace_back(info.name, Choice{Law::textbook, info.law});
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
  const Map map(setting, {"period", "delay", "extrapolate", "monitor_every", "computation_time"});
  Sampling out;
  if (law == Law::free) fail(setting, "a free swing has nothing to sample: remove it.");
  if (!map.at("period").given()) fail_missing(map.at("period"), "give the time between samples in s.");
  read(map.at("period"), out.period, above_zero("leave sampling out for a law that acts at every instant"));
  const auto delay = map.at("delay"), line = map.at("extrapolate"), monitor = map.at("monitor_every"),
             computation = map.at("computation_time");
  read(
      delay, out.delay,
      {{"none", Delay::none}, {"velocity", Delay::velocity}, {"force", Delay::force}, {"both", Delay::both}});
  read(line, out.extrapolate);
  read(monitor, out.monitor_every, 1);
  read(computation, out.computation_time,
       {.low = 0, .high = out.period, .high_open = true, .note = "it must end before the next sample"});
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
  const Map map(setting, {"damping", "posture", "limits", "manipulability"});
  const Map posture(map.at("posture"), {"stiffness", "q"}), limits(map.at("limits"), {"gain", "margin"});
  NullSpaceConfig out;
  read(map.at("damping"), out.damping, at_least_zero());
  if (map.at("posture").given() && !posture.at("stiffness").given())
    fail_missing(posture.at("stiffness"), "give the stiffness of the pull in N m/rad or N/m.");
  read(posture.at("stiffness"), out.posture_stiffness, at_least_zero());
  if (posture.at("q").given()) read(posture.at("q"), out.posture.emplace());
  if (map.at("limits").given() && !limits.at("gain").given())
    fail_missing(limits.at("gain"), "give the gain of the repulsion in N m rad^3 or N m^3.");
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
  const Map map(setting, {"inertia"});
  if (!setting.given()) return;
  const auto inertia = map.at("inertia");
  if (!inertia.given()) fail_missing(inertia, "give the inertia that the tip shall show, in kg m^2 and kg.");
  yaml::read_one_or_six(inertia, out.virtual_inertia.emplace(), above_zero());
  if (out.orientation != OrientationCoordinates::rotation_vector ||
      out.position != PositionCoordinates::cartesian)
    fail(setting, "works with orientation: rotation_vector and position: cartesian: choose them.");
}

void read_force(const Setting& setting, ControllerConfig& out) {
  const Map map(setting, {"rows", "desired", "inertia", "damping"});
  if (!setting.given()) return;
  ForceControl force;
  const auto rows = map.at("rows"), desired = map.at("desired");
  if (!rows.given()) fail_missing(rows, "name the task rows whose force is controlled, for instance [vz].");
  if (!desired.given())
    fail_missing(desired, "give the force on the surroundings for each of controller.force.rows.");
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
    const Map map(entry, {"centre", "radius", "influence", "gain"});
    if (!map.at("centre").given()) fail_missing(map.at("centre"), "give the middle of the ball in m.");
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
  const Map map(setting, {"policy", "threshold", "damping"});
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
  const Map map(setting, {"resolution", "velocity_cutoff"});
  if (!setting.given()) return std::nullopt;
  Sensors out;
  read(map.at("resolution"), out.resolution, at_least_zero("0 is exact"));
  read(map.at("velocity_cutoff"), out.velocity_cutoff, at_least_zero("0 is exact"));
  if (!controller.sampling)
    fail(setting, "needs a law that samples: give controller.sampling.period, or remove it.");
  return out;
}

void read_effort_limit(const Setting& setting, ControllerConfig& out) {
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

ControllerConfig read_controller(const Setting& setting) {
  const Map map(setting, {"law", "coordinates", "rows", "orientation", "position", "gains", "feedforward",
                          "null_space", "compensate_friction", "compensate_tip_force", "impedance", "force",
                          "obstacles", "singularity", "sampling", "sensors", "effort_limit"});
  const Map gains(map.at("gains"), {"stiffness", "damping"});
  ControllerConfig out;
  read_law(map.at("law"), out);
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
