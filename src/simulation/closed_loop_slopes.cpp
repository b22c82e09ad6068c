#include "simulation/closed_loop_slopes.hpp"

#include <cmath>

#include "control/command_slope.hpp"
#include "recursion/operational_space.hpp"
#include "scalar/dual.hpp"
#include "scalar/packet.hpp"

namespace osculate {

namespace {

// A value, the same in every lane, and its derivatives along four coordinates.
constexpr int lanes = 4;
using S = Dual<Packet<lanes>>;

double value(const S& x) { return x.value[0]; }
Vector3<double> value(const Vec3<S>& v) { return {value(v.x), value(v.y), value(v.z)}; }
Vector3<double> slope(const Vec3<S>& v, int lane) {
  return {v.x.derivative[lane], v.y.derivative[lane], v.z.derivative[lane]};
}
template <class Space>
Vector6 slope(const Vec<Space, S>& v, int lane) {
  Vector6 out;
  out << slope(v.ang, lane), slope(v.lin, lane);
  return out;
}
S constant(double x) { return {x, 0.0}; }
/// f(x) for a function that has this value and slope at x.
S chained(double f, double slope, const S& x) { return {f, Packet<lanes>(slope) * x.derivative}; }

/// rho of R' = rho~ R.
Vec3<S> turn(const Mat3<S>& R) {
  const auto product = [](const Vec3<S>& a, const Vec3<S>& b) {  // a' . b
    return S(0.0, a.x.derivative * b.x.value + a.y.derivative * b.y.value + a.z.derivative * b.z.value);
  };
  return {product(R.z, R.y), product(R.x, R.z), product(R.y, R.x)};
}

S friction_torque(const JointFriction& f, const S& qd) {
  const double v = value(qd), step = std::tanh(v / f.v_s);
  const double coulomb = v > 0 ? f.coulomb_positive : f.coulomb_negative;
  return chained(f.viscous * v + coulomb * step, f.viscous + coulomb / f.v_s * (1 - step * step), qd);
}

Vec<Force, S> as_force(const Vector6& v) {
  const auto part = [&v](int i) { return Vec3<S>{constant(v[i]), constant(v[i + 1]), constant(v[i + 2])}; };
  return {part(0), part(3)};
}

}  // namespace

/// For constants that all lanes share.
static double first_lane(const S& x) { return value(x); }

bool ClosedLoopSlopes::exist(const ClosedLoop& loop) {
  const Plant& plant = loop.plant();
  const LawOptions& law = loop.controller().options();
  const bool swept =
      !plant.dense && plant.chain.one_axis_joints() && loop.controller().model().one_axis_joints();
  if (law.law == Law::free) return swept;
  return swept && law.law == Law::operational_space && !law.sampling && CommandSlope::exists(law) &&
         law.singularity.policy == SingularPolicy::none && !law.null_space.limits &&
         law.null_space.manipulability == 0;
}

struct ClosedLoopSlopes::Work {
  ClosedLoop& loop;
  std::size_t n;
  bool acts;
  OperationalSpace<S> space;
  ForwardDynamics<S> plant;
  std::vector<JointPosition<double>> joints;
  std::vector<JointPosition<S>> places;
  std::vector<S> q, qd, T0, T, net, qdd;
  std::vector<double> yd;

  explicit Work(ClosedLoop& given)
      : loop(given),
        n(static_cast<std::size_t>(loop.velocities())),
        acts(loop.controller().options().law != Law::free),
        space(cast<S>(loop.controller().model())),
        plant(cast<S>(loop.plant().chain)),
        joints(n),
        places(n),
        q(n),
        qd(n),
        T0(n),
        T(n),
        net(n),
        qdd(n),
        yd(loop.states()) {}

  void begin(double t, const double* y);
  void start(const double* y, std::size_t first);
  Vec<Force, S> feel(S& loss);
  void control(const CommandSlope& law, const Vec<Force, S>& push);
  void write(std::size_t first, const S& work, const S& loss, const S& external, double* columns) const;
};

void ClosedLoopSlopes::Work::begin(double t, const double* y) {
  set_positions(loop.plant().chain, loop.q(y), joints);
  if (acts) loop.right_side(t, y, yd.data());
  const LawOptions& law = loop.controller().options();
  if (!law.base_path) return;
  const BaseMotion<double> base = loop.base(t);
  const BaseMotion<S> fixed = {base.R.cast<S>(), base.p.cast<S>(), base.velocity.cast<S>(),
                               base.acceleration.cast<S>()};
  space.move_base(fixed);
  plant.move_base(fixed);
}

/// The state, with the derivative of coordinate first + l of (q, qd) in lane l.
void ClosedLoopSlopes::Work::start(const double* y, std::size_t first) {
  const auto coordinate = [&](std::size_t i) {
    S x = constant(y[i]);
    if (i >= first && i < first + lanes) x.derivative.set(static_cast<int>(i - first), 1);
    return x;
  };
  for (std::size_t i = 0; i < n; ++i) {
    q[i] = coordinate(i);
    qd[i] = coordinate(n + i);
    places[i].c = chained(joints[i].c, -joints[i].s, q[i]);
    places[i].s = chained(joints[i].s, joints[i].c, q[i]);
    places[i].d = q[i];
  }
}

/// All that pushes the tip of a plant that has moved; the power lost at the surface is added to `loss`.
Vec<Force, S> ClosedLoopSlopes::Work::feel(S& loss) {
  Vec<Force, S> push = as_force(loop.plant().tip_force);
  if (!loop.plant().environment) return push;
  const Environment& environment = *loop.plant().environment;
  const Vec3<S>& p = plant.tip_position();
  const Vec3<S>& v = plant.tip_velocity().lin;
  const bool in_contact = loop.modes().contact;
  const Touch at = touch(environment, value(p), value(v), in_contact);
  S lost = constant(lost_power(environment, at, value(v), in_contact));
  for (int i = 0; i < 6; ++i) component(push, i).value += at.wrench[i];
  for (int lane = 0; lane < lanes; ++lane) {
    const TouchSlope along =
        touch_slope(environment, at, value(v), in_contact, slope(p, lane), slope(v, lane));
    for (int i = 0; i < 3; ++i) component(push, 3 + i).derivative.set(lane, along.force[i]);
    lost.derivative.set(lane, along.lost_power);
  }
  loss += lost;
  return push;
}

/// T: the law's torque.
void ClosedLoopSlopes::Work::control(const CommandSlope& slope_of_u, const Vec<Force, S>& push) {
  const Controller& controller = loop.controller();
  const LawOptions& law = controller.options();
  for (std::size_t i = 0; i < n; ++i) {
    T0[i] = constant(-law.null_space.damping) * qd[i];
    if (const auto& posture = law.null_space.posture)
      T0[i] += constant(posture->stiffness) * (constant(posture->q[i]) - q[i]);
  }
  space.place(places);
  space.sweep(qd, T0, push);

  Vec<Motion, S> u;
  for (int i = 0; i < 6; ++i) component(u, i) = constant(controller.last().u[i]);
  const Vec<Motion, S> pose = {turn(space.tip_rotation()), space.tip_position()};
  for (int lane = 0; lane < lanes; ++lane) {
    const Vector6 along =
        slope_of_u.along({slope(pose, lane), slope(space.tip_velocity(), lane), slope(push, lane)});
    for (int i = 0; i < 6; ++i) component(u, i).derivative.set(lane, along[i]);
  }
  const Vec<Force, S> F = TaskFactor<S>(space.Omega(), law.rows).solve(space.right_side() + u);  // (4)
  space.torques(F, T);
  for (std::size_t i = 0; i < n; ++i) {
    if (law.compensate_friction && !controller.friction().empty())
      T[i] += friction_torque(controller.friction()[i], qd[i]);
    if (!law.effort_limit.empty() && std::abs(value(T[i])) > law.effort_limit[i])
      T[i] = constant(std::copysign(law.effort_limit[i], value(T[i])));
  }
}

void ClosedLoopSlopes::Work::write(std::size_t first, const S& work, const S& loss, const S& external,
                                   double* columns) const {
  for (std::size_t j = first; j < std::min(first + lanes, 2 * n); ++j) {
    const int lane = static_cast<int>(j - first);
    double* column = columns + j * loop.states();
    for (std::size_t i = 0; i < n; ++i) {
      column[i] = qd[i].derivative[lane];
      column[n + i] = qdd[i].derivative[lane];
    }
    column[2 * n] = work.derivative[lane];
    column[2 * n + 1] = loss.derivative[lane];
    column[2 * n + 2] = external.derivative[lane];
  }
}

ClosedLoopSlopes::ClosedLoopSlopes(ClosedLoop& loop) : work_(std::make_unique<Work>(loop)) {}
ClosedLoopSlopes::~ClosedLoopSlopes() = default;

void ClosedLoopSlopes::operator()(double t, const double* y, double* columns) {
  Work& w = *work_;
  w.begin(t, y);
  const Controller& controller = w.loop.controller();
  const LawOptions& law = controller.options();
  const Plant& plant = w.loop.plant();
  const CommandSlope slope_of_u(law, controller.last(), controller.known_tip_force());
  const Vec<Force, S> constant_push = as_force(plant.tip_force);

  std::fill_n(columns, w.loop.states() * w.loop.states(), 0.0);  // nothing depends on the energies
  for (std::size_t first = 0; first < 2 * w.n; first += lanes) {
    S work = constant(0), loss = constant(0);
    w.start(y, first);
    w.plant.place(w.places);
    w.plant.move(w.qd);
    const Vec<Force, S> push = w.feel(loss);
    if (w.acts) w.control(slope_of_u, law.know_tip_force ? push : Vec<Force, S>{});
    for (std::size_t i = 0; i < w.n; ++i) {
      const S friction = plant.friction.empty() ? constant(0) : friction_torque(plant.friction[i], w.qd[i]);
      w.net[i] = w.T[i] - friction;
      work += w.T[i] * w.qd[i];
      loss += friction * w.qd[i];
    }
    w.plant.accelerations(w.net, push, w.qdd);
    w.write(first, work, loss, dot(constant_push, w.plant.tip_velocity()), columns);
  }
}

}  // namespace osculate
