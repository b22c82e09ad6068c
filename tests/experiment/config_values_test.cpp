// Values of plant, references, controller and sweep, and what they need of the arm.
#include "experiment/config_support.hpp"
#include "support/catch.hpp"

namespace osculate::testing::config_values_tests {

namespace {

ControllerConfig controller(const std::string& keys) {
  return parse(Lines{.controller = "controller: {" + keys + "}"}.text()).controller;
}

/// Joints with an effort limit of 10 times their number and position limits -1 and 2.
ArmDescription arm_of(std::size_t joints) {
  ArmDescription arm;
  for (std::size_t i = 0; i < joints; ++i) {
    JointInfo joint;
    joint.name = "j" + std::to_string(i + 1);
    joint.lower = -1;
    joint.upper = 2;
    joint.effort = 10 * static_cast<double>(i + 1);
    arm.joints.push_back(joint);
    arm.chain.links.emplace_back();
  }
  return arm;
}

}  // namespace

TEST_CASE("the plant's surface, scales and dynamics") {
  const auto plane =
      parse_with(
          "plant: {mass_scale: [1, 2], inertia_scale: 3, dynamics: dense, share_kinematics: false,\n"
          "  environment: {type: plane, point: [0, 0, 1], normal: [0, 1, 1], stiffness: 5, "
          "damping: 6, friction: 7, v_s: 8}}")
          .plant;
  CHECK(plane.mass_scale == 1);
  CHECK(plane.link_mass_scale == std::vector<double>{1, 2});
  CHECK(plane.inertia_scale == 3);
  CHECK(plane.dynamics == PlantDynamics::dense);
  CHECK(!plane.share_kinematics);
  CHECK(plane.environment.value() ==
        Environment{Plane{Vector3<double>(0, 0, 1), Vector3<double>(0, 1, 1)}, 5, 6, 7, 8});
  const auto ball = parse_with("plant: {environment: {type: ball, centre: [1, 2, 3], radius: 4}}").plant;
  CHECK(ball.environment.value() == Environment{Ball{Vector3<double>(1, 2, 3), 4}});
  CHECK(parse_with("plant: {environment: {type: plane}}").plant.environment.value() == Environment{});
  const auto plain = parse_with("").plant;
  CHECK_FALSE(plain.environment.has_value());
  CHECK(plain.dynamics == PlantDynamics::recursive);
  CHECK(plain.link_mass_scale.empty());
}

TEST_CASE("references that excite one axis or one row") {
  const auto axes = parse_with("reference: {type: each_axis, amplitude: [0, 0, 0, 1, 2, 3], period: 5}");
  CHECK(std::get<EachAxisOptions>(axes.reference).amplitude[5] == 3);
  CHECK(std::get<EachAxisOptions>(axes.reference).period == 5);
  const auto sines =
      parse_with("reference: {type: multisine, row: wz, amplitude: 0.1, frequencies: [3, 1]}").reference;
  CHECK(std::get<MultisineOptions>(sines).row == 2);
  CHECK(std::get<MultisineOptions>(sines).amplitude == 0.1);
  CHECK(std::get<MultisineOptions>(sines).frequencies == std::vector<double>{3, 1});
  const auto defaults = std::get<MultisineOptions>(parse_with("reference: {type: multisine}").reference);
  CHECK(defaults.row == MultisineOptions{}.row);
  CHECK(defaults.frequencies == MultisineOptions{}.frequencies);
}

TEST_CASE("every law by its name") {
  CHECK(controller("law: operational_space").law == Law::operational_space);
  CHECK(controller("law: resolved_acceleration").law == Law::resolved_acceleration);
  CHECK(controller("law: free").law == Law::free);
  for (const auto& info : textbook_laws()) {
    const auto c = controller("law: " + std::string(info.name));
    CHECK(c.law == Law::textbook);
    CHECK(c.textbook == info.law);
  }
  CHECK(controller("law: operational_space_dense").textbook == TextbookLaw::dense);
}

TEST_CASE("the controller's sections") {
  const auto c = controller(
      "law: operational_space, feedforward: false, compensate_tip_force: true,\n"
      "null_space: {damping: 1, posture: {stiffness: 2, q: [3, 4]}, limits: {gain: 5, margin: 6}, "
      "manipulability: "
      "7},\n"
      "impedance: {inertia: [1, 2, 3, 4, 5, 6]}, force: {rows: [vz, wx], desired: [20, -1], inertia: 8, "
      "damping: 9},\n"
      "obstacles: [{centre: [1, 2, 3], radius: 4, influence: 5, gain: 6}, {centre: [0, 0, 1]}],\n"
      "sampling: {period: 0.01, computation_time: 0.005}, sensors: {resolution: 1e-4, velocity_cutoff: 50},\n"
      "effort_limit: [10, 20]");
  CHECK_FALSE(c.feedforward);
  CHECK(c.null_space == NullSpaceConfig{1, 2, std::vector<double>{3, 4}, 5, 6, 7});
  CHECK(c.virtual_inertia.value()[5] == 6);
  CHECK(c.stiffness == Vector6::Constant(100));  // as given, N/m now
  CHECK(c.force.value() == ForceControl{{5, 0}, {20, -1}, 8, 9});
  REQUIRE(c.obstacles.size() == 2);
  CHECK(c.obstacles[0] == Obstacle{Vector3<double>(1, 2, 3), 4, 5, 6});
  CHECK(c.obstacles[1] == Obstacle{Vector3<double>(0, 0, 1)});
  CHECK(c.sampling.value().computation_time == 0.005);
  CHECK(c.sensors.value() == Sensors{1e-4, 50});
  CHECK(c.effort_limit == EffortLimit::list);
  CHECK(c.effort_limits == std::vector<double>{10, 20});

  const auto plain = controller("law: operational_space");
  CHECK(plain.feedforward);
  CHECK(plain.null_space == NullSpaceConfig{});
  CHECK_FALSE(plain.virtual_inertia.has_value());
  CHECK_FALSE(plain.force.has_value());
  CHECK(plain.effort_limit == EffortLimit::none);
  const auto some = controller("law: free, effort_limit: none, obstacles: [], null_space: {damping: 0}");
  CHECK(some.obstacles.empty());
  CHECK(controller("law: no_coriolis, effort_limit: model").effort_limit == EffortLimit::model);
  const auto pull = controller("law: operational_space, null_space: {posture: {stiffness: 2}}").null_space;
  CHECK(pull.posture_stiffness == 2);
  CHECK_FALSE(pull.posture.has_value());
  CHECK(controller("law: operational_space, impedance: {inertia: 3}").virtual_inertia.value() ==
        Vector6::Constant(3));
  CHECK(parse_with("integrator: {method: runge_kutta}").integrator.method == Method::runge_kutta);
  CHECK(parse_with("verify: {poles: true}").verify.poles);
}

TEST_CASE("the threshold of a singularity follows its policy") {
  const auto of = [](const std::string& keys) {
    return controller("law: operational_space, singularity: {" + keys + "}").singularity;
  };
  CHECK(of("") == SingularityOptions{});
  CHECK(of("policy: none").threshold == 1e-6);
  CHECK(of("policy: damped") == SingularityOptions{SingularPolicy::damped, 1e-2, 1e-3});
  CHECK(of("policy: truncated").threshold == 1e-2);
  CHECK(of("policy: released, threshold: 0.1, damping: 0.2") ==
        SingularityOptions{SingularPolicy::released, 0.1, 0.2});
}

TEST_CASE("a sweep of one key") {
  const auto sweep =
      parse_with("sweep: {key: controller.gains.damping, values: [20, 1e1, .5]}\nduration: 3").sweep;
  CHECK(sweep.key == "controller.gains.damping");
  REQUIRE(sweep.variants.size() == 3);
  CHECK(sweep.variants[1].name == "1e1");
  CHECK(sweep.variants[1].overrides == Strings{"controller.gains.damping=1e1"});
  CHECK(sweep.variants[1].value == 10.0);
  CHECK(sweep.variants[2].value == 0.5);
  const auto words = parse_with("sweep: {key: controller.law, values: [free, gravity_only]}").sweep;
  CHECK_FALSE(words.variants[0].value.has_value());
  const auto names = parse_with("sweep: {key: name, values: ['1', 'a: b']}").sweep;
  CHECK(names.variants[0].overrides == Strings{"name=\"1\""});
  CHECK_FALSE(names.variants[0].value.has_value());
  CHECK(names.variants[1].overrides == Strings{"name=\"a: b\""});
}

TEST_CASE("each variant of a sweep is an experiment of its own") {
  const std::string text = Lines{.more = R"(
duration: 3
sweep:
  variants:
    as_given: {}
    free:
      controller: {law: free}
      expect.fails: [energy, g]
      plant.payload: {mass: 1, com: [0, 0, 0.1]}
    pulled:
      controller.null_space.posture: {stiffness: 2, q: [1, 2]}
      model.urdf: "b \"c\", {d}.urdf"
      initial.q.1: 0.25
)"}
                               .text();
  const Strings given{"duration=2"};
  const auto e = parse(text, given);
  REQUIRE(e.sweep.variants.size() == 3);
  CHECK(e.sweep.key.empty());
  const auto run = [&](std::size_t i) { return parse(text, overrides_of(e.sweep.variants[i], given)); };
  CHECK(run(0).duration == 2);
  CHECK(run(0).sweep.variants.empty());
  const auto free = run(1);
  CHECK(free.controller.law == Law::free);
  CHECK(free.expect.fails == Strings{"energy", "g"});
  CHECK(free.plant.payload.com[2] == 0.1);
  // On top of the variant before it this one would be refused: a free swing has no null space.
  const auto pulled = run(2);
  CHECK(pulled.controller.null_space.posture.value() == std::vector<double>{1, 2});
  CHECK(pulled.model.urdf == "/arms/lab/b \"c\", {d}.urdf");
  CHECK(pulled.q == std::vector<double>{0, 0.25});
  CHECK(pulled.duration == 2);
}

TEST_CASE("--set changes a sweep, and its variants are tried again") {
  const auto text = Lines{.more = "sweep: {key: duration, values: [1, 2]}"}.text();
  CHECK(parse(text, {"sweep.values=[5]"}).sweep.variants.at(0).value == 5.0);
  CHECK(parse(text, {"sweep={}"}).sweep.variants.empty());
  CHECK(message_of(text, {"sweep.values.1=-2"}) ==
        "--set sweep.values.1=-2: duration = -2: must be > 0. (Variant -2 of sweep.)");
}

TEST_CASE("what the sections need of the arm is checked against it") {
  auto arm = arm_of(3);
  const std::string three = "entries, the chain has 3 joints: j1 j2 j3.";
  const auto check = [&](const std::string& keys, const std::string& more = "",
                         const std::string& q = "[0, 1, 1]") {
    const Lines lines{.initial = "initial: {q: " + q + "}",
                      .controller = "controller: {law: operational_space, rows: [vx, vy, vz], " + keys + "}",
                      .more = more};
    return message([&] { check_against(parse(lines.text()), arm); });
  };
  CHECK(check("", "plant: {mass_scale: [1, 2, 3]}") == "(accepted)");
  CHECK(
      check("", "plant: {mass_scale: [1, 2]}") ==
      "reach.yaml:4:21: plant.mass_scale has 2 entries; give one number, or one for each of the 3 links that "
      "the joints j1 j2 j3 carry.");
  CHECK(check("null_space: {posture: {stiffness: 1}, limits: {gain: 1}, manipulability: 1}") == "(accepted)");
  CHECK(check("null_space: {posture: {stiffness: 1, q: [1, 2]}}") ==
        "reach.yaml:3:98: controller.null_space.posture.q has 2 " + three);
  CHECK(check("effort_limit: [1, 2]") == "reach.yaml:3:72: controller.effort_limit has 2 " + three);
  CHECK(check("effort_limit: []") == "reach.yaml:3:72: controller.effort_limit has 0 " + three);
  CHECK(check("effort_limit: [1, 2, 3]") == "(accepted)");
  CHECK(check("effort_limit: model") == "(accepted)");
  CHECK(check("null_space: {limits: {gain: 1}}", "", "[0, -1, 0]") ==
        "reach.yaml:2:14: initial.q: joint j2 starts at or beyond its limit, where "
        "controller.null_space.limits has "
        "no value: start between the limits of the URDF file.");
  CHECK(check("null_space: {limits: {gain: 0}}", "", "[0, -1, 0]") == "(accepted)");
  CHECK(check("obstacles: [{centre: [0, 0, 1]}]") == "(accepted)");

  arm.joints[0].effort = 0;
  arm.joints[2].effort.reset();
  arm.joints[2].lower.reset();
  CHECK(check("effort_limit: model") ==
        "reach.yaml:3:72: controller.effort_limit = model: the URDF file gives no <limit effort> for each "
        "axis of "
        "j1 j3; give a list of torques, one for each velocity coordinate.");
  CHECK(check("null_space: {limits: {gain: 1}}", "", "[0, 0, -9]") == "(accepted)");

  const Lines two{
      .initial = "initial: {q: [0, 1, 1]}",
      .controller = "controller: {law: no_coriolis, rows: [vx, vy], obstacles: [{centre: [0, 0, 1]}]}"};
  CHECK(message([&] { check_against(parse(two.text()), arm); }) ==
        "reach.yaml:3:59: controller.obstacles needs the task rows vx, vy and vz: add them to "
        "controller.rows.");
  const Lines six{.initial = "initial: {q: [0, 1, 1]}", .controller = "controller: {law: no_coriolis}"};
  CHECK(message([&] { check_against(parse(six.text()), arm); }).find("controller.rows has 6 task rows") !=
        std::string::npos);
}

TEST_CASE("posture, limits, manipulability and sensors are for joints with one axis") {
  auto arm = arm_of(2);
  arm.chain.links[0].type = JointType::floating;
  const auto check = [&](const std::string& keys) {
    const Lines lines{.initial = "initial: {q: [1, 0, 0, 0, 0, 0, 0, 0.5]}",
                      .controller = "controller: {law: operational_space, " + keys + "}"};
    return message([&] { check_against(parse(lines.text()), arm); });
  };
  const auto refused = [&](const std::string& keys, const std::string& path) {
    INFO(keys);
    CHECK(check(keys).find(": " + path +
                           " is for joints with one axis each; this chain has others: remove it.") !=
          std::string::npos);
  };
  CHECK(check("null_space: {damping: 1}, sampling: {period: 1}") == "(accepted)");
  refused("null_space: {posture: {stiffness: 1}}", "controller.null_space.posture");
  refused("null_space: {limits: {gain: 1}}", "controller.null_space.limits");
  refused("null_space: {manipulability: 1}", "controller.null_space.manipulability");
  refused("sampling: {period: 1}, sensors: {resolution: 1e-4}", "controller.sensors");
  CHECK(check("effort_limit: [1, 1, 1, 1, 1, 1]") ==
        "reach.yaml:3:52: controller.effort_limit has 6 entries, the chain has 7 velocity coordinates in its "
        "joints "
        "j1 j2.");
  CHECK(check("effort_limit: [1, 1, 1, 1, 1, 1, 1]") == "(accepted)");
  CHECK(check("effort_limit: model").find("for each axis of j1; give a list") != std::string::npos);
}

}  // namespace osculate::testing::config_values_tests
