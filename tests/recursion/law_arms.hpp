// Random arms in three regimes, what the recursions say of them, and the sizes against which rounding is
// measured.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <span>
#include <sstream>
#include <string>

#include "model/random_arm.hpp"
#include "recursion/forward_dynamics.hpp"
#include "recursion/operational_space.hpp"
#include "recursion/worst.hpp"
#include "reference/dense.hpp"
#include "spatial/plain.hpp"

namespace osculate::testing {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;

inline std::span<const double> span_of(const Vector& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}
inline std::span<double> span_of(Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

/// What sweeps 1 to 3 say of an arm in a state.
struct Sides {
  Matrix Omega;
  Vector c, g, both;  // right sides: Omega times c, g and c + g
  Vector D;           // D(k), tip to base
};
inline Sides sides_of(OperationalSpace<double>& space, const RandomArm& arm) {
  Sides out;
  space.place(arm.positions);
  space.sweep(span_of(arm.qd));
  out.Omega = plain(space.Omega());
  out.both = plain(space.right_side());
  out.g = plain(space.right_side_of_g());
  out.D.resize(space.n());
  for (int k = 1; k <= space.n(); ++k) out.D[k - 1] = space.articulated_joint_inertia(k).d;
  out.c = plain(space.right_side_of_c(span_of(arm.qd)));
  return out;
}
inline Sides sides_of(const RandomArm& arm) {
  OperationalSpace<double> space(arm.chain);
  return sides_of(space, arm);
}
inline bool same_bits(const Sides& a, const Sides& b) {
  return a.Omega == b.Omega && a.c == b.c && a.g == b.g && a.both == b.both && a.D == b.D;
}

/// What the plant does under joint torques T and the wrench F_ext on its tip.
struct Motions {
  Vector qdd;
  Vector tip;
};
inline Motions motions_of(const RandomArm& arm, const Vector& T, const Vector& F_ext) {
  ForwardDynamics<double> plant(arm.chain);
  plant.place(arm.positions);
  Motions out;
  out.qdd.resize(plant.n());
  plant.accelerations(span_of(arm.qd), span_of(T), as<Force, double>(F_ext), span_of(out.qdd));
  out.tip = plain(plant.tip_acceleration());
  return out;
}

/// One number for each of the six rows: the root of the mobility of its half. Does not change when axes turn.
inline Vector row_scale(const Matrix& Omega) {
  Vector out(6);
  out << Vector::Constant(3, std::sqrt(Omega.diagonal().head<3>().sum())),
      Vector::Constant(3, std::sqrt(Omega.diagonal().tail<3>().sum()));
  return out;
}
inline Matrix entry_scale(const Matrix& Omega) { return row_scale(Omega) * row_scale(Omega).transpose(); }

/// From the dense reference, the sizes of what is summed: sums may cancel, and their error is that of the
/// terms.
struct Sizes {
  dense::State<double> x;
  Matrix Minv;   // |M^-1|
  Vector C, G;   // N m or N, without cancellation between links
  Vector tip;    // of Jdot qd
  Matrix reach;  // 6 x n, as J, with the distance from joint to tip as every lever arm
  explicit Sizes(const RandomArm& arm) : x(dense::state(arm.chain, arm.positions, arm.qd)) {
    Minv = x.joint.M.inverse().cwiseAbs();
    const double rates = arm.qd.lpNorm<1>();
    C = x.joint.M.diagonal().cwiseSqrt() * std::sqrt(x.joint.M.diagonal().maxCoeff()) * rates * rates;
    double mass = 0;
    for (const auto& link : arm.chain.links) mass += link.mass;
    G = Vector::Constant(arm.chain.n(), mass * arm.chain.gravity.norm() * x.tip.J.cwiseAbs().maxCoeff());
    reach = Matrix::Zero(6, arm.chain.n());
    const auto places = dense::places(arm.chain, arm.positions);
    for (int i = 0; i < arm.chain.n(); ++i) {
      const auto& link = places.links[static_cast<std::size_t>(i)];
      const bool turns = link.type == JointType::revolute;
      reach.col(i).head<3>().setConstant(turns ? 1 : 0);
      reach.col(i).tail<3>().setConstant(turns ? (places.tip.p - link.origin).norm() : 1);
    }
    tip = Vector::Constant(6, x.tip.J.cwiseAbs().maxCoeff() * rates * rates);
  }
  Matrix J() const { return x.tip.J.cwiseAbs(); }
  Vector right_side_c() const { return J() * Minv * C + tip; }
  Vector right_side_g() const { return J() * Minv * G; }
  /// of qdd under T and F_ext
  Vector accelerations(const Vector& T, const Vector& F_ext) const {
    return Minv * (T.cwiseAbs() + C + G + J().transpose() * F_ext.cwiseAbs());
  }
  /// of the tip acceleration under T = J* F. A large F that has little lever arm left was moved over all of
  /// `reach`.
  Vector commanded(const Vector& F) const {
    return reach * (Minv * (reach.transpose() * F.cwiseAbs() + C + G)) + tip;
  }
};

/// Rows in which Omega is regular: pivots of the matrix scaled to unit diagonal above 1e-10, largest first.
inline TaskRows regular_rows(const Matrix& Omega) {
  const Vector d = Omega.diagonal().cwiseSqrt().cwiseInverse();
  Matrix A = d.asDiagonal() * Omega * d.asDiagonal();
  TaskRows rows;
  Eigen::Index pivot = 0;
  while (rows.size() < 6 && A.diagonal().maxCoeff(&pivot) > 1e-10) {
    A -= Matrix(A.col(pivot) * A.row(pivot) / A(pivot, pivot));
    A.row(pivot).setZero();
    A.col(pivot).setZero();
    rows.push_back(static_cast<int>(pivot));
  }
  return rows;
}
/// Ascending, of a symmetric matrix.
inline Vector eigenvalues(const Matrix& A) { return Eigen::SelfAdjointEigenSolver<Matrix>(A).eigenvalues(); }
/// cond of a positive definite matrix scaled to unit diagonal.
inline double condition(const Matrix& Omega) {
  const Vector d = Omega.diagonal().cwiseSqrt().cwiseInverse();
  const Vector sigma = eigenvalues(d.asDiagonal() * Omega * d.asDiagonal());
  return sigma[sigma.size() - 1] / sigma[0];
}

inline Vector uniform(Random& random, int n, double range) {
  return Vector::NullaryExpr(n, [&] { return random.uniform(-range, range); });
}

struct Case {
  RandomArm arm;
  int n;
  Random random;  // for what else the law needs
  std::string which;
};
template <class Check>
void for_arms(Check check) {
  for (const Regime regime : {Regime::generic, Regime::nearly_singular, Regime::zero_velocity})
    for (int n = 1; n <= 12; ++n)
      for (unsigned seed = 1; seed <= 8; ++seed) {
        std::ostringstream which;
        const RandomArm arm = random_arm(seed, n, regime);
        which << "random_arm(" << seed << ", " << n << "), " << regime_name(regime) << ", " << arm;
        INFO(which.str());
        check(Case{arm, n, Random(seed), which.str()});
      }
}

}  // namespace osculate::testing
