// The anchor of the work-precision study as a peer gets it: numbers and two functions. C++17, and nothing of
// ours, for the reasons of route.hpp.
#pragma once

#include <Eigen/Geometry>

#include "benchmarks/route.hpp"

namespace osculate::bench {

/// An arm that starts at rest and whose tip follows a path of positions, orientation held. Inertial frame.
struct Anchor {
  Arm arm;
  std::vector<double> q;                                   // rad, at t = 0
  double duration, interval;                               // s; between outputs
  double stiffness, damping;                               // 1/s^2 and 1/s, of all six rows
  Eigen::Matrix3d R;                                       // the orientation to hold
  std::function<void(double t, double* p_v_a)> path;       // 9 numbers: m, m/s, m/s^2
  std::function<void(double t, const double* p)> observe;  // takes the tip's position, m; may be empty
};

struct AnchorRun {
  long rhs = 0, steps = 0, failures = 0;  // evaluations of the law; steps; steps refused
  double seconds = 0;                     // of processor time, without loading the arm
};

/// The function that a peer's module exports as `run_anchor`: a run in so many steps of one length, or at a
/// tolerance, as its integrator takes.
using RunAnchor = void(const Anchor&, double steps_or_tolerance, AnchorRun&);

/// The tip acceleration that the law asks for where the tip has the pose R, p and the velocity V (angular
/// first).
inline void command(const Anchor& anchor, double t, const Eigen::Matrix3d& R, const Eigen::Vector3d& p,
                    const Eigen::Matrix<double, 6, 1>& V, State& state) {
  Eigen::Matrix3d path;  // columns: p, v, a
  anchor.path(t, path.data());
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // from R to the orientation held, to first order
  for (int i = 0; i < 3; ++i) turn += R.col(i).cross(anchor.R.col(i)) / 2;
  Eigen::Map<Eigen::Vector3d> angular(state.u.data()), linear(state.u.data() + 3);
  angular = anchor.stiffness * turn - anchor.damping * V.head<3>();
  linear = path.col(2) + anchor.damping * (path.col(1) - V.tail<3>()) + anchor.stiffness * (path.col(0) - p);
}

}  // namespace osculate::bench
