"""Every shipped experiment: it says what it shows, stands in the table, and comes out as it expects, in short form."""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["OSCULATE"]
FOLDER = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"]) / "experiments"
EXPERIMENTS = {file.stem: file.read_text() for file in sorted(FOLDER.glob("*.yaml"))}

SHORT = 0.2  # s: arm, law and tolerances stay, only the duration shrinks
# What an experiment shows may take longer: a stop, a touch, a passage, a limit, a settled response.
LONGER = {
    "puma560_gimbal_lock": 3, "puma560_singular": 4, "puma560_wrist_none": 1.5,
    "puma560_wrist_damped": 1.6, "puma560_wrist_truncated": 1.6, "puma560_wrist_released": 1.6,
    "puma560_wrist_rest": 2, "puma560_elbow_damped": 3.6, "puma560_shoulder_released": 2.2,
    "puma560_touch": 1.9, "puma560_ball": 1.5, "puma560_force": 1, "puma560_impedance": 1, "puma560_obstacle": 2,
    "puma560_torque_limits": 1.5, "puma560_beyond_limits": 2, "puma560_each_axis": 4, "puma560_frequency": 8,
    "puma560_long_horizon": 2.5, "arm7_self_motion": 1, "puma560_encoders": 0.1,
}
SWEPT = 0.05  # s, each run of a sweep
SWEPT_LONGER = {"puma560_wrist_near": 1.6}


def length_of(name):
    if is_sweep(name):
        return SWEPT_LONGER.get(name, SWEPT)
    return LONGER.get(name, SHORT)


def is_sweep(name):
    return re.search(r"^sweep:", EXPERIMENTS[name], re.MULTILINE) is not None


def call(name, *settings, verb=None):
    """`osculate run` or `sweep` on a shipped experiment, shorter."""
    verb = verb or ("sweep" if is_sweep(name) else "run")
    sets = [x for setting in (f"duration={length_of(name)}", *settings) for x in ("--set", setting)]
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run([PROGRAM, verb, str(FOLDER / f"{name}.yaml"), "-o", str(pathlib.Path(folder) / "out.h5"),
                               "--quiet", *sets], capture_output=True, text=True, timeout=60)


class Files(unittest.TestCase):
    def test_each_says_what_it_shows_and_what_it_expects(self):
        self.assertGreater(len(EXPERIMENTS), 50)
        for name, text in EXPERIMENTS.items():
            with self.subTest(name):
                self.assertRegex(text, r"\A# \S", "a comment at the top")
                self.assertRegex(text, r"(?m)^expect:")
                self.assertRegex(text, rf"(?m)^name: {name}$")

    def test_each_has_one_row_in_the_table_and_each_row_a_file(self):
        table = (FOLDER / "README.md").read_text()
        rows = re.findall(r"^\| \[(\w+)\.yaml\]\((\w+)\.yaml\) \|", table, re.MULTILINE)
        for shown, target in rows:
            self.assertEqual(shown, target)
        self.assertEqual(sorted(shown for shown, _ in rows), sorted(EXPERIMENTS))

    def test_lengths_are_of_experiments_that_exist(self):
        self.assertLessEqual(set(LONGER) | set(SWEPT_LONGER), set(EXPERIMENTS))


class Runs(unittest.TestCase):
    def test_each_comes_out_as_expected(self):
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for name, done in zip(EXPERIMENTS, pool.map(call, EXPERIMENTS)):
                with self.subTest(name):
                    self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_passages_pass_while_their_policy_acts(self):
        for name in ("wrist_damped", "wrist_truncated", "wrist_released", "wrist_rest", "elbow_damped",
                     "shoulder_released"):
            with self.subTest(name):
                done = call(f"puma560_{name}")
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertRegex(done.stdout, r"the singularity policy acted for [\d.]+ s")
                self.assertRegex(done.stdout, r"(?m)^linearization .* pass$")  # outside the passage

    def test_contacts_are_made(self):
        for name, claim in (("touch", "energy"), ("ball", "energy"), ("force", "force_response")):
            with self.subTest(name):
                done = call(f"puma560_{name}")
                self.assertRegex(done.stdout, r"(?m)^[1-9]\d* changes of contact")
                self.assertRegex(done.stdout, rf"(?m)^{claim} .* pass$")

    def test_a_touch_is_no_false_alarm_at_any_tolerance(self):
        # The step that ends at the touch is now and then better than its tolerance, by chance: the shadow must be better yet.
        tolerances = [1e-10 * 1.2**k for k in range(40)]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            runs = pool.map(lambda rtol: call("puma560_touch", f"integrator.rtol={rtol}", "duration=1"), tolerances)
            for rtol, done in zip(tolerances, runs):
                with self.subTest(rtol):
                    self.assertRegex(done.stdout, r"(?m)^[1-9]\d* changes of contact")
                    self.assertRegex(done.stdout, r"(?m)^energy .* pass$")

    def test_the_null_space_is_judged_where_there_is_one(self):
        for name in ("arm7_posture", "arm7_joint_limits", "arm7_manipulability", "chain60_reach"):
            with self.subTest(name):
                self.assertRegex(call(name).stdout, r"(?m)^null_space .* pass$")

    def test_frequency_poles_and_cross_coupling_are_judged(self):
        for name, claims in (("puma560_frequency", ("frequency_response", "poles")),
                             ("puma560_each_axis", ("decoupling", "analytic_response"))):
            done = call(name)
            for claim in claims:
                with self.subTest(name, claim=claim):
                    self.assertRegex(done.stdout, rf"(?m)^{claim} .* pass$")


class Disturbed(unittest.TestCase):
    def test_a_stop_that_is_not_expected(self):
        for name in ("puma560_wrist_none", "puma560_singular"):
            with self.subTest(name):
                self.assertEqual(call(name, "expect={}").returncode, 3)

    def test_a_stop_that_does_not_come(self):
        done = call("puma560_wrist_none", "controller.singularity={policy: damped, threshold: 0.01}")
        self.assertEqual(done.returncode, 1)
        self.assertIn("expects stop: singular", done.stderr)

    def test_a_failure_that_does_not_come(self):
        self.assertEqual(call("puma560_dense_plant", "expect.fails=[torque]").returncode, 1)

    def test_one_run_of_a_sweep_that_fails(self):
        done = call("puma560_mismatch", "expect.fails=[omega]")
        self.assertEqual(done.returncode, 1)


if __name__ == "__main__":
    unittest.main()
