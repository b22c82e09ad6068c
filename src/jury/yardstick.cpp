#include "jury/yardstick.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "scalar/eps.hpp"

namespace osculate::jury {

namespace {

using Matrix = MatrixX<double>;
using Vector = VectorX<double>;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Whether velocity coordinate i of a joint turns its link.
bool turns(JointType type, int i) {
  switch (type) {
    case JointType::prismatic:
      return false;
    case JointType::cylindrical:
      return i == 0;
    case JointType::planar:
      return i == 2;
    case JointType::floating:
      return i < 3;
    default:
      return true;
  }
}

/// How far the joint's position moves its link's origin, m.
double displacement(const Link<double>& link, const double* q) {
  switch (link.type) {
    case JointType::prismatic:
      return std::abs(q[0]);
    case JointType::cylindrical:
      return std::abs(q[1]);
    case JointType::planar:
      return std::hypot(q[0], q[1]);
    case JointType::floating:
      return std::hypot(q[4], q[5], q[6]);
    default:
      return 0;
  }
}

/// |A|, weighted, and its largest entry.
double largest(const Matrix& A, const Matrix& weight) { return A.cwiseAbs().cwiseProduct(weight).maxCoeff(); }

}  // namespace

// Sums go along the arm, so rounding is relative to path lengths, which never cancel: L(k, j) from joint k to
// the centre of mass of link j, L(k, tip) to the tip. With w = the sum of |qd| that turns and v = that which
// slides, a link accelerates by at most w (w L + 2 v) without qdd.
void Yardstick::joint_terms(const Chain<double>& chain, const Evidence& e, const Vector& q) {
  const auto& [tip, joint] = e.plant;
  const auto n = static_cast<Eigen::Index>(joint.C.size());
  double spin = 0, pace = 0;
  Eigen::Index column = 0;
  for (const Link<double>& link : chain.links)
    for (int i = 0; i < velocity_count(link.type); ++i, ++column)
      (turns(link.type, i) ? spin : pace) += std::abs(e.qd[column]);

  // From the tip inwards: sums over the links outboard of a joint.
  Matrix J_weight(6, n);
  Vector C_size(n), G_size(n), inertia_size(n);
  std::vector<double> steps;  // m, from each link's joint to the next
  const double* at = q.data();
  for (const Link<double>& link : chain.links) {
    steps.push_back(link.p_origin.norm() + displacement(link, at));
    at += position_count(link.type);
  }
  const std::size_t links = chain.links.size();
  const double reach = std::accumulate(steps.begin(), steps.end(), chain.p_tip.norm());
  const double push = spin * (spin * reach + 2 * pace), gravity = chain.gravity.norm();
  column = 0;
  for (std::size_t k = 0; k < links; ++k) {
    double first = 0, second = 0, mass = 0, gyration = 0, path = 0;  // of m L, m L^2, m, moments, L
    for (std::size_t j = k; j < links; ++j) {
      const Link<double>& link = chain.links[j];
      if (j > k) path += steps[j];
      const double L = path + link.com.norm();
      mass += link.mass;
      first += link.mass * L;
      second += link.mass * L * L;
      gyration += link.inertia.norm();
    }
    path += chain.p_tip.norm();
    for (int i = 0; i < velocity_count(chain.links[k].type); ++i, ++column) {
      const bool turning = turns(chain.links[k].type, i);
      J_weight.col(column).head<3>().setOnes();
      J_weight.col(column).tail<3>().setConstant(turning ? 1 / std::max(path, 1e-300) : 1);
      inertia_size[column] = turning ? second + gyration : mass;
      C_size[column] = turning ? first * push + gyration * spin * spin : mass * push;
      G_size[column] = (turning ? first : mass) * gravity;
    }
  }
  const double rounding = 10 * static_cast<double>(n) * eps;
  const Vector w = joint.M.diagonal().cwiseSqrt().cwiseInverse();
  // A(i) = sum of m L^2 over M(i,i): how much larger the numbers are that M(i,i) is the outcome of.
  measure(Term::M) = {w * w.transpose(), inertia_size.cwiseProduct(w.cwiseAbs2()).maxCoeff(), rounding};
  measure(Term::C) = {w, C_size.cwiseProduct(w).maxCoeff(), rounding};
  measure(Term::G) = {w, G_size.cwiseProduct(w).maxCoeff(), rounding};
  measure(Term::J) = {J_weight, 1, rounding};
  Vector six(6);
  six.head<3>().setOnes();
  six.tail<3>().setConstant(1 / std::max(reach, 1e-300));
  measure(Term::Jdot_qd) = {six, spin * spin + 2 * spin * pace / std::max(reach, 1e-300), rounding};

  const Matrix Minv = joint.M.inverse();
  const Vector sizes = e.net_torque.cwiseAbs() + joint.C.cwiseAbs() + joint.G.cwiseAbs();
  const Vector roots = joint.M.diagonal().cwiseSqrt();
  measure(Term::qdd) = {roots, Vector(Minv.cwiseAbs() * sizes).cwiseProduct(roots).maxCoeff(), 0};
}

// As the verdict weighs them (src/verification/claims.cpp): rows by the root of the largest diagonal entry of
// Omega in their block.
void Yardstick::task_terms(const StateTerms& terms) {
  const Evidence& e = terms.evidence;
  const Matrix& Omega = e.task.Omega;
  const auto m = Omega.rows();
  double block[2] = {0, 0};
  for (Eigen::Index i = 0; i < m; ++i) {
    double& most = block[e.rows[static_cast<std::size_t>(i)] / 3];
    most = std::max(most, Omega(i, i));
  }
  Vector d(m);
  for (Eigen::Index i = 0; i < m; ++i) d[i] = std::sqrt(block[e.rows[static_cast<std::size_t>(i)] / 3]);
  const auto bound = [&terms](Claim claim) {
    const Residual& r = terms.residual(claim);
    return r.applies ? r.bound : infinite;
  };
  measure(Term::qdd).bound = bound(Claim::forward_dynamics);
  const Vector d_inv = d.cwiseInverse();
  measure(Term::Omega) = {d_inv * d_inv.transpose(), 1, bound(Claim::omega)};
  if (!terms.regular()) {
    for (const Term term : {Term::Lambda, Term::c, Term::g}) measure(term).bound = infinite;
    return;
  }
  const Matrix Lambda = e.terms.Lambda.cwiseAbs();
  Vector c_size = e.task.J_Minv_C.cwiseAbs() + e.task.Jdot_qd.cwiseAbs(), g_size = e.task.J_Minv_G.cwiseAbs();
  for (Eigen::Index i = 0; i < m; ++i)
    if (e.rows[static_cast<std::size_t>(i)] >= 3) g_size[i] += e.gravity.norm();
  measure(Term::Lambda) = {d * d.transpose(), largest(Lambda, d * d.transpose()), bound(Claim::lambda)};
  measure(Term::c) = {d, largest(Lambda * c_size, d), bound(Claim::c)};
  measure(Term::g) = {d, largest(Lambda * g_size, d), bound(Claim::g)};
}

Yardstick::Yardstick(const Chain<double>& chain, const StateTerms& terms, const VectorX<double>& q) {
  joint_terms(chain, terms.evidence, q);
  task_terms(terms);
}

double Yardstick::ratio(Term term, const Matrix& a, const Matrix& b) const {
  const auto& [weight, scale, bound] = measure(term);
  if (!a.allFinite() || !b.allFinite()) return infinite;
  const double off = largest(a - b, weight);
  return off == 0 ? 0 : off / (scale * bound);
}

}  // namespace osculate::jury
