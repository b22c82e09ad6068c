"""The figures of a real, short run: every file made by the command, and what is drawn against the numbers of the file.

Environment: OSCULATE (the program), OSCULATE_SOURCE_DIR (the project's root).
"""
import math
import shutil
import tempfile
import unittest
from pathlib import Path

from support import LABEL, ROOT, legend_texts, make_all, outside, overlaps, panels, plot, run

import h5py
import numpy as np
from figures import FIGURES, SWEEP_FIGURES
from result import NotAResult, Result

ALONG_TIME = ("joints", "tip", "residuals", "energy", "solver", "condition", "global_error", "manipulability", "departure")
FOR_SOME = ("contact", "self_motion", "cross_coupling", "frequency_response", "poles")  # what this run has not


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.directory)
        cls.file = cls.directory / "short.h5"
        assert run(ROOT / "experiments" / "puma560_circle.yaml", cls.file, "duration=0.5") == 0, "the run does not succeed"
        cls.result = Result(cls.file)
        cls.addClassCleanup(cls.result.close)
        cls.made, cls.left_out = make_all(cls.result)
        cls.raw = h5py.File(cls.file, "r")
        cls.addClassCleanup(cls.raw.close)

    def assert_drawn(self, line, times, values):
        """The line shows these numbers, all of them, where a logarithmic axis can."""
        np.testing.assert_array_equal(line.get_xdata(), times)
        if line.axes.get_yscale() == "log":
            values = np.where(values > 0, values, np.nan)
        np.testing.assert_array_equal(line.get_ydata(), values)

    def test_every_axis_is_labelled_with_its_unit_and_every_figure_is_titled(self):
        for name, figure in self.made.items():
            self.assertEqual(figure._suptitle.get_text().split("\n")[-1], "verdict pass", name)
            self.assertTrue(figure._suptitle.get_text().startswith("puma560_circle: "), name)
            labels = [text for axes in panels(figure) for text in (axes.get_xlabel(), axes.get_ylabel()) if text]
            self.assertTrue(any(axes.get_xlabel() == "time [s]" for axes in panels(figure)), name)
            for text in labels:
                self.assertRegex(text, LABEL, name)

    def test_what_does_not_apply_is_left_out_with_a_reason(self):
        self.assertEqual(tuple(self.made), (*ALONG_TIME, "error_growth"))
        self.assertEqual(tuple(self.left_out), FOR_SOME)
        self.assertEqual(self.left_out["contact"], "the experiment has no surface to touch")
        self.assertEqual(self.left_out["self_motion"], "the arm is not redundant: 6 velocity coordinates, 6 task rows")
        self.assertIn("no axis was commanded alone", self.left_out["cross_coupling"])
        self.assertEqual(self.left_out["frequency_response"], "the reference is no sum of sines")
        self.assertEqual(self.left_out["poles"], "verify.poles is false")

    def test_joints(self):
        figure = self.made["joints"]
        names = self.result.read("joint")
        self.assertEqual(len(names), 6)
        self.assertEqual(len(panels(figure)), 3 * 6)
        expected = (
            ("joint_position", "position_unit", "position"),
            ("joint_velocity", "velocity_unit", "velocity"),
            ("joint_torque", "effort_unit", "torque"),
        )
        for column, (variable, unit, title) in enumerate(expected):
            for joint, axes in enumerate(panels(figure)[6 * column : 6 * column + 6]):
                self.assertEqual(axes.get_ylabel(), f"{names[joint]}\n[{self.result.read(unit)[joint]}]")
                self.assertEqual(axes.get_title(), title if joint == 0 else "")
                self.assertEqual(len(axes.lines), 1)
                self.assert_drawn(axes.lines[0], self.raw["time"][:], self.raw["trajectory/" + variable][:, joint])

    def test_tip(self):
        figure = self.made["tip"]
        planes = [(axes.get_xlabel(), axes.get_ylabel()) for axes in panels(figure) if axes.name == "rectilinear"]
        self.assertEqual(planes[:3], [("y [m]", "z [m]"), ("x [m]", "y [m]"), ("x [m]", "z [m]")])
        position = self.raw["trajectory/tip_position"][:]
        reference, tip, start = panels(figure)[0].lines
        np.testing.assert_array_equal(tip.get_xydata(), position[:, 1:])
        np.testing.assert_array_equal(reference.get_xydata(), self.raw["trajectory/reference_position"][:, 1:])
        np.testing.assert_array_equal(start.get_xydata(), position[:1, 1:])
        solid = [axes for axes in panels(figure) if axes.name == "3d"]
        self.assertEqual([axes.get_zlabel() for axes in solid], ["z [m]"])
        errors = panels(figure)[-2:]
        self.assertEqual([axes.get_ylabel() for axes in errors], ["position error [m]", "orientation error [rad]"])
        pose_error = self.raw["trajectory/pose_error"][:]
        for axes, part in zip(errors, (slice(3, 6), slice(0, 3))):
            self.assertEqual(len(axes.lines), 1)  # all rows are controlled
            self.assert_drawn(axes.lines[0], self.raw["time"][:], np.linalg.norm(pose_error[:, part], axis=1))

    def test_residuals(self):
        verdicts = self.result.verdicts()
        applicable = [name for name, row in verdicts.items() if row.result != -1]
        shown = panels(self.made["residuals"])
        self.assertEqual([axes.get_title(loc="left").split(":")[0] for axes in shown], applicable)
        self.assertEqual(len(applicable), len(verdicts) - 5)  # no null-space torque, coordinates, sines, poles, contact
        self.assertIn("null_space (no null-space torque)", self.made["residuals"]._supxlabel.get_text())
        steps = self.raw["step_time"][:]
        for axes, name in zip(shown, applicable):
            values, bounds = self.raw[f"verification/{name}"][:], self.raw[f"verification/{name}_bound"][:]
            undecided = ~(bounds <= 1e-3)
            failing = ~undecided & (values > bounds)
            texts = ["residual", "bound"] + ["failing"] * int(failing.any()) + ["undecided"] * int(undecided.any())
            self.assertEqual(legend_texts(axes), texts, name)
            self.assert_drawn(axes.lines[0], steps, values)
            self.assert_drawn(axes.lines[1], steps, bounds)
            if undecided.any():
                np.testing.assert_array_equal(axes.lines[-1].get_xdata(), steps[undecided])

    def test_energy(self):
        top, middle, bottom = panels(self.made["energy"])
        labels = ["energy [J]", "imbalance [J]", "relative imbalance [1]"]
        self.assertEqual([axes.get_ylabel() for axes in (top, middle, bottom)], labels)
        self.assertEqual(legend_texts(top), ["kinetic", "potential, less its start", "work of the joints", "dissipated"])
        group = {name: self.raw["energy/" + name][:] for name in self.raw["energy"]}
        time = self.raw["time"][:]
        expected = (group["kinetic"], group["potential"] - group["potential"][0], group["work"], group["dissipated"])
        for line, values in zip(top.lines, expected):
            self.assert_drawn(line, time, values)
        # The imbalance that is drawn is small beside the energies, and below the error estimate the verdict goes by.
        drawn = middle.lines[0].get_ydata()
        estimate = float(self.raw["global_error/energy"][()])
        self.assertEqual(list(middle.lines[1].get_ydata()), [estimate, estimate])
        self.assertLess(np.nanmax(drawn), 4 * estimate + 16 * 7 * np.finfo(float).eps * np.abs(group["potential"]).max() * 4)
        self.assert_drawn(bottom.lines[0], self.raw["step_time"][:], self.raw["verification/energy"][:])

    def test_solver(self):
        top, middle, bottom = panels(self.made["solver"])
        steps = self.raw["step_time"][:]
        for axes, name, text in zip(
            (top, middle, bottom),
            ("step_size", "order", "local_error"),
            ("step size [s]", "order of the method [1]", "local error / tolerance [1]"),
        ):
            self.assertEqual(axes.get_ylabel(), text)
            self.assert_drawn(axes.lines[0], steps, self.raw["solver/" + name][:])

    def test_condition(self):
        top, bottom = panels(self.made["condition"])
        self.assertEqual([top.get_ylabel(), bottom.get_ylabel()], ["cond(Ω) [1]", "|c| / |F| [1]"])
        self.assert_drawn(top.lines[0], self.raw["time"][:], self.raw["operational_space/cond_Omega"][:])
        self.assertEqual(len(bottom.lines), 2)
        c, F = (self.raw["operational_space/" + name][-1] for name in "cF")
        for line, part in zip(bottom.lines, (slice(0, 3), slice(3, 6))):
            # two norms of three components, in another order of addition: a few roundings
            self.assertAlmostEqual(line.get_ydata()[-1] / (math.hypot(*c[part]) / math.hypot(*F[part])), 1, delta=8 * np.finfo(float).eps)

    def test_global_error(self):
        for axes, name, unit in zip(panels(self.made["global_error"]), ("position", "orientation"), ("m", "rad")):
            self.assertEqual(axes.get_ylabel(), f"{name} error [{unit}]")
            self.assert_drawn(axes.lines[0], self.raw["step_time"][:], self.raw["solver/global_error_" + name][:])
            distance = float(self.raw["analytic_response/" + name][()])
            self.assertEqual(list(axes.lines[1].get_ydata()), [distance, distance])

    def test_no_text_overlaps_another(self):
        for name, figure in self.made.items():
            self.assertEqual(overlaps(figure), [], name)
            self.assertEqual(outside(figure), [], name)

    def test_command_makes_every_file(self):
        done = plot(self.file)
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stderr.splitlines(), [f"plot.py: {name} left out: {why}" for name, why in self.left_out.items()])
        expected = {self.directory / "short_figures" / f"{name}.{kind}" for name in self.made for kind in ("png", "pdf")}
        self.assertEqual({Path(line) for line in done.stdout.splitlines()}, expected)
        self.assertEqual(set((self.directory / "short_figures").iterdir()), expected)
        for path in expected:
            start = path.read_bytes()[:8]
            self.assertTrue(start.startswith(b"\x89PNG" if path.suffix == ".png" else b"%PDF"), path)
            self.assertGreater(path.stat().st_size, 4000, path)

    def test_only_and_format(self):
        done = plot(self.file, "-o", self.directory / "some", "--only", "solver", "condition", "--format", "svg")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual({path.name for path in (self.directory / "some").iterdir()}, {"solver.svg", "condition.svg"})

    def test_only_what_does_not_apply(self):
        done = plot(self.file, "-o", self.directory / "mixed", "--only", "contact", "solver", "slopes", "--format", "png")
        self.assertEqual(done.returncode, 2)
        self.assertEqual([Path(line).name for line in done.stdout.splitlines()], ["solver.png"])
        self.assertEqual(len(done.stderr.splitlines()), 2)
        self.assertIn("contact left out: the experiment has no surface to touch", done.stderr)
        self.assertIn("slopes left out: it is not a figure of a run", done.stderr)

    def test_list(self):
        done = plot("--list")
        self.assertEqual((done.returncode, done.stdout.split()), (0, [*FIGURES, *SWEEP_FIGURES]))
        self.assertEqual(sorted(FIGURES), sorted((*ALONG_TIME, "error_growth", *FOR_SOME)))
        self.assertEqual(list(SWEEP_FIGURES), ["comparison", "slopes"])

    def test_unwritable_output(self):
        done = plot(self.file, "-o", self.file / "figures", "--only", "solver")
        self.assertEqual(done.returncode, 4)
        self.assertIn("cannot write the figures", done.stderr)


class Edited(unittest.TestCase):
    """Files that are not what they should be, or not finished: made from a real one."""

    @classmethod
    def setUpClass(cls):
        cls.directory = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.directory)
        cls.file = cls.directory / "real.h5"
        assert run(ROOT / "experiments" / "puma560_circle.yaml", cls.file, "duration=0.05", "verify.shadow=false") == 0

    def edited(self, edit):
        path = self.directory / "edited.h5"
        shutil.copy(self.file, path)
        with h5py.File(path, "r+") as file:
            edit(file)
        return path

    def make(self, path, names=ALONG_TIME):
        with Result(path) as result:
            return {name: FIGURES[name](result) for name in names}

    def test_without_a_verdict(self):
        def edit(file):
            for name in ("verdict", "timing", "global_error", "analytic_response"):
                del file[name]
            del file.attrs["verdict"]
            file.attrs["status"] = "recovered"

        figures = self.make(self.edited(edit))
        for figure in figures.values():
            self.assertTrue(figure._suptitle.get_text().endswith("\nrun recovered, no verdict"))
        self.assertEqual(panels(figures["residuals"])[0].get_title(loc="left"), "omega")

    def test_made_before_runs_measured(self):
        def edit(file):
            for name in ("measured", "departure", "energy/self_motion", "trajectory/tip_force", "operational_space/effective_mass"):
                del file[name]

        path = self.edited(edit)
        with Result(path) as result:
            made, left_out = make_all(result)
        self.assertEqual(tuple(made), ALONG_TIME[:7])
        self.assertIn("no /operational_space/effective_mass", left_out["manipulability"])
        self.assertIn("no /departure/angular_acceleration", left_out["departure"])
        self.assertIn("no /measured/cross_coupling", left_out["cross_coupling"])

    def test_without_a_shadow_run(self):
        figures = self.make(self.file, ("global_error", "residuals"))
        for axes in panels(figures["global_error"]):
            self.assertEqual(len(axes.lines), 0)
            self.assertEqual(axes.texts[0].get_text(), "not estimated: the experiment has no shadow run")
        self.assertIn("energy, analytic_response, decoupling (no shadow run", " ".join(figures["residuals"]._supxlabel.get_text().split()))

    def test_failing_undecided_and_missing_values(self):
        def edit(file):
            file["verification/omega"][3] = 2 * file["verification/omega_bound"][3]
            file["verification/lambda_bound"][5:7] = 2e-3
            file["operational_space/cond_Omega"][2:4] = np.nan
            file["operational_space/c"][2:4] = np.nan
            file["verdict/result"][0] = 0
            file["verdict/undecided_steps"][0] = 0

        path = self.edited(edit)
        figures = self.make(path, ("residuals", "condition"))
        omega, lambda_ = panels(figures["residuals"])[:2]
        with Result(path) as result:
            steps, time = result.read("step_time"), result.read("time")
        self.assertEqual(legend_texts(omega), ["residual", "bound", "failing"])
        self.assertEqual(list(omega.lines[2].get_xdata()), [steps[3]])
        self.assertIn("FAIL", omega.get_title(loc="left"))
        self.assertEqual(legend_texts(lambda_), ["residual", "bound", "undecided"])
        self.assertEqual(list(lambda_.lines[2].get_xdata()), list(steps[5:7]))
        condition, ratio = panels(figures["condition"])
        self.assertEqual(list(condition.lines[1].get_xdata()), list(time[2:4]))
        for line in (condition.lines[0], ratio.lines[0]):
            self.assertEqual(list(np.flatnonzero(np.isnan(line.get_ydata())[1:]) + 1), [2, 3])

    def test_stopped_before_the_first_step(self):
        file = self.directory / "stopped.h5"
        straight = ("initial.q=[0, 0, 0, 0, 0, 0]", "duration=0.05")
        self.assertEqual(run(ROOT / "experiments" / "puma560_circle.yaml", file, *straight), 3)
        figures = self.make(file)
        for figure in figures.values():
            figure.draw_without_rendering()
            self.assertTrue(figure._suptitle.get_text().endswith("\nrun failed, verdict fail"))

    def test_sixty_joints(self):
        def edit(file):
            names = [f"joint{i}" for i in range(60)]
            for path, unit, text in (
                ("joint_position", "position_unit", "rad"),
                ("joint_velocity", "velocity_unit", "rad/s"),
                ("joint_torque", "effort_unit", "N m"),
            ):
                axis = path.replace("joint_position", "position_coordinate") if "position" in path else "velocity_coordinate"
                values = np.repeat(file["trajectory/" + path][:], 10, axis=1)
                for name in ("trajectory/" + path, unit):
                    del file[name]
                if len(file[axis]) != 60:
                    del file[axis]
                    file[axis] = names
                    file[axis].make_scale(axis)
                file["trajectory/" + path] = values
                for place, scale in enumerate(("time", axis)):
                    file["trajectory/" + path].dims[place].attach_scale(file[scale])
                file[unit] = [text if i % 2 else text.replace("rad", "m").replace("N m", "N") for i in range(60)]
                file[unit].dims[0].attach_scale(file[axis])

        with Result(self.edited(edit)) as result:
            figure = FIGURES["joints"](result)
        self.assertEqual(len(panels(figure)), 180)
        self.assertLess(max(figure.get_size_inches()), 40)
        self.assertEqual(panels(figure)[0].get_ylabel(), "joint0\n[m]")
        self.assertEqual(panels(figure)[-1].get_ylabel(), "joint59\n[N m]")
        self.assertEqual(panels(figure)[120].get_title(), "torque or force")

    def assert_refused(self, path, *words):
        done = plot(path, "-o", self.directory / "none")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stdout, "")
        self.assertEqual(len(done.stderr.splitlines()), 1)
        for word in (str(path), *words):
            self.assertIn(word, done.stderr)
        with self.assertRaises(NotAResult):
            Result(path)

    def test_no_such_file(self):
        self.assert_refused(self.directory / "absent.h5", "no such file")

    def test_not_hdf5(self):
        text = self.directory / "text.h5"
        text.write_text("time,x\n0,1\n")
        self.assert_refused(text, "cannot be read as HDF5", "osculate run")

    def test_hdf5_of_another_kind(self):
        other = self.directory / "other.h5"
        with h5py.File(other, "w") as file:
            file["time"] = [0.0, 1.0]
        self.assert_refused(other, "not a result file", "step_time", "attribute status")

    def test_a_variable_is_missing(self):
        def edit(file):
            del file["solver/order"]

        path = self.edited(edit)
        done = plot(path, "-o", self.directory / "partial", "--only", "solver")
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no variable /solver/order", done.stderr)

    def test_unknown_figure_and_no_file(self):
        done = plot(self.file, "--only", "torques")
        self.assertEqual(done.returncode, 2)
        self.assertIn("torques", done.stderr)
        self.assertEqual(plot().returncode, 2)


if __name__ == "__main__":
    unittest.main()
