// Joint positions as field numbers. Trigonometry stops here: everything further in takes cosines and sines,
// so that exact rational poses exist.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "model/chain.hpp"

namespace osculate {

/// Where one joint stands. Revolute: c, s are cosine and sine of the angle, d = 0. Prismatic: c = 1, s = 0, d
/// in m.
template <Field S>
struct JointPosition {
  S c = S(1), s = S(0), d = S(0);
};

/// Joint positions (base to tip) of a chain from coordinates q (rad or m, base to tip). q.size() ==
/// chain.n().
template <Field S>
void set_positions(const Chain<S>& chain, std::span<const S> q, std::vector<JointPosition<S>>& out) {
  using std::cos;
  using std::sin;
  out.resize(q.size());
  for (std::size_t i = 0; i < q.size(); ++i)
    out[i] = chain.links[i].type == JointType::revolute ? JointPosition<S>{cos(q[i]), sin(q[i]), S(0)}
                                                        : JointPosition<S>{S(1), S(0), q[i]};
}

template <Field S>
std::vector<JointPosition<S>> positions(const Chain<S>& chain, std::span<const S> q) {
  std::vector<JointPosition<S>> out;
  set_positions(chain, q, out);
  return out;
}

/// Rotation about the unit vector `axis` with the given cosine and sine (Rodrigues' formula). Field
/// operations only.
template <Field S>
Matrix3<S> rotation(const Vector3<S>& axis, const S& c, const S& s) {
  const S& x = axis[0];
  const S& y = axis[1];
  const S& z = axis[2];
  const S v = S(1) - c;
  Matrix3<S> R;
  R << c + v * x * x, v * x * y - s * z, v * x * z + s * y,  //
      v * x * y + s * z, c + v * y * y, v * y * z - s * x,   //
      v * x * z - s * y, v * y * z + s * x, c + v * z * z;
  return R;
}

}  // namespace osculate
