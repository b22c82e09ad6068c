"""A chain of many links from the file to the record: read, run, recorded, verified; nothing in it is n x n."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py

PROGRAM = os.environ["OSCULATE"]
SOURCE = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
LINKS = 200


class Large(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.kept.name)
        for n in (LINKS, 1000):
            subprocess.run([sys.executable, SOURCE / "models/make_chain.py", str(n), cls.folder], check=True)
        cls.file = cls.folder / "large.h5"
        cls.done = subprocess.run([PROGRAM, "run", cls.folder / f"chain{LINKS}.yaml", "-o", cls.file, "--quiet",
                                   "--set", "duration=0.1"], capture_output=True, text=True, timeout=120)

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def test_all_claims_pass(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout + self.done.stderr)
        for claim in ("torque", "forward_dynamics", "linearization", "null_space", "energy", "analytic_response"):
            self.assertRegex(self.done.stdout, rf"(?m)^{claim} .* pass$")

    def test_an_instant_holds_a_few_numbers_for_each_joint(self):
        with h5py.File(self.file) as file:
            instants = file["time"].shape[0]
            shapes = {}
            file.visititems(lambda name, item: shapes.update({name: item.shape}) if isinstance(item, h5py.Dataset) else None)
        for name, shape in shapes.items():
            self.assertLessEqual(sum(size >= LINKS for size in shape), 1, name)
        along_joints = [name for name, shape in shapes.items() if shape == (instants, LINKS)]
        self.assertEqual(sorted(along_joints), [f"trajectory/joint_{what}"
                                                for what in ("acceleration", "position", "torque", "velocity")])

    def test_a_thousand_links_are_read(self):
        done = subprocess.run([PROGRAM, "info", self.folder / "chain1000.urdf", "--base", "l0", "--tip", "tip"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("moving mass 20 kg", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^1000  j1000: continuous")


if __name__ == "__main__":
    unittest.main()
