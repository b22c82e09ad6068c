"""Commonly used operational space control implementations as laws of osculate: what `osculate judge` finds missing in
each, and what that costs.

    zoo.py                       judge's findings equal the truth of this table; the page has the rows of this table
    zoo.py --write docs/zoo.md   all measurements, and the page
    zoo.py --law                 franka_ros' law as a controller of one's own, see docs/your-controller.md

Environment: OSCULATE, the program; OSCULATE_SOURCE_DIR, the source tree.
"""
import argparse
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

OSCULATE = os.environ.get("OSCULATE", "osculate")
SOURCE = pathlib.Path(os.environ.get("OSCULATE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[2]))
EXPERIMENTS = SOURCE / "experiments"


OWN = "zoo.py --law"  # a law that osculate has not: it runs as a controller of one's own


@dataclasses.dataclass(frozen=True)
class Implementation:
    name: str
    source: str  # what was read, and which state of it
    equation: str  # its torque; u is what it asks of the tip
    law: str  # of osculate, with that equation, or OWN
    omits: frozenset  # ids of `osculate judge`: by its equation, on an arm with six joints
    feedforward: bool  # whether velocity and acceleration of a reference are part of its u
    note: str  # what its equation is meant for, and what of the code is not in the law
    singular: str  # what its code does near a singularity
    null_space: str  # "consistent", "kinematic" or "" where its equation has none
    motion: bool = True  # False: of interest for its null space only


def implementation(name, omits="", **keys):
    return Implementation(name=name, omits=frozenset(omits.split()), **keys)


ZOO = [
    implementation(
        "Khatib 1987", law="operational_space_dense", feedforward=True,
        source="A unified approach for motion and force control of robot manipulators, IEEE J. Robotics and "
               "Automation 3(1)",
        equation="J\\* (Λ u + μ + p) + (1 − J\\* Λ J M⁻¹) T0",
        note="The complete law. μ contains −Λ J̇ q̇ and the tip's part of C.",
        singular="outside this equation", null_space="consistent"),
    implementation(
        "Kreutz-Delgado, Jain and Rodriguez 1992", law="operational_space_dense", feedforward=True,
        source="equation (16) of the paper that osculate implements; the recursions of `operational_space` give the "
               "same torque",
        equation="J\\* Λ (u + J M⁻¹ (C + G − T0) − J̇ q̇) + T0",
        note="The complete law.",
        singular="outside this equation", null_space="consistent"),
    implementation(
        "Nakanishi et al. 2008, simplified acceleration control", law="pseudo_inverse", feedforward=True,
        source="Operational space control: a theoretical and empirical comparison, Int. J. Robotics Research 27(6); the "
               "variant without M before the null-space term",
        equation="M J⁺ (u − J̇ q̇) + C + G + (1 − J⁺ J) T0",
        note="Complete for the tip of an arm without redundancy. One of the variants that the article compares; others of it "
             "have M in the null space.",
        singular="outside this equation", null_space="kinematic"),
    implementation(
        "robosuite, as it comes", law="block_inertia", feedforward=False, omits="uncoupled_lambda jdot_qd",
        source="robosuite: controllers/parts/arm/osc.py at 1063bbdd, controllers/parts/controller.py at 202ccfa1, "
               "utils/control_utils.py at 0354d163; `uncouple_pos_ori=True`",
        equation="J\\* diag(Λ_v, Λ_w) u + C + G + (1 − J\\* Λ J M⁻¹) T0",
        note="u = K e − D v: goals that stand still between actions of a policy. C + G is MuJoCo's `qfrc_bias`.",
        singular="singular values of the blocks of Λ⁻¹ below 2.5e-4 are left out", null_space="consistent"),
    implementation(
        "robosuite, coupled", law="no_jdot_qd", feedforward=False, omits="jdot_qd",
        source="the same files; `uncouple_pos_ori=False`",
        equation="J\\* Λ u + C + G + (1 − J\\* Λ J M⁻¹) T0",
        note="As above.",
        singular="plain inverse of Λ⁻¹", null_space="consistent"),
    implementation(
        "SAI primitives", law="gravity_only", feedforward=True, omits="jdot_qd coriolis",
        source="sai-primitives: MotionForceTask.cpp at 091394bf, .h at 03427fc6, RobotController.cpp at 1e1e59b3; "
               "gravity compensation on, full dynamic decoupling",
        equation="J\\* Λ u + G + (1 − J\\* Λ J M⁻¹) T0",
        note="As it comes, gravity compensation is off, small entries of the inertia are raised on purpose "
             "(`BOUNDED_INERTIA_ESTIMATES`) and a generator limits the goal to 0.3 m/s: none of this is in the law.",
        singular="a singularity handler: it classifies the lost directions and blends them out", null_space="consistent"),
    implementation(
        "abr_control, as it comes", law="gravity_only", feedforward=False, omits="jdot_qd coriolis",
        source="abr_control/controllers/osc.py after pull request 28; `use_g=True, use_C=False`",
        equation="J\\* Λ u + G + (1 − J\\* Λ J M⁻¹) T0",
        note="u = K e − D v; the damping is −D M q̇ in joint space, which the tip feels as −D v. As it comes it controls the "
             "three positions; here all six rows.",
        singular="pseudo-inverse where abs(det Λ⁻¹) < 1e-3", null_space="consistent"),
    implementation(
        "abr_control, use_C", law="no_jdot_qd", feedforward=False, omits="jdot_qd",
        source="the same file; `use_C=True`",
        equation="J\\* Λ u + C + G + (1 − J\\* Λ J M⁻¹) T0",
        note="As above. Earlier versions had an option `use_dJ` for J̇ q̇.",
        singular="the same", null_space="consistent"),
    implementation(
        "mjctrl", law="no_jdot_qd", feedforward=False, omits="jdot_qd",
        source="opspace.py at f1526415",
        equation="J\\* Λ u + C + G + (1 − J\\* Λ J M⁻¹) T0",
        note="u = K e − D v: an example that follows a target moved by hand. What it adds as gravity compensation is MuJoCo's "
             "`qfrc_bias`, C + G.",
        singular="pseudo-inverse with cut 1e-2 where abs(det Λ⁻¹) < 1e-2", null_space="consistent"),
    implementation(
        "Isaac Lab", law="gravity_only", feedforward=False, omits="jdot_qd coriolis",
        source="isaaclab/controllers/operational_space.py at 005bd5b2, operational_space_cfg.py at 0b12dfac (2026); "
               "`inertial_dynamics_decoupling=True, gravity_compensation=True`",
        equation="J\\* Λ u + G + (1 − J\\* Λ J M⁻¹) T0",
        note="u = K e − D v. As it comes both options are off; the torque is then J\\* u. At this "
             "commit it calls Newton's controller.",
        singular="pull request 7903 (2026) damps the inverse of Λ⁻¹", null_space="consistent"),
    implementation(
        "Newton", law="gravity_only", feedforward=False, omits="jdot_qd coriolis",
        source="newton: controllers/impl/operational_space/model_free.py at 061a2295 (2026); "
               "`use_inertia_decoupling=True, use_gravity_compensation=True`",
        equation="J\\* Λ u + G + (1 − J\\* Λ J M⁻¹) T0",
        note="u = K e + D (velocity error). What its caller supplies as gravity force is taken to be G.",
        singular="not looked at", null_space="consistent"),
    implementation(
        "franka_ros, Cartesian impedance example", law=OWN, feedforward=False, omits="constant_lambda jdot_qd",
        source="franka_example_controllers/src/cartesian_impedance_example_controller.cpp at 03a014dd (2017)",
        equation="J\\* (K e − D v) + C + (1 − J\\* (J\\*)⁺) T0",
        note="Impedance control without Λ, by design: e is meant to stay where the surroundings press. The robot adds G "
             "itself; here the law does. K and D are the gains times 0.5, 0.2, 0.1 kg m² and 11, 15, 21 kg. The projector of "
             "the code has a damped pseudo-inverse (0.2), the law an exact one.",
        singular="nothing is inverted but in the projector, damped", null_space="kinematic"),
    implementation(
        "franka_ros, its projector in the complete law", law="kinematic_null_space", feedforward=True, motion=False,
        source="the same file",
        equation="J\\* Λ (u + J M⁻¹ (C + G) − J̇ q̇) + (1 − J\\* (J\\*)⁺) T0",
        note="What the projector alone does. Khatib 1987 says why the tip feels it.",
        singular="", null_space="kinematic"),
    implementation(
        "Siciliano et al. 2009, PD control with gravity compensation", law="jacobian_transpose", feedforward=False,
        omits="constant_lambda jdot_qd coriolis",
        source="Robotics, chapter 8, operational space control; Takegaki and Arimoto 1981",
        equation="J\\* (K e − D v) + G",
        note="Made for goals that stand still, where it is stable without any model but G. K and D are the gains times the "
             "diagonal of Λ at the start.",
        singular="nothing is inverted", null_space=""),
]

NOT_IN = [
    ("DART, examples/operational_space_control", "M (J⁺ K ė + (J̇)⁺ K e) + C + G + D J⁺ K e with damped pseudo-inverses, at "
     "001a70aa: no law of osculate has this form, and no set of candidates of `judge` is its truth."),
    ("roboticstoolbox-python", "It offers Λ, μ and p as functions (`inertia_x`, `coriolis_x`, `gravload_x`), not a controller. "
     "Compare those with `osculate terms` or `osculate reference`."),
]

# Circle of 0.1 m: period in s, and how the arm moves on it at the start, from puma560_missing_terms.yaml.
PERIODS = {"slow": 4.0, "medium": 2.0, "fast": 0.8}
START_QD = np.array([0, 1.74799587, -0.35898377, 0, -1.3890121, 0]) * 0.8  # rad, times 1 / period
AXIS = 5.0  # s: time of one axis of the cross-coupling, long enough for it to come back
SETTLED = 2.0  # s; what the start left is by then below 1e-7 of itself: gains 100 and 20 have the time constant 0.1 s
COMPLETE = "operational_space_dense"
LAG = "(16) without feed-forward, to compare with"
INVERTS_NOTHING = ("jacobian_transpose", OWN)
NULL_SPACE = {"kinematic": frozenset(["kinematic_damping"]), "consistent": frozenset(), "": frozenset()}


class Runs:
    """Runs and judges each law once."""

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)

    def run(self, name, experiment, settings):
        path = self.directory / f"{name.replace(OWN, 'own')}.h5"
        command = [OSCULATE, "run", EXPERIMENTS / experiment, "--quiet", "-o", path]
        if settings["controller.law"] == OWN:
            program = json.dumps([sys.executable, str(pathlib.Path(__file__).resolve()), "--law"])
            settings = {**settings, "controller.law": f"{{process: {program}, terms: true}}"}
        for key, value in {"verify.shadow": "false", **settings}.items():
            command += ["--set", f"{key}={value}"]
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        if not path.exists():
            raise RuntimeError(f"{name}: {done.stderr}")
        return path

    def judge(self, path):
        done = subprocess.run([OSCULATE, "judge", path, "--json"], capture_output=True, text=True, timeout=120)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{path}: {done.stderr}")
        return json.loads(done.stdout)

    def circle(self, law, feedforward, speed, turns=1):
        """The last `turns` turns are settled."""
        period = PERIODS[speed]
        return self.run(f"{law}-{feedforward}-{speed}", "puma560_missing_terms.yaml", {
            "sweep": "{}", "controller.law": law, "controller.feedforward": str(feedforward).lower(),
            "reference.period": period, "initial.qd": list(START_QD / period), "duration": SETTLED + turns * period})

    def each_axis(self, law):
        return self.run(f"{law}-axes", "puma560_each_axis.yaml", {
            "controller.law": law, "reference.period": AXIS, "duration": 6 * AXIS - 0.5})

    def wrist(self, law, feedforward):
        threshold = "1e-15" if law in INVERTS_NOTHING else "1e-6"
        return self.run(f"{law}-{feedforward}-wrist", "puma560_wrist_near.yaml", {
            "sweep": "{}", "controller.law": law, "controller.feedforward": str(feedforward).lower(),
            "controller.singularity": f"{{threshold: {threshold}}}", "controller.null_space": "{damping: 0}"})

    def damped_arm7(self, law, feedforward):
        return self.run(f"{law}-{feedforward}-arm7", "arm7_missing_terms.yaml", {
            "sweep": "{}", "controller.law": law, "controller.feedforward": str(feedforward).lower()})

    def posture(self, law):
        """At rest, no gravity: all that moves the arm is a posture torque on its joints 1 to 4."""
        return self.run(f"{law}-posture", "arm7_posture.yaml", {
            "controller.law": law, "reference": "{type: hold}", "model.gravity": "[0, 0, 0]", "duration": 3,
            "controller.null_space": "{damping: 0.5, posture: {stiffness: 1, q: [0.8, 0.1, 0.7, 1.6, 0.1, 0.8, 0.2]}}"})


def lengths(vectors):
    """Of the linear and of the angular half: mm and mrad."""
    return 1e3 * np.linalg.norm(vectors[:, 3:], axis=1), 1e3 * np.linalg.norm(vectors[:, :3], axis=1)


def tip_error(path):
    with h5py.File(path) as f:
        after = f["time"][:] >= SETTLED - 1e-9
        return [x.max() for x in lengths(f["trajectory/pose_error"][:][after])]


def apart(path, other):
    """Largest distance of two tips at the same times, mm."""
    with h5py.File(path) as f, h5py.File(other) as g:
        assert np.array_equal(f["time"][:], g["time"][:])
        after = f["time"][:] >= SETTLED - 1e-9
        a, b = (h["trajectory/tip_position"][:][after] for h in (f, g))
    return 1e3 * np.linalg.norm(a - b, axis=1).max()


def cross_coupling(path):
    """Largest motion about or along an axis while another one is commanded alone, mrad and mm. The closed form of such an
    axis is 0, so this is the largest off-diagonal entry of measured/cross_coupling, which only runs with a closed form have."""
    turned, slid = 0.0, 0.0
    with h5py.File(path) as f:
        axis = np.minimum(f["time"][:] // AXIS, 5).astype(int)
        error = np.abs(f["trajectory/pose_error"][:])
        assert f.attrs["status"] == "complete"
    for commanded in range(6):
        others = np.delete(error[axis == commanded].max(axis=0), commanded)
        split = 3 if commanded >= 3 else 2
        turned, slid = max(turned, others[:split].max()), max(slid, others[split:].max())
    return 1e3 * turned, 1e3 * slid


def singular(path):
    with h5py.File(path) as f:
        peak = f["measured/joint_torque_peak"][:]
        end = f["time"][-1] if f.attrs["status"] != "complete" else None
        return end, peak.max(), int(peak.argmax()) + 1, 1e3 * float(f["measured/orientation_error"][()])


def leak(path):
    with h5py.File(path) as f:
        acceleration = f["trajectory/tip_acceleration"][0]
        linear, angular = lengths(f["trajectory/pose_error"][:])
        assert f.attrs["status"] == "complete", path
    return np.linalg.norm(acceleration[3:]), np.linalg.norm(acceleration[:3]), linear.max(), angular.max()


def number(x, floor=1e-6):
    """Two digits and more; "0" is below 1e-6."""
    if x < floor:
        return "0"
    return f"{x:.0f}" if x >= 100 else f"{x:.3g}" if x >= 1 else f"{x:.2g}"


def terms(ids):
    return ", ".join(f"`{i}`" for i in sorted(ids)) or "nothing"


class Mismatches(list):
    def compare(self, name, found, truth):
        ids = {finding["term"] for finding in found["findings"]}
        if ids != truth:
            self.append(f"{name}: judge finds {sorted(ids)}, the truth is {sorted(truth)}")
        if found["verdict"] != ("wrong" if truth else "right"):
            self.append(f"{name}: verdict {found['verdict']}")
        self.extend(f"{name}: in doubt: {doubt}" for doubt in found["doubts"])
        for finding in found["findings"]:
            value = finding["coefficients"][0]["value"]
            if finding["term"] in ("jdot_qd", "coriolis") and abs(value + 1) > 1e-3:
                self.append(f"{name}: coefficient of {finding['term']} is {value}, the truth is -1")
        return ids


def distinct(key):
    """Each law with its options once, with one implementation that has it."""
    return list({key(i): i for i in reversed(ZOO)}.items())[::-1]


def static_cells(i):
    """What the page says of an implementation without a measurement."""
    return [i.name, i.equation, f"`{i.law}`", "yes" if i.feedforward else "no", i.source]


def page_rows(text):
    for line in text.splitlines():
        cells = [c.strip() for c in line.strip().strip("|").split(" | ")]
        if line.startswith("| ") and not line.startswith("| implementation"):
            yield cells


def check(runs, page):
    mismatches = Mismatches()

    def arm6(item):
        (law, feedforward), i = item
        return i, runs.judge(runs.circle(law, feedforward, "medium", turns=0))

    def arm7(item):
        (law, feedforward), i = item
        return i, runs.judge(runs.damped_arm7(law, feedforward))

    both = distinct(lambda i: (i.law, i.feedforward))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        six = pool.map(arm6, [x for x in both if x[1].motion])
        seven = pool.map(arm7, [x for x in both if x[1].null_space == "kinematic" and x[1].law != OWN])  # OWN: 10 s
        for i, found in six:
            mismatches.compare(f"{i.law}, feedforward {i.feedforward}", found, i.omits)
        for i, found in seven:
            mismatches.compare(f"{i.law} on arm7", found, i.omits | NULL_SPACE[i.null_space])
    names = {i.name for i in ZOO}
    text = page.read_text()
    for cells in page_rows(text):
        if cells[0] not in names | {LAG}:
            mismatches.append(f"{page.name}: '{cells[0]}' is not in the table of zoo.py")
    for i in ZOO:
        if not any(cells == static_cells(i) for cells in page_rows(text)):
            mismatches.append(f"{page.name}: no row as in zoo.py for '{i.name}'; write it again")
        row = [cells for cells in page_rows(text) if cells[0] == i.name and len(cells) > 2 and cells[1] == f"`{i.law}`"]
        if i.motion and not any(cells[2] == terms(i.omits) for cells in row):
            mismatches.append(f"{page.name}: '{i.name}' does not omit {terms(i.omits)}; write it again")
    for note, _ in NOT_IN:
        if note not in text:
            mismatches.append(f"{page.name}: '{note}' is missing")
    return mismatches


HEAD = """\
# The zoo of laws

Made by `tests/judge/zoo.py --write docs/zoo.md`. Commonly used implementations of operational space control, each by the
law of osculate that has its equation ([laws.md](laws.md)): which terms of (16) it omits, and what that costs on a given
motion.

These are the equations, not the programs: no sampling, no filters, no saturation, exact models, the same gains for all
(stiffness 100 1/s², damping 20 1/s), friction of the model compensated by all. Each is as its source stood at the time
named there ("at" is the beginning of a commit), not as of today. Leaving out velocity terms is a decision, and for slow
motion, goals that stand still, or contact often the right one: they are small there and take a good model. The tables say
how small; a 0 in them is below 1e-6 of its unit.

## What they are

Feed-forward: whether velocity and acceleration of the reference are part of u. Without it u = K e − D v.

"""


def write(runs, page):
    mismatches = Mismatches()
    jobs, laws = {}, distinct(lambda i: (i.law, i.feedforward))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for law, feedforward in sorted({k for k, i in laws if i.motion} | {(COMPLETE, True), (COMPLETE, False)}):
            for speed in PERIODS:
                jobs["circle", law, feedforward, speed] = pool.submit(runs.circle, law, feedforward, speed)
            jobs["wrist", law, feedforward] = pool.submit(runs.wrist, law, feedforward)
        for law in sorted({i.law for i in ZOO if i.motion}):
            jobs["axes", law] = pool.submit(runs.each_axis, law)
        for law, feedforward in sorted(k for k, i in laws if i.null_space):
            jobs["arm7", law, feedforward] = pool.submit(runs.damped_arm7, law, feedforward)
        for law in sorted({i.law for i in ZOO if i.null_space} | {"jacobian_transpose"}):
            jobs["posture", law] = pool.submit(runs.posture, law)
        paths = {k: job.result() for k, job in jobs.items()}
        judged = dict(zip(paths, pool.map(
            lambda k: runs.judge(paths[k]) if k[0] == "arm7" or k[-1] == "medium" else None, paths)))

    out = [HEAD]

    def table(head, rows):
        out.append("| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|\n")
        out.extend("| " + " | ".join(row) + " |\n" for row in rows)

    table(["implementation", "T", "law", "feed-forward", "source"], [static_cells(i) for i in ZOO])
    out.append("\nWhat to know of them:\n\n")
    out.extend(f"- {i.name}: {i.note}\n" for i in ZOO)
    out.append("\nNot in the zoo:\n\n")
    out.extend(f"- {name}: {why}\n" for name, why in NOT_IN)

    out.append("""
## What is missing, and what it costs on a circle

A [PUMA 560](../experiments/puma560_missing_terms.yaml), radius 0.1 m, orientation held, started on the circle at its speed;
periods of 4, 2 and 0.8 s, that is 0.16, 0.31 and 0.79 m/s. The terms are those that `osculate judge` finds in the log of
the medium circle ([judge.md](judge.md)); they equal what the equation omits, or this page is not written. The error is the
largest distance of the tip from the reference over the last turn, 2 s and more after the start. Without feed-forward most
of it is the lag of K e − D v, which the complete law has too; "of it" is the largest distance from where the tip of the
complete law is, with the same feed-forward or none: what the missing terms alone do. All in mm.

""")
    lag = dataclasses.replace(ZOO[1], name=LAG, feedforward=False, singular="")
    moving = [*(i for i in ZOO if i.motion), lag]
    rows = []
    for i in moving:
        key = (i.law, i.feedforward)
        found = mismatches.compare(i.name, judged["circle", *key, "medium"], i.omits)
        cells = [i.name, f"`{i.law}`", terms(found)]
        for speed in PERIODS:
            path, complete = paths["circle", *key, speed], paths["circle", COMPLETE, i.feedforward, speed]
            with h5py.File(path) as f:
                assert f.attrs["status"] == "complete", path
            cells += [number(tip_error(path)[0]), number(apart(path, complete)) if i.law != COMPLETE else "0"]
        rows.append(cells)
    table(["implementation", "law", "omits", "slow", "of it", "medium", "of it", "fast", "of it"], rows)
    out.append("""
Leaving out both velocity terms costs less here than leaving out J̇ q̇ alone: they partly cancel.

## Cross-coupling

The reference jumps along one axis after the other, by 0.05 rad or 0.02 m, as in
[puma560_each_axis](../experiments/puma560_each_axis.yaml): the largest motion about and along the five axes that were not
commanded. Feed-forward makes no difference here.

""")
    rows = []
    for i in ZOO:
        if i.motion:
            turned, slid = cross_coupling(paths["axes", i.law])
            rows.append([i.name, f"`{i.law}`", number(turned), number(slid)])
    table(["implementation", "law", "turns, mrad", "slides, mm"], rows)
    out.append("""
## Near a singularity

The tip turns past the stretched wrist at a short distance, as in
[puma560_wrist_near](../experiments/puma560_wrist_near.yaml), by the equation alone: what the code of an implementation does
there is told beside it and not simulated. Measured: how the run ends, the largest joint torque and the largest angle of the
tip from its reference until then. Laws that invert Λ⁻¹ are stopped where the smallest scaled eigenvalue of Ω falls below
1e-6. A tip that leaves its path can meet the singularity, where such a law asks for any torque, or pass it at a larger
distance: the numbers are of this one path. Without feed-forward the tip lags, and the angle is mostly that. The URDF file
allows 30 N m for joints 4 and 6.

""")
    rows = []
    for i in moving:
        end, torque, joint, angle = singular(paths["wrist", i.law, i.feedforward])
        rows.append([i.name, f"`{i.law}`", "completes" if end is None else f"stops at {end:.2f} s",
                     f"{number(torque)}, joint {joint}", number(angle), i.singular])
    table(["implementation", "law", "run", "largest torque, N m", "tip error, mrad", "in its code"], rows)
    out.append("""
## A redundant arm

With seven joints a law has room for T0, a torque that should not move the tip. Measured on arm7, at rest and without
gravity, with a posture torque of 0.4 to 0.5 N m on joints 1 to 4: the tip's acceleration at the first instant, when nothing
else acts, and how far the tip goes within 3 s (later missing velocity terms act too). Without any projection, T0 alone
would give {linear} m/s² and {angular} rad/s². The last column is what `judge` finds in the log of
[arm7_missing_terms](../experiments/arm7_missing_terms.yaml), a fast motion with a damped null space; it equals the truth.

""".format(**dict(zip(("linear", "angular"), (f"{x:.2f}" for x in leak(paths["posture", "jacobian_transpose"]))))))
    rows = []
    for i in ZOO:
        if not i.null_space:
            rows.append([i.name, f"`{i.law}`", "no null-space torque", "", "", "", "", ""])
            continue
        found = mismatches.compare(f"{i.name} on arm7", judged["arm7", i.law, i.feedforward],
                                   i.omits | NULL_SPACE[i.null_space])
        rows.append([i.name, f"`{i.law}`", i.null_space, *(number(x) for x in leak(paths["posture", i.law])), terms(found)])
    table(["implementation", "law", "projector", "m/s²", "rad/s²", "mm", "mrad", "judge finds"], rows)
    out.append("""
Consistent: 1 − J\\* Λ J M⁻¹. Kinematic: 1 − J\\* (J\\*)⁺, the same as 1 − J⁺ J; it needs no inertia. It leaves the joint
torques that no tip force can produce, but through M⁻¹ these move the tip too: here more than T0 without a projection,
because the projector puts some of T0 on the light joints of the wrist.
""")
    if not mismatches:
        page.write_text("".join(out))
    return mismatches


def law():
    """J* (B u) + C + G + (1 - J* (J*)^+) T0, one answer a line."""
    B = np.array([0.5, 0.2, 0.1, 11, 15, 21])  # kg m^2, kg
    json.loads(sys.stdin.readline())
    print(json.dumps({"protocol": 1}), flush=True)
    for line in sys.stdin:
        now = json.loads(line)
        C, G, J, u, T0 = (np.array(now[name]) for name in ("C", "G", "J", "u", "null_space_torque"))
        T = J.T @ (B * u - np.linalg.solve(J @ J.T, J @ T0)) + C + G + T0  # (J*)^+ = (J J*)^-1 J
        print(json.dumps({"torque": T.tolist()}), flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--write", metavar="PAGE", type=pathlib.Path, help="measure everything and write the page")
    arguments.add_argument("--page", metavar="PAGE", type=pathlib.Path, default=SOURCE / "docs/zoo.md",
                           help="the page to check")
    arguments.add_argument("--law", action="store_true", help="be the law that osculate has not")
    given = arguments.parse_args()
    if given.law:
        law()
        return 0
    with tempfile.TemporaryDirectory() as directory:
        runs = Runs(directory)
        mismatches = write(runs, given.write) if given.write else check(runs, given.page)
    for mismatch in mismatches:
        print(mismatch, file=sys.stderr)
    return 1 if mismatches else 0


if __name__ == "__main__":
    sys.exit(main())
