// Rigid bodies and placements: what lumping needs, and the checks on a body's numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/chain.hpp"

namespace osculate::internal {

/// Where a frame stands in another: x_outer = R x_inner + p, p in m.
struct Placement {
  Matrix3<double> R = Matrix3<double>::Identity();
  Vector3<double> p = Vector3<double>::Zero();
};

/// a then b: the pose of b's inner frame in a's outer frame.
Placement operator*(const Placement& a, const Placement& b);

/// Mass (kg), centre of mass (m) and inertia about it (kg m^2), all in one frame.
struct RigidBody {
  double mass = 0;
  Vector3<double> com = Vector3<double>::Zero();
  Matrix3<double> inertia = Matrix3<double>::Zero();
};

/// The same body, given in the frame in which its own frame has the pose `at`.
RigidBody placed(const Placement& at, const RigidBody& body);

/// The bodies, all in one frame, glued together: mass, first and second moments are conserved (parallel axis
/// theorem). A single body comes back bit by bit. Where no body has mass the centre of mass is that of the
/// first one.
RigidBody lump(const std::vector<RigidBody>& bodies);

/// Why no calculation can use this body (negative mass, inertia not positive semidefinite, not finite), or
/// nothing.
std::optional<std::string> body_fault(const RigidBody& body);

/// Why no rigid body has this inertia (triangle inequality of the principal values), or nothing. Published
/// data does it.
std::optional<std::string> triangle_fault(const RigidBody& body);

/// As number_text, rounded to six significant digits.
std::string short_number(double x);

}  // namespace osculate::internal
