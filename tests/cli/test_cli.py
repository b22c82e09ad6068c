"""The program as a user meets it: exit codes, messages, files, signals."""
import json
import math
import os
import pathlib
import random
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
PUMA = ROOT / "models" / "puma560.urdf"
ROBOTS = ROOT.parent / "shared" / "robots"
PUMA_Q = "0,-0.8,0.4,0,0.9,0"


def call(*arguments, program=PROGRAM, env=None, timeout=120):
    full = dict(os.environ, **(env or {}))
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, env=full, timeout=timeout)


class InFolder(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)


class ExitCodes(InFolder):
    def test_version_names_the_libraries(self):
        done = call("--version")
        self.assertEqual(done.returncode, 0)
        for name in ("osculate ", "SUNDIALS ", "HDF5 ", "Eigen ", "urdfdom "):
            self.assertRegex(done.stdout, name + r"\S*\d")

    def test_wrong_usage_is_bad_input(self):
        for arguments in ([], ["fly"], ["run"], ["terms", PUMA], ["run", CIRCLE, "--speed=3"]):
            self.assertEqual(call(*arguments).returncode, 2, arguments)

    def test_a_run_that_passes(self):
        out = self.folder / "a.h5"
        done = call("run", CIRCLE, "-o", out, "--set", "duration=0.3")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("verdict pass", done.stdout)
        self.assertNotIn("\r", done.stderr)  # no progress line: stderr is no terminal
        with h5py.File(out) as f:
            self.assertEqual(f.attrs["status"], "complete")
            self.assertEqual(f.attrs["verdict"], "pass")
            self.assertAlmostEqual(f["time"][-1], 0.3, places=12)
            self.assertEqual(len(f["time"]), 31)

    def test_several_files_and_the_gravest_code_wins(self):
        broken = self.folder / "broken.yaml"
        broken.write_text("name: x\nmodell: {}\n")
        done = call("check", broken, CIRCLE)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{CIRCLE}: fine", done.stdout)
        self.assertIn("broken.yaml:2:1", done.stderr)
        self.assertIn("did you mean 'model'", done.stderr)

    def test_an_unexpected_stop_is_3_and_its_file_is_kept(self):
        out = self.folder / "stopped.h5"
        done = call("run", CIRCLE, "-o", out, "--set", "integrator.max_steps=50")
        self.assertEqual(done.returncode, 3)
        self.assertIn("max_steps = 50", done.stderr)
        with h5py.File(out) as f:
            self.assertEqual(f.attrs["status"], "failed")
            self.assertEqual(len(f["step_time"]), 50)

    def test_a_run_by_bdf_says_where_its_jacobian_comes_from(self):
        mobile = CIRCLE.parent / "mobile_arm_lissajous.yaml"  # its base is a joint with several axes
        for file, settings, jacobian in ((CIRCLE, [], "in closed form"), (mobile, [], "by differences"),
                                         (CIRCLE, ["--set", "integrator.jacobian=differences"], "by differences")):
            done = call("verify", file, "--set", "integrator.method=bdf", "--set", "duration=0.1", *settings)
            self.assertIn(f"Jacobian of bdf: {jacobian}\n", done.stdout)

    def test_output_failures_are_4(self):
        out = self.folder / "a.h5"
        out.write_text("precious")
        done = call("run", CIRCLE, "-o", out, "--set", "duration=0.1")
        self.assertEqual(done.returncode, 4)
        self.assertIn("--force", done.stderr)
        self.assertEqual(out.read_text(), "precious")
        missing = self.folder / "no" / "such" / "a.h5"
        done = call("run", CIRCLE, "-o", missing, "--set", "duration=0.1")
        self.assertEqual(done.returncode, 4)
        self.assertIn(str(missing.parent), done.stderr)

    def test_interruption_finishes_the_file(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            out = self.folder / f"{code}.h5"
            process = subprocess.Popen([PROGRAM, "run", CIRCLE, "-o", out, "--set", "duration=10000"],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while not out.exists():
                time.sleep(0.02)
            time.sleep(0.5)
            process.send_signal(number)
            output, _ = process.communicate(timeout=30)
            self.assertEqual(process.returncode, code)
            self.assertIn("interrupted", output)
            with h5py.File(out) as f:
                self.assertEqual(f.attrs["status"], "interrupted")
                self.assertGreater(len(f["time"]), 1)
                self.assertIn("verdict", f)

    def test_a_killed_run_is_recovered(self):
        rng = random.Random(7)
        kept = []
        for attempt in range(50):
            out = self.folder / f"killed{attempt}.h5"
            process = subprocess.Popen([PROGRAM, "run", CIRCLE, "-o", out, "--set", "duration=10000"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while not out.exists():
                time.sleep(0.02)
            time.sleep(rng.uniform(0.0, 0.5))
            process.kill()
            process.wait()
            done = call("recover", out)
            self.assertEqual(done.returncode, 0, done.stderr)
            with h5py.File(self.folder / f"killed{attempt}.recovered.h5") as f:
                self.assertEqual(f.attrs["status"], "recovered")
                times = f["time"][:]
                np.testing.assert_allclose(times, 0.01 * np.arange(len(times)), atol=1e-9)
                self.assertTrue(np.isfinite(f["trajectory/joint_position"][:]).all())
                kept.append(len(times))
            out.unlink()
        print(f"rows recovered from 50 killed runs: {min(kept)} to {max(kept)}", flush=True)
        self.assertGreater(max(kept), 100)
        self.assertEqual(call("recover", PUMA).returncode, 4)

    def test_a_result_opens_in_netcdf_and_xarray(self):
        import xarray

        out = self.folder / "a.h5"
        self.assertEqual(call("run", CIRCLE, "-o", out, "--set", "duration=0.2").returncode, 0)
        header = subprocess.run(["ncdump", "-h", out], capture_output=True, text=True)
        self.assertEqual(header.returncode, 0, header.stderr)
        for text in ("time = UNLIMITED", "step = UNLIMITED", "spatial = 6", "joint_torque(time, velocity_coordinate)",
                     "Lambda(time, spatial, spatial_column)", 'step_time:units = "s"', "group: verdict"):
            self.assertIn(text, header.stdout)
        for engine in ("netcdf4", "h5netcdf"):
            for group in (None, "trajectory", "operational_space", "energy", "verification", "solver", "verdict"):
                with xarray.open_dataset(out, engine=engine, group=group) as data:
                    self.assertFalse([d for d in data.dims if "phony" in str(d)])
                    self.assertTrue(all("long_name" in v.attrs for v in data.variables.values()))

    def test_the_same_run_gives_the_same_bits(self):
        files = [self.folder / "a.h5", self.folder / "b.h5"]
        for out in files:
            self.assertEqual(call("run", CIRCLE, "-o", out, "--set", "duration=0.5").returncode, 0)
        compared = 0
        with h5py.File(files[0]) as a, h5py.File(files[1]) as b:
            names = []
            a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
            for name in names:
                if name.split("/")[0] in ("provenance", "timing"):
                    continue
                x, y = a[name][()], b[name][()]
                same = x.tobytes() == y.tobytes() if x.dtype.kind != "O" else (x == y).all()
                self.assertTrue(same, name)
                compared += 1
        self.assertGreater(compared, 60)

    def test_recorded_physics_adds_up(self):
        """What the file holds is consistent by itself, computed here from its numbers alone."""
        out = self.folder / "a.h5"
        self.assertEqual(call("run", CIRCLE, "-o", out, "--set", "duration=1").returncode, 0)
        with h5py.File(out) as f:
            t = f["time"][:]
            q, qd = f["trajectory/joint_position"][:], f["trajectory/joint_velocity"][:]
            # central differences of 0.01 s: error of order h^2/6 times the third derivative, far below 5e-2 of the rates
            rate = (q[2:] - q[:-2]) / (t[2:] - t[:-2])[:, None]
            self.assertLess(np.abs(rate - qd[1:-1]).max(), 0.05 * np.abs(qd).max())
            Omega, Lambda = f["operational_space/Omega"][:], f["operational_space/Lambda"][:]
            cond = f["operational_space/cond_Omega"][:]
            eye = np.einsum("tij,tjk->tik", Omega, Lambda) - np.eye(6)
            self.assertLess(np.abs(eye).max(), 1e-10 * cond.max())
            u = f["trajectory/command"][:]
            F = np.einsum("tij,tj->ti", Lambda, u) + f["operational_space/c"][:] + f["operational_space/g"][:]
            scale = np.abs(f["operational_space/F"][:]).max()
            self.assertLess(np.abs(F - f["operational_space/F"][:]).max(), 1e-10 * scale)  # (4)
            accelerations = f["trajectory/tip_acceleration"][:]
            self.assertLess(np.abs(accelerations - u).max(), 1e-9 * np.abs(u).max())  # (5)
            quaternion = f["trajectory/tip_orientation"][:]
            self.assertLess(np.abs(np.linalg.norm(quaternion, axis=1) - 1).max(), 1e-14)
            self.assertGreaterEqual(quaternion[0, 0], 0)
            self.assertGreater((quaternion[1:] * quaternion[:-1]).sum(axis=1).min(), 0.9)
            energy = f["energy/kinetic"][:] + f["energy/potential"][:]
            supplied = f["energy/work"][:] - f["energy/dissipated"][:]
            scale = (f["energy/kinetic"][:] + np.abs(f["energy/work"][:]) + f["energy/dissipated"][:]).max()
            self.assertLess(np.abs(energy - energy[0] - supplied).max(), 1e-8 * scale)
            self.assertIn("<robot", f["provenance/model"][()].decode())


class Terms(InFolder):
    def one(self, *arguments):
        done = call("terms", *arguments, "--json")
        return done, json.loads(done.stdout)

    def test_json_has_the_promised_keys_and_is_consistent(self):
        done, out = self.one(PUMA, "--tip", "tool0", "--q", PUMA_Q, "--qd", "0.1,0.2,-0.3,0.4,0.5,-0.6", "--u", "1,2,3,4,5,6")
        self.assertEqual(done.returncode, 0, done.stderr)
        keys = {"joints", "n", "tip", "M", "C", "G", "J", "Jdot_qd", "recursive", "dense", "residual", "cond_Omega",
                "rank", "warnings"}
        self.assertLessEqual(keys, set(out))
        M, J, C, G = (np.array(out[k]) for k in ("M", "J", "C", "G"))
        Omega = J @ np.linalg.solve(M, J.T)
        for side in ("recursive", "dense"):
            s = {k: np.array(v) for k, v in out[side].items()}
            self.assertEqual(set(s), {"Omega", "Lambda", "c", "g", "F", "T", "qdd"})
            np.testing.assert_allclose(s["Omega"], Omega, rtol=0, atol=1e-12 * np.abs(Omega).max())
            np.testing.assert_allclose(s["T"], J.T @ s["F"], rtol=0, atol=1e-12 * np.abs(s["T"]).max() * 10)
            np.testing.assert_allclose(J @ s["qdd"] + out["Jdot_qd"], [1, 2, 3, 4, 5, 6], atol=1e-9)
        self.assertEqual(out["rank"], 6)
        self.assertRegex(done.stdout, r"\d\.\d{15,16}")  # 17 significant digits

    def test_rank_loss_is_a_warning_with_nulls(self):
        done, out = self.one(PUMA, "--tip", "tool0", "--q", "0,-0.8,0.4,0,0,0")  # wrist stretched
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(out["rank"], 6)
        for key in ("Lambda", "c", "g", "F", "T", "qdd"):
            self.assertIsNone(out["recursive"][key])
            self.assertIsNone(out["dense"][key])
        self.assertEqual(np.array(out["recursive"]["Omega"]).shape, (6, 6))
        self.assertTrue(any("rank" in w for w in out["warnings"]))
        self.assertIn("rank", done.stderr)

    def test_rows_restrict_the_task(self):
        done, out = self.one(PUMA, "--tip", "tool0", "--q", PUMA_Q, "--rows", "vx,vy,vz", "--u", "1,0,0")
        self.assertEqual(done.returncode, 0)
        self.assertEqual(np.array(out["dense"]["Lambda"]).shape, (3, 3))
        self.assertEqual(np.array(out["J"]).shape, (3, 6))

    def test_bad_input_names_the_trouble(self):
        for arguments, fragments in (
            (["--q", "0,0,0"], ["q has 3 entries", "needs 6"]),
            (["--q", "0,0,zero,0,0,0"], ["entry 3", "'zero'"]),
            (["--q", PUMA_Q, "--rows", "vx,up"], ["'up'", "wx,wy,wz,vx,vy,vz"]),
            (["--q", PUMA_Q, "--gravity", "0,1"], ["--gravity", "needs 3"]),
            ([], ["--q or --states"]),
        ):
            done = call("terms", PUMA, "--tip", "tool0", *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            for fragment in fragments:
                self.assertIn(fragment, done.stderr)
        done = call("terms", PUMA, "--tip", "tool9", "--q", PUMA_Q)
        self.assertEqual(done.returncode, 2)
        self.assertIn("tool0", done.stderr)

    def states(self, n, count, seed):
        rng = random.Random(seed)
        path = self.folder / "states.csv"
        rows = [[rng.uniform(-math.pi, math.pi) for _ in range(n)] + [rng.uniform(-1, 1) for _ in range(n)] for _ in range(count)]
        path.write_text("\n".join(",".join(repr(x) for x in row) for row in rows) + "\n")
        return path

    def test_real_robots_at_100_states(self):
        if not ROBOTS.is_dir():
            self.skipTest("the folder of real robots is not there")
        robots = {"ur5e": ("base_link", "tool0", 6), "panda": ("panda_link0", "panda_hand_tcp", 7),
                  "iiwa14": ("base", "iiwa_link_ee", 7), "jaco2_7dof": ("world", "j2s7s300_end_effector", 7),
                  "irb120": ("base_link", "tool0", 6), "tx90": ("base_link", "tool0", 6), "sia10d": ("world", "link_t", 7),
                  "kr5_arc": ("base_link", "tool0", 6), "baxter": ("torso", "left_hand", 7),
                  "qarm": ("world", "END-EFFECTOR", 4)}
        for name, (base, tip, n) in robots.items():
            rows = ["--rows", "vx,vy,vz"] if n < 6 else []
            done = call("terms", ROBOTS / f"{name}.urdf", "--base", base, "--tip", tip, "--states",
                        self.states(n, 100, name), "--json", *rows)
            self.assertEqual(done.returncode, 0, f"{name}: {done.stderr}")
            out = json.loads(done.stdout)
            self.assertEqual(len(out), 100)
            eps = 2.0**-52
            worst = {"Omega": 0.0, "Lambda": 0.0, "g": 0.0}
            for state in out:
                for key, value in state["residual"].items():
                    if key in state["bound"] and value is not None:
                        self.assertLessEqual(value, state["bound"][key], f"{name} {key}")
                for key in worst:  # plainly relative: largest difference over largest entry
                    if state["dense"][key] is None:
                        continue
                    x, y = np.array(state["recursive"][key]), np.array(state["dense"][key])
                    unit = eps * (1 if key == "Omega" else state["cond_Omega"])
                    worst[key] = max(worst[key], np.abs(x - y).max() / np.abs(y).max() / unit)
            print(f"{name}: Omega {worst['Omega']:.1f} eps, Lambda {worst['Lambda']:.3f} and g {worst['g']:.3f} eps cond", flush=True)
            self.assertLess(worst["Omega"], 20)

    def test_info(self):
        done = call("info", PUMA, "--tip", "tool0")
        self.assertEqual(done.returncode, 0)
        self.assertIn("6 joints", done.stdout)
        self.assertIn("moving mass 23.45 kg", done.stdout)
        self.assertIn("tool0", call("info", PUMA).stdout)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
