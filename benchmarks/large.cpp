// The study behind docs/large-n.md: cost, memory and rounding of the recursions on long arms.
//   large                 all tables
//   large TABLE           one of times, memory, symmetry and rounding (some 20 s)
//   large CALL N COUNT    COUNT times osc or forward on N links, for counting instructions
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "benchmarks/long_arm_rounding.hpp"

namespace {

std::size_t in_use = 0;  // bytes that operator new has given and delete has not taken back

constexpr std::size_t header = 64;  // the size in front of each block
void* give(std::size_t size) {
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
void* operator new(std::size_t size, std::align_val_t) { return give(size); }
void operator delete(void* p) noexcept { take(p); }
void operator delete(void* p, std::size_t) noexcept { take(p); }
void operator delete(void* p, std::align_val_t) noexcept { take(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { take(p); }

using namespace osculate;
using namespace osculate::long_arms;

namespace {

/// One arm with both recursions ready.
struct Ready {
  RandomArm arm;
  State<double> at;
  OperationalSpace<double> space;
  ForwardDynamics<double> plant;
  VectorX<double> T, qdd;

  explicit Ready(int n)
      : arm(snake(1, n)), at(state_of(arm, 1)), space(arm.chain), plant(arm.chain), T(n), qdd(n) {}
  /// Omega, F and T: kinematics, four sweeps, one solve.
  void osc() { command(space, arm.positions, at, T); }
  void forward() {
    plant.place(arm.positions);
    plant.accelerations(span_of(at.qd), span_of(at.T0), {}, span_of(qdd));
  }
};

template <class Recursion>
double bytes_per_link(const RandomArm& arm) {
  const std::size_t before = in_use;
  Recursion recursion(arm.chain);
  recursion.place(arm.positions);
  return static_cast<double>(in_use - before) / recursion.n();
}

/// Seconds of one call, best of several batches.
template <class Call>
double best_time(int n, Call&& call) {
  const int count = std::max(1, 200'000 / n);
  call();
  double best = 1e9;
  for (int batch = 0; batch < 9; ++batch) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) call();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count() / count);
  }
  return best;
}

void print_times() {
  std::puts("| n | {Omega, c + g, F, T} us | ns a link | forward dynamics us | ns a link |");
  std::puts("|---|---|---|---|---|");
  for (const int n : {7, 10, 100, 1000, 10'000, 100'000}) {
    Ready arm(n);
    const double osc = best_time(n, [&] { arm.osc(); }), forward = best_time(n, [&] { arm.forward(); });
    std::printf("| %d | %.4g | %.1f | %.4g | %.1f |\n", n, osc * 1e6, osc * 1e9 / n, forward * 1e6,
                forward * 1e9 / n);
  }
}

void print_memory() {
  std::puts("| n | operational space, bytes a link | forward dynamics, bytes a link |");
  std::puts("|---|---|---|");
  for (const int n : {8, 128, 1024, 8192, 131'072}) {
    const RandomArm arm = snake(1, n);
    std::printf("| %d | %.1f | %.1f |\n", n, bytes_per_link<OperationalSpace<double>>(arm),
                bytes_per_link<ForwardDynamics<double>>(arm));
  }
}

void print_rounding() {
  std::puts("| n | motors | arms | Omega | Omega c | Omega g | Omega (c + g) | F | T | qdd |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|");
  for (const Motors motors : {Motors::everywhere, Motors::none})
    for (const int n : {7, 30, 100, 300, 1000}) {
      const unsigned arms = n == 1000 ? 4 : 10;
      std::array<double, 7> error{}, condition{};
      for (unsigned seed = 1; seed <= arms; ++seed) {
        const auto terms = rounding_of(state_of(snake(seed, n, motors), seed), 17 * seed);
        for (std::size_t i = 0; i < terms.size(); ++i) {
          error[i] = std::max(error[i], terms[i].error);
          condition[i] = std::max(condition[i], terms[i].condition);
        }
      }
      std::printf("| %d | %s | %u |", n, motors == Motors::none ? "no" : "yes", arms);
      for (std::size_t i = 0; i < error.size(); ++i) std::printf(" %.2g (%.2g) |", error[i], condition[i]);
      std::puts("");
    }
}

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Matrix3<double> tilde(const Vector3<double>& a) {
  Matrix3<double> out;
  out << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return out;
}

/// (37) as printed, all 36 numbers of P and no symmetrising: largest |P - P*| over the largest entry of its
/// kind (angular, mixed, linear), among all links.
double asymmetry_of_the_printed_form(const RandomArm& arm) {
  const Chain<double>& chain = arm.chain;
  const auto n = static_cast<std::size_t>(chain.n());
  std::vector<Matrix3<double>> R(n + 1, Matrix3<double>::Identity());
  std::vector<Vector3<double>> l(n + 1);  // from one origin to the next outward, inertial frame
  for (std::size_t i = 0; i < n; ++i) {   // base to tip
    const Link<double>& link = chain.links[i];
    const JointPosition<double>& q = arm.positions[i];
    l[i] = R[i] * (link.p_origin + link.axis * q.d);
    R[i + 1] = R[i] * rotation<double>(link.axis, q.c, q.s);
  }
  Matrix6 P = Matrix6::Zero(), psi = Matrix6::Zero();
  Vector6d K = Vector6d::Zero();
  double J = 0, worst = 0;
  for (std::size_t i = n; i-- > 0;) {  // tip to base
    const Link<double>& link = chain.links[i];
    const Vector3<double> p = R[i + 1] * link.com, h = R[i + 1] * link.axis;
    Matrix6 M;
    M.topLeftCorner<3, 3>() =
        R[i + 1] * link.inertia * R[i + 1].transpose() - link.mass * tilde(p) * tilde(p);
    M.topRightCorner<3, 3>() = link.mass * tilde(p);
    M.bottomLeftCorner<3, 3>() = -link.mass * tilde(p);
    M.bottomRightCorner<3, 3>() = link.mass * Matrix3<double>::Identity();
    Vector6d H = Vector6d::Zero();
    H.segment<3>(link.type == JointType::revolute ? 0 : 3) = h;
    P = psi * P * psi.transpose() + K * J * K.transpose() + M;  // (37)
    const auto off = [&P](int a, int b) {
      const Matrix3<double> here = P.block<3, 3>(a, b), there = P.block<3, 3>(b, a).transpose();
      return (here - there).cwiseAbs().maxCoeff() / here.cwiseAbs().maxCoeff();
    };
    worst = std::max({worst, off(0, 0), off(0, 3), off(3, 3)});
    Matrix6 phi = Matrix6::Identity();
    phi.topRightCorner<3, 3>() = tilde(l[i]);
    J = link.armature;
    const double D = H.dot(P * H) + J;                      // (30)
    const Vector6d G = P * H / D;                           // (31)
    K = phi * G;                                            // (32)
    psi = phi * (Matrix6::Identity() - G * H.transpose());  // (33)
  }
  return worst;
}

void print_asymmetry() {
  std::puts("| n | largest asymmetry of P by the printed (37), eps |");
  std::puts("|---|---|");
  for (const int n : {7, 100, 1000, 10'000}) {
    double worst = 0;
    for (const Motors motors : {Motors::everywhere, Motors::none})
      for (unsigned seed = 1; seed <= 4; ++seed)
        worst = std::max(worst, asymmetry_of_the_printed_form(snake(seed, n, motors)));
    std::printf("| %d | %.2g |\n", n, worst / std::numeric_limits<double>::epsilon());
  }
}

int run(const char* call, int n, long count) {
  Ready arm(n);
  const bool osc = std::strcmp(call, "osc") == 0;
  if (!osc && std::strcmp(call, "forward") != 0) {
    std::fprintf(stderr, "no call is named %s: use osc or forward\n", call);
    return 2;
  }
  for (; count > 0; --count) osc ? arm.osc() : arm.forward();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) return run(argv[1], std::atoi(argv[2]), std::atol(argv[3]));
  const struct {
    const char* name;
    void (*print)();
  } tables[] = {{"times", print_times},
                {"memory", print_memory},
                {"symmetry", print_asymmetry},
                {"rounding", print_rounding}};
  bool printed = false;
  for (const auto& table : tables) {
    if (argc == 2 && std::strcmp(argv[1], table.name) != 0) continue;
    if (printed) std::puts("");
    table.print();
    printed = true;
  }
  if (printed) return 0;
  std::fputs("usage: large [times|memory|symmetry|rounding], or large osc|forward N COUNT\n", stderr);
  return 2;
}
