#include "control/obstacles.hpp"

#include <stdexcept>
#include <string>

namespace osculate {

double distance(const Obstacle& obstacle, const Vector3<double>& p) {
  return (p - obstacle.centre).norm() - obstacle.radius;
}

Vector3<double> repulsion(const std::vector<Obstacle>& obstacles, const Vector3<double>& p) {
  Vector3<double> out = Vector3<double>::Zero();
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const Obstacle& obstacle = obstacles[i];
    const double d = distance(obstacle, p), d0 = obstacle.influence;
    if (!(d > 0))
      throw std::domain_error("the tip point is at or inside obstacles[" + std::to_string(i) +
                              "], where the field has no value");
    if (d >= d0) continue;
    const Vector3<double> away = (p - obstacle.centre).normalized();
    out += obstacle.gain * (1 / d - 1 / d0) / (d * d) * away;
  }
  return out;
}

}  // namespace osculate
