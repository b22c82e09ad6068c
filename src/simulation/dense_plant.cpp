#include "simulation/dense_plant.hpp"

namespace osculate {

namespace {

Vec3<double> vec(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }
Vec<Motion, double> motion(const dense::Vector6<double>& v) {
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

}  // namespace

void DensePlant::move(std::span<const double> qd) {
  qd_ = Eigen::Map<const VectorX<double>>(qd.data(), static_cast<Eigen::Index>(qd.size()));
  at_ = dense::state(chain_, joints_, qd_, base_);
}

void DensePlant::accelerations(std::span<const double> T, const Vec<Force, double>& F_ext,
                               std::span<double> qdd) {
  const Eigen::Map<const VectorX<double>> torque(T.data(), static_cast<Eigen::Index>(T.size()));
  dense::Vector6<double> push;
  push << F_ext.ang.x, F_ext.ang.y, F_ext.ang.z, F_ext.lin.x, F_ext.lin.y, F_ext.lin.z;
  qdd_ = dense::forward_dynamics(at_.joint, at_.tip.J, VectorX<double>(torque), push);
  std::copy(qdd_.begin(), qdd_.end(), qdd.begin());
}

Vec<Motion, double> DensePlant::tip_velocity() const { return motion(at_.tip.tip_velocity); }
Vec<Motion, double> DensePlant::tip_acceleration() const {
  return motion(at_.tip.J * qdd_ + at_.tip.Jdot_qd);
}
Mat3<double> DensePlant::tip_rotation() const {
  const Matrix3<double>& R = at_.tip.R;
  return {vec(R.row(0)), vec(R.row(1)), vec(R.row(2))};
}
Vec3<double> DensePlant::tip_position() const { return vec(at_.tip.p); }
double DensePlant::kinetic_energy(std::span<const double>) const {
  return dense::kinetic_energy(at_.joint, qd_);
}
double DensePlant::potential_energy() const { return dense::potential_energy(chain_, joints_); }

}  // namespace osculate
