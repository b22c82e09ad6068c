"""The Python module against the program: numbers, shapes, errors, runs, threads, types. PYTHONPATH has the module."""
import ast
import contextlib
import io
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import h5py
import numpy as np
import osculate

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
MODELS, EXPERIMENTS = ROOT / "models", ROOT / "experiments"
CIRCLE = EXPERIMENTS / "puma560_circle.yaml"
EPS = np.finfo(float).eps
ARMS = ("puma560", "arm7", "satellite_arm", "mobile_arm")  # the last two with a floating and a planar joint


def program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


def arm(name, **more):
    return osculate.Chain(MODELS / f"{name}.urdf", "tool0", **more)


def state(chain, seed, count=None):
    """Random q, qd, u; quaternions need no unit length."""
    random = np.random.default_rng(seed)
    lead = () if count is None else (count,)
    q = random.uniform(-1, 1, lead + (chain.positions,))
    return q, random.uniform(-1, 1, lead + (chain.velocities,)), random.uniform(-1, 1, lead + (6,))


class Numbers(unittest.TestCase):
    def test_terms_are_those_of_the_program_to_the_bit(self):
        for name in ARMS:
            chain = arm(name)
            for seed in range(3):
                q, qd, u = state(chain, seed)
                lists = [",".join(repr(float(x)) for x in values) for values in (q, qd, u)]
                shown = json.loads(program("terms", MODELS / f"{name}.urdf", "--tip", chain.tip, f"--q={lists[0]}",
                                           f"--qd={lists[1]}", f"--u={lists[2]}", "--json").stdout)
                ours = chain.terms(q, qd, u)
                self.assertEqual(shown["rank"], ours.rank)
                np.testing.assert_array_equal(ours.position, shown["tip"]["position"])
                np.testing.assert_array_equal(ours.rotation, shown["tip"]["rotation"])
                for key in ("M", "C", "G", "J", "Jdot_qd", "cond_Omega"):
                    np.testing.assert_array_equal(getattr(ours, key), shown[key])
                for side in ("recursive", "dense", "residual"):
                    for key, value in shown[side].items():
                        value = np.nan if value is None else value
                        np.testing.assert_array_equal(getattr(getattr(ours, side), key), value)

    def test_forward_dynamics_solves_the_equation_of_motion(self):
        for name in ARMS:
            chain = arm(name)
            for seed in range(10):
                q, qd, push = state(chain, seed)
                terms = chain.terms(q, qd)
                torque = np.random.default_rng(seed).uniform(-10, 10, chain.velocities)
                qdd = chain.forward_dynamics(q, qd, torque, push)
                parts = [torque, -terms.C, -terms.G, terms.J.T @ push]
                # M qdd is formed from numbers of this size; qdd itself is known to eps times M's condition.
                scale = np.sqrt(np.diag(terms.M))
                size = max(np.max(np.abs(part) / scale) for part in parts)
                condition = np.linalg.cond(terms.M / np.outer(scale, scale))
                wrong = np.max(np.abs((terms.M @ qdd - sum(parts)) / scale))
                self.assertLessEqual(wrong, 32 * EPS * condition * size, (name, seed))

    def test_the_torque_gives_the_acceleration(self):
        for name in ("puma560", "arm7", "mobile_arm"):
            chain = arm(name)
            for seed in range(10):
                q, qd, u = state(chain, seed)
                terms = chain.terms(q, qd, u)
                if terms.rank < 6:
                    continue
                T = chain.operational_space_torque(q, qd, u)
                allowed = 32 * EPS * terms.cond_Omega
                size = np.max(np.abs(terms.recursive.T))
                self.assertLessEqual(np.max(np.abs(T - terms.recursive.T)), allowed * size)
                reached = terms.J @ chain.forward_dynamics(q, qd, T) + terms.Jdot_qd
                forces = np.max(np.abs(terms.dense.Omega) @ np.abs(terms.dense.F))
                self.assertLessEqual(np.max(np.abs(reached - u)), allowed * forces)

    def test_other_torques_do_not_move_the_tip(self):
        chain = arm("arm7")
        q, qd, u = state(chain, 1)
        terms = chain.terms(q, qd, u)
        others = np.linspace(-3, 3, 7)
        qdd = chain.forward_dynamics(q, qd, chain.operational_space_torque(q, qd, u, T0=others))
        self.assertGreater(np.max(np.abs(qdd - terms.recursive.qdd)), 1e-3)
        forces = np.max(np.abs(terms.dense.Omega) @ np.abs(terms.dense.F))
        size = forces + np.max(np.abs(terms.J @ np.linalg.inv(terms.M)) @ np.abs(others))
        self.assertLessEqual(np.max(np.abs(terms.J @ qdd + terms.Jdot_qd - u)), 32 * EPS * terms.cond_Omega * size)

    def test_rows(self):
        chain = arm("puma560")
        q, qd, u = state(chain, 2)
        terms = chain.terms(q, qd, u[3:], rows=["vx", "vy", "vz"])
        whole = chain.terms(q, qd, u)
        np.testing.assert_array_equal(terms.J, whole.J[3:])
        self.assertEqual(terms.recursive.Lambda.shape, (3, 3))
        T = chain.operational_space_torque(q, qd, u[3:], rows=["vx", "vy", "vz"])
        allowed = 32 * EPS * terms.cond_Omega * np.max(np.abs(T))
        self.assertLessEqual(np.max(np.abs(T - terms.recursive.T)), allowed)

    def test_armature_and_gravity(self):
        q = state(arm("puma560"), 3)[0]
        plain = arm("puma560").terms(q)
        more = np.arange(1.0, 7.0)
        heavy = arm("puma560", armature=more, gravity=(0, 0, 0)).terms(q)
        allowed = 4 * EPS * np.max(np.abs(heavy.M))
        np.testing.assert_allclose(heavy.M - plain.M, np.diag(more), rtol=0, atol=allowed)
        self.assertTrue(np.all(heavy.G == 0))
        self.assertGreater(np.max(np.abs(plain.G)), 1)

    def test_text_of_a_model(self):
        chain = osculate.Chain.from_text((MODELS / "puma560.urdf").read_text(), "tool0")
        q = state(chain, 4)[0]
        np.testing.assert_array_equal(chain.tip_pose(q)[0], arm("puma560").tip_pose(q)[0])
        self.assertEqual(len(chain.joints), 6)


class Arrays(unittest.TestCase):
    def setUp(self):
        self.arm = arm("puma560")
        self.q, self.qd, self.u = state(self.arm, 5, 7)

    def test_many_states_are_the_single_ones_to_the_bit(self):
        for name in ARMS:
            chain = arm(name)
            q, qd, u = state(chain, 6, 5)
            T = np.random.default_rng(7).uniform(-1, 1, (5, chain.velocities))
            many = chain.terms(q, qd, u)
            qdd = chain.forward_dynamics(q, qd, T)
            p, R = chain.tip_pose(q)
            for i in range(5):
                one = chain.terms(q[i], qd[i], u[i])
                np.testing.assert_array_equal(many.J[i], one.J)
                for side in ("recursive", "dense", "residual"):
                    for key in ("Omega", "Lambda", "c", "g", "F", "T", "qdd"):
                        np.testing.assert_array_equal(getattr(getattr(many, side), key)[i], getattr(getattr(one, side), key))
                np.testing.assert_array_equal(qdd[i], chain.forward_dynamics(q[i], qd[i], T[i]))
                np.testing.assert_array_equal(p[i], chain.tip_pose(q[i])[0])
                np.testing.assert_array_equal(R[i], chain.tip_pose(q[i])[1])

    def test_one_state_stands_for_all(self):
        T = self.arm.operational_space_torque(self.q, self.qd[0], self.u[0])
        again = self.arm.operational_space_torque(self.q, np.tile(self.qd[0], (7, 1)), np.tile(self.u[0], (7, 1)))
        np.testing.assert_array_equal(T, again)
        self.assertEqual(self.arm.operational_space_torque(self.q[0], self.qd, self.u[0]).shape, (7, 6))
        self.assertEqual(self.arm.terms(self.q[:0]).M.shape, (0, 6, 6))

    def test_memory_order_and_dtype(self):
        expected = self.arm.operational_space_torque(self.q, self.qd, self.u)
        sparse = np.zeros((14, 12))
        sparse[::2, ::2] = self.q
        reverse = np.ascontiguousarray(self.q[::-1, ::-1])[::-1, ::-1]
        for q in (np.asfortranarray(self.q), sparse[::2, ::2], reverse, self.q.tolist(), self.q.astype(">f8"),
                  self.q.astype(np.longdouble)):
            np.testing.assert_array_equal(self.arm.operational_space_torque(q, self.qd, self.u), expected)
        single = self.q.astype(np.float32)
        np.testing.assert_array_equal(self.arm.tip_pose(single)[0], self.arm.tip_pose(single.astype(float))[0])
        whole = np.array([0, 1, -1, 2, 1, 0])
        np.testing.assert_array_equal(self.arm.tip_pose(whole)[0], self.arm.tip_pose(whole.astype(float))[0])
        self.assertEqual(expected.dtype, np.float64)
        self.assertTrue(expected.flags.c_contiguous)

    def test_arguments_are_not_changed_and_results_are_new(self):
        q = self.q.copy()
        first = self.arm.forward_dynamics(q, self.qd, self.u)
        first[:] = 0
        np.testing.assert_array_equal(q, self.q)
        self.assertGreater(np.max(np.abs(self.arm.forward_dynamics(q, self.qd, self.u))), 0)

    def test_what_is_refused(self):
        six = "give shape (6,) or (N, 6): rad or m for each joint, base to tip"
        nan = self.q.copy()
        nan[2, 3] = np.nan
        for q, text in ((np.zeros(5), "q has shape (5,): " + six), (np.zeros((2, 5)), "q has shape (2, 5): " + six),
                        (np.zeros((1, 2, 6)), "q has shape (1, 2, 6): " + six), (0.0, "q has shape (): " + six),
                        (self.q.astype(complex), "q has dtype complex128, not real numbers: " + six),
                        (["a"] * 6, "q has dtype <U1, not real numbers: " + six),
                        ([[1], [2, 3]], "q is no array of numbers: " + six),
                        (nan, "q[2, 3] is nan: give finite numbers")):
            with self.assertRaises(ValueError) as caught:
                self.arm.tip_pose(q)
            self.assertEqual(str(caught.exception), text)
        with self.assertRaises(ValueError) as caught:
            self.arm.forward_dynamics(self.q, self.qd[:3], self.u)
        self.assertEqual(str(caught.exception), "qd has shape (3, 6), but q has shape (7, 6): give as many states, or one "
                         "of shape (6,) for all of them")
        for rows, text in ((["vx", "up"], "rows: 'up' is no task row: choose from wx, wy, wz, vx, vy, vz"),
                           (["vx", "vx"], "rows: 'vx' is given twice"), ([], "rows is empty")):
            with self.assertRaisesRegex(ValueError, re.escape(text)):
                self.arm.terms(self.q, rows=rows)
        with self.assertRaisesRegex(ValueError, r"u has shape \(6,\): give shape \(3,\) or \(N, 3\)"):
            self.arm.terms(self.q, u=np.zeros(6), rows=["vx", "vy", "vz"])
        with self.assertRaisesRegex(ValueError, "side_branches is 'cut': choose 'lump' or 'drop'"):
            arm("puma560", side_branches="cut")
        with self.assertRaisesRegex(ValueError, "armature has -1.0+: give numbers >= 0"):
            arm("puma560", armature=-np.ones(6))


class Errors(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def message_of_program(self, *arguments):
        return program(*arguments).stderr.strip().removeprefix("osculate: ")

    def test_model(self):
        for tip in ("tool9", "base_link"):
            with self.assertRaises(osculate.ModelError) as caught:
                osculate.Chain(MODELS / "puma560.urdf", tip)
            self.assertEqual(str(caught.exception), self.message_of_program(
                "terms", MODELS / "puma560.urdf", "--tip", tip, "--q=0,0,0,0,0,0"))
        self.assertEqual(caught.exception.exit_code, 2)
        self.assertIsInstance(caught.exception, osculate.Error)

    def test_experiment(self):
        with self.assertRaises(osculate.ConfigError) as caught:
            osculate.Experiment(CIRCLE, {"duration": -1})
        self.assertEqual(str(caught.exception), self.message_of_program("check", CIRCLE, "--set", "duration=-1"))
        with self.assertRaisesRegex(osculate.ConfigError, r"^text:1:\d+: "):
            osculate.Experiment.from_text("nam: x\n")
        broken = osculate.Experiment(CIRCLE, {"model.tip": "tool9"})
        with self.assertRaisesRegex(osculate.ModelError, "tool9"):
            broken.check()

    def test_file(self):
        taken = self.folder / "taken.h5"
        taken.write_text("mine")
        short = osculate.Experiment(CIRCLE, {"duration": 0.01})
        with self.assertRaises(osculate.FileError) as caught:
            short.run(taken)
        self.assertEqual(caught.exception.exit_code, 4)
        self.assertEqual(taken.read_text(), "mine")

    def test_singular(self):
        chain = arm("puma560")
        with self.assertRaisesRegex(osculate.SingularArm, r"^state 1: the arm is singular: task row \d of 6"):
            chain.operational_space_torque([[0, -0.8, 0.4, 0, 0.9, 0], [0] * 6], np.zeros(6), np.zeros(6))
        terms = chain.terms([[0, -0.8, 0.4, 0, 0.9, 0], [0] * 6])
        self.assertEqual(terms.rank[0], 6)
        self.assertLess(terms.rank[1], 6)
        self.assertTrue(np.all(np.isnan(terms.recursive.Lambda[1])) and np.isnan(terms.residual.T[1]))
        self.assertTrue(np.all(np.isfinite(terms.recursive.Lambda[0])) and np.all(np.isfinite(terms.recursive.Omega)))


class Runs(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def assert_same_bits(self, a, b):
        done = program("diff", a, b)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_run_is_that_of_the_program(self):
        ours, theirs = self.folder / "ours.h5", self.folder / "theirs.h5"
        run = osculate.Experiment(CIRCLE, {"duration": 0.2}).run(ours)
        done = program("run", CIRCLE, "-o", theirs, "--set", "duration=0.2")
        self.assert_same_bits(ours, theirs)
        self.assertEqual((run.exit_code, run.status, run.verdict, run.message), (0, "complete", "pass", ""))
        self.assertEqual(run.output, ours)
        self.assertEqual(run.report.splitlines()[:18], done.stdout.splitlines()[:18])
        with h5py.File(ours) as f, h5py.File(theirs) as g:
            self.assertEqual([claim.id.encode() for claim in run.claims], list(f["verdict/claim"][:]))
            passed = {"pass": 1, "fail": 0, "not_applicable": -1}
            self.assertEqual([passed[claim.result] for claim in run.claims], list(f["verdict/result"][:]))
            judged = f["verdict/result"][:] >= 0
            for key in ("worst", "bound", "at_time"):
                values = np.array([getattr(claim, key) for claim in run.claims])
                np.testing.assert_array_equal(values[judged], f["verdict/" + key][:][judged])
            # The module is a file of its own, and the result names it.
            ids = [file["provenance/build_id"][()] for file in (f, g)]
            self.assertNotEqual(*ids)
            self.assertEqual(f["time"][-1], run.end_time)

    def test_text_and_what_it_resolves_to(self):
        text = CIRCLE.read_text()
        experiment = osculate.Experiment.from_text(text, EXPERIMENTS, {"duration": 0.05, "integrator.rtol": 1e-9})
        again = osculate.Experiment.from_text(experiment.yaml)
        self.assertEqual(again.yaml, experiment.yaml)
        self.assertEqual(again.name, experiment.name)
        self.assertEqual(again.run().steps, experiment.run().steps)

    def test_a_failed_claim_is_a_result(self):
        run = osculate.Experiment(EXPERIMENTS / "puma560_mismatch.yaml", {"duration": 0.05, "expect": {}}).run()
        self.assertIsNone(run.output)
        self.assertEqual(run.verdict, "fail" if run.exit_code else "pass")
        stopped = osculate.Experiment(EXPERIMENTS / "puma560_singular.yaml", {"expect": {}}).run()
        self.assertEqual((stopped.exit_code, stopped.status), (3, "failed"))
        self.assertIn("singular", stopped.message)

    def test_two_runs_at_once_give_the_bits_of_one(self):
        experiment = osculate.Experiment(CIRCLE, {"duration": 0.5})
        alone = self.folder / "alone.h5"
        experiment.run(alone)
        together = [self.folder / f"{i}.h5" for i in range(2)]
        threads = [threading.Thread(target=experiment.run, args=(file,)) for file in together]
        for thread in threads:
            thread.start()
        turns = 0  # this thread gets its turns meanwhile, and uses the same HDF5 library
        while any(thread.is_alive() for thread in threads):
            with h5py.File(alone) as f:
                self.assertEqual(f.attrs["status"], "complete")
            turns += 1
        for thread, file in zip(threads, together):
            thread.join()
            self.assert_same_bits(alone, file)
        self.assertGreater(turns, 2)

    def test_interruption_leaves_a_proper_file(self):
        file = self.folder / "long.h5"
        timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            osculate.Experiment(CIRCLE, {"duration": 1000, "verify.shadow": False}).run(file)
        timer.join()
        with h5py.File(file) as f:
            self.assertEqual(f.attrs["status"], "interrupted")
            self.assertGreater(f["time"].size, 1)


class Description(unittest.TestCase):
    def test_the_example_of_the_page(self):
        page = (ROOT / "docs" / "python.md").read_text()
        code, shown = re.search(r"```python\n(.*?)```\n\n```\n(.*?)```", page, re.DOTALL).groups()
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            for name in ("models", "experiments"):
                os.symlink(ROOT / name, pathlib.Path(folder) / name)
            out = io.StringIO()
            try:
                os.chdir(folder)
                with contextlib.redirect_stdout(out):
                    exec(compile(code, "docs/python.md", "exec"), {})  # noqa: S102
            finally:
                os.chdir(before)
        self.assertEqual(out.getvalue(), shown)

    def test_everything_public_is_described(self):
        self.assertEqual(sorted(osculate.__all__), osculate.__all__)
        for name in osculate.__all__:
            thing = getattr(osculate, name)
            self.assertTrue(thing.__doc__, name)
            if isinstance(thing, type) and not issubclass(thing, Exception):
                for member, value in vars(thing).items():
                    if not member.startswith("_"):
                        described = getattr(thing, member).__doc__ or ""
                        self.assertGreater(len(described), 2, f"{name}.{member}")

    def test_the_stub_says_what_the_module_has(self):
        """Names and arguments; types are for stubtest: ./dev api."""
        stub = ast.parse(pathlib.Path(osculate.__file__).with_name("_core.pyi").read_text())
        classes = {of.name: of for of in stub.body if isinstance(of, ast.ClassDef)}
        functions = {of.name for of in stub.body if isinstance(of, ast.FunctionDef)}
        self.assertEqual(sorted(classes.keys() | functions), osculate.__all__)
        compared = 0
        for name, of in classes.items():
            thing = getattr(osculate, name)
            members = {m.name: m for m in of.body if isinstance(m, ast.FunctionDef)}
            if not issubclass(thing, Exception):
                public = {m for m in vars(thing) if not m.startswith("_")}
                self.assertEqual({m for m in members if m != "__init__"}, public, name)
            for member, method in members.items():
                if any(getattr(decorator, "id", "") == "property" for decorator in method.decorator_list):
                    self.assertTrue(isinstance(vars(thing)[member], property), f"{name}.{member}")
                    continue
                # "q: object, qd: object = None, *, rows: Optional[List[str]] = None"
                given = re.match(r"\w+\((.*)\) -> ", getattr(thing, member).__doc__)[1]
                while re.search(r"[\[({<]", given):
                    given = re.sub(r"\[[^][]*\]|\([^()]*\)|\{[^{}]*\}|<[^<>]*>", "", given)
                arguments = method.args
                expected = [a.arg for a in arguments.args] + ["*"] * bool(arguments.kwonlyargs)
                expected += [a.arg for a in arguments.kwonlyargs]
                self.assertEqual([part.split(":")[0].strip() for part in given.split(",")], expected, f"{name}.{member}")
                compared += 1
        self.assertGreaterEqual(compared, 10)


class Judge(unittest.TestCase):
    """A controller of this test's own, evaluated along a motion of all joints."""

    @classmethod
    def setUpClass(cls):
        cls.chain = arm("puma560", armature=[0.2] * 6)
        cls.t = np.arange(1000) * 1e-3
        speed, phase = np.linspace(2, 5, 6), np.arange(6)
        cls.q = np.array([0, -0.8, 0.4, 0.3, 0.9, 0.2]) + 0.3 * np.sin(np.outer(cls.t, speed) + phase)
        cls.qd = 0.3 * speed * np.cos(np.outer(cls.t, speed) + phase)
        cls.u = np.sin(np.outer(cls.t, speed[::-1]) * 3 + phase)
        terms = cls.chain.terms(cls.q, cls.qd, cls.u)
        cls.exact = terms.dense.T
        force = np.einsum("kij,kj->ki", terms.dense.Lambda, terms.Jdot_qd)
        cls.without_jdot = cls.exact + np.einsum("kji,kj->ki", terms.J, force)

    def test_right_and_wrong(self):
        right = osculate.judge(self.chain, self.t, self.q, self.qd, self.exact, self.u)
        self.assertEqual((right.ruling, right.findings), ("right", []))
        wrong = osculate.judge(self.chain, self.t, self.q, self.qd, self.without_jdot, self.u)
        self.assertEqual(wrong.ruling, "wrong")
        self.assertEqual([f.term for f in wrong.findings], ["jdot_qd"])
        self.assertAlmostEqual(wrong.findings[0].coefficients[0].value, -1, places=6)
        self.assertIn("omits J* Lambda Jdot qd", wrong.report)

    def test_order_of_u_and_bad_arguments(self):
        linear_first = np.hstack([self.u[:, 3:], self.u[:, :3]])
        found = osculate.judge(self.chain, self.t, self.q, self.qd, self.without_jdot, linear_first, u_order=None)
        self.assertEqual([f.term for f in found.findings], ["jdot_qd"])
        self.assertIn("linear rows first", found.conventions[0])
        for change, words in (({"tau": self.exact[:, :5]}, "tau has shape (1000, 5): give (1000, 6)"),
                              ({"u": None}, "give either u or reference"),
                              ({"u_order": "first"}, "u_order is 'first': choose 'angular', 'linear' or None"),
                              ({"viscous": [1.0]}, "viscous has 1 numbers: give 6")):
            arguments = {"tau": self.exact, "u": self.u} | change
            with self.assertRaisesRegex(ValueError, re.escape(words)):
                osculate.judge(self.chain, self.t, self.q, self.qd, **arguments)
        with self.assertRaisesRegex(osculate.LogError, "sample 2"):
            osculate.judge(self.chain, 0 * self.t, self.q, self.qd, self.exact, self.u)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=1))
