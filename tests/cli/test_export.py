"""`osculate export`: every value of a result file stands in the tables, bit for bit."""
import csv
import os
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

OSCULATE = os.environ["OSCULATE"]
EXPERIMENTS = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"]) / "experiments"


def osculate(*arguments):
    return subprocess.run([OSCULATE, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def read(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.file = cls.folder / "run.h5"
        done = osculate("run", EXPERIMENTS / "puma560_circle.yaml", "-o", cls.file, "--quiet", "--set", "duration=0.5")
        assert done.returncode == 0, done
        done = osculate("export", cls.file, "--csv", cls.folder / "tables")
        assert done.returncode == 0, done
        cls.tables = {p.stem: read(p) for p in (cls.folder / "tables").glob("*.csv")}

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_every_dataset_is_there_bit_for_bit(self):
        columns = self.tables["columns"][1:]
        alone = {row[0]: row for row in self.tables["values"][1:]}
        compared = 0
        with h5py.File(self.file) as result:
            datasets = []
            result.visititems(lambda name, item: datasets.append(name) if isinstance(item, h5py.Dataset) else None)
            for name in datasets:
                dataset = result[name]
                unit = dataset.attrs.get("units", "")
                text = h5py.check_string_dtype(dataset.dtype) is not None
                if dataset.shape == ():
                    value = dataset.asstr()[()] if text else dataset[()]
                    if text and "\n" in value:
                        self.assertEqual((self.folder / "tables" / (name.replace("/", ".") + ".txt")).read_text(), value)
                    elif text:
                        self.assertEqual(alone[name][1], value)
                    else:
                        np.testing.assert_equal(float(alone[name][1]), float(value))
                        self.assertEqual(alone[name][2], unit)
                    compared += 1
                    continue
                mine = [row for row in columns if row[2] == name]
                table = self.tables[mine[0][0].removesuffix(".csv")]
                places = [table[0].index(row[1]) for row in mine]
                found = [[line[i] for i in places] for line in table[1:]]
                self.assertEqual({row[3] for row in mine}, {unit}, name)
                if text:
                    self.assertEqual([v for line in found for v in line], list(dataset.asstr()[:].ravel()), name)
                else:
                    np.testing.assert_array_equal(np.array(found, float), dataset[:].reshape(len(dataset), -1), name)
                compared += 1
            self.assertGreater(len(datasets), 100)
            self.assertEqual(compared, len(datasets))

    def test_columns_bear_the_names_of_joints_and_components(self):
        header = self.tables["time"][0]
        with h5py.File(self.file) as result:
            joint = result["joint"].asstr()[0]
        self.assertIn(f"trajectory/joint_position[{joint}]", header)
        self.assertIn("operational_space/Omega[wx, vz]", header)

    def test_messages(self):
        again = osculate("export", self.file, "--csv", self.folder / "tables")
        self.assertEqual(again.returncode, 4)
        self.assertIn("has files already", again.stderr)
        self.assertIn("--force", again.stderr)
        self.assertEqual(osculate("export", self.file, "--csv", self.folder / "tables", "--force").returncode, 0)
        under = osculate("export", self.file, "--csv", self.file / "tables")
        self.assertEqual(under.returncode, 4)
        self.assertIn("cannot make this directory", under.stderr)
        missing = osculate("export", self.folder / "none.h5", "--csv", self.folder / "none")
        self.assertEqual(missing.returncode, 4)
        self.assertIn("no such file", missing.stderr)


unittest.main()
