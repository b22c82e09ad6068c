#include "model/lumping.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <charconv>
#include <cmath>

#include "input/number_text.hpp"
#include "scalar/eps.hpp"

namespace osculate::internal {
namespace {

// Backward error of the symmetric eigenvalue routine is a small multiple of eps |I|; 64 covers the rotation
// into the link frame as well.
constexpr double slack = 64 * eps;

/// Principal inertias, smallest first, kg m^2.
Vector3<double> principal(const Matrix3<double>& inertia) {
  return Eigen::SelfAdjointEigenSolver<Matrix3<double>>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

std::string list(const Vector3<double>& values) {
  const double rounding = slack * values.cwiseAbs().maxCoeff();
  const Vector3<double> x = (values.array().abs() <= rounding).select(0.0, values);
  return "(" + short_number(x[0]) + ", " + short_number(x[1]) + ", " + short_number(x[2]) + ")";
}

/// Inertia about a point at -d from the centre of mass, of the mass alone.
Matrix3<double> shifted(double mass, const Vector3<double>& d) {
  return mass * (d.squaredNorm() * Matrix3<double>::Identity() - d * d.transpose());
}

}  // namespace

Placement operator*(const Placement& a, const Placement& b) { return {a.R * b.R, a.R * b.p + a.p}; }

RigidBody placed(const Placement& at, const RigidBody& body) {
  const bool turned = at.R != Matrix3<double>::Identity();
  const Matrix3<double> I = turned ? Matrix3<double>(at.R * body.inertia * at.R.transpose()) : body.inertia;
  return {body.mass, at.R * body.com + at.p, 0.5 * I + 0.5 * I.transpose()};
}

RigidBody lump(const std::vector<RigidBody>& bodies) {
  if (bodies.empty()) return {};
  if (bodies.size() == 1) return bodies.front();
  RigidBody sum;
  Vector3<double> moment = Vector3<double>::Zero();
  for (const auto& b : bodies) {
    sum.mass += b.mass;
    moment += b.mass * b.com;
  }
  sum.com = sum.mass > 0 ? Vector3<double>(moment / sum.mass) : bodies.front().com;
  for (const auto& b : bodies) sum.inertia += b.inertia + shifted(b.mass, b.com - sum.com);
  return sum;
}

std::optional<std::string> body_fault(const RigidBody& body) {
  if (!std::isfinite(body.mass) || !body.com.allFinite() || !body.inertia.allFinite())
    return "mass " + number_text(body.mass) +
           " kg, centre of mass or inertia is not a finite number. Check the units.";
  if (body.mass < 0) return "mass " + number_text(body.mass) + " kg is negative. Give a mass >= 0.";
  const Vector3<double> I = principal(body.inertia);
  if (!I.allFinite()) return "principal inertias " + list(I) + " kg m^2 are not finite. Check the units.";
  if (I[0] < -slack * I.cwiseAbs().maxCoeff())
    return "principal inertias " + list(I) +
           " kg m^2: an inertia must have none below 0. Check the signs, and the products of inertia ixy, "
           "ixz, iyz.";
  return std::nullopt;
}

std::optional<std::string> triangle_fault(const RigidBody& body) {
  const Vector3<double> I = principal(body.inertia);
  if (I[2] <= I[0] + I[1] + slack * I[2]) return std::nullopt;
  return "principal inertias " + list(I) + " kg m^2 break the triangle inequality (" + short_number(I[2]) +
         " > " + short_number(I[0] + I[1]) +
         "). No rigid body has these; check for a unit or about-point mistake.";
}

std::string short_number(double x) {
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::general, 6).ptr;
  return {text.data(), end};
}

}  // namespace osculate::internal
