#include "simulation/contact.hpp"

#include <cmath>

#include "scalar/fault.hpp"

namespace osculate {

namespace {

/// Sets gap and normal.
void approach(const Plane& plane, const Vector3<double>& p, Touch& out) {
  out.normal = plane.normal.stableNormalized();
  out.gap = out.normal.dot(p - plane.point);
}

void approach(const Ball& ball, const Vector3<double>& p, Touch& out) {
  const Vector3<double> offset = p - ball.centre;
  const double distance = offset.norm();
  if (distance > 0) out.normal = offset / distance;
  out.gap = distance - ball.radius;
}

/// Velocity along the surface, m/s.
Vector3<double> slip_velocity(const Touch& at, const Vector3<double>& v) { return v + at.entry * at.normal; }

/// Friction divided by the slip, N s/m: friction pressure tanh(slip / v_s) / slip, which tends to
/// friction pressure / v_s.
double friction_rate(const Environment& environment, double pressure, double slip) {
  const double x = slip / environment.v_s;
  const double tanh_over_x = x > 0 ? std::tanh(x) / x : 1.0;
  return environment.friction * pressure / environment.v_s * tanh_over_x;
}

}  // namespace

Touch touch(const Environment& environment, const Vector3<double>& p, const Vector3<double>& v,
            bool in_contact) {
  Touch out;
  std::visit([&](const auto& surface) { approach(surface, p, out); }, environment.surface);
  out.entry = -out.normal.dot(v);
  const double damping_force = environment.damping * out.entry;
  out.pressure = -environment.stiffness * out.gap + seeded(Fault::contact_damping, damping_force);
  if (!in_contact) return out;
  const Vector3<double> slip = slip_velocity(out, v);
  const Vector3<double> normal_force = out.pressure * out.normal;
  const Vector3<double> friction_force = -friction_rate(environment, out.pressure, slip.norm()) * slip;
  out.wrench.tail<3>() =
      seeded(Fault::contact_normal, normal_force) + seeded(Fault::contact_friction, friction_force);
  return out;
}

double stored_energy(const Environment& environment, const Touch& at, bool in_contact) {
  return in_contact || at.gap < 0 ? environment.stiffness * at.gap * at.gap / 2 : 0.0;
}

double lost_power(const Environment& environment, const Touch& at, const Vector3<double>& v,
                  bool in_contact) {
  if (!in_contact) return at.gap < 0 ? environment.stiffness * at.gap * at.entry : 0.0;
  const double slip = slip_velocity(at, v).norm();
  const double pressure = environment.damping * at.entry - environment.stiffness * at.gap;
  return environment.damping * at.entry * at.entry + friction_rate(environment, pressure, slip) * slip * slip;
}

}  // namespace osculate
