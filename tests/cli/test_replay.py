"""Replay, diff and resume: what becomes of result files later."""
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import time
import unittest

import h5py
import numpy as np

from test_cli import PROGRAM, ROOT, InFolder, call

FAULTY = os.environ["OSCULATE_FAULTY"]
EXPERIMENTS = ROOT / "experiments"
LEFT_OUT = ("provenance", "timing")


def settings(*changes):
    return [word for change in changes for word in ("--set", change)]


def values_of(path):
    """Every dataset outside /provenance and /timing, as numpy reads it."""
    out = {}
    with h5py.File(path) as file:
        def add(name, item):
            if isinstance(item, h5py.Dataset) and name.split("/")[0] not in LEFT_OUT:
                out[name] = item[()]
        file.visititems(add)
    return out


def same_bits(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and (
        list(a.flat) == list(b.flat) if a.dtype == object else a.tobytes() == b.tobytes())


def flip(path, dataset, index, bit):
    """Flips one bit of one double in the file. Returns the values before and after."""
    with h5py.File(path, "r+") as file:
        before = float(file[dataset][index])
        bits = struct.unpack("<Q", struct.pack("<d", before))[0] ^ (1 << bit)
        after = struct.unpack("<d", struct.pack("<Q", bits))[0]
        file[dataset][index] = after
    return before, after


class WithResults(InFolder):
    def result(self, name, experiment, *changes, program=PROGRAM, env=None, code=0):
        out = self.folder / name
        done = call("run", EXPERIMENTS / f"{experiment}.yaml", "-o", out, *settings(*changes), program=program, env=env)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return out

    def identical(self, a, b):
        done = call("diff", a, b)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertIn("identical, bit for bit", done.stdout)
        mine, yours = values_of(a), values_of(b)  # the same by another reader
        self.assertEqual(list(mine), list(yours))
        for name in mine:
            self.assertTrue(same_bits(np.asarray(mine[name]), np.asarray(yours[name])), name)


class Diff(WithResults):
    CIRCLE = ("puma560_circle", "duration=0.5", "plant.payload.mass=1")

    def test_the_same_experiment_twice_gives_the_same_bits(self):
        self.identical(self.result("a.h5", *self.CIRCLE), self.result("b.h5", *self.CIRCLE))

    def test_one_bit(self):
        a = self.result("a.h5", *self.CIRCLE)
        with h5py.File(a) as file:
            t = file["time"][37]
        for bit in (0, 3, 40):
            b = self.folder / f"bit{bit}.h5"
            shutil.copy(a, b)
            before, after = flip(b, "trajectory/joint_position", (37, 2), bit)
            done = call("diff", a, b)
            self.assertEqual(done.returncode, 1)
            ulps = 2**bit
            self.assertIn(f"t = {t:.17g} s, row 37 along time, trajectory/joint_position[37, joint3], "
                          f"{ulps} ulp{'s' if ulps > 1 else ''}\n", done.stdout)
            self.assertIn(f"{before:.17g}  in {a}", done.stdout)
            self.assertIn(f"{after:.17g}  in {b}", done.stdout)

    def test_the_earliest_time_comes_first(self):
        a = self.result("a.h5", *self.CIRCLE)
        b = self.folder / "b.h5"
        shutil.copy(a, b)
        with h5py.File(a) as file:
            late, early = 30, int(np.searchsorted(file["step_time"][:], 0.1))
            t = file["step_time"][early]
            self.assertLess(t, file["time"][late])
        flip(b, "trajectory/joint_position", (late, 0), 0)
        flip(b, "solver/step_size", early, 1)
        flip(b, "measured/position_error", (), 2)
        done = call("diff", a, b)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"t = {t:.17g} s, row {early} along step, solver/step_size[{early}], 2 ulps", done.stdout)
        for name, ulps in (("trajectory/joint_position", 1), ("solver/step_size", 2), ("measured/position_error", 4)):
            self.assertRegex(done.stdout, rf"(?m)^{name} +1 .* {ulps}$")

    def test_what_is_no_number_or_no_value(self):
        a = self.result("a.h5", *self.CIRCLE)
        b = self.folder / "b.h5"

        def changed(change):
            shutil.copy(a, b)
            with h5py.File(b, "r+") as file:
                change(file)
            done = call("diff", a, b)
            self.assertEqual(done.returncode, 1, done.stdout)
            return done.stdout

        def to(name, index, value):
            def change(file):
                file[name][index] = value
            return change

        quiet = struct.unpack("<d", struct.pack("<Q", 0x7FF8000000000001))[0]
        with h5py.File(a) as file:
            self.assertTrue(np.isnan(file["trajectory/command"][()]).sum() == 0)
        self.assertIn("not a number", changed(to("trajectory/command", (3, 0), quiet)))
        # two NaNs with different bits are different, with the same bits the same
        c = self.folder / "c.h5"
        shutil.copy(a, c)
        with h5py.File(c, "r+") as file:
            file["trajectory/command"][3, 0] = quiet
        shutil.copy(c, b)
        self.assertEqual(call("diff", b, c).returncode, 0)
        with h5py.File(b, "r+") as file:
            file["trajectory/command"][3, 0] = np.nan
        self.assertEqual(call("diff", b, c).returncode, 1)
        # the start is at rest: zeros, whose sign counts
        with h5py.File(a) as file:
            self.assertEqual(struct.pack("<d", file["trajectory/joint_velocity"][0, 0]), bytes(8))
        self.assertIn("the sign of zero", changed(to("trajectory/joint_velocity", (0, 0), -0.0)))
        self.assertIn("first divergence: verdict/claim[2]\n  'c'  in", changed(to("verdict/claim", 2, "cc")))
        self.assertIn("attribute units: 'm' against 'mm'",
                      changed(lambda file: file["trajectory/tip_position"].attrs.__setitem__("units", "mm")))
        self.assertIn("only in the first file", changed(lambda file: file.__delitem__("energy/work")))
        self.assertIn("only in the second file", changed(lambda file: file.create_dataset("more", data=1.0)))
        self.assertIn("attribute title", changed(lambda file: file.attrs.__setitem__("title", "other")))
        shorter = changed(lambda file: file["trajectory/tip_position"].resize(40, 0))
        self.assertIn("51 against 40 rows", shorter)
        self.assertIn("row 40 along time, trajectory/tip_position[40]", shorter)

    def test_provenance_and_timing_do_not_count_but_the_build_is_named(self):
        a = self.result("a.h5", *self.CIRCLE)
        b = self.folder / "b.h5"
        shutil.copy(a, b)
        with h5py.File(b, "r+") as file:
            file["provenance/compiler"][()] = "another one"
            file["timing/checking"][()] = 1e9
        done = call("diff", a, b)
        self.assertEqual(done.returncode, 0)
        self.assertIn("build or processor differ", done.stdout)
        self.assertRegex(done.stdout, "compiler: '.*' against 'another one'")

    def test_another_program(self):
        # The faulty copy of the program with a fault that acts from the first evaluation on.
        a = self.result("a.h5", "puma560_circle", "duration=0.3")
        env = dict(os.environ, OSCULATE_FAULT="reference_acceleration")
        b = self.folder / "b.h5"
        call("run", EXPERIMENTS / "puma560_circle.yaml", "-o", b, *settings("duration=0.3"), program=FAULTY, env=env)
        done = call("diff", a, b)
        self.assertEqual(done.returncode, 1)
        mine, yours = values_of(a), values_of(b)
        times = {"time": mine["time"], "step": mine["step_time"]}
        first = []
        with h5py.File(a) as file:
            for number, (name, x) in enumerate(mine.items()):
                axis = file[name].dims[0][0].name[1:] if file[name].ndim and len(file[name].dims[0]) else None
                y = yours[name]
                if axis not in times:
                    continue
                rows = min(len(x), len(y))
                off = (x[:rows].view("u8") if x.dtype == float else x[:rows]) != (
                    y[:rows].view("u8") if y.dtype == float else y[:rows])
                row = np.flatnonzero(off.reshape(rows, -1).any(axis=1))
                if len(row):
                    first.append((times[axis][row[0]], axis, int(row[0])))
        t = min(first)[0]
        said = done.stdout.splitlines()
        line = next(line for line in said if line.startswith("first divergence"))
        self.assertIn(f"t = {t:.17g} s, row ", line)
        self.assertTrue(any(f"row {row} along {axis}," in line for time_, axis, row in first if time_ == t), line)

    def test_bad_input(self):
        a = self.result("a.h5", *self.CIRCLE)
        text = self.folder / "text.h5"
        text.write_text("no HDF5")
        for other in (text, self.folder / "missing.h5", self.folder):
            self.assertEqual(call("diff", a, other).returncode, 4)
        self.assertEqual(call("diff", a).returncode, 2)


class Replay(WithResults):
    def moved_away(self, experiment, *changes, command="run"):
        """A result whose experiment, model and waypoints are gone."""
        place = self.folder / "place"
        for name in ("experiments", "models"):
            shutil.copytree(ROOT / name, place / name, ignore=shutil.ignore_patterns("*.py", "*.md"))
        out = self.folder / "away" / "result.h5"
        out.parent.mkdir()
        done = call(command, place / "experiments" / f"{experiment}.yaml", "-o", out, *settings(*changes))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        shutil.rmtree(place)
        return out

    def test_from_the_file_alone(self):
        for number, (experiment, *changes) in enumerate((
                ("puma560_circle", "duration=0.3", "plant.mass_scale=1.1", "plant.share_kinematics=false",
                 "verify.poles=true"),
                ("puma560_obstacle", "duration=0.3"),
                ("prismatic_arm_waypoints", "duration=0.4"),
                ("puma560_missing_terms", "duration=0.2", "expect={}", "controller.law=no_coriolis"),
                ("puma560_two_sweeps", "duration=0.2"))):
            with self.subTest(experiment):
                out = self.moved_away(experiment, *changes)
                done = call("replay", out)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertIn("identical, bit for bit", done.stdout)
                self.assertEqual([path.name for path in out.parent.iterdir()], ["result.h5"])
                shutil.rmtree(out.parent)

    def test_of_a_sweep(self):
        out = self.moved_away("puma560_circle", "duration=0.1", "verify.shadow=false",
                              "sweep={variants: {a: {}, b: {model.urdf: ../models/puma560_akb86.urdf}, "
                              "c: {'reference': {type: waypoints, file: prismatic_arm_waypoints.csv}}}}",
                              "controller.gains.stiffness=1", command="sweep")
        done = call("replay", out)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("identical, bit for bit", done.stdout)

    def test_a_difference_and_a_kept_result(self):
        out = self.result("a.h5", "puma560_circle", "duration=0.3")
        before, after = flip(out, "trajectory/tip_position", (12, 1), 4)
        kept = self.folder / "kept.h5"
        done = call("replay", out, "-o", kept)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("row 12 along time, trajectory/tip_position[12, y], 16 ulps", done.stdout)
        self.assertEqual(values_of(kept)["trajectory/tip_position"][12, 1], before)
        self.assertEqual(call("diff", out, kept).returncode, 1)
        self.assertEqual(call("replay", out, "-o", kept).returncode, 4)  # exists already
        self.assertEqual(call("replay", out, "-o", kept, "--force").returncode, 1)

    def test_another_build_is_named(self):
        out = self.result("a.h5", "puma560_circle", "duration=0.1")
        with h5py.File(out, "r+") as file:
            file["provenance/cpu_features"][()] = "abacus"
        done = call("replay", out)
        self.assertEqual(done.returncode, 0)
        self.assertIn("cpu_features: 'abacus' against", done.stdout)
        done = call("replay", out, program=FAULTY, env={"OSCULATE_FAULT": "law_damping"})
        self.assertEqual(done.returncode, 1)
        self.assertIn("first divergence: t = ", done.stdout)

    def test_bad_input(self):
        plain = self.folder / "plain.h5"
        with h5py.File(plain, "w") as file:
            file["x"] = 1
        self.assertEqual(call("replay", plain).returncode, 4)
        out = self.result("a.h5", "puma560_circle", "duration=0.1")
        with h5py.File(out, "r+") as file:
            del file["provenance/model"]
        done = call("replay", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no /provenance/model", done.stderr)


class Resume(WithResults):
    def stopped(self, experiment, changes, number, points=1):
        """A run that the signal ended after so many restart points, or a few more."""
        return self.stop(self.folder / "stopped.h5", number, points,
                         "run", EXPERIMENTS / f"{experiment}.yaml", *settings(*changes))

    def stop(self, out, number, points, *command):
        wanted = -signal.SIGKILL if number == signal.SIGKILL else 128 + number
        for _ in range(20):  # it may be over before the signal comes
            out.unlink(missing_ok=True)
            run = subprocess.Popen([PROGRAM, *command, "-o", out, "--quiet"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            until = time.monotonic() + 60
            while time.monotonic() < until and run.poll() is None:
                try:
                    with h5py.File(out, "r", libver="latest", swmr=True) as file:
                        if points == 0 or len(file["restart_time"]) >= points:
                            break
                except (OSError, KeyError):
                    pass
            run.send_signal(number)
            if run.wait(timeout=60) == wanted:
                return out
        self.fail("the run was always too fast for the signal")

    def resumed(self, out, *more):
        target = self.folder / "resumed.h5"
        done = call("resume", out, "-o", target, "--force", *more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return target, done.stdout

    CASES = {
        # continuous laws: smooth, with jumps, with contact, with an obstacle, with a fit and poles
        "puma560_circle": ("duration=3", "output.restart_interval=0.5"),
        "puma560_each_axis": ("duration=4", "output.restart_interval=0.75", "reference.period=1"),
        "puma560_touch": ("output.restart_interval=0.3",),
        "puma560_force": ("output.restart_interval=0.4",),
        "puma560_obstacle": ("output.restart_interval=0.3", "integrator.method=bdf", "integrator.rtol=1e-7"),
        "puma560_frequency": ("duration=12", "output.restart_interval=0.7"),  # stopped in the midst of the fit
        "puma560_wrist_truncated": ("output.restart_interval=0.3",),
        "prismatic_arm_waypoints": ("output.restart_interval=0.5",),
        # sampled laws: with values of old samples, sensors, a late torque, a slow monitor
        "puma560_sampled": ("output.restart_interval=0.2", "integrator.method=adams"),
        "puma560_two_sweeps": ("duration=1.5", "output.restart_interval=0.21"),
        "puma560_old_force": ("duration=1.5", "output.restart_interval=0.21", "verify.shadow=false"),
        "puma560_encoders": ("output.restart_interval=0.1",),
        "puma560_late_torque": ("output.restart_interval=0.1",),
        "puma560_hybrid": ("duration=2", "output.restart_interval=0.1", "verify.record=worst"),
    }

    def test_a_killed_run_goes_on_as_if_nothing_had_been(self):
        for experiment, changes in self.CASES.items():
            with self.subTest(experiment):
                whole = self.folder / "whole.h5"
                done = call("run", EXPERIMENTS / f"{experiment}.yaml", "-o", whole, "--force", *settings(*changes))
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                out = self.stopped(experiment, changes, signal.SIGKILL, points=12 if "frequency" in experiment else 1)
                target, said = self.resumed(out)
                self.assertIn("resumed from the restart point at t = ", said)
                self.identical(whole, target)

    def test_interrupted_twice_and_replayed(self):
        changes = ("duration=6", "output.restart_interval=0.5")
        whole = self.result("whole.h5", "puma560_circle", *changes)
        out = self.stopped("puma560_circle", changes, signal.SIGINT, points=2)
        with h5py.File(out) as file:
            self.assertEqual(file.attrs["status"], "interrupted")
        done = call("replay", out)  # of what there is
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("was stopped (status interrupted)", done.stdout)
        again = self.stop(self.folder / "again.h5", signal.SIGKILL, 7, "resume", out)
        target, said = self.resumed(again)
        self.assertIn("resumed from the restart point at t = ", said)
        self.identical(whole, target)
        self.assertEqual(call("replay", target).returncode, 0)

    def test_recovered_first(self):
        changes = ("duration=6", "output.restart_interval=0.5")
        whole = self.result("whole.h5", "puma560_circle", *changes)
        out = self.stopped("puma560_circle", changes, signal.SIGKILL, points=2)
        recovered = self.folder / "recovered.h5"
        self.assertEqual(call("recover", out, "-o", recovered).returncode, 0)
        target, said = self.resumed(recovered)
        self.assertIn("resumed from the restart point", said)
        self.identical(whole, target)

    def test_without_a_point_it_begins_at_the_start(self):
        changes = ("duration=6",)
        out = self.stopped("puma560_circle", changes, signal.SIGKILL, points=0)
        target, said = self.resumed(out)
        self.assertIn("no restart point was reached: run again from the start", said)
        self.identical(self.result("whole.h5", "puma560_circle", *changes), target)

    def test_what_a_restart_must_not_change(self):
        """What a restart forgot would be missing in the measures of the run that had many."""
        for experiment in ("puma560_two_sweeps", "puma560_encoders", "puma560_touch", "puma560_each_axis"):
            with self.subTest(experiment):
                duration = () if experiment != "puma560_each_axis" else ("duration=4",)
                rare = self.result(f"{experiment}_rare.h5", experiment, *duration, "output.restart_interval=0")
                often = self.result(f"{experiment}_often.h5", experiment, *duration, "output.restart_interval=0.11")
                with h5py.File(rare) as a, h5py.File(often) as b:
                    self.assertNotIn("restart_time", a)
                    self.assertGreaterEqual(len(b["restart_time"]), 9)
                    np.testing.assert_array_equal(a["verdict/result"], b["verdict/result"])
                    names = ["trajectory/joint_position", "trajectory/joint_torque", "trajectory/tip_orientation",
                             "energy/work", "measured/cross_coupling", "measured/position_error",
                             "measured/mode_changes"]
                    if "sampling" in a["provenance/experiment"].asstr()[()]:  # the others have peaks of their own steps
                        names += ["measured/joint_torque_peak", "measured/joint_torque_peak_time"]
                        torque = list(a["verdict/claim"].asstr()).index("torque")
                        self.assertEqual(a["verdict/checked_steps"][torque], b["verdict/checked_steps"][torque])
                    for name in names:  # errors of the integration are all that may differ
                        if name in a:
                            np.testing.assert_allclose(b[name], a[name], rtol=2e-6, atol=2e-7, err_msg=name)
                    counts = b["solver/rhs_evaluations"][:]
                    self.assertTrue((np.diff(counts) >= 0).all())
                    self.assertGreaterEqual(counts[-1], a["solver/rhs_evaluations"][-1])

    def test_refusals(self):
        out = self.result("a.h5", "puma560_circle", "duration=0.1")
        done = call("resume", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("its run is complete", done.stderr)
        self.assertEqual(call("resume", self.folder / "missing.h5").returncode, 4)
        out = self.stopped("puma560_circle", ("duration=6", "output.restart_interval=0.5"), signal.SIGKILL)
        self.assertEqual(call("resume", out, "-o", out, "--force").returncode, 4)
        self.assertEqual(call("recover", out).returncode, 0)
        broken = self.folder / "stopped.recovered.h5"
        with h5py.File(broken, "r+") as file:
            file["restart/memory"][7] = np.inf  # a truth value
        done = call("resume", broken)
        self.assertEqual(done.returncode, 4)
        self.assertIn("cannot be used", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
