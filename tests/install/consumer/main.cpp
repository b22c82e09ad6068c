// Moves the tip of an arm by 0.1 m along x: controller MODEL.urdf TIP SAMPLES
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "model/urdf.hpp"
#include "recursion/forward_dynamics.hpp"
using namespace osculate;

int main(int, char** argv) {
  const Chain<double> chain = load_urdf(argv[1], {.base = "", .tip = argv[2]}).chain;
  OperationalSpace<double> space(chain);  // what the controller knows; joints of one axis
  ForwardDynamics<double> arm(chain);     // in place of the real arm
  const auto n = static_cast<std::size_t>(chain.n());
  std::vector<double> q(n, 0.5), qd(n, 0.0), T(n), qdd(n);  // base to tip
  std::vector<JointPosition<double>> joints = positions<double>(chain, q);
  space.place(joints);
  const Vec3<double> target = space.tip_position() + Vec3<double>{0.1, 0, 0};
  const TaskRows rows = all_rows();
  double worst = 0;
  for (int sample = 0; sample < std::atoi(argv[3]); ++sample) {
    set_positions<double>(chain, q, joints);  // cosines and sines
    space.place(joints);
    space.sweep(qd);
    const Vec<Motion, double> V = space.tip_velocity();
    const Vec<Motion, double> u{V.ang * -20.0, (target - space.tip_position()) * 100.0 - V.lin * 20.0};
    const TaskFactor<double> Omega(space.Omega(), rows);    // singular where an entry of pivots() is not > 0
    space.torques(Omega.solve(u + space.right_side()), T);  // T = J* (Lambda u + c + g), to the motors

    arm.place(joints);
    arm.accelerations(qd, T, {}, qdd);
    const Vec<Motion, double> miss = arm.tip_acceleration() - u;
    for (int i = 0; i < 6; ++i) worst = std::max(worst, std::abs(component(miss, i)));
    for (std::size_t i = 0; i < n; ++i) q[i] += 1e-3 * (qd[i] += 1e-3 * qdd[i]);
  }
  std::printf("missed by %.3e\nT", worst);
  for (const double torque : T) std::printf(" %.17g", torque);
}
