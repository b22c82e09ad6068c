#include <cmath>
#include <sstream>

#include "experiment/config.hpp"
#include "experiment/yaml_reader.hpp"
#include "input/number_text.hpp"

namespace osculate {
namespace {

using yaml::quoted;

/// The shortest decimal that reads back to the same bits. YAML 1.1 readers take 1e-10 for a text and -0 for
/// an integer without sign, so both get a point.
std::string number(double x) {
  std::string out = number_text(x);
  const auto e = out.find('e');
  if (e != std::string::npos && out.find('.') == std::string::npos) out.insert(e, ".0");
  if (x == 0 && std::signbit(x)) out = "-0.0";
  return out;
}

template <class Items, class Write>
std::string list(const Items& items, Write write) {
  std::string out;
  for (const auto& item : items) out += (out.empty() ? "" : ", ") + write(item);
  return "[" + out + "]";
}
std::string numbers(const std::vector<double>& x) { return list(x, number); }
template <int n>
std::string numbers(const Eigen::Matrix<double, n, 1>& x) {
  return numbers(std::vector<double>(x.data(), x.data() + n));
}

std::string friction(const std::vector<JointFriction>& joints) {
  if (joints.empty()) return "{}";
  const auto part = [&](double JointFriction::*p) {
    return list(joints, [p](const JointFriction& joint) { return number(joint.*p); });
  };
  return "{viscous: " + part(&JointFriction::viscous) +
         ", coulomb_positive: " + part(&JointFriction::coulomb_positive) +
         ", coulomb_negative: " + part(&JointFriction::coulomb_negative) +
         ", v_s: " + part(&JointFriction::v_s) + "}";
}

std::string truth(bool x) { return x ? "true" : "false"; }
std::string row(int i) { return task_row_names.at(static_cast<std::size_t>(i)); }

std::string user_law(const UserLawOptions& law) {
  return (law.plugin.empty() ? "{process: " + list(law.process, quoted) : "{plugin: " + quoted(law.plugin)) +
         ", directory: " + quoted(law.directory) +
         (law.options.empty() ? "" : ", options: " + quoted(law.options)) + ", terms: " + truth(law.terms) +
         ", time_limit: " + number(law.time_limit) + ", start_limit: " + number(law.start_limit) + "}";
}

std::string law(const ControllerConfig& c) {
  switch (c.law) {
    case Law::user:
      return user_law(c.user);
    case Law::operational_space:
      return "operational_space";
    case Law::resolved_acceleration:
      return "resolved_acceleration";
    case Law::textbook:
      for (const auto& info : textbook_laws())
        if (info.law == c.textbook) return std::string(info.name);
      break;
    case Law::free:
      return "free";
  }
  return "";
}

std::string environment(const Environment& e) {
  std::string out = "{type: ";
  if (const auto* plane = std::get_if<Plane>(&e.surface))
    out += "plane, point: " + numbers<3>(plane->point) + ", normal: " + numbers<3>(plane->normal);
  if (const auto* ball = std::get_if<Ball>(&e.surface))
    out += "ball, centre: " + numbers<3>(ball->centre) + ", radius: " + number(ball->radius);
  return out + ", stiffness: " + number(e.stiffness) + ", damping: " + number(e.damping) +
         ", friction: " + number(e.friction) + ", v_s: " + number(e.v_s) + "}";
}

std::string null_space(const NullSpaceConfig& n) {
  std::string out = "    damping: " + number(n.damping) + "\n";
  if (n.posture || n.posture_stiffness != 0)
    out += "    posture: {stiffness: " + number(n.posture_stiffness) +
           (n.posture ? ", q: " + numbers(*n.posture) : "") + "}\n";
  return out + "    limits: {gain: " + number(n.limit_gain) + ", margin: " + number(n.limit_margin) + "}\n" +
         "    manipulability: " + number(n.manipulability) + "\n";
}

std::string force(const ForceControl& f) {
  return "{rows: " + list(f.rows, row) + ", desired: " + numbers(f.desired) +
         ", inertia: " + number(f.inertia) + ", damping: " + number(f.damping) + "}";
}

std::string obstacle(const Obstacle& o) {
  return "{centre: " + numbers<3>(o.centre) + ", radius: " + number(o.radius) +
         ", influence: " + number(o.influence) + ", gain: " + number(o.gain) + "}";
}

std::string singularity(const SingularityOptions& s) {
  const char* policies[] = {"none", "damped", "truncated", "released"};
  return "{policy: " + std::string(policies[static_cast<int>(s.policy)]) +
         ", threshold: " + number(s.threshold) + ", damping: " + number(s.damping) + "}";
}

std::string effort_limit(const ControllerConfig& c) {
  if (c.effort_limit == EffortLimit::none) return "none";
  return c.effort_limit == EffortLimit::model ? "model" : numbers(c.effort_limits);
}

std::string sampling(const Sampling& s) {
  const char* delays[] = {"none", "velocity", "force", "both"};
  return "{period: " + number(s.period) + ", delay: " + delays[static_cast<int>(s.delay)] +
         ", extrapolate: " + truth(s.extrapolate) + ", monitor_every: " + std::to_string(s.monitor_every) +
         ", computation_time: " + number(s.computation_time) + "}";
}

struct WriteReference {
  std::string operator()(const HoldOptions&) const { return "  type: hold\n"; }
  std::string operator()(const StepOptions& o) const {
    return "  type: step\n  offset: " + numbers<6>(o.offset) + "\n  at: " + number(o.at) + "\n";
  }
  std::string operator()(const LineOptions& o) const {
    return "  type: line\n  offset: " + numbers<6>(o.offset) + "\n  start: " + number(o.start) +
           "\n  duration: " + number(o.duration) + "\n";
  }
  std::string operator()(const CircleOptions& o) const {
    return "  type: circle\n  radius: " + number(o.radius) + "\n  period: " + number(o.period) +
           "\n  plane: " + o.plane + "\n";
  }
  std::string operator()(const LissajousOptions& o) const {
    return "  type: lissajous\n  amplitude: " + numbers<6>(o.amplitude) +
           "\n  period: " + numbers<6>(o.period) + "\n  phase: " + numbers<6>(o.phase) + "\n";
  }
  std::string operator()(const WaypointsOptions& o) const {
    return "  type: waypoints\n  file: " + quoted(o.file.string()) + "\n";
  }
  std::string operator()(const EachAxisOptions& o) const {
    return "  type: each_axis\n  amplitude: " + numbers<6>(o.amplitude) + "\n  period: " + number(o.period) +
           "\n";
  }
  std::string operator()(const MultisineOptions& o) const {
    return "  type: multisine\n  row: " + row(o.row) + "\n  amplitude: " + number(o.amplitude) +
           "\n  frequencies: " + numbers(o.frequencies) + "\n";
  }
};

std::string record(const VerifyConfig& verify) {
  if (verify.record == VerifyConfig::Record::all) return "all";
  if (verify.record == VerifyConfig::Record::worst) return "worst";
  return std::to_string(verify.record_every);
}

std::string sweep(const SweepConfig& s) {
  const auto split = [](const std::string& text) {
    const auto equals = text.find('=');
    return std::pair{text.substr(0, equals), text.substr(equals + 1)};
  };
  std::string out = "sweep:\n";
  if (!s.key.empty()) {
    const auto value = [&](const SweepConfig::Variant& v) { return split(v.overrides.at(0)).second; };
    return out + "  key: " + quoted(s.key) + "\n  values: " + list(s.variants, value) + "\n";
  }
  const auto change = [&](const std::string& text) {
    const auto [key, value] = split(text);
    return quoted(key) + ": " + value;
  };
  out += "  variants:\n";
  for (const auto& v : s.variants) {
    const auto changes = list(v.overrides, change);
    out += "    " + quoted(v.name) + ": {" + changes.substr(1, changes.size() - 2) + "}\n";
  }
  return out;
}

}  // namespace

std::string to_yaml(const Experiment& x) {
  std::ostringstream out;
  const auto& m = x.model;
  out << "name: " << quoted(x.name) << "\n"
      << "model:\n"
      << "  urdf: " << quoted(m.urdf.string()) << "\n"
      << "  base: " << quoted(m.choice.base) << "\n"
      << "  tip: " << quoted(m.choice.tip) << "\n"
      << "  gravity: " << numbers<3>(m.choice.gravity) << "\n"
      << "  side_branches: " << (m.choice.side_branches == SideBranches::lump ? "lump" : "drop") << "\n"
      << "  armature: " << numbers(m.armature) << "\n"
      << "  friction: " << friction(m.friction) << "\n";

  const auto& p = x.plant;
  out << "plant:\n"
      << "  payload:\n"
      << "    mass: " << number(p.payload.mass) << "\n"
      << "    com: " << numbers<3>(p.payload.com) << "\n"
      << "    inertia:\n";
  for (int i = 0; i < 3; ++i)
    out << "      - " << numbers<3>(Vector3<double>(p.payload.inertia.row(i).transpose())) << "\n";
  if (p.armature) out << "  armature: " << numbers(*p.armature) << "\n";
  if (p.friction) out << "  friction: " << friction(*p.friction) << "\n";
  out << "  mass_scale: " << (p.link_mass_scale.empty() ? number(p.mass_scale) : numbers(p.link_mass_scale))
      << "\n"
      << "  inertia_scale: " << number(p.inertia_scale) << "\n"
      << "  tip_force: " << numbers<6>(p.tip_force) << "\n";
  if (p.environment) out << "  environment: " << environment(*p.environment) << "\n";
  out << "  dynamics: " << (p.dynamics == PlantDynamics::recursive ? "recursive" : "dense") << "\n"
      << "  share_kinematics: " << truth(p.share_kinematics) << "\n";

  out << "initial:\n"
      << "  q: " << numbers(x.q) << "\n"
      << "  qd: " << numbers(x.qd) << "\n"
      << "reference:\n"
      << std::visit(WriteReference{}, x.reference);
  if (x.base_motion) out << "base_motion:\n" << std::visit(WriteReference{}, *x.base_motion);

  const auto& c = x.controller;
  out << "controller:\n"
      << "  law: " << law(c) << "\n"
      << "  rows: " << list(c.rows, row) << "\n"
      << "  gains:\n"
      << "    stiffness: " << numbers<6>(c.stiffness) << "\n"
      << "    damping: " << numbers<6>(c.damping) << "\n"
      << "  null_space:\n"
      << null_space(c.null_space) << "  feedforward: " << truth(c.feedforward) << "\n"
      << "  compensate_friction: " << truth(c.compensate_friction) << "\n"
      << "  compensate_tip_force: " << truth(c.compensate_tip_force) << "\n"
      << "  orientation: " << name(c.orientation) << "\n"
      << "  position: " << name(c.position) << "\n";
  if (c.virtual_inertia) out << "  impedance: {inertia: " << numbers<6>(*c.virtual_inertia) << "}\n";
  if (c.force) out << "  force: " << force(*c.force) << "\n";
  out << "  obstacles: " << list(c.obstacles, obstacle) << "\n"
      << "  singularity: " << singularity(c.singularity) << "\n";
  if (c.sampling) out << "  sampling: " << sampling(*c.sampling) << "\n";
  if (c.sensors)
    out << "  sensors: {resolution: " << number(c.sensors->resolution)
        << ", velocity_cutoff: " << number(c.sensors->velocity_cutoff) << "}\n";
  out << "  effort_limit: " << effort_limit(c) << "\n";

  const auto& i = x.integrator;
  const char* methods[] = {"adams", "bdf", "runge_kutta"};
  const char* jacobians[] = {"automatic", "differences"};
  out << "integrator:\n"
      << "  method: " << methods[static_cast<int>(i.method)] << "\n"
      << "  rtol: " << number(i.rtol) << "\n"
      << "  atol: {position: " << number(i.atol_position) << ", velocity: " << number(i.atol_velocity)
      << "}\n"
      << "  max_step: " << number(i.max_step) << "\n"
      << "  max_steps: " << std::to_string(i.max_steps) << "\n"
      << "  jacobian: " << jacobians[static_cast<int>(i.jacobian)] << "\n";

  out << "duration: " << number(x.duration) << "\n"
      << "output:\n"
      << "  interval: " << number(x.output.interval) << "\n"
      << "  restart_interval: " << number(x.output.restart_interval) << "\n"
      << "verify:\n"
      << "  every: " << std::to_string(x.verify.every) << "\n"
      << "  record: " << record(x.verify) << "\n"
      << "  shadow: " << truth(x.verify.shadow) << "\n"
      << "  poles: " << truth(x.verify.poles) << "\n"
      << "expect:\n"
      << "  stop: " << quoted(x.expect.stop) << "\n"
      << "  fails: " << list(x.expect.fails, [](const std::string& id) { return id; }) << "\n";
  if (!x.sweep.variants.empty()) out << sweep(x.sweep);
  return out.str();
}

}  // namespace osculate
