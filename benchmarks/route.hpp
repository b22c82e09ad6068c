// What is timed: a call of one system on one arm. Peers are loaded as modules, each with its own copy of what
// headers compile to, because a peer's binary and we may disagree on the alignment of Eigen's types. A module
// serves the jury too (jury/engine.hpp). This file is C++17: the headers of one peer are not C++20.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "jury/engine.hpp"

namespace osculate::bench {

using jury::Arm;

/// Joint lists base to tip. Six-vectors angular part first, inertial frame, about the tip point.
struct State {
  std::vector<double> q, qd, T;  // rad, rad/s, N m
  std::array<double, 6> u{};     // tip acceleration asked for, gravity not in it: rad/s^2, m/s^2
};

struct Answer {
  std::vector<double> qdd;    // rad/s^2
  std::array<double, 6> F{};  // Lambda u + c + g: N m, N
  std::vector<double> T;      // J^T F, N m
};

enum class Call {
  forward_dynamics,  // (q, qd, T) -> qdd
  task,              // (q, qd, u) -> Omega, F = Lambda u + c + g, T
};

/// One way to compute an answer with a system's public calls. `run` allocates nothing of its own, and starts
/// from nothing but the state: everything cached is made anew.
struct Route {
  std::string system, name;
  Call call;
  std::function<void(const State&, Answer&)> run;
  std::function<void(double*)> read_Omega;  // 36 numbers, by rows; of the last `run` of a task
};

/// The function that a peer's module exports as `add_routes`.
using AddRoutes = void(const Arm&, std::vector<Route>&);

}  // namespace osculate::bench
