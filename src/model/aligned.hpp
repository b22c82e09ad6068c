// The same arm with every revolute and prismatic joint along the z axis of its link: placing it then takes a
// turn about z and no general rotation.
#pragma once

#include "model/chain.hpp"

namespace osculate {

/// Below zero; of a packet the first lane, of a dual number the value.
template <Field S>
bool is_negative(const S& x) {
  if constexpr (Ordered<S>)
    return x < S(0);
  else if constexpr (requires { first_lane(x); })
    return first_lane(x) < 0;
  else
    return is_negative(x.value);
}

/// A rotation whose third column is the unit vector `axis`: the smallest one that turns z, or -z where that
/// is nearer, into it. Field operations only; for a packet the first lane chooses.
template <Field S>
Matrix3<S> rotation_onto(const Vector3<S>& axis) {
  const bool down = is_negative(axis[2]);
  const S one(1), x = down ? S(-axis[0]) : axis[0], y = down ? S(-axis[1]) : axis[1],
                  z = down ? S(-axis[2]) : axis[2];
  const S w = one / (one + z);
  Matrix3<S> R;
  R << one - x * x * w, -(x * y * w), x, -(x * y * w), one - y * y * w, y, -x, -y, z;
  if (down) R.col(1) = -R.col(1), R.col(2) = -R.col(2);  // half a turn about x
  return R;
}

/// An arm with the same motion, tip and joint torques for the same coordinates. Only link frames differ: each
/// is turned within its link so that `axis` is z.
template <Field S>
Chain<S> aligned(const Chain<S>& chain) {
  Chain<S> out = chain;
  Matrix3<S> inboard = Matrix3<S>::Identity();  // new axes of the inboard link in its old ones
  for (Link<S>& link : out.links) {
    const Matrix3<S> own =
        one_axis(link.type) ? rotation_onto(link.axis) : Matrix3<S>(Matrix3<S>::Identity());
    link.p_origin = inboard.transpose() * link.p_origin;
    link.R_origin = Matrix3<S>(inboard.transpose() * link.R_origin) * own;
    link.com = own.transpose() * link.com;
    link.inertia = Matrix3<S>(own.transpose() * link.inertia) * own;
    if (one_axis(link.type)) link.axis = Vector3<S>::UnitZ();
    inboard = own;
  }
  out.p_tip = inboard.transpose() * out.p_tip;
  out.R_tip = inboard.transpose() * out.R_tip;
  return out;
}

}  // namespace osculate
