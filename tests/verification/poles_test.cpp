// Poles of the closed loop against those that the gains place.
#include "verification/poles.hpp"

#include <cmath>

#include "model/urdf.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"
#include "verification/claims.hpp"

namespace osculate::testing::poles_tests {
using Complex = std::complex<double>;

namespace {

const std::vector<double> bent{0, -0.8, 0.4, 0, 0.6, 0};             // rad, PUMA
const std::vector<double> seven{0.3, 0.5, 0.2, 1.2, 0.1, 0.8, 0.2};  // rad, arm7

Chain<double> chain_of(const std::string& urdf, bool weightless = false) {
  ChainChoice choice;
  choice.tip = "tool0";
  if (weightless) choice.gravity.setZero();
  return load_urdf(std::string(OSCULATE_SOURCE_DIR) + "/models/" + urdf, choice).chain;
}

/// A loop at rest at q, and its state there.
struct Resting {
  ClosedLoop loop;
  std::vector<double> y;

  Resting(const Chain<double>& model, const std::vector<double>& q, const LawOptions& law,
          std::unique_ptr<Path> path = make_path(HoldOptions{}), double payload = 0,
          const std::vector<JointFriction>& friction = {})
      : loop(Controller(model, friction, law, std::move(path), tip_pose(model, q)),
             plant(model, payload, friction)),
        y(loop.states(), 0.0) {
    std::copy(q.begin(), q.end(), y.begin());
  }
  PoleCheck check() { return check_poles(loop, 0, y); }
  PoleCheck check_against(const LawOptions& other) {
    return check_poles(loop, 0, y, other.stiffness, other.damping);
  }

  static Plant plant(const Chain<double>& model, double payload, const std::vector<JointFriction>& friction) {
    Plant out;
    out.chain = model;
    out.chain.links.back().mass += payload;
    out.friction = friction;
    return out;
  }
};

LawOptions gains(double stiffness, double damping) {
  LawOptions law;
  law.stiffness.setConstant(stiffness);
  law.damping.setConstant(damping);
  return law;
}

}  // namespace

TEST_CASE("designed poles are the roots of s^2 + D s + K without cancellation") {
  const std::vector<double> K{100, 100, 100, 1e-6, 0, 0}, D{0, 20, 50, 1e3, 5, 0};
  const auto s = designed_poles(K, D);
  REQUIRE(s.size() == 12);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double k = K[i / 2], d = D[i / 2];
    INFO("K " << k << ", D " << d << ", pole " << s[i].real() << " + j " << s[i].imag());
    // Each coefficient of the polynomial off by a few roundings.
    CHECK(std::abs(s[i] * s[i] + d * s[i] + k) <= 8 * eps * (std::norm(s[i]) + d * std::abs(s[i]) + k));
  }
  CHECK(s[0] == Complex(0, -10));
  CHECK(s[3] == Complex(-10));
  CHECK(s[7].real() == Approx(-1e-9 * (1 + 1e-12)).epsilon(4 * eps));  // -K/D (1 + K/D^2 + ...)
  CHECK(s[9] == Complex(0));
  CHECK(s[11] == Complex(0));
}

TEST_CASE("poles of a matrix that is known") {
  MatrixX<double> A(4, 4);  // two axes, (K, D) = (100, 5) and (4, 5)
  A << 0, 0, 1, 0, 0, 0, 0, 1, -100, 0, -5, 0, 0, -4, 0, -5;
  const auto found = poles(A);
  const double imaginary = std::sqrt(100 - 6.25);
  const std::vector<Complex> known{-4.0, {-2.5, -imaginary}, {-2.5, imaginary}, -1.0};
  REQUIRE(found.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(found[i] - known[i]) < 100 * 8 * eps);  // |A| n eps
  CHECK_THROWS_AS(poles(MatrixX<double>::Constant(2, 2, std::nan(""))), std::domain_error);
}

TEST_CASE("the poles of a resting PUMA are those of its gains") {
  const Chain<double> puma = chain_of("puma560.urdf");
  for (const double damping : {50.0, 20.0, 5.0, 0.0}) {
    Resting at(puma, bent, gains(100, damping));
    const PoleCheck right = at.check();
    WARN("D " << damping << ": worst " << right.worst << ", bound " << right.bound);
    CHECK(right.found.size() == 12);
    CHECK(right.designed.size() == 12);
    CHECK(right.worst <= right.bound / 4);
    // A critically damped pair is known to the square root of the error only.
    CHECK(right.bound < (damping == 20.0 ? 1e-4 : 1e-8));

    LawOptions wrong = gains(100, damping);
    wrong.stiffness[4] *= 1 + 10 * right.bound;
    const PoleCheck noticed = Resting(puma, bent, wrong).check_against(gains(100, damping));
    CHECK(noticed.worst > noticed.bound);
    CHECK(noticed.designed == right.designed);
  }
}

TEST_CASE("gains of different kinds on the six axes") {
  LawOptions law;
  law.stiffness << 100, 64, 1, 400, 0, 25;
  law.damping << 20, 3, 30, 41, 8, 0;
  const Chain<double> puma = chain_of("puma560.urdf");
  Resting at(puma, bent, law);
  const PoleCheck right = at.check();
  WARN("mixed: worst " << right.worst << ", bound " << right.bound << " at pole " << right.at);
  CHECK(right.worst <= right.bound / 2);
  // Every row by itself is held to its own bound, far below that of the critically damped one.
  for (const int row : {1, 2, 3, 5}) {
    LawOptions wrong = law;
    wrong.damping[row] += 1e-6 * std::sqrt(law.stiffness[row]);
    const PoleCheck noticed = Resting(puma, bent, wrong).check_against(law);
    INFO("row " << row);
    CHECK(noticed.worst > 10 * noticed.bound);
    CHECK(noticed.bound < 1e-7);
    CHECK(noticed.at / 2 == static_cast<std::size_t>(row));
  }
}

TEST_CASE("near a singularity the bound grows with the error") {
  const Chain<double> puma = chain_of("puma560.urdf");
  double last = 0;
  for (const double wrist : {0.6, 0.1, 0.01}) {
    const PoleCheck check = Resting(puma, {0.3, -0.8, 0.4, 0.3, wrist, 0.2}, gains(100, 5)).check();
    WARN("wrist at " << wrist << " rad: worst " << check.worst << ", bound " << check.bound);
    CHECK(check.worst <= check.bound / 4);
    CHECK(check.bound > last);
    CHECK(check.bound < undecided_bound);
    last = check.bound;
  }
}

TEST_CASE("a redundant arm and a task of fewer rows have more poles than designed") {
  LawOptions position = gains(100, 5);
  position.rows = {3, 4, 5};
  struct Case {
    std::string urdf;
    std::vector<double> q;
    LawOptions law;
    std::size_t designed, found;
  };
  for (const auto& [urdf, q, law, designed, found] :
       {Case{"arm7.urdf", seven, gains(100, 5), 12, 14}, Case{"puma560.urdf", bent, position, 6, 12}}) {
    const PoleCheck check = Resting(chain_of(urdf, true), q, law).check();
    WARN(urdf << ": worst " << check.worst << ", bound " << check.bound);
    CHECK(check.designed.size() == designed);
    CHECK(check.found.size() == found);
    CHECK(check.worst <= check.bound / 4);
    CHECK(check.bound < 1e-8);
    // Self-motion that nothing damps and no weight drives: double poles at 0, found to the root of the error.
    std::size_t at_zero = 0;
    for (const Complex s : check.found) at_zero += std::abs(s) < 10 * std::sqrt(check.bound) ? 1 : 0;
    CHECK(at_zero == found - designed);
  }
}

TEST_CASE("the linearised loop of sliding and turning joints is -J^-1 K J, -J^-1 D J") {
  // A gantry: the tip's displacement is that of the joints, J = 1 on the linear rows.
  Chain<double> gantry;
  for (int i = 0; i < 3; ++i) {
    Link<double> link;
    link.type = JointType::prismatic;
    link.axis = Vector3<double>::Unit(i);
    link.mass = 2;
    link.inertia.setIdentity();
    gantry.links.push_back(link);
  }
  gantry.p_tip = {0.3, 0, 0.2};
  gantry.gravity = {0, 0, -9.80665};
  LawOptions law;
  law.rows = {3, 4, 5};
  law.stiffness << 0, 0, 0, 100, 64, 25;
  law.damping << 0, 0, 0, 20, 4, 30;
  Resting at(gantry, {0.1, -0.2, 0.3}, law);
  MatrixX<double> known = MatrixX<double>::Zero(6, 6);
  known.topRightCorner(3, 3).setIdentity();
  known.bottomLeftCorner(3, 3) = -law.stiffness.tail<3>().asDiagonal().toDenseMatrix();
  known.bottomRightCorner(3, 3) = -law.damping.tail<3>().asDiagonal().toDenseMatrix();
  // Linear, so rounding alone: 11/6 of a few eps of the acceleration of gravity by a step of some 3e-3 m.
  CHECK((linearised(at.loop, 0, at.y) - known).cwiseAbs().maxCoeff() < 16 * eps * 9.80665 / 1e-3);
  const PoleCheck check = at.check();
  CHECK(check.worst <= check.bound / 4);
}

TEST_CASE("a wrong model moves the poles") {
  const Chain<double> puma = chain_of("puma560.urdf", true);
  const PoleCheck check = Resting(puma, bent, gains(100, 5), make_path(HoldOptions{}), 1.0).check();
  CHECK(check.bound < 1e-8);
  CHECK(check.worst > 1e-3);
}

TEST_CASE("friction that the law takes away exactly moves no pole; left alone it does") {
  const Chain<double> puma = chain_of("puma560.urdf");
  const std::vector<JointFriction> friction(6, {4, 7, 5, 0.1});  // unlike in the two directions
  LawOptions law = gains(100, 5);
  const PoleCheck taken = Resting(puma, bent, law, make_path(HoldOptions{}), 0, friction).check();
  WARN("friction: worst " << taken.worst << ", bound " << taken.bound);
  CHECK(taken.worst <= taken.bound / 4);
  CHECK(taken.bound < 1e-8);
  law.compensate_friction = false;
  const std::vector<JointFriction> viscous(6, {4, 0, 0, 0.1});
  const PoleCheck left = Resting(puma, bent, law, make_path(HoldOptions{}), 0, viscous).check();
  CHECK(left.bound < undecided_bound);  // the light wrist makes the matrix large
  CHECK(left.worst > 10 * undecided_bound);
}

TEST_CASE("poles are refused away from equilibrium and for laws without designed poles") {
  const auto refusal = [](Resting at) {
    try {
      at.check();
    } catch (const std::domain_error& error) { return std::string(error.what()); }
    return std::string("none");
  };
  const Chain<double> puma = chain_of("puma560.urdf");
  CHECK(refusal(Resting(puma, bent, gains(100, 20))) == "none");
  Resting moving(puma, bent, gains(100, 20));
  moving.y[7] = 0.01;
  CHECK(refusal(std::move(moving)).find("not in equilibrium") != std::string::npos);
  StepOptions step;
  step.offset[3] = 0.01;
  CHECK(refusal(Resting(puma, bent, gains(100, 20), make_path(step))).find("the largest acceleration is") !=
        std::string::npos);
  CHECK(refusal(Resting(chain_of("arm7.urdf"), seven, gains(100, 20))).find("not in equilibrium") !=
        std::string::npos);  // the self-motion falls
  CHECK(refusal(Resting(puma, bent, gains(100, 20), make_path(HoldOptions{}), 1.0))
            .find("not in equilibrium") != std::string::npos);
  LawOptions law = gains(100, 20);
  law.sampling = Sampling{};
  CHECK(refusal(Resting(puma, bent, law)).find("sampled") != std::string::npos);
  law = gains(100, 20);
  law.law = Law::free;
  CHECK(refusal(Resting(puma, bent, law)).find("free swing") != std::string::npos);
  law = gains(100, 20);
  law.constant_command = Vector6::Zero();
  CHECK(refusal(Resting(puma, bent, law)).find("constant command") != std::string::npos);
  law = gains(100, 20);
  law.position = PositionCoordinates::cylindrical;
  CHECK(refusal(Resting(puma, bent, law)).find("rotation vector") != std::string::npos);
}

}  // namespace osculate::testing::poles_tests
