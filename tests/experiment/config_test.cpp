// Experiment files in: values, defaults, overrides, files, lists against the arm.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

#include "experiment/config_support.hpp"
#include "support/catch.hpp"

namespace osculate::testing::config_tests {

namespace {

ArmDescription arm_with(const Strings& joints) {
  ArmDescription arm;
  for (const auto& name : joints) {
    JointInfo joint;
    joint.name = name;
    arm.joints.push_back(joint);
    arm.chain.links.emplace_back();
  }
  return arm;
}

}  // namespace

TEST_CASE("a minimal experiment has every default of the header") {
  const auto e = parse(Lines{}.text());
  CHECK(e.name == "reach");
  CHECK(e.model.urdf == "/arms/lab/arm.urdf");
  CHECK(e.model.choice.base.empty());
  CHECK(e.model.choice.gravity == Vector3<double>(0, 0, -9.80665));
  CHECK(e.q == std::vector<double>{0, 1});
  CHECK(e.qd.empty());  // at rest
  CHECK(std::holds_alternative<HoldOptions>(e.reference));
  CHECK(e.controller.rows == std::vector<int>{0, 1, 2, 3, 4, 5});
  CHECK(e.controller.stiffness == Vector6::Constant(100));
  CHECK(e.integrator.rtol == 1e-10);
  CHECK(e.duration == 10);
  CHECK(e.verify.every == 1);
  CHECK_FALSE(e.plant.armature.has_value());
}

TEST_CASE("every setting arrives where it belongs") {
  const auto e = parse(R"(
name: all
model:
  urdf: ../models/arm.urdf
  base: floor
  tip: tool
  gravity: [0, 1.5, -9]
  side_branches: drop
  armature: &motors [1, 2]
  friction: {viscous: [0.1, 0.2], coulomb_positive: [3, 4], coulomb_negative: [5, 6], v_s: 0.5}
plant:
  payload: {mass: 2, com: [0, 0, 0.1], inertia: [3, 4, 5, 0.1, 0.2, 0.3]}
  armature: *motors
  friction: {coulomb: [7, 8], v_s: [0.1, 0.2]}
  mass_scale: 1.25
  tip_force: [1, 2, 3, 4, 5, 6]
initial: {q: [.5, +1e-1], qd: [-1, 0]}
reference: {type: lissajous, amplitude: [0, 0, 0, 0.1, 0.2, 0], period: 3, phase: [0, 0, 0, 0, 1, 0]}
controller: {law: operational_space, coordinates: position, gains: {stiffness: [1, 2, 3, 4, 5, 6], damping: 7},
             null_space: {damping: 8}, compensate_friction: false}
integrator: {method: bdf, rtol: 1.0e-6, atol: {position: 1e-7, velocity: 1e-8}, max_step: 0.1, max_steps: 1e6}
duration: 3
output: {interval: 0.5}
verify: {every: 4, record: 7, shadow: false}
expect: {stop: singular, fails: [c_plus_g, omega]}
)");
  CHECK(e.model.urdf == "/arms/models/arm.urdf");
  CHECK(e.model.choice.side_branches == SideBranches::drop);
  CHECK(e.model.friction[1].viscous == 0.2);
  CHECK(e.model.friction[1].coulomb_positive == 4);
  CHECK(e.model.friction[1].coulomb_negative == 6);
  CHECK(e.model.friction[0].v_s == 0.5);
  const auto& I = e.plant.payload.inertia;
  CHECK(I.diagonal() == Vector3<double>(3, 4, 5));
  CHECK(Vector3<double>(I(0, 1), I(0, 2), I(1, 2)) == Vector3<double>(0.1, 0.2, 0.3));
  CHECK(I == I.transpose());
  CHECK(e.plant.armature.value() == std::vector<double>{1, 2});
  CHECK(e.plant.friction.value()[1].coulomb_negative == 8);
  CHECK(e.plant.friction.value()[1].v_s == 0.2);
  CHECK(e.plant.tip_force[5] == 6);
  CHECK(e.q == std::vector<double>{0.5, 0.1});
  const auto& path = std::get<LissajousOptions>(e.reference);
  CHECK(path.amplitude[4] == 0.2);
  CHECK(path.period == Vector6::Constant(3));
  CHECK(path.phase[4] == 1);
  CHECK(e.controller.rows == std::vector<int>{3, 4, 5});
  CHECK(e.controller.stiffness[5] == 6);
  CHECK(e.controller.damping == Vector6::Constant(7));
  CHECK(e.controller.null_space.damping == 8);
  CHECK_FALSE(e.controller.compensate_friction);
  CHECK(e.integrator.method == Method::bdf);
  CHECK(e.integrator.atol_position == 1e-7);
  CHECK(e.integrator.atol_velocity == 1e-8);
  CHECK(e.integrator.max_steps == 1'000'000);
  CHECK(e.verify.every == 4);
  CHECK(e.verify.record == VerifyConfig::Record::every);
  CHECK(e.verify.record_every == 7);
  CHECK(e.expect.fails == Strings{"c_plus_g", "omega"});
}

TEST_CASE("merge keys fill in what is not given") {
  const auto e = parse_with(
      "plant: {friction: &f {viscous: [1, 2], v_s: 0.5}}\n"
      "verify: {<<: {every: 3, shadow: false}, every: 5}");
  CHECK(e.verify.every == 5);
  CHECK_FALSE(e.verify.shadow);
}

TEST_CASE("--set changes a setting before anything is checked") {
  const auto circle = "reference: {type: circle, radius: 0.2}";
  const auto e =
      parse_with(circle, {"duration=2.5", "initial.q.1=-0.5", "plant.payload.mass=3", "model.urdf=b.urdf",
                          "controller.gains={stiffness: [1, 2, 3, 4, 5, 6]}", "reference.period=4",
                          "controller.gains.damping=9", "controller.gains.stiffness.2=30"});
  CHECK(e.duration == 2.5);
  CHECK(e.q == std::vector<double>{0, -0.5});
  CHECK(e.plant.payload.mass == 3);
  CHECK(e.model.urdf == "/arms/lab/b.urdf");
  CHECK(e.controller.stiffness[2] == 30);
  CHECK(e.controller.stiffness[3] == 4);
  CHECK(e.controller.damping == Vector6::Constant(9));
  CHECK(std::get<CircleOptions>(e.reference).radius == 0.2);
  CHECK(std::get<CircleOptions>(e.reference).period == 4);
  CHECK(std::holds_alternative<HoldOptions>(parse_with(circle, {"reference={type: hold}"}).reference));
  CHECK(parse("name: only\n", {"model={urdf: a, tip: t}", "initial.q=[1]", "controller.law=free"}).q.size() ==
        1);
  CHECK(parse(Lines{.more = "duration: -1"}.text(), {"duration=1"}).duration == 1);
}

TEST_CASE("--set on an alias leaves the anchor alone") {
  const auto e = parse(Lines{.initial = "initial: {q: &q [1, 2], qd: *q}"}.text(), {"initial.qd.0=7"});
  CHECK(e.q == std::vector<double>{1, 2});
  CHECK(e.qd == std::vector<double>{7, 2});
}

TEST_CASE("a bad --set is reported as such") {
  CHECK(message_of_set("controller.gains.stifness=3") ==
        "--set controller.gains.stifness=3: unknown key 'controller.gains.stifness': did you mean "
        "'stiffness'?");
  CHECK(message_of_set("duration=-1") == "--set duration=-1: duration = -1: must be > 0.");
  CHECK(message_of_set("initial.q.2=1") ==
        "--set initial.q.2=1: initial.q is a list of 2: '2' must be an index from 0 to 1.");
  CHECK(message_of_set("initial.qd.0=1") ==
        "--set initial.qd.0=1: initial.qd is not given; set the whole list: --set initial.qd=[...].");
  CHECK(message_of_set("model.tip.x=1") ==
        "--set model.tip.x=1: model.tip = tool has no parts; set model.tip itself.");
  const auto form = "must have the form key.path=value, for instance --set initial.q.2=0.5.";
  for (const auto* text : {"duration", "=3", "a..b=3", ".a=3", "a.=3"}) {
    const std::string start = std::string("--set ") + text + ": ";
    CHECK(message_of_set(text) == start + form);
  }
  CHECK(message_of_set("duration=[1").starts_with("--set duration=[1: not valid YAML: "));
  CHECK(message_of_set("duration=").starts_with("--set duration=: duration = (nothing): "));
  CHECK(message_of_set("initial.q=").starts_with("--set initial.q=: initial.q = (nothing): must be a list"));
  CHECK(message_of_set("controller={gains: {}}")
            .starts_with("--set controller={gains: {}}: controller.law is missing"));
}

TEST_CASE("files that cannot be read") {
  const auto folder = std::filesystem::temp_directory_path() / "osculate_config_test";
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& text) {
    std::ofstream(folder / "x.yaml", std::ios::binary) << text;
    return folder / "x.yaml";
  };
  const auto read_message = [](const std::filesystem::path& file) {
    return message([&] { read_experiment(file); });
  };
  const auto name = (folder / "x.yaml").string();
  CHECK(read_message(folder / "none.yaml") ==
        (folder / "none.yaml").string() + ": no such file; give an experiment file.");
  CHECK(read_message(folder) == folder.string() + ": is a directory; give an experiment file.");
  for (const auto* text : {"", "\n\n", "# nothing\n", "~\n"})
    CHECK(read_message(write(text)) ==
          name + ": is empty; an experiment needs model, initial and controller.");
  CHECK(read_message(write("- 1\n")).starts_with(name + ":1:1: must be a map of keys"));
  CHECK(read_message(write("hello\n")).starts_with(name + ":1:1: must be a map of keys"));
  const auto e = read_experiment(write("\xef\xbb\xbf" + Lines{.more = "duration: 3\r"}.text()));
  CHECK(e.name == "x");
  CHECK(e.duration == 3);
  CHECK(e.file == folder / "x.yaml");
  CHECK(e.model.urdf == std::filesystem::absolute(folder / "arm.urdf").lexically_normal());
  std::filesystem::remove_all(folder);
}

TEST_CASE("lists are checked against the arm, at the place where they were given") {
  const auto arm = arm_with({"joint1", "joint2", "joint3"});
  const auto check = [&](const Lines& lines, const Strings& overrides = {}) {
    return message([&] { check_against(parse(lines.text(), overrides), arm); });
  };
  const std::string three = "the chain has 3 joints: joint1 joint2 joint3.";
  const std::string q3 = "initial: {q: [0, 1, 2]}",
                    xyz = "controller: {law: operational_space, rows: [vx, vy, vz]}";
  CHECK(check({}) == "reach.yaml:2:14: initial.q has 2 entries, " + three);
  CHECK(check({}, {"initial.q=[1]"}) == "--set initial.q=[1]: initial.q has 1 entries, " + three);
  CHECK(
      check({.initial = q3}) ==
      "reach.yaml:3:13: controller.rows has 6 task rows, the chain has only 3 joints (joint1 joint2 joint3); "
      "choose at most 3, for instance controller.rows: [vx, vy, vz].");
  CHECK(check({.initial = q3, .controller = "controller: {law: free}"}) == "(accepted)");
  CHECK(check({.initial = q3, .controller = xyz}) == "(accepted)");
  CHECK(check({.model = "model: {urdf: a, tip: t, armature: [1]}", .initial = q3, .controller = xyz}) ==
        "reach.yaml:1:36: model.armature has 1 entries, " + three);
  CHECK(check({.initial = q3, .controller = xyz, .more = "plant: {friction: {viscous: [1, 2]}}"}) ==
        "reach.yaml:4:19: plant.friction has 2 entries, " + three);
  CHECK(check({.initial = q3, .controller = xyz, .more = "plant: {friction: {}, armature: []}"}) ==
        "(accepted)");
  auto made = parse(Lines{}.text());
  made.places.clear();
  CHECK(message([&] { check_against(made, arm); }) == "reach.yaml: initial.q has 2 entries, " + three);
}

TEST_CASE("what a law needs of the arm is checked against it") {
  const auto arm = arm_with({"j1", "j2", "j3", "j4", "j5", "j6"});
  const auto check = [&](const std::string& controller, const std::string& more = "") {
    const Lines lines{.initial = "initial: {q: [0, 1, 2, 3, 4, 5]}", .controller = controller, .more = more};
    return message([&] { check_against(parse(lines.text()), arm); });
  };
  const auto says = [](const std::string& text, const std::string& part) {
    INFO(text);
    CHECK(text.find(part) != std::string::npos);
  };
  CHECK(check("controller: {law: resolved_acceleration}") == "(accepted)");
  says(check("controller: {law: resolved_acceleration, rows: [vx, vy, vz]}"),
       "as many task rows as joint coordinates; here are 3 and 6");
  says(check("controller: {law: operational_space, orientation: quaternion, rows: [wx, vx, vy, vz]}"),
       "needs the task rows wx, wy and wz");
  says(check("controller: {law: operational_space, position: spherical, rows: [vx, vy]}"),
       "needs the task rows vx, vy and vz");
  says(check("controller: {law: operational_space, orientation: quaternion, gains: {damping: [1, 2, 3, 4, 5, "
             "6]}}"),
       "must be equal for wx, wy and wz");
  says(check("controller: {law: operational_space, sampling: {period: 1, delay: both}}",
             "base_motion: {type: circle}"),
       "for a base at rest");
  CHECK(check("controller: {law: operational_space, sampling: {period: 1, delay: both}}",
              "base_motion: {type: hold}") == "(accepted)");
}

TEST_CASE("joints with several coordinates are counted by coordinate") {
  auto arm = arm_with({"body", "elbow"});
  arm.chain.links[0].type = JointType::floating;
  const auto check = [&](const std::string& initial, const std::string& model = "model: {urdf: a, tip: t}") {
    const Lines lines{.model = model, .initial = initial, .controller = "controller: {law: free}"};
    return message([&] { check_against(parse(lines.text()), arm); });
  };
  CHECK(check("initial: {q: [1, 0, 0, 0, 0, 0, 0, 0.5]}") == "(accepted)");
  CHECK(check("initial: {q: [1, 0]}") ==
        "reach.yaml:2:14: initial.q has 2 entries, the chain has 8 position coordinates in its joints body "
        "elbow.");
  CHECK(check("initial: {q: [1, 0, 0, 0, 0, 0, 0, 0.5], qd: [1]}") ==
        "reach.yaml:2:46: initial.qd has 1 entries, the chain has 7 velocity coordinates in its joints body "
        "elbow.");
  CHECK(check("initial: {q: [0, 0, 0, 0, 1, 1, 1, 0.5]}").find("which is no orientation") !=
        std::string::npos);
  CHECK(check("initial: {q: [1, 0, 0, 0, 0, 0, 0, 0.5]}",
              "model: {urdf: a, tip: t, armature: [0, 0, 0, 0, 0, 1, 0]}")
            .find("its armature must be 0") != std::string::npos);
}

/// The key, or a map on the way to it, is called unknown.
static bool is_unknown(std::string key, const std::string& type) {
  if (const auto at = key.find(".N."); at != std::string::npos) key.replace(at, 3, ".0.");
  const std::string surface = type == "circle" ? "ball" : "plane";
  const auto got = message_of(
      Lines{.controller = "controller: {law: operational_space, obstacles: [{centre: [0, 0, 1]}]}",
            .more = "reference: {type: " + type + "}\nplant: {environment: {type: " + surface + "}}"}
          .text(),
      {key + "={zzz: 0}"});
  // Entries of lists are named path[i].
  if (const auto at = key.find(".0."); at != std::string::npos) key.replace(at, 3, "[0].");
  for (auto end = key.size(); end != std::string::npos; end = end == 0 ? end - 1 : key.rfind('.', end - 1))
    if (got.find("unknown key '" + key.substr(0, end) + "'") != std::string::npos) return true;
  return false;
}

static const Strings types{"hold",      "step",      "line",      "circle",
                           "lissajous", "waypoints", "each_axis", "multisine"};

TEST_CASE("every key of docs/experiment-file.md exists") {
  CHECK(is_unknown("model.zzz", "hold"));
  CHECK(is_unknown("zzz.urdf", "hold"));
  CHECK(is_unknown("controller.obstacles.N.zzz", "hold"));
  CHECK(is_unknown("plant.environment.zzz", "hold"));
  std::ifstream in(OSCULATE_SOURCE_DIR "/docs/experiment-file.md");
  std::string line;
  int keys = 0;
  while (std::getline(in, line)) {
    if (!line.starts_with("| `") && !line.starts_with("| **`")) continue;
    const auto cell = line.substr(1, line.find(" | ", 1) - 1);
    std::string section;
    for (auto at = cell.find('`'); at != std::string::npos; at = cell.find('`', at + 1)) {
      const auto end = cell.find('`', at + 1);
      auto key = cell.substr(at + 1, end - at - 1);
      at = end;
      if (key.starts_with('.')) key = section + key;
      section = key.substr(0, key.find_last_of('.'));
      INFO(key);
      CHECK_FALSE(
          std::all_of(types.begin(), types.end(), [&](const auto& type) { return is_unknown(key, type); }));
      ++keys;
    }
  }
  CHECK(keys > 80);
}

TEST_CASE("every key is in docs/experiment-file.md") {
  std::ifstream in(OSCULATE_SOURCE_DIR "/docs/experiment-file.md");
  const std::string page{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  int keys = 0;
  const auto look = [&](const std::string& section, const std::string& more, const std::string& set) {
    // The message about an unknown key lists the known ones: "the keys here are a, b or c."
    auto got = message_of(Lines{.more = more}.text(), {set + "#####=0"});
    const std::string start = "the keys here are ";
    INFO(section << "\n" << got);
    REQUIRE(got.find(start) != std::string::npos);
    got = got.substr(got.find(start) + start.size());
    std::string key;
    for (const char c : got) {
      if (std::isalpha(static_cast<unsigned char>(c)) || c == '_') {
        key += c;
      } else if (!key.empty() && key != "or") {
        INFO(key);
        CHECK((page.find("`" + section + key) != std::string::npos ||
               page.find("`." + key + "`") != std::string::npos));
        ++keys;
        key.clear();
      } else {
        key.clear();
      }
    }
  };
  for (const std::string section : {"",
                                    "model.",
                                    "model.friction.",
                                    "plant.",
                                    "plant.payload.",
                                    "initial.",
                                    "controller.",
                                    "controller.gains.",
                                    "controller.null_space.",
                                    "controller.null_space.posture.",
                                    "controller.null_space.limits.",
                                    "controller.impedance.",
                                    "controller.force.",
                                    "controller.singularity.",
                                    "controller.sampling.",
                                    "controller.sensors.",
                                    "integrator.",
                                    "output.",
                                    "verify.",
                                    "expect.",
                                    "sweep."})
    look(section, "", section);
  for (const auto& type : types) look("reference.", "reference: {type: " + type + "}", "reference.");
  for (const std::string type : {"plane", "ball"})
    look("plant.environment.", "plant: {environment: {type: " + type + "}}", "plant.environment.");
  look("controller.obstacles.N.", "", "controller.obstacles=[{zzz: 0}]  #");
  CHECK(keys > 100);
}

TEST_CASE("docs/experiment-file.md names every claim and every law") {
  std::ifstream in(OSCULATE_SOURCE_DIR "/docs/experiment-file.md");
  const std::string page{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto names = [&](std::string_view word) {
    INFO(word);
    CHECK(page.find(word) != std::string::npos);
  };
  // "must be omega, lambda, ... or force_response."
  const auto claims = message_of_set("expect.fails=[0]");
  std::string word;
  for (const char c : claims.substr(claims.find("must be ") + 8)) {
    if (std::isalpha(static_cast<unsigned char>(c)) || c == '_') {
      word += c;
    } else {
      if (!word.empty()) names(word);
      word.clear();
    }
  }
  for (const auto& info : textbook_laws()) names("`" + std::string(info.name) + "`");
}

TEST_CASE("the experiments of the project can be read") {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(OSCULATE_SOURCE_DIR "/experiments")) {
    if (entry.path().extension() != ".yaml") continue;
    INFO(entry.path());
    const auto e = read_experiment(entry.path());
    CHECK(e.name == entry.path().stem());
    CHECK(std::filesystem::exists(e.model.urdf));
    ++files;
  }
  CHECK(files >= 1);
}

}  // namespace osculate::testing::config_tests
