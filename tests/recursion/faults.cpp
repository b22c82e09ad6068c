// Seeded faults: each changes what the recursions say, and none reaches the dense reference. Compiled with
// OSCULATE_FAULTS. Both sides start from the same chain, joint positions and rates; sharing more would show
// here.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "reference/dense.hpp"
#include "support/catch.hpp"

#ifndef OSCULATE_FAULTS
#error "this test seeds faults: link osculate_recursion_faulty"
#endif

using namespace osculate;
using osculate::Random;
using osculate::random_arm;
using osculate::RandomArm;
using Vector = VectorX<double>;
using Numbers = std::vector<double>;

namespace {

/// Seeds a fault for as long as it lives.
struct Seeded {
  explicit Seeded(Fault fault) { active_fault = fault; }
  ~Seeded() { active_fault = Fault::none; }
  Seeded(const Seeded&) = delete;
  Seeded& operator=(const Seeded&) = delete;
};

struct Case {
  RandomArm arm;
  Vector u, T;
  dense::Vector6<double> F_ext;
};

/// 6 to 8 joints, so that all task rows exist.
std::vector<Case> cases() {
  std::vector<Case> out;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int n = 6 + static_cast<int>(seed % 3);
    Random random(seed);
    const auto numbers = [&random](int size) {
      return Vector(Vector::NullaryExpr(size, [&] { return random.uniform(-5, 5); }));
    };
    out.push_back({random_arm(seed, n), numbers(6), numbers(n), numbers(6)});
  }
  return out;
}

void append(Numbers& out, double x) { out.push_back(x); }
template <class Derived>
void append(Numbers& out, const Eigen::MatrixBase<Derived>& m) {
  for (int j = 0; j < m.cols(); ++j)
    for (int i = 0; i < m.rows(); ++i) out.push_back(m(i, j));
}
template <class Space>
void append(Numbers& out, const Vec<Space, double>& v) {
  for (int i = 0; i < 6; ++i) out.push_back(component(v, i));
}

/// Everything the dense side says.
Numbers definitions(const Case& c) {
  const auto& [arm, u, T, F_ext] = c;
  const auto x = dense::state(arm.chain, arm.positions, arm.qd);
  const auto task = dense::mobility(x.tip, x.joint);
  const auto terms = dense::task_terms(task);
  const auto command = dense::task_force(task, terms, u);
  Numbers out;
  append(out, x.tip.R);
  append(out, x.tip.p);
  append(out, x.tip.J);
  append(out, x.tip.tip_velocity);
  append(out, x.tip.Jdot_qd);
  append(out, x.joint.M);
  append(out, x.joint.C);
  append(out, x.joint.G);
  append(out, task.Omega);
  append(out, task.J_Minv_C);
  append(out, task.J_Minv_G);
  append(out, terms.Lambda);
  append(out, terms.c);
  append(out, terms.g);
  append(out, command.F);
  append(out, command.T);
  append(out, dense::forward_dynamics<double>(x.joint, x.tip.J, T, F_ext));
  append(out, dense::kinetic_energy(x.joint, arm.qd));
  append(out, dense::potential_energy(arm.chain, arm.positions));
  return out;
}

/// Everything the recursive side says, as far as both sides say it.
Numbers recursions(const Case& c) {
  const auto& [arm, u, T, F_ext] = c;
  const auto n = static_cast<std::size_t>(arm.chain.n());
  const std::span<const double> qd{arm.qd.data(), n};
  Numbers out, torques(n), qdd(n);
  OperationalSpace<double> space(arm.chain);
  space.place(arm.positions);
  space.sweep(qd, {T.data(), n});
  const TaskFactor<double> factor(space.Omega(), all_rows());
  TaskVector<double> right = restricted(space.right_side(), all_rows());
  for (std::size_t i = 0; i < 6; ++i) right[i] += u[static_cast<int>(i)];
  const auto F = wrench(factor.solve(right), all_rows());
  append(out, space.tip_velocity());
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) append(out, component(space.Omega(), i, j));
  append(out, F);
  space.torques(F, torques);
  append(out, Eigen::Map<const Vector>(torques.data(), arm.chain.n()));
  append(out, space.right_side_of_g());
  append(out, space.right_side_of_c(qd));

  ForwardDynamics<double> plant(arm.chain);
  plant.place(arm.positions);
  plant.accelerations(qd, {T.data(), n}, {{F_ext[0], F_ext[1], F_ext[2]}, {F_ext[3], F_ext[4], F_ext[5]}},
                      qdd);
  append(out, Eigen::Map<const Vector>(qdd.data(), arm.chain.n()));
  append(out, plant.tip_acceleration());
  return out;
}

bool same_bits(const Numbers& a, const Numbers& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}
/// Some number is off by more than a thousandth of the largest, or is no number at all: no rounding does
/// that.
bool differs(const Numbers& a, const Numbers& b) {
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(b[i])) return true;
    largest = std::max(largest, std::abs(a[i]));
    difference = std::max(difference, std::abs(a[i] - b[i]));
  }
  return difference > 1e-3 * largest;
}

}  // namespace

TEST_CASE("every seeded fault changes the recursions and no bit of the dense reference") {
  const std::vector<Case> all = cases();
  std::vector<Numbers> by_definition, by_recursion;
  for (const Case& c : all) by_definition.push_back(definitions(c)), by_recursion.push_back(recursions(c));

  int executed = 0;
  for (std::size_t i = 1; i < fault_names.size(); ++i) {
    const std::string fault(fault_names[i]);
    int states_that_differ = 0;
    fault_executions = 0;
    for (std::size_t j = 0; j < all.size(); ++j) {
      INFO(fault << ", seed " << j + 1 << ", " << all[j].arm);
      const Seeded seeded(static_cast<Fault>(i));
      CHECK(same_bits(definitions(all[j]), by_definition[j]));
      states_that_differ += differs(by_recursion[j], recursions(all[j]));
    }
    // Faults of link frames, joints with more axes, laws and energies are not on these lines: tests/mutation.
    if (fault_executions == 0) continue;
    ++executed;
    INFO(fault << " changes too little");
    CHECK(states_that_differ >= 12);  // of 20: not every arm has a sliding joint or armature
  }
  CHECK(executed >= 45);
}

TEST_CASE("without a fault repeated runs give identical bits on both sides") {
  REQUIRE(active_fault == Fault::none);
  for (const Case& c : cases()) {
    INFO(c.arm);
    CHECK(same_bits(definitions(c), definitions(c)));
    CHECK(same_bits(recursions(c), recursions(c)));
  }
}
