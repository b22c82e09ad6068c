// Bad experiment files: every message has a place, a value and a remedy.
#include "experiment/config_support.hpp"
#include "support/catch.hpp"

using namespace osculate;

TEST_CASE("the texts of messages") {
  CHECK(message_of(Lines{.controller = "controller:\n  law: operational_space\n  gains:\n"
                                       "    stiffness: [1, 2, -40, 4, 5, 6]"}
                       .text()) == "reach.yaml:6:23: controller.gains.stiffness[2] = -40: must be >= 0.");
  CHECK(message_of(Lines{.controller = "controller: {law: free, gains: {stifness: 3}}"}.text()) ==
        "reach.yaml:3:33: unknown key 'controller.gains.stifness': did you mean 'stiffness'?");
  CHECK(message_of(Lines{.controller = "controller: {coordinates: pose}"}.text()) ==
        "reach.yaml:3:13: controller.law is missing: give operational_space, resolved_acceleration or free.");
  CHECK(message_of(Lines{.more = "integrator: {rtol: 1e-15}"}.text()) ==
        "reach.yaml:4:20: integrator.rtol = 1e-15: must be >= 1e-14 and < 1: a double resolves 2e-16.");
  CHECK(message_of(Lines{.more = "duration: 1\nduration: 2"}.text()) ==
        "reach.yaml:5:1: key 'duration' is given twice, first at reach.yaml:4:1: remove one.");
  CHECK(message_of(Lines{.more = "duration: \"1\""}.text()) ==
        "reach.yaml:4:11: duration = \"1\": must be a number: remove the quotes.");
  CHECK(message_of(Lines{.more = "verify: {shadow: yes}"}.text()) ==
        "reach.yaml:4:18: verify.shadow = yes: must be true or false.");
  CHECK(message_of(Lines{.initial = "initial: {qd: [0]}"}.text()) ==
        "reach.yaml:2:10: initial.q is missing: give one number for each joint from base to tip "
        "(zero is singular for common arms).");
}

TEST_CASE("bad input is refused with place and reason") {
  struct Bad {
    int line;  // of the minimal experiment, replaced by `text`; 4 adds
    std::string text, place, fragment;
  };
  const auto bad = GENERATE(values<Bad>({
      {4, "speed: 3", "4:1", "unknown key 'speed': the keys here are name, model, plant"},
      {4, "durration: 3", "4:1", "did you mean 'duration'?"},
      {4, "Duration: 3", "4:1", "did you mean 'duration'?"},
      {4, "name: ''", "4:7", "not empty"},
      {4, "name: a/b", "4:7", "must not contain '/'"},
      {1, "model: {tip: tool}", "1:8", "model.urdf is missing"},
      {1, "model: {urdf: a.urdf}", "1:8", "model.tip is missing"},
      {1, "model: a.urdf", "1:8", "model = a.urdf: must be a map"},
      {1, "model: {urdf: a, tip: t, gravity: -9.81}", "1:35", "three numbers [x, y, z]"},
      {1, "model: {urdf: a, tip: t, gravity: [0, -9.81]}", "1:35",
       "[0, -9.81]: must be a list of three numbers"},
      {1, "model: {urdf: a, tip: t, side_branches: keep}", "1:41", "must be lump or drop."},
      {1, "model: {urdf: a, tip: t, armature: [1, -2]}", "1:40", "model.armature[1] = -2: must be >= 0."},
      {1, "model: {urdf: a, tip: t, friction: {viscous: [1, 2], coulomb: [1]}}", "1:63",
       "has 1 entries, model.friction.viscous has 2"},
      {1, "model: {urdf: a, tip: t, friction: {coulomb: [1], coulomb_positive: [1]}}", "1:69",
       "this or coulomb, not both"},
      {1, "model: {urdf: a, tip: t, friction: {coulomb_positive: [1]}}", "1:36",
       "model.friction.coulomb_negative is missing"},
      {1, "model: {urdf: a, tip: t, friction: {coulomb: [-1]}}", "1:47", "must be >= 0: give the magnitude"},
      {1, "model: {urdf: a, tip: t, friction: {v_s: 0.1}}", "1:42", "nothing to smooth"},
      {1, "model: {urdf: a, tip: t, friction: {viscous: [1], v_s: 0}}", "1:56", "must be > 0"},
      {4, "plant: {payload: {mass: -1}}", "4:25", "plant.payload.mass = -1: must be >= 0."},
      {4, "plant: {payload: {inertia: [1, 2]}}", "4:28", "three rows of three, or [ixx,"},
      {4, "plant: {payload: {inertia: [[1, 0, 2], [0, 1, 0], [3, 0, 1]]}}", "4:28", "must be symmetric"},
      {4, "plant: {payload: {inertia: [1, 1, 1, 2, 0, 0]}}", "4:28", "no negative principal moment"},
      {4, "plant: {mass_scale: 0}", "4:21", "must be > 0: 1 leaves the masses"},
      {4, "plant: {tip_force: [1, 2, 3]}", "4:20", "six numbers, one for each of wx, wy, wz, vx, vy, vz"},
      {2, "initial: {q: []}", "2:14", "one number for each joint"},
      {2, "initial: {q: 0}", "2:14", "must be a list of numbers"},
      {2, "initial: {q: [0, .nan]}", "2:18", "initial.q[1] = .nan: must be a finite number."},
      {2, "initial: {q: [-.INF]}", "2:15", "must be a finite number."},
      {2, "initial: {q: [pi/2]}", "2:15", "initial.q[0] = pi/2: must be a number; write its value"},
      {2, "initial: {q: [+-1]}", "2:15", "must be a number"},
      {2, "initial: {q: [0x10]}", "2:15", "must be a number"},
      {2, "initial: {q: [1e400]}", "2:15", "does not fit in a double."},
      {2, "initial: {q: [[1]]}", "2:15", "initial.q[0] = [1]: must be one number."},
      {4, "reference: {type: cirle}", "4:19", "did you mean 'circle'?"},
      {4, "reference: {radius: 0.1}", "4:13", "it belongs to type circle, the type here is hold"},
      {4, "reference: {type: circle, offset: 1}", "4:27", "it belongs to type step or line"},
      {4, "reference: {type: circle, radius: 0}", "4:35", "reference.radius = 0: must be > 0"},
      {4, "reference: {type: circle, period: -2}", "4:35", "must be > 0"},
      {4, "reference: {type: circle, plane: xx}", "4:34", "must be xy, yx, yz, zy, zx or xz"},
      {4, "reference: {type: step, at: -1}", "4:29", "must be >= 0"},
      {4, "reference: {type: line, duration: 0}", "4:35", "use type step"},
      {4, "reference: {type: lissajous, period: 0}", "4:38", "must be > 0"},
      {4, "reference: {type: waypoints}", "4:12", "reference.file is missing"},
      {3, "controller: {law: osc}", "3:19", "must be operational_space, resolved_acceleration or free."},
      {3, "controller: {law: free, sampling: {period: 1}}", "3:35", "nothing to sample"},
      {3, "controller: {law: operational_space, sampling: {delay: both}}", "3:48",
       "sampling.period is missing"},
      {3, "controller: {law: operational_space, sampling: {period: 0}}", "3:57", "must be > 0"},
      {3, "controller: {law: operational_space, sampling: {period: 1, delay: bot}}", "3:67",
       "did you mean 'both'?"},
      {3, "controller: {law: operational_space, sampling: {period: 1, extrapolate: true}}", "3:73",
       "nothing to extrapolate"},
      {3, "controller: {law: operational_space, sampling: {period: 1, monitor_every: 2}}", "3:75",
       "use resolved_acceleration"},
      {3, "controller: {law: resolved_acceleration, sampling: {period: 1, delay: force}}", "3:71",
       "only operational_space has delayed forms"},
      {3, "controller: {law: resolved_acceleration, null_space: {damping: 1}}", "3:64", "has no null space"},
      {3, "controller: {law: free, orientation: rpy}", "3:38", "must be rotation_vector, roll_pitch_yaw"},
      {3, "controller: {law: free, position: polar}", "3:35", "must be cartesian, cylindrical or spherical"},
      {4, "base_motion: {type: step}", "4:14", "a base moves along type line"},
      {4, "base_motion: {type: circle, offset: 1}", "4:29", "unknown key 'base_motion.offset'"},
      {3, "controller: {law: free, rows: [vx, vq]}", "3:36", "controller.rows[1] = vq: must be wx,"},
      {3, "controller: {law: free, rows: [vx, vx]}", "3:36", "named twice"},
      {3, "controller: {law: free, rows: []}", "3:31", "at least one"},
      {3, "controller: {law: free, coordinates: poses}", "3:38", "did you mean 'pose'?"},
      {3, "controller: {law: free, gains: {damping: [1, 2]}}", "3:42", "one number, or a list of six"},
      {3, "controller: {law: free, null_space: {damping: -1}}", "3:47", "must be >= 0"},
      {4, "integrator: {atol: 0}", "4:20", "must be > 0"},
      {4, "integrator: {rtol: 1}", "4:20", "< 1"},
      {4, "integrator: {atol: {positon: 1}}", "4:21", "unknown key 'integrator.atol.positon'"},
      {4, "integrator: {max_steps: 0}", "4:25", "a whole number >= 1"},
      {4, "integrator: {max_steps: 1.5}", "4:25", "a whole number >= 1"},
      {4, "integrator: {method: euler}", "4:22", "must be adams or bdf."},
      {4, "duration:", "4:1", "duration = (nothing): must be one number."},
      {4, "output: {interval: 1e-9}", "4:20", "at most 1e8 instants"},
      {4, "verify: {every: 0}", "4:17", "a whole number >= 1"},
      {4, "verify: {every: steps}", "4:17", "must be step or a whole number >= 1."},
      {4, "verify: {record: none}", "4:18", "must be all, worst or a whole number >= 1."},
      {4, "expect: {fails: [lamda]}", "4:18", "did you mean 'lambda'?"},
      {4, "expect: {fails: omega}", "4:17", "must be a list of claims"},
      {4, "expect: {stop: crash}", "4:16", "must be singular, non_finite, step_too_small or too_many_steps"},
      {4, "verify: {<<: 3}", "4:10", "'<<' merges a map"},
      {4, "name: [1, 2", "4:1", "not valid YAML"},
      {4, "name: \"x", "4:9", "not valid YAML"},
      {4, "name: a: b", "4:8", "not valid YAML"},
      {4, "name: *none", "4:7", "not valid YAML"},
      {4, "name: x\n---\nname: y", "5:1", "a second document or value starts here"},
      {4, "name: \x04", "4:7", "control character (byte 4)"},
      {4, "verify: &v {every: *v}", "4:9", "an alias that contains itself"},
      {1, ", a", "1:1", "a value cannot start here"},
      {4, "? [a]\n: 1", "4:3", "a key must be one word"},
  }));
  Lines lines;
  (bad.line == 1   ? lines.model
   : bad.line == 2 ? lines.initial
   : bad.line == 3 ? lines.controller
                   : lines.more) = bad.text;
  const auto got = message_of(lines.text());
  INFO("input: " << bad.text << "\nmessage: " << got);
  CHECK(got.starts_with("reach.yaml:" + bad.place + ": "));
  CHECK(got.find(bad.fragment) != std::string::npos);
}

TEST_CASE("aliases cannot make an endless tree") {
  std::string text = "a: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const auto last = "*a" + std::to_string(i - 1);
    text += "b" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last;
    for (int j = 1; j < 8; ++j) text += ", " + last;
    text += "]\n";
  }
  CHECK(message_of(text).find("too many values") != std::string::npos);
}
