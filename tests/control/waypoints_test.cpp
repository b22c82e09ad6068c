#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "control/reference.hpp"
#include "control/rotation.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::waypoints_tests {

namespace {

constexpr double pi = 3.141592653589793;

/// A file with the given text, removed at the end of the scope.
struct File {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("osculate_waypoints_" + std::to_string(getpid()) + ".csv");
  explicit File(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
  ~File() { std::filesystem::remove(path); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
};

Pose start_pose() {
  Pose out;
  out.R = exp_rotation({0.4, -0.9, 0.2});
  out.p << 0.5, 0.25, 0.75;
  return out;
}

/// What make_path says about a file with this text, without the file's name in front.
std::string error_of(const std::string& text) {
  const File file(text);
  try {
    make_path(WaypointsOptions{file.path}, Pose{});
  } catch (const ReferenceError& error) {
    const std::string what = error.what(), name = file.path.string();
    return what.starts_with(name) ? what.substr(name.size()) : "no file name in: " + what;
  }
  return "no error";
}

/// A row whose orientation is exp(r) R0, as a quaternion of the given length.
std::string oriented_row(double t, const Pose& initial, const Eigen::Vector3d& r, double length = 1) {
  const Eigen::Vector4d q = length * quaternion(exp_rotation(r) * initial.R);
  std::ostringstream out;
  out.precision(17);
  out << t << ",0.5,0.25,0.75," << q[0] << "," << q[1] << "," << q[2] << "," << q[3] << "\n";
  return out.str();
}

const std::string header = "t,x,y,z\n", oriented_header = "t,x,y,z,qw,qx,qy,qz\n";

}  // namespace

TEST_CASE("waypoints: through the knots, at rest at both ends, held outside") {
  const File file(
      "# a comment\n\n t , x , y , z \r\n1, 0.5, 0.25, 0.75\n\n1.5,0.7,+0.25,0.75  # turn here\n  # another\n"
      "3,0.6,0.25,1.0e0\r\n3.25,0.5,0.25,0.5");
  const Pose initial = start_pose();
  const auto path = make_path(WaypointsOptions{file.path}, initial);
  const std::vector<double> times{1, 1.5, 3, 3.25};
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {0.2, 0, 0}, {0.1, 0, 0.25}, {0, 0, -0.25}};
  for (std::size_t i = 0; i < times.size(); ++i) {
    INFO("knot " << i);
    CHECK((path->at(times[i]).y.tail<3>() - points[i]).norm() <= 2 * eps);
    CHECK(path->at(times[i]).y.head<3>() == Eigen::Vector3d::Zero());
  }
  for (const double t : {0.0, 0.5, 3.25, 9.0}) {
    CHECK(path->at(t).y.tail<3>() == (t < 1 ? path->at(1).y : path->at(3.25).y).tail<3>());
    CHECK(path->at(t).yd == Vector6::Zero());
    CHECK(path->at(t).ydd == Vector6::Zero());
  }
  CHECK(path->at(1).yd == Vector6::Zero());
  // Just before the end: acceleration up to 6 |mean velocity| / h = 48 m/s^2, and a sum of terms of up to 12
  // m/s.
  const double before = std::nextafter(3.25, 0.0);
  CHECK(path->at(before).yd.norm() <= 48 * (3.25 - before) + 4 * eps * 12);
  CHECK(path->breakpoints() == times);
  CHECK(path->commanded() == std::array<bool, 6>{false, false, false, true, false, true});
}

TEST_CASE("waypoints: two derivatives are continuous at inner knots and consistent between them") {
  const File file(header + "0,0,0,0\n0.5,1,-1,2\n0.75,0,3,1\n2,0.5,0.5,0.5\n3,-1,0,0\n");
  const auto path = make_path(WaypointsOptions{file.path}, Pose{});
  for (const double t : {0.5, 0.75, 2.0}) {
    INFO("knot at " << t);
    const double before = std::nextafter(t, 0.0), gap = t - before;
    const auto left = path->at(before), right = path->at(t);
    // The largest terms added in this spline are 40 m, 65 m/s, 333 m/s^2 in sums of at most 4; just before a
    // knot the motion still lacks `gap` times the next derivative, at most 16 m/s, 102 m/s^2, 615 m/s^3.
    CHECK((left.y - right.y).norm() <= 4 * eps * 40 + 16 * gap);
    CHECK((left.yd - right.yd).norm() <= 4 * eps * 65 + 102 * gap);
    CHECK((left.ydd - right.ydd).norm() <= 4 * eps * 333 + 615 * gap);
  }
  for (const double t : {0.2, 0.6, 1.3, 2.5}) {
    // A cubic: the five-point formula is exact, h = 1/32 makes no rounding of its own.
    const double h = 1.0 / 32;
    const auto slope = [&](auto row) -> Vector6 {
      return (8 * (row(t + h) - row(t - h)) - (row(t + 2 * h) - row(t - 2 * h))) / (12 * h);
    };
    INFO("t " << t);
    const auto point = path->at(t);
    // Rounding: sums of terms up to 40 m and 65 m/s, times 1.5 / h.
    CHECK((slope([&](double x) -> Vector6 { return path->at(x).y; }) - point.yd).norm() <=
          4 * eps * 40 * 1.5 / h);
    CHECK((slope([&](double x) -> Vector6 { return path->at(x).yd; }) - point.ydd).norm() <=
          4 * eps * 65 * 1.5 / h);
  }
  CHECK(path->breakpoints() == std::vector<double>{0.5, 0.75, 2, 3});
}

TEST_CASE("waypoints: a straight motion in two points is the cubic 3x^2 - 2x^3") {
  const File file("\xEF\xBB\xBF" + header + "0,0,0,0\n2,1,0,0\n");
  const auto path = make_path(WaypointsOptions{file.path}, Pose{});
  for (const double x : {0.125, 0.5, 0.75}) {
    CHECK(path->at(2 * x).y[3] == Approx(3 * x * x - 2 * x * x * x).epsilon(4 * eps));
    CHECK(path->at(2 * x).yd[3] == Approx(3 * x * (1 - x)).epsilon(4 * eps));
  }
}

TEST_CASE("waypoints: orientations are reached, unwrapped, whatever the sign of the quaternion") {
  const Pose initial = start_pose();
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3;
  const std::vector<double> angles{0, 1, 2.5, 3.1, 1, -1, -3};
  std::string text = oriented_header;
  for (std::size_t i = 0; i < angles.size(); ++i)
    text += oriented_row(static_cast<double>(i), initial, angles[i] * axis, i % 2 == 0 ? 1.0005 : -0.9995);
  text += "7,0.5,0.25,0.75,-1.0005,0,0,0\n";  // -q and a length within 0.001 of 1
  const File file(text);
  const auto path = make_path(WaypointsOptions{file.path}, initial);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    INFO("knot " << i);
    CHECK((path->at(static_cast<double>(i)).y.head<3>() - angles[i] * axis).norm() <= 32 * eps);
    const auto tip = tip_reference(*path, initial, static_cast<double>(i));
    CHECK((tip.pose.R - exp_rotation(angles[i] * axis) * initial.R).norm() <= 64 * eps);
  }
  CHECK((tip_reference(*path, initial, 8).pose.R - Eigen::Matrix3d::Identity()).norm() <= 32 * eps);
}

TEST_CASE("waypoints: half a turn is reached from the side the motion comes from") {
  const std::string text =
      oriented_header + "0,0,0,0,1,0,0,0\n1,0,0,0,0.70710678,0,0,-0.70710678\n2,0,0,0,0,0,0,1\n";
  const File file(text);
  const auto path = make_path(WaypointsOptions{file.path}, Pose{});
  CHECK((path->at(2).y.head<3>() - Eigen::Vector3d(0, 0, -pi)).norm() <= 4 * eps * pi);
}

TEST_CASE("waypoints: turning further than pi is an error with its line") {
  std::string text = oriented_header;
  const double angles[] = {0, 2, 4};
  for (int i = 0; i < 3; ++i) text += oriented_row(i, Pose{}, {0, angles[i], 0});
  const std::string what = error_of(text);
  INFO(what);
  CHECK(what.starts_with(":4: orientation is 4"));
  CHECK(
      what.ends_with(" rad from the initial one, followed continuously: must be <= pi; turn less far, or the "
                     "other way."));
}

TEST_CASE("waypoint files that cannot be used are named with line, value and remedy") {
  CHECK(error_of("") == ": is empty; must start with the header t,x,y,z.");
  CHECK(error_of("# nothing\n\n") == ": is empty; must start with the header t,x,y,z.");
  CHECK(error_of(header + "0,0,0,0\n") == ": 1 waypoints: must be at least 2.");
  CHECK(error_of("0,0,0,0\n1,0,0,0\n") == ":1: header '0,0,0,0': must be t,x,y,z or t,x,y,z,qw,qx,qy,qz.");
  CHECK(error_of("# c\nt,x,y\n") == ":2: header 't,x,y': must be t,x,y,z or t,x,y,z,qw,qx,qy,qz.");
  CHECK(error_of(header + "0,0,0\n") == ":2: 3 values: must be 4, as in the header.");
  CHECK(error_of(header + "0,0,0,0,\n") == ":2: 5 values: must be 4, as in the header.");
  CHECK(error_of(oriented_header + "0,0,0,0\n") == ":2: 4 values: must be 8, as in the header.");
  CHECK(error_of(header + "0,0,0,0\n\n1,0,a1,0\n") == ":4: y = 'a1': must be a finite number.");
  CHECK(error_of(header + "0,0,,0\n") == ":2: y = '': must be a finite number.");
  CHECK(error_of(header + "0,0,0,nan\n") == ":2: z = 'nan': must be a finite number.");
  CHECK(error_of(header + "0,1e999,0,0\n") == ":2: x = '1e999': must be a finite number.");
  CHECK(error_of(header + "0,1.5m,0,0\n") == ":2: x = '1.5m': must be a finite number.");
  CHECK(error_of(header + "0,+-1,0,0\n") == ":2: x = '+-1': must be a finite number.");
  CHECK(error_of(header + "-0.5,0,0,0\n") == ":2: t = -0.5 s: the first time must be >= 0.");
  CHECK(error_of(header + "0,0,0,0\n1,0,0,0\n1,2,0,0\n") ==
        ":4: t = 1 s: must be > 1 s, the time of the waypoint before.");
  CHECK(error_of(oriented_header + "0,0,0,0,1.002,0,0,0\n") ==
        ":2: quaternion qw,qx,qy,qz of length 1.002: must be 1 within 0.001.");
  CHECK(error_of(oriented_header + "0,0,0,0,0,0,0,0\n") ==
        ":2: quaternion qw,qx,qy,qz of length 0: must be 1 within 0.001.");
}

TEST_CASE("a waypoint file that is not there is named") {
  CHECK_THROWS_WITH(make_path(WaypointsOptions{"no/such/file.csv"}, Pose{}),
                    "no/such/file.csv: no such file; check the path of reference.file.");
}

}  // namespace osculate::testing::waypoints_tests
