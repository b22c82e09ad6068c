#include "judge/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/pose.hpp"
#include "reference/dense.hpp"

namespace osculate {

namespace {

using Vector = VectorX<double>;
using Matrix = MatrixX<double>;
using dense::solve;

// A pivot of Omega below this fraction of its diagonal entry: noise of 1e-4 in q would drown Lambda.
constexpr double pivot_floor = 1e-8;
constexpr double step =
    1e-6;  // of finite differences: kg m^2, kg, kg m, m; their error is 1e-6 of the column
constexpr double coulomb_speed = 1e-2;  // rad/s or m/s: width of the step of Coulomb friction

std::array<std::string, 4> payload_names{"mass", "first moment x", "first moment y", "first moment z"};

bool has(const std::vector<int>& rows, int from) {
  for (int i = from; i < from + 3; ++i)
    if (std::find(rows.begin(), rows.end(), i) == rows.end()) return false;
  return true;
}

bool any(const std::vector<int>& rows, int from) {
  return std::any_of(rows.begin(), rows.end(), [&](int i) { return i >= from && i < from + 3; });
}

Vector6 swapped(const Vector6& x) { return (Vector6() << x.tail<3>(), x.head<3>()).finished(); }

Matrix3<double> rotation_of(const Eigen::Vector4d& w_first) {
  return Eigen::Quaterniond(w_first[0], w_first[1], w_first[2], w_first[3]).normalized().toRotationMatrix();
}

/// w x y z read as x y z w.
Eigen::Vector4d misread(const Eigen::Vector4d& x) { return {x[3], x[0], x[1], x[2]}; }

}  // namespace

Chain<double> believed(const Chain<double>& model, const Belief& belief) {
  Chain<double> out = model;
  int column = 0;
  for (auto& link : out.links) {
    if (one_axis(link.type) && belief.armature.size() > 0) link.armature += belief.armature[column];
    column += velocity_count(link.type);
  }
  // The payload: mass m, first moment h about the tip point, no inertia about it.
  auto& last = out.links.back();
  const double m = belief.payload[0], mass = last.mass + m;
  const Vector3<double> p = model.p_tip, h = model.R_tip * belief.payload.tail<3>();
  const auto about = [](double weight, const Vector3<double>& a,
                        const Vector3<double>& b) -> Matrix3<double> {
    return weight * (a.dot(b) * Matrix3<double>::Identity() - 0.5 * (a * b.transpose() + b * a.transpose()));
  };
  if (belief.payload != Eigen::Vector4d::Zero()) {
    const Matrix3<double> at_origin =
        last.inertia + about(last.mass, last.com, last.com) + about(m, p, p) + about(2, p, h);
    last.com = Vector3<double>(last.mass * last.com + m * p + h) / mass;
    last.inertia = at_origin - about(mass, last.com, last.com);
    last.mass = mass;
  }
  out.p_tip += model.R_tip * belief.tip_offset;
  return out;
}

/// All that a state defines, and the commanded acceleration.
struct Candidates::Point {
  dense::State<double> state;
  dense::Mobility<double> task;
  dense::Ldlt<double> M, Lambda;  // Lambda: the factor of Omega
  Matrix J_Minv;                  // J M^-1, task rows
  TipReference reference;
  PoseError error;
  Vector6 u = Vector6::Zero();

  /// J* Lambda x
  Vector pull(const Vector& x) const { return task.J.transpose() * solve(Lambda, x); }
  /// What the tip feels of a torque: J* Lambda J M^-1 T
  Vector felt(const Vector& T) const { return pull(J_Minv * T); }
};

Candidates::Candidates(const Chain<double>& model, const JudgeOptions& options, bool from_reference,
                       bool order_known, ErrorLaw error_law)
    : model_(model),
      options_(options),
      from_reference_(from_reference),
      turns_(has(options.rows, 0)),
      slides_(has(options.rows, 3)),
      redundant_(model.velocities() > static_cast<int>(options.rows.size())),
      error_law_(error_law) {
  const int n = model.velocities(), m = static_cast<int>(options.rows.size());
  const auto term = [&](const char* id, const char* phrase, CandidateKind kind = CandidateKind::term,
                        int count = 1) {
    add(list_, columns_, {id, phrase, kind}, count);
  };
  term("jdot_qd", "J* Lambda Jdot qd");
  term("coriolis", redundant_ ? "J* Lambda J M^-1 C" : "C");
  term("gravity", redundant_ ? "J* g" : "G");
  if (!options.friction.empty()) term("friction_model", "the friction of the model");
  if (!from_reference) {
    term("command", "J* Lambda u");
  } else if (options.gains) {
    if (any(options.rows, 0)) term("stiffness_angular", "the orientation error");
    if (any(options.rows, 3)) term("stiffness_linear", "the position error");
    if (any(options.rows, 0)) term("damping_angular", "the rate of the orientation error");
    if (any(options.rows, 3)) term("damping_linear", "the rate of the position error");
    term("feedforward", "the acceleration of the reference");
  } else {
    Candidate gains{"gains", "the gains", CandidateKind::gains};
    for (const int half : {0, 3})
      if (any(options.rows, half))
        for (const char* name : {"stiffness", "damping"}) {
          gains.names.push_back(std::string(name) + (half == 0 ? ", angular" : ", linear"));
          gains.units.push_back(name[0] == 's' ? "1/s^2" : "1/s");
        }
    add(list_, columns_, gains, static_cast<int>(gains.names.size()));
    term("feedforward", "the acceleration of the reference");
  }
  if (any(options.rows, 0) && any(options.rows, 3))
    term("uncoupled_lambda", "takes Lambda of the angular and of the linear rows apart",
         CandidateKind::mistake);
  Candidate constant{"constant_lambda", "takes a constant diagonal inertia in place of Lambda",
                     CandidateKind::mistake};
  constant.names.push_back("share of Lambda");
  constant.units.push_back("1");
  for (const int row : options.rows) {
    constant.names.push_back(std::string(row < 3 ? "angular " : "linear ") + "xyz"[row % 3]);
    constant.units.push_back(row < 3 ? "kg m^2" : "kg");
  }
  add(list_, columns_, constant, 1 + m);
  if (turns_ && slides_ && order_known)
    term("swapped_rows", "takes the angular and the linear rows of u in the wrong order",
         CandidateKind::mistake);
  if (turns_ || slides_) {
    term("u_in_tip_frame", "takes u as if it were in the tip's axes", CandidateKind::mistake);
    term("u_turned_to_tip", "turns u into the tip's axes but takes J in those of the base",
         CandidateKind::mistake);
  }
  if (slides_)
    term("spatial_acceleration",
         "mixes classical and spatial accelerations: omega x v is missing in Jdot qd, or in u",
         CandidateKind::mistake);
  if (from_reference && turns_) {
    term("quaternion_reference", "reads the reference's quaternion in the wrong order",
         CandidateKind::mistake);
    term("quaternion_both", "reads both quaternions in the wrong order", CandidateKind::mistake);
  }
  const auto per_joint = [&](const char* id, const char* phrase, const char* turning, const char* sliding) {
    Candidate c{id, phrase, CandidateKind::parameter};
    for (std::size_t i = 0; i < model.links.size(); ++i)
      for (int j = 0; j < velocity_count(model.links[i].type); ++j) {
        c.names.push_back("joint " + std::to_string(i + 1));
        const bool slide = model.links[i].type == JointType::prismatic;
        c.units.push_back(slide ? sliding : turning);
      }
    add(list_, columns_, c, n);
  };
  if (model.one_axis_joints()) per_joint("armature", "armature", "kg m^2", "kg");
  Candidate payload{"payload", "a payload", CandidateKind::parameter};
  payload.names.assign(payload_names.begin(), payload_names.end());
  payload.units = {"kg", "kg m", "kg m", "kg m"};
  add(list_, columns_, payload, 4);
  add(list_, columns_,
      {"tip_point", "another tip point", CandidateKind::parameter, 0, 3, {"x", "y", "z"}, {"m", "m", "m"}},
      3);
  per_joint("viscous", "viscous friction", "N m s/rad", "N s/m");
  per_joint("coulomb", "Coulomb friction", "N m", "N");
  per_joint("torque_scale", "scale", "1", "1");
  add(list_, columns_,
      {"gravity_vector",
       "another gravity",
       CandidateKind::parameter,
       0,
       3,
       {"x", "y", "z"},
       {"m/s^2", "m/s^2", "m/s^2"}},
      3);
  if (redundant_) {
    const auto null_term = [&](const char* id, const char* phrase, int count = 1) {
      add(null_list_, null_columns_, {id, phrase, CandidateKind::term}, count);
    };
    null_term("coriolis", "C");
    null_term("gravity", "G");
    null_term("pseudo_inverse", "M J^+ (u - Jdot qd), of the pseudo-inverse of J");
    if (!options.friction.empty()) null_term("friction_model", "the friction of the model");
    null_term("damping", "joint damping");
    const int positions = model.one_axis_joints() ? n : 0;
    if (positions > 0) null_term("posture", "a posture", n + 1);
    term("kinematic_damping", "projects joint damping by 1 - J* (J*)^+, which the tip feels",
         CandidateKind::mistake);
    if (positions > 0)
      term("kinematic_posture", "projects a posture by 1 - J* (J*)^+, which the tip feels",
           CandidateKind::mistake, n + 1);
  }
}

bool Candidates::possible(const Belief& belief) const {
  double mass = 0;
  for (const auto& link : model_.links) mass += link.mass;
  const double load = belief.payload[0];
  return load > -model_.links.back().mass && load < mass && belief.payload.tail<3>().norm() < 0.5 * mass &&
         belief.tip_offset.norm() < 0.5;
}

Vector Candidates::armature() const {
  Vector out = Vector::Zero(model_.velocities());
  Eigen::Index column = 0;
  for (const auto& link : model_.links) {
    out[column] = link.armature;
    column += velocity_count(link.type);
  }
  return out;
}

void Candidates::add(std::vector<Candidate>& list, int& columns, Candidate candidate, int count) const {
  candidate.first = columns;
  candidate.columns = count;
  columns += count;
  list.push_back(std::move(candidate));
}

Vector6 Candidates::command(const Point& at, const TipReference& reference, const Gains& gains,
                            bool feedforward) const {
  const PoseError error = pose_error(reference, {at.state.tip.R, at.state.tip.p}, at.state.tip.tip_velocity);
  if (error_law_ == ErrorLaw::angular_velocity) {
    Vector6 u = gains.damping.cwiseProduct(reference.velocity - at.state.tip.tip_velocity) +
                gains.stiffness.cwiseProduct(error.e);
    if (feedforward) u += reference.acceleration;
    return u;
  }
  const Vector6 edd = -gains.damping.cwiseProduct(error.ed) - gains.stiffness.cwiseProduct(error.e);
  TipReference moving = reference;
  if (!feedforward) moving.acceleration.setZero();
  return pose_command(moving, {at.state.tip.R, at.state.tip.p}, at.state.tip.tip_velocity, error, edd);
}

bool Candidates::look(const Chain<double>& chain, const Sample& sample, Point& at) const {
  at.state = dense::state(chain, positions(chain, std::span<const double>(sample.q)), sample.qd, {});
  at.M = dense::factor(at.state.joint.M);
  dense::Jacobian<double> J_Minv;
  dense::mobility(at.state.tip, at.state.joint, at.M, options_.rows, J_Minv, at.task);
  at.J_Minv = J_Minv(options_.rows, Eigen::all);
  at.Lambda = dense::factor(at.task.Omega);
  for (Eigen::Index i = 0; i < at.Lambda.D.size(); ++i)
    if (!(at.Lambda.D[i] > pivot_floor * at.task.Omega(i, i))) return false;
  if (from_reference_) {
    at.u = command(at, sample.reference, options_.gains.value_or(Gains{}), true);
  } else {
    at.u = sample.u;
    if (options_.acceleration == Acceleration::spatial) {
      const Vector6& V = at.state.tip.tip_velocity;
      at.u.tail<3>() += V.head<3>().cross(V.tail<3>());
    }
  }
  return true;
}

void Candidates::follow(Sample& sample) const {
  const auto tip =
      dense::state(model_, positions(model_, std::span<const double>(sample.q)), sample.qd, {}).tip;
  sample.quaternion = quaternion(tip.R);
  sample.reference = {{tip.R, tip.p}, tip.tip_velocity, sample.u};
  // Off by as much as loops are: 0.05 rad, 0.05 m, and as much per second.
  sample.reference.pose.p.array() += 0.05 * sample.u[3] / (1 + std::abs(sample.u[3]));
  sample.reference.velocity.array() += 0.05 * sample.u[0] / (1 + std::abs(sample.u[0]));
}

bool Candidates::exact(const Belief& belief, const Sample& sample, Vector& out) const {
  Point at;
  if (!look(believed(model_, belief), sample, at)) return false;
  const auto& [J, Jdot_qd, Omega, J_Minv_C, J_Minv_G] = at.task;
  out = at.pull(at.u(options_.rows) + J_Minv_C + J_Minv_G - Jdot_qd);  // (16)
  for (std::size_t i = 0; i < options_.friction.size(); ++i)
    out[static_cast<Eigen::Index>(i)] +=
        friction_torque(options_.friction[i], sample.qd[static_cast<Eigen::Index>(i)]);
  return true;
}

bool Candidates::evaluate(const Belief& belief, const Sample& sample, Columns& out, bool parameters) const {
  Point at;
  const Chain<double> chain = believed(model_, belief);
  if (!look(chain, sample, at) || !exact(belief, sample, out.exact)) return false;
  const auto& [J, Jdot_qd, Omega, J_Minv_C, J_Minv_G] = at.task;
  const Eigen::Index n = chain.velocities(), m = J.rows();
  const std::vector<int>& rows = options_.rows;
  const auto task = [&](const Vector6& x) { return Vector(x(rows)); };
  const Vector u = task(at.u);
  const Vector6& V = at.state.tip.tip_velocity;
  const Matrix3<double>& R = at.state.tip.R;
  const Matrix identity = Matrix::Identity(n, n);
  out.P = redundant_ ? Matrix(J.transpose() * solve(at.Lambda, at.J_Minv)) : identity;

  out.X.setZero(n, columns_);
  int column = 0;
  const auto put = [&](const Vector& x) { out.X.col(column++) = x; };
  put(-at.pull(Jdot_qd));
  put(at.pull(J_Minv_C));
  put(at.pull(J_Minv_G));
  Vector friction(n);
  if (!options_.friction.empty()) {
    for (Eigen::Index i = 0; i < n; ++i)
      friction[i] = friction_torque(options_.friction[static_cast<std::size_t>(i)], sample.qd[i]);
    put(at.felt(friction));
  }
  if (!from_reference_) {
    put(at.pull(u));
  } else {
    // u is affine in the gains: what one of them adds is what u loses without it.
    const auto part = [&](int half, bool stiffness, double gain_scale) {
      Gains all = options_.gains.value_or(Gains{}), without = all;
      Vector6& changed = stiffness ? without.stiffness : without.damping;
      for (int i = half; i < half + 3; ++i) changed[i] -= gain_scale == 0 ? changed[i] : gain_scale;
      return at.pull(task(at.u - command(at, sample.reference, without, true)));
    };
    if (options_.gains) {
      for (const bool stiffness : {true, false})
        for (const int half : {0, 3})
          if (any(rows, half)) put(part(half, stiffness, 0));
    } else {
      for (const int half : {0, 3})
        if (any(rows, half))
          for (const bool stiffness : {true, false}) put(part(half, stiffness, 1));
    }
    put(at.pull(task(at.u - command(at, sample.reference, options_.gains.value_or(Gains{}), false))));
  }
  if (any(rows, 0) && any(rows, 3)) {
    Matrix blocks = Omega;
    for (Eigen::Index i = 0; i < m; ++i)
      for (Eigen::Index j = 0; j < m; ++j)
        if ((rows[static_cast<std::size_t>(i)] < 3) != (rows[static_cast<std::size_t>(j)] < 3))
          blocks(i, j) = 0;
    put(J.transpose() * Vector(solve(dense::factor(blocks), u) - solve(at.Lambda, u)));
  }
  put(-at.pull(u));  // constant inertia: the share of Lambda that is gone
  for (Eigen::Index i = 0; i < m; ++i) put(J.row(i).transpose() * u[i]);
  // u given otherwise: by its difference.
  const auto instead = [&](const Vector6& wrong) { put(at.pull(task(wrong - at.u))); };
  const auto turned = [&](const Matrix3<double>& by) {
    Vector6 out_u = at.u;
    if (turns_) out_u.head<3>() = by * at.u.head<3>();
    if (slides_) out_u.tail<3>() = by * at.u.tail<3>();
    return out_u;
  };
  for (const Candidate& c : list_) {
    if (c.first < column) continue;
    if (c.id == "swapped_rows") instead(swapped(at.u));
    if (c.id == "u_in_tip_frame") instead(turned(R));
    if (c.id == "u_turned_to_tip") instead(turned(R.transpose()));
    if (c.id == "spatial_acceleration") {
      Vector6 carried = Vector6::Zero();
      carried.tail<3>() = V.head<3>().cross(V.tail<3>());
      put(at.pull(task(carried)));
    }
    if (c.id == "quaternion_reference" || c.id == "quaternion_both") {
      TipReference wrong = sample.reference;
      wrong.pose.R = rotation_of(misread(sample.quaternion));
      if (c.id == "quaternion_reference") {
        instead(command(at, wrong, options_.gains.value_or(Gains{}), true));
      } else {
        Point misled = at;
        misled.state.tip.R = rotation_of(misread(quaternion(R, sample.quaternion)));
        instead(command(misled, wrong, options_.gains.value_or(Gains{}), true));
      }
    }
    const auto slope = [&](auto change) {
      Belief other = belief;
      if (other.armature.size() == 0) other.armature.setZero(n);
      change(other);
      Vector there;
      if (parameters && exact(other, sample, there)) {
        put(out.P * (there - out.exact) / step);
      } else {
        put(Vector::Zero(n));
      }
    };
    if (c.id == "armature")
      for (Eigen::Index i = 0; i < n; ++i) slope([&](Belief& b) { b.armature[i] += step; });
    if (c.id == "payload")
      for (Eigen::Index i = 0; i < 4; ++i) slope([&](Belief& b) { b.payload[i] += step; });
    if (c.id == "tip_point")
      for (Eigen::Index i = 0; i < 3; ++i) slope([&](Belief& b) { b.tip_offset[i] += step; });
    if (c.id == "viscous")
      for (Eigen::Index i = 0; i < n; ++i) put(out.P.col(i) * sample.qd[i]);
    if (c.id == "coulomb")
      for (Eigen::Index i = 0; i < n; ++i) put(out.P.col(i) * std::tanh(sample.qd[i] / coulomb_speed));
    if (c.id == "torque_scale")
      for (Eigen::Index i = 0; i < n; ++i) put(out.P.col(i) * out.exact[i]);
    if (c.id == "gravity_vector")
      for (int i = 0; i < 3; ++i) {  // G is linear in gravity
        Chain<double> other = chain;
        other.gravity = Vector3<double>::Unit(i);
        const auto joints = positions(other, std::span<const double>(sample.q));
        put(at.felt(dense::state(other, joints, sample.qd, {}).joint.G));
      }
  }
  if (!redundant_) return true;

  // J^+ = J* (J J*)^-1; 1 - J* (J*)^+ is the projector without the mass matrix.
  const auto JJt = dense::factor(Matrix(J * J.transpose()));
  const Matrix kinematic = identity - J.transpose() * solve(JJt, J);
  const Vector q =
      model_.one_axis_joints()
          ? Vector(Eigen::Map<const Vector>(sample.q.data(), static_cast<Eigen::Index>(sample.q.size())))
          : Vector();
  const Matrix leak = out.P * kinematic;
  put(-leak * sample.qd);
  if (q.size() == n) {
    put(-leak * q);
    for (Eigen::Index i = 0; i < n; ++i) put(leak.col(i));
  }
  const Matrix N = identity - out.P;
  out.null.resize(n, null_columns_);
  int null_column = 0;
  const auto put_null = [&](const Vector& x) { out.null.col(null_column++) = N * x; };
  put_null(at.state.joint.C);
  put_null(at.state.joint.G);
  put_null(at.state.joint.M * (J.transpose() * solve(JJt, Vector(u - Jdot_qd))));
  if (!options_.friction.empty()) put_null(friction);
  put_null(-sample.qd);
  if (q.size() == n) {
    put_null(-q);
    out.null.rightCols(n) = N;
  }
  return true;
}

}  // namespace osculate
