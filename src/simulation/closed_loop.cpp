#include "simulation/closed_loop.hpp"

#include <tuple>

#include "simulation/integrator.hpp"

namespace osculate {

namespace {

using Reason = IntegrationStopped::Reason;

template <class Space>
Vector6 to_vector6(const Vec<Space, double>& v) {
  Vector6 out;
  for (int i = 0; i < 6; ++i) out[i] = component(v, i);
  return out;
}

Vec<Force, double> to_force(const Vector6& v) { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }

// A measure this many times above the threshold is taken from the law's last evaluation, which is near
// enough.
constexpr double far_from_singular = 1e3;

// The force of a sample depends, by extrapolation, on velocities of the two samples before it, and the next
// sample uses the forces of the last two: no sample before the last four matters to it.
constexpr std::size_t samples_that_matter = 4;

// Whether a plant can take over placement and sweep 1 from the controller's sweeps; else it takes over
// cosines and sines alone.
template <class PlantDynamics, class Space>
constexpr bool can_follow = requires(PlantDynamics& plant, const Space& space) {
  plant.follow(space);
};

/// Places and moves the plant where the controller's sweeps have been.
template <class PlantDynamics, class Space>
void follow_sweeps(PlantDynamics& dynamics, const Space& space,
                   const std::vector<JointPosition<double>>& joints, std::span<const double> qd) {
  if constexpr (can_follow<PlantDynamics, Space>) {
    dynamics.follow(space);
  } else {
    dynamics.place(joints);
    dynamics.move(qd);
  }
}

}  // namespace

ClosedLoop::ClosedLoop(Controller controller, Plant plant)
    : controller_(std::move(controller)),
      plant_(std::move(plant)),
      plant_dynamics_(plant_.dense                     ? Dynamics(std::in_place_index<2>, plant_.chain)
                      : plant_.chain.one_axis_joints() ? Dynamics(std::in_place_index<0>, plant_.chain)
                                                       : Dynamics(std::in_place_index<1>, plant_.chain)),
      positions_(plant_.chain.positions()),
      velocities_(plant_.chain.velocities()),
      one_axis_joints_(plant_.chain.one_axis_joints()),
      shares_kinematics_(plant_.share_kinematics && same_arm_and_state()),
      joints_(plant_.chain.links.size()),
      net_torque_(static_cast<std::size_t>(velocities_)),
      computed_(net_torque_.size()),
      held_(net_torque_.size()),
      derivative_(states()) {
  seen_.q.resize(static_cast<std::size_t>(positions_));
  for (auto* v : {&seen_.qd, &seen_.qdd, &seen_.torque}) v->resize(net_torque_.size());
}

template <class PlantDynamics>
void ClosedLoop::feel(const PlantDynamics& dynamics) {
  seen_.tip_force = plant_.tip_force;
  if (!plant_.environment) return;
  const auto& p = dynamics.tip_position();
  const auto v = dynamics.tip_velocity().lin;
  seen_.touch = touch(*plant_.environment, {p.x, p.y, p.z}, {v.x, v.y, v.z}, modes_.contact);
  seen_.tip_force += seen_.touch.wrench;
}

void ClosedLoop::move(double t, const double* y) {
  set_positions(plant_.chain, q(y), joints_);
  std::visit(
      [&](auto& dynamics) {
        if (controller_.options().base_path) dynamics.move_base(base(t));
        dynamics.place(joints_);
        dynamics.move(qd(y));
        feel(dynamics);
      },
      plant_dynamics_);
}

bool ClosedLoop::same_arm_and_state() const {
  const LawOptions& law = controller_.options();
  const bool swept = law.law == Law::operational_space || law.law == Law::textbook || law.law == Law::user;
  const bool feels_first = plant_.environment && law.know_tip_force;
  return swept && !sampled() && !law.base_path && !feels_first && !plant_.dense &&
         plant_.chain.one_axis_joints() && plant_.chain == controller_.model();
}

void ClosedLoop::follow(const double* y) {
  auto& dynamics = std::get<0>(plant_dynamics_);
  follow_sweeps(dynamics, *controller_.exact_sweeps(), controller_.joints(), qd(y));
  feel(dynamics);
}

void ClosedLoop::control(double t, const double* y) {
  const auto at = [t] { return " (t = " + std::to_string(t) + " s)"; };
  try {
    controller_.torque(t, q(y), qd(y), seen_.torque, seen_.tip_force);
  } catch (const SingularArm& error) {
    throw IntegrationStopped(Reason::singular, error.what());
  } catch (const UserLawFailed& error) {
    throw IntegrationStopped(Reason::law, error.what());
  } catch (const RepresentationSingular& error) {
    throw IntegrationStopped(Reason::singular, error.what() + at());
  } catch (const std::domain_error& error) { throw IntegrationStopped(Reason::failed, error.what() + at()); }
}

void ClosedLoop::sample(double t, std::span<const double> y) {
  if (controller_.options().sampling->delay != Delay::none) {
    if (taken_.size() == samples_that_matter) taken_.erase(taken_.begin());
    taken_.push_back({t, modes_, controller_.sensed(), {y.begin(), y.end()}});
  }
  move(t, y.data());
  control(t, y.data());
  computed_ = seen_.torque;
  const SingularityOptions& singularity = controller_.options().singularity;
  const double measure = controller_.last_measure();
  if (singularity.policy == SingularPolicy::none && measure >= 0 && measure < singularity.threshold)
    throw IntegrationStopped(Reason::singular, controller_.singular_message(
                                                   t, controller_.compliance(t, q(y.data()), qd(y.data()))));
}

void ClosedLoop::remember(Memory& memory) {
  std::vector<Sample> samples = taken_;
  memory(samples);
  if (memory.reading()) {
    taken_.clear();
    for (const Sample& past : samples) {
      set_modes(past.modes);
      controller_.set_sensed(past.sensed);
      sample(past.t, past.y);
    }
  }
  memory(modes_, computed_, held_, controller_);
  set_modes(modes_);
}

void ClosedLoop::right_side(double t, const double* y, double* yd) { evaluate(t, y, yd, false); }

void ClosedLoop::evaluate(double t, const double* y, double* yd, bool look) {
  const auto np = static_cast<std::size_t>(positions_), nv = static_cast<std::size_t>(velocities_);
  const bool acts = !sampled() && (look || controller_.options().law != Law::free);
  if (shares_kinematics_) {
    seen_.tip_force = plant_.tip_force;  // all that the law may know
    control(t, y);
    follow(y);
  } else {
    move(t, y);
    if (acts) control(t, y);
  }
  const std::span<const double> rates = qd(y), torque{sampled() ? held_ : seen_.torque};

  // The plant's friction is computed here even where the law has just compensated the same: nothing that the
  // claims compare comes from the other side.
  double power = 0, loss = 0;  // W
  const bool rubs = !plant_.friction.empty();
  for (std::size_t i = 0; i < nv; ++i) {
    const double friction = rubs ? friction_torque(plant_.friction[i], rates[i]) : 0.0;
    net_torque_[i] = torque[i] - seeded(Fault::plant_friction, friction);
    power += torque[i] * rates[i];
    loss += friction * rates[i];
  }
  const Vec<Force, double> push = to_force(seen_.tip_force);
  const Vec<Force, double> constant_push = to_force(plant_.tip_force);
  std::visit(
      [&](auto& dynamics) {
        dynamics.accelerations(net_torque_, seeded(Fault::plant_wrench, push), {yd + np, nv});
        yd[np + nv + 2] = dot(constant_push, dynamics.tip_velocity());
        // The surface stores energy and loses it; neither is counted through the wrench that it gives.
        const auto v = dynamics.tip_velocity().lin;
        if (plant_.environment)
          loss += lost_power(*plant_.environment, seen_.touch, {v.x, v.y, v.z}, modes_.contact);
      },
      plant_dynamics_);
  if (one_axis_joints_)
    std::copy(rates.begin(), rates.end(), yd);
  else
    position_rates(plant_.chain, q(y), rates, {yd, np});
  yd[np + nv] = seeded(Fault::work, power);
  yd[np + nv + 1] = loss;
}

bool ClosedLoop::watches_singularity() const {
  const LawOptions& law = controller_.options();
  const bool truncates = law.singularity.policy == SingularPolicy::truncated;
  return law.law != Law::free && !sampled() && (truncates || law.singularity.policy == SingularPolicy::none);
}

int ClosedLoop::event_count() const {
  const LawOptions& law = controller_.options();
  int count = static_cast<int>(law.obstacles.size()) + (plant_.environment ? 2 : 0);
  if (watches_singularity())
    count += law.singularity.policy == SingularPolicy::none ? 1 : static_cast<int>(law.rows.size());
  return count;
}

void ClosedLoop::events(double t, const double* y, double* g) {
  const LawOptions& law = controller_.options();
  if (plant_.environment || !law.obstacles.empty()) move(t, y);
  if (plant_.environment) {
    *g++ = seen_.touch.gap;
    *g++ = seen_.touch.pressure;
  }
  std::visit(
      [&](const auto& dynamics) {
        for (const Obstacle& obstacle : law.obstacles) {
          const auto& p = dynamics.tip_position();
          *g++ = distance(obstacle, {p.x, p.y, p.z}) - obstacle.influence;
        }
      },
      plant_dynamics_);
  if (!watches_singularity()) return;
  const double threshold = law.singularity.threshold;
  if (law.singularity.policy == SingularPolicy::none) {
    double measure = controller_.last_measure();
    if (measure < far_from_singular * threshold)
      measure = smooth_measure(controller_.compliance(t, q(y), qd(y)), law.rows);
    *g = measure - threshold;
    return;
  }
  const SingularTask task(law.singularity, controller_.compliance(t, q(y), qd(y)), law.rows);
  for (std::size_t i = 0; i < law.rows.size(); ++i) *g++ = task.eigenvalues()[i] - threshold;
}

bool ClosedLoop::switch_modes(double t, std::span<const double> y) {
  Modes next;
  move(t, y.data());
  next.contact = plant_.environment && touches(seen_.touch);
  const LawOptions& law = controller_.options();
  if (watches_singularity()) {
    const Compliance<double>& Omega = controller_.compliance(t, q(y.data()), qd(y.data()));
    const double threshold = law.singularity.threshold;
    if (law.singularity.policy == SingularPolicy::none) {
      // An event is located to rounding, on either side of the threshold.
      if (smooth_measure(Omega, law.rows) <= threshold * (1 + 1e-6))
        throw IntegrationStopped(Reason::singular, controller_.singular_message(t, Omega));
    } else {
      const SingularTask task(law.singularity, Omega, law.rows);
      while (next.truncated < static_cast<int>(law.rows.size()) &&
             task.eigenvalues()[static_cast<std::size_t>(next.truncated)] < threshold)
        ++next.truncated;
    }
  }
  const bool changed = !(next == modes_);
  set_modes(next);
  return changed;
}

void ClosedLoop::set_modes(const Modes& modes) {
  modes_ = modes;
  controller_.set_truncated(modes.truncated);
}

bool ClosedLoop::plant_is_model() const {
  const LawOptions& law = controller_.options();
  const bool pushed = plant_.environment || !plant_.tip_force.isZero(0);
  if (!(plant_.chain == controller_.model()) || (pushed && !law.know_tip_force)) return false;
  const std::vector<JointFriction> none(net_torque_.size());
  const auto or_none = [&none](const std::vector<JointFriction>& f) { return f.empty() ? none : f; };
  return or_none(plant_.friction) == (law.compensate_friction ? or_none(controller_.friction()) : none);
}

Vector6 ClosedLoop::plant_tip_velocity() const {
  return std::visit([](const auto& dynamics) { return to_vector6(dynamics.tip_velocity()); },
                    plant_dynamics_);
}

std::pair<double, double> ClosedLoop::energies(std::span<const double> qd) const {
  auto [kinetic, potential] = std::visit(
      [&](const auto& dynamics) {
        return std::pair(dynamics.kinetic_energy(qd), dynamics.potential_energy());
      },
      plant_dynamics_);
  if (plant_.environment) potential += stored_energy(*plant_.environment, seen_.touch, modes_.contact);
  return {kinetic, potential};
}

Whereabouts ClosedLoop::locate(double t, std::span<const double> y) {
  const double* const energy = y.data() + positions_ + velocities_;
  Whereabouts out{.q = q(y.data()), .tip = controller_.tip_motion(t, q(y.data()), qd(y.data()))};
  if (shares_kinematics_)
    follow(y.data());
  else
    move(t, y.data());
  std::tie(out.kinetic, out.potential) = energies(qd(y.data()));
  out.work = energy[0];
  out.dissipated = energy[1];
  out.external_work = energy[2];
  return out;
}

const Observation& ClosedLoop::observe(double t, std::span<const double> y) {
  const auto np = static_cast<std::size_t>(positions_), nv = static_cast<std::size_t>(velocities_);
  seen_.t = t;
  std::copy_n(y.begin(), np, seen_.q.begin());
  std::copy_n(y.begin() + positions_, nv, seen_.qd.begin());
  evaluate(t, y.data(), derivative_.data(), true);
  std::copy_n(derivative_.begin() + positions_, nv, seen_.qdd.begin());
  if (sampled()) seen_.torque = held_;
  seen_.command = sampled() ? controller_.look(t, seen_.q, seen_.qd) : controller_.last();
  std::visit([&](const auto& dynamics) { seen_.tip_acceleration = to_vector6(dynamics.tip_acceleration()); },
             plant_dynamics_);
  std::tie(seen_.kinetic, seen_.potential) = energies(seen_.qd);
  seen_.work = y[np + nv];
  seen_.dissipated = y[np + nv + 1];
  seen_.external_work = y[np + nv + 2];
  return seen_;
}

}  // namespace osculate
