// The sweeps over packets: every lane against the same arm and state in double, and differences of the plant
// against dual numbers.
#include <Eigen/Eigenvalues>
#include <bit>
#include <cmath>

#include "model/random_arm.hpp"
#include "recursion/ensemble.hpp"
#include "reference/dense.hpp"
#include "scalar/dual.hpp"
#include "scalar/eps.hpp"
#include "support/catch.hpp"

namespace osculate::testing::packets_tests {

namespace {

using Array = MatrixX<double>;

/// States of one arm, one in each row.
struct States {
  Chain<double> chain;
  Array q, qd, T, u;
};
States random_states(const RandomArm& arm, int count) {
  Random random(static_cast<std::uint64_t>(count));
  States out{arm.chain, arm.q.transpose().replicate(count, 1), arm.qd.transpose().replicate(count, 1),
             Array(count, arm.qd.size()), Array(count, 6)};
  for (int i = 1; i < count; ++i) {
    for (Eigen::Index j = 0; j < out.q.cols(); ++j) out.q(i, j) += random.uniform(-0.5, 0.5);
    for (Eigen::Index j = 0; j < out.qd.cols(); ++j) out.qd(i, j) += random.uniform(-1, 1);
  }
  for (double& x : out.T.reshaped()) x = random.uniform(-20, 20);
  for (double& x : out.u.reshaped()) x = random.uniform(-5, 5);
  return out;
}
std::vector<double> row(const Array& x, Eigen::Index i) {
  std::vector<double> out(static_cast<std::size_t>(x.cols()));
  for (Eigen::Index j = 0; j < x.cols(); ++j) out[static_cast<std::size_t>(j)] = x(i, j);
  return out;
}

double condition(const Array& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Array> solver(symmetric, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff() / solver.eigenvalues().minCoeff();
}

/// Largest difference, as a multiple of eps times the size of `right`.
template <class Left, class Right>
double epsilons(const Left& left, const Right& right) {
  return (left - right).cwiseAbs().maxCoeff() / (eps * right.cwiseAbs().maxCoeff());
}

/// The same by the sweeps over double, H = Hinge<double> or Joint<double>. F is compared by what it solves
/// too.
template <class H, class Packets>
void compare_with_scalar(BasicEnsemble<Packets>& ensemble, const States& states) {
  EnsembleTerms found;
  Array qdd;
  ensemble.evaluate(states.q, states.qd, states.u, found);
  ensemble.accelerations(states.q, states.qd, states.T, qdd);
  BasicOperationalSpace<H> space(states.chain);
  BasicForwardDynamics<H> plant(states.chain);
  const TaskRows rows = all_rows();
  const Eigen::Index n = states.qd.cols();
  for (Eigen::Index i = 0; i < states.q.rows(); ++i) {
    const auto joints = positions<double>(states.chain, row(states.q, i));
    const auto qd = row(states.qd, i);
    space.place(joints);
    space.sweep(qd);
    const auto Omega = space.Omega();
    const TaskFactor<double> factor(Omega, rows);
    const auto as_vector = [](const TaskVector<double>& x) {
      return Eigen::Map<const Eigen::Matrix<double, 1, 6>>(x.data()).eval();
    };
    TaskVector<double> right = restricted(space.right_side(), rows);
    const auto bias = as_vector(factor.solve(right));
    const auto g = as_vector(factor.solve(restricted(space.right_side_of_g(), rows)));
    for (std::size_t j = 0; j < 6; ++j) right[j] += states.u(i, static_cast<Eigen::Index>(j));
    const TaskVector<double> F = factor.solve(right);
    Eigen::RowVectorXd T(n), thdd(n);
    space.torques(wrench(F, rows), {T.data(), static_cast<std::size_t>(n)});
    plant.place(joints);
    plant.accelerations(qd, row(states.T, i), {}, {thdd.data(), static_cast<std::size_t>(n)});

    // Cosines differ by an ulp from the library's and sums by their order: each of about ten operations in a
    // row for each link, felt through M^-1 and then Omega^-1.
    const auto M = dense::state<double>(states.chain, joints, VectorX<double>(states.qd.row(i))).joint.M;
    Array whole(6, 6), upper(6, 6);
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) {
        whole(r, c) = component(Omega, r, c);
        upper(r, c) = found.Omega(i, compliance_column(r, c));
      }
    const double inner = 10 * double(n) * condition(M), outer = inner * condition(whole);
    CAPTURE(i, condition(M), condition(whole));
    CHECK(epsilons(upper, whole) <= inner);
    CHECK(epsilons(qdd.row(i), thdd) <= inner);
    const double size = std::max(bias.cwiseAbs().maxCoeff(), g.cwiseAbs().maxCoeff());
    CHECK((found.c.row(i) - (bias - g)).cwiseAbs().maxCoeff() <= outer * eps * size);
    CHECK(epsilons(found.g.row(i), g) <= outer);
    CHECK(epsilons(found.F.row(i), as_vector(F)) <= outer);
    CHECK(epsilons(found.T.row(i), T) <= outer);
  }
}

bool same_bits(const Array& x, const Array& y) {
  return x.size() == y.size() && std::equal(x.data(), x.data() + x.size(), y.data(), [](double a, double b) {
           return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
         });
}

}  // namespace

TEST_CASE("lanes agree with the scalar sweeps") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const States states = random_states(random_arm(seed, 7), 11);
    Ensemble<4> four(states.chain);
    compare_with_scalar<Hinge<double>>(four, states);
  }
}

TEST_CASE("lanes agree for joints with more axes") {
  using enum JointType;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RandomArm arm =
        random_arm_of(seed, {floating, universal, cylindrical, spherical, planar, revolute, prismatic});
    States states = random_states(arm, 3);
    BasicEnsemble<Joint<Packet<2>>> ensemble(arm.chain);
    compare_with_scalar<Joint<double>>(ensemble, states);
  }
}

TEST_CASE("a state gives the same bits in every lane and beside any other") {
  const States states = random_states(random_arm(3, 7), 19);
  Ensemble<4> ensemble(states.chain);
  EnsembleTerms together, apart;
  Array qdd, qdd_apart;
  ensemble.evaluate(states.q, states.qd, states.u, together);
  ensemble.accelerations(states.q, states.qd, states.T, qdd);
  for (int first = 0; first < 19; ++first)
    for (int count : {1, 3, 4, 6}) {
      if (first + count > 19) continue;
      const auto part = [&](const Array& x) { return Array(x.middleRows(first, count)); };
      ensemble.evaluate(part(states.q), part(states.qd), part(states.u), apart);
      ensemble.accelerations(part(states.q), part(states.qd), part(states.T), qdd_apart);
      CHECK(same_bits(apart.Omega, part(together.Omega)));
      CHECK(same_bits(apart.c, part(together.c)));
      CHECK(same_bits(apart.g, part(together.g)));
      CHECK(same_bits(apart.F, part(together.F)));
      CHECK(same_bits(apart.T, part(together.T)));
      CHECK(same_bits(qdd_apart, part(qdd)));
    }
}

TEST_CASE("a state that is no number spoils its own row only") {
  States states = random_states(random_arm(3, 7), 8);
  Ensemble<4> ensemble(states.chain);
  EnsembleTerms clean, spoilt;
  ensemble.evaluate(states.q, states.qd, states.u, clean);
  states.q(5, 0) = std::nan("");
  ensemble.evaluate(states.q, states.qd, states.u, spoilt);
  CHECK(std::isnan(spoilt.T(5, 0)));
  for (Eigen::Index i : {0, 1, 2, 3, 4, 6, 7}) CHECK(same_bits(spoilt.T.row(i), clean.T.row(i)));
}

TEST_CASE("arrays of the wrong shape are refused") {
  const States states = random_states(random_arm(3, 7), 4);
  Ensemble<4> ensemble(states.chain);
  EnsembleTerms terms;
  Array qdd;
  CHECK_THROWS_AS(ensemble.evaluate(states.q, states.qd, states.u.leftCols(5), terms), std::invalid_argument);
  CHECK_THROWS_AS(ensemble.evaluate(states.q, states.qd.topRows(3), states.u, terms), std::invalid_argument);
  CHECK_THROWS_AS(ensemble.accelerations(states.q, states.qd, states.T.leftCols(6), qdd),
                  std::invalid_argument);
}

TEST_CASE("differences of the plant agree with dual numbers") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RandomArm arm = random_arm(seed, 7);
    const Eigen::Index n = 7;
    const VectorX<double> T = VectorX<double>::LinSpaced(n, -10, 10);
    Ensemble<4> ensemble(arm.chain);
    const double step = 6e-6;
    const PlantSlopes found = plant_slopes(ensemble, arm.q, arm.qd, T, step);
    const PlantSlopes coarse = plant_slopes(ensemble, arm.q, arm.qd, T, 1e3 * step);

    using D = Dual<double>;
    BasicForwardDynamics<Hinge<D>> plant(cast<D>(arm.chain));
    Array exact[3] = {Array(n, n), Array(n, n), Array(n, n)};
    double largest = 0;
    for (int b = 0; b < 3; ++b)
      for (Eigen::Index j = 0; j < n; ++j) {
        std::vector<JointPosition<D>> joints;
        std::vector<D> qd, torques, qdd(7);
        for (Eigen::Index i = 0; i < n; ++i) {
          const auto seed_of = [&](int block) { return block == b && i == j ? 1.0 : 0.0; };
          const JointPosition<double>& at = arm.positions[static_cast<std::size_t>(i)];
          const bool turns = arm.chain.links[static_cast<std::size_t>(i)].type == JointType::revolute;
          const double turn = turns ? seed_of(0) : 0, slide = seed_of(0) - turn;
          JointPosition<D> position;
          position.c = D(at.c, -at.s * turn), position.s = D(at.s, at.c * turn), position.d = D(at.d, slide);
          joints.push_back(position);
          qd.emplace_back(arm.qd[i], seed_of(1));
          torques.emplace_back(T[i], seed_of(2));
        }
        plant.place(joints);
        plant.accelerations(qd, torques, {}, qdd);
        for (Eigen::Index i = 0; i < n; ++i) {
          exact[b](i, j) = qdd[static_cast<std::size_t>(i)].derivative;
          largest = std::max(largest, std::abs(qdd[static_cast<std::size_t>(i)].value));
        }
      }

    const auto M = dense::state<double>(arm.chain, arm.positions, arm.qd).joint.M;
    // Rounding of qdd as in compare_with_scalar, twice, over the distance 2 step; the error of the thousand
    // times longer step, divided by its square, bounds what the short one leaves out.
    const double rounding = 10 * double(n) * condition(M) * eps * largest;
    const double left_out = (coarse.q - exact[0]).cwiseAbs().maxCoeff() / 1e6;
    const auto error = [&](const Array& x, int b) { return (x - exact[b]).cwiseAbs().maxCoeff(); };
    CAPTURE(seed, condition(M), left_out, rounding, largest);
    CHECK(error(found.q, 0) <= 2 * left_out + rounding / step);
    CHECK(error(coarse.q, 0) > 10 * error(found.q, 0));  // the step matters where it should
    CHECK(error(found.qd, 1) <=
          rounding + 10 * double(n) * condition(M) * eps * exact[1].cwiseAbs().maxCoeff());
    CHECK(error(found.T, 2) <=
          rounding + 10 * double(n) * condition(M) * eps * exact[2].cwiseAbs().maxCoeff());
  }
}

}  // namespace osculate::testing::packets_tests
