// Long arms: the same cost for every link from the first to the ten-thousandth, 100,000 links on a small
// stack, a deep file, and rounding at 1,000 links held against the same recursions with 113 bits.
#include <pthread.h>

#include <cmath>
#include <exception>
#include <functional>
#include <map>
#include <string>

#include "benchmarks/long_arm_rounding.hpp"
#include "model/urdf.hpp"
#include "scalar/counted.hpp"
#include "support/catch.hpp"

using namespace osculate;
using namespace osculate::long_arms;

namespace {

/// Runs `work` on a thread with a stack of 256 kB, where a call for each of 10,000 links would need more.
void on_small_stack(const std::function<void()>& work) {
  struct Job {
    const std::function<void()>& work;
    std::exception_ptr thrown;
  } job{work, nullptr};
  const auto run = [](void* given) -> void* {
    Job& at = *static_cast<Job*>(given);
    try {
      at.work();
    } catch (...) { at.thrown = std::current_exception(); }
    return nullptr;
  };
  pthread_attr_t attributes;
  pthread_t thread;
  REQUIRE(pthread_attr_init(&attributes) == 0);
  REQUIRE(pthread_attr_setstacksize(&attributes, 256 * 1024) == 0);
  REQUIRE(pthread_create(&thread, &attributes, run, &job) == 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  if (job.thrown) std::rethrow_exception(job.thrown);
}

/// Operations of the controller torque and of forward dynamics, kinematics included, joint positions given.
std::pair<Tally, Tally> operations(int n) {
  const State<Counted> at = cast_state<Counted>(state_of(snake(1, n), 1));
  std::vector<JointPosition<Counted>> joints;
  for (const JointPosition<double>& q : snake(1, n).positions)
    joints.push_back({Counted(q.c), Counted(q.s), Counted(q.d), {}, {}});
  OperationalSpace<Counted> space(at.chain);
  ForwardDynamics<Counted> plant(at.chain);
  VectorX<Counted> T(n), qdd(n);
  Tally control, dynamics;
  {
    const CountingScope counting(control);
    command(space, joints, at, T);
  }
  {
    const CountingScope counting(dynamics);
    plant.place(joints);
    plant.accelerations(span_of(at.qd), span_of(at.T0), {}, span_of(qdd));
  }
  return {control, dynamics};
}

double sum(const Tally& x) {
  return static_cast<double>(x.multiplications + x.additions + x.divisions + x.negations + x.roots);
}

/// A hanging chain of n links as a URDF file.
std::string deep_file(int n) {
  std::string text = "<robot name=\"deep\"><link name=\"l0\"/>";
  for (int i = 1; i <= n; ++i) {
    const std::string own = std::to_string(i), inboard = std::to_string(i - 1);
    text += "<joint name=\"j" + own + "\" type=\"continuous\"><parent link=\"l" + inboard +
            "\"/><child link=\"l" + own +
            "\"/><origin xyz=\"0 0 0.1\"/><axis xyz=\"0 1 0\"/></joint><link name=\"l" + own +
            "\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" "
            "iyz=\"0\"/></inertial></link>";
  }
  return text + "</robot>";
}

}  // namespace

TEST_CASE("operations are a + b n from 7 links to 10,000") {
  const auto [torque7, dynamics7] = operations(7);
  const auto [torque100, dynamics100] = operations(100);
  const auto on_the_line = [](const Tally& at7, const Tally& at100, int n) {
    return sum(at7) + (sum(at100) - sum(at7)) / 93 * (n - 7);
  };
  for (const int n : {10, 1000, 10000}) {
    INFO("n = " << n);
    const auto [torque, dynamics] = operations(n);
    const double expected_torque = on_the_line(torque7, torque100, n);
    const double expected_dynamics = on_the_line(dynamics7, dynamics100, n);
    CHECK(std::abs(sum(torque) / expected_torque - 1) <= 0.01);
    CHECK(std::abs(sum(dynamics) / expected_dynamics - 1) <= 0.01);
  }
}

TEST_CASE("100,000 links on a stack of 256 kB: D > 0 and the tip accelerates as commanded") {
  constexpr int n = 100'000;
  for (const Motors motors : {Motors::everywhere, Motors::none}) {
    INFO("motors: " << (motors == Motors::none ? "none" : "everywhere"));
    const RandomArm arm = snake(1, n, motors);
    const State<double> at = state_of(arm, 1);
    VectorX<double> T(n), qdd(n), scale(6), tip(6);
    int positive = 0;
    on_small_stack([&] {
      OperationalSpace<double> space(arm.chain);
      const VectorX<double> F = rows_of(command(space, arm.positions, at, T));
      for (int k = 1; k <= n; ++k) positive += space.articulated_joint_inertia(k).d > 0;
      scale = matrix_of(space.Omega()).cwiseAbs() * F.cwiseAbs() + rows_of(space.right_side()).cwiseAbs();
      ForwardDynamics<double> plant(arm.chain);
      plant.place(arm.positions);
      plant.accelerations(span_of(at.qd), span_of(T), {}, span_of(qdd));
      tip = rows_of(plant.tip_acceleration());
    });
    CHECK(positive == n);
    CHECK(qdd.allFinite());
    const double missed = (tip - at.u).cwiseAbs().cwiseQuotient(scale).maxCoeff();
    INFO("missed by " << missed / 0x1p-52 << " eps of the terms");
    CHECK(missed <= 0x1p-52 * n);  // n roundings in a row
  }
}

TEST_CASE("a file of 10,000 links in a row is read on a stack of 256 kB") {
  constexpr int n = 10'000;
  const std::string text = deep_file(n);
  ArmDescription arm;
  on_small_stack([&] {
    ChainChoice choice;
    choice.tip = "l" + std::to_string(n);
    arm = parse_urdf(text, "deep", choice);
  });
  REQUIRE(arm.chain.n() == n);
  CHECK(arm.joints.front().name == "j1");
  CHECK(arm.joints.back().name == "j10000");
}

TEST_CASE("rounding at 7, 100 and 1,000 links is within n eps times the condition of each term") {
  // n roundings in a row, each eps, act like errors of n eps in the arm's numbers at most; what those do, the
  // condition says. Errors that do not conspire give less: seen at 1,000 links, in eps of the condition, by
  // benchmarks/large.cpp with and without fused multiply-add.
  const std::map<std::string, double> seen{
      {"Omega", 12}, {"Omega c", 32}, {"Omega g", 62}, {"Omega (c + g)", 32},
      {"F", 17},     {"T", 5.5},      {"qdd", 19}};
  for (const Motors motors : {Motors::everywhere, Motors::none})
    for (const int n : {7, 100, 1000})
      for (unsigned seed = 1; seed <= (n == 1000 ? 2 : 4); ++seed) {
        const State<double> at = state_of(snake(seed, n, motors), seed);
        for (const Rounding& term : rounding_of(at, 17 * seed)) {
          INFO(term.name << ", n = " << n << ", seed " << seed
                         << (motors == Motors::none ? ", no motors" : ", motors") << ": " << term.error
                         << " eps, condition " << term.condition);
          CHECK(term.error <= n * term.condition);
          if (n == 1000) CHECK(term.error <= 5 * seen.at(term.name) * term.condition);
        }
      }
}
