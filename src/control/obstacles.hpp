// Artificial potential fields that keep the tip point off obstacles (Khatib 1986, section on the FIRAS
// function).
#pragma once

#include <vector>

#include "control/reference.hpp"

namespace osculate {

/// A ball that the tip point must not enter.
struct Obstacle {
  Vector3<double> centre = Vector3<double>::Zero();  // m, inertial frame
  double radius = 0.1;                               // m, > 0
  double influence = 0.1;  // m, > 0: distance from the surface where the field begins
  double gain = 0.01;      // m^4/s^2, >= 0
  bool operator==(const Obstacle&) const = default;
};

/// Distance of p from the surface, m; < 0 inside.
double distance(const Obstacle& obstacle, const Vector3<double>& p);

/// Acceleration of a unit mass at p by the fields, m/s^2: the negative gradient of the sum over the obstacles
/// nearer than their influence d0 of gain/2 (1/d - 1/d0)^2. Throws std::domain_error at or inside an
/// obstacle.
Vector3<double> repulsion(const std::vector<Obstacle>& obstacles, const Vector3<double>& p);

}  // namespace osculate
