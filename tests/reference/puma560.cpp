// The dense formulation against numbers that others computed and published: the test suite of the Robotics
// Toolbox for Python (petercorke/robotics-toolbox-python, tests/test_DHRobot.py, MIT licence) for the PUMA
// 560 of Corke & Armstrong-Helouvry (ICRA 1994). The arm is built here from the standard Denavit-Hartenberg
// table. Every number is matched to half a unit of its last printed digit.
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "model/friction.hpp"
#include "model/urdf.hpp"
#include "reference/dense.hpp"
#include "support/catch.hpp"

namespace osculate::testing::puma560_tests {
using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

namespace {

constexpr double pi = std::numbers::pi;

struct Row {  // source: the table named above; motor values on the motor's side of the gear
  double d, a, alpha_quarters /* alpha in quarter turns */, m;
  Vector3<double> r,
      I;  // centre of mass and diagonal inertia about it, in the frame at the far end of the link
  double Jm, gear, B, Tc_positive, Tc_negative;
};

const std::vector<Row> table = {
    {0.67183, 0, 1, 0, {0, 0, 0}, {0, 0.35, 0}, 200e-6, -62.6111, 1.48e-3, 0.395, -0.435},
    {0,
     0.4318,
     0,
     17.4,
     {-0.3638, 0.006, 0.2275},
     {0.130, 0.524, 0.539},
     200e-6,
     107.815,
     0.817e-3,
     0.126,
     -0.071},
    {0.15005,
     0.0203,
     -1,
     4.8,
     {-0.0203, -0.0141, 0.070},
     {0.066, 0.086, 0.0125},
     200e-6,
     -53.7063,
     1.38e-3,
     0.132,
     -0.105},
    {0.4318, 0, 1, 0.82, {0, 0.019, 0}, {1.8e-3, 1.3e-3, 1.8e-3}, 33e-6, 76.0364, 71.2e-6, 11.2e-3, -16.9e-3},
    {0, 0, -1, 0.34, {0, 0, 0}, {0.3e-3, 0.4e-3, 0.3e-3}, 33e-6, 71.923, 82.6e-6, 9.26e-3, -14.5e-3},
    {0, 0, 0, 0.09, {0, 0, 0.032}, {0.15e-3, 0.15e-3, 0.04e-3}, 33e-6, 76.686, 36.7e-6, 3.96e-3, -10.5e-3}};

/// Link i's frame sits at joint i: frame i-1 of the table turned by q_i. The far end is B_i = Tz(d) Tx(a)
/// Rx(alpha) on.
Chain<double> puma560() {
  Chain<double> chain;
  Matrix3<double> R = Matrix3<double>::Identity();
  Vector3<double> p = Vector3<double>::Zero();
  for (const Row& row : table) {
    Link<double> link;
    link.R_origin = R;
    link.p_origin = p;
    R = rotation<double>(Vector3<double>::UnitX(), row.alpha_quarters == 0 ? 1 : 0, row.alpha_quarters);
    p = {row.a, 0, row.d};
    link.mass = row.m;
    link.com = p + R * row.r;
    link.inertia = R * row.I.asDiagonal() * R.transpose();
    link.armature = row.Jm * row.gear * row.gear;
    chain.links.push_back(link);
  }
  chain.R_tip = R;
  chain.p_tip = p;
  chain.gravity = {0, 0, -9.81};
  return chain;
}

/// Friction of the table at the joint's side. The smoothing speed is so small that tanh is 1 at the speeds
/// used here.
Vector friction(const Vector& qd) {
  Vector out(6);
  for (int i = 0; i < 6; ++i) {
    const Row& row = table[static_cast<std::size_t>(i)];
    const double gear = std::abs(row.gear);
    out[i] = qd[i] == 0
                 ? 0
                 : friction_torque(
                       {row.B * gear * gear, gear * row.Tc_positive, -gear * row.Tc_negative, 1e-3}, qd[i]);
  }
  return out;
}

Vector vector(std::initializer_list<double> x) {
  Vector out(x.size());
  std::copy(x.begin(), x.end(), out.begin());
  return out;
}

const Vector zero = Vector::Zero(6);
const Vector one = Vector::Ones(6);
const Vector nominal = vector({0, pi / 4, pi, 0, pi / 4, 0});

dense::State<double> at(const Chain<double>& chain, const Vector& qd) {
  return dense::state(chain, positions<double>(chain, {nominal.data(), 6}), qd);
}

Vector inverse_dynamics(const dense::State<double>& x, const Vector& qdd) {
  return x.joint.M * qdd + x.joint.C + x.joint.G;
}

/// Compares with numbers as printed, separated by blanks.
void check_printed(const std::string& printed, const Matrix& row_by_row) {
  std::istringstream in(printed);
  std::string word;
  for (Eigen::Index i = 0; i < row_by_row.rows(); ++i)
    for (Eigen::Index j = 0; j < row_by_row.cols(); ++j) {
      REQUIRE(in >> word);
      const auto point = word.find('.');
      const int digits = point == std::string::npos ? 4 : static_cast<int>(word.size() - point - 1);
      INFO("row " << i << " column " << j << " printed " << word);
      CHECK(std::abs(row_by_row(i, j) - std::stod(word)) <= 0.5 * std::pow(10.0, -digits));
    }
  REQUIRE_FALSE(in >> word);
}

}  // namespace

TEST_CASE("PUMA 560: gravity load") {
  check_printed("0 31.6399 6.0351 0 0.0283 0", at(puma560(), zero).joint.G.transpose());
}

TEST_CASE("PUMA 560: inverse dynamics") {
  const auto rest = at(puma560(), zero);
  const auto moving = at(puma560(), one);
  Chain<double> weightless = puma560();
  weightless.gravity.setZero();
  check_printed("3.35311 36.0025 7.42596 0.190043 0.203441 0.194133",
                inverse_dynamics(rest, one).transpose());
  check_printed("32.4952 60.867 17.7436 1.45452 1.29911 0.713781",
                (inverse_dynamics(moving, one) + friction(one)).transpose());
  check_printed("29.1421 56.5044 16.3528 1.26448 1.12392 0.519648",
                (inverse_dynamics(moving, zero) + friction(one)).transpose());
  check_printed("32.4952 29.2271 11.7085 1.45452 1.27086 0.713781",
                (inverse_dynamics(at(weightless, one), one) + friction(one)).transpose());
}

TEST_CASE("PUMA 560: a wrench exerted by the tip is carried by the joints") {
  const auto x = at(puma560(), zero);
  const Vector3<double> in_tip_frame(1, 2, 3);
  dense::Vector6<double> wrench;
  wrench << x.tip.R * in_tip_frame, x.tip.R * in_tip_frame;
  check_printed("0.642756 29.0866 4.70321 2.82843 -1.97175 3.0000",
                (x.joint.G + x.tip.J.transpose() * wrench).transpose());
  // The same through forward dynamics: with that torque, and the reaction on the tip, the arm stands still.
  const Vector T = x.joint.G + x.tip.J.transpose() * wrench;
  const Vector qdd = dense::forward_dynamics<double>(x.joint, x.tip.J, T, -wrench);
  // Rounding of torques of about 32 N m, over the smallest eigenvalue of M, which is above 0.17 kg m^2
  // (armature).
  CHECK(qdd.norm() <= 10 * std::numeric_limits<double>::epsilon() * T.norm() / 0.17);
}

TEST_CASE("PUMA 560: joint-space inertia") {
  const Matrix M = at(puma560(), zero).joint.M;
  check_printed(
      "3.6594 -0.4044 0.1006 -0.0025 0 0  -0.4044 4.4137 0.3509 0 0.0024 0  0.1006 0.3509 0.9378 0 0.0015 0 "
      "-0.0025 0 0 0.1925 0 0  0 0.0024 0.0015 0 0.1713 0  0 0 0 0 0 0.1941",
      M);
  check_printed("3.1500 9.4805 3.6189 0.1901 0.3519 0.5823", (M * vector({1, 2, 3, 1, 2, 3})).transpose());
}

TEST_CASE("PUMA 560: forward dynamics with friction") {
  const Vector qd = vector({0.1, 0.2, 0.8, 0.2, 0.5, 1});
  const Vector T = vector({1, 3.2, 1.8, 0.1, 0.7, 4.6});
  const auto x = at(puma560(), qd);
  check_printed("-7.4102 -9.8432 -10.9694 -4.4314 -0.9881 21.0228",
                dense::forward_dynamics<double>(x.joint, x.tip.J, T - friction(qd)).transpose());
}

TEST_CASE("PUMA 560: centrifugal and Coriolis torque") {
  Matrix printed(6, 6);
  printed << -.1735, -2.0494, -.1178, -.0002, -.0045, .0001,  //
      .6274, 1.1572, 1.9287, -.0015, -.0003, 0,               //
      -.3608, -.7734, -.0018, -.0009, -.0064, 0,              //
      .0011, .0005, -.0001, .0002, .0002, -.0001,             //
      -.0002, .0028, .0046, -.0002, 0, 0,                     //
      .0001, 0, 0, 0, 0, 0;
  const Vector qd = vector({1, 2, 3, 1, 2, 3});
  const Vector difference = at(puma560(), qd).joint.C - printed * qd;
  // Each row is a sum over columns printed to half a unit of 1e-4 each.
  CHECK(difference.cwiseAbs().maxCoeff() <= 0.5e-4 * qd.sum());
}

TEST_CASE("PUMA 560: operational-space inertia at the tip, and manipulability") {
  const auto x = at(puma560(), zero);
  const std::vector<int> v_then_w = {3, 4, 5, 0, 1, 2};
  const auto task = dense::mobility(x.tip, x.joint, v_then_w);
  check_printed(
      "17.2954 -2.7542 -9.6233 0 0.2795 0  -2.7542 12.1909 1.2459 -0.3254 -0.0703 -0.9652 "
      "-9.6233 1.2459 13.3348 0 0.2767 0  0 -0.3254 0 0.1941 0 0.1941 "
      "0.2795 -0.0703 0.2767 0 0.1713 0  0 -0.9652 0 0.1941 0 0.5791",
      dense::task_terms(task).Lambda);
  const auto yoshikawa = [&](const Matrix& J) {
    return Matrix::Constant(1, 1, std::sqrt((J * J.transpose()).determinant()));
  };
  check_printed("0.0786", yoshikawa(x.tip.J));
  check_printed("0.111181", yoshikawa(x.tip.J.bottomRows<3>()));
  check_printed("2.44949", yoshikawa(x.tip.J.topRows<3>()));
}

TEST_CASE("PUMA 560: the model file says the same as the table") {
  ChainChoice choice;
  choice.base = "base_link";
  choice.tip = "tool0";
  choice.gravity = {0, 0, -9.81};
  Chain<double> file = load_urdf(OSCULATE_SOURCE_DIR "/models/puma560.urdf", choice).chain;
  const Chain<double> own = puma560();
  REQUIRE(file.n() == 6);
  for (std::size_t i = 0; i < 6; ++i) file.links[i].armature = own.links[i].armature;
  const Vector qd = vector({1, -2, 3, -1, 2, -3});
  const auto x = at(file, qd);
  const auto y = at(own, qd);
  // The file turns by angles whose cosines are 6e-17 instead of 0, and its offsets are rounded sums: 20 eps
  // of the largest entry of each quantity, six joints with some three roundings each.
  const double tol = 20 * std::numeric_limits<double>::epsilon();
  const auto close = [&](const Matrix& a, const Matrix& b) {
    return (a - b).cwiseAbs().maxCoeff() <= tol * b.cwiseAbs().maxCoeff();
  };
  CHECK(close(x.joint.M, y.joint.M));
  CHECK(close(x.joint.C, y.joint.C));
  CHECK(close(x.joint.G, y.joint.G));
  CHECK(close(x.tip.J, y.tip.J));
  CHECK(close(x.tip.R, y.tip.R));
  CHECK(close(x.tip.p, y.tip.p));
}

}  // namespace osculate::testing::puma560_tests
