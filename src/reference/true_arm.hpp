// The exact arm behind rounded numbers.
#pragma once

#include "model/chain.hpp"
#include "scalar/quad.hpp"

namespace osculate {

/// R made orthonormal to the last bit of Quad by two Newton steps R <- R (3 1 - R^T R) / 2. Each squares the
/// defect, so rotations rounded in double (1e-16) end near 1e-64.
inline Matrix3<Quad> orthonormal(Matrix3<Quad> R) {
  const Matrix3<Quad> three = Quad(3) * Matrix3<Quad>::Identity();
  for (int step = 0; step < 2; ++step) R = Matrix3<Quad>(R * (three - R.transpose() * R) / Quad(2));
  return R;
}

/// The arm that the doubles of `chain` stand for: rotations orthonormal and axes of length 1 in Quad, every
/// other number as it is; the slides of a planar joint normal to its axis. Without this there would be no
/// true arm: J and M disagree by eps on what a joint does if its axis has not length 1.
inline Chain<Quad> true_arm(const Chain<double>& chain) {
  Chain<Quad> out = cast<Quad>(chain);
  out.R_tip = orthonormal(out.R_tip);
  for (Link<Quad>& link : out.links) {
    link.R_origin = orthonormal(link.R_origin);
    link.axis /= link.axis.norm();
    if (link.type == JointType::planar) link.axis2 -= Vector3<Quad>(link.axis * link.axis.dot(link.axis2));
    link.axis2 /= link.axis2.norm();
  }
  return out;
}

}  // namespace osculate
