// What the operators of the paper say of each other: (18) to (36), (52) to (59) and properties without a
// number, each a function that returns its two sides. Equation numbers: Kreutz-Delgado, Jain & Rodriguez
// (1992).
#pragma once

#include <algorithm>
#include <vector>

#include "reference/operators.hpp"

namespace osculate::dense {

/// Of an identity: left = right.
template <Field S>
struct Sides {
  Operator<S> left, right;
};

namespace internal {

/// 6 x 6 blocks, one below the other.
template <Field S>
Operator<S> stacked(const std::vector<Operator<S>>& blocks) {
  std::vector<Piece<S>> pieces;
  for (const auto& block : blocks) pieces.push_back({6 * static_cast<Eigen::Index>(pieces.size()), 0, block});
  return assembled(6 * static_cast<Eigen::Index>(blocks.size()), 6, pieces);
}

template <Field S>
Operator<S> cross(const Vector3<S>& a, const Operator<S>& b) {
  return Operator<S>(cross_matrix(a)) * b;
}

template <Field S>
Operator<S> power(const Operator<S>& E, int n) {
  Operator<S> out = E;
  for (int i = 1; i < n; ++i) out = E * out;
  return out;
}

template <Field S>
Operator<S> zero(Eigen::Index rows, Eigen::Index cols) {
  return MatrixX<S>(MatrixX<S>::Zero(rows, cols));
}
/// 1 in the space of the links, and in that of the joints.
template <Field S>
Operator<S> one_links(const Operators<S>& x) {
  return one<S>(6 * x.n);
}
template <Field S>
Operator<S> one_joints(const Operators<S>& x) {
  return one<S>(x.m());
}
/// phi~ and psi~.
template <Field S>
Operator<S> less_one(const Operator<S>& A) {
  return MatrixX<S>(A.value - MatrixX<S>::Identity(A.rows(), A.rows()));
}
/// H* D^-1 H.
template <Field S>
Operator<S> HDH(const Operators<S>& x) {
  return x.H.T() * x.D_inv * x.H;
}
/// psi* H* D^-1 and H psi.
template <Field S>
Operator<S> psi_HD(const Operators<S>& x) {
  return x.psi.T() * x.H.T() * x.D_inv;
}
template <Field S>
Operator<S> H_psi(const Operators<S>& x) {
  return x.H * x.psi;
}
/// Omega(0), (11).
template <Field S>
Operator<S> Omega_tip(const Operators<S>& x) {
  return x.dense.J * x.dense.M_inv * x.dense.J.T();
}
/// Omega(0) c(0), (14), and Omega(0) g(0), (15).
template <Field S>
Operator<S> Omega_c(const Operators<S>& x) {
  return x.dense.J * (x.dense.M_inv * x.dense.C) - x.dense.Jdot_qd;
}
template <Field S>
Operator<S> Omega_g(const Operators<S>& x) {
  return x.dense.J * (x.dense.M_inv * x.dense.G);
}

}  // namespace internal

// The operators: (18) to (36).

template <Field S>
Sides<S> phi_step_is_nilpotent(const Operators<S>& x) {
  return {internal::power(x.E_phi, x.n), internal::zero<S>(6 * x.n, 6 * x.n)};
}

template <Field S>
Sides<S> shift_inverse(const Operators<S>& x) {
  std::vector<Operator<S>> left, right;
  for (int i = 0; i <= x.n + 1; ++i)
    for (int j = 0; j <= x.n + 1; ++j) {
      left.push_back(shift(x, i, j) * shift(x, j, i));
      right.push_back(one<S>(6));
    }
  return {internal::stacked(left), internal::stacked(right)};
}

template <Field S>
Sides<S> shift_group(const Operators<S>& x) {
  std::vector<Operator<S>> left, right;
  for (int i = 0; i <= x.n + 1; ++i)
    for (int l = 0; l <= x.n + 1; ++l)
      for (int j = 0; j <= x.n + 1; ++j) {
        if (i == l || l == j) continue;
        left.push_back(shift(x, i, l) * shift(x, l, j));
        right.push_back(shift(x, i, j));
      }
  return {internal::stacked(left), internal::stacked(right)};
}

/// The inertia about O(k) is the one about the centre of mass, moved.
template <Field S>
Sides<S> link_inertia(const Operators<S>& x) {
  std::vector<Operator<S>> left, right;
  for (int k = 1; k <= x.n; ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    MatrixX<S> at_com = MatrixX<S>::Zero(6, 6), move = MatrixX<S>::Identity(6, 6);
    at_com.topLeftCorner(3, 3) = x.I_com[i];
    at_com.bottomRightCorner(3, 3) = x.mass[i] * Matrix3<S>::Identity();
    move.topRightCorner(3, 3) = cross_matrix(x.p[i]);
    left.push_back(x.link_block(x.M, k, k));
    right.push_back(Operator<S>(move) * Operator<S>(at_com) * Operator<S>(move).T());
  }
  return {internal::stacked(left), internal::stacked(right)};
}

template <Field S>
Sides<S> phi_inverts(const Operators<S>& x) {
  return {x.phi * (internal::one_links(x) - x.E_phi), internal::one_links(x)};
}
template <Field S>
Sides<S> articulated_inertia(const Operators<S>& x) {
  return {x.P, x.E_psi * x.P * x.E_psi.T() + x.K * x.Jm * x.K.T() + x.M};
}
template <Field S>
Sides<S> hinge_inertia(const Operators<S>& x) {
  return {x.D, x.H * x.P * x.H.T() + x.Jm};
}
template <Field S>
Sides<S> gain(const Operators<S>& x) {
  return {x.G, x.P * x.H.T() * x.D_inv};
}
template <Field S>
Sides<S> shifted_gain(const Operators<S>& x) {
  return {x.K, x.E_phi * x.G};
}
template <Field S>
Sides<S> psi_step(const Operators<S>& x) {
  return {x.E_psi, x.E_phi * (internal::one_links(x) - x.G * x.H)};
}
template <Field S>
Sides<S> psi_inverts(const Operators<S>& x) {
  return {x.psi * (internal::one_links(x) - x.E_psi), internal::one_links(x)};
}
template <Field S>
Sides<S> psi_step_is_nilpotent(const Operators<S>& x) {
  return {internal::power(x.E_psi, x.n), internal::zero<S>(6 * x.n, 6 * x.n)};
}

template <Field S>
Sides<S> hinge_inertia_blocks(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  for (int k = 1; k <= x.n; ++k)
    pieces.push_back({x.first(k), x.first(k),
                      x.H_block(k) * x.link_block(x.P, k, k) * x.H_block(k).T() + x.joint_block(x.Jm, k)});
  return {x.D, internal::assembled(x.m(), x.m(), pieces)};
}
template <Field S>
Sides<S> gain_blocks(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  for (int k = 1; k <= x.n; ++k)
    pieces.push_back({6 * (k - 1), x.first(k), x.link_block(x.P, k, k) * x.H_block(k).T()});
  return {x.G * x.D, internal::assembled(6 * x.n, x.m(), pieces)};
}
template <Field S>
Sides<S> shifted_gain_blocks(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  for (int k = 1; k < x.n; ++k)
    pieces.push_back({6 * k, x.first(k), shift(x, k + 1, k) * x.column_block(x.G, k, k)});
  return {x.K, internal::assembled(6 * x.n, x.m(), pieces)};
}
template <Field S>
Sides<S> psi_step_blocks(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  for (int k = 1; k < x.n; ++k)
    pieces.push_back(
        {6 * k, 6 * (k - 1), shift(x, k + 1, k) * (one<S>(6) - x.column_block(x.G, k, k) * x.H_block(k))});
  return {x.E_psi, internal::assembled(6 * x.n, 6 * x.n, pieces)};
}
template <Field S>
Sides<S> base_step(const Operators<S>& x) {
  return {x.W, x.E * (internal::one_links(x) - x.G * x.H)};
}
/// For l next to j and halfway; the other l follow by induction.
template <Field S>
Sides<S> psi_semigroup(const Operators<S>& x) {
  const auto psi = articulated_shifts(x);
  std::vector<Operator<S>> left, right;
  for (std::size_t i = 0; i < psi.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j)
      for (const std::size_t l : {std::min(j + 1, i), (i + j) / 2}) {
        left.push_back(psi[i][l] * psi[l][j]);
        right.push_back(psi[i][j]);
      }
  return {internal::stacked(left), internal::stacked(right)};
}
template <Field S>
Sides<S> phi_blocks(const Operators<S>& x) {
  std::vector<internal::Piece<S>> pieces;
  for (int i = 1; i <= x.n; ++i)
    for (int j = 1; j <= i; ++j) pieces.push_back({6 * (i - 1), 6 * (j - 1), shift(x, i, j)});
  return {x.phi, internal::assembled(6 * x.n, 6 * x.n, pieces)};
}
template <Field S>
Sides<S> psi_blocks(const Operators<S>& x) {
  const auto psi = articulated_shifts(x);
  std::vector<internal::Piece<S>> pieces;
  for (int i = 1; i <= x.n; ++i)
    for (int j = 1; j <= i; ++j)
      pieces.push_back(
          {6 * (i - 1), 6 * (j - 1), psi[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]});
  return {x.psi, internal::assembled(6 * x.n, 6 * x.n, pieces)};
}

// Relations between the operators: (52) to (59).

template <Field S>
Sides<S> phi_less_psi(const Operators<S>& x) {
  return {x.phi * x.K * x.H * x.psi, x.phi - x.psi};
}
template <Field S>
Sides<S> phi_less_psi_turned(const Operators<S>& x) {
  return {x.psi * x.K * x.H * x.phi, x.phi - x.psi};
}
template <Field S>
Sides<S> stripped_phi(const Operators<S>& x) {
  return {(internal::one_joints(x) - x.H * x.psi * x.K) * x.H * x.phi, x.H * x.psi};
}
template <Field S>
Sides<S> inertia_split(const Operators<S>& x) {
  return {x.psi * x.M * x.phi.T(),
          x.P + internal::less_one(x.psi) * x.P + x.P * internal::less_one(x.phi).T()};
}
template <Field S>
Sides<S> inertia_split_short(const Operators<S>& x) {
  return {x.P + internal::less_one(x.psi) * x.P, x.psi * x.P};
}
template <Field S>
Sides<S> phi_tilde(const Operators<S>& x) {
  return {internal::less_one(x.phi), x.phi * x.E_phi};
}
template <Field S>
Sides<S> phi_tilde_turned(const Operators<S>& x) {
  return {internal::less_one(x.phi), x.E_phi * x.phi};
}
template <Field S>
Sides<S> compliance_split(const Operators<S>& x) {
  const Operator<S> psi_tilde = internal::less_one(x.psi);
  return {internal::psi_HD(x) * internal::H_psi(x), x.Omega + psi_tilde.T() * x.Omega + x.Omega * psi_tilde};
}
template <Field S>
Sides<S> compliance(const Operators<S>& x) {
  return {x.Omega, x.E_psi.T() * x.Omega * x.E_psi + internal::HDH(x)};
}
template <Field S>
Sides<S> base_step_by_operators(const Operators<S>& x) {
  const Operator<S> PE = x.P * x.E.T();
  return {x.E.T() - internal::HDH(x) * (x.psi * PE), x.W.T()};
}

// Properties that follow from (24) to (29), with motor inertia.

template <Field S>
Sides<S> hinge_gain(const Operators<S>& x) {
  return {x.H * x.G, internal::one_joints(x) - x.Jm * x.D_inv};
}
template <Field S>
Sides<S> hinge_strip(const Operators<S>& x) {
  return {x.H * (internal::one_links(x) - x.G * x.H), x.Jm * x.D_inv * x.H};
}
template <Field S>
Sides<S> psi_gain(const Operators<S>& x) {
  return {x.E_psi * x.G, x.K * x.Jm * x.D_inv};
}
template <Field S>
Sides<S> articulated_symmetry(const Operators<S>& x) {
  return {x.P, x.P.T()};
}
template <Field S>
Sides<S> compliance_symmetry(const Operators<S>& x) {
  return {x.Omega, x.Omega.T()};
}

}  // namespace osculate::dense
