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

/// Change of the normal where the point moves by dp.
Vector3<double> normal_slope(const Plane&, const Touch&, const Vector3<double>&) {
  return Vector3<double>::Zero();
}
Vector3<double> normal_slope(const Ball& ball, const Touch& at, const Vector3<double>& dp) {
  const double distance = at.gap + ball.radius;
  if (!(distance > 0)) return Vector3<double>::Zero();
  return (dp - at.normal.dot(dp) * at.normal) / distance;
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

TouchSlope touch_slope(const Environment& environment, const Touch& at, const Vector3<double>& v,
                       bool in_contact, const Vector3<double>& dp, const Vector3<double>& dv) {
  const double k = environment.stiffness, c = environment.damping;
  const Vector3<double> dnormal =
      std::visit([&](const auto& surface) { return normal_slope(surface, at, dp); }, environment.surface);
  const double dgap = at.normal.dot(dp);
  const double dentry = -dnormal.dot(v) - at.normal.dot(dv);
  TouchSlope out;
  if (!in_contact) {
    if (at.gap < 0) out.lost_power = k * (dgap * at.entry + at.gap * dentry);
    return out;
  }
  const double dpressure = c * dentry - k * dgap;
  const Vector3<double> slip = slip_velocity(at, v);
  const Vector3<double> dslip = dv + dentry * at.normal + at.entry * dnormal;
  const double speed = slip.norm();
  // rate = friction pressure g / v_s with g = tanh(x) / x, x = speed / v_s, and x g' = 1 - tanh^2 - g
  const double x = speed / environment.v_s, step = std::tanh(x);
  const double xg_slope = x > 0 ? 1 - step * step - step / x : 0.0;
  const double rate = friction_rate(environment, at.pressure, speed);
  double drate = friction_rate(environment, dpressure, speed);
  if (x > 0)
    drate +=
        environment.friction * at.pressure / environment.v_s * xg_slope * ((slip / speed).dot(dslip) / speed);
  out.force = dpressure * at.normal + at.pressure * dnormal - drate * slip - rate * dslip;
  out.lost_power = 2 * c * at.entry * dentry + drate * speed * speed + 2 * rate * slip.dot(dslip);
  return out;
}

}  // namespace osculate
