"""osculate sweep as a user meets it: table, slopes, file, exit codes, interruption."""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
import numpy as np

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
CIRCLE = ROOT / "experiments" / "puma560_circle.yaml"
MASSES = [0.0001, 0.001, 0.01]  # kg
# Errors are linear in the payload m up to terms of order m Omega, and the tip point yields 0.09 to 0.53 m/s^2 per newton:
# the slopes below deviate from whole numbers by less than the largest mass.
SLOPE_TOLERANCE = 0.01


def call(*arguments, cwd=None):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120, cwd=cwd)


def strings(dataset):
    return list(dataset.asstr())


class Sweeps(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def experiment(self, sweep, duration=0.3):
        """The circle of the PUMA 560, shorter, with this section `sweep`."""
        text = CIRCLE.read_text().replace("../models", str(ROOT / "models"))
        text, found = re.subn(r"^duration: .*$", f"duration: {duration}", text, flags=re.MULTILINE)
        self.assertEqual(found, 1)
        path = self.folder / "experiment.yaml"
        path.write_text(text + (f"sweep: {sweep}\n" if sweep else ""))
        return path

    def payloads(self):
        return self.experiment(f"{{key: plant.payload.mass, values: {MASSES}}}")

    def test_slopes_over_the_payload(self):
        out = self.folder / "sweep.h5"
        done = call("sweep", self.payloads(), "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("puma560_circle, over plant.payload.mass", done.stdout)
        self.assertIn("d log(quantity) / d log(plant.payload.mass)", done.stdout)
        self.assertIn(f"recorded in {out}", done.stdout)
        for mass in MASSES:
            self.assertRegex(done.stdout, rf"(?m)^{mass} +complete +pass ")
        self.assertNotIn("\r", done.stderr)
        for line in set(done.stderr.splitlines()):
            self.assertEqual(done.stderr.splitlines().count(line), 1, line)  # each warning once
        with h5py.File(out) as f:
            self.assertEqual((f.attrs["status"], f.attrs["verdict"]), ("complete", "pass"))
            self.assertEqual(strings(f["variant"]), [str(m) for m in MASSES])
            np.testing.assert_array_equal(f["value"], MASSES)
            np.testing.assert_array_equal(f["exit_code"], [0, 0, 0])
            self.assertEqual(strings(f["verdict"]), ["pass"] * 3)
            self.assertEqual(strings(f["changes"])[1], "plant.payload.mass=0.001\n")
            self.assertIn("sweep:", f["provenance/experiment"].asstr()[()])
            self.assertIn("<robot", f["provenance/model"].asstr()[()])
            self.assertTrue((f["steps"][:] > 10).all() and (f["rhs_evaluations"][:] > f["steps"][:]).all())
            self.assertTrue((f["global_error_position"][:] < 1e-9).all())
            for name in ("closed_form_position", "closed_form_orientation"):
                self.assertTrue(np.isnan(f[name][:]).all(), "no closed form where plant and model differ")
            quantities = strings(f["slopes/quantity"])
            slope = dict(zip(quantities, f["slopes/slope"][:]))
            self.assertAlmostEqual(slope["missed_acceleration_linear"], 1, delta=SLOPE_TOLERANCE)
            self.assertAlmostEqual(slope["missed_acceleration_angular"], 1, delta=SLOPE_TOLERANCE)
            # The tip error comes from the start at rest.
            self.assertAlmostEqual(slope["tip_error_position"], 0, delta=SLOPE_TOLERANCE)
            self.assertIn("tip error, position", done.stdout)
            fitted = 0
            for i, name in enumerate(quantities):
                x, y = np.log10(MASSES), np.log10(f[name][:])
                if not np.isfinite(y).all():
                    self.assertTrue(np.isnan(f["slopes/slope"][i]), name)
                    continue
                line = np.polyfit(x, y, 1)
                self.assertAlmostEqual(f["slopes/slope"][i], line[0], places=10)
                self.assertAlmostEqual(f["slopes/spread"][i], np.sqrt(np.mean((y - np.polyval(line, x)) ** 2)), places=10)
                np.testing.assert_allclose(f["slopes/between"][i, 1:], np.diff(y) / np.diff(x), rtol=0, atol=1e-10)
                self.assertTrue(np.isnan(f["slopes/between"][i, 0]))
                self.assertEqual(f["slopes/points"][i], 3)
                fitted += 1
            self.assertGreaterEqual(fitted, 5)

    def test_a_held_tip_sags_in_proportion(self):
        out = self.folder / "hold.h5"
        done = call("sweep", self.payloads(), "-o", out, "--set", "reference={type: hold}", "--set", "duration=1")
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(out) as f:
            slope = dict(zip(strings(f["slopes/quantity"]), f["slopes/slope"][:]))
            for name in ("tip_error_position", "tip_error_position_rms", "missed_acceleration_linear"):
                self.assertAlmostEqual(slope[name], 1, delta=SLOPE_TOLERANCE)

    def test_numbers_are_those_of_the_runs(self):
        out, single = self.folder / "sweep.h5", self.folder / "run.h5"
        file = self.payloads()
        self.assertEqual(call("sweep", file, "-o", out).returncode, 0)
        done = call("run", file, "-o", single, "--set", "sweep={}", "--set", "plant.payload.mass=0.01")
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(out) as f, h5py.File(single) as run:
            error = run["trajectory/pose_error"][:]
            missed = run["trajectory/tip_acceleration"][:] - run["trajectory/command"][:]
            torque = np.abs(run["trajectory/joint_torque"][:])
            recorded = {
                "tip_error_orientation": np.linalg.norm(error[:, :3], axis=1).max(),
                "tip_error_position": np.linalg.norm(error[:, 3:], axis=1).max(),
                "missed_acceleration_angular": np.linalg.norm(missed[:, :3], axis=1).max(),
                "missed_acceleration_linear": np.linalg.norm(missed[:, 3:], axis=1).max(),
                "peak_torque": torque.max(),
                "global_error_position": run["global_error/position"][()],
            }
            for name, value in recorded.items():
                # The run is recorded every 0.01 s, a tenth of the loop's time constant; peaks are smooth or at the start.
                self.assertAlmostEqual(f[name][2] / value, 1, delta=0.02, msg=name)
            self.assertEqual(f["peak_torque_joint"][2], 1 + torque.max(axis=0).argmax())
            squares = (np.linalg.norm(error[:, 3:], axis=1) ** 2)
            mean = np.sum((squares[1:] + squares[:-1]) / 2 * np.diff(run["time"][:])) / run["time"][-1]
            self.assertAlmostEqual(f["tip_error_position_rms"][2] / np.sqrt(mean), 1, delta=0.02)
            self.assertEqual(f["steps"][2], len(run["step"]))
            self.assertEqual(f["rhs_evaluations"][2], run["solver/rhs_evaluations"][-1])

    def test_each_variant_has_its_own_expectation(self):
        variants = {
            "as_given": {},
            "heavy": {"plant.payload.mass": "1"},
            "misjudged": {"expect.fails": "[lambda]"},
            "stops": {"integrator.max_steps": "20"},
            "stops_as_expected": {"integrator.max_steps": "20", "expect.stop": "too_many_steps"},
        }
        body = ", ".join(
            f"{name}: {{{', '.join(f'{k}: {v}' for k, v in changes.items())}}}" for name, changes in variants.items())
        file = self.experiment(f"{{variants: {{{body}}}}}")
        out = self.folder / "sweep.h5"
        done = call("sweep", file, "-o", out)
        codes = []
        for changes in variants.values():
            sets = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
            codes.append(call("verify", file, "--set", "sweep={}", *sets).returncode)
        self.assertEqual(codes, [0, 0, 1, 3, 0])
        self.assertEqual(done.returncode, 3)
        self.assertNotIn("slope", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^stops: .*max_steps = 20")
        with h5py.File(out) as f:
            self.assertEqual((f.attrs["status"], f.attrs["verdict"]), ("complete", "fail"))
            np.testing.assert_array_equal(f["exit_code"], codes)
            self.assertEqual(strings(f["status"]), ["complete"] * 3 + ["failed"] * 2)
            self.assertEqual([strings(f["verdict"])[i] for i in (0, 1, 2, 4)], ["pass", "pass", "fail", "as_expected"])
            self.assertEqual(f["steps"][3], 20)
            self.assertNotIn("value", f)
            self.assertNotIn("slopes", f)
            closed_form = f["closed_form_position"][:]
            self.assertLess(closed_form[0], 1e-8)
            self.assertTrue(np.isnan(closed_form[1]))

    def test_other_readers(self):
        import xarray

        out = self.folder / "sweep.h5"
        self.assertEqual(call("sweep", self.payloads(), "-o", out, "--set", "duration=0.1").returncode, 0)
        header = subprocess.run(["ncdump", "-h", out], capture_output=True, text=True)
        self.assertEqual(header.returncode, 0, header.stderr)
        for text in ("variant = 3 ;", "double tip_error_position(variant) ;", "string verdict(variant) ;",
                     "double slope(quantity) ;", "double between(quantity, variant) ;"):
            self.assertIn(text, header.stdout)
        for engine in ("netcdf4", "h5netcdf"):
            with xarray.open_dataset(out, engine=engine) as data:
                self.assertEqual(data["tip_error_position"].dims, ("variant",))
                self.assertEqual(float(data["value"].sel(variant="0.01")), 0.01)
                self.assertEqual(str(data["status"].sel(variant="0.01").values), "complete")
                self.assertEqual(data["missed_acceleration_linear"].attrs["units"], "m/s^2")
                self.assertTrue(all("long_name" in v.attrs for v in data.variables.values()))
            with xarray.open_dataset(out, engine=engine, group="slopes") as data:
                self.assertEqual(data["between"].dims, ("quantity", "variant"))
                self.assertTrue(np.isfinite(float(data["slope"].sel(quantity="missed_acceleration_linear"))))

    def test_the_same_sweep_gives_the_same_bits(self):
        files = [self.folder / "a.h5", self.folder / "b.h5"]
        for out in files:
            self.assertEqual(call("sweep", self.payloads(), "-o", out).returncode, 0)
        compared = 0
        with h5py.File(files[0]) as a, h5py.File(files[1]) as b:
            names = []
            a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
            for name in names:
                if name.split("/")[0] in ("provenance", "timing"):
                    continue
                x, y = a[name][()], b[name][()]
                self.assertTrue((x == y).all() if x.dtype.kind == "O" else x.tobytes() == y.tobytes(), name)
                compared += 1
        self.assertGreater(compared, 20)

    def test_nothing_is_recorded_unless_asked(self):
        file = self.experiment("{key: duration, values: [0.1, 0.05]}")
        done = call("sweep", file, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("no slopes: they need at least 3 values", done.stdout)
        self.assertEqual(os.listdir(self.folder), ["experiment.yaml"])

    def test_bad_input_is_refused_before_anything_runs(self):
        out = self.folder / "sweep.h5"
        for sweep, fragments in (
            (None, ["has no section sweep", "sweep: {key:"]),
            ("{}", ["has no section sweep"]),
            ("{key: durration, values: [1]}", ["did you mean 'duration'", "Variant 1 of sweep"]),
            ("{variants: {fine: {}, short: {initial.q: [0, 1]}}}", ["initial.q", "Variant short of sweep"]),
        ):
            done = call("sweep", self.experiment(sweep, duration=1000), "-o", out)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(done.stdout, "")
            for fragment in fragments:
                self.assertIn(fragment, done.stderr)
            self.assertFalse(out.exists())
        file = self.payloads()
        for arguments in ([], [file, file], [file, "--fast"]):
            self.assertEqual(call("sweep", *arguments).returncode, 2, arguments)

    def test_output_failures_are_4(self):
        file = self.experiment("{key: duration, values: [0.1, 0.05]}")
        out = self.folder / "sweep.h5"
        out.write_text("precious")
        done = call("sweep", file, "-o", out)
        self.assertEqual(done.returncode, 4)
        self.assertIn("--force", done.stderr)
        self.assertEqual(out.read_text(), "precious")
        self.assertEqual(call("sweep", file, "-o", self.folder / "none" / "a.h5").returncode, 4)
        self.assertEqual(call("sweep", file, "-o", out, "--force").returncode, 0)
        with h5py.File(out) as f:
            np.testing.assert_allclose(f["end_time"], [0.1, 0.05], rtol=1e-12)

    def test_interruption_keeps_what_is_done(self):
        file = self.experiment("{key: duration, values: [0.1, 10000, 0.2]}")
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            out = self.folder / f"{code}.h5"
            process = subprocess.Popen([PROGRAM, "sweep", file, "-o", out], stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            while not out.exists():
                self.assertIsNone(process.poll())
                time.sleep(0.02)
            time.sleep(2)  # the first run takes some 10 ms, the second minutes
            process.send_signal(number)
            output, errors = process.communicate(timeout=30)
            self.assertEqual(process.returncode, code)
            self.assertIn("interrupted", output)
            self.assertIn("interrupted", errors)
            with h5py.File(out) as f:
                self.assertEqual(f.attrs["status"], "interrupted")
                self.assertEqual(strings(f["status"]), ["complete", "interrupted", "not_run"])
                np.testing.assert_array_equal(f["value"], [0.1, 10000, 0.2])
                for name in ("tip_error_position", "steps", "exit_code"):
                    np.testing.assert_array_equal(np.isnan(f[name][:]), [False, True, True])
                self.assertTrue(np.isnan(f["steps"].attrs["_FillValue"][0]))


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
