#include "simulation/contact.hpp"

#include <cmath>

#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::contact_tests {

namespace {

using V3 = Vector3<double>;

Environment plane() {
  return {.surface = Plane{{5, -7, 0.5}, {0, 0, 2}},  // z = 0.5, the material below
          .stiffness = 1000,
          .damping = 10,
          .friction = 0.5,
          .v_s = 0.01};
}
Environment ball() {
  Environment out = plane();
  out.surface = Ball{{1, 0, 0}, 0.5};
  return out;
}

V3 force(const Environment& environment, const V3& p, const V3& v) {
  return touch(environment, p, v, true).wrench.tail<3>();
}

}  // namespace

TEST_CASE("plane: gap, pressure and wrench by hand") {
  // depth 0.01 m at 0.2 m/s: 1000 0.01 + 10 0.2 = 12 N; slip (0.03, 0.04) of 0.05 m/s = 5 v_s.
  const V3 p(0.3, -0.2, 0.49), v(0.03, 0.04, -0.2);
  const Touch at = touch(plane(), p, v, true);
  CHECK(at.gap == Approx(-0.01).epsilon(100 * eps));  // 0.49 - 0.5 cancels
  CHECK(at.entry == 0.2);
  CHECK(at.pressure == Approx(12).epsilon(100 * eps));
  CHECK(at.normal == V3(0, 0, 1));
  CHECK(at.wrench.head<3>() == V3::Zero());
  CHECK(at.wrench[3] == Approx(-0.5 * 12 * std::tanh(5) * 0.6).epsilon(100 * eps));
  CHECK(at.wrench[4] == Approx(-0.5 * 12 * std::tanh(5) * 0.8).epsilon(100 * eps));
  CHECK(at.wrench[5] == Approx(12).epsilon(100 * eps));
}

TEST_CASE("plane: a slanted normal of any length") {
  Environment environment = plane();
  environment.friction = 0;
  for (const double length : {1e-200, 1.0, 1e200}) {
    environment.surface = Plane{V3::Zero(), length * V3(3, 0, 4)};
    const Touch at = touch(environment, {-0.3, 0.9, -0.4}, {0.6, 7, 0.8}, true);  // depth 0.5, leaves at 1
    CHECK(at.gap == Approx(-0.5).epsilon(4 * eps));
    CHECK(at.entry == Approx(-1).epsilon(4 * eps));
    CHECK((at.wrench.tail<3>() - 490 * V3(0.6, 0, 0.8)).norm() <= 8 * eps * 510);
  }
}

TEST_CASE("ball: gap, pressure and wrench by hand") {
  // 0.48 m from the centre along n = (0.6, 0, 0.8): depth 0.02 m; 0.1 m/s inwards: 20 + 1 = 21 N.
  const V3 n(0.6, 0, 0.8), side(0.8, 0, -0.6);
  const Touch at = touch(ball(), V3(1, 0, 0) + 0.48 * n, -0.1 * n + 0.02 * side, true);
  CHECK(at.gap == Approx(-0.02).epsilon(100 * eps));
  CHECK(at.entry == Approx(0.1).epsilon(8 * eps));
  CHECK(at.pressure == Approx(21).epsilon(100 * eps));
  CHECK((at.normal - n).norm() <= 4 * eps);
  CHECK(at.wrench.head<3>() == V3::Zero());
  CHECK((at.wrench.tail<3>() - 21 * n + 0.5 * 21 * std::tanh(2) * side).norm() <= 200 * eps * 21);
  const Touch centre = touch(ball(), {1, 0, 0}, {0, 0, -1}, true);
  CHECK(centre.gap == -0.5);
  CHECK(centre.wrench.tail<3>() == V3(0, 0, 510));
}

TEST_CASE("without contact there is no wrench, but gap and pressure are the same") {
  for (const auto& environment : {plane(), ball()})
    for (const V3& p : {V3(1.1, 0.2, 0.3), V3(1, 1, 1)}) {
      const V3 v(0.2, -0.1, -0.4);
      const Touch on = touch(environment, p, v, true), off = touch(environment, p, v, false);
      CHECK(off.wrench == Vector6::Zero());
      CHECK(on.wrench != Vector6::Zero());
      CHECK(off.gap == on.gap);
      CHECK(off.pressure == on.pressure);
      CHECK(off.entry == on.entry);
      CHECK(off.normal == on.normal);
    }
}

TEST_CASE("mode: inside where the surface pushes, at the surface unless leaving") {
  const auto mode = [](double z, double vz, double damping) {
    Environment environment = plane();
    environment.surface = Plane{};
    environment.damping = damping;
    return touches(touch(environment, {0, 0, z}, {0, 0, vz}, false));
  };
  CHECK(mode(-0.01, 0, 10));
  CHECK(mode(-0.01, 0.9, 10));        // 10 N - 9 N
  CHECK_FALSE(mode(-0.01, 1.1, 10));  // 10 N - 11 N: the surface cannot follow
  CHECK(mode(-0.01, 1.1, 0));
  CHECK_FALSE(mode(0.01, -5, 10));  // would push, but is not reached
  for (const double damping : {0.0, 10.0}) {
    CHECK(mode(0, -0.1, damping));
    CHECK(mode(0, 0, damping));
    CHECK_FALSE(mode(0, 0.1, damping));
    CHECK_FALSE(mode(1e-300, 0, damping));
  }
}

TEST_CASE("friction is odd in slip, opposes it, stays below Coulomb's and has no kink") {
  const V3 p(0, 0, 0.48);  // 20 N
  const double normal_force = force(plane(), p, V3::Zero())[2];
  CHECK(force(plane(), p, V3::Zero()).head<2>() == V3::Zero().head<2>());
  double before = 0;
  for (const double slip : {1e-300, 1e-170, 1e-9, 1e-4, 1e-3, 0.01, 0.03, 0.1, 100.0}) {
    INFO("slip " << slip);
    const V3 v = slip * V3(0.28, -0.96, 0);
    const V3 there = force(plane(), p, v), back = force(plane(), p, -v);
    CHECK(there.head<2>() == -back.head<2>());
    CHECK(there[2] == normal_force);
    const double expected = 0.5 * normal_force * std::tanh(slip / 0.01);
    CHECK(there.dot(v / slip) == Approx(-expected).epsilon(16 * eps));
    CHECK(std::abs(there[0] * 0.96 + there[1] * 0.28) <= 4 * eps * expected);  // nothing across the slip
    CHECK(expected > before);
    CHECK(expected <= 0.5 * normal_force);
    if (slip < 0.1) before = expected;  // tanh is 1 from there on
  }
  // d force / d slip at 0 is -friction 20 N / v_s = -1000 N s/m; tanh x = x (1 - x^2/3 + ...), x = 1e-6.
  CHECK(force(plane(), p, {1e-8, 0, 0})[0] ==
        Approx(-0.5 * normal_force / 0.01 * 1e-8).epsilon(1e-12 / 3 + 16 * eps));
}

TEST_CASE("a large ball is a plane") {
  const V3 v(0.03, -0.02, -0.1);
  Environment flat = plane();
  flat.surface = Plane{};
  const double x = 0.03, y = -0.05, z = -0.01;
  const Touch on_plane = touch(flat, {x, y, z}, v, true);
  for (const double radius : {10.0, 1e3, 1e5}) {
    Environment round = plane();
    round.surface = Ball{{0, 0, -radius}, radius};
    const Touch on_ball = touch(round, {x, y, z}, v, true);
    // sqrt((R + z)^2 + rho^2) - R = z + rho^2 / (2 (R + z)) - ..., the next term below (rho/R)^2 of this one.
    const double rho = std::hypot(x, y), bulge = rho * rho / (2 * (radius + z)), rounding = 4 * eps * radius;
    CHECK(on_ball.gap - on_plane.gap ==
          Approx(bulge).epsilon(rho * rho / (radius * radius)).margin(rounding));
    const double tilt = rho / (radius + z);  // of the normal
    CHECK((on_ball.normal - on_plane.normal).norm() <= tilt);
    // The normal force changes by 1000 bulge + 10 |v| tilt, and tilts; friction by the half of both, and by
    // its slope, at most 0.5 11 N / v_s, times the change of the slip, at most 2 |v| tilt.
    const double pressure = on_plane.pressure, change = 1000 * (bulge + rounding) + 10 * v.norm() * tilt;
    const double allowed =
        1.5 * (change + (pressure + change) * tilt) + 0.5 * (pressure + change) / 0.01 * 2 * v.norm() * tilt;
    CHECK((on_ball.wrench - on_plane.wrench).norm() <= allowed);
    CHECK(on_ball.wrench != on_plane.wrench);
  }
}

TEST_CASE("every number of an environment counts") {
  const V3 p(1.1, 0.2, 0.38), v(0.003, 0.001, -0.02);
  const auto differs = [&](const Environment& base, const auto& change) {
    Environment other = base;
    change(other);
    return touch(other, p, v, true).wrench != touch(base, p, v, true).wrench;
  };
  for (const auto& base : {plane(), ball()}) {
    CHECK_FALSE(differs(base, [](Environment&) {}));
    CHECK(differs(base, [](Environment& e) { e.stiffness *= 1.01; }));
    CHECK(differs(base, [](Environment& e) { e.damping *= 1.01; }));
    CHECK(differs(base, [](Environment& e) { e.friction *= 1.01; }));
    CHECK(differs(base, [](Environment& e) { e.v_s *= 1.01; }));
  }
  CHECK(differs(plane(), [](Environment& e) { std::get<Plane>(e.surface).point[2] += 0.001; }));
  CHECK_FALSE(differs(plane(), [](Environment& e) { std::get<Plane>(e.surface).point[0] += 0.001; }));
  CHECK(differs(plane(), [](Environment& e) { std::get<Plane>(e.surface).normal[0] += 0.001; }));
  CHECK(differs(ball(), [](Environment& e) { std::get<Ball>(e.surface).centre[0] += 0.001; }));
  CHECK(differs(ball(), [](Environment& e) { std::get<Ball>(e.surface).radius += 0.001; }));
}

namespace {

/// A point mass in a uniform field that meets a surface. y = p, v, energy lost in the surface.
struct Thrown {
  using State = Eigen::Matrix<double, 7, 1>;
  Environment environment;
  double mass = 2;          // kg
  V3 field{0.4, -0.3, -1};  // m/s^2
  State y = State::Zero();
  double t = 0;  // s
  bool in_contact = false;

  Touch at(const State& x) const { return touch(environment, x.head<3>(), x.segment<3>(3), in_contact); }
  Touch at() const { return at(y); }
  State rate(const State& x) const {
    const Touch here = at(x);
    State out;
    out << x.segment<3>(3), field + here.wrench.tail<3>() / mass,
        lost_power(environment, here, x.segment<3>(3), in_contact);
    return out;
  }
  /// Classical Runge-Kutta of fourth order.
  State after(double h) const {
    const State k1 = rate(y), k2 = rate(y + h / 2 * k1), k3 = rate(y + h / 2 * k2), k4 = rate(y + h * k3);
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  /// In steps of h to the first change of sign of event(Touch), which the last step ends just after. The sign
  /// is that after one step: at the start it may be zero.
  template <class Event>
  void run_to(const Event& event, double h) {
    const bool positive = event(at(after(h))) > 0;
    const auto changed = [&](double step) { return (event(at(after(step))) > 0) != positive; };
    for (; !changed(h); t += h) {
      REQUIRE(t < 1);
      y = after(h);
    }
    double low = 0, high = h;
    for (int i = 0; i < 60; ++i) (changed((low + high) / 2) ? high : low) = (low + high) / 2;
    y = after(high);
    t += high;
  }
  double mechanical() const {
    return mass * (y.segment<3>(3).squaredNorm() / 2 - field.dot(y.head<3>())) +
           stored_energy(environment, at(), in_contact);
  }
};

double gap_of(const Touch& at) { return at.gap; }
double pressure_of(const Touch& at) { return at.pressure; }

struct Bounce {
  double imbalance;                  // J, over the whole bounce
  double lost_in_contact, lost;      // J
  double released_with, taken_away;  // J, stored at the release, kinetic energy lost
};

/// From just before the touch until the tip has left the material, with every mode change by `touches`.
Bounce bounce(const Environment& environment, const V3& p, const V3& v, double h) {
  Thrown body{environment};
  body.y << p, v, 0;
  const double start = body.mechanical();
  const auto change_mode = [&](bool expected) {
    const double before = body.mechanical();
    body.in_contact = touches(body.at());
    REQUIRE(body.in_contact == expected);
    CHECK(std::abs(body.mechanical() - before) <= 1e-12 * start);  // the event is found to 1e-18 s or so
  };
  body.run_to(gap_of, h);
  change_mode(true);
  body.run_to(pressure_of, h);
  Bounce out{};
  out.lost_in_contact = body.y[6];
  out.released_with = stored_energy(environment, body.at(), true);
  change_mode(false);
  if (body.at().gap < 0) body.run_to(gap_of, h);
  CHECK_FALSE(touches(body.at()));
  CHECK(body.at().gap >= 0);
  out.lost = body.y[6];
  out.imbalance = body.mechanical() + body.y[6] - start;
  return out;
}

}  // namespace

TEST_CASE("energy of a bounce: kinetic + field + stored + lost stays, through every mode") {
  struct Shot {
    Environment environment;
    V3 p, v;
  };
  // v_s = 0.1: friction's fastest rate, 0.5 60 N / (2 kg 0.1 m/s) = 150/s, is resolved by these steps.
  Environment on_plane = plane(), on_ball = ball();
  on_plane.v_s = on_ball.v_s = 0.1;
  for (const auto& [environment, p, v] :
       {Shot{on_plane, {0, 0, 0.51}, {0.7, 0.2, -1}}, Shot{on_ball, {1.1, 0, 0.51}, {-0.3, 0.4, -1}}}) {
    const Bounce coarse = bounce(environment, p, v, 4e-4), fine = bounce(environment, p, v, 2e-4);
    // A fourth-order method: the finer run is wrong by a fifteenth of the difference, twice that is allowed.
    const double truncation = std::abs(coarse.imbalance - fine.imbalance) / 15;
    INFO("imbalance " << coarse.imbalance << ", " << fine.imbalance << " J");
    CHECK(std::abs(fine.imbalance) <= 2 * truncation + 2000 * eps * 2);  // steps, rounding of 2 J in each
    CHECK(truncation < 1e-7);
    CHECK(fine.lost_in_contact > 0.1);  // of 1 J
    CHECK(fine.released_with > 1e-4);   // the damped surface is left before it is flat again
    // After the release the surface relaxes by itself: what it had stored is lost.
    CHECK(fine.lost - fine.lost_in_contact == Approx(fine.released_with).epsilon(1e-7));
  }
  Environment elastic = plane();
  elastic.damping = elastic.friction = 0;
  const Bounce back = bounce(elastic, {0, 0, 0.51}, {0.7, 0.2, -1}, 2e-4);
  CHECK(back.lost == 0);
  CHECK(back.released_with <= 1e-12);
}

TEST_CASE("power: what the tip loses is stored or lost, at any state") {
  const V3 v(0.02, -0.013, -0.3);
  for (const auto& environment : {plane(), ball()})
    for (const double speed : {-6.0, -1.0, 0.0, 0.5, 1.0}) {
      const V3 p(1.05, 0.1, 0.47), u = speed * v;
      const double scale = 1000 * 0.05 * u.norm() + 60 * u.squaredNorm();
      for (const bool in_contact : {true, false}) {
        INFO("speed " << speed << ", in contact " << in_contact);
        const Touch at = touch(environment, p, u, in_contact);
        const double stored_rate = environment.stiffness * at.gap * -at.entry;  // d/dt (k gap^2 / 2)
        const double lost = lost_power(environment, at, u, in_contact);
        CHECK(at.gap < 0);
        CHECK(std::abs(at.wrench.tail<3>().dot(u) + stored_rate + lost) <= 16 * eps * scale);
        if (touches(at) == in_contact) CHECK(lost >= 0);
      }
    }
  const Touch outside = touch(plane(), {0, 0, 0.6}, v, false);
  CHECK(stored_energy(plane(), outside, false) == 0);
  CHECK(lost_power(plane(), outside, v, false) == 0);
  const Touch inside = touch(plane(), {0, 0, 0.25}, v, true);
  CHECK(stored_energy(plane(), inside, true) == 1000 * 0.25 * 0.25 / 2);
}

}  // namespace osculate::testing::contact_tests
