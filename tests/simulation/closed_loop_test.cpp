// A right-hand side or its Jacobian takes no memory from the heap, whatever the law: this program counts
// every request, those of Eigen (malloc) included; set-up and first evaluation are not counted. And what
// plant and controller share.
#include "simulation/closed_loop.hpp"

#include <cstdlib>
#include <new>

#include "control/quick_arm.hpp"
#include "simulation/closed_loop_slopes.hpp"
#include "support/catch.hpp"

namespace {
long requests = 0;
}

// With glibc both operator new and Eigen end in malloc. Sanitizers bring their own malloc: there only
// operator new is seen.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) noexcept {
  ++requests;
  return __libc_malloc(size);
}
constexpr bool sees_malloc = true;
#else
constexpr bool sees_malloc = false;
#endif

// Not inlined: GCC would take new and free for a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++requests;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace osculate::testing::closed_loop_tests {
using namespace osculate::test;

namespace {

struct Setting {
  LawOptions law;
  Plant plant;
  std::vector<JointFriction> friction;
};

/// Requests during 300 right-hand sides, event functions and Jacobians at different states, after one of
/// each.
long requests_of(const Setting& setting, const QuickArm& arm) {
  const std::span<const double> q{arm.q.data(), static_cast<std::size_t>(arm.q.size())};
  const auto n = static_cast<std::size_t>(arm.chain.n());
  ClosedLoop loop(Controller(arm.chain, setting.friction, setting.law, make_path(CircleOptions{}),
                             tip_pose(arm.chain, q, base_motion(setting.law.base_path.get(), 0))),
                  setting.plant);
  std::vector<double> y(loop.states()), yd(loop.states());
  std::vector<double> g(static_cast<std::size_t>(loop.event_count()) + 1);
  ClosedLoopSlopes slopes(loop);
  std::vector<double> df(loop.states() * loop.states());
  long counted = 0;
  for (int i = 0; i <= 300; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      y[j] = q[j] + 1e-4 * i;
      y[n + j] = arm.qd[static_cast<Eigen::Index>(j)] * (1 - 0.005 * i);
    }
    const long before = requests;
    loop.right_side(0.01 * i, y.data(), yd.data());
    loop.events(0.01 * i, y.data(), g.data());
    if (ClosedLoopSlopes::exist(loop)) slopes(0.01 * i, y.data(), df.data());
    if (i > 0) counted += requests - before;
    CHECK(std::isfinite(yd[n]));
  }
  return counted;
}

}  // namespace

TEST_CASE("the counter sees what it should") {
  const long start = requests;
  const auto number = std::make_unique<double>(1);
  CHECK(requests > start);
  const long before = requests;
  const Eigen::VectorXd matrix = Eigen::VectorXd::Constant(100, *number);
  CHECK(matrix.sum() == 100);
  CHECK((requests > before) == sees_malloc);
}

TEST_CASE("a right-hand side takes no memory") {
  const QuickArm arm = quick_arm(3, 6);
  const std::size_t n = 6;
  Setting s;
  s.plant.chain = arm.chain;
  SECTION("operational space") {}
  SECTION("shares nothing") { s.plant.share_kinematics = false; }
  SECTION("friction, null space, torque limits, fewer rows") {
    s.friction.assign(n, {0.1, 1, 2, 0.01});
    s.plant.friction = s.friction;
    s.law.rows = {3, 4, 5};
    s.law.null_space.damping = 1;
    s.law.null_space.posture = NullSpaceOptions::Posture{std::vector<double>(n, 0.1), 2};
    s.law.null_space.limits =
        NullSpaceOptions::Limits{std::vector<double>(n, -9), std::vector<double>(n, 9), 8, 0.1};
    s.law.effort_limit.assign(n, 50);
  }
  SECTION("impedance at a surface that the law feels, and a field") {
    s.plant.environment = Environment{Ball{{5, 5, 5}, 0.1}, 1e4, 10, 0.2, 1e-3};
    s.plant.tip_force[4] = 3;
    s.law.know_tip_force = true;
    s.law.virtual_inertia = Vector6::Constant(2);
    s.law.obstacles = {Obstacle{{-5, 5, 5}, 0.1, 40, 0.01}};
  }
  SECTION("force control") {
    s.law.know_tip_force = true;
    s.law.force = ForceControl{{5}, {10}, 1, 20};
  }
  SECTION("moving base") { s.law.base_path = make_path(CircleOptions{.radius = 0.2}); }
  SECTION("coordinates") {
    s.law.orientation = OrientationCoordinates::quaternion;
    s.law.position = PositionCoordinates::cylindrical;
  }
  SECTION("singularity policies, far and near") {
    s.law.singularity.policy =
        GENERATE(SingularPolicy::damped, SingularPolicy::truncated, SingularPolicy::released);
    s.law.singularity.threshold = GENERATE(1e-9, 0.5);
  }
  SECTION("resolved acceleration") { s.law.law = Law::resolved_acceleration; }
  SECTION("free swing") { s.law.law = Law::free; }
  CHECK(requests_of(s, arm) == 0);
}

TEST_CASE("a plant that shares the controller's kinematics moves as one that does not") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const QuickArm arm = quick_arm(seed, 6);
    INFO(arm.name);
    const std::span<const double> q{arm.q.data(), 6};
    const auto loop_of = [&](bool share) {
      Plant plant{arm.chain, {}};
      plant.share_kinematics = share;
      plant.environment = Environment{Ball{{5, 5, 5}, 9}, 1e2, 10, 0.2, 1e-3};
      ClosedLoop loop(
          Controller(arm.chain, {}, LawOptions{}, make_path(CircleOptions{}), tip_pose(arm.chain, q)), plant);
      loop.set_modes({.contact = true});
      return loop;
    };
    ClosedLoop shares = loop_of(true), alone = loop_of(false);
    CHECK(shares.shares_kinematics());
    CHECK(!alone.shares_kinematics());
    std::vector<double> y(shares.states());
    std::copy(arm.q.begin(), arm.q.end(), y.begin());
    std::copy(arm.qd.begin(), arm.qd.end(), y.begin() + 6);
    const Observation a = shares.observe(0.3, y), b = alone.observe(0.3, y);
    // The same lines at the same numbers: bits may differ where a compiler contracts them differently, by n
    // eps of the torques' size, which M^-1 turns into as much of the accelerations' size times cond(M) < 1e5.
    const auto size = [](const std::vector<double>& v) {
      return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())).norm();
    };
    const double eps = std::numeric_limits<double>::epsilon();
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(std::abs(a.qdd[i] - b.qdd[i]) <= 6 * eps * 1e5 * size(b.qdd));
      CHECK(std::abs(a.torque[i] - b.torque[i]) <= 6 * eps * 1e5 * size(b.torque));
    }
    CHECK((a.tip_force - b.tip_force).norm() <= 6 * eps * 1e2 * 10);  // stiffness times the reach
    CHECK(a.tip_force.norm() > 0);
    CHECK(a.potential == Approx(b.potential).epsilon(6 * eps));
    CHECK(a.kinetic == Approx(b.kinetic).epsilon(6 * eps));
  }
}

TEST_CASE("kinematics are shared only where plant and controller agree on arm and state") {
  const QuickArm arm = quick_arm(2, 6);
  const auto shares = [&](const LawOptions& law, const Plant& plant) {
    return ClosedLoop(Controller(arm.chain, {}, law, make_path(HoldOptions{}),
                                 tip_pose(arm.chain, {arm.q.data(), 6})),
                      plant)
        .shares_kinematics();
  };
  const Plant same{arm.chain, {}};
  const LawOptions plain;
  CHECK(shares(plain, same));
  Plant heavier = same, dense = same, touched = same;
  heavier.chain.links.back().mass += 1;
  dense.dense = true;
  touched.environment = Environment{};
  CHECK(!shares(plain, heavier));
  CHECK(!shares(plain, dense));
  CHECK(shares(plain, touched));
  LawOptions feels = plain, sampled = plain, carried = plain, swings = plain, resolved = plain;
  feels.know_tip_force = true;
  sampled.sampling = Sampling{};
  carried.base_path = make_path(CircleOptions{});
  swings.law = Law::free;
  resolved.law = Law::resolved_acceleration;
  CHECK(shares(feels, same));
  CHECK(!shares(feels, touched));
  for (const LawOptions& law : {sampled, carried, swings, resolved}) CHECK(!shares(law, same));
}

TEST_CASE("a state is where it is observed, and its terms know no torque and no wrench that the law knows") {
  const double eps = std::numeric_limits<double>::epsilon();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const QuickArm arm = quick_arm(seed, 6);
    const std::span<const double> q{arm.q.data(), 6};
    INFO(arm.name);
    std::vector<double> y(15, 0.25);
    std::copy(arm.q.begin(), arm.q.end(), y.begin());
    std::copy(arm.qd.begin(), arm.qd.end(), y.begin() + 6);
    const auto loop_of = [&](const Setting& s) {
      return ClosedLoop(Controller(arm.chain, {}, s.law, make_path(CircleOptions{}),
                                   tip_pose(arm.chain, q, base_motion(s.law.base_path.get(), 0))),
                        s.plant);
    };
    Setting plain;
    plain.plant.chain = arm.chain;
    plain.law.rows = {3, 4, 5};
    Setting pushes = plain, feels = plain, other = plain, carried = plain, resolved = plain;
    pushes.law.null_space.damping = 1;
    feels.plant.tip_force[4] = 3;
    feels.law.know_tip_force = true;
    other.plant.chain.links.back().mass += 1;
    carried.law.base_path = make_path(CircleOptions{.radius = 0.2});
    resolved.law.law = Law::resolved_acceleration;
    resolved.law.rows = all_rows();

    for (const Setting& setting : {plain, pushes, feels, other, carried, resolved}) {
      ClosedLoop loop = loop_of(setting);
      const Observation seen = loop.observe(0.3, y);
      const Whereabouts at = loop.locate(0.3, y);
      // Recursions along six joints in a reach of a few metres, by the same or by other lines.
      CHECK((at.tip.pose.R - seen.command.tip.R).norm() <= 6 * eps * 10);
      CHECK((at.tip.pose.p - seen.command.tip.p).norm() <= 6 * eps * 10);
      CHECK((at.tip.velocity - seen.command.tip_velocity).norm() <= 6 * eps * 10 * (1 + arm.qd.norm()));
      CHECK(at.kinetic == Approx(seen.kinetic).epsilon(6 * eps));
      CHECK(at.potential == Approx(seen.potential).epsilon(6 * eps));
      CHECK(at.work == seen.work);
      CHECK(at.dissipated == seen.dissipated);
      CHECK(at.external_work == seen.external_work);
      CHECK(std::equal(at.q.begin(), at.q.end(), seen.q.begin(), seen.q.end()));
    }

    ClosedLoop quiet = loop_of(plain);
    const std::span<const double> qd{arm.qd.data(), 6};
    quiet.observe(0.3, y);
    const RecursiveTerms due = quiet.controller().terms(qd);
    for (const Setting& setting : {pushes, feels, plain}) {
      ClosedLoop loop = loop_of(setting);
      loop.observe(0.3, y);
      for (int times = 0; times < 2; ++times) {  // the second one finds the sweeps at the right side of c
        const long before = requests;
        const RecursiveTerms& terms = loop.controller().terms(qd);
        CHECK(requests == before);
        // the same lines, see above; cond(Omega) < 1e5
        CHECK((terms.c_plus_g - due.c_plus_g).norm() <= 6 * eps * 1e5 * due.c_plus_g.norm());
        CHECK((terms.c - due.c).norm() <= 6 * eps * 1e5 * due.c.norm());
        CHECK((terms.g - due.g).norm() <= 6 * eps * 1e5 * due.g.norm());
      }
    }
  }
}

TEST_CASE("a restart point does not overfill what has room for six") {
  VectorX<double> seven = VectorX<double>::Ones(7);
  UpTo6 six;
  Memory written;
  written(seven);
  Memory read(written.numbers());
  CHECK_THROWS_AS(read(six), MemoryMismatch);
}

}  // namespace osculate::testing::closed_loop_tests
