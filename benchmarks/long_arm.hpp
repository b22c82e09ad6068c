// Arms of any number of links with numbers that stay sane, and what the recursions say of them over any
// scalar. Shared by the study that docs/large-n.md quotes and by the tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"

namespace osculate::long_arms {

/// Without motors a joint next to the tip moves nothing but its own thin link: the largest joint
/// acceleration grows about like n^2.
enum class Motors { everywhere, none };

/// A snake of 10 m and 20 kg whatever n: rods of 10 m / n, 3 cm thick, that bend gently about random axes, so
/// that the arm's direction goes on a random walk of a few radians; every fourth joint slides. The tip moves
/// at some m/s. Armature: 0.02 kg m^2, or 2 kg where the joint slides.
inline RandomArm snake(std::uint64_t seed, int n, Motors motors = Motors::everywhere) {
  Random random(seed * 1000003u + static_cast<std::uint64_t>(n));
  const double length = 10.0 / n, mass = 20.0 / n, radius = 0.03;  // m, kg, m
  const double turn = 6 / std::sqrt(n), rate = 2 / std::sqrt(n);   // rad, rad/s
  const double across = mass / 12 * (3 * radius * radius + length * length);
  RandomArm arm;
  arm.q.resize(n);
  arm.qd.resize(n);
  arm.chain.links.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const bool slides = i % 4 == 3;
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    Link<double> link;
    link.type = slides ? JointType::prismatic : JointType::revolute;
    link.p_origin = {0, 0, i == 0 ? 0 : length};
    link.axis = Vector3<double>(std::cos(angle), std::sin(angle), 0.3).normalized();
    link.mass = mass;
    link.com = {0, 0, length / 2};
    link.inertia.diagonal() << across, across, mass * radius * radius / 2;
    if (motors == Motors::everywhere) link.armature = slides ? 2 : 0.02;
    arm.chain.links.push_back(link);
    arm.q[i] = slides ? random.uniform(-0.3, 0.3) * length : random.uniform(-1, 1) * turn;
    arm.qd[i] = random.uniform(-1, 1) * (slides ? rate * length : rate);
  }
  arm.chain.p_tip = {0, 0, length};
  arm.chain.gravity = 9.80665 * random.direction();
  arm.positions = positions<double>(arm.chain, {arm.q.data(), static_cast<std::size_t>(n)});
  return arm;
}

/// All numbers that the terms of one state depend on; lists base to tip.
template <Field S>
struct State {
  Chain<S> chain;
  VectorX<S> q, qd, T0;  // rad or m, per second, N m or N: torques for forward dynamics
  VectorX<S> u;          // 6: tip acceleration that the law commands, rad/s^2, m/s^2
};
inline State<double> state_of(const RandomArm& arm, std::uint64_t seed) {
  Random random(seed);
  State<double> at{arm.chain, arm.q, arm.qd, VectorX<double>(arm.qd.size()), VectorX<double>(6)};
  for (VectorX<double>* list : {&at.T0, &at.u})
    for (double& x : *list) x = random.uniform(-5, 5);
  return at;
}
template <Field To, Field From>
State<To> cast_state(const State<From>& at) {
  return {cast<To>(at.chain), at.q.template cast<To>(), at.qd.template cast<To>(), at.T0.template cast<To>(),
          at.u.template cast<To>()};
}

template <Field S>
std::span<const S> span_of(const VectorX<S>& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
template <Field S>
std::span<S> span_of(VectorX<S>& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

/// Everything that the recursions give at one state. c, g and c_plus_g before the solve: Omega times them.
template <Field S>
struct Terms {
  MatrixX<S> Omega;                      // 6 x 6
  VectorX<S> c, g, c_plus_g, F, T, qdd;  // 6, 6, 6, 6, n, n
};

template <class Space, Field S>
VectorX<S> rows_of(const Vec<Space, S>& v) {
  VectorX<S> out(6);
  for (int i = 0; i < 6; ++i) out[i] = component(v, i);
  return out;
}
template <Field S>
MatrixX<S> matrix_of(const Compliance<S>& Omega) {
  MatrixX<S> out(6, 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) out(i, j) = component(Omega, i, j);
  return out;
}

/// Four sweeps, one solve and one sweep back: T of (16) for the commanded u, and F.
template <Field S>
Vec<Force, S> command(OperationalSpace<S>& space, const std::vector<JointPosition<S>>& joints,
                      const State<S>& at, VectorX<S>& T) {
  static const TaskRows rows = all_rows();
  space.place(joints);
  space.sweep(span_of(at.qd));
  TaskVector<S> right = restricted(space.right_side(), rows);
  for (int i = 0; i < 6; ++i)
    right[static_cast<std::size_t>(i)] = right[static_cast<std::size_t>(i)] + at.u[i];
  const Vec<Force, S> F = wrench(TaskFactor<S>(space.Omega(), rows).solve(right), rows);
  space.torques(F, span_of(T));
  return F;
}

template <Field S>
Terms<S> terms_of(const State<S>& at) {
  const std::vector<JointPosition<S>> joints = positions(at.chain, span_of(at.q));
  OperationalSpace<S> space(at.chain);
  ForwardDynamics<S> plant(at.chain);
  Terms<S> out;
  out.T.resize(at.qd.size());
  out.qdd.resize(at.qd.size());
  out.F = rows_of(command(space, joints, at, out.T));
  out.Omega = matrix_of(space.Omega());
  out.c_plus_g = rows_of(space.right_side());
  out.g = rows_of(space.right_side_of_g());
  out.c = rows_of(space.right_side_of_c(span_of(at.qd)));
  plant.place(joints);
  plant.accelerations(span_of(at.qd), span_of(at.T0), {}, span_of(out.qdd));
  return out;
}

}  // namespace osculate::long_arms
