// The arms that come with the program, against the tables they were written from.
#include <algorithm>
#include <filesystem>
#include <numbers>

#include "chain_kinematics.hpp"
#include "scalar/eps.hpp"
#include "urdf_text.hpp"

namespace osculate::testing::models_tests {
using namespace textbook;
using std::numbers::pi;

namespace {

ArmDescription model(const std::string& name, const std::string& tip = "tool0",
                     const Vector3d& gravity = {0, 0, -9.81}) {
  ChainChoice choice;
  choice.base = "base_link";
  choice.tip = tip;
  choice.gravity = gravity;
  return load_urdf(std::string(OSCULATE_SOURCE_DIR) + "/models/" + name, choice);
}

double mass_of(const Chain<double>& chain) {
  double mass = 0;
  for (const auto& l : chain.links) mass += l.mass;
  return mass;
}

struct DH {
  double alpha, a, d;
};

// Corke set, standard DH: alpha_i, a_i, d_i.
const std::vector<DH> corke = {{pi / 2, 0, 0.67183}, {0, 0.4318, 0},  {-pi / 2, 0.0203, 0.15005},
                               {pi / 2, 0, 0.4318},  {-pi / 2, 0, 0}, {0, 0, 0}};
// AKB86 set, modified DH: alpha_{i-1}, a_{i-1}, d_i.
const std::vector<DH> akb86 = {
    {0, 0, 0},       {-pi / 2, 0, 0.2435}, {0, 0.4318, -0.0934}, {pi / 2, -0.0203, 0.4331},
    {-pi / 2, 0, 0}, {pi / 2, 0, 0}};

Matrix4d standard(const std::vector<DH>& table, const VectorXd& q) {
  Matrix4d T = Matrix4d::Identity();
  for (int i = 0; i < 6; ++i)
    T = T * turn_z(q[i]) * shift(0, 0, table[i].d) * shift(table[i].a, 0, 0) * turn_x(table[i].alpha);
  return T;
}

Matrix4d modified(const std::vector<DH>& table, const VectorXd& q) {
  Matrix4d T = Matrix4d::Identity();
  for (int i = 0; i < 6; ++i)
    T = T * turn_x(table[i].alpha) * shift(table[i].a, 0, 0) * turn_z(q[i]) * shift(0, 0, table[i].d);
  return T;
}

std::vector<VectorXd> puma_poses() {
  std::vector<VectorXd> all;
  const auto add = [&](std::vector<double> q) { all.push_back(Eigen::Map<VectorXd>(q.data(), 6)); };
  add({0, 0, 0, 0, 0, 0});
  add({0, pi / 2, -pi / 2, 0, 0, 0});  // ready
  add({0, 0, -pi / 2, 0, 0, 0});       // stretched
  add({0, pi / 4, pi, 0, pi / 4, 0});  // nominal
  add({0.3, -1.2, 0.7, 2.1, -0.4, -2.5});
  add({-2.0, 0.9, -2.2, -1.3, 1.6, 0.1});
  return all;
}

// Six levels of two or three products each, entries and lengths of order one.
constexpr double tol_pose = 6 * 3 * 8 * eps;

}  // namespace

TEST_CASE("puma560.urdf stands where its standard DH table says") {
  const auto arm = model("puma560.urdf");
  REQUIRE(arm.chain.n() == 6);
  for (const auto& q : puma_poses()) {
    INFO("q = " << q.transpose());
    CHECK((poses(arm.chain, q).back() - standard(corke, q)).cwiseAbs().maxCoeff() <= tol_pose);
  }
}

TEST_CASE("puma560_akb86.urdf stands where its modified DH table says") {
  const auto arm = model("puma560_akb86.urdf");
  REQUIRE(arm.chain.n() == 6);
  for (const auto& q : puma_poses()) {
    INFO("q = " << q.transpose());
    CHECK((poses(arm.chain, q).back() - modified(akb86, q)).cwiseAbs().maxCoeff() <= tol_pose);
  }
}

TEST_CASE("the tip of puma560.urdf in the nominal pose, worked out by hand") {
  const auto arm = model("puma560.urdf");
  VectorXd q(6);
  q << 0, pi / 4, pi, 0, pi / 4, 0;
  const Matrix4d T = poses(arm.chain, q).back();
  // In the x-z plane: a2 along pi/4, a3 along pi/4 + pi, d4 along -pi/4; d3 along -y.
  const double c = std::sqrt(0.5);
  const Vector3d wrist(0.4318 * c - 0.0203 * c + 0.4318 * c, -0.15005,
                       0.67183 + 0.4318 * c - 0.0203 * c - 0.4318 * c);
  CHECK((T.topRightCorner<3, 1>() - wrist).norm() <= tol_pose);
}

TEST_CASE("mass matrix and gravity torque of puma560.urdf are the published ones") {
  // petercorke/robotics-toolbox-python, tests/test_DHRobot.py, pose qn, g = 9.81 m/s^2, printed to four
  // decimals.
  constexpr double half_digit = 0.5e-4 * (1 + 1e-9);
  auto arm = model("puma560.urdf");
  const double Jm[] = {200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6};
  const double gear[] = {-62.6111, 107.815, -53.7063, 76.0364, 71.923, 76.686};
  for (int i = 0; i < 6; ++i) arm.chain.links[i].armature = Jm[i] * gear[i] * gear[i];
  VectorXd q(6);
  q << 0, pi / 4, pi, 0, pi / 4, 0;
  const auto [M, G] = mass_and_gravity(arm.chain, q);
  VectorXd G_published(6);
  G_published << 0, 31.6399, 6.0351, 0, 0.0283, 0;
  MatrixXd M_published(6, 6);
  M_published << 3.6594, -0.4044, 0.1006, -0.0025, 0, 0,  //
      -0.4044, 4.4137, 0.3509, 0, 0.0024, 0,              //
      0.1006, 0.3509, 0.9378, 0, 0.0015, 0,               //
      -0.0025, 0, 0, 0.1925, 0, 0,                        //
      0, 0.0024, 0.0015, 0, 0.1713, 0,                    //
      0, 0, 0, 0, 0, 0.1941;
  INFO("M\n" << M << "\nG " << G.transpose());
  CHECK((M - M_published).cwiseAbs().maxCoeff() <= half_digit);
  CHECK((G - G_published).cwiseAbs().maxCoeff() <= half_digit);
}

TEST_CASE("both PUMA files are read with their oddities, each said once") {
  const auto arm = model("puma560.urdf");
  CHECK(arm.inertia_concerns == std::vector<std::string>{"link 'link1': mass 0 kg, inertia only"});
  REQUIRE(arm.warnings.size() == 2);
  CHECK(urdf_text::says(arm.warnings[0], {"link 'link1'", "(0, 0, 0.35)", "triangle"}));
  CHECK(urdf_text::says(arm.warnings[1], {"link 'link3'", "(0.0125, 0.066, 0.086)", "triangle"}));
  CHECK(arm.joints[0].lower == Approx(-160 * pi / 180));
  const auto akb = model("puma560_akb86.urdf");
  REQUIRE(akb.warnings.size() == 1);
  CHECK(urdf_text::says(akb.warnings[0], {"link 'link1'"}));
  CHECK(akb.chain.links[2].inertia == Matrix3d(Vector3d(0.066, 0.0125, 0.066).asDiagonal()));
}

TEST_CASE("planar_2r.urdf has the closed form that its header gives") {
  const auto arm = model("planar_2r.urdf", "tip");
  const double l1 = 1, c1 = 0.5, m1 = 2, I1 = 0.2, l2 = 0.8, c2 = 0.4, m2 = 1.5, I2 = 0.1, g = 9.81;
  constexpr double tol = 32 * 40 * eps;  // about 32 operations on terms up to 40 N m
  for (const double q1 : {0.0, 0.4, -2.0})
    for (const double q2 : {0.0, 1.3, -0.7}) {
      VectorXd q(2);
      q << q1, q2;
      INFO("q = " << q.transpose());
      const auto [M, G] = mass_and_gravity(arm.chain, q);
      const Vector3d tip = poses(arm.chain, q).back().topRightCorner<3, 1>();
      CHECK(std::abs(tip[0] - (l1 * std::cos(q1) + l2 * std::cos(q1 + q2))) <= tol);
      CHECK(std::abs(tip[2] - (l1 * std::sin(q1) + l2 * std::sin(q1 + q2))) <= tol);
      CHECK(tip[1] == 0);
      CHECK(std::abs(M(0, 0) - (I1 + I2 + m1 * c1 * c1 +
                                m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * std::cos(q2)))) <= tol);
      CHECK(std::abs(M(0, 1) - (I2 + m2 * (c2 * c2 + l1 * c2 * std::cos(q2)))) <= tol);
      CHECK(std::abs(M(1, 1) - (I2 + m2 * c2 * c2)) <= tol);
      CHECK(std::abs(G[0] - ((m1 * c1 + m2 * l1) * g * std::cos(q1) + m2 * c2 * g * std::cos(q1 + q2))) <=
            tol);
      CHECK(std::abs(G[1] - m2 * c2 * g * std::cos(q1 + q2)) <= tol);
    }
}

TEST_CASE("every file of models/ loads; names, masses and zero poses are as its header and the index say") {
  struct Row {
    std::string file, tip;
    int n, prismatic;
    double mass;
    Vector3d zero;  // tip position at q = 0
  };
  const std::vector<Row> rows = {
      {"arm7.urdf", "tool0", 7, 0, 18.3, {0, 0, 1.25}},
      {"chain60.urdf", "tip", 60, 0, 10.035, {0, 0, 6}},
      {"planar_2r.urdf", "tip", 2, 0, 3.5, {1.8, 0, 0}},
      {"prismatic_arm.urdf", "tool0", 6, 1, 19.1, {0, 0.25, 1.18}},
      {"puma560.urdf", "tool0", 6, 0, 23.45, {0.4521, -0.15005, 1.10363}},
      {"puma560_akb86.urdf", "tool0", 6, 0, 23.45, {0.4115, 0.1501, 0.4331}},
      {"ur5e_like.urdf", "tool0", 6, 0, 17.7, {-0.8172, -0.2329, 0.0628}},
  };
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(OSCULATE_SOURCE_DIR) + "/models"))
    if (entry.path().extension() == ".urdf") files.push_back(entry.path().filename().string());
  std::sort(files.begin(), files.end());
  std::vector<std::string> known;
  for (const auto& row : rows) known.push_back(row.file);
  for (const char* on_a_moving_base : {"mobile_arm.urdf", "satellite_arm.urdf"})
    known.push_back(on_a_moving_base);
  std::sort(known.begin(), known.end());
  CHECK(files == known);
  for (const auto& row : rows) {
    INFO(row.file);
    const auto arm = model(row.file, row.tip);
    CHECK(arm.chain.n() == row.n);
    int prismatic = 0;
    for (const auto& joint : arm.joints) {
      prismatic += joint.type == JointType::prismatic;
      CHECK(joint.lower.has_value());
      CHECK(joint.upper.has_value());
      CHECK(joint.damping == 0);
      CHECK(joint.friction == 0);
    }
    CHECK(prismatic == row.prismatic);
    CHECK(std::abs(mass_of(arm.chain) - row.mass) <= row.n * eps * row.mass);
    const Vector3d tip = poses(arm.chain, VectorXd::Zero(row.n)).back().topRightCorner<3, 1>();
    CHECK((tip - row.zero).norm() <= row.n * 3 * 8 * eps * std::max(1.0, row.zero.norm()));
    if (!row.file.starts_with("puma")) CHECK(arm.warnings.empty());
  }
}

TEST_CASE("planar and floating joints of a file become joints with several coordinates") {
  const auto arm_on = [](const std::string& name, const std::string& base) {
    ChainChoice choice;
    choice.base = base;
    choice.tip = "tool0";
    return load_urdf(std::string(OSCULATE_SOURCE_DIR) + "/models/" + name, choice).chain;
  };
  const Chain<double> mobile = arm_on("mobile_arm.urdf", "ground");
  CHECK(mobile.n() == 6);
  CHECK(mobile.positions() == 8);
  CHECK(mobile.velocities() == 8);
  const Link<double>& platform = mobile.links.front();
  CHECK(platform.type == JointType::planar);
  CHECK(platform.axis == Vector3d::UnitZ());
  CHECK(platform.axis2 == Vector3d::UnitX());
  CHECK(!mobile.one_axis_joints());

  const Chain<double> satellite = arm_on("satellite_arm.urdf", "world");
  CHECK(satellite.n() == 7);
  CHECK(satellite.positions() == 13);
  CHECK(satellite.velocities() == 12);
  CHECK(satellite.links.front().type == JointType::floating);
}

TEST_CASE("the first direction of a planar joint lies in its plane, whatever the normal") {
  for (const char* normal : {"1 0 0", "0 1 0", "0.6 0 0.8", "-2 1 3"}) {
    using namespace urdf_text;
    const std::string axis = std::string("<axis xyz=\"") + normal + "\"/>";
    const ArmDescription arm =
        load(robot(a_link("base", "") + a_link("one") + a_joint("j1", "base", "one", "planar", axis)), "one");
    const Link<double>& link = arm.chain.links.front();
    INFO(normal);
    CHECK(std::abs(link.axis.dot(link.axis2)) <= 4 * eps);
    CHECK(std::abs(link.axis2.norm() - 1) <= 4 * eps);
  }
}

}  // namespace osculate::testing::models_tests
