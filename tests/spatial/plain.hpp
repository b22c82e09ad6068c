// Structured spatial maps written out as plain matrices, angular rows first.
#pragma once

#include "model/chain.hpp"
#include "spatial/map.hpp"

namespace osculate::testing {

template <Field S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
template <Field S>
using Matrix6 = Eigen::Matrix<S, 6, 6>;

template <Field S>
Vector3<S> plain(const Vec3<S>& v) {
  return {v.x, v.y, v.z};
}
template <Field S>
Matrix3<S> plain(const Mat3<S>& a) {
  Matrix3<S> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = entry(a, i, j);
  return out;
}
template <Field S>
Matrix3<S> plain(const Sym3<S>& a) {
  Matrix3<S> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = entry(a, i, j);
  return out;
}
template <class Space, Field S>
Vector6<S> plain(const Vec<Space, S>& v) {
  return {v.ang.x, v.ang.y, v.ang.z, v.lin.x, v.lin.y, v.lin.z};
}
template <class To, Field S>
Matrix6<S> plain(const Symmetric<To, S>& a) {
  Matrix6<S> out;
  out.template topLeftCorner<3, 3>() = plain(a.J);
  out.template topRightCorner<3, 3>() = plain(a.B);
  out.template bottomLeftCorner<3, 3>() = plain(a.B).transpose();
  out.template bottomRightCorner<3, 3>() = plain(a.A);
  return out;
}

/// Six numbers as an element of Space.
template <class Space, Field S>
Vec<Space, S> as(const Vector6<S>& v) {
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

/// a~ with a~ x = a x x.
template <Field S>
Matrix3<S> skew(const Vector3<S>& a) {
  const S o(0);
  Matrix3<S> A;
  A << o, -a[2], a[1], a[2], o, -a[0], -a[1], a[0], o;
  return A;
}

}  // namespace osculate::testing
