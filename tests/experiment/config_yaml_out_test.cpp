// Experiments out as YAML and in again, bit for bit.
#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <sstream>

#include "experiment/config_support.hpp"
#include "support/catch.hpp"

namespace osculate::testing::config_yaml_out_tests {

namespace {

using Bits = std::vector<std::uint64_t>;
void add(Bits& bits, double x) { bits.push_back(std::bit_cast<std::uint64_t>(x)); }
template <class Numbers>
void add_all(Bits& bits, const Numbers& x) {
  bits.push_back(static_cast<std::uint64_t>(x.size()));
  for (const double value : x) add(bits, value);
}
void add_friction(Bits& bits, const std::vector<JointFriction>& joints) {
  bits.push_back(joints.size());
  for (const auto& f : joints)
    add_all(bits, std::array{f.viscous, f.coulomb_positive, f.coulomb_negative, f.v_s});
}
struct AddReference {
  Bits& bits;
  void operator()(const HoldOptions&) const {}
  void operator()(const StepOptions& o) const { add_all(bits, o.offset), add(bits, o.at); }
  void operator()(const LineOptions& o) const {
    add_all(bits, o.offset), add(bits, o.start), add(bits, o.duration);
  }
  void operator()(const CircleOptions& o) const { add(bits, o.radius), add(bits, o.period); }
  void operator()(const LissajousOptions& o) const {
    add_all(bits, o.amplitude), add_all(bits, o.period), add_all(bits, o.phase);
  }
  void operator()(const WaypointsOptions&) const {}
  void operator()(const EachAxisOptions& o) const { add_all(bits, o.amplitude), add(bits, o.period); }
  void operator()(const MultisineOptions& o) const {
    bits.push_back(static_cast<std::uint64_t>(o.row));
    add(bits, o.amplitude), add_all(bits, o.frequencies);
  }
};

/// Every number of an experiment, bit for bit.
Bits bits_of(const Experiment& e) {
  Bits bits;
  add_all(bits, e.model.choice.gravity);
  add_all(bits, e.model.armature);
  add_friction(bits, e.model.friction);
  add(bits, e.plant.payload.mass);
  add_all(bits, e.plant.payload.com);
  add_all(bits, e.plant.payload.inertia.reshaped());
  bits.push_back(e.plant.armature.has_value());
  if (e.plant.armature) add_all(bits, *e.plant.armature);
  bits.push_back(e.plant.friction.has_value());
  if (e.plant.friction) add_friction(bits, *e.plant.friction);
  add(bits, e.plant.mass_scale);
  add_all(bits, e.plant.tip_force);
  add_all(bits, e.q);
  add_all(bits, e.qd);
  bits.push_back(e.reference.index());
  std::visit(AddReference{bits}, e.reference);
  add_all(bits, e.controller.stiffness);
  add_all(bits, e.controller.damping);
  add(bits, e.plant.inertia_scale);
  add_all(bits, e.plant.link_mass_scale);
  add_all(bits, e.controller.effort_limits);
  if (e.controller.virtual_inertia) add_all(bits, *e.controller.virtual_inertia);
  if (const auto& sampling = e.controller.sampling) {
    add(bits, sampling->period);
    add(bits, sampling->computation_time);
    bits.push_back(static_cast<std::uint64_t>(sampling->monitor_every));
  }
  if (e.base_motion) std::visit(AddReference{bits}, *e.base_motion);
  add_all(bits, std::array{e.integrator.rtol, e.integrator.atol_position, e.integrator.atol_velocity,
                           e.integrator.max_step, e.duration, e.output.interval, e.output.restart_interval});
  for (const long x : {e.integrator.max_steps, e.verify.every, e.verify.record_every})
    bits.push_back(static_cast<std::uint64_t>(x));
  return bits;
}
/// Everything that is no number.
std::string words_of(const Experiment& e) {
  std::ostringstream out;
  out << e.name << '|' << e.model.urdf << '|' << e.model.choice.base << '|' << e.model.choice.tip << '|'
      << static_cast<int>(e.model.choice.side_branches) << static_cast<int>(e.controller.law)
      << static_cast<int>(e.integrator.method) << static_cast<int>(e.integrator.jacobian)
      << static_cast<int>(e.verify.record) << e.verify.shadow << static_cast<int>(e.plant.dynamics)
      << static_cast<int>(e.controller.textbook) << e.verify.poles << e.controller.feedforward
      << static_cast<int>(e.controller.effort_limit) << e.plant.share_kinematics
      << e.controller.compensate_friction << e.controller.compensate_tip_force
      << static_cast<int>(e.controller.orientation) << static_cast<int>(e.controller.position) << '|'
      << e.expect.stop << '|';
  for (const auto& id : e.expect.fails) out << id << ',';
  for (const int row : e.controller.rows) out << row << ',';
  if (const auto& sampling = e.controller.sampling)
    out << "sampled" << static_cast<int>(sampling->delay) << sampling->extrapolate;
  if (e.base_motion) out << "base" << e.base_motion->index();
  if (const auto* circle = std::get_if<CircleOptions>(&e.reference)) out << circle->plane;
  if (const auto* points = std::get_if<WaypointsOptions>(&e.reference)) out << points->file;
  out << '|' << e.sweep.key;
  for (const auto& variant : e.sweep.variants) {
    out << ';' << variant.name << (variant.value ? " has a value" : "");
    for (const auto& change : variant.overrides) out << ' ' << change;
  }
  return out.str();
}

}  // namespace

TEST_CASE("what to_yaml writes is read back bit for bit") {
  const auto reference =
      GENERATE(as<std::string>{}, "{type: hold}", "{type: step, offset: [.1, 0, 0, 0, -0.0, 1e-3], at: 0.7}",
               "{type: line, offset: [0, 0, 0, 0.1, 0.2, 0.3], start: 0.1, duration: 0.3}",
               "{type: circle, radius: 0.3333333333333333, period: 1e-3, plane: zx}",
               "{type: lissajous, amplitude: [0, 0, 0, 0.1, 0.7, 0], period: [1, 2, 3, 4, 5, 6], phase: 0.1}",
               "{type: waypoints, file: 'path \"of\" \\ points.csv'}",
               "{type: each_axis, amplitude: [0, 0.1, 0, 0, -0.0, 1e-3], period: 0.7}",
               "{type: multisine, row: wz, amplitude: 0.3, frequencies: [0.1, 1e-9, 3]}");
  const auto seed = GENERATE(range(1u, 6u));
  INFO(reference << ", seed " << seed);
  auto e = parse_with("reference: " + reference);
  // Numbers of all sizes, the smallest subnormal and the largest double among them.
  std::mt19937_64 random(seed);
  const auto positive = [&] {
    const double edges[] = {5e-324, std::numeric_limits<double>::max(), 0.1, 1e22, 2.2250738585072014e-308};
    if (random() % 8 == 0) return edges[random() % 5];
    return std::ldexp(1 + static_cast<double>(random() >> 12) * 0x1p-52,
                      static_cast<int>(random() % 600) - 300);
  };
  const auto any = [&] { return random() % 2 == 0 ? positive() : random() % 5 == 0 ? -0.0 : -positive(); };
  e.name = seed == 1 ? "a \"b\" \\ \x01 # \u00e9: {[" : "1e5";
  e.model.choice.base = seed % 2 == 0 ? "null" : "";
  for (auto& x : e.q) x = any();
  for (auto& x : e.qd) x = any();
  for (int i = 0; i < 3; ++i) e.model.choice.gravity[i] = any();
  e.model.armature = {positive(), positive()};
  for (int i = 0; i < 3; ++i) e.model.friction.push_back({positive(), positive(), positive(), positive()});
  e.plant.payload.inertia.diagonal() << positive(), positive(), positive();
  e.plant.payload.mass = positive();
  if (seed % 2 == 0) e.plant.armature = std::vector<double>{};
  if (seed % 3 == 0) e.plant.armature = std::vector<double>{positive()};
  if (seed % 3 == 1) e.plant.friction = std::vector<JointFriction>{};
  if (seed % 3 == 2)
    e.plant.friction = std::vector<JointFriction>{{positive(), positive(), positive(), positive()}};
  e.plant.mass_scale = positive();
  for (int i = 0; i < 6; ++i) {
    e.plant.tip_force[i] = any();
    e.controller.stiffness[i] = positive();
    e.controller.damping[i] = positive();
  }
  e.controller.rows = {5, 3, 0};
  e.controller.law = seed % 2 == 0 ? Law::free : Law::operational_space;
  e.controller.feedforward = seed % 2 == 0;
  e.plant.inertia_scale = positive();
  e.plant.share_kinematics = seed % 2 == 0;
  e.plant.dynamics = seed % 2 == 0 ? PlantDynamics::dense : PlantDynamics::recursive;
  if (seed == 1) e.plant.environment = Environment{Plane{{any(), 1, any()}, {any(), 1, any()}}, positive()};
  if (seed == 2)
    e.plant.environment = Environment{Ball{{any(), 1, 0}, positive()}, 1, positive(), 0.1, positive()};
  if (seed == 2) {
    e.plant.link_mass_scale = {positive(), positive()};
    e.plant.mass_scale = 1;
  }
  e.controller.compensate_friction = seed % 2 == 0;
  e.controller.compensate_tip_force = seed % 2 == 0;
  e.controller.orientation = static_cast<OrientationCoordinates>(seed % 4);
  e.controller.position = static_cast<PositionCoordinates>(seed % 3);
  if (seed == 1) {
    e.controller.law = Law::textbook;
    e.controller.textbook = TextbookLaw::pseudo_inverse;
    e.controller.null_space = {positive(), positive(), std::vector<double>{any(), any()},
                               positive(), positive(), 0};
    e.controller.orientation = OrientationCoordinates::rotation_vector;
    e.controller.position = PositionCoordinates::cartesian;
    e.controller.virtual_inertia = Vector6::Constant(positive());
    e.controller.compensate_tip_force = true;
    e.controller.force = ForceControl{{3, 0}, {any(), any()}, positive(), positive()};
    e.controller.sampling = Sampling{1, Delay::none, false, 1, 0.3};
    e.controller.sensors = Sensors{positive(), positive()};
    e.controller.effort_limit = EffortLimit::list;
    e.controller.effort_limits = {positive(), positive()};
  }
  if (seed == 3) {
    e.controller.sampling = Sampling{positive(), Delay::both, true, 1};
    e.controller.obstacles = {{{any(), 0, any()}, positive(), positive(), positive()}, {}};
    e.controller.null_space.posture_stiffness = positive();
    e.controller.null_space.manipulability = positive();
    e.controller.effort_limit = EffortLimit::model;
    e.controller.singularity = {SingularPolicy::none, 0.3, positive()};
  }
  if (seed == 5) {
    e.controller.law = Law::resolved_acceleration;
    e.controller.sampling = Sampling{positive(), Delay::none, false, 7};
  }
  if (seed == 4) e.base_motion = LineOptions{Vector6::Constant(positive()), positive(), positive()};
  e.integrator = {
      seed % 2 == 0 ? Method::bdf : Method::runge_kutta, 1.0 / 3, positive(), positive(), positive(), 12345};
  e.integrator.jacobian = seed % 2 == 0 ? JacobianBy::differences : JacobianBy::automatic;
  e.verify.every = 3;
  e.verify.record = seed % 2 == 0 ? VerifyConfig::Record::worst : VerifyConfig::Record::every;
  e.verify.record_every = seed % 2 == 0 ? 1 : 9;
  e.verify.shadow = seed % 2 == 0;
  e.verify.poles = seed % 2 == 0;
  if (seed == 4) e.sweep = {"duration", {{"0.5", {"duration=0.5"}, 0.5}, {"1e0", {"duration=1e0"}, 1.0}}};
  if (seed == 5) {
    e.sweep.variants = {{"as: it # is", {}, {}},
                        {"two", {"initial.q=[1, 2]", "expect={stop: \"\", fails: [g]}", "name=\"a b\""}, {}}};
  }
  if (auto& sampling = e.controller.sampling)  // at most 1e9 samples in a run
    sampling->period = std::max(sampling->period, e.duration * 1e-6 / 3);
  e.output.interval = 0.1 + 0.2;
  e.output.restart_interval = 0.1 + 0.7;
  e.expect = {"too_many_steps", {"g", "null_space"}};
  const auto text = to_yaml(e);
  INFO(text);
  const auto back = parse_experiment(text, "somewhere/else.yaml", "/another/place");
  CHECK(words_of(back) == words_of(e));
  CHECK(bits_of(back) == bits_of(e));
  CHECK(to_yaml(back) == text);
  CHECK(back.plant.environment == e.plant.environment);
  CHECK(back.controller.null_space == e.controller.null_space);
  CHECK(back.controller.force == e.controller.force);
  CHECK(back.controller.obstacles == e.controller.obstacles);
  CHECK(back.controller.singularity == e.controller.singularity);
  CHECK(back.controller.sensors == e.controller.sensors);
  for (std::size_t i = 0; i < e.sweep.variants.size(); ++i)
    CHECK(back.sweep.variants.at(i).value == e.sweep.variants[i].value);
}

TEST_CASE("the defaults are written out") {
  const auto e = parse(Lines{}.text());
  const auto text = to_yaml(e);
  for (const auto* line : {"  gravity: [0, 0, -9.80665]\n", "  rtol: 1.0e-10\n", "  max_steps: 50000000\n",
                           "  rows: [wx, wy, wz, vx, vy, vz]\n", "  urdf: \"/arms/lab/arm.urdf\"\n"})
    CHECK(text.find(line) != std::string::npos);
  CHECK(words_of(parse(text)) == words_of(e));
  CHECK(bits_of(parse(text)) == bits_of(e));
}

}  // namespace osculate::testing::config_yaml_out_tests
