// Operational coordinates against src/reference/coordinates.hpp in long double: the judge differentiates y
// along a motion of the pose and knows no Pi. A bound is a factor times eps times a condition; every claim is
// also shown to fail when an input is moved so that the result moves by ten times the bound.
#include "control/coordinates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "reference/coordinates.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"
#include "support/singular_values.hpp"

namespace osculate::testing::coordinates_tests {

namespace {

using Wide = long double;
using WidePose = dense::Transform<Wide>;
using WideMotion = dense::TimeDerivatives<VectorX<Wide>>;
using O = OrientationCoordinates;
using P = PositionCoordinates;

constexpr double pi = std::numbers::pi;
constexpr int samples = 300;

const CoordinateChart parts[] = {
    {O::roll_pitch_yaw, {}}, {O::zyz_euler, {}},   {O::quaternion, {}},
    {{}, P::cartesian},      {{}, P::cylindrical}, {{}, P::spherical},
};

std::string title(const CoordinateChart& chart) {
  std::string out;
  if (chart.orientation()) out.append(" ").append(name(*chart.orientation()));
  if (chart.position()) out.append(" ").append(name(*chart.position()));
  return out;
}

double largest(const auto& x) { return static_cast<double>(x.cwiseAbs().maxCoeff()); }

struct Random {
  std::mt19937 bits{20240611};

  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits()) * 0x1p-32);
  }
  /// A cosine or sine of the angle that makes coordinates singular: 0.002 to 1, either sign, as many in each
  /// decade.
  double distance() { return std::pow(10, uniform(-2.7, 0)) * (bits() % 2 == 0 ? 1 : -1); }
  template <class V>
  V vector(int size, double limit) {
    V out(size);
    for (double& x : out) x = uniform(-limit, limit);
    return out;
  }
  Vector6 six(double limit) { return vector<Vector6>(6, limit); }
};

dense::Transform<Wide> turn(const Vector3<Wide>& axis, double angle) {
  return {rotation(axis, std::cos(Wide(angle)), std::sin(Wide(angle))), Vector3<Wide>::Zero()};
}

/// Orthonormal to long double. A third of the poses come near the singularities of each representation of the
/// orientation, all of them near those of the position; none comes nearer than 0.0019.
WidePose random_pose(Random& random) {
  const Vector3<Wide> X = Vector3<Wide>::UnitX(), Y = Vector3<Wide>::UnitY(), Z = Vector3<Wide>::UnitZ();
  const double d = random.distance();
  const double middle[] = {std::asin(d), std::acos(d), random.uniform(-pi, pi)};
  const WidePose turned = turn(Z, random.uniform(-pi, pi)) * turn(Y, middle[random.bits() % 3]) *
                          turn(random.bits() % 2 == 0 ? X : Z, random.uniform(-pi, pi));
  const double phi = random.uniform(-pi, pi), rho = 1.5 * std::abs(random.distance());
  const Wide cos_pitch = std::hypot(turned.R(2, 1), turned.R(2, 2));
  const Wide sin_b = std::hypot(turned.R(0, 2), turned.R(1, 2));
  if (std::min(cos_pitch, sin_b) < Wide(0.0019)) return random_pose(random);
  return {turned.R, {Wide(rho * std::cos(phi)), Wide(rho * std::sin(phi)), Wide(random.uniform(-1, 1))}};
}

Pose rounded(const WidePose& at) { return {at.R.cast<double>(), at.p.cast<double>()}; }

/// y, yd, ydd of the moving pose in long double, on the branch nearest to `near`.
WideMotion judged(const CoordinateChart& chart, const WidePose& at, const Vector6& beta, const Vector6& betad,
                  const Coordinates& near) {
  const auto moving = dense::moving_pose<Wide>(at.R, at.p, beta.cast<Wide>(), betad.cast<Wide>());
  const int size = chart.size(), m = chart.orientation_size();
  WideMotion out{VectorX<Wide>(size), VectorX<Wide>(size), VectorX<Wide>(size)};
  const auto put = [&](int row, const auto& y) {
    const auto part = dense::time_derivatives(y);
    const auto n = y.size();
    out.y.segment(row, n) = part.y, out.yd.segment(row, n) = part.yd, out.ydd.segment(row, n) = part.ydd;
  };
  if (chart.orientation() == O::roll_pitch_yaw) put(0, dense::roll_pitch_yaw(moving.R));
  if (chart.orientation() == O::zyz_euler) put(0, dense::zyz_euler(moving.R));
  if (chart.orientation() == O::quaternion) {
    Eigen::Index i = 0;
    near.head<4>().cwiseAbs().maxCoeff(&i);
    put(0, dense::quaternion(moving.R, static_cast<int>(i)));
    if (near[i] < 0) out = {-out.y, -out.yd, -out.ydd};
  }
  if (chart.position() == P::cylindrical) put(m, dense::cylindrical(moving.p));
  if (chart.position() == P::spherical) put(m, dense::spherical(moving.p));
  if (chart.position() == P::cartesian) put(m, moving.p);
  const Wide whole_turn = 2 * std::acos(Wide(-1));
  const std::vector<CoordinateName> names = chart.names();
  for (int i = 0; i < size; ++i)
    if (names[static_cast<std::size_t>(i)].unit == "rad")
      out.y[i] += whole_turn * std::round((Wide(near[i]) - out.y[i]) / whole_turn);
  return out;
}

/// Singular values of Pi, by its columns; of a quaternion the three that are not zero.
struct Singular {
  double smallest, condition;
  Singular(const CoordinateChart& chart, const Coordinates& y) {
    Eigen::MatrixXd Pi(6, chart.size());
    for (int i = 0; i < chart.size(); ++i) {
      Coordinates unit = Coordinates::Zero(chart.size());
      unit[i] = 1;
      Pi.col(i) = chart.velocity(y, unit);
    }
    const Eigen::VectorXd sigma = singular_values(Pi);
    smallest = sigma[(chart.orientation() ? 3 : 0) + chart.position_size() - 1];
    condition = sigma[0] / smallest;
  }
};

/// A claim: error <= factor * eps * scale, in every sample; and not so for the moved result.
struct Claim {
  double factor;
  double worst = 0, least_moved = std::numeric_limits<double>::infinity();

  explicit Claim(double f) : factor(f) {}
  /// How far results are moved, to see the claim fail.
  double move(double scale) const { return 10 * factor * eps * scale; }
  void see(double scale, double error, double error_moved) {
    const bool numbers = std::isfinite(error) && std::isfinite(error_moved);
    worst = std::max(worst, numbers ? error / (eps * scale) : std::numeric_limits<double>::infinity());
    least_moved = std::min(least_moved, error_moved / (eps * scale));
  }
};

void check(const char* what, const Claim& claim) {
  INFO(what << ": worst " << claim.worst << " eps scale, moved at least " << claim.least_moved);
  CHECK(claim.worst <= claim.factor);
  CHECK(claim.least_moved > claim.factor);
}

}  // namespace

TEST_CASE("y, Pi, its inverse and Pi. agree with the differentiated coordinates") {
  for (const CoordinateChart& chart : parts) {
    Random random;
    // Worst seen: y 0.6, round trip 1.4, rates and velocity 1.5, bias and accelerations 1.4, sigma 4.
    Claim of_y(8), of_rates(8), of_velocity(8), of_bias(8), of_accelerations(8), of_trip(8), of_sigma(20);
    for (int i = 0; i < samples; ++i) {
      const WidePose at = random_pose(random);
      const Pose pose = rounded(at);
      const Vector6 beta = random.six(1), betad = random.six(1);
      const Coordinates near = chart.coordinates(pose);
      const WideMotion truth = judged(chart, at, beta, betad, near);
      const Coordinates y = truth.y.cast<double>(), yd = truth.yd.cast<double>(),
                        ydd = truth.ydd.cast<double>();
      const Singular Pi(chart, y);
      const auto off = [](const auto& x, const auto& wide) {
        return largest(VectorX<Wide>(x.template cast<Wide>() - wide));
      };

      // R and p come rounded to eps, which turns the coordinates by up to eps / sigma.
      double scale = largest(y) + 1 / Pi.smallest;
      Pose moved = pose;
      const Vector3<double> turn_by = of_y.move(scale) * beta.head<3>().normalized();
      moved.R += dense::cross_matrix(turn_by) * pose.R;
      moved.p += of_y.move(scale) * beta.tail<3>().normalized();
      of_y.see(scale, off(near, truth.y), off(chart.coordinates(moved, y), truth.y));
      const Coordinates there = chart.coordinates(chart.pose(y), y);
      const Coordinates beside = y + of_trip.move(scale) / largest(yd) * yd;
      of_trip.see(scale, largest(there - y), largest(chart.coordinates(chart.pose(beside), y) - y));

      // Rows of Pi have elements up to max(1, r): Pi yd sums terms of that size.
      const double norm = Pi.condition * Pi.smallest;
      scale = Pi.condition * largest(yd);
      double more = 1 + of_rates.move(scale) / largest(yd);
      of_rates.see(scale, off(chart.rates(y, beta), truth.yd), off(chart.rates(y, more * beta), truth.yd));

      const int row = chart.orientation() ? 0 : 3;
      const auto part = [row](const Vector6& x) { return Vector3<Wide>(x.segment<3>(row).cast<Wide>()); };
      const Vector3<Wide> velocity = part(beta), acceleration = part(betad);
      scale = norm * largest(yd);
      more = 1 + of_velocity.move(scale) / largest(velocity);
      of_velocity.see(scale, largest(part(chart.velocity(y, yd)) - velocity),
                      largest(part(chart.velocity(y, more * yd)) - velocity));

      scale = norm * (largest(ydd) + largest(yd) * largest(yd));
      const Vector3<Wide> from_ydd = part(chart.velocity(y, ydd));
      const Vector6 extra = of_bias.move(scale) * Vector6::Ones();
      of_bias.see(scale, largest(from_ydd + part(chart.bias(y, yd)) - acceleration),
                  largest(from_ydd + part(chart.bias(y, yd) + extra) - acceleration));

      scale = Pi.condition * (largest(ydd) + largest(yd) * largest(yd));
      const Vector6 push = of_accelerations.move(scale) / largest(yd) * beta;  // moves ydd along yd
      of_accelerations.see(scale, off(chart.accelerations(y, yd, betad), truth.ydd),
                           off(chart.accelerations(y, yd, betad + push), truth.ydd));

      // The singular value decomposition is exact to eps times the largest one.
      const double smallest = chart.smallest_singular_value(y);
      of_sigma.see(norm, std::abs(smallest - Pi.smallest),
                   std::abs(smallest + of_sigma.move(norm) - Pi.smallest));
    }
    INFO(title(chart));
    check("y", of_y);
    check("round trip", of_trip);
    check("rates", of_rates);
    check("velocity", of_velocity);
    check("bias", of_bias);
    check("accelerations", of_accelerations);
    check("smallest singular value", of_sigma);
  }
}

TEST_CASE("beta. = u = Pi v + Pi. yd makes ydd = v") {
  for (const CoordinateChart& chart : parts) {
    Random random;
    Claim from_y(8), from_pose(8);  // worst seen: 1.6 and 1.6
    for (int i = 0; i < samples; ++i) {
      const WidePose at = random_pose(random);
      const Vector6 beta = random.six(1);
      const Coordinates near = chart.coordinates(rounded(at));
      const WideMotion now = judged(chart, at, beta, Vector6::Zero(), near);
      const Coordinates v = random.vector<Coordinates>(chart.size(), 10);
      const auto missed = [&](const Coordinates& y, const Coordinates& yd, double along) {
        const Vector6 u = chart.command(y, yd, v) + along * chart.velocity(y, v);
        const WideMotion then = judged(chart, at, beta, u, near);
        return largest(VectorX<Wide>(then.ydd - chart.attainable(y, yd, v).cast<Wide>()));
      };
      const Coordinates y = now.y.cast<double>(), yd = now.yd.cast<double>();
      const Singular Pi(chart, y);
      const double moves = largest(chart.rates(y, chart.velocity(y, v)));  // ydd moves by `along` times this

      // The command from exact coordinates: rounding of u, magnified by Pi^-1.
      double scale = Pi.condition * (largest(v) + largest(yd) * largest(yd));
      from_y.see(scale, missed(y, yd, 0), missed(y, yd, from_y.move(scale) / moves));

      // From the pose and beta: the pose's rounding costs 1 / sigma in y, and Pi^-1 magnifies it once more.
      const Coordinates found = chart.rates(near, beta);
      scale *= Pi.condition;
      from_pose.see(scale, missed(near, found, 0), missed(near, found, from_pose.move(scale) / moves));
    }
    INFO(title(chart));
    check("from y", from_y);
    check("from the pose", from_pose);
  }
}

TEST_CASE("the tracking law gives each coordinate the error e'' + D e' + K e = 0") {
  const CoordinateChart charts[] = {{O::roll_pitch_yaw, P::cylindrical},
                                    {O::zyz_euler, P::spherical},
                                    {O::quaternion, P::cartesian},
                                    {O::roll_pitch_yaw, {}},
                                    {{}, P::spherical}};
  for (const CoordinateChart& chart : charts) {
    Random random;
    Claim law(4);  // worst seen: 0.6
    const int n = chart.size();
    for (int i = 0; i < samples; ++i) {
      const WidePose at = random_pose(random), target = random_pose(random);
      const Vector6 beta = random.six(1);
      const TipReference reference{rounded(target), random.six(1), random.six(1)};
      const Coordinates K = random.vector<Coordinates>(n, 10) + Coordinates::Constant(n, 11);
      const Coordinates D = random.vector<Coordinates>(n, 3) + Coordinates::Constant(n, 4);

      const Coordinates y = chart.coordinates(rounded(at));
      const Coordinates yd = chart.rates(y, beta);
      const CoordinateMotion wanted = chart.motion(reference, y);
      const Coordinates v = tracking_acceleration(wanted, y, yd, K, D);
      const WideMotion goal = judged(chart, target, reference.velocity, reference.acceleration, wanted.y);
      const auto left_over = [&](double along) {
        const Vector6 u = chart.command(y, yd, v) + along * beta;
        const WideMotion tip = judged(chart, at, beta, u, y);
        VectorX<Wide> out = goal.ydd - tip.ydd + D.cast<Wide>().cwiseProduct(goal.yd - tip.yd) +
                            K.cast<Wide>().cwiseProduct(goal.y - tip.y);
        if (chart.orientation() == O::quaternion) {
          const VectorX<Wide> e = tip.y.head(4);
          out.head(4) -= e.dot(out.head(4)) * e;
        }
        return largest(out);
      };
      const double here = Singular(chart, y).condition, there = Singular(chart, wanted.y).condition;
      const double of_tip = here * here * (largest(v) + largest(yd) * largest(yd));
      const double of_goal = there * there *
                             (largest(wanted.ydd) + largest(D) * largest(wanted.yd) +
                              largest(wanted.yd) * largest(wanted.yd) + largest(K) * largest(wanted.y));
      const double scale = of_tip + of_goal;
      law.see(scale, left_over(0), left_over(law.move(scale) / largest(yd)));
      if (chart.orientation() != O::quaternion)
        CHECK(largest((wanted.y - y).head(3)) <= pi * (1 + 4 * eps));  // the short way round
      else
        CHECK((wanted.y.head<4>() - y.head<4>()).norm() <= std::sqrt(2) * (1 + 4 * eps));
    }
    INFO(title(chart));
    check("law", law);
  }
}

TEST_CASE("the two parts do not know of each other") {
  Random random;
  const WidePose at = random_pose(random);
  const Pose pose = rounded(at);
  const Vector6 beta = random.six(1), betad = random.six(1);
  for (const CoordinateChart& a : {parts[0], parts[1], parts[2]})
    for (const CoordinateChart& b : {parts[3], parts[4], parts[5]}) {
      const CoordinateChart both(a.orientation(), b.position());
      const auto joined = [](const Coordinates& x, const Coordinates& y) {
        Coordinates out(x.size() + y.size());
        out << x, y;
        return out;
      };
      INFO(title(both));
      const Coordinates ya = a.coordinates(pose), yb = b.coordinates(pose), y = both.coordinates(pose);
      const Coordinates xa = a.rates(ya, beta), xb = b.rates(yb, beta), x = both.rates(y, beta);
      CHECK(y == joined(ya, yb));
      CHECK(x == joined(xa, xb));
      CHECK(both.accelerations(y, x, betad) ==
            joined(a.accelerations(ya, xa, betad), b.accelerations(yb, xb, betad)));
      CHECK(both.attainable(y, x, y) == joined(a.attainable(ya, xa, ya), b.attainable(yb, xb, yb)));
      CHECK(both.command(y, x, y) == a.command(ya, xa, ya) + b.command(yb, xb, yb));
      CHECK(both.pose(y).R == a.pose(ya).R);
      CHECK(both.pose(y).p == b.pose(yb).p);
      CHECK(both.smallest_singular_value(y) ==
            std::min(a.smallest_singular_value(ya), b.smallest_singular_value(yb)));
      CHECK(both.names().size() == static_cast<std::size_t>(both.size()));
      CHECK(a.command(ya, xa, ya).tail<3>().isZero(0));
      CHECK(b.command(yb, xb, yb).head<3>().isZero(0));
    }
}

TEST_CASE("angles and quaternions follow the tip over several turns") {
  // Turning about z: yaw, a and phi advance; the quaternion changes sign with every turn.
  const CoordinateChart rpy(O::roll_pitch_yaw, P::cylindrical), zyz(O::zyz_euler, P::spherical),
      free(O::quaternion, {});
  const Vector3<double> Z = Vector3<double>::UnitZ();
  const Matrix3<double> tilt = rotation<double>(Vector3<double>::UnitY(), std::cos(0.7), std::sin(0.7));
  const auto at = [&](double angle) {
    const Matrix3<double> turned = rotation<double>(Z, std::cos(angle), std::sin(angle));
    return Pose{turned * tilt, turned * Vector3<double>(0.4, 0, 0.3)};
  };
  Coordinates a = rpy.coordinates(at(0)), b = zyz.coordinates(at(0)), e = free.coordinates(at(0));
  for (const double way : {1.0, -1.0}) {
    for (double t = 0; t <= 24; t += 0.5) {  // nearly four turns, there and back
      const double angle = way > 0 ? t : 24 - t;
      a = rpy.coordinates(at(angle), a);
      b = zyz.coordinates(at(angle), b);
      e = free.coordinates(at(angle), e);
      // Angles of 24 carry 24 eps, and their cosines bring as much into the pose; times 1 / cos(0.7) or
      // 1 / sin(0.7) at most 1.6.
      const double tolerance = 2 * 1.6 * 24 * eps;
      INFO("angle " << angle);
      const double w = std::cos(angle / 2) * std::cos(0.35), z = std::sin(angle / 2) * std::cos(0.35);
      for (const double off :
           {a[2] - angle, a[4] - angle, b[0] - angle, b[5] - angle, a[0], b[2], e[0] - w, e[3] - z})
        CHECK(std::abs(off) <= tolerance);
      // A step of 10 tolerances is seen.
      CHECK(std::abs(rpy.coordinates(at(angle + 10 * tolerance), a)[2] - angle) > tolerance);
      CHECK(std::abs(zyz.coordinates(at(angle + 10 * tolerance), b)[5] - angle) > tolerance);
    }
  }
  CHECK((e - free.coordinates(at(0))).norm() <= 24 * 4 * eps);
  // Without a previous value: the principal one.
  CHECK(std::abs(rpy.coordinates(at(24))[2]) <= pi);
  CHECK(free.coordinates(at(7))[0] > 0);
  // The reference is found on the tip's turn, its quaternion on the tip's side.
  TipReference reference;
  reference.pose = at(0.1);
  a[2] = 24.2;
  CHECK(std::abs(rpy.motion(reference, a).y[2] - (0.1 + 8 * pi)) <= 2 * 1.6 * 8 * pi * eps);
  CHECK(free.motion(reference, -e).y[0] < 0);
}

TEST_CASE("singular coordinates are refused by name") {
  const auto message = [](const CoordinateChart& chart, const Pose& pose) -> std::string {
    try {
      chart.coordinates(pose);
    } catch (const RepresentationSingular& error) { return error.what(); }
    return "";
  };
  const auto tilted = [](double angle) {
    return Pose{rotation<double>(Vector3<double>::UnitY(), std::cos(angle), std::sin(angle)), {0, 0, 0}};
  };
  const auto placed = [](double x, double y, double z) {
    return Pose{Matrix3<double>::Identity(), {x, y, z}};
  };
  const CoordinateChart &rpy = parts[0], &zyz = parts[1], &cylindrical = parts[4], &spherical = parts[5];
  const CoordinateChart free(O::quaternion, P::cartesian);
  CHECK(message(rpy, tilted(pi / 2 - 1e-4)) ==
        "tip: roll_pitch_yaw coordinates are singular at pitch = 1.5707 rad: the smallest singular value of "
        "Pi is 7.07107e-05, must be >= 0.001. Choose the quaternion, which has no singular orientation, or "
        "move the path away.");
  CHECK(message(cylindrical, placed(3e-4, -4e-4, 1)) ==
        "tip: cylindrical coordinates are singular at rho = 0.0005 m: the smallest singular value of Pi is "
        "0.0005, must be >= 0.001. Choose cartesian coordinates, which have no singular position, or move "
        "the path away.");
  const auto names = [&](const CoordinateChart& chart, const Pose& pose, const char* coordinate) {
    const std::string start = "tip:" + title(chart) + " coordinates are singular at " + coordinate + ":";
    return message(chart, pose).rfind(start, 0) == 0;
  };
  CHECK(names(rpy, tilted(-pi / 2), "pitch = -1.5708 rad"));
  CHECK(names(zyz, tilted(0), "b = 0 rad"));
  CHECK(names(zyz, tilted(pi), "b = 3.14159 rad"));
  CHECK(names(cylindrical, placed(0, 0, 1), "rho = 0 m"));
  CHECK(names(spherical, placed(0, 0, 0), "r = 0 m"));
  CHECK(names(spherical, placed(0, 0, 2), "theta = 0 rad"));
  CHECK(names(spherical, placed(0, 1e-4, -2), "theta = 3.14154 rad"));
  // The limit itself, from both sides; what each representation cannot do another can.
  CHECK(message(cylindrical, placed(0, -1.001e-3, 0)).empty());
  CHECK(!message(cylindrical, placed(0, -0.999e-3, 0)).empty());
  CHECK(message(spherical, placed(1.001e-3, 0, 5)).empty());
  CHECK(!message(spherical, placed(0.999e-3, 0, 5)).empty());
  CHECK(message(rpy, tilted(pi / 2 - 1.415e-3)).empty());  // cos(pitch) / sqrt(1 + |sin(pitch)|) = 1.0006e-3
  CHECK(!message(rpy, tilted(pi / 2 - 1.413e-3)).empty());
  CHECK(message(zyz, tilted(1.415e-3)).empty());
  CHECK(!message(zyz, tilted(1.413e-3)).empty());
  for (const double angle : {0.0, pi / 2, -pi / 2, pi}) CHECK(message(free, tilted(angle)).empty());
  TipReference reference;
  reference.pose = tilted(pi / 2);
  std::string text = message(rpy, reference.pose);
  CHECK_THROWS_WITH(rpy.motion(reference), text.replace(0, 3, "reference"));
  const Coordinates level = Coordinates::Zero(3);
  CHECK_THROWS_AS(zyz.rates(level, Vector6::Ones()), RepresentationSingular);
  CHECK_THROWS_AS(spherical.accelerations(level, level, Vector6::Ones()), RepresentationSingular);
}

TEST_CASE("charts that cannot be are refused, and coordinates have names and units") {
  CHECK_THROWS_WITH(CoordinateChart({}, {}),
                    "coordinates: neither orientation nor position is chosen: choose one.");
  CHECK_THROWS_WITH(CoordinateChart(O::rotation_vector, P::cartesian),
                    "coordinates: rotation_vector is a law for the orientation error, not coordinates: use "
                    "pose_error, or choose roll_pitch_yaw, zyz_euler or quaternion.");
  const auto listed = [](const CoordinateChart& chart) {
    std::string out;
    for (const CoordinateName& c : chart.names()) out.append(c.name).append("/").append(c.unit).append(" ");
    return out;
  };
  CHECK(listed({O::roll_pitch_yaw, P::cartesian}) == "roll/rad pitch/rad yaw/rad x/m y/m z/m ");
  CHECK(listed({O::zyz_euler, P::cylindrical}) == "a/rad b/rad c/rad rho/m phi/rad z/m ");
  CHECK(listed({O::quaternion, P::spherical}) == "qw/1 qx/1 qy/1 qz/1 r/m theta/rad phi/rad ");
  CHECK(listed({{}, P::spherical}) == "r/m theta/rad phi/rad ");
}

}  // namespace osculate::testing::coordinates_tests
