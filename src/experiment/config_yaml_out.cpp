#include <charconv>
#include <cmath>
#include <sstream>

#include "experiment/config.hpp"

namespace osculate {
namespace {

/// The shortest decimal that reads back to the same bits. YAML 1.1 readers take 1e-10 for a text and -0 for
/// an integer without sign, so both get a point.
std::string number(double x) {
  char buffer[32];
  std::string out{buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr};
  const auto e = out.find('e');
  if (e != std::string::npos && out.find('.') == std::string::npos) out.insert(e, ".0");
  if (x == 0 && std::signbit(x)) out = "-0.0";
  return out;
}

/// A text in double quotes, as YAML and JSON escape it.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      const char* digits = "0123456789abcdef";
      out += std::string("\\x") + digits[(c >> 4) & 15] + digits[c & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
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

std::string law(Law law) {
  switch (law) {
    case Law::operational_space:
      return "operational_space";
    case Law::resolved_acceleration:
      return "resolved_acceleration";
    case Law::free:
      return "free";
  }
  return "";
}

std::string sampling(const Sampling& s) {
  const char* delays[] = {"none", "velocity", "force", "both"};
  return "{period: " + number(s.period) + ", delay: " + delays[static_cast<int>(s.delay)] +
         ", extrapolate: " + (s.extrapolate ? "true" : "false") +
         ", monitor_every: " + std::to_string(s.monitor_every) + "}";
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
};

std::string record(const VerifyConfig& verify) {
  if (verify.record == VerifyConfig::Record::all) return "all";
  if (verify.record == VerifyConfig::Record::worst) return "worst";
  return std::to_string(verify.record_every);
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
  out << "  mass_scale: " << number(p.mass_scale) << "\n"
      << "  tip_force: " << numbers<6>(p.tip_force) << "\n";

  out << "initial:\n"
      << "  q: " << numbers(x.q) << "\n"
      << "  qd: " << numbers(x.qd) << "\n"
      << "reference:\n"
      << std::visit(WriteReference{}, x.reference);
  if (x.base_motion) out << "base_motion:\n" << std::visit(WriteReference{}, *x.base_motion);

  const auto& c = x.controller;
  out << "controller:\n"
      << "  law: " << law(c.law) << "\n"
      << "  rows: " << list(c.rows, [](int row) { return std::string(task_row_names.at(row)); }) << "\n"
      << "  gains:\n"
      << "    stiffness: " << numbers<6>(c.stiffness) << "\n"
      << "    damping: " << numbers<6>(c.damping) << "\n"
      << "  null_space:\n"
      << "    damping: " << number(c.null_space_damping) << "\n"
      << "  compensate_friction: " << (c.compensate_friction ? "true" : "false") << "\n"
      << "  compensate_tip_force: " << (c.compensate_tip_force ? "true" : "false") << "\n"
      << "  orientation: " << name(c.orientation) << "\n"
      << "  position: " << name(c.position) << "\n";
  if (c.sampling) out << "  sampling: " << sampling(*c.sampling) << "\n";

  const auto& i = x.integrator;
  out << "integrator:\n"
      << "  method: " << (i.method == Method::adams ? "adams" : "bdf") << "\n"
      << "  rtol: " << number(i.rtol) << "\n"
      << "  atol: {position: " << number(i.atol_position) << ", velocity: " << number(i.atol_velocity)
      << "}\n"
      << "  max_step: " << number(i.max_step) << "\n"
      << "  max_steps: " << std::to_string(i.max_steps) << "\n";

  out << "duration: " << number(x.duration) << "\n"
      << "output:\n"
      << "  interval: " << number(x.output.interval) << "\n"
      << "verify:\n"
      << "  every: " << std::to_string(x.verify.every) << "\n"
      << "  record: " << record(x.verify) << "\n"
      << "  shadow: " << (x.verify.shadow ? "true" : "false") << "\n"
      << "expect:\n"
      << "  stop: " << quoted(x.expect.stop) << "\n"
      << "  fails: " << list(x.expect.fails, [](const std::string& id) { return id; }) << "\n";
  return out.str();
}

}  // namespace osculate
