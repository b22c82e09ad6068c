// Scalar operations of the recursions and of the dense reference, counted by running them over Counted.
// Shared by the tool that writes docs/operations.md and by the test that the page tells the truth.
#pragma once

#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/resolved_acceleration.hpp"
#include "reference/dense.hpp"
#include "scalar/counted.hpp"

namespace osculate::operations {

/// A chain of identical links in some state. `u`: accelerations asked of the tip, six rows; rad/s^2, m/s^2.
struct Sample {
  Chain<Counted> chain;
  std::vector<JointPosition<Counted>> positions;
  VectorX<Counted> qd;  // chain.velocities(), base to tip
  VectorX<Counted> T;   // the same number of joint torques
  VectorX<Counted> u;   // 6
};

/// n links alike: generic axis, offset, centre of mass and inertia, the same for every n. The state depends
/// on `state` alone. Six rows of Omega have full rank for n >= 6 turning joints only; where they have not,
/// the numbers mean nothing, but no operation depends on a number.
inline Sample homogeneous(JointType type, int n, std::uint64_t state, bool motors = true) {
  Random shape(1);
  Chain<double> chain;
  Link<double> link = random_link(shape, type);
  link.armature = motors && one_axis(type) ? 0.25 : 0;
  chain.links.assign(static_cast<std::size_t>(n), link);
  random_ends(shape, chain);

  const RandomArm arm = random_arm_of(state, std::vector<JointType>(static_cast<std::size_t>(n), type));
  Random random(state);
  const auto list = [&](Eigen::Index size) {
    VectorX<Counted> out(size);
    for (Counted& x : out) x = Counted(random.uniform(-2, 2));
    return out;
  };
  Sample out{cast<Counted>(chain), {}, list(chain.velocities()), list(chain.velocities()), list(6)};
  for (const JointPosition<double>& q : arm.positions)
    out.positions.push_back(
        {Counted(q.c), Counted(q.s), Counted(q.d), q.R.cast<Counted>(), q.p.cast<Counted>()});
  return out;
}

inline std::span<const Counted> span_of(const VectorX<Counted>& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
inline std::span<Counted> span_of(VectorX<Counted>& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

/// What `work` executes.
template <class Work>
Tally tally_of(Work&& work) {
  Tally tally;
  const CountingScope counting(tally);
  work();
  return tally;
}

/// One computation and what it costs. `sweeps`: passes along the arm, where the recursion counts them itself;
/// forward kinematics is not one of them.
struct Cost {
  std::string name;
  Tally tally;
  long sweeps = 0;
};

/// F of (4) by one factorisation and one solve: all six rows.
inline Vec<Force, Counted> tip_force(const Compliance<Counted>& Omega, const Vec<Motion, Counted>& right_side,
                                     const VectorX<Counted>& u) {
  return TaskFactor<Counted>(Omega, all_rows())
      .solve(right_side + Vec<Motion, Counted>{{u[0], u[1], u[2]}, {u[3], u[4], u[5]}});
}

/// Each sweep by itself, joints with one axis, one frame.
inline std::vector<Cost> sweep_costs(const Sample& at) {
  using H = Hinge<Counted>;
  const ArmBuilder<Counted> builder(at.chain);
  const JointOrder order(at.chain);
  const JointList<H> rates{order, span_of(at.qd)};
  const Ground<Counted> ground = builder.ground();
  BasicArm<H> arm = builder.arm();
  Passes<H> x(at.chain.n());
  const Vec<Motion, Counted> right{{at.u[0], at.u[1], at.u[2]}, {at.u[3], at.u[4], at.u[5]}};
  Vec<Force, Counted> F;

  std::vector<Cost> out;
  const auto add = [&](const char* name, const auto& work) {
    const long before = x.sweeps;
    const Tally tally = tally_of(work);
    out.push_back({name, tally, x.sweeps - before});
  };
  add("forward kinematics", [&] { builder.place(at.positions, arm); });
  add("sweep 1, velocities", [&] { sweep_velocities(arm, rates, ground, x); });
  add("sweep 2, articulated inertia", [&] { sweep_articulated(arm, x, ground, {}, x); });
  add("sweep 3, compliance", [&] { sweep_compliance(arm, ground, ground.a_g, x); });
  add("6 x 6 factor and one solve", [&] { F = tip_force(x.Omega0, right, at.u); });
  add("sweep 4, torques", [&] { sweep_torques(arm, F, x); });
  add("gravity sweep, g(0) by itself", [&] { sweep_gravity(arm, ground.a_g, x); });
  add("acceleration sweep", [&] { sweep_accelerations(arm, x, ground, x); });
  return out;
}

/// T of (16), from joint positions and rates to torques.
template <class H>
Cost torque_cost(const char* name, const Sample& at) {
  BasicOperationalSpace<H> space(at.chain);
  VectorX<Counted> T(at.T.size());
  const Tally tally = tally_of([&] {
    space.place(at.positions);
    space.sweep(span_of(at.qd));
    space.torques(tip_force(space.Omega(), space.right_side(), at.u), span_of(T));
  });
  return {name, tally, space.sweeps()};
}

/// The same in link frames, with values of the sample before: the second sample.
inline Cost sampled_cost(const char* name, const Sample& at, Delay delay) {
  BasicOperationalSpace<LinkHinge<Counted>> space(at.chain);
  VectorX<Counted> T(at.T.size());
  const auto sample = [&] {
    space.place(at.positions);
    space.begin_sample(delay, false, span_of(at.qd), {});
    space.finish_sample(false, tip_force(space.Omega(), space.right_side(), at.u), span_of(T));
  };
  sample();
  const long before = space.sweeps();
  const Tally tally = tally_of(sample);
  return {name, tally, space.sweeps() - before};
}

/// qdd of (6), from joint positions, rates and torques.
template <class H>
Cost plant_cost(const char* name, const Sample& at) {
  BasicForwardDynamics<H> plant(at.chain);
  VectorX<Counted> qdd(at.T.size());
  const Tally tally = tally_of([&] {
    plant.place(at.positions);
    plant.accelerations(span_of(at.qd), span_of(at.T), {}, span_of(qdd));
  });
  return {name, tally};
}

/// Whole computations by recursion.
inline std::vector<Cost> whole_costs(const Sample& at) {
  return {torque_cost<Hinge<Counted>>("controller torque", at),
          plant_cost<Hinge<Counted>>("forward dynamics", at),
          sampled_cost("controller torque in link frames", at, Delay::none),
          sampled_cost("- old velocities", at, Delay::velocity),
          sampled_cost("- old force", at, Delay::force),
          sampled_cost("- both old", at, Delay::both)};
}

/// The same by the products for joints with any number of axes.
inline std::vector<Cost> joint_costs(const Sample& at) {
  return {torque_cost<Joint<Counted>>("controller torque", at),
          plant_cost<Joint<Counted>>("forward dynamics", at)};
}

/// Resolved acceleration control of n <= 6 turning joints in the first n task rows, without its n x n solve:
/// that one is counted on a matrix of the same size and taken off.
inline Cost resolved_cost(const Sample& at) {
  const int n = at.chain.n();
  TaskVector<Counted> u{};
  TaskRows rows;
  std::array<TaskVector<Counted>, 6> A{};
  Random random(static_cast<std::uint64_t>(n));
  for (int i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    rows.push_back(i);
    u[row] = at.u[i];
    for (Counted& x : A[row]) x = Counted(random.uniform(-1, 1));
  }
  const Counted floor(1e-9);
  ResolvedAcceleration<Hinge<Counted>> control(at.chain);
  VectorX<Counted> T(at.T.size());
  bool regular = false;
  const Tally all = tally_of([&] {
    control.place(at.positions);
    control.sweep(span_of(at.qd));
    regular = control.torques(u, rows, {}, floor, span_of(T));
  });
  const Tally solve = tally_of([&] { regular = regular && solve_square(A, u, n, floor).has_value(); });
  if (!regular) throw std::runtime_error("resolved acceleration counted on a singular arm");
  return {"resolved acceleration, its n x n solve apart", all - solve, control.sweeps()};
}

/// T of (16) by the dense reference: state, mobility, task terms and task force. As written there: dual
/// numbers for Jdot qd, and Eigen's own products, which multiply by a factor of 1.
inline Cost dense_torque_cost(const Sample& at) {
  const Tally tally = tally_of([&] {
    const auto [tip, joint] = dense::state(at.chain, at.positions, at.qd);
    const dense::Mobility<Counted> task = dense::mobility(tip, joint);
    dense::task_force(task, dense::task_terms(task), at.u);
  });
  return {"controller torque", tally};
}
/// qdd of (6) by the dense reference.
inline Cost dense_plant_cost(const Sample& at) {
  const Tally tally = tally_of([&] {
    const auto [tip, joint] = dense::state(at.chain, at.positions, at.qd);
    dense::forward_dynamics(joint, tip.J, at.T);
  });
  return {"forward dynamics", tally};
}

/// Cost of n links: constant + slope n.
struct Law {
  Tally constant, slope;
};
/// `costs`: those of 1, 2, 3, ... links. nullopt where they are not on one line exactly, from n = 1 on.
inline std::optional<Law> linear_law(const std::vector<Tally>& costs) {
  const Tally slope = costs.at(1) - costs[0];
  for (std::size_t i = 2; i < costs.size(); ++i)
    if (costs[i] - costs[i - 1] != slope) return std::nullopt;
  return Law{costs[0] - slope, slope};
}

constexpr int longest = 12;  // links of the longest chain counted for a law

/// What is counted on one sample, always in the same order.
using Counting = std::vector<Cost> (*)(const Sample&);
inline std::vector<Cost> resolved_costs(const Sample& at) { return {resolved_cost(at)}; }

/// One computation on chains of 1 ... `last` links.
struct Series {
  std::string name;
  std::vector<Tally> costs;  // costs[n - 1]
  std::vector<long> sweeps;
};
inline std::vector<Series> series_of(Counting counting, JointType type, std::uint64_t state = 1,
                                     int last = longest, bool motors = true) {
  std::vector<Series> out;
  for (int n = 1; n <= last; ++n) {
    const std::vector<Cost> costs = counting(homogeneous(type, n, state, motors));
    out.resize(costs.size());
    for (std::size_t i = 0; i < costs.size(); ++i) {
      out[i].name = costs[i].name;
      out[i].costs.push_back(costs[i].tally);
      out[i].sweeps.push_back(costs[i].sweeps);
    }
  }
  return out;
}

inline std::int64_t sum(const Tally& x) {
  return x.multiplications + x.additions + x.negations + x.divisions + x.roots;
}

/// A cell: a + b n.
inline std::string written(std::int64_t constant, std::int64_t slope) {
  if (slope == 0) return std::to_string(constant);
  std::string out = (slope == 1 ? std::string() : std::to_string(slope) + " ") + "n";
  if (constant != 0) out += (constant < 0 ? " - " : " + ") + std::to_string(std::abs(constant));
  return out;
}
inline std::string row_of(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out += " " + cell + " |";
  return out;
}
/// name | multiplications | additions | divisions | negations | sweeps. Throws where the law is not linear.
inline std::string law_row(const Series& series) {
  const std::optional<Law> law = linear_law(series.costs);
  if (!law) throw std::runtime_error(series.name + " is not linear in n");
  const auto& [a, b] = *law;
  const long sweeps = series.sweeps.back();
  return row_of({series.name, written(a.multiplications, b.multiplications),
                 written(a.additions, b.additions), written(a.divisions, b.divisions),
                 written(a.negations, b.negations), sweeps > 0 ? std::to_string(sweeps) : "-"});
}

/// Where the multiplications of the dense reference become a cubic exactly, among 1 ... n links, and its
/// leading coefficient: third difference / 6.
struct Cubic {
  int from;
  std::int64_t third_difference;
};
inline Cubic cubic_law(const std::vector<Tally>& costs) {
  const auto third = [&](std::size_t i) {
    const auto m = [&](std::size_t j) { return costs[j].multiplications; };
    return m(i + 3) - 3 * m(i + 2) + 3 * m(i + 1) - m(i);
  };
  std::size_t i = costs.size() - 4;
  while (i > 0 && third(i - 1) == third(costs.size() - 4)) --i;
  return {static_cast<int>(i) + 1, third(i)};
}

/// The rows of docs/operations.md.
struct Tables {
  std::vector<std::string> turning, sliding, many_axes, dense, order, forward_dynamics;
};

/// The dense reference beside the recursion: `whole` is its place in whole_costs.
inline void add_dense_rows(Cost (*dense_cost)(const Sample&), std::size_t whole, Tables& out) {
  const auto text = [](double x) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.2f", x);
    return std::string(digits);
  };
  std::vector<Tally> costs;
  std::string name;
  for (int n = 1; n <= 24; ++n) {
    const Sample at = homogeneous(JointType::revolute, n, 1);
    const Cost cost = dense_cost(at);
    name = cost.name;
    costs.push_back(cost.tally);
    if (n != 6 && n != 7 && n != 12 && n != 20) continue;
    const std::int64_t ours = sum(whole_costs(at)[whole].tally), all = sum(cost.tally);
    out.dense.push_back(
        row_of({cost.name, std::to_string(n), std::to_string(cost.tally.multiplications),
                std::to_string(cost.tally.additions), std::to_string(cost.tally.divisions),
                std::to_string(cost.tally.negations), std::to_string(all), std::to_string(ours),
                text(static_cast<double>(all) / static_cast<double>(ours))}));
  }
  const Cubic law = cubic_law(costs);
  const std::int64_t divisor = std::gcd(law.third_difference, std::int64_t{6});
  const auto growth = [&](std::size_t n) {
    return std::log2(static_cast<double>(sum(costs[2 * n - 1])) / static_cast<double>(sum(costs[n - 1])));
  };
  out.order.push_back(row_of(
      {name, std::to_string(law.third_difference / divisor) + "/" + std::to_string(6 / divisor) + " n^3",
       std::to_string(law.from), text(growth(6)), text(growth(12))}));
}

/// Best published counts of forward dynamics: multiplications and divisions, additions and subtractions.
/// Featherstone, Rigid Body Dynamics Algorithms (2008), Table 10.1. See docs/operations.md for the caveats.
struct Published {
  double multiplications, additions;
};
inline Published published_rnea(double n) { return {93 * n - 108, 81 * n - 100}; }
inline Published published_crba(double n) { return {10 * n * n + 22 * n - 32, 6 * n * n + 37 * n - 43}; }
inline Published published_solve(double n) {
  return {n * n * n / 6 + 3 * n * n / 2 - 2 * n / 3, n * n * n / 6 + n * n - 7 * n / 6};
}
inline Published published_aba(double n) { return {224 * n - 259, 205 * n - 248}; }
inline Published operator+(const Published& x, const Published& y) {
  return {x.multiplications + y.multiplications, x.additions + y.additions};
}
inline Published published_dense(double n) {
  return published_rnea(n) + published_crba(n) + published_solve(n);
}

/// Forward dynamics in the published convention: ours, and the best published.
inline void add_forward_dynamics_rows(const Series& ours, Tables& out) {
  const auto& [a, b] = linear_law(ours.costs).value();
  const auto here = [&a = a, &b = b](double n) {
    const auto at = [n](std::int64_t constant, std::int64_t slope) {
      return static_cast<double>(constant) + static_cast<double>(slope) * n;
    };
    return Published{at(a.multiplications + a.divisions, b.multiplications + b.divisions),
                     at(a.additions, b.additions)};
  };
  const auto add = [&](const char* name, const auto& count) {
    std::vector<std::string> cells{name};
    for (const int n : {6, 12, 24}) {
      const Published c = count(n);
      cells.push_back(std::to_string(std::lround(c.multiplications)) + " + " +
                      std::to_string(std::lround(c.additions)));
    }
    out.forward_dynamics.push_back(row_of(cells));
  };
  add("ours, O(n)", here);
  add("published ABA, O(n)", published_aba);
  add("published RNEA + CRBA + factor and solve, O(n^3)", published_dense);
}

/// All rows as counted now. Throws where a recursion is not linear.
inline Tables tables() {
  Tables out;
  for (const Counting counting : {sweep_costs, whole_costs}) {
    const std::vector<Series> turning = series_of(counting, JointType::revolute);
    const std::vector<Series> sliding = series_of(counting, JointType::prismatic);
    for (std::size_t i = 0; i < turning.size(); ++i) {
      out.turning.push_back(law_row(turning[i]));
      if (sliding[i].costs != turning[i].costs) out.sliding.push_back(law_row(sliding[i]));
    }
  }
  out.turning.push_back(law_row(series_of(resolved_costs, JointType::revolute, 1, 6)[0]));
  for (const auto& [type, links] : {std::pair{JointType::revolute, "turning joints"},
                                    std::pair{JointType::spherical, "spherical joints"}})
    for (Series series : series_of(joint_costs, type)) {
      series.name += std::string(", ") + links;
      out.many_axes.push_back(law_row(series));
    }
  add_dense_rows(dense_torque_cost, 0, out);
  add_dense_rows(dense_plant_cost, 1, out);
  add_forward_dynamics_rows(series_of(whole_costs, JointType::revolute)[1], out);
  return out;
}

}  // namespace osculate::operations
