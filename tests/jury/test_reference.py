"""Reference data: read back by h5py, xarray, ncdump and json, and held against laws of physics, a closed form over 50
digits, an arm written in NumPy, and the program's own double precision."""
import decimal
import hashlib
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
import xarray

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
EPS = np.finfo(float).eps
ARMS = {"puma560": ["tool0"], "arm7": ["tool0"], "prismatic_arm": ["tool0", "--armature", "0.1,0.2,3,0,0,0.01"],
        "mobile_arm": ["tool0"], "satellite_arm": ["tool0", "--gravity", "0,0,0"],
        "planar_2r": ["tip", "--rows", "vx,vz"]}
holder = tempfile.TemporaryDirectory()
FOLDER = pathlib.Path(holder.name)


def call(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def write(arm, out, *more, states=8):
    tip, *options = ARMS[arm]
    done = call("reference", ROOT / "models" / f"{arm}.urdf", "--tip", tip, *options, "--states", states, "-o", out, *more)
    assert done.returncode == 0, done.stderr
    return out


def setUpModule():
    for arm in ARMS:
        write(arm, FOLDER / f"{arm}.h5")


def tearDownModule():
    holder.cleanup()


def opened(arm):
    return h5py.File(FOLDER / f"{arm}.h5")


def relative(x, y, floor=0.0):
    off = np.abs(x - y).max()
    return 0.0 if off == 0 else off / max(np.abs(y).max(), floor)


class Files(unittest.TestCase):
    def test_json_holds_the_same_doubles(self):
        out = write("puma560", FOLDER / "puma560.json")
        data = json.loads(out.read_text())
        with opened("puma560") as f:
            self.assertEqual([s["kind"] for s in data["states"]], list(f["kind"].asstr()))
            self.assertEqual(data["velocity_coordinate"], list(f["velocity_coordinate"].asstr()))
            for name in f["quantity"].asstr():
                self.assertEqual([s[name] for s in data["states"]], f[name][()].tolist(), name)
            for name in f["arm"]:
                self.assertEqual(data["arm"][name], f["arm"][name][()].tolist(), name)

    def test_twice_the_same_bytes_and_another_seed_is_another_file(self):
        for kind in ("h5", "json"):
            first, again = (write("prismatic_arm", FOLDER / f"{n}.{kind}", states=3) for n in "ab")
            self.assertEqual(first.read_bytes(), again.read_bytes(), kind)
        other = write("prismatic_arm", FOLDER / "c.json", "--seed", 2, states=3)
        a, c = json.loads(again.read_text()), json.loads(other.read_text())
        self.assertNotEqual(a["states"][2]["q"], c["states"][2]["q"])

    def test_every_dataset_says_what_it_is(self):
        with opened("mobile_arm") as f:
            for name in f["quantity"].asstr():
                data = f[name]
                self.assertTrue(data.attrs["long_name"], name)
                self.assertTrue("units" in data.attrs or "unit" in data.attrs["long_name"], name)
                self.assertEqual(data.dims[0][0].name, "/state", name)
            text = f["provenance/model"].asstr()[()]
            file = (ROOT / "models/mobile_arm.urdf").read_bytes()
            self.assertEqual(text.encode(), file)
            self.assertEqual(f["provenance/model_sha256"].asstr()[()], hashlib.sha256(file).hexdigest())
            self.assertIn("angular", f["conventions/component_order"].asstr()[()])
            self.assertEqual(f["generator/seed"].asstr()[()], "1")
            self.assertEqual(list(f["joint_type"].asstr()), ["planar"] + 5 * ["revolute"])

    def test_netcdf_readers_open_it(self):
        for engine in ("netcdf4", "h5netcdf"):
            with xarray.open_dataset(FOLDER / "puma560.h5", engine=engine) as data:
                self.assertEqual(data["M"].dims, ("state", "velocity_coordinate", "velocity_coordinate_column"))
                self.assertEqual(list(data["spatial"].values[:2]), ["wx", "wy"])
        header = subprocess.run(["ncdump", "-h", FOLDER / "puma560.h5"], capture_output=True, text=True)
        self.assertEqual(header.returncode, 0, header.stderr)
        self.assertIn("double Lambda(state, task_row, task_row_column)", header.stdout)

    def test_refusals_name_the_remedy(self):
        arm = ROOT / "models/puma560.urdf"
        mobile = ROOT / "models/mobile_arm.urdf"
        out = FOLDER / "x.h5"
        for arguments, code, words in (
                ([arm, "--tip", "tool0", "--states", 5, "-o", FOLDER / "x.csv"], 2, r"ends in \.h5 or \.json"),
                ([arm, "--tip", "tool0", "--states", 1, "-o", out], 2, "--states"),
                ([arm, "--tip", "tool0", "--states", 999999, "-o", out], 2, "too many .* at most"),
                ([arm, "--tip", "tool0", "--states", 5, "--rows", "vq", "-o", out], 2, "choose from wx"),
                ([arm, "--tip", "tool0", "--states", 5, "--armature", "1,2", "-o", out], 2, "needs 6"),
                ([arm, "--tip", "tool0", "--states", 5, "--armature", "0,0,0,0,0,-1", "-o", out], 2, "negative"),
                ([mobile, "--tip", "tool0", "--states", 5, "--armature", "1,0,0,0,0,0", "-o", out], 2, "several axes"),
                ([arm, "--tip", "tool0", "--states", 5, "-o", FOLDER / "puma560.h5"], 4, "--force"),
                ([arm, "--tip", "tool0", "--states", 5, "-o", FOLDER / "none" / "x.json"], 4, "cannot be written"),
                ([arm, "--tip", "tool0", "--states", 5, "-o", FOLDER / "none" / "x.h5"], 4, "no such directory")):
            done = call("reference", *arguments)
            self.assertEqual((done.returncode, bool(re.search(words, done.stderr))), (code, True), done.stderr)
        self.assertFalse(out.exists())


class States(unittest.TestCase):
    def test_kinds_and_limits(self):
        with opened("puma560") as f:
            self.assertEqual(list(f["kind"].asstr()[:3]), ["at_rest", "nearly_singular", "random"])
            self.assertTrue((f["qd"][0] == 0).all() and (f["C"][0] == 0).all() and (f["Jdot_qd"][0] == 0).all())
            self.assertTrue((f["qd"][1:] != 0).all())
            self.assertTrue(0.5e8 < f["cond_Omega"][1] < 2e8, f["cond_Omega"][1])
            self.assertLess(np.median(f["cond_Omega"][2:]), 1e5)
        urdf = (ROOT / "models/prismatic_arm.urdf").read_text()
        limits = [(float(a), float(b)) for a, b in re.findall(r'lower="(\S+)" upper="(\S+)"', urdf)]
        with opened("prismatic_arm") as f:
            for (low, high), q in zip(limits, f["q"][()].T, strict=True):
                self.assertTrue((low <= q).all() and (q <= high).all())
                self.assertGreater(np.ptp(q), 0.2 * (high - low))

    def test_no_rank_no_numbers(self):
        out = FOLDER / "flat.json"
        done = call("reference", ROOT / "models/planar_2r.urdf", "--tip", "tip", "--states", 3, "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        for state in json.loads(out.read_text())["states"]:
            self.assertEqual(state["rank"], 2)
            self.assertIsNone(state["Lambda"][0][0])
            self.assertIsNone(state["T"][1])
            self.assertIsNotNone(state["Omega"][0][0])
        done = call("reference", ROOT / "models/planar_2r.urdf", "--tip", "tip", "--states", 3, "-o", FOLDER / "flat.h5")
        with h5py.File(FOLDER / "flat.h5") as f:
            self.assertTrue(np.isnan(f["Lambda"][()]).all())
            self.assertTrue(np.isnan(f["Lambda"].attrs["_FillValue"][0]))


class Physics(unittest.TestCase):
    """With NumPy alone; rounding of NumPy's own sums, times the condition number where a solve is in between."""

    def test_laws(self):
        for arm in ARMS:
            with opened(arm) as f:
                n = len(f["velocity_coordinate"])
                tol = 10 * n * EPS
                rows = [list(f["spatial"].asstr()).index(r) for r in f["task_row"].asstr()]
                self.assertLess(np.nanmax(f["difference"]), 2.0**-54)
                for i in range(len(f["state"])):
                    s = {name: f[name][i] for name in f["quantity"].asstr()}
                    with self.subTest(arm=arm, state=i):
                        M, J, task = s["M"], s["J"], s["J"][rows]
                        self.assertTrue((M == M.T).all())
                        self.assertGreater(np.linalg.eigvalsh(M)[0], 0)
                        self.assertLessEqual(relative(s["C"] + s["G"], s["bias"], np.abs(s["G"]).max()), tol)
                        self.assertLessEqual(relative(M @ s["qdd"], s["tau"] - s["bias"]), tol * s["cond_M"])
                        self.assertLessEqual(relative(M @ s["qdd_given"] + s["bias"], s["tau_inverse"]), tol * s["cond_M"])
                        self.assertLessEqual(relative(J @ s["qd"], s["tip_velocity"]), tol * 10)
                        hard = tol * s["cond_Omega"]
                        self.assertLessEqual(relative(s["Lambda"] @ s["Omega"], np.eye(len(rows))), hard)
                        self.assertLessEqual(relative(task @ np.linalg.solve(M, task.T), s["Omega"]), tol * s["cond_M"])
                        self.assertLessEqual(relative(task.T @ s["F"], s["T"]), hard)
                        self.assertLessEqual(relative(s["Lambda"] @ s["u"] + s["c"] + s["g"], s["F"]), hard)
                        # the point of it: under T the task rows of the tip accelerate by u
                        qdd = np.linalg.solve(M, s["T"] - s["bias"])
                        self.assertLessEqual(relative(task @ qdd + s["Jdot_qd"][rows], s["u"]), 10 * hard)
                        self.assertLessEqual(abs(s["qd"] @ M @ s["qd"] / 2 - s["kinetic_energy"]),
                                             tol * max(s["kinetic_energy"], 1e-300))
                        R, (w, x, y, z) = s["rotation"], s["quaternion"]
                        self.assertLessEqual(np.abs(R.T @ R - np.eye(3)).max(), 4 * EPS)
                        self.assertGreaterEqual(w, 0)
                        turned = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                                  [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                                  [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
                        self.assertLessEqual(np.abs(R - turned).max(), 8 * EPS)

    def test_planar_arm_to_the_last_bit(self):
        """The closed form in models/planar_2r.urdf, over 50 digits, with the file's numbers as doubles."""
        D = decimal.Decimal
        decimal.getcontext().prec = 50

        def cos_sin(x):
            c = s = D(0)
            term = D(1)
            for k in range(60):  # the series of exp(i x), |x| < 7
                if k % 2 == 0:
                    c += term if k % 4 == 0 else -term
                else:
                    s += term if k % 4 == 1 else -term
                term = term * x / (k + 1)
            return c, s

        l1, c1, m1, I1, l2, c2, m2, I2, g = map(D, (1.0, 0.5, 2.0, 0.2, 0.8, 0.4, 1.5, 0.1, 9.80665))

        def ulps(found, true):
            return abs(D(float(found)) - true) / D(math.ulp(float(true)))

        worst = D(0)
        with opened("planar_2r") as f:
            for i in range(len(f["state"])):
                q, qd = [D(float(x)) for x in f["q"][i]], [D(float(x)) for x in f["qd"][i]]
                a, s1 = cos_sin(q[0])
                ca, sa = cos_sin(q[0] + q[1])
                c12, s12 = cos_sin(q[1])
                M12 = I2 + m2 * (c2 * c2 + l1 * c2 * c12)
                h = m2 * l1 * c2 * s12
                both = qd[0] + qd[1]
                pairs = [(f["M"][i, 0, 0], I1 + I2 + m1 * c1**2 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * c12)),
                         (f["M"][i, 0, 1], M12), (f["M"][i, 1, 1], I2 + m2 * c2**2),
                         (f["G"][i, 0], (m1 * c1 + m2 * l1) * g * a + m2 * c2 * g * ca), (f["G"][i, 1], m2 * c2 * g * ca),
                         (f["C"][i, 0], -h * qd[1] * (2 * qd[0] + qd[1])), (f["C"][i, 1], h * qd[0] ** 2),
                         (f["position"][i, 0], l1 * a + l2 * ca), (f["position"][i, 2], l1 * s1 + l2 * sa),
                         (f["J"][i, 3, 1], -l2 * sa), (f["J"][i, 5, 0], l1 * a + l2 * ca),
                         (f["Jdot_qd"][i, 3], -l1 * a * qd[0] ** 2 - l2 * ca * both**2)]
                worst = max([worst, *(ulps(x, y) for x, y in pairs if y != 0)])
                self.assertTrue(all(x == 0 for x, y in pairs if y == 0))
        self.assertLessEqual(worst, D("0.5") + D("1e-10"))  # rounded to nearest

    def test_double_precision_stays_within_its_bounds(self):
        with opened("arm7") as f:
            csv = FOLDER / "states.csv"
            lines = [",".join(repr(float(x)) for x in [*q, *qd, *u]) for q, qd, u in zip(f["q"], f["qd"], f["u"])]
            csv.write_text("\n".join(lines) + "\n")
            done = call("terms", ROOT / "models/arm7.urdf", "--tip", "tool0", "--states", csv, "--json")
            for i, terms in enumerate(json.loads(done.stdout)):
                Omega = f["Omega"][i]
                d = np.repeat([math.sqrt(Omega.diagonal()[:3].max()), math.sqrt(Omega.diagonal()[3:].max())], 3)
                for side in ("recursive", "dense"):
                    off = np.abs(np.array(terms[side]["Omega"]) - Omega) / np.outer(d, d)
                    self.assertLessEqual(off.max(), terms["bound"]["Omega"])
                    Lambda = f["Lambda"][i] * np.outer(d, d)
                    off = np.abs(np.array(terms[side]["Lambda"]) * np.outer(d, d) - Lambda)
                    self.assertLessEqual(off.max() / np.abs(Lambda).max(), terms["bound"]["Lambda"])
                self.assertLessEqual(relative(np.array(terms["M"]), f["M"][i]), 70 * EPS)
                self.assertLessEqual(relative(np.array(terms["G"]), f["G"][i]), 70 * EPS)


def turn(axis, angle):
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K


def arm_in_numpy(arm, types, q):
    """J at the tip and M from the numbers of /arm alone: the columns of every link's Jacobian."""
    R, p, joints, M = np.eye(3), np.zeros(3), [], np.diag(arm["armature"]).astype(float)

    def jacobian(point):
        J = np.zeros((6, len(q)))
        for k, (kind, axis, origin) in enumerate(joints):
            J[:, k] = [*axis, *np.cross(axis, point - origin)] if kind == "revolute" else [0, 0, 0, *axis]
        return J

    for k, kind in enumerate(types):
        p = p + R @ arm["joint_origin_position"][k]
        R = R @ arm["joint_origin_rotation"][k]
        axis = R @ arm["joint_axis"][k]
        joints.append((kind, axis, p))
        if kind == "revolute":
            R = R @ turn(arm["joint_axis"][k], q[k])
        else:
            p = p + axis * q[k]
        J = jacobian(p + R @ arm["link_center_of_mass"][k])
        M += J[:3].T @ R @ arm["link_inertia"][k] @ R.T @ J[:3] + arm["link_mass"][k] * J[3:].T @ J[3:]
    return M, jacobian(p + R @ arm["tip_position"])


class Page(unittest.TestCase):
    def test_the_numbers_under_arm_and_the_snippet_of_the_page(self):
        page = (ROOT / "docs/reference-data.md").read_text()
        snippet = re.search(r"```python\n(.*?)```", page, re.DOTALL).group(1)
        for name in ("puma560", "prismatic_arm"):
            with opened(name) as f:
                arm = {key: f["arm"][key][()] for key in f["arm"]}
                types = list(f["joint_type"].asstr())

            def mine(q, qd, wrong=False):
                M, J = arm_in_numpy(arm, types, q)
                h = 1e-2  # Jdot by central differences of sixth order: h^6 is far above rounding
                weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
                rate = sum(w * (arm_in_numpy(arm, types, q + k * h * qd)[1] - arm_in_numpy(arm, types, q - k * h * qd)[1])
                           for k, w in weights.items()) / h
                self.differences = max(self.differences, np.abs(rate @ qd - self.truth(name, q)).max())
                return M, J, self.truth(name, q), np.linalg.inv(J @ np.linalg.solve(M, J.T)) * (1.001 if wrong else 1)

            self.differences = 0
            code = snippet.replace("puma560.h5", str(FOLDER / f"{name}.h5"))
            exec(compile(code, "snippet", "exec"), {"mine": mine})
            self.assertLess(self.differences, 1e-8)  # h^6 = 1e-12, times seventh derivatives
            with self.assertRaisesRegex(AssertionError, "Lambda, state 0"):
                exec(compile(code, "snippet", "exec"), {"mine": lambda q, qd: mine(q, qd, wrong=True)})

    @staticmethod
    def truth(name, q):
        with opened(name) as f:
            return f["Jdot_qd"][np.flatnonzero((f["q"][()] == q).all(axis=1))[0]]


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=1))
