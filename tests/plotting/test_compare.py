"""Figures of several runs: one line for each file, its numbers those of the file.

Environment: as support.py says.
"""
import unittest

from support import LABEL, ROOT, Files, outside, overlaps, panels, plot, run

import numpy as np
from compare import COMPARISONS, MOST, names_of
from result import Result
from style import NotApplicable


class Compared(Files):
    wanted = {"puma560_circle": ("duration=0.5",), "puma560_touch": ("duration=1.0",), "arm7_posture": ("duration=0.4",)}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        heavy = cls.directory / "heavy.h5"
        assert run(ROOT / "experiments" / "puma560_circle.yaml", heavy, "duration=0.3", "plant.payload.mass=2", "integrator.rtol=1e-6") == 0
        cls.files["heavy"] = heavy
        cls.results = {name: Result(file) for name, file in cls.files.items()}
        for result in cls.results.values():
            cls.addClassCleanup(result.close)
        cls.made, cls.left_out = {}, {}
        for name, make in COMPARISONS.items():
            try:
                cls.made[name] = make(list(cls.results.values()))
            except NotApplicable as reason:
                cls.left_out[name] = str(reason)

    def panel(self, figure, text):
        return next(axes for axes in panels(self.made[figure]) if axes.get_ylabel().replace("\n", " ").startswith(text))

    def assert_lines(self, axes, expected):
        """The panel has one line for each file, with these numbers."""
        self.assertEqual([line.get_label() for line in axes.lines], list(expected))
        for line, (times, values) in zip(axes.lines, expected.values()):
            np.testing.assert_array_equal(line.get_xdata(), times)
            if axes.get_yscale() == "log":
                values = np.where(values > 0, values, np.nan)
            np.testing.assert_array_equal(line.get_ydata(), values)

    def of_all(self, read, names=None):
        return {name: read(result) for name, result in self.results.items() if names is None or name in names}

    def test_every_figure_is_labelled_and_no_text_overlaps_another(self):
        self.assertEqual(set(self.left_out), {"frequency_response"})
        self.assertEqual(self.left_out["frequency_response"], "none of the files has what it shows")
        for name, figure in self.made.items():
            self.assertTrue(figure._suptitle.get_text().startswith("comparison of 4 runs: "), name)
            self.assertGreater(len(panels(figure)), 0)
            for axes in panels(figure):
                self.assertGreater(len(axes.lines), 0)
                self.assertRegex(axes.get_ylabel(), LABEL, name)
                if axes.get_xlabel():
                    self.assertRegex(axes.get_xlabel(), LABEL, name)
            texts = [text.get_text() for text in figure.legends[0].get_texts()]
            if len(texts) == 4:
                self.assertEqual(texts, ["puma560_circle: verdict pass", "puma560_touch: verdict pass", "arm7_posture: verdict pass",
                                         "heavy: verdict pass"])
            self.assertEqual(overlaps(figure), [], name)
            self.assertEqual(outside(figure), [], name)

    def test_joints_by_name(self):
        shown = panels(self.made["joints"])
        self.assertEqual(len(shown), 3 * 7)
        for name in ("joint3", "joint7"):
            axes = self.panel("joints", f"effort {name}")
            def torque(result, name=name):
                return result.read("time"), result.read("trajectory/joint_torque")[:, result.read("joint").index(name)]
            self.assert_lines(axes, self.of_all(torque, ("arm7_posture",) if name == "joint7" else None))

    def test_residuals_over_bounds(self):
        axes = self.panel("residuals", "omega")
        def share(result):
            return result.read("step_time"), result.read("verification/omega") / result.read("verification/omega_bound")
        self.assert_lines(axes, self.of_all(share))
        alone = self.panel("residuals", "null_space")
        self.assertEqual([line.get_label() for line in alone.lines], ["arm7_posture"])
        self.assertGreater(len(panels(self.made["residuals"])), 9)

    def test_tip(self):
        axes = self.panel("tip", "position error")
        def error(result):
            return result.read("time"), np.linalg.norm(result.read("trajectory/pose_error")[:, 3:], axis=1)
        self.assert_lines(axes, self.of_all(error))
        self.assertEqual([axes.get_ylabel() for axes in panels(self.made["tip"])][:3], ["tip\nx [m]", "tip\ny [m]", "tip\nz [m]"])

    def test_what_only_some_have(self):
        pressure = self.panel("contact", "normal force")
        self.assert_lines(pressure, self.of_all(lambda result: (result.read("time"), result.read("contact/pressure")), ("puma560_touch",)))
        own = self.panel("self_motion", "kinetic energy of self-motion")
        self.assert_lines(own, self.of_all(lambda result: (result.read("time"), result.read("energy/self_motion")), ("arm7_posture",)))

    def test_solver_energy_and_condition(self):
        self.assertEqual(len(panels(self.made["solver"])), 3)
        self.assert_lines(self.panel("solver", "step size"), self.of_all(lambda r: (r.read("step_time"), r.read("solver/step_size"))))
        self.assertEqual(len(panels(self.made["energy"])), 5)
        self.assert_lines(self.panel("energy", "kinetic"), self.of_all(lambda r: (r.read("time"), r.read("energy/kinetic"))))
        self.assert_lines(self.panel("condition", "cond"), self.of_all(lambda r: (r.read("time"), r.read("operational_space/cond_Omega"))))
        self.assert_lines(self.panel("departure", "missed linear"), self.of_all(lambda r: (r.read("step_time"), r.read("departure/linear_acceleration"))))
        self.assertEqual(len(panels(self.made["manipulability"])), 7)
        self.assertEqual(len(panels(self.made["global_error"])), 2)
        self.assertEqual(self.made["error_growth"].axes[0].get_xscale(), "log")

    def test_lines_differ_in_colour_and_dash(self):
        looks = [(line.get_color(), line.get_linestyle()) for line in self.panel("solver", "step size").lines]
        self.assertEqual(len({colour for colour, _ in looks}), 4)
        self.assertEqual(len({dash for _, dash in looks}), 4)

    def test_command(self):
        files = [self.files["puma560_circle"], self.files["heavy"]]
        done = plot(*files, "--only", "solver", "tip", "--format", "pdf")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.split(), [str(self.directory / "comparison_figures" / f"{name}.pdf") for name in ("solver", "tip")])
        done = plot(*files, "--only", "poles", "-o", self.directory / "none")
        self.assertEqual((done.returncode, done.stderr), (2, "plot.py: poles left out: it is not a figure of several runs\n"))
        done = plot(*[files[0]] * (MOST + 1))
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot be told apart", done.stderr)

    def test_names_tell_files_apart(self):
        class Named:
            def __init__(self, path):
                self.path = path

        def path(text):
            return Named(type(self.directory)(text))
        self.assertEqual(names_of([path("a/x.h5"), path("a/y.h5")]), ["x", "y"])
        self.assertEqual(names_of([path("a/x.h5"), path("b/x.h5")]), ["a/x", "b/x"])
        self.assertEqual(names_of([path("a/x.h5"), path("a/x.h5")]), ["a/x (1)", "a/x (2)"])


if __name__ == "__main__":
    unittest.main()
