// The true arm by the definitions: qdd = M^-1 (T - C - G + J* F_ext) (6) with the dense M, C, G, J. O(n^3).
// A plant that shares no line with the recursions of its controller.
#pragma once

#include "recursion/sweeps.hpp"
#include "reference/dense.hpp"

namespace osculate {

/// The calls of BasicForwardDynamics. Inertial frame, about the tip point; joint lists base to tip.
/// Allocates.
class DensePlant {
 public:
  explicit DensePlant(const Chain<double>& chain) : chain_(chain) {}

  void place(const std::vector<JointPosition<double>>& joints) { joints_ = joints; }
  void move_base(const BaseMotion<double>& base) { base_ = base; }
  void move(std::span<const double> qd);
  void accelerations(std::span<const double> T, const Vec<Force, double>& F_ext, std::span<double> qdd);

  Vec<Motion, double> tip_velocity() const;
  Vec<Motion, double> tip_acceleration() const;
  Mat3<double> tip_rotation() const;
  Vec3<double> tip_position() const;
  double kinetic_energy(std::span<const double> qd) const;
  double potential_energy() const;

 private:
  Chain<double> chain_;
  std::vector<JointPosition<double>> joints_;
  BaseMotion<double> base_;
  VectorX<double> qd_, qdd_;
  dense::State<double> at_;
};

}  // namespace osculate
