#include "control/command_slope.hpp"

namespace osculate {

// With e = e_R, E = exp(e~) = R_ref R^T and a tip that turns by rho, R' = rho~ R:
//   E'      = eps~ E,  eps = -E rho
//   e'      = J_l(e)^-1 eps
//   (E w)'  = eps x E w + E w'
//   delta'  = -(E w)'                                           delta = w_ref - E w = J_l e.
//   e.'     = J_l^-1 (delta' - J_l'[e'] e.)
// and u = E^T turning, turning = a_ref - delta x E w - J_l e.. - J_l'[e.] e.  (pose_error.cpp). J_l'[x] is
// the derivative of J_l(e) along x, J_l''[x, y] the second one.
//
// With s = |e|^2, J_l(e) z = z + b(s) e x z + c(s) e x (e x z). The coefficients obey s b' = a/2 - b and
// s c' = (b - 3 c)/2, where a = 1 - s c has the derivative (c - b)/2; hence
//   b'' = ((c - b)/4 - 2 b') / s,    c'' = (b' - 5 c') / (2 s).
// Rounding makes that wrong by eps / s near s = 0; every use multiplies it by s or more.

bool CommandSlope::exists(const LawOptions& law) {
  return law.obstacles.empty() && !chart_of(law.orientation, law.position);
}

CommandSlope::CommandSlope(const LawOptions& law, const Command& command, const Vector6& tip_force)
    : law_(law),
      E_(command.reference.pose.R * command.tip.R.transpose()),
      error_turn_(command.error.e.head<3>()),
      e_(command.error.e.head<3>()),
      ed_(command.error.ed.head<3>()),
      turned_(E_ * command.tip_velocity.head<3>()),
      f_(rotation_coefficients(e_.squaredNorm())) {
  const double s = e_.squaredNorm();
  b_second_ = s > 0 ? ((f_.c - f_.b) / 4 - 2 * f_.b_slope) / s : 1 / 360.0;
  c_second_ = s > 0 ? (f_.b_slope - 5 * f_.c_slope) / (2 * s) : 1 / 2520.0;
  edd_ = -law.damping.head<3>().cwiseProduct(ed_) - law.stiffness.head<3>().cwiseProduct(e_);
  if (law.virtual_inertia) edd_ -= tip_force.head<3>().cwiseQuotient(law.virtual_inertia->head<3>());
  delta_ = -turned_;
  turning_ = -error_turn_.left_jacobian(edd_) - error_turn_.left_jacobian_rate(ed_);
  if (law.feedforward) {
    delta_ += command.reference.velocity.head<3>();
    turning_ += command.reference.acceleration.head<3>();
  }
  turning_ -= delta_.cross(turned_);
}

Vector3<double> CommandSlope::bent_jacobian(const Vector3<double>& x, const Vector3<double>& y,
                                            const Vector3<double>& z) const {
  const double sx = 2 * e_.dot(x), sy = 2 * e_.dot(y), sxy = 2 * x.dot(y);
  const Vector3<double> ez = e_.cross(z), xz = x.cross(z), yz = y.cross(z);
  return (b_second_ * sx * sy + f_.b_slope * sxy) * ez + f_.b_slope * (sx * yz + sy * xz) +
         (c_second_ * sx * sy + f_.c_slope * sxy) * e_.cross(ez) +
         f_.c_slope * (sx * (y.cross(ez) + e_.cross(yz)) + sy * (x.cross(ez) + e_.cross(xz))) +
         f_.c * (x.cross(yz) + y.cross(xz));
}

Vector6 CommandSlope::along(const TipChange& tip) const {
  if (law_.constant_command) return Vector6::Zero();
  const RotationVector& J = error_turn_;
  const Vector3<double> eps = -E_ * tip.pose.head<3>();
  const Vector3<double> turned = eps.cross(turned_) + E_ * tip.velocity.head<3>();
  const Vector3<double> e = J.left_jacobian_inverse(eps);
  const Vector3<double> ed = J.left_jacobian_inverse(-turned - J.left_jacobian_rate(e, ed_));

  Vector6 edd;  // rows 3..5: the error is p_ref - p
  edd.head<3>() = -law_.damping.head<3>().cwiseProduct(ed) - law_.stiffness.head<3>().cwiseProduct(e);
  edd.tail<3>() = law_.damping.tail<3>().cwiseProduct(tip.velocity.tail<3>()) +
                  law_.stiffness.tail<3>().cwiseProduct(tip.pose.tail<3>());
  if (law_.virtual_inertia) edd -= tip.force.cwiseQuotient(*law_.virtual_inertia);

  const Vector3<double> deltad = J.left_jacobian(edd.head<3>()) + J.left_jacobian_rate(e, edd_) +
                                 J.left_jacobian_rate(ed, ed_) + J.left_jacobian_rate(ed_, ed) +
                                 bent_jacobian(e, ed_, ed_);
  const Vector3<double> turning = turned.cross(turned_) - delta_.cross(turned) - deltad;
  Vector6 u;
  u.head<3>() = E_.transpose() * (turning - eps.cross(turning_));
  u.tail<3>() = -edd.tail<3>();
  if (law_.force)
    for (const int row : law_.force->rows)
      u[row] = tip.force[row] / law_.force->inertia - law_.force->damping * tip.velocity[row];
  return u;
}

}  // namespace osculate
