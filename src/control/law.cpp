#include "control/law.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "control/task_inverse.hpp"

namespace osculate {

namespace {

// A pivot of L D L^T below this fraction of its diagonal entry has lost all but a few bits: rank loss in
// double.
constexpr double pivot_floor = 1e-13;

template <class Space>
void set(Vector6& out, const Vec<Space, double>& v) {
  out[0] = v.ang.x, out[1] = v.ang.y, out[2] = v.ang.z;
  out[3] = v.lin.x, out[4] = v.lin.y, out[5] = v.lin.z;
}

template <class Sweeps>
void set_tip(Pose& out, const Sweeps& sweeps) {
  const auto [x, y, z] = rows_of(sweeps.tip_rotation());
  out.R(0, 0) = x.x, out.R(0, 1) = x.y, out.R(0, 2) = x.z;
  out.R(1, 0) = y.x, out.R(1, 1) = y.y, out.R(1, 2) = y.z;
  out.R(2, 0) = z.x, out.R(2, 1) = z.y, out.R(2, 2) = z.z;
  const auto& p = sweeps.tip_position();
  out.p[0] = p.x, out.p[1] = p.y, out.p[2] = p.z;
}

constexpr const char* row_names[] = {"wx", "wy", "wz", "vx", "vy", "vz"};

std::string singular_text(double t, const std::string& which) {
  return "the arm is singular at t = " + std::to_string(t) + " s: " + which;
}
[[noreturn]] void singular(double t, const std::string& which) { throw SingularArm(singular_text(t, which)); }

/// One of the two alternatives: joints with one axis, or of any kind.
template <class Variant>
Variant for_chain(const Chain<double>& chain) {
  if (chain.one_axis_joints()) return Variant(std::in_place_index<0>, chain);
  return Variant(std::in_place_index<1>, chain);
}

}  // namespace

std::optional<CoordinateChart> chart_of(OrientationCoordinates orientation, PositionCoordinates position) {
  const bool turns = orientation != OrientationCoordinates::rotation_vector;
  const bool slides = position != PositionCoordinates::cartesian;
  if (!turns && !slides) return std::nullopt;
  return CoordinateChart(turns ? std::optional(orientation) : std::nullopt,
                         slides ? std::optional(position) : std::nullopt);
}

BaseMotion<double> base_motion(const Path* path, double t) {
  if (!path) return {};
  const TipReference at = tip_reference(*path, {}, t);
  return {at.pose.R, at.pose.p, at.velocity, at.acceleration};
}

Controller::Controller(const Chain<double>& model, std::vector<JointFriction> friction,
                       const LawOptions& options, std::shared_ptr<const Path> path, const Pose& initial)
    : model_(model),
      friction_(std::move(friction)),
      options_(options),
      path_(std::move(path)),
      initial_(initial),
      chart_(chart_of(options.orientation, options.position)),
      space_(for_chain<Space>(model)),
      has_null_space_(!options.null_space.empty()),
      joints_(model.links.size()),
      T0_(static_cast<std::size_t>(model.velocities()), 0.0),
      rigid_torque_(static_cast<std::size_t>(model.velocities()), 0.0),
      known_q_(static_cast<std::size_t>(model.positions())),
      known_qd_(static_cast<std::size_t>(model.velocities())) {
  if (options_.law == Law::resolved_acceleration)
    resolved_ = for_chain<Resolved>(model);
  else if (options_.law == Law::operational_space && options_.sampling)
    sampled_ = for_chain<SampledSpace>(model);
  else if (options_.law == Law::user)
    user_ = UserLaw(options_.user);
}

void Controller::begin(double t, std::span<const double> q, std::span<const double> qd) {
  set_positions(model_, q, joints_);
  if (options_.base_path) base_ = base_motion(options_.base_path.get(), t);
  if (options_.law == Law::resolved_acceleration) return;  // a square task has no null space
  if (has_null_space_) osculate::null_space_torque(options_.null_space, model_, options_.rows, q, qd, T0_);
}

template <class Sweeps>
void Controller::see_tip(const Sweeps& sweeps, double t) {
  set_tip(command_.tip, sweeps);
  set(command_.tip_velocity, sweeps.tip_velocity());
  tip_reference(*path_, initial_, t, command_.reference);
  if (options_.feedforward) {
    tracking_.look(command_.reference, command_.tip, command_.tip_velocity);
  } else {
    const TipReference at_rest{.pose = command_.reference.pose};
    tracking_.look(at_rest, command_.tip, command_.tip_velocity);
  }
  command_.error = tracking_.error();
}

std::string Controller::singular_message(double t, const Compliance<double>& Omega) const {
  const SingularTask task(options_.singularity, Omega, options_.rows);
  char size[32];
  std::snprintf(size, sizeof size, "%.2e", task.eigenvalues()[0]);
  const int row = options_.rows[static_cast<std::size_t>(task.weakest_row())];
  return singular_text(t, std::string("it is about to lose task row ") + row_names[row] +
                              ", smallest scaled eigenvalue of Omega " + size +
                              "; controller.singularity.policy can be damped, truncated or released");
}

Vec<Force, double> Controller::tip_force(const Compliance<double>& Omega,
                                         const Vec<Motion, double>& right_side, double t) {
  const SingularityOptions& singularity = options_.singularity;
  const TaskRows& rows = options_.rows;
  Vector6 all;
  set(all, right_side);
  TaskVector<double> right{};
  for (std::size_t i = 0; i < rows.size(); ++i)
    right[i] = all[rows[i]] + seeded(Fault::law_command, command_.u[rows[i]]);
  // The wrench with these components on the task rows and none elsewhere.
  const auto as_wrench = [this, &rows](const TaskVector<double>& F) -> Vec<Force, double> {
    Vector6& f = command_.F;
    f.setZero();
    for (std::size_t i = 0; i < rows.size(); ++i) f[rows[i]] = F[i];
    if (faulty(Fault::law_rows) && rows.size() > 1) std::swap(f[rows[rows.size() - 2]], f[rows.back()]);
    return {{f[0], f[1], f[2]}, {f[3], f[4], f[5]}};
  };

  const TaskInverse inverse(Omega, rows);
  measure_ = inverse.measure();  // at most the smallest eigenvalue
  command_.filtered = false;
  if (singularity.policy != SingularPolicy::none && measure_ < singularity.threshold) {
    const SingularTask task(singularity, Omega, rows, truncated_);
    command_.filtered = task.active();
    if (task.active()) return as_wrench(task.solve(right));
  }
  if (const int lost = inverse.lost(pivot_floor); lost >= 0)
    singular(t, std::string("task row ") + row_names[rows[static_cast<std::size_t>(lost)]] +
                    " depends on the rows before it");
  return as_wrench(inverse.solve(right));  // (4): one solve on u + right side
}

void Controller::operational_space(double t, std::span<const double> qd) {
  if (!options_.sampling) {
    std::visit(
        [&](auto& space) {
          const long before = space.sweeps();
          space.place(joints_);
          space.sweep(qd, T0_, known_push_);  // sweeps 1, 2, 3
          swept_alone_ = !has_null_space_ && !options_.know_tip_force;
          see_tip(space, t);
          decide();
          const Vec<Force, double> F_c = tip_force(space.Omega(), space.right_side(), t);
          space.torques(F_c, rigid_torque_);  // sweep 4
          sweeps_ = space.sweeps() - before;
        },
        space_);
    return;
  }
  const Sampling& sampling = *options_.sampling;
  std::visit(
      [&](auto& space) {
        const long before = space.sweeps();
        if (options_.base_path) space.move_base(base_);
        space.place(joints_);
        space.begin_sample(sampling.delay, sampling.extrapolate, qd, T0_, known_push_);
        see_tip(space, t);
        decide();
        const Vec<Force, double> F_c = tip_force(space.Omega(), space.right_side(), t);
        space.finish_sample(sampling.extrapolate, F_c, rigid_torque_);
        sweeps_ = space.sweeps() - before;
      },
      *sampled_);
}

void Controller::resolved_acceleration(double t, std::span<const double> qd) {
  std::visit(
      [&](auto& resolved) {
        const long before = resolved.sweeps();
        if (options_.base_path) resolved.move_base(base_);
        resolved.place(joints_);
        resolved.sweep(qd);
        see_tip(resolved, t);
        decide();
        TaskVector<double> u{};
        for (std::size_t i = 0; i < options_.rows.size(); ++i)
          u[i] = seeded(Fault::law_command, command_.u[options_.rows[i]]);
        if (!resolved.torques(u, options_.rows, known_push_, pivot_floor, rigid_torque_))
          singular(t, "the Jacobian of the task rows has no inverse");
        sweeps_ = resolved.sweeps() - before;
      },
      *resolved_);
  command_.F.setConstant(std::numeric_limits<double>::quiet_NaN());  // no F_c is formed
}

void Controller::textbook(double t, std::span<const double> qd) {
  sweep_exactly(qd);  // for the tip, and to be compared
  std::visit([&](auto& space) { see_tip(space, t); }, space_);
  decide();
  std::array<double, 6> u{};
  for (std::size_t i = 0; i < options_.rows.size(); ++i) u[i] = command_.u[options_.rows[i]];
  if (!textbook_torque(options_.textbook, model_, joints_, base_, qd, options_.rows,
                       {u.data(), options_.rows.size()}, T0_, known_push_, options_.constant_inertia,
                       rigid_torque_))
    singular(t, "the task rows depend on each other");
  command_.F.setConstant(std::numeric_limits<double>::quiet_NaN());
}

const Compliance<double>& Controller::compliance(double t, std::span<const double> q,
                                                 std::span<const double> qd) {
  set_positions(model_, q, joints_);
  if (options_.base_path) base_ = base_motion(options_.base_path.get(), t);
  sweep_exactly(qd);
  return std::visit([](const auto& space) -> const Compliance<double>& { return space.Omega(); }, space_);
}

void Controller::place_exactly() {
  std::visit(
      [&](auto& space) {
        if (options_.base_path) space.move_base(base_);
        space.place(joints_);
      },
      space_);
}

void Controller::sweep_exactly(std::span<const double> qd) {
  place_exactly();
  std::visit([&](auto& space) { space.sweep(qd); }, space_);
  swept_alone_ = true;
}

TipMotion Controller::tip_motion(double t, std::span<const double> q, std::span<const double> qd) {
  set_positions(model_, q, joints_);
  if (options_.base_path) base_ = base_motion(options_.base_path.get(), t);
  place_exactly();
  TipMotion out;
  std::visit(
      [&](auto& space) {
        space.sweep_tip_velocity(qd);
        set_tip(out.pose, space);
        set(out.velocity, space.tip_velocity());
      },
      space_);
  return out;
}

const Command& Controller::torque(double t, std::span<const double> q_true, std::span<const double> qd_true,
                                  std::span<double> T, const Vector6& tip_force) {
  sense(q_true, qd_true);
  const std::span<const double> q{known_q_}, qd{known_qd_};
  if (options_.know_tip_force) {
    known_tip_force_ = tip_force;
    for (int i = 0; i < 6; ++i) set_component(known_push_, i, tip_force[i]);
  }
  measure_ = -1;
  begin(t, q, qd);
  if (options_.base_path && !options_.sampling)
    std::visit([&](auto& space) { space.move_base(base_); }, space_);
  switch (options_.law) {
    case Law::operational_space:
      operational_space(t, qd);
      break;
    case Law::resolved_acceleration:
      resolved_acceleration(t, qd);
      break;
    case Law::textbook:
      textbook(t, qd);
      break;
    case Law::user:
      sweep_exactly(qd);
      std::visit([&](auto& space) { see_tip(space, t); }, space_);
      decide();
      user(t, qd);
      break;
    case Law::free:
      sweep_exactly(qd);
      std::visit([&](auto& space) { see_tip(space, t); }, space_);
      std::fill(T.begin(), T.end(), 0.0);
      return command_;
  }
  if (options_.sampling && options_.law == Law::resolved_acceleration) {
    monitored_ = samples_ % options_.sampling->monitor_every == 0;
    if (monitored_) {
      sweep_exactly(qd);
      std::visit([&](auto& space) { terms_of(space, qd, seen_by_monitor_); }, space_);
    }
  }
  ++samples_;
  for (std::size_t i = 0; i < T.size(); ++i) {
    T[i] = rigid_torque_[i];
    if (options_.compensate_friction && !friction_.empty())
      T[i] += seeded(Fault::friction_compensation, friction_torque(friction_[i], qd[i]));
  }
  command_.saturated = false;
  for (std::size_t i = 0; i < options_.effort_limit.size(); ++i) {
    const double limit = options_.effort_limit[i];
    command_.saturated = command_.saturated || std::abs(T[i]) > limit;
    T[i] = std::clamp(T[i], -limit, limit);
  }
  return command_;
}

const Command& Controller::look(double t, std::span<const double> q, std::span<const double> qd) {
  begin(t, q, qd);
  sweep_exactly(qd);
  std::visit([&](auto& space) { see_tip(space, t); }, space_);
  return command_;
}

template <class Sweeps>
void Controller::terms_of(Sweeps& space, std::span<const double> qd, RecursiveTerms& out) const {
  const auto m = static_cast<Eigen::Index>(options_.rows.size());
  const Compliance<double> all = space.Omega();
  out.Omega.resize(6, 6);
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j)
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) out.Omega(i, j) = component(all, i, j);
  const TaskInverse Omega(all, options_.rows);
  const bool exist = Omega.lost(pivot_floor) < 0;
  out.Lambda.resize(exist ? m : 0, exist ? m : 0);
  for (UpTo6* v : {&out.c, &out.g, &out.c_plus_g}) v->resize(exist ? m : 0);
  if (!exist) return;
  const auto solve = [&](const TaskVector<double>& right, double* to) {
    const TaskVector<double> x = Omega.solve(right);
    std::copy_n(x.data(), m, to);
  };
  for (Eigen::Index j = 0; j < m; ++j) {
    TaskVector<double> unit{};
    unit[static_cast<std::size_t>(j)] = 1;
    solve(unit, out.Lambda.data() + j * m);
  }
  if (!swept_alone_) space.sweep(qd);
  solve(restricted(space.right_side(), options_.rows), out.c_plus_g.data());
  solve(restricted(space.right_side_of_g(), options_.rows), out.g.data());
  solve(restricted(space.right_side_of_c(qd), options_.rows), out.c.data());
}

const RecursiveTerms& Controller::terms(std::span<const double> qd) {
  if (options_.law == Law::resolved_acceleration) {
    if (options_.sampling && options_.sampling->monitor_every > 1) return seen_by_monitor_;
    sweep_exactly(qd);
  }
  std::visit([&](auto& space) { terms_of(space, qd, terms_); }, space_);
  swept_alone_ = false;  // space_ holds the right side of c
  return terms_;
}

Pose tip_pose(const Chain<double>& chain, std::span<const double> q) { return tip_pose(chain, q, {}); }

Pose tip_pose(const Chain<double>& chain, std::span<const double> q, const BaseMotion<double>& base) {
  auto space =
      for_chain<std::variant<BasicOperationalSpace<Hinge<double>>, BasicOperationalSpace<Joint<double>>>>(
          chain);
  return std::visit(
      [&](auto& sweeps) {
        sweeps.move_base(base);
        sweeps.place(positions(chain, q));
        Pose tip;
        set_tip(tip, sweeps);
        return tip;
      },
      space);
}

}  // namespace osculate
