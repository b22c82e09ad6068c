"""The figures of special situations and of sweeps: what is drawn against the numbers of the file, from short real runs.

Environment: as support.py says.
"""
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from support import LABEL, PROGRAM, ROOT, legend_texts, make_all, outside, overlaps, panels, plot, run, spans

import h5py
import numpy as np
from matplotlib.patches import Ellipse
from result import NotAResult, Result, Sweep, open_result

EPS = np.finfo(float).eps

PUMA = f"""
model: {{urdf: {ROOT}/models/puma560.urdf, base: base_link, tip: tool0, armature: [0.784, 2.325, 0.577, 0.191, 0.171, 0.194]}}
initial: {{q: [0, -0.8, 0.4, 0, 0.9, 0]}}
"""
EACH_AXIS = PUMA + """
reference: {type: each_axis, amplitude: [0.1, 0.1, 0, 0.03, 0.03, 0.03], period: 0.5}
controller: {law: operational_space, gains: {stiffness: 400, damping: 40}}
integrator: {rtol: 1e-9, atol: 1e-11}
duration: 2.4
"""
SINES = PUMA + """
reference: {type: multisine, row: vx, amplitude: 0.005, frequencies: [0.5, 1, 2, 4]}
controller:
  law: operational_space
  feedforward: false
  gains: {stiffness: [64, 64, 64, 400, 100, 100], damping: [8, 16, 20, 30, 12, 20]}
duration: 5
verify: {poles: true}
"""
TOUCH = PUMA + """
plant: {environment: {type: plane, point: [0, 0, 0.73], normal: [0, 0, 2], stiffness: 5000, damping: 60, friction: 0.2, v_s: 0.01}}
reference: {type: line, offset: [0, 0, 0, 0.05, 0.02, 0], duration: 0.3}
controller:
  law: operational_space
  gains: {stiffness: 100, damping: 20}
  compensate_tip_force: true
  force: {rows: [vz], desired: [-10], inertia: 1, damping: 40}
integrator: {method: runge_kutta, rtol: 1e-8, atol: 1e-10}
duration: 0.4
"""
POLICY = PUMA + """
reference: {type: line, offset: [0, 0, 0, 0.7, 0, 0], duration: 1}
controller: {law: operational_space, gains: {stiffness: 100, damping: 20}, singularity: {policy: truncated}}
integrator: {rtol: 1e-7, atol: 1e-9}
duration: 0.75
"""
SWEEP = PUMA + """
reference: {type: lissajous, amplitude: [0.2, 0.15, 0.1, 0.05, 0.08, 0.05], period: [2, 3, 2.5, 2, 2.5, 3]}
controller: {law: operational_space, gains: {stiffness: 100, damping: 20}}
integrator: {rtol: 1e-8, atol: 1e-10}
duration: 0.2
"""
NAMED = SWEEP + """
sweep:
  variants:
    as_given: {}
    heavy: {plant.payload.mass: 5}
    stops_at_once: {initial.q: [0, -0.8, 0.4, 0, 0, 0], expect.stop: singular}
    stops: {reference: {type: line, offset: [0, 0, 0, 0.7, 0, 0], duration: 0.3}, expect.stop: singular}
"""
NUMBERS = SWEEP + """
sweep: {key: plant.payload.mass, values: [0.5, 1, 2, 4]}
"""
WORDS = SWEEP + """
sweep: {key: controller.law, values: [operational_space, gravity_only]}
"""


class Situation(unittest.TestCase):
    """One experiment, run once, with its figures made once."""

    experiment, verb = None, "run"

    @classmethod
    def setUpClass(cls):
        if cls.experiment is None:
            raise unittest.SkipTest("the base of the others")
        cls.directory = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.directory)
        source = cls.experiment
        if not isinstance(source, Path):
            source = cls.directory / "experiment.yaml"
            source.write_text(cls.experiment)
        cls.file = cls.directory / "made.h5"
        assert run(source, cls.file, verb=cls.verb) == 0, f"{cls.__name__}: the {cls.verb} does not succeed"
        cls.result = open_result(cls.file)
        cls.addClassCleanup(cls.result.close)
        cls.raw = h5py.File(cls.file, "r")
        cls.addClassCleanup(cls.raw.close)
        cls.made, cls.left_out = make_all(cls.result)

    def check(self, *names):
        """Made, labelled with units, without texts on one another."""
        for name in names:
            self.assertIn(name, self.made)
            for axes in panels(self.made[name]):
                for text in (axes.get_xlabel(), axes.get_ylabel()):
                    if text:
                        self.assertRegex(text, LABEL, name)
            self.assertEqual(overlaps(self.made[name]), [], name)
            self.assertEqual(outside(self.made[name]), [], name)

    def assert_drawn(self, line, times, values):
        np.testing.assert_array_equal(line.get_xdata(), times)
        if line.axes.get_yscale() == "log":
            values = np.where(values > 0, values, np.nan)
        np.testing.assert_array_equal(line.get_ydata(), values)

    def assert_shaded(self, axes, holds):
        """Each recorded step lies in a shaded span if and only if the condition holds at its end."""
        steps = self.raw["step_time"][:]
        middle = (np.concatenate([[0], steps[:-1]]) + steps) / 2
        real = middle < steps  # steps of length 0 have no inside
        shaded = np.any([(low < middle) & (middle < high) for low, high in spans(axes)] or [np.zeros(len(steps), bool)], axis=0)
        np.testing.assert_array_equal(shaded[real], holds[real])


class CrossCoupling(Situation):
    experiment = EACH_AXIS

    def test_cells_hold_the_numbers_of_the_file(self):
        self.check("cross_coupling")
        figure = self.made["cross_coupling"]
        values, when = self.raw["measured/cross_coupling"][:], self.raw["measured/cross_coupling_time"][:]
        self.assertTrue(np.isnan(values[2]).all())  # wz is passed over
        self.assertTrue(np.isfinite(np.delete(values, 2, axis=0)).all())
        maps = [axes for axes in figure.axes if axes.images]
        self.assertEqual(len(maps), 2)
        for axes, columns in zip(maps, (slice(0, 3), slice(3, 6))):
            self.assertEqual([text.get_text() for text in axes.get_xticklabels()], ["wx wy wz", "vx vy vz"][columns.start // 3].split())
            self.assertEqual(len(axes.texts), 18)
            for text, value, at in zip(axes.texts, values[:, columns].ravel(), when[:, columns].ravel()):
                self.assertEqual(text.get_text(), "not alone" if np.isnan(value) else f"{value:.1e}\n{at:.3g} s" if value > 0 else "0")
            shown = axes.images[0].get_array()
            np.testing.assert_array_equal(np.ma.getmaskarray(shown), np.isnan(values[:, columns]))
            positive = values[:, columns] > 0
            np.testing.assert_array_equal(shown.data[positive], values[:, columns][positive])
        bars = [axes.get_xlabel() for axes in figure.axes if not axes.images]
        self.assertEqual([text[-6:].split("[")[1] for text in bars], ["rad]", "m]"])

    def test_growth_is_drawn_with_the_fit_of_the_run(self):
        self.check("error_growth")
        axes, = panels(self.made["error_growth"])
        self.assertEqual((axes.get_xscale(), axes.get_yscale(), len(axes.lines)), ("log", "log", 4))
        time, error = self.raw["growth_time"][:], self.raw["measured/error_growth"][:]
        self.assert_drawn(axes.lines[0], time, error)
        fit = axes.lines[2]
        slope = np.diff(np.log(fit.get_ydata()[[0, -1]])) / np.diff(np.log(fit.get_xdata()[[0, -1]]))
        exponent = float(self.raw["measured/growth_exponent"][()])
        self.assertAlmostEqual(float(slope), exponent, delta=1e-12 * max(1, abs(exponent)))
        self.assertIn(f"{exponent:.2f}", fit.get_label())
        peak = np.maximum.accumulate(error)
        later = time >= fit.get_xdata()[0]
        drawn = axes.lines[1].get_ydata()  # the largest so far, at least rounding
        self.assertTrue((drawn >= peak).all())
        np.testing.assert_array_equal(drawn[peak > drawn.min()], peak[peak > drawn.min()])
        off = np.log(fit.get_ydata()) - np.log(drawn[later])
        self.assertLess(abs(off.mean()), 1e-9)  # through the middle of what it fits
        self.assertEqual(set(axes.lines[3].get_ydata()), {float(self.raw["global_error/position"][()])})
        self.assertEqual(float(self.raw["global_error/position"][()]), error.max())


class Sines(Situation):
    experiment = SINES

    def test_bode(self):
        self.check("frequency_response")
        gain, phase, error = panels(self.made["frequency_response"])
        data = {name: self.raw["frequency_response/" + name][:] for name in self.raw["frequency_response"]}
        frequency = self.raw["frequency"][:]
        self.assertEqual(list(frequency), [0.5, 1, 2, 4])
        self.assertEqual([len(axes.lines) for axes in (gain, phase, error)], [2, 2, 2])
        K, D = 400, 30  # of vx
        fine = gain.lines[0].get_xdata()
        self.assertGreater(len(fine), 100)  # a curve, not the four points
        s = 2j * np.pi * fine
        design = K / (K + s**2 + D * s)
        np.testing.assert_allclose(gain.lines[0].get_ydata(), np.abs(design), rtol=1e-12)
        np.testing.assert_allclose(np.exp(1j * phase.lines[0].get_ydata()), design / np.abs(design), atol=1e-12)
        self.assert_drawn(gain.lines[1], frequency, data["gain"])
        np.testing.assert_allclose(phase.lines[1].get_ydata(), data["phase"], atol=16 * EPS)
        self.assert_drawn(error.lines[0], frequency, data["error"])
        self.assert_drawn(error.lines[1], frequency, data["bound"])

    def test_poles(self):
        self.check("poles")
        plane, distance = panels(self.made["poles"])
        designed, found = plane.lines[:2]
        np.testing.assert_array_equal(designed.get_xdata(), self.raw["poles/designed_real"][:])
        np.testing.assert_array_equal(designed.get_ydata(), self.raw["poles/designed_imag"][:])
        np.testing.assert_array_equal(found.get_xdata(), self.raw["poles/found_real"][:])
        self.assertEqual(len(found.get_xdata()), 12)
        # s^2 + 16 s + 64 and s^2 + 20 s + 100 have double roots; the others are simple.
        self.assertEqual(sorted(text.get_text() for text in plane.texts), ["×2", "×2"])
        bound = self.result.verdicts()["poles"].bound
        self.assertEqual(set(distance.lines[1].get_ydata()), {bound})
        self.assertLess(np.nanmax(distance.lines[0].get_ydata()), bound)
        self.assertEqual(len(distance.lines[0].get_ydata()), 12)


class Contact(Situation):
    experiment = TOUCH

    def test_contact(self):
        self.check("contact")
        gap, pressure, force = panels(self.made["contact"])  # a point contact has no moment
        time, wrench = self.raw["time"][:], self.raw["trajectory/tip_force"][:]
        self.assertFalse(wrench[:, :3].any())
        self.assert_drawn(gap.lines[0], time, self.raw["contact/gap"][:])
        self.assert_drawn(pressure.lines[0], time, self.raw["contact/pressure"][:])
        self.assertEqual(list(pressure.lines[1].get_ydata()), [10, 10])  # the tip pushes down, the normal points up
        self.assertEqual(legend_texts(force), ["x", "y", "z", "desired z", "tip in contact"])
        for line, values in zip(force.lines[:3], wrench[:, 3:].T):
            self.assert_drawn(line, time, values)
        self.assertEqual(list(force.lines[3].get_ydata()), [10, 10])
        self.assertLess(abs(wrench[-1, 5] - 10), 0.1)  # and that is what comes about
        touching = self.raw["solver/contact"][:] > 0
        self.assertTrue(touching.any() and not touching.all())
        for axes in (gap, pressure, force):
            self.assert_shaded(axes, touching)

    def test_departure_leaves_out_the_row_whose_force_is_controlled(self):
        self.check("departure")
        axes = panels(self.made["departure"])[3]
        error = self.raw["trajectory/pose_error"][:]
        self.assert_drawn(axes.lines[0], self.raw["time"][:], np.linalg.norm(error[:, 3:5], axis=1))
        self.assertEqual(legend_texts(axes), ["tracking error (vx, vy)", "tip in contact"])


class Policy(Situation):
    experiment = POLICY

    def test_departure(self):
        self.check("departure")
        shown = panels(self.made["departure"])
        truncated = self.raw["solver/truncated"][:] > 0
        self.assertTrue(truncated.any() and not truncated.all())
        for axes, part in zip(shown, ("angular", "linear")):
            self.assert_drawn(axes.lines[0], self.raw["step_time"][:], self.raw[f"departure/{part}_acceleration"][:])
        error = self.raw["trajectory/pose_error"][:]
        for axes, part in zip(shown[2:], (slice(0, 3), slice(3, 6))):
            self.assert_drawn(axes.lines[0], self.raw["time"][:], np.linalg.norm(error[:, part], axis=1))
        for axes in shown:
            self.assert_shaded(axes, truncated)
            self.assertEqual(legend_texts(axes)[1:], ["directions truncated"])

    def test_rows_that_are_not_commanded(self):
        self.check("cross_coupling")
        words = [text.get_text() for axes in self.made["cross_coupling"].axes for text in axes.texts]
        self.assertEqual(words.count("not alone"), 30)  # all but vx


class Redundant(Situation):
    experiment = ROOT / "experiments" / "arm7_lissajous.yaml"

    @classmethod
    def setUpClass(cls):
        cls.experiment = cls.experiment.read_text().replace("../models", f"{ROOT}/models").replace("duration: 12", "duration: 2")
        super().setUpClass()

    def test_self_motion(self):
        self.check("self_motion")
        energy, share, velocity = panels(self.made["self_motion"])
        time, own, kinetic = self.raw["time"][:], self.raw["energy/self_motion"][:], self.raw["energy/kinetic"][:]
        self.assert_drawn(energy.lines[0], time, kinetic)
        self.assert_drawn(energy.lines[1], time, own)
        moving = kinetic > 0
        np.testing.assert_array_equal(share.lines[0].get_ydata()[moving], own[moving] / kinetic[moving])
        self.assertEqual(len(velocity.lines), 7)
        for i, line in enumerate(velocity.lines):
            self.assert_drawn(line, time, self.raw["trajectory/joint_velocity"][:, i])

    def test_manipulability(self):
        self.check("manipulability")
        mass, inertia, sigma, condition, path = panels(self.made["manipulability"])
        time = self.raw["time"][:]
        for axes, name in ((mass, "effective_mass"), (inertia, "effective_inertia")):
            self.assertEqual(legend_texts(axes), ["smallest", "middle", "largest"])
            for i, line in enumerate(axes.lines):
                self.assert_drawn(line, time, self.raw["operational_space/" + name][:, i])
        self.assert_drawn(sigma.lines[0], time, self.raw["operational_space/sigma_min"][:])
        self.assert_drawn(condition.lines[0], time, self.raw["operational_space/cond_Omega"][:])

        position = self.raw["trajectory/tip_position"][:]
        least = int(np.argmin(np.ptp(position, axis=0)))
        plane = [i for i in range(3) if i != least]
        self.assertEqual([axes[0] for axes in (path.get_xlabel(), path.get_ylabel())], ["xyz"[i] for i in plane])
        np.testing.assert_array_equal(path.lines[0].get_xydata(), position[:, plane])
        ellipses = [patch for patch in path.patches if isinstance(patch, Ellipse)]
        self.assertGreater(len(ellipses), 3)
        scale, corners = [], np.linspace(0, 2 * np.pi, 720)
        for ellipse in ellipses:
            at = int(np.argmin(np.linalg.norm(position[:, plane] - ellipse.center, axis=1)))
            half = self.raw["operational_space/effective_mass"][at][:, None] * self.raw["operational_space/effective_mass_axes"][at]
            turn = np.radians(ellipse.angle)
            along = np.array([np.cos(turn), np.sin(turn)])
            across = np.array([-along[1], along[0]])
            for direction in np.array([np.cos(corners), np.sin(corners)]).T[::90]:
                # furthest points in this direction: of the ellipsoid in space, and of what is drawn
                inside = np.linalg.norm(half[:, plane] @ direction)
                drawn = np.hypot(ellipse.width / 2 * (along @ direction), ellipse.height / 2 * (across @ direction))
                scale.append(drawn / inside)
        np.testing.assert_allclose(scale, scale[0], rtol=1e-9)
        bar = next(line for line in path.lines if line.get_linewidth() > 2)
        kilograms = float(path.texts[0].get_text().split()[3])
        self.assertAlmostEqual(np.ptp(bar.get_xdata()) / kilograms / scale[0], 1, delta=1e-9)


class Named(Situation):
    experiment, verb = NAMED, "sweep"

    def test_bars(self):
        self.assertIsInstance(self.result, Sweep)
        self.assertEqual(self.left_out, {"slopes": "the variants have names: see comparison"})
        self.check("comparison")
        shown = panels(self.made["comparison"])
        self.assertEqual([axes.get_xlabel() for axes in shown], ["position error of the tip [mm]", "orientation error of the tip [mrad]"])
        self.assertEqual([text.get_text() for text in shown[0].get_yticklabels()], list(self.raw["variant"].asstr()))
        status = list(self.raw["status"].asstr())
        self.assertEqual(status, ["complete", "complete", "failed", "failed"])
        for axes, part in zip(shown, ("position", "orientation")):
            self.assertEqual(axes.get_xscale(), "log")
            worst = 1e3 * self.raw["tip_error_" + part][:]
            for bar, value in zip(axes.patches, worst[:2]):
                self.assertAlmostEqual((bar.get_x() + bar.get_width()) / value, 1, delta=4 * EPS)
            self.assertEqual(axes.texts[1].get_text().strip(), f"{worst[1]:.3g}")
            self.assertEqual(axes.texts[2].get_text().strip(), "failed")
            self.assertIn("failed at", axes.texts[3].get_text())
            np.testing.assert_array_equal(axes.lines[0].get_xdata()[:2], 1e3 * self.raw[f"tip_error_{part}_rms"][:2])

    def test_command(self):
        done = plot(self.file, "-o", self.directory / "figures", "--format", "png")
        self.assertEqual((done.returncode, done.stderr), (0, "plot.py: slopes left out: the variants have names: see comparison\n"))
        self.assertEqual([path.name for path in (self.directory / "figures").iterdir()], ["comparison.png"])
        done = plot(self.file, "-o", self.directory / "none", "--only", "tip")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", "plot.py: tip left out: it is not a figure of a sweep\n"))

    def test_a_sweep_that_was_killed(self):
        path = self.directory / "killed.h5"
        shutil.copy(self.file, path)
        with h5py.File(path, "r+") as file:
            for name in [name for name in file if name not in ("variant", "changes", "provenance")]:
                del file[name]
        with open_result(path) as result:
            self.assertIsInstance(result, Sweep)
            self.assertEqual(make_all(result), ({}, {name: "the sweep was not finished: it has no numbers" for name in ("comparison", "slopes")}))


class Numbers(Situation):
    experiment, verb = NUMBERS, "sweep"

    def test_slopes(self):
        self.assertEqual(list(self.left_out), ["comparison"])
        self.check("slopes")
        figure = self.made["slopes"]
        slope = dict(zip(self.raw["slopes/quantity"].asstr(), self.raw["slopes/slope"]))
        expected = (
            ("tip_error_position", "tip_error_position_rms", "global_error_position"),  # plant is not model: no closed form
            ("tip_error_orientation", "tip_error_orientation_rms", "global_error_orientation"),
            ("missed_acceleration_linear",),
            ("missed_acceleration_angular",),
        )
        self.assertEqual(len(panels(figure)), 4)
        for axes, names in zip(panels(figure), expected):
            self.assertEqual((axes.get_xscale(), axes.get_yscale()), ("log", "log"))
            self.assertEqual(axes.get_xlabel(), "plant.payload.mass [kg]")
            self.assertEqual(len(axes.lines), 2 * len(names))
            for name, points, line in zip(names, axes.lines[::2], axes.lines[1::2]):
                self.assert_drawn(points, [0.5, 1, 2, 4], self.raw[name][:])
                x, y = np.log(line.get_xdata()), np.log(line.get_ydata())
                self.assertAlmostEqual((y[1] - y[0]) / (x[1] - x[0]), slope[name], delta=1e-12)
                self.assertTrue(points.get_label().endswith(f"slope {slope[name]:.2f}"))
                middle = np.mean(np.log(self.raw[name][:]))  # least squares go through the mean
                self.assertAlmostEqual(y.mean(), middle, delta=1e-12 * abs(middle) + slope[name] * 1e-12)


class Words(Situation):
    experiment, verb = WORDS, "sweep"

    def test_words_are_names(self):
        self.check("comparison")
        self.assertEqual(list(self.left_out), ["slopes"])
        names = [text.get_text() for text in panels(self.made["comparison"])[0].get_yticklabels()]
        self.assertEqual(names, ["operational_space", "gravity_only"])


class Running(unittest.TestCase):
    def test_a_run_that_goes_on_while_it_is_drawn(self):
        directory = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, directory)
        (directory / "long.yaml").write_text(EACH_AXIS + "output: {interval: 0.001}\n")
        file = directory / "long.h5"
        command = [PROGRAM, "run", str(directory / "long.yaml"), "-o", str(file), "--quiet", "--set", "duration=100000"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)

        def wait_for(what):
            for _ in range(600):
                if what():
                    return
                time.sleep(0.05)
            self.fail("the run does not go on")

        def started():
            try:
                with Result(file) as result:
                    return len(result.read("step_time")) > 0
            except NotAResult:  # not yet there
                return False

        def longer():  # h5py sees new rows after a refresh only
            for name in ("step", "step_time"):
                result.file[name].id.refresh()
            return result.file["step"].shape[0] > len(missed)

        wait_for(started)
        with Result(file) as result:
            missed = result.read("departure/linear_acceleration")
            wait_for(longer)
            self.assertEqual(len(result.read("step_time")), len(missed))
            made, left_out = make_all(result)
        self.assertEqual(made["departure"]._suptitle.get_text().split("\n")[1], "unfinished run, no verdict")
        self.assertEqual(len(panels(made["departure"])[0].lines[0].get_xdata()), len(missed))
        self.assertIn("not finished", left_out["error_growth"])


class Free(Situation):
    experiment = PUMA + "controller: {law: free}\nduration: 0.1\n"

    def test_no_command_to_depart_from(self):
        self.assertEqual(self.left_out["departure"], "the law commands no acceleration of the tip")
        self.assertIn("manipulability", self.made)
        self.assertIsInstance(self.result, Result)


if __name__ == "__main__":
    unittest.main()
