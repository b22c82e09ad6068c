// Nothing is allocated after set-up, and memory is linear in n. Every operator new of this program counts;
// under glibc so does malloc itself, which Eigen calls directly.
#include <cstddef>
#include <cstdlib>
#include <new>
#include <span>
#include <vector>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/resolved_acceleration.hpp"
#include "support/catch.hpp"

namespace {

long allocations = 0;    // since the start of the program
std::size_t in_use = 0;  // bytes that operator new has given and delete has not taken back

/// Memory with its size in front, so that delete knows it.
constexpr std::size_t header = 64;  // also the strongest alignment that is asked for
void* give(std::size_t size) {
  ++allocations;
  in_use += size;
  void* const block = std::aligned_alloc(header, (size + 2 * header - 1) / header * header);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<std::size_t*>(block) = size;
  return static_cast<std::byte*>(block) + header;
}
void take(void* given) noexcept {
  if (given == nullptr) return;
  void* const block = static_cast<std::byte*>(given) - header;
  in_use -= *static_cast<std::size_t*>(block);
  std::free(block);
}

}  // namespace

void* operator new(std::size_t size) { return give(size); }
void* operator new[](std::size_t size) { return give(size); }
void* operator new(std::size_t size, std::align_val_t) { return give(size); }
void* operator new[](std::size_t size, std::align_val_t) { return give(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return give(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return give(size); }
void operator delete(void* p) noexcept { take(p); }
void operator delete[](void* p) noexcept { take(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { take(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { take(p); }
void operator delete(void* p, std::size_t) noexcept { take(p); }
void operator delete[](void* p, std::size_t) noexcept { take(p); }
void operator delete(void* p, std::align_val_t) noexcept { take(p); }
void operator delete[](void* p, std::align_val_t) noexcept { take(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { take(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { take(p); }

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
#define COUNTS_MALLOC 1
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* malloc(std::size_t size) { return ++allocations, __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return ++allocations, __libc_calloc(count, size); }
void* realloc(void* p, std::size_t size) { return ++allocations, __libc_realloc(p, size); }
}
#endif

using namespace osculate;

namespace {

constexpr int calls = 50;

/// Allocations of many calls, each in another state.
template <class Call>
long allocations_of(Call&& call) {
  const long before = allocations;
  for (int i = 0; i < calls; ++i) call(i);
  return allocations - before;
}

const std::vector<JointType> one_axis_types{JointType::revolute, JointType::prismatic, JointType::revolute,
                                            JointType::revolute, JointType::prismatic, JointType::revolute,
                                            JointType::revolute};
const std::vector<JointType> all_types{JointType::floating, JointType::revolute,    JointType::prismatic,
                                       JointType::planar,   JointType::cylindrical, JointType::universal,
                                       JointType::spherical};

/// An arm in `calls` states, all lists made beforehand.
struct Moving {
  RandomArm arm;
  std::vector<VectorX<double>> q;
  std::vector<JointPosition<double>> joints;
  std::vector<double> T, qdd;
  TaskRows rows = all_rows();
  BaseMotion<double> base;

  explicit Moving(const std::vector<JointType>& types) : arm(random_arm_of(1, types)), joints(arm.positions) {
    for (unsigned seed = 1; seed <= calls; ++seed) q.push_back(random_arm_of(seed, types).q);
    T.resize(static_cast<std::size_t>(arm.qd.size()), 1.0);
    qdd.resize(T.size());
    base.velocity << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
  }
  std::span<const double> qd() const { return {arm.qd.data(), static_cast<std::size_t>(arm.qd.size())}; }
  void go_to(int i) {
    const VectorX<double>& now = q[static_cast<std::size_t>(i)];
    set_positions<double>(arm.chain, {now.data(), static_cast<std::size_t>(now.size())}, joints);
  }
  /// The force for no command, by one solve.
  template <class H>
  Vec<Force, double> force(const BasicOperationalSpace<H>& space) const {
    const TaskFactor<double> Omega(space.Omega(), rows);
    return wrench(Omega.solve(restricted(space.right_side(), rows)), rows);
  }
};

/// Everything that OperationalSpace and ForwardDynamics do, after one call each.
template <class H>
void check_one_frame(const std::vector<JointType>& types) {
  Moving at(types);
  BasicOperationalSpace<H> space(at.arm.chain);
  BasicForwardDynamics<H> plant(at.arm.chain);
  double sum = 0;
  const auto everything = [&](int i) {
    at.go_to(i);
    space.move_base(at.base);
    space.place(at.joints);
    space.sweep(at.qd(), at.T);
    space.torques(at.force(space), at.T);
    sum += space.right_side_of_g().lin.x + space.right_side_of_c(at.qd()).lin.x;
    plant.move_base(at.base);
    plant.place(at.joints);
    plant.accelerations(at.qd(), at.T, {}, at.qdd);
    sum += plant.kinetic_energy(at.qd()) + plant.potential_energy() + plant.tip_acceleration().lin.x;
  };
  everything(0);
  CHECK(allocations_of(everything) == 0);
  CHECK(std::isfinite(sum));
}

/// The sampled forms, in link frames.
template <class H>
void check_link_frames(const std::vector<JointType>& types) {
  for (const Delay delay : {Delay::none, Delay::velocity, Delay::force, Delay::both}) {
    Moving at(types);
    BasicOperationalSpace<H> space(at.arm.chain);
    const auto sample = [&](int i) {
      at.go_to(i);
      space.place(at.joints);
      space.begin_sample(delay, true, at.qd(), {});
      space.finish_sample(true, at.force(space), at.T);
    };
    sample(0);
    CHECK(allocations_of(sample) == 0);
    CHECK(std::isfinite(at.T[0]));
  }
}

/// Bytes that a recursion over n links holds after its first call.
template <class Recursion>
std::size_t bytes_of(int n) {
  const RandomArm arm = random_arm(1, n);
  const std::size_t before = in_use;
  Recursion recursion(arm.chain);
  recursion.place(arm.positions);
  return in_use - before;
}

}  // namespace

TEST_CASE("the counter sees what is allocated on purpose") {
  [[maybe_unused]] static const void* volatile sink;  // keeps the compiler from leaving a new and its delete
                                                      // out
  const auto one_number = [](int i) {
    const double* const number = new double(i);
    sink = number;
    delete number;
  };
  const auto list = [](int i) {
    const std::vector<double> numbers(static_cast<std::size_t>(i) + 1);
    sink = numbers.data();
  };
  const auto strongly_aligned = [](int) {
    struct alignas(64) Wide {
      double lane[8];
    };
    const std::vector<Wide> numbers(3);
    sink = numbers.data();
  };
  CHECK(allocations_of(one_number) >= calls);
  CHECK(allocations_of(list) >= calls);
  CHECK(allocations_of(strongly_aligned) >= calls);
#ifdef COUNTS_MALLOC
  const auto matrix = [](int i) {
    const VectorX<double> numbers(i + 1);
    sink = numbers.data();
  };
  CHECK(allocations_of(matrix) >= calls);
#endif
  CHECK(allocations_of([](int i) { sink = &one_axis_types[static_cast<std::size_t>(i) % 7]; }) == 0);
  const std::size_t before = in_use;
  const std::vector<double> held(1000);
  CHECK(in_use - before == 1000 * sizeof(double));
}

TEST_CASE("nothing is allocated after set-up, for joints of every kind") {
  check_one_frame<Hinge<double>>(one_axis_types);
  check_one_frame<Joint<double>>(all_types);
  check_link_frames<LinkHinge<double>>(one_axis_types);
  check_link_frames<LinkJoint<double>>(all_types);
}

TEST_CASE("resolved acceleration allocates nothing after set-up") {
  Moving at({6, JointType::revolute});
  ResolvedAcceleration<Hinge<double>> control(at.arm.chain);
  int regular = 0;
  const TaskVector<double> u{1, 2, 3, 4, 5, 6};
  const auto sample = [&](int i) {
    at.go_to(i);
    control.place(at.joints);
    control.sweep(at.qd());
    regular += control.torques(u, at.rows, {}, 1e-9, at.T);
  };
  sample(0);
  CHECK(allocations_of(sample) == 0);
  CHECK(regular == calls + 1);
}

TEST_CASE("memory is linear in the number of links") {
  // Powers of two: lists that grow by doubling then hold exactly what they need.
  const auto check = [](const char* what, std::size_t (*bytes)(int)) {
    const std::size_t at128 = bytes(128), at1024 = bytes(1024), at8192 = bytes(8192);
    INFO(what << ": " << at128 << ", " << at1024 << ", " << at8192 << " bytes at 128, 1024 and 8192 links");
    CHECK(at128 > 128 * sizeof(double));
    CHECK((at8192 - at1024) * (1024 - 128) == (at1024 - at128) * (8192 - 1024));
  };
  check("operational space", bytes_of<OperationalSpace<double>>);
  check("forward dynamics", bytes_of<ForwardDynamics<double>>);
}
