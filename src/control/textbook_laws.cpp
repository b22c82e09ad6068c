// The laws of textbook_laws.hpp, each in the one or two statements that its equation asks for. J, Lambda and
// what is made of them are on the task rows. On a moving base C and Jdot qd contain what the base adds, so a
// law that drops one of them drops that part of the base's motion too.
//
// Sources. (16): Kreutz-Delgado, Jain & Rodriguez 1992. Khatib 1987: A unified approach for motion and force
// control of robot manipulators, IEEE J. Robotics and Automation 3(1). Nakanishi et al. 2008: Operational
// space control: a theoretical and empirical comparison, Int. J. Robotics Research 27(6). Siciliano et al.
// 2009: Robotics, chapter 8, operational space control. What programs leave out
// is what their public code or documentation says of them.
#include "control/textbook_laws.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include "reference/dense.hpp"

namespace osculate {

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;
using dense::solve;
using Factor = dense::Ldlt<double>;

// A pivot of L D L^T below this fraction of its diagonal entry has lost all but a few bits: rank loss in
// double. What rounding leaves of it grows as the pivots before it shrink.
constexpr double pivot_floor = 1e-13;

/// The factor of a positive definite matrix; nullopt where it has lost rank. Neither changes when rows and
/// columns are scaled.
std::optional<Factor> regular(const Matrix& A) {
  Factor f = dense::factor(A);
  double smallest = 1;  // pivot so far, over its diagonal entry
  for (Eigen::Index i = 0; i < f.D.size(); ++i) {
    const double left = f.D[i] / A(i, i);
    if (!(left * smallest > pivot_floor)) return std::nullopt;
    smallest = std::min(smallest, left);
  }
  return f;
}

Vector vector(std::span<const double> x) {
  return Eigen::Map<const Vector>(x.data(), static_cast<Eigen::Index>(x.size()));
}

/// Omega with its angular and linear rows uncoupled: the inverse of what it stands for is diag(L_w, L_v).
Matrix uncoupled(Matrix Omega, const TaskRows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows.size(); ++j)
      if ((rows[i] < 3) != (rows[j] < 3))
        Omega(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = 0;
  return Omega;
}

constexpr std::array<TextbookLawInfo, 8> laws{{
    {TextbookLaw::dense, "operational_space_dense", "nothing",
     "Khatib 1987; (16) of Kreutz-Delgado, Jain and Rodriguez 1992; Nakanishi et al. 2008 as the dynamically "
     "consistent law"},
    {TextbookLaw::no_jdot_qd, "no_jdot_qd", "Jdot qd",
     "robosuite's operational space controller, which compensates C and G only; abr_control with use_C; "
     "mjctrl"},
    {TextbookLaw::no_coriolis, "no_coriolis", "C",
     "the other half of what gravity_only leaves out, alone; not known to be in use"},
    {TextbookLaw::gravity_only, "gravity_only", "C and Jdot qd",
     "SAI primitives; abr_control as it comes; the operational space controllers of Isaac Lab and "
     "Newton"},
    {TextbookLaw::block_inertia, "block_inertia",
     "the coupling of turning and sliding in Lambda, and Jdot qd",
     "robosuite's operational space controller with position and orientation uncoupled, as it comes"},
    {TextbookLaw::pseudo_inverse, "pseudo_inverse",
     "the inertia weight of the inverse, and the effect of the null space on the tip",
     "Luh, Walker and Paul 1980; Nakanishi et al. 2008 as simplified acceleration control without "
     "premultiplication of the null space by M"},
    {TextbookLaw::kinematic_null_space, "kinematic_null_space", "the effect of the null space on the tip",
     "the projector of the Cartesian impedance example of franka_ros; Khatib 1987 says why it disturbs the "
     "tip"},
    {TextbookLaw::jacobian_transpose, "jacobian_transpose",
     "all dynamics but G; Lambda is a constant diagonal",
     "Siciliano et al. 2009 as PD control with gravity compensation; Takegaki and Arimoto 1981"},
}};

}  // namespace

std::span<const TextbookLawInfo> textbook_laws() { return laws; }

bool textbook_torque(TextbookLaw law, const Chain<double>& model,
                     const std::vector<JointPosition<double>>& joints, const BaseMotion<double>& base,
                     std::span<const double> qd, const TaskRows& rows, std::span<const double> u_task,
                     std::span<const double> T0_applied, const Vec<Force, double>& F_known,
                     std::span<const double> B, std::span<double> T) {
  const Vector u = vector(u_task), T0 = vector(T0_applied);
  const auto [tip, joint] = dense::state(model, joints, vector(qd), base);
  const auto& [M, C, G] = joint;
  const auto [J, Jdot_qd, Omega, J_Minv_C, J_Minv_G] = dense::mobility(tip, joint, rows);
  const Matrix Jt = J.transpose();  // J*

  Vector out;
  if (law == TextbookLaw::jacobian_transpose) {
    out = Jt * vector(B).cwiseProduct(u) + G + T0;  // T = J* (B u) + G + T0
  } else if (law == TextbookLaw::pseudo_inverse) {
    const auto JJt = regular(J * Jt);
    if (!JJt) return false;
    // J^+ = J* (J J*)^-1, and J* J*^+ = J* (J J*)^-1 J
    const Vector qdd = Jt * solve(*JJt, Vector(u - Jdot_qd));      // J^+ (u - Jdot qd)
    const Vector T0_free = T0 - Jt * solve(*JJt, Vector(J * T0));  // (1 - J* J*^+) T0
    out = M * qdd + C + G + T0_free;
  } else {
    const auto Lambda = regular(Omega);  // solve(*Lambda, x) is Lambda x
    if (!Lambda) return false;
    const Vector J_Minv_T0 = J * solve(dense::factor(M), T0);
    switch (law) {
      case TextbookLaw::dense:  // T = J* Lambda (u + J M^-1 (C + G - T0) - Jdot qd) + T0          (16)
        out = Jt * solve(*Lambda, Vector(u + J_Minv_C + J_Minv_G - J_Minv_T0 - Jdot_qd)) + T0;
        break;
      case TextbookLaw::no_jdot_qd:  // T = J* Lambda (u + J M^-1 (C + G - T0)) + T0
        out = Jt * solve(*Lambda, Vector(u + J_Minv_C + J_Minv_G - J_Minv_T0)) + T0;
        break;
      case TextbookLaw::no_coriolis:  // T = J* Lambda (u + J M^-1 (G - T0) - Jdot qd) + T0
        out = Jt * solve(*Lambda, Vector(u + J_Minv_G - J_Minv_T0 - Jdot_qd)) + T0;
        break;
      case TextbookLaw::gravity_only:  // T = J* Lambda (u - J M^-1 T0) + G + T0
        out = Jt * solve(*Lambda, Vector(u - J_Minv_T0)) + G + T0;
        break;
      case TextbookLaw::block_inertia: {  // T = J* diag(L_w, L_v) u + C + G + (1 - J* Lambda J M^-1) T0
        const auto blocks = regular(uncoupled(Omega, rows));
        if (!blocks) return false;
        out = Jt * solve(*blocks, u) + C + G + T0 - Jt * solve(*Lambda, J_Minv_T0);
        break;
      }
      case TextbookLaw::kinematic_null_space: {
        const auto JJt = regular(J * Jt);
        if (!JJt) return false;
        // T = J* Lambda (u + J M^-1 (C + G) - Jdot qd) + (1 - J* J*^+) T0
        out = Jt * solve(*Lambda, Vector(u + J_Minv_C + J_Minv_G - Jdot_qd)) + T0 -
              Jt * solve(*JJt, Vector(J * T0));
        break;
      }
      case TextbookLaw::pseudo_inverse:
      case TextbookLaw::jacobian_transpose:
        break;  // above
    }
  }
  dense::Vector6<double> F;
  for (int i = 0; i < 6; ++i) F[i] = component(F_known, i);
  Eigen::Map<Vector>(T.data(), out.size()) = out - tip.J.transpose() * F;
  return true;
}

std::vector<double> inertia_diagonal(const Chain<double>& model,
                                     const std::vector<JointPosition<double>>& joints, const TaskRows& rows,
                                     const BaseMotion<double>& base) {
  const auto [tip, joint] = dense::state(model, joints, Vector(Vector::Zero(model.velocities())), base);
  const auto Lambda = regular(dense::mobility(tip, joint, rows).Omega);
  if (!Lambda)
    throw std::domain_error("the diagonal of Lambda does not exist: the arm is singular on the task rows");
  const auto m = static_cast<Eigen::Index>(rows.size());
  const Vector diagonal = solve(*Lambda, Matrix(Matrix::Identity(m, m))).diagonal();
  return {diagonal.begin(), diagonal.end()};
}

}  // namespace osculate
