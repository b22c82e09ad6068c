"""`osculate judge` on result files and on logs in CSV and HDF5 that another program writes."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

OSCULATE = os.environ["OSCULATE"]
SOURCE = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
MODEL = ["--model", str(SOURCE / "models/puma560.urdf"), "--base", "base_link", "--tip", "tool0"]
ARMATURE = "0.7840299686,2.324814845,0.5768733319,0.1907906261,0.1707062917,0.1940645057"  # of puma560_circle.yaml
# What each law leaves out of (16): docs/laws.md.
TRUTH = {
    "operational_space": set(),
    "resolved_acceleration": set(),
    "operational_space_dense": set(),
    "no_jdot_qd": {"jdot_qd"},
    "no_coriolis": {"coriolis"},
    "gravity_only": {"jdot_qd", "coriolis"},
    "block_inertia": {"uncoupled_lambda", "jdot_qd"},
    "pseudo_inverse": set(),
    "jacobian_transpose": {"constant_lambda", "jdot_qd", "coriolis"},
}


def osculate(*arguments, expect=0):
    done = subprocess.run([OSCULATE, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == expect, f"exit {done.returncode}, expected {expect}: {done.stdout}{done.stderr}"
    return done


class Judge(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.at = pathlib.Path(cls.directory.name)
        for law in TRUTH:
            cls.run_law(law, law)

    @classmethod
    def run_law(cls, law, name, *sets):
        more = [word for assignment in sets for word in ("--set", assignment)]
        subprocess.run([OSCULATE, "run", SOURCE / "experiments/puma560_circle.yaml", "--set", f"controller.law={law}",
                        "--set", "duration=2", "--set", "verify.shadow=false", *more, "-o", cls.at / f"{name}.h5",
                        "--quiet", "--force"], capture_output=True, check=False)  # laws that leave a term out fail claims

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def judged(self, *arguments, expect):
        return json.loads(osculate("judge", *arguments, "--json", expect=expect).stdout)

    def test_every_law_of_the_program_is_named(self):
        for law, missing in TRUTH.items():
            with self.subTest(law):
                found = self.judged(self.at / f"{law}.h5", expect=1 if missing else 0)
                self.assertEqual({f["term"] for f in found["findings"]}, missing)
                self.assertEqual(found["verdict"], "wrong" if missing else "right")
                self.assertEqual(found["doubts"], [])
                for finding in found["findings"]:
                    if finding["term"] != "constant_lambda":
                        value = finding["coefficients"][0]["value"]
                        self.assertAlmostEqual(abs(value), 1, delta=1e-3)

    def columns(self, law):
        """Of a law that does not compensate friction, which a log of another program could not say."""
        self.run_law(law, "plain", "controller.compensate_friction=false")
        with h5py.File(self.at / "plain.h5") as f:
            t, g = f["time"][:], f["trajectory"]
            return t, g["joint_position"][:], g["joint_velocity"][:], g["joint_torque"][:], g["command"][:]

    def write_csv(self, name, blocks, extra=""):
        header = ",".join(n for n, _ in blocks)
        path = self.at / name
        np.savetxt(path, np.column_stack([b for _, b in blocks]), delimiter=",", header=header + extra, comments="",
                   fmt="%.17g")
        return path

    def numbered(self, name, count, first=1):
        return ",".join(f"{name}{i + first}" for i in range(count))

    def test_csv_of_another_program(self):
        t, q, qd, tau, u = self.columns("gravity_only")
        log = self.write_csv("log.csv", [("t", t), (self.numbered("q", 6), q), (self.numbered("qd", 6), qd),
                                         (self.numbered("tau", 6), tau), ("u_wx,u_wy,u_wz,u_vx,u_vy,u_vz", u)])
        found = self.judged(log, *MODEL, "--armature", ARMATURE, expect=1)
        self.assertEqual({f["term"] for f in found["findings"]}, {"jdot_qd", "coriolis"})
        said = osculate("judge", log, *MODEL, "--armature", ARMATURE, expect=1).stdout
        self.assertIn("omits J* Lambda Jdot qd (coefficient ", said)

    def test_hdf5_of_another_program_and_the_order_of_u(self):
        t, q, qd, tau, u = self.columns("no_coriolis")
        path = self.at / "log.h5"
        with h5py.File(path, "w") as f:
            f["t"], f["q"], f["qd"], f["tau"] = t, q, qd, tau
            f["u"] = np.hstack([u[:, 3:], u[:, :3]])
        arguments = [path, *MODEL, "--armature", ARMATURE]
        found = self.judged(*arguments, "--u-order", "linear", expect=1)
        self.assertEqual({f["term"] for f in found["findings"]}, {"coriolis"})
        self.assertEqual(found["conventions"], [])
        found = self.judged(*arguments, expect=1)
        self.assertIn("linear rows first", found["conventions"][0])
        found = self.judged(*arguments, "--u-order", "angular", expect=1)  # declared: then it is a mistake
        self.assertIn("swapped_rows", {f["term"] for f in found["findings"]})

    def test_bad_input(self):
        t, q, qd, tau, u = self.columns("operational_space")
        no_u = self.write_csv("no_u.csv", [("t", t), (self.numbered("q", 6), q), (self.numbered("qd", 6), qd),
                                           (self.numbered("tau", 6), tau)])
        for arguments, words in [
            ([no_u, *MODEL], "Without either any torque could be right"),
            ([no_u], "for the log of another program say --model and --tip"),
            ([self.at / "absent.csv", *MODEL], "absent.csv"),
            ([no_u, *MODEL, "--armature", "1,2"], "--armature has 2 entries, needs 1 or 6"),
            ([no_u, *MODEL, "--stiffness", "100"], "belong together"),
            ([no_u, *MODEL, "--rows", "vq"], "'vq' is no task row"),
        ]:
            said = osculate("judge", *arguments, expect=2).stderr
            self.assertIn(words, said)


if __name__ == "__main__":
    unittest.main()
