// Bad experiment files: every message has a place, a value and a remedy.
#include "experiment/config_support.hpp"
#include "support/catch.hpp"

namespace osculate::testing::config_messages_tests {

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
      {3, "controller: {law: osc}", "3:19",
       "must be operational_space, resolved_acceleration, free, operational_space_dense,"},
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
      {4, "integrator: {method: euler}", "4:22", "must be adams, bdf or runge_kutta."},
      {4, "duration:", "4:1", "duration = (nothing): must be one number."},
      {4, "output: {interval: 1e-9}", "4:20", "at most 1e8 instants"},
      {4, "output: {restart_interval: 1e-9}", "4:28", "more than 1e5 restart points"},
      {4, "output: {restart_interval: -1}", "4:28", "0 makes no restart points"},
      {4, "verify: {every: 0}", "4:17", "a whole number >= 1"},
      {4, "verify: {every: steps}", "4:17", "must be step or a whole number >= 1."},
      {4, "verify: {record: none}", "4:18", "must be all, worst or a whole number >= 1."},
      {4, "expect: {fails: [lamda]}", "4:18", "did you mean 'lambda'?"},
      {4, "expect: {fails: omega}", "4:17", "must be a list of claims"},
      {4, "expect: {stop: crash}", "4:16",
       "must be singular, non_finite, step_too_small, too_many_steps or law"},
      {4, "plant: {mass_scale: [1, 0]}", "4:25", "plant.mass_scale[1] = 0: must be > 0: 1 leaves"},
      {4, "plant: {inertia_scale: 0}", "4:24", "must be > 0: 1 leaves the inertias"},
      {4, "plant: {dynamics: sparse}", "4:19", "must be recursive or dense."},
      {4, "plant: {environment: {stiffness: 1}}", "4:22",
       "plant.environment.type is missing: give plane or ball."},
      {4, "plant: {environment: wall}", "4:22", "must be a map with the key type"},
      {4, "plant: {environment: {type: wall}}", "4:29", "must be plane or ball; did you mean 'ball'?"},
      {4, "plant: {environment: {type: plane, radius: 1}}", "4:36",
       "it belongs to type ball, the type here is plane"},
      {4, "plant: {environment: {type: plane, normal: [0, 0, 0]}}", "4:44",
       "must not be zero: it points out"},
      {4, "plant: {environment: {type: plane, point: [0, 0]}}", "4:43", "three numbers [x, y, z]"},
      {4, "plant: {environment: {type: ball, radius: 0}}", "4:43", "must be > 0"},
      {4, "plant: {environment: {type: ball, stiffness: 0}}", "4:46", "must be > 0"},
      {4, "plant: {environment: {type: ball, damping: -1}}", "4:44", "must be >= 0"},
      {4, "plant: {environment: {type: ball, friction: -1}}", "4:45", "must be >= 0: give the Coulomb"},
      {4, "plant: {environment: {type: ball, v_s: 0}}", "4:40", "must be > 0"},
      {4, "reference: {type: each_axis}", "4:12", "reference.amplitude is missing: give six jumps"},
      {4, "reference: {type: each_axis, amplitude: [0, 0, 0, 0, 0, 0]}", "4:41", "no axis to move"},
      {4, "reference: {type: each_axis, amplitude: [1, 0, 0, 0, 0, 0], period: 0}", "4:69", "must be > 0"},
      {4, "reference: {type: each_axis, amplitude: [1, 0, 0, 0, 0, 0], period: 1e-9}", "4:12",
       "at most 1e6 axes"},
      {4, "reference: {type: each_axis, row: vx}", "4:30", "it belongs to type multisine"},
      {4, "reference: {type: multisine, row: x}", "4:35", "reference.row = x: must be wx, wy,"},
      {4, "reference: {type: multisine, amplitude: [1]}", "4:41", "must be one number."},
      {4, "reference: {type: multisine, frequencies: []}", "4:43", "at least one frequency in Hz"},
      {4, "reference: {type: multisine, frequencies: 2}", "4:43", "must be a list of frequencies in Hz."},
      {4, "reference: {type: multisine, frequencies: [1, 0]}", "4:47",
       "reference.frequencies[1] = 0: must be > 0"},
      {4, "reference: {type: multisine, frequencies: [1, 2, 1]}", "4:50", "is given twice"},
      {4, "base_motion: {type: each_axis, amplitude: [1, 0, 0, 0, 0, 0]}", "4:14",
       "a base moves along type line"},
      {4, "base_motion: {type: multisine}", "4:14", "a base moves along type line"},
      {3, "controller: {law: gravity}", "3:19", "did you mean 'gravity_only'?"},
      {3, "controller: {law: free, feedforward: 1}", "3:38", "must be true or false."},
      {3, "controller: {law: free, null_space: {manipulability: 1}}", "3:54",
       "free has no null space: remove it"},
      {3, "controller: {law: resolved_acceleration, null_space: {limits: {gain: 1}}}", "3:63",
       "has no null space"},
      {3, "controller: {law: free, null_space: {posture: {stiffness: 1}}}", "3:47", "free has no null space"},
      {3, "controller: {law: no_coriolis, null_space: {posture: {q: [1]}}}", "3:54",
       "controller.null_space.posture.stiffness is missing"},
      {3, "controller: {law: no_coriolis, null_space: {posture: {stiffness: -1}}}", "3:66", "must be >= 0"},
      {3, "controller: {law: no_coriolis, null_space: {limits: {margin: 1}}}", "3:53",
       "controller.null_space.limits.gain is missing"},
      {3, "controller: {law: no_coriolis, null_space: {limits: {gain: 1, margin: 0}}}", "3:71",
       "must be > 0"},
      {3, "controller: {law: no_coriolis, null_space: {manipulability: -1}}", "3:61", "must be >= 0"},
      {3, "controller: {law: no_coriolis, impedance: {}}", "3:43", "controller.impedance.inertia is missing"},
      {3, "controller: {law: no_coriolis, impedance: {inertia: 0}}", "3:53", "must be > 0"},
      {3, "controller: {law: no_coriolis, impedance: {inertia: [1, 2]}}", "3:53",
       "one number, or a list of six"},
      {3, "controller: {law: no_coriolis, impedance: {inertia: 1}, orientation: quaternion}", "3:43",
       "works with orientation: rotation_vector and position: cartesian"},
      {3, "controller: {law: free, impedance: {inertia: 1}}", "3:36", "a free swing has no torque to shape"},
      {3, "controller: {law: no_coriolis, force: {desired: [1]}}", "3:39",
       "controller.force.rows is missing"},
      {3, "controller: {law: no_coriolis, force: {rows: [vz]}}", "3:39",
       "controller.force.desired is missing"},
      {3, "controller: {law: no_coriolis, rows: [vx], force: {rows: [vz], desired: [1]}}", "3:59",
       "controller.force.rows[0] = vz: is not a task row here: add it to controller.rows."},
      {3, "controller: {law: no_coriolis, force: {rows: [vz], desired: [1, 2]}}", "3:61", "which are 1."},
      {3, "controller: {law: no_coriolis, force: {rows: [vz], desired: [1], inertia: 0}}", "3:75",
       "must be > 0"},
      {3, "controller: {law: no_coriolis, force: {rows: [vz], desired: [1], damping: -1}}", "3:75",
       "must be >= 0"},
      {3, "controller: {law: no_coriolis, force: {rows: [vz], desired: [1]}}", "3:39",
       "set controller.compensate_tip_force: true."},
      {3, "controller: {law: free, compensate_tip_force: true, force: {rows: [vz], desired: [1]}}", "3:60",
       "a free swing has no torque to shape"},
      {3, "controller: {law: no_coriolis, obstacles: {radius: 1}}", "3:43", "a list of maps {centre, radius"},
      {3, "controller: {law: no_coriolis, obstacles: [{radius: 1}]}", "3:44",
       "controller.obstacles[0].centre is missing"},
      {3, "controller: {law: no_coriolis, obstacles: [{centre: [0, 0, 1], radius: 0}]}", "3:72",
       "must be > 0"},
      {3, "controller: {law: no_coriolis, obstacles: [{centre: [0, 0, 1], influence: 0}]}", "3:75",
       "controller.obstacles[0].influence = 0: must be > 0"},
      {3, "controller: {law: no_coriolis, obstacles: [{centre: [0, 0, 1], gain: -1}]}", "3:70",
       "must be >= 0"},
      {3, "controller: {law: free, obstacles: [{centre: [0, 0, 1]}]}", "3:36", "no torque to shape"},
      {3, "controller: {law: no_coriolis, singularity: {policy: dampd}}", "3:54", "did you mean 'damped'?"},
      {3, "controller: {law: no_coriolis, singularity: {policy: damped}}", "3:54", "use policy: none."},
      {3,
       "controller: {law: operational_space, sampling: {period: 1, delay: force}, singularity: {policy: "
       "released}}",
       "3:97", "only operational_space without delay"},
      {3, "controller: {law: free, singularity: {threshold: 1}}", "3:50", "must be > 0 and < 1"},
      {3, "controller: {law: free, singularity: {damping: 0}}", "3:48", "must be > 0"},
      {3, "controller: {law: no_coriolis, sensors: {resolution: 1e-4}}", "3:41",
       "give controller.sampling.period"},
      {3, "controller: {law: no_coriolis, sampling: {period: 1}, sensors: {resolution: -1}}", "3:77",
       "must be >= 0: 0 is exact"},
      {3, "controller: {law: no_coriolis, sampling: {period: 1}, sensors: {velocity_cutoff: -1}}", "3:82",
       "must be >= 0: 0 is exact"},
      {3, "controller: {law: no_coriolis, effort_limit: all}", "3:46",
       "must be none, model or a list of torques"},
      {3, "controller: {law: no_coriolis, effort_limit: [1, 0]}", "3:50",
       "controller.effort_limit[1] = 0: must be > 0"},
      {3, "controller: {law: free, effort_limit: model}", "3:39", "a free swing has no torque to shape"},
      {3, "controller: {law: no_coriolis, sampling: {period: 1, computation_time: 1}}", "3:72",
       "must be >= 0 and < 1: it must end before the next sample."},
      {3, "controller: {law: operational_space, sampling: {period: 1, delay: both, computation_time: 0.5}}",
       "3:91", "goes with delay: none only"},
      {4, "verify: {poles: 2}", "4:17", "must be true or false."},
      {4, "sweep: {key: duration}", "4:8", "sweep.values is missing"},
      {4, "sweep: {values: [1]}", "4:8", "sweep.key is missing"},
      {4, "sweep: {key: duration, values: 1}", "4:32", "must be a list of values of sweep.key."},
      {4, "sweep: {key: duration, values: []}", "4:32", "must have at least one value."},
      {4, "sweep: {key: initial.q, values: [[0, 1]]}", "4:34", "must be one number or word; give lists"},
      {4, "sweep: {key: duration, values: [1, 2, 1]}", "4:39", "is given twice: remove one."},
      {4, "sweep: {key: duration, values: [1], variants: {}}", "4:47", "this or key and values, not both"},
      {4, "sweep: {key: sweep.key, values: [duration]}", "4:14", "a sweep cannot change sweep"},
      {4, "sweep: {key: a..b, values: [1]}", "4:14", "sweep.key = a..b: must be a key path"},
      {4, "sweep: {key: a=b, values: [1]}", "4:14", "sweep.key = a=b: must be a key path"},
      {4, "sweep: {key: model.urdf, values: [../b.urdf]}", "4:35", "must not contain '/': name the variants"},
      {4, "sweep: {key: duration, values: ['']}", "4:33", "must not be empty"},
      {4, "sweep: {variants: []}", "4:19", "must be a map: {name: {key.path: value"},
      {4, "sweep: {variants: {}}", "4:19", "must have at least one variant"},
      {4, "sweep: {variants: {a/b: {}}}", "4:20", "must not contain '/'"},
      {4, "sweep: {variants: {a: 3}}", "4:23", "sweep.variants.a = 3: must be a map"},
      {4, "sweep: {variants: {a: {sweep: {}}}}", "4:24", "a sweep cannot change sweep"},
      {4, "sweep: {variants: {a: {x.: 1}}}", "4:24", "must be a key path"},
      {4, "sweep: {key: duration, values: [1, -1]}", "4:36",
       "duration = -1: must be > 0. (Variant -1 of sweep.)"},
      {4, "sweep: {key: durration, values: [1]}", "4:34", "did you mean 'duration'? (Variant 1 of sweep.)"},
      {4, "sweep: {variants: {fast: {}, slow: {duration: 2, initial.q.5: 1}}}", "4:63",
       "initial.q is a list of 2: '5' must be an index from 0 to 1. (Variant slow of sweep.)"},
      {4, "sweep: {variants: {a: {expect.fails: [lamda]}}}", "4:38",
       "did you mean 'lambda'? (Variant a of sweep.)"},
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

}  // namespace osculate::testing::config_messages_tests
