// A compliant surface that the tip may touch: normal force stiffness x depth + damping x speed, never
// pulling, and smoothed Coulomb friction.
#pragma once

#include <variant>

#include "control/reference.hpp"

namespace osculate {

struct Plane {
  Vector3<double> point = Vector3<double>::Zero();    // m, any point of it; inertial frame
  Vector3<double> normal = Vector3<double>::UnitZ();  // out of the material; of any length but 0
  bool operator==(const Plane&) const = default;
};
struct Ball {
  Vector3<double> centre = Vector3<double>::Zero();  // m, inertial frame
  double radius = 0.1;                               // m, > 0; the material is inside
  bool operator==(const Ball&) const = default;
};

struct Environment {
  std::variant<Plane, Ball> surface;
  double stiffness = 1e4;  // N/m, > 0
  double damping = 0;      // N s/m, >= 0
  double friction = 0;     // Coulomb coefficient, >= 0; 0: frictionless
  double v_s = 1e-3;       // m/s, > 0: friction is smoothed, friction x normal force x tanh(slip / v_s)
  bool operator==(const Environment&) const = default;
};

/// The tip point at the surface.
struct Touch {
  double gap = 0;                                     // m, < 0 inside the material; depth is -gap
  double entry = 0;                                   // m/s, speed into the material
  double pressure = 0;                                // N, stiffness x depth + damping x speed of entry
  Vector3<double> normal = Vector3<double>::UnitZ();  // unit, out of the material
  Vector6 wrench = Vector6::Zero();                   // N m, N: on the tip, about the tip point
};

/// p, v: position and velocity of the tip point in the inertial frame. The wrench is zero unless
/// `in_contact`; whether the tip is in contact is a mode that only changes at events, so that the wrench is
/// smooth in between. The two event functions of a contact are `gap` and `pressure`: both are smooth inside
/// and outside the material, whatever the mode. At the centre of a ball the normal is the z axis.
Touch touch(const Environment& environment, const Vector3<double>& p, const Vector3<double>& v,
            bool in_contact);

/// The mode at a state: the tip is in contact where it is inside the material and the surface pushes, or at
/// the surface and does not leave.
inline bool touches(const Touch& at) { return at.gap < 0 ? at.pressure > 0 : at.gap == 0 && at.entry >= 0; }

/// Energy stored in the surface, J: stiffness depth^2 / 2 in contact, and while the tip is still inside the
/// material of a surface that no longer pushes; else 0. It does not jump where the mode changes.
double stored_energy(const Environment& environment, const Touch& at, bool in_contact);

/// Power lost in the surface, W, >= 0: damping and friction in contact; where the tip leaves faster than the
/// surface can follow, what the surface had stored. In every mode
/// d(stored_energy)/dt + lost_power + wrench . velocity = 0. v: m/s, of the tip point, inertial frame.
double lost_power(const Environment& environment, const Touch& at, const Vector3<double>& v, bool in_contact);

/// The derivatives of a touch along a change of its point's position and velocity.
struct TouchSlope {
  Vector3<double> force = Vector3<double>::Zero();  // N, of the wrench; it has no moment
  double lost_power = 0;                            // W
};
/// dp, dv: change of position and velocity of the tip point, whose touch is `at` and velocity v. In a fixed
/// mode.
TouchSlope touch_slope(const Environment& environment, const Touch& at, const Vector3<double>& v,
                       bool in_contact, const Vector3<double>& dp, const Vector3<double>& dv);

}  // namespace osculate
