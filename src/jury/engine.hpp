// What the jury asks of another library. Each library is a module of its own (benchmarks/peer_*.cpp) that is
// loaded at run time, because its binary and we may disagree on the alignment of Eigen's types. This file is
// C++17 and sees nothing of ours: the headers of one library are not C++20.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace osculate::jury {

/// The numbers of an arm whose joints turn or slide, without rotors, which not every library has; as in
/// model/chain.hpp.
struct Arm {
  struct Link {
    Eigen::Matrix3d R_origin;  // joint axes in the inboard link frame, which is the link's at q = 0
    Eigen::Vector3d p_origin;  // m, in the inboard link frame
    Eigen::Vector3d axis;      // unit vector, joint frame
    double mass;               // kg
    Eigen::Vector3d com;       // m, link frame
    Eigen::Matrix3d inertia;   // kg m^2, about the centre of mass, link axes
    bool slides = false;       // along the axis; else it turns about it
  };
  std::vector<Link> links;  // base to tip
  Eigen::Matrix3d R_tip;    // in the last link's frame
  Eigen::Vector3d p_tip;    // m
  Eigen::Vector3d gravity;  // m/s^2, acceleration of free fall
  int n() const { return static_cast<int>(links.size()); }
};

/// Joint lists base to tip: rad or m and their rates, N m or N.
struct Question {
  std::vector<double> q, qd, tau;
};

/// By rows, joints base to tip; tip quantities angular first, base frame, about the tip point, ordinary
/// accelerations.
struct Answer {
  std::vector<double> M;        // n x n
  std::vector<double> C, G;     // n: M qdd + C + G = tau
  std::vector<double> J;        // 6 x n
  std::vector<double> Jdot_qd;  // 6
  std::vector<double> qdd;      // n, under tau
  std::vector<double> Omega;    // 6 x 6, J M^-1 J* by the library's own operators; empty where it has none
};

struct Engine {
  std::string name, version;
  std::function<void(const Question&, Answer&)> answer;
};

/// The function that a module exports as `make_engine`. Throws where the library cannot take the arm.
using MakeEngine = void(const Arm&, Engine&);

}  // namespace osculate::jury
