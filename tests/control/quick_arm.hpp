// Random arms over doubles alone: model/random_arm.hpp brings exact fractions, which are slow to compile.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "model/chain.hpp"
#include "model/pose.hpp"

namespace osculate::test {

/// Uniform numbers, the same with every library.
struct Draw {
  std::mt19937 bits;
  explicit Draw(unsigned seed) : bits(seed) {}

  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits()) * 0x1p-32);
  }
  VectorX<double> vector(Eigen::Index n, double range) {
    VectorX<double> out(n);
    for (double& x : out) x = (*this)(-range, range);
    return out;
  }
  Vector3<double> direction() {
    const double z = (*this)(-1, 1), angle = (*this)(-std::numbers::pi, std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  Matrix3<double> turn() {
    const double angle = (*this)(-std::numbers::pi, std::numbers::pi);
    return rotation<double>(direction(), std::cos(angle), std::sin(angle));
  }
};

struct QuickArm {
  Chain<double> chain;
  VectorX<double> q, qd;
  std::vector<JointPosition<double>> positions;
  std::string name;

  void place() {
    positions = osculate::positions<double>(chain, {q.data(), static_cast<std::size_t>(q.size())});
  }
};

/// n joints, every third of which slides; axes and offsets in any direction, motors on every fourth.
inline QuickArm quick_arm(unsigned seed, int n) {
  Draw draw(1000 * seed + static_cast<unsigned>(n));
  QuickArm arm;
  arm.name = "quick_arm(" + std::to_string(seed) + ", " + std::to_string(n) + ")";
  for (int i = 0; i < n; ++i) {
    Link<double> link;
    if (i % 3 == 2) link.type = JointType::prismatic;
    link.R_origin = draw.turn();
    link.p_origin = draw(0.1, 0.5) * draw.direction();
    link.axis = draw.direction();
    link.mass = draw(0.5, 10);
    link.com = draw(0, 0.3) * draw.direction();
    const double I = link.mass * draw(0.001, 0.04);  // the body's shape is of no matter here
    link.inertia.diagonal() << I, 1.5 * I, 2 * I;
    if (i % 4 == 3) link.armature = draw(0.05, 1);
    arm.chain.links.push_back(link);
  }
  arm.chain.R_tip = draw.turn();
  arm.chain.p_tip = draw(0.1, 0.4) * draw.direction();
  arm.chain.gravity = 9.80665 * draw.direction();
  arm.q = draw.vector(n, std::numbers::pi);
  for (int i = 2; i < n; i += 3) arm.q[i] *= 0.1;
  arm.qd = draw.vector(n, 2);
  arm.place();
  return arm;
}

}  // namespace osculate::test
