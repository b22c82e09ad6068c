"""Controllers of a user's own in closed loop: right and wrong ones, in C and in Python, and every way to fail."""
import hashlib
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import textwrap
import time
import unittest

import h5py
import numpy as np

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
PYTHON = "/usr/bin/python3"
PUMA = ROOT / "experiments" / "puma560_your_controller.yaml"
PLANAR = ROOT / "experiments" / "planar_2r_line.yaml"
ARM7 = ROOT / "experiments" / "arm7_lissajous.yaml"
EXAMPLE = ROOT / "experiments" / "your_controller.py"
SHORT = 0.2  # s


def build(source, target, *flags):
    subprocess.run([os.environ.get("CC", "cc"), "-std=gnu11", "-O1", "-Wall", "-Werror", "-shared", "-fPIC",
                    "-I", ROOT / "include", *flags, source, "-o", target, "-lm"], check=True)


def setUpModule():
    global HOLDER, FOLDER, LAWS, EXAMPLE_C
    HOLDER = tempfile.TemporaryDirectory()
    FOLDER = pathlib.Path(HOLDER.name)
    LAWS, EXAMPLE_C = FOLDER / "laws.so", FOLDER / "your_controller.so"
    build(ROOT / "tests" / "plugin" / "laws.c", LAWS)
    build(ROOT / "experiments" / "your_controller.c", EXAMPLE_C, "-Wextra", "-pedantic")


def tearDownModule():
    HOLDER.cleanup()


def call(*arguments, timeout=60):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=timeout)


def run(experiment, law, *settings, out=None, duration=SHORT):
    """`law`: the map of controller.law, without braces."""
    sets = [f"controller.law={{{law}}}", f"duration={duration}", *settings]
    where = ["-o", out, "--force"] if out else []
    return call("run" if out else "verify", experiment, *where, "--quiet", *(x for s in sets for x in ("--set", s)))


def plugin(kind, *more):
    return ", ".join((f"plugin: {LAWS}", f"options: {kind}", "terms: true", *more))


def result(table, claim):
    """pass, FAIL or n/a."""
    return re.search(rf"(?m)^{claim} .*? (pass|FAIL|n/a)(:.*)?$", table)[1]


class Right(unittest.TestCase):
    def test_the_example_in_c_passes_every_claim(self):
        done = run(PUMA, f"plugin: {EXAMPLE_C}, terms: true")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for claim in ("torque", "linearization", "analytic_response", "decoupling", "energy", "kinematics"):
            self.assertEqual(result(done.stdout, claim), "pass", claim)

    def test_a_closed_form_that_uses_no_term_of_ours_passes(self):
        done = run(PLANAR, f"plugin: {LAWS}, options: planar", duration=1.5)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for claim in ("torque", "linearization", "analytic_response"):
            self.assertEqual(result(done.stdout, claim), "pass", claim)

    def test_friction_armature_a_moving_base_and_a_wall(self):
        for name, duration, settings in (("puma560_circle", SHORT, ()), ("puma560_impedance", 1, ()),
                                         ("arm7_moving_base", SHORT, ("controller.null_space={}",))):
            with self.subTest(name):
                done = run(ROOT / "experiments" / f"{name}.yaml", plugin("right"), *settings, duration=duration)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(result(done.stdout, "torque"), "pass")
                self.assertEqual(result(done.stdout, "linearization"), "pass")

    def test_a_null_space_of_ours_or_its_own_is_judged(self):
        for kind, settings in (("right", ()), ("own_null_space", ("controller.null_space={}",))):
            done = run(ARM7, plugin(kind), *settings)
            if kind == "right":  # J^T F alone: T0 of the experiment is left out
                self.assertEqual(result(done.stdout, "torque"), "FAIL")
                self.assertEqual(result(done.stdout, "linearization"), "pass")
            else:
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(result(done.stdout, "null_space"), "pass")

    def test_sampled_with_a_memory_of_its_own_in_each_copy(self):
        sampling = "controller.sampling={period: 0.01}"
        done = run(PUMA, plugin("count"), sampling)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(result(done.stdout, "torque"), "pass")
        self.assertEqual(result(done.stdout, "linearization"), "pass")

    def test_the_library_is_told_the_end_and_its_prints_are_no_results(self):
        self.assertIn("goodbye after ", run(PUMA, plugin("say_goodbye"), duration=0.01).stderr)
        done = run(PUMA, plugin("print"), duration=0.01)
        self.assertNotIn("must not mix", done.stdout)
        self.assertIn("must not mix", done.stderr)


class Wrong(unittest.TestCase):
    def test_a_dropped_term_fails_linearization_and_torque(self):
        out = FOLDER / "wrong.h5"
        done = run(PUMA, plugin("no_jdot_qd"), out=out)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        for claim in ("torque", "linearization"):
            self.assertEqual(result(done.stdout, claim), "FAIL", claim)
        for claim in ("omega", "lambda", "c", "g", "forward_dynamics", "kinematics", "energy"):
            self.assertEqual(result(done.stdout, claim), "pass", claim)
        with h5py.File(out) as file:
            ratio = np.nanmax(file["verification/linearization"][:] / file["verification/linearization_bound"][:])
            self.assertGreater(ratio, 1e6)

    def test_another_error_law_is_told_from_a_wrong_torque(self):
        done = run(PUMA, plugin("own_u"))
        self.assertEqual(done.returncode, 1)
        for claim in ("torque", "linearization"):
            self.assertEqual(result(done.stdout, claim), "pass", claim)
        self.assertEqual(result(done.stdout, "analytic_response"), "FAIL")

    def test_expected_failures_make_exit_code_0(self):
        fails = "expect.fails=[torque, linearization, analytic_response, decoupling]"
        self.assertEqual(run(PUMA, plugin("no_jdot_qd"), fails).returncode, 0)


class Fails(unittest.TestCase):
    """Exit code 3, one clear sentence, and a finished file with what was computed before."""

    def check(self, law, said, *settings, start=0.0):
        out = FOLDER / f"{self.id().rsplit('.')[-1]}_{abs(hash(law + str(settings)))}.h5"
        begun = time.monotonic()
        done = run(PUMA, law, "integrator.max_step=0.01", *settings, out=out)
        self.assertLess(time.monotonic() - begun, 20)
        self.assertEqual(done.returncode, 3, f"{law}: {done.stdout}{done.stderr}")
        self.assertRegex(done.stderr, said)
        at = re.search(r"at t = ([\d.e-]+) s", done.stderr)
        self.assertGreaterEqual(float(at[1]), start)
        with h5py.File(out) as file:
            self.assertEqual(file.attrs["status"], "failed")
            self.assertGreater(len(file["verdict/claim"]), 10)
            if start > 0:
                self.assertGreater(len(file["time"]), 3)
                self.assertLessEqual(file["time"][-1], SHORT)
                self.assertTrue(np.isfinite(file["trajectory/joint_torque"][:]).all())

    def test_a_library_that_fails(self):
        name = re.escape(f"controller {LAWS}")
        for kind, said in (("crash", r"crashed \(Segmentation fault\) at t = .*: compile it with -g"),
                           ("abort", r"crashed \(Aborted\) at t = "),
                           ("exit", r"ended itself \(exit code 7\) at t = "),
                           ("unset", r"gave torque\[0\] = nan at t = .*: every number must be set"),
                           ("nan", r"gave torque\[5\] = nan at t = "),
                           ("overrun", r"wrote past the end of torque at t = "),
                           ("refuse", r"refuses to go on at t = \S+ s: joint 3 is too warm")):
            with self.subTest(kind):
                self.check(plugin(kind), f"{name} {said}", start=0.05)
        self.check(plugin("hang", "time_limit: 0.3"),
                   r"gave no answer within 0.3 s at t = .* raise controller.law.time_limit", start=0.05)
        self.check(f"plugin: {EXAMPLE_C}", r"refuses to go on at t = 0 s: set controller.law.terms: true")

    def test_a_sampled_library_that_fails(self):
        for kind, said in (("crash", r"crashed \(Segmentation fault\) at t = 0.05 s"), ("nan", r"at t = 0.05 s")):
            with self.subTest(kind):
                self.check(plugin(kind), said, "controller.sampling={period: 0.01}", start=0.05)

    def test_a_memory_without_sampling(self):
        self.check(plugin("integrate"), "two different answers to the same question at t = 0 s: .*give controller.sampling",
                   "initial.q.0=0.3")

    def test_a_stop_that_is_expected(self):
        self.assertEqual(run(PUMA, plugin("crash"), "expect.stop=law").returncode, 0)

    def test_a_program_that_fails(self):
        begin = ("import json, os, sys, time\nsys.stdin.readline()\nprint(json.dumps({'protocol': 1}), flush=True)\n"
                 "for line in sys.stdin:\n    now = json.loads(line)\n    late = now['t'] >= 0.05\n")
        for kind, body, said in (
                ("rubbish", "print('hello' if late else json.dumps({'torque': now['G']}))",
                 r"printed 'hello', which is no answer \(expected .* at byte 1\), at t = .*: print one JSON object"),
                ("size", "print(json.dumps({'torque': now['G'][:5] if late else now['G']}))",
                 r"gave 5 numbers as torque and not 6 at t = "),
                ("nan", "print(json.dumps({'torque': [float('nan') if late else 0] * 6}))", r"gave torque\[0\] = nan at t = "),
                ("huge", "print('{\"torque\": [1e999, 0, 0, 0, 0, 0]}')", r"gave torque\[0\] = inf at t = "),
                ("words", "print('{\"torque\": [\"much\"]}')", r"gave no list of numbers as torque at t = "),
                ("key", "print('{\"tau\": []}')", r"unknown key 'tau' at t = .*: the keys of an answer are torque, u"),
                ("nothing", "print('{}')", r"answered without the key 'torque' at t = "),
                ("twice", "print('{\"torque\": [0, 0, 0, 0, 0, 0]}\\n[]')", r"printed more than one line"),
                ("endless", "print('x' * 200000)", r"printed a line of more than \d+ bytes at t = "),
                ("error", "print(json.dumps({'error': 'Gelenk zu heiß'}))", r"refuses to go on at t = 0 s: Gelenk zu heiß"),
                ("raise", "raise ValueError('oh')", r"ended itself \(exit code 1\) at t = "),
                ("exit", "os._exit(4) if late else print(json.dumps({'torque': now['G']}))",
                 r"ended itself \(exit code 4\) at t = "),
                ("hang", "time.sleep(1000)", r"gave no answer within 0.4 s at t = ")):
            with self.subTest(kind):
                script = FOLDER / f"{kind}.py"
                script.write_text(begin + f"    {body}\n    sys.stdout.flush()\n")
                self.check(f"process: [{PYTHON}, {kind}.py], directory: {FOLDER}, terms: true, time_limit: 0.4", said,
                           start=0.05 if "late" in body else 0.0)

    def test_nothing_is_left_behind(self):
        mark = FOLDER / "mark.py"
        mark.write_text("import sys, time\nsys.stdin.readline()\nprint('{\"protocol\": 1}', flush=True)\ntime.sleep(1000)\n")
        self.check(f"process: [{PYTHON}, {mark}], time_limit: 0.3", "gave no answer")
        self.assertEqual(running(mark), 0)


def running(script):
    """How many programs have its name in their command line."""
    def line(path):
        try:
            return path.read_bytes()
        except OSError:
            return b""
    return sum(str(script).encode() in line(path) for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"))


def until(true):
    end = time.monotonic() + 20
    while not true() and time.monotonic() < end:
        time.sleep(0.02)
    return true()


class Signals(unittest.TestCase):
    def start(self, script):
        """A long run with a program, in a session of its own as under a terminal; returns when it has recorded rows."""
        out = FOLDER / f"{script.stem}.h5"
        run = subprocess.Popen([PROGRAM, "run", PUMA, "-o", out, "--quiet", "--set", "duration=1000", "--set",
                                f"controller.law={{process: [{PYTHON}, {script}], terms: true}}"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        self.assertTrue(until(lambda: out.exists() and out.stat().st_size > 100_000))
        return run, out

    def example(self, name):
        script = FOLDER / name
        script.write_text(EXAMPLE.read_text())
        return script

    def test_ctrl_c_finishes_the_file_and_does_not_reach_the_controller(self):
        run, out = self.start(self.example("interrupted.py"))
        os.killpg(run.pid, signal.SIGINT)
        self.assertEqual(run.wait(timeout=30), 130)
        with h5py.File(out) as file:
            self.assertEqual(file.attrs["status"], "interrupted")

    def test_the_controller_ends_when_osculate_is_killed(self):
        script = self.example("orphan.py")
        run, _ = self.start(script)
        self.assertEqual(running(script), 1 + 1)  # itself, and its name in the command line of osculate
        run.kill()
        run.wait()
        self.assertTrue(until(lambda: running(script) == 0))


class Refused(unittest.TestCase):
    """Exit code 2 before anything runs, with the place in the file."""

    def check(self, law, said, *settings):
        for verb in ("check", "verify"):
            done = call(verb, PUMA, "--set", f"controller.law={law}", *(x for s in settings for x in ("--set", s)))
            self.assertEqual(done.returncode, 2, f"{verb} {law}: {done.stdout}{done.stderr}")
            self.assertRegex(done.stderr, said)
            self.assertRegex(done.stderr, r"(?m)^osculate: (--set |\S+puma560_your_controller.yaml)")

    def test_libraries_that_cannot_be_used(self):
        text = FOLDER / "text.so"
        text.write_text("no library")
        old, bare, none = FOLDER / "old.so", FOLDER / "bare.so", FOLDER / "none.so"
        for target, code in ((old, "int osculate_controller_abi(void) { return 7; }"), (none, "int x;"),
                             (bare, "int osculate_controller_abi(void) { return 1; }")):
            source = target.with_suffix(".c")
            source.write_text(code)
            build(source, target)
        for law, said in ((f"{{plugin: {FOLDER}/nothing.so}}", "nothing.so is no file: build it"),
                          (f"{{plugin: {text}}}", "cannot be loaded: "),
                          (f"{{plugin: {none}}}", "has no symbol osculate_controller_abi: write OSCULATE_CONTROLLER_PLUGIN"),
                          (f"{{plugin: {old}}}", "compiled for version 7 of the controller interface, this osculate has version 1"),
                          (f"{{plugin: {bare}}}", "has no symbol osculate_controller_torque"),
                          (f"{{plugin: {LAWS}, options: refuse_to_start}}",
                           r'refuses to start \(osculate_controller_create returned 3\): no "gripper" here, 6 joints, first '),
                          (f"{{plugin: {LAWS}, options: crash_at_start}}", r"crashed \(Segmentation fault\) when it was started"),
                          (f"{{plugin: {LAWS}, options: hang_at_start, start_limit: 0.3}}",
                           "gave no answer within 0.3 s when it was started .* raise controller.law.start_limit")):
            with self.subTest(law):
                self.check(law, said)

    def test_programs_that_cannot_be_used(self):
        for name, text in (("silent.py", ""), ("old.py", "print('{\"protocol\": 9}')"), ("import.py", "import nonesuch"),
                           ("chatty.py", "print('ready')")):
            (FOLDER / name).write_text(text)
        python = f"directory: {FOLDER}, process: [{PYTHON}"
        for law, said in (("{process: [no_such_program_1]}", "refuses to start: no_such_program_1 cannot be run: No such file"),
                          (f"{{process: [{PYTHON}], directory: nowhere}}", "refuses to start: its directory .*nowhere.* cannot be entered"),
                          (f"{{{python}, silent.py]}}", r"ended itself \(exit code 0\) when it was started"),
                          (f"{{{python}, import.py]}}", r"ended itself \(exit code 1\) when it was started"),
                          (f"{{{python}, old.py]}}", "another version of the line protocol when it was started: .* version 1"),
                          (f"{{{python}, chatty.py]}}", "printed 'ready', which is no answer")):
            with self.subTest(law):
                self.check(law, said)

    def test_settings_that_do_not_fit(self):
        law = f"{{plugin: {LAWS}, options: right, terms: true}}"
        self.check("{}", "give either plugin, a shared library, or process")
        self.check(f"{{plugin: {LAWS}, process: [a]}}", "give either plugin")
        self.check("{process: []}", "give either plugin")
        self.check("{plugni: a.so}", "unknown key 'controller.law.plugni'.*did you mean 'plugin'")
        self.check("{plugin: a.so, time_limit: 0}", "controller.law.time_limit = 0: must be > 0")
        self.check(law, "a sampled law of your own may have a memory", "controller.sampling={period: 0.01}",
                   "output.restart_interval=0.1")
        self.check(law, "only operational_space has delayed forms", "controller.sampling={period: 0.01, delay: both}")
        self.check(law, "only operational_space without delay has it", "controller.singularity.policy=damped")


class Lines(unittest.TestCase):
    def test_what_a_program_is_told(self):
        script = FOLDER / "told.py"
        script.write_text(textwrap.dedent("""\
            import json, sys
            model = json.loads(sys.stdin.readline())
            assert model["protocol"] == 1 and "<robot" in model["urdf"] and model["options"] == 'a "b" ä', model
            assert (model["base"], model["tip"]) == ("base_link", "tip"), model
            assert model["joints"] == ["joint1", "joint2"] and model["rows"] == ["vx", "vz"], model
            assert model["gravity"] == [0, 0, -9.80665] and model["armature"] == [0.25, 0.5], model
            assert model["stiffness"] == [64] * 6 and model["period"] == 0, model
            print('{"protocol": 1}', flush=True)
            for line in sys.stdin:
                now = json.loads(line)
                shape = {key: len(now[key]) for key in ("q", "qd", "u", "null_space_torque", "M", "C", "G", "J", "Jdot_qd")}
                assert shape == dict(q=2, qd=2, u=2, null_space_torque=2, M=2, C=2, G=2, J=2, Jdot_qd=2), shape
                assert now["tip"].keys() == {"position", "orientation", "velocity"}, now
                for frame in (now["reference"], now["base"]):
                    assert [len(frame[key]) for key in ("position", "orientation", "velocity", "acceleration")] == [3, 4, 6, 6]
                assert now["base"]["orientation"] == [1, 0, 0, 0] and "tip_force" not in now, now
                print(json.dumps({"torque": now["G"]}), flush=True)
            """))
        law = f"process: [{PYTHON}, {script}], options: 'a \"b\" ä', terms: true"
        done = run(PLANAR, law, "model.armature=[0.25, 0.5]", "initial.qd=[0.5, -1]", duration=0.02)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)  # G alone is wrong, but an answer
        self.assertEqual(result(done.stdout, "linearization"), "FAIL")

    def test_numbers_pass_to_a_program_and_back_bit_for_bit(self):
        """The same law in C and in Python, with no room for rounding: the two result files are the same."""
        script = FOLDER / "springs.py"
        script.write_text(textwrap.dedent("""\
            import json, sys
            sys.stdin.readline()
            print('{"protocol": 1}', flush=True)
            for line in sys.stdin:
                now = json.loads(line)
                q, qd, G = now["q"], now["qd"], now["G"]
                print(json.dumps({"torque": [G[k] - 3.7 * qd[k] - 41.3 * (q[k] - 0.1 * k) for k in range(len(q))]}), flush=True)
            """))
        files = FOLDER / "c.h5", FOLDER / "python.h5"
        run(PLANAR, plugin("springs"), out=files[0])
        run(PLANAR, f"process: [{PYTHON}, {script}], terms: true", out=files[1])
        with h5py.File(files[0]) as a, h5py.File(files[1]) as b:
            self.assertGreater(len(a["step_time"]), 10)
            for name in ("trajectory/joint_position", "trajectory/joint_torque", "step_time", "verification/torque"):
                self.assertEqual(a[name][:].tobytes(), b[name][:].tobytes(), name)

    def test_the_example_in_python_is_short_and_right_when_sampled_too(self):
        self.assertLessEqual(len([line for line in EXAMPLE.read_text().splitlines() if line.strip()]), 20)
        done = run(PUMA, f"process: [{PYTHON}, {EXAMPLE}], terms: true", "controller.sampling={period: 0.01}", duration=0.1)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(result(done.stdout, "linearization"), "pass")


class Again(unittest.TestCase):
    def test_a_file_names_the_library_replays_with_it_and_tells_a_change(self):
        library, out = FOLDER / "mine.so", FOLDER / "mine.h5"
        library.write_bytes(EXAMPLE_C.read_bytes())
        self.assertEqual(run(PUMA, f"plugin: {library}, terms: true", out=out, duration=0.05).returncode, 0)
        digest = hashlib.sha256(library.read_bytes()).hexdigest()
        with h5py.File(out) as file:
            self.assertEqual(file["provenance/controller"].asstr()[()], f"{digest}  {library}\n")
            self.assertIn(str(library), file["provenance/experiment"].asstr()[()])
        done = call("replay", out)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn(f"its run had a controller of its own, '{library}', which would run with your rights", done.stderr)
        done = call("replay", out, "--run-controller")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("has changed", done.stdout)
        library.write_bytes(LAWS.read_bytes())
        self.assertIn(f"the controller has changed: {library} is not what it was, SHA-256 {digest}",
                      call("replay", out, "--run-controller").stdout)
        library.unlink()
        done = call("replay", out, "--run-controller")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertRegex(done.stderr, f"needs the controller's file {library} .*which is not there")

    def test_a_script_is_named_and_digests_of_every_length_are_right(self):
        script = FOLDER / "padded.py"
        for size in (0, 55, 56, 63, 64, 65):
            script.write_bytes(EXAMPLE.read_bytes() + b"#" * ((size - len(EXAMPLE.read_bytes())) % 64))
            out = FOLDER / "padded.h5"
            law = f"process: [{PYTHON}, padded.py], directory: {FOLDER}, terms: true"
            self.assertEqual(run(PUMA, law, out=out, duration=0.001).returncode, 0)
            with h5py.File(out) as file:
                lines = file["provenance/controller"].asstr()[()].splitlines()
            self.assertEqual(lines[1], f"{hashlib.sha256(script.read_bytes()).hexdigest()}  {script}")

    def test_a_sampled_one_is_not_resumed(self):
        out = FOLDER / "stopped.h5"
        self.assertEqual(run(PUMA, plugin("crash"), "controller.sampling={period: 0.01}", out=out).returncode, 3)
        done = call("resume", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("sampled law is one of your own, and what that remembers is not in the file", done.stderr)

    def test_a_continuous_one_is_resumed_when_it_has_been_mended(self):
        library, whole, stopped, resumed = (FOLDER / name for name in ("mended.so", "whole.h5", "crashed.h5", "resumed.h5"))
        law, restart = f"plugin: {library}, options: crash, terms: true", "output.restart_interval=0.02"
        library.write_bytes(LAWS.read_bytes())
        self.assertEqual(run(PUMA, law, restart, out=stopped).returncode, 3)
        library.unlink()
        library.write_bytes(EXAMPLE_C.read_bytes())  # the same law, which does not look at its options
        self.assertEqual(run(PUMA, law, restart, out=whole).returncode, 0)
        self.assertEqual(call("resume", stopped, "-o", resumed).returncode, 2)
        done = call("resume", stopped, "-o", resumed, "--run-controller")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("the controller has changed", done.stdout)
        self.assertIn("resumed from the restart point at t = 0.04 s", done.stdout)
        self.assertEqual(call("diff", whole, resumed).returncode, 0)


if __name__ == "__main__":
    unittest.main()
