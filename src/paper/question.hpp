// What is asked of an arm at one state: command, torques, forces, a moving base, in small whole numbers so
// that they are exact in every scalar.
#pragma once

#include "model/random_arm.hpp"
#include "paper/swept.hpp"

namespace osculate::paper {

/// `floor`: see independent_rows; 0 for exact scalars.
template <Field S>
Question<S> question(const Chain<S>& chain, const std::vector<JointPosition<S>>& positions,
                     const VectorX<S>& qd, std::uint64_t seed, const S& floor) {
  Random random(seed ^ 0x9a9e5);
  const auto numbers = [&random](Eigen::Index size) {
    VectorX<S> out(size);
    for (Eigen::Index i = 0; i < size; ++i) out[i] = S(random.integer(-8, 8));
    return out;
  };
  Question<S> ask;
  ask.chain = chain;
  ask.positions = positions;
  ask.qd = qd;
  ask.rows = independent_rows(chain, positions, qd, floor);
  ask.u = numbers(static_cast<Eigen::Index>(ask.rows.size()));
  ask.T0 = numbers(qd.size());
  ask.T = numbers(qd.size());
  ask.F = numbers(6);
  ask.push = numbers(6);
  // Turned about z by the angle whose cosine is 3/5.
  ask.base.R << S(3) / S(5), S(-4) / S(5), S(0), S(4) / S(5), S(3) / S(5), S(0), S(0), S(0), S(1);
  ask.base.p = numbers(3);
  ask.base.velocity = numbers(6);
  ask.base.acceleration = numbers(6);
  return ask;
}

}  // namespace osculate::paper
