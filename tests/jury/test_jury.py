"""The jury: our two formulations alone, and with KDL, MuJoCo, Simbody and DART where their modules were built.

    test_jury.py Ours        needs nothing else
    test_jury.py Libraries   exit code 77, skipped, where a module is missing"""
import os
import pathlib
import subprocess
import sys
import unittest

import jury_page
from jury_page import LIBRARIES, RUNS, TERMS, hear

FAULTY = os.environ["OSCULATE_FAULTY"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
NONE = {"OSCULATE_ENGINES": "/nonexistent"}
# MuJoCo takes inertias about the centre of mass of the whole arm, so light wrists lose digits: docs/jury.md
ROUNDING_OF_MUJOCO = {"prismatic_arm": ("M", "Omega"), "puma560_akb86": ("M", "Omega")}


def by_text(*arguments, env=None):
    return subprocess.run([jury_page.PROGRAM, "jury", *map(str, arguments)], capture_output=True, text=True, timeout=100,
                          env=dict(os.environ, **(env or {})))


class Ours(unittest.TestCase):
    def test_without_libraries_it_says_so_and_compares_ours(self):
        for arm, options in (("puma560", []), ("satellite_arm", []), ("planar_2r", ["--rows", "vx,vz"])):
            found, code = hear(arm, options, states=20, env=NONE)
            self.assertEqual((code, found["members"]), (0, ["recursions", "dense"]), arm)
            for term in ("qdd", "Omega", "Lambda", "c", "g"):
                (pair,) = found["terms"][term]["pairs"]
                self.assertTrue(0 < pair["ratio"] <= 1, (arm, term, pair))
            self.assertEqual(found["terms"]["M"]["pairs"], [])  # the recursions form no M
            self.assertEqual(set(found["absent"]), set(LIBRARIES))
        done = by_text(ROOT / "models/arm7.urdf", env=NONE)
        self.assertIn("no other library takes part", done.stderr)
        self.assertIn("all agree", done.stdout)

    def test_without_rank_no_lambda_is_judged(self):
        found, code = hear("planar_2r", states=5, env=NONE)
        self.assertEqual(code, 0)
        self.assertEqual(found["terms"]["Lambda"]["undecided"], 5)
        self.assertIsNone(found["terms"]["Lambda"]["pairs"][0]["ratio"])
        self.assertEqual(found["terms"]["Omega"]["undecided"], 0)

    def test_faults_of_the_recursions_are_seen(self):
        for fault, term in (("compliance_joint", "Omega"), ("bias_force", "c"), ("gravity_tip", "g"), ("plant_bias", "qdd")):
            found, code = hear("puma560", states=5, program=FAULTY, env=dict(NONE, OSCULATE_FAULT=fault))
            self.assertEqual(code, 1, fault)
            self.assertEqual(found["terms"][term]["agree"], 0, fault)
            self.assertIn("two members cannot tell who is wrong", found["terms"][term]["remark"])

    def test_bad_input(self):
        arm = ROOT / "models/arm7.urdf"
        for arguments, words in ((["--disturb", "ODE:1"], "KDL, MuJoCo, Simbody or DART"), (["--disturb", "KDL:-2"], "above -1"),
                                 (["--rows", "x"], "choose from"), (["--states", "0"], "--states")):
            done = by_text(arm, *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)


class Libraries(unittest.TestCase):
    def test_every_arm(self):
        for arm, options in RUNS:
            with self.subTest(arm=arm, options=options):
                found, code = hear(arm, options, states=30)
                for name, reason in found["absent"].items():
                    self.assertNotIn("not built", reason)
                for term in TERMS:
                    if term in ROUNDING_OF_MUJOCO.get(arm, ()) and not found["terms"][term]["agree"]:
                        self.assertEqual(found["terms"][term]["alone"].split()[0], "MuJoCo")
                        self.assertLess(max(p["ratio"] for p in found["terms"][term]["pairs"]), 10)
                    else:
                        self.assertEqual(found["terms"][term]["agree"], 1, found["terms"][term]["remark"])
                self.assertEqual(code == 0, all(found["terms"][t]["agree"] for t in TERMS))
                if arm in ("arm7", "ur5e_like", "prismatic_arm", "planar_2r") or "--solid" in options:
                    self.assertEqual(found["absent"], {})
                    for term in TERMS:
                        members = len(found["members"]) - (term in ("M", "C", "G", "J", "Jdot_qd"))
                        self.assertEqual(len(found["terms"][term]["pairs"]), members * (members - 1) // 2)

    def test_one_mass_off_by_a_millionth_is_noticed_and_its_library_named(self):
        for name in LIBRARIES:
            found, code = hear("arm7", ["--disturb", f"{name}:1e-6"], states=5)
            self.assertEqual(code, 1)
            for term in ("M", "C", "G", "qdd", "Omega", "Lambda", "c", "g"):
                self.assertEqual(found["terms"][term]["alone"].split()[0], name, term)
            for term in ("J", "Jdot_qd"):  # kinematics has no mass in it
                self.assertEqual(found["terms"][term]["agree"], 1, term)

    def test_a_fault_of_the_recursions_leaves_them_alone(self):
        for fault, term in (("compliance_joint", "Omega"), ("bias_force", "c"), ("gravity_tip", "g"), ("plant_bias", "qdd")):
            found, code = hear("arm7", states=5, program=FAULTY, env={"OSCULATE_FAULT": fault})
            self.assertEqual((code, found["terms"][term]["alone"]), (1, "recursions"), fault)

    def test_the_text_names_who_stands_alone(self):
        done = by_text(ROOT / "models/arm7.urdf", "--disturb", "DART:1e-6", "--states", 3)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"M: DART \S+ stands alone; it differs by up to \S+ times the bound at state \d")
        self.assertIn("they do not agree", done.stdout)


if __name__ == "__main__":
    if "Libraries" in sys.argv[1:] and (lacking := [n for n, r in hear("arm7", states=1)[0]["absent"].items()]):
        print("skipped: not built:", ", ".join(lacking))
        sys.exit(77)
    unittest.main(verbosity=1)
