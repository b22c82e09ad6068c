"""The mutation matrix: which claim of which shipped experiment must catch each fault of src/scalar/fault.hpp.

    python3 tests/mutation/matrix.py docs/mutations.md

runs every fault in every experiment and writes the page. Environment, all optional: OSCULATE, OSCULATE_FAULTY (the
program and its copy with seedable faults), OSCULATE_SOURCE_DIR.
"""
import concurrent.futures
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(os.environ.get("OSCULATE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[2]))
PROGRAM = os.environ.get("OSCULATE", str(ROOT / "build" / "dev" / "osculate"))
FAULTY = os.environ.get("OSCULATE_FAULTY", str(ROOT / "build" / "dev" / "osculate_faulty"))

# Named in advance: fault, experiment, claims that must fail there.
NAMED = [
    # spatial types
    ("spatial_cross", "puma560_circle", "kinematics omega"),
    ("spatial_turn", "puma560_circle", "omega forward_dynamics"),
    ("shift_force", "puma560_circle", "torque forward_dynamics"),
    ("shift_motion", "puma560_circle", "kinematics g"),
    ("shift_inertia", "puma560_circle", "omega forward_dynamics"),
    ("shift_compliance", "puma560_circle", "omega"),
    ("frame_force", "puma560_sampled", "torque linearization"),       # link frames: sampled laws alone
    ("frame_motion", "puma560_sampled", "torque linearization"),
    ("strip_inertia", "puma560_circle", "omega forward_dynamics"),
    ("strip_compliance", "puma560_circle", "omega lambda"),
    ("joint_strip_inertia", "satellite_arm_reach", "omega forward_dynamics"),
    ("joint_strip_compliance", "satellite_arm_reach", "omega lambda"),
    ("tracking_damping", "puma560_roll_pitch_yaw", "coordinates"),
    ("tracking_reference", "arm7_quaternion_cylindrical", "coordinates"),
    ("psi_order", "puma560_circle", "c forward_dynamics"),
    ("psi_star_order", "puma560_circle", "g c_plus_g"),
    ("composite_inertia", "puma560_circle", "omega forward_dynamics"),
    ("compliance_not_stripped", "puma560_circle", "omega lambda"),
    ("joint_block", "mobile_arm_lissajous", "omega forward_dynamics"),   # needs a joint with more axes
    # placing the arm
    ("sense_of_rotation", "puma560_circle", "kinematics"),
    ("slide", "prismatic_arm_waypoints", "kinematics"),               # needs a sliding joint
    ("inertia_about_com", "puma560_circle", "omega forward_dynamics"),
    ("inertia_turned_back", "puma560_circle", "omega forward_dynamics"),
    ("first_moment_not_turned", "puma560_circle", "g forward_dynamics"),
    ("tip_not_turned", "arm7_lissajous", "kinematics"),               # the PUMA's tip lies at O(1)
    ("gravity_sign", "puma560_circle", "g forward_dynamics"),
    ("base_acceleration", "arm7_moving_base", "kinematics forward_dynamics"),
    ("planar_axes", "mobile_arm_lissajous", "kinematics"),
    ("spherical_axes", "satellite_arm_tumble", "kinematics"),         # turning in more than one axis at once
    # sweep 1
    ("velocity_joint", "puma560_circle", "kinematics"),
    ("bias_acceleration", "puma560_circle", "c kinematics"),
    ("bias_turn", "puma560_circle", "c kinematics"),
    ("outer_rate", "puma560_circle", "c kinematics"),
    ("coriolis_once", "prismatic_arm_waypoints", "c kinematics"),     # needs a sliding joint
    ("bias_force", "puma560_circle", "c forward_dynamics"),
    ("gyroscopic", "puma560_circle", "c forward_dynamics"),
    ("centrifugal", "puma560_circle", "c forward_dynamics"),
    ("inner_velocity", "puma560_circle", "c forward_dynamics"),
    ("tip_bias", "arm7_lissajous", "c kinematics"),                   # needs a tip away from O(1)
    # sweep 2
    ("articulated_mass", "puma560_circle", "omega forward_dynamics"),
    ("articulated_armature", "puma560_circle", "omega forward_dynamics"),
    ("armature_without_gain", "puma560_circle", "omega forward_dynamics"),
    ("stale_gain", "puma560_circle", "omega forward_dynamics"),
    ("known_torque", "arm7_lissajous", "torque forward_dynamics"),    # T0 of the null space
    ("bias_inertia", "puma560_circle", "c forward_dynamics"),
    ("articulated_force", "puma560_circle", "c forward_dynamics"),
    ("innovation", "puma560_circle", "c torque"),
    ("innovation_bias", "puma560_circle", "c torque"),
    ("tip_wrench", "puma560_tip_force", "torque forward_dynamics"),
    ("ground_in_every_link", "puma560_circle", "c_plus_g"),
    # sweep 3 and gravity
    ("compliance_joint", "puma560_circle", "omega"),
    ("compliance_bias", "puma560_circle", "c c_plus_g"),
    ("tip_right_side", "arm7_lissajous", "c torque"),                 # a(0) again
    ("tip_gravity", "puma560_circle", "c_plus_g torque"),
    ("printed_4_3", "puma560_circle", "c_plus_g torque"),
    ("gravity_tip", "puma560_circle", "g"),
    ("gravity_start", "puma560_circle", "g"),
    # sweep 4
    ("torque_shift", "puma560_circle", "torque"),
    ("torque_next_shift", "puma560_circle", "torque"),
    ("null_space_torque", "arm7_lissajous", "torque null_space"),
    # delayed forms
    ("velocity_too_old", "puma560_old_velocities", "torque"),
    ("extrapolated_velocity", "puma560_two_sweeps", "torque"),
    ("force_too_old", "puma560_old_force", "torque"),
    ("extrapolated_force", "puma560_two_sweeps", "torque"),
    ("sampled_wrench", "puma560_two_sweeps", "torque"),               # needs a known wrench
    # plant
    ("plant_innovation", "puma560_free_swing", "forward_dynamics energy"),
    ("plant_acceleration", "puma560_free_swing", "forward_dynamics energy"),
    ("plant_joint", "puma560_free_swing", "forward_dynamics kinematics"),
    ("plant_bias", "puma560_free_swing", "forward_dynamics kinematics"),
    ("plant_tip_bias", "arm7_lissajous", "kinematics linearization"),
    ("plant_wrench", "puma560_tip_force", "forward_dynamics energy"),
    ("plant_friction", "puma560_circle", "energy linearization"),     # needs friction
    ("contact_normal", "puma560_force", "energy"),
    ("contact_damping", "puma560_force", "energy"),
    ("contact_friction", "puma560_touch", "energy"),                  # needs friction
    ("rotor_energy", "puma560_circle", "energy"),                     # needs armature
    ("weight", "puma560_free_swing", "energy"),
    ("work", "puma560_circle", "energy"),
    # laws
    ("law_command", "puma560_circle", "torque linearization"),
    ("law_command", "puma560_resolved_acceleration", "torque linearization"),    # its second place
    ("force_feedback", "puma560_force", "force_response"),
    ("law_rows", "puma560_circle", "torque linearization"),
    ("reference_acceleration", "puma560_circle", "analytic_response"),
    ("law_damping", "puma560_circle", "analytic_response"),
    ("friction_compensation", "puma560_circle", "linearization analytic_response"),
    ("resolved_bias", "puma560_resolved_acceleration", "torque linearization"),
    ("resolved_force", "puma560_resolved_acceleration", "torque linearization"),
    ("resolved_armature", "puma560_resolved_acceleration", "torque linearization"),
    # coordinates
    ("coordinate_rate", "puma560_roll_pitch_yaw", "coordinates"),
    ("coordinate_map", "puma560_roll_pitch_yaw", "coordinates"),
    ("coordinate_map", "arm7_quaternion_cylindrical", "coordinates"),
    ("coordinate_map", "arm7_zyz_spherical", "coordinates"),
]

# Faults that change nothing that a claim could see, with the proof.
EQUIVALENT = {}

SHORT = 0.05              # s, simulated, where a fault is seeded: sampled laws take 13 samples
LONGER = {"puma560_force": 0.26, "puma560_touch": 1.0}    # s: until the tip has touched
WHOLE = {"puma560_singular", "puma560_gimbal_lock",    # they are expected to stop, which takes their time
         "planar_2r_line"}                             # rests at first
MAX_STEPS = 5000          # no faulty run goes on for ever


@dataclasses.dataclass
class Fault:
    name: str
    group: str
    wrong: str


@dataclasses.dataclass
class Outcome:
    code: int
    failed: list       # claims that fail, in the verdict's order
    executed: int      # how often the faulty line ran
    text: str


def faults():
    """The faults of fault.hpp, in order."""
    text = (ROOT / "src" / "scalar" / "fault.hpp").read_text()
    body = text[text.index("enum class Fault {"):]
    group, out = "", []
    for line in body[:body.index("};")].splitlines()[1:]:
        if comment := re.fullmatch(r"\s*// (.*)", line):
            group = comment[1]
        elif entry := re.fullmatch(r"\s*(\w+),(?:\s*// (.*))?", line):
            if entry[1] != "none":
                out.append(Fault(entry[1], group, entry[2] or ""))
        else:
            raise ValueError(f"fault.hpp: not understood: {line}")
    return out


def places(fault):
    """(file, "sign" or "line") wherever the fault is seeded: `seeded` negates a value, `faulty` takes another line."""
    out = []
    for file in sorted((ROOT / "src").rglob("*.[ch]pp")):
        if file.name == "fault.hpp":
            continue
        for call in re.findall(r"(\w+)\(Fault::" + fault + r"\b", file.read_text()):
            out.append((file.relative_to(ROOT).as_posix(), "line" if call == "faulty" else "sign"))
    return out


def experiments():
    """The shipped experiments that some fault is named for, and the two that are expected to stop."""
    return sorted({experiment for _, experiment, _ in NAMED} | (WHOLE & {"puma560_singular", "puma560_gimbal_lock"}))


def run(program, experiment, fault="", short=True):
    """`osculate run` on a shipped experiment; nothing but its length and the guard on its steps is changed."""
    environment = {key: value for key, value in os.environ.items() if key != "OSCULATE_FAULT"}
    if fault:
        environment["OSCULATE_FAULT"] = fault
    settings = ["--set", f"integrator.max_steps={MAX_STEPS}"] if short else []
    if short and experiment not in WHOLE:
        settings += ["--set", f"duration={LONGER.get(experiment, SHORT)}"]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, "run", "--quiet", str(ROOT / "experiments" / f"{experiment}.yaml"),
                               "-o", str(pathlib.Path(folder) / "out.h5"), *settings],
                              capture_output=True, text=True, env=environment, timeout=120)
    failed = [line.split()[0] for line in done.stdout.splitlines() if "  FAIL" in line]
    counted = re.search(rf"^fault {fault} executed (\d+) times$", done.stderr, re.MULTILINE)
    return Outcome(done.returncode, failed, int(counted[1]) if counted else 0, done.stdout + done.stderr)


def run_all(jobs):
    """Outcomes of several run(*job), in order, two at a time."""
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        return list(pool.map(lambda job: run(*job), jobs))


def complaint(outcome, claims):
    """Why this is not the catch that was named, or ""."""
    if outcome.executed == 0:
        return "the faulty line was not executed"
    if outcome.code != 1:
        return f"exit code {outcome.code} instead of 1"
    missing = set(claims.split()) - set(outcome.failed)
    return f"no failure of {' '.join(sorted(missing))}" if missing else ""


INTRODUCTION = """# Mutation matrix

Made by `./dev mutations`, which runs every fault in every experiment that a fault is named for, and fails if one is not
caught as named.

**A fault** is one wrong sign or one wrong line in a recursion, a law, a delay, a coordinate map or the plant. It has a name
in `src/scalar/fault.hpp` and is seeded by it: `seeded(Fault::weight, x)` is `-x` while that fault is active and `x`
otherwise; `if (faulty(Fault::psi_order))` takes the wrong line. In the real program `seeded` returns its argument and
`faulty` is the constant `false`, so nothing is left of either. The copy `osculate_faulty`, built from the same sources,
reads the name of one fault from `OSCULATE_FAULT` and counts how often it was executed:

```
OSCULATE_FAULT=weight build/dev/osculate_faulty run experiments/puma560_free_swing.yaml --set duration={short} -o fault.h5
```

**Caught** means: `osculate run` ends with exit code 1, the claims named below fail, and the count is not zero. Experiment
and claims are named in advance in `tests/mutation/matrix.py`. Experiments are shortened to {short} s
({whole}: in full; {longer}) and otherwise as shipped.
Without a fault, program and copy pass {passing} of these {experiments} experiments in full. The bounds that the faults exceed are
those of [bounds.md](bounds.md), measured over 100000 random states.
"""

BY_EXPERIMENT = """\
x: caught. o: executed, not caught. Empty: not executed. An experiment overlooks a fault where the faulty term is
zero (no sliding joint, no friction, no armature, no gravity, no null-space torque, the PUMA's tip at O(1), a base at rest,
turning in one plane), where the law does not use it, and where the claim that would see it does not apply (energy on a
moving base; analytic_response under a sampled law, an unknown payload or coordinates of its own), or decides nothing
because the run fell apart and its own global error grew with it (`law_damping`; exit code 3)."""


def seen(outcome):
    """The fault was executed and some claim failed."""
    return outcome.executed > 0 and outcome.code == 1 and bool(outcome.failed)


def unseen_faults(found, results):
    """Faults that no experiment catches and nobody has proven equivalent."""
    return [fault.name for fault in found
            if fault.name not in EQUIVALENT and not any(map(seen, results[fault.name].values()))]


def page(found, results, passing):
    """The page, from faults and their outcomes: results[fault][experiment].
    passing: how many experiments pass without a fault."""
    names = experiments()
    caught = sum(not complaint(results[fault][experiment], claims) for fault, experiment, claims in NAMED)
    longer = ", ".join(f"{name}: {duration} s" for name, duration in sorted(LONGER.items()))
    lines = INTRODUCTION.format(short=SHORT, longer=longer, whole=", ".join(sorted(WHOLE)), passing=passing,
                                experiments=len(names)).splitlines()
    named = {fault for fault, _, _ in NAMED}
    lines += ["", f"{len(named)} faults, {len(NAMED)} named catches, {caught} of them as named.", "",
              "## Fault by claim", "",
              "In bold the claims named in advance. *sign*: the term has the wrong sign; *line*: the line is wrong as told.",
              "",
              "| fault | what is wrong | seeded in | experiment | executed | claims that caught it |",
              "|---|---|---|---|---|---|"]
    for fault in found:
        seeded = places(fault.name)
        files = ", ".join(sorted({f"`{file.removeprefix('src/')}`" for file, _ in seeded}))
        kind = "/".join(sorted({kind for _, kind in seeded}))
        for name, experiment, claims in NAMED:
            if name != fault.name:
                continue
            outcome = results[name][experiment]
            failed = " ".join(f"**{claim}**" if claim in claims.split() else claim for claim in outcome.failed)
            if problem := complaint(outcome, claims):
                failed = f"NOT AS NAMED: {problem}"
            lines.append(f"| `{name}` | {fault.group}; {kind}: {fault.wrong} | {files} | {experiment} | "
                         f"{'yes' if outcome.executed else 'no'} | {failed} |")
    lines += ["", "## Fault by experiment", ""] + BY_EXPERIMENT.splitlines() + [""]
    lines += [f"{number}. {name}" for number, name in enumerate(names, 1)]
    lines += ["", "| fault | " + " | ".join(str(number) for number in range(1, len(names) + 1)) + " |",
              "|---|" + "---|" * len(names)]
    for fault in found:
        row = results[fault.name]
        marks = ["x" if seen(row[name]) else "o" if row[name].executed else "" for name in names]
        lines.append(f"| `{fault.name}` | " + " | ".join(marks) + " |")
    lines += ["", "## Equivalent faults", ""]
    proofs = [f"- `{name}`: {proof}" for name, proof in EQUIVALENT.items()]
    lines += proofs or ["None: each fault changes what some claim says."]
    if unseen := unseen_faults(found, results):
        lines += ["", f"NOT AS NAMED: caught nowhere, and not proven equivalent: {', '.join(unseen)}."]
    return "\n".join(lines) + "\n"


def main(output):
    found, names = faults(), experiments()
    trouble = []
    whole = [(program, name, "", False) for program in (PROGRAM, FAULTY) for name in names]
    failing = set()
    for job, outcome in zip(whole, run_all(whole)):
        if outcome.code != 0:
            failing.add(job[1])
            trouble.append(f"{job[0]} {job[1]}: exit code {outcome.code} without a fault\n{outcome.text}")
    jobs = [(FAULTY, name, fault.name) for fault in found for name in names]
    results = {fault.name: {} for fault in found}
    for (_, name, fault), outcome in zip(jobs, run_all(jobs)):
        results[fault][name] = outcome
    for fault, experiment, claims in NAMED:
        if problem := complaint(results[fault][experiment], claims):
            trouble.append(f"{fault} in {experiment}: {problem}; failed: {' '.join(results[fault][experiment].failed)}")
    trouble += [f"{name}: caught nowhere" for name in unseen_faults(found, results)]
    trouble += [f"{fault.name}: not in the table" for fault in found if fault.name not in {name for name, _, _ in NAMED}
                and fault.name not in EQUIVALENT]
    pathlib.Path(output).write_text(page(found, results, len(names) - len(failing)))
    named = {fault for fault, _, _ in NAMED}
    print("\n".join(trouble + [f"{len(named)} faults, {len(NAMED)} named catches, {len(trouble)} complaints: {output}"]))
    return 1 if trouble else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
