// Doubles in vector registers against the generic code in long double, for every kind of joint. Built for
// the instruction set of the build, and for AVX2 and FMA even where that has neither; depends on headers
// alone.
//
// What an error may be is measured, not guessed: the same answers in long double, from numbers each of which
// is changed by a part in 2^30. The change of an answer over 2^-30 is its condition, and the error must stay
// below a constant times eps times that. The right sides are sums of accelerations as large as gravity, which
// may cancel (behind a floating joint gravity is not felt): their condition is at least that.
#include <sstream>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/worst.hpp"

using namespace osculate;
using namespace osculate::testing;
using Long = long double;

namespace {

/// An arm, its state and what acts on it.
template <Field S>
struct Situation {
  Chain<S> chain;
  std::vector<JointPosition<S>> positions;
  std::vector<S> qd, T, F;  // F: (moment; force) on the tip
};

template <Field S>
struct Answer {
  std::string name;
  std::vector<S> numbers;
};

template <class H, Field S = typename H::Scalar>
std::vector<Answer<S>> answers(const Situation<S>& of, bool columns) {
  std::vector<Answer<S>> out;
  const auto add = [&](const char* name, const auto& v) {
    out.push_back({std::string(name) + ", angular", {v.ang.x, v.ang.y, v.ang.z}});
    out.push_back({std::string(name) + ", linear", {v.lin.x, v.lin.y, v.lin.z}});
  };
  const Vec<Force, S> F{{of.F[0], of.F[1], of.F[2]}, {of.F[3], of.F[4], of.F[5]}};
  BasicOperationalSpace<H> space(of.chain);
  space.place(of.positions);
  if constexpr (in_link_frames<H>)
    space.sweep(of.qd, of.T, F);
  else
    columns ? space.sweep_from_tip(of.qd, of.T, F) : space.sweep(of.qd, of.T, F);
  Answer<S> J{"Omega, angular", {}}, B{"Omega, mixed", {}}, A{"Omega, linear", {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      J.numbers.push_back(component(space.Omega(), i, j));
      B.numbers.push_back(component(space.Omega(), i, j + 3));
      A.numbers.push_back(component(space.Omega(), i + 3, j + 3));
    }
  out.insert(out.end(), {J, B, A});
  add("right side", space.right_side());
  add("tip velocity", space.tip_velocity());
  add("right side of g", space.right_side_of_g());
  out.push_back({"tip", {space.tip_position().x, space.tip_position().y, space.tip_position().z}});
  Answer<S> T{"torque", std::vector<S>(of.qd.size())};
  space.torques(F, T.numbers);
  out.push_back(T);
  if constexpr (!in_link_frames<H>) {
    BasicForwardDynamics<H> plant(of.chain);
    plant.place(of.positions);
    Answer<S> qdd{"qdd", std::vector<S>(of.qd.size())};
    plant.accelerations(of.qd, of.T, F, qdd.numbers);
    out.push_back(qdd);
    add("tip acceleration", plant.tip_acceleration());
    out.push_back({"energy", {plant.kinetic_energy(of.qd)}});
  }
  return out;
}

/// The same situation in long double; each number times 1 + change, a new one every time.
template <class Change>
Situation<Long> in_long(const Situation<double>& of, const Change& change) {
  Situation<Long> out{cast<Long>(of.chain), {}, {}, {}, {}};
  const auto move = [&](auto& numbers) {
    for (Long& x : numbers.reshaped()) x *= 1 + change();
  };
  for (auto& l : out.chain.links) {
    for (auto* v : {&l.p_origin, &l.com}) move(*v);
    for (auto* R : {&l.R_origin, &l.inertia}) move(*R);
    l.mass *= 1 + change(), l.armature *= 1 + change();
  }
  move(out.chain.p_tip), move(out.chain.gravity);
  for (const auto& p : of.positions) {
    out.positions.push_back({p.c * (1 + change()), p.s * (1 + change()), p.d * (1 + change()),
                             p.R.cast<Long>(), p.p.cast<Long>()});
    move(out.positions.back().R), move(out.positions.back().p);
  }
  for (const double x : of.qd) out.qd.push_back(x * (1 + change()));
  for (const double x : of.T) out.T.push_back(x * (1 + change()));
  for (const double x : of.F) out.F.push_back(x * (1 + change()));
  return out;
}

double distance(const std::vector<Long>& a, const auto& b) {
  Long out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, std::abs(a[i] - Long(b[i])));
  return static_cast<double>(out);
}

/// Doubles through joints of type H against long doubles through L, by four sweeps.
template <class H, class L>
void compare(const RandomArm& arm, std::uint64_t seed, const std::string& which, Worst& worst,
             bool columns = false) {
  Random random(seed);
  Situation<double> given{arm.chain, arm.positions, {arm.qd.begin(), arm.qd.end()}, {}, {}};
  for (std::size_t i = 0; i < given.qd.size(); ++i) given.T.push_back(random.uniform(-20, 20));
  for (int i = 0; i < 6; ++i) given.F.push_back(random.uniform(-20, 20));
  const auto got = answers<H>(given, columns);
  const auto exact = answers<L>(in_long(given, [] { return Long(0); }), false);
  std::vector<double> condition(exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i)
    if (exact[i].name.starts_with("right side")) condition[i] = arm.chain.gravity.norm();
  for (int draw = 0; draw < 4; ++draw) {
    const auto moved = answers<L>(in_long(given, [&] { return random.sign() * 0x1p-30; }), false);
    for (std::size_t i = 0; i < exact.size(); ++i)
      condition[i] = std::max(condition[i], distance(exact[i].numbers, moved[i].numbers) * 0x1p30);
  }
  for (std::size_t i = 0; i < got.size(); ++i) {
    INFO(which << ": " << exact[i].name);
    REQUIRE(got[i].name == exact[i].name);
    REQUIRE(got[i].numbers.size() == exact[i].numbers.size());
    const double error = distance(exact[i].numbers, got[i].numbers);
    if (error != 0) worst.see(error, condition[i], which + ": " + exact[i].name);
  }
}

}  // namespace

TEST_CASE("vector registers give what the generic code gives, revolute and prismatic joints") {
  Worst sweeps, columns, link_frames;
  for (int n = 1; n <= 9; ++n)
    for (unsigned seed = 1; seed <= 6; ++seed) {
      std::ostringstream which;
      const RandomArm arm = random_arm(seed, n);
      which << "random_arm(" << seed << ", " << n << "), " << letters(arm.chain);
      compare<Hinge<double>, Hinge<Long>>(arm, seed, which.str(), sweeps);
      compare<Hinge<double>, Hinge<Long>>(arm, seed, which.str(), columns, true);
      compare<LinkHinge<double>, Hinge<Long>>(arm, seed, which.str(), link_frames);
    }
  check_within("four sweeps", sweeps, 11);       // seen 2.4
  check_within("columns", columns, 10);          // seen 2.1
  check_within("link frames", link_frames, 60);  // seen 13
}

TEST_CASE("vector registers give what the generic code gives, joints with several axes") {
  Worst worst, columns;
  for (const JointType type : {JointType::cylindrical, JointType::universal, JointType::planar,
                               JointType::spherical, JointType::floating})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const RandomArm arm = random_arm_of(seed, {JointType::revolute, type, JointType::prismatic, type});
      const std::string which = letters(arm.chain) + ", seed " + std::to_string(seed);
      compare<Joint<double>, Joint<Long>>(arm, seed, which, worst);
      compare<Joint<double>, Joint<Long>>(arm, seed, which, columns, true);
    }
  check_within("four sweeps", worst, 10);  // seen 2.1
  check_within("columns", columns, 10);
}
