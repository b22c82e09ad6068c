// Textbook kinematics for the tests: 4x4 transforms, column by column Jacobians. Shares nothing with src/ but
// the Chain.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "model/chain.hpp"

namespace textbook {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

inline Matrix4d transform(const Matrix3d& R, const Vector3d& p) {
  Matrix4d T = Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = R;
  T.topRightCorner<3, 1>() = p;
  return T;
}
inline Matrix3d turn(double angle, const Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}
inline Matrix4d turn_x(double a) { return transform(turn(a, Vector3d::UnitX()), Vector3d::Zero()); }
inline Matrix4d turn_z(double a) { return transform(turn(a, Vector3d::UnitZ()), Vector3d::Zero()); }
inline Matrix4d shift(double x, double y, double z) { return transform(Matrix3d::Identity(), {x, y, z}); }

/// Roll about x, then pitch about the fixed y, then yaw about the fixed z: the rpy of a URDF origin.
inline Matrix3d from_rpy(const Vector3d& rpy) {
  return turn(rpy[2], Vector3d::UnitZ()) * turn(rpy[1], Vector3d::UnitY()) * turn(rpy[0], Vector3d::UnitX());
}

/// Poses of all links (base to tip) and of the tip, base frame: n + 1 transforms.
inline std::vector<Matrix4d> poses(const osculate::Chain<double>& chain, const VectorXd& q) {
  std::vector<Matrix4d> T;
  Matrix4d at = Matrix4d::Identity();
  for (int i = 0; i < chain.n(); ++i) {
    const auto& l = chain.links[i];
    at = at * transform(l.R_origin, l.p_origin);
    at = at * (l.type == osculate::JointType::revolute ? transform(turn(q[i], l.axis), Vector3d::Zero())
                                                       : transform(Matrix3d::Identity(), l.axis * q[i]));
    T.push_back(at);
  }
  T.push_back(at * transform(chain.R_tip, chain.p_tip));
  return T;
}

struct Dynamics {
  MatrixXd M;
  VectorXd G;  // the torque that holds the arm still
};

/// M = sum of J* m J and Jw* I Jw over the links, G the gradient of the potential energy; revolute joints
/// only.
inline Dynamics mass_and_gravity(const osculate::Chain<double>& chain, const VectorXd& q) {
  const auto T = poses(chain, q);
  const int n = chain.n();
  Dynamics out{MatrixXd::Zero(n, n), VectorXd::Zero(n)};
  for (int i = 0; i < n; ++i) out.M(i, i) = chain.links[i].armature;
  for (int k = 0; k < n; ++k) {
    const auto& l = chain.links[k];
    const Matrix3d R = T[k].topLeftCorner<3, 3>();
    const Vector3d com = R * l.com + T[k].topRightCorner<3, 1>();
    MatrixXd Jv = MatrixXd::Zero(3, n), Jw = MatrixXd::Zero(3, n);
    for (int i = 0; i <= k; ++i) {
      const Vector3d z = T[i].topLeftCorner<3, 3>() * chain.links[i].axis;
      const Vector3d p = T[i].topRightCorner<3, 1>();
      Jw.col(i) = z;
      Jv.col(i) = z.cross(com - p);
    }
    out.M += l.mass * Jv.transpose() * Jv + Jw.transpose() * R * l.inertia * R.transpose() * Jw;
    out.G -= l.mass * Jv.transpose() * chain.gravity;
  }
  return out;
}

}  // namespace textbook
