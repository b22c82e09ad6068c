"""docs/paper.md says what is so: equations, files, functions, tests and bounds; `osculate paper` prints its tables."""
import os
import pathlib
import re
import subprocess
import unittest

import paper_map

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
PAGE = ROOT / "docs" / "paper.md"


def paper(model, *options):
    command = [PROGRAM, "paper", ROOT / "models" / model, *map(str, options)]
    return subprocess.run(command, capture_output=True, text=True, timeout=280)


def split(line, columns):
    """Equation, statement and the `columns` last words of a row that the program prints."""
    found = re.fullmatch(r"(\(\d+\)(?:-\(\d+\)|(?:, \(\d+\))*)|section [\d.]+|text after \(\d+\)|-) +(.*)", line)
    if not found:
        return None
    return found[1], *re.fullmatch("(.*?)" + r" +(\S+)" * columns, found[2]).groups()


class Page(unittest.TestCase):
    maxDiff = 2000

    def setUp(self):
        self.text = PAGE.read_text()

    def test_it_is_what_the_sources_say_now(self):
        self.assertEqual(self.text, paper_map.page(), "run ./dev bounds, or tests/paper/paper_map.py docs/paper.md")

    def test_every_equation_file_function_and_test_is_there(self):
        self.assertEqual(paper_map.faults_of(self.text), [])

    def test_every_constant_of_bounds_is_on_it(self):
        table = self.text.split("## Bounds")[1]
        rows = re.findall(r"^\| .* \| ([\d.e+]+) \| ([\d.e+]+) \|$", table, re.M)
        header = (ROOT / "src" / "paper" / "bounds.hpp").read_text()
        constants = re.findall(r"^ *\{([\d.e+]+), ([\d.e+]+), \d+\}", header, re.M)
        self.assertGreater(len(constants), 0)
        self.assertEqual([(constant, worst) for worst, constant in rows], constants)

    def changed(self, old, new):
        self.assertIn(old, self.text)
        return paper_map.faults_of(self.text.replace(old, new))

    def test_the_check_can_fail(self):
        self.assertIn("no articulated in src/recursion/sweeps.hpp", self.changed("`articulate`", "`articulated`"))
        self.assertIn("no CoordinateChart::commands in src/control/coordinates.hpp",
                      self.changed("`CoordinateChart::command`", "`CoordinateChart::commands`"))
        self.assertIn("no file src/recursion/sweep.hpp", self.changed("/sweeps.hpp)", "/sweep.hpp)"))
        self.assertIn("no test called prove", self.changed("| proof, bounds |", "| prove, bounds |"))
        self.assertIn("no test M is a matrix in tests/reference/exact_laws.cpp",
                      self.changed("M is the matrix of the kinetic energy", "M is a matrix"))
        self.assertIn("equation (52) is missing", self.changed("\n| (52) |", "\n| (51) |"))
        self.assertIn("equations are out of order", self.changed("\n| (52) |", "\n| (1) |"))
        self.assertEqual(paper_map.faults_of(self.text.replace("## Tests", "")), ["no section Tests"])

    def test_names_are_found_where_they_are_defined_only(self):
        text = ("// int told(int);\nstruct Later;\nclass Box {\n public:\n  int size() const;\n};\n"
                "template <class S>\nS twice(S x) {\n  return once(x) + once(x);\n}\n"
                "int Box::size() const { return 0; }\n")
        for name in ("Box", "twice", "Box::size"):
            self.assertTrue(paper_map.defines(text, name), name)
        for name in ("Later", "told", "once", "twic", "Box::twice", "Boxes::size"):
            self.assertFalse(paper_map.defines(text, name), name)

    def test_bounds_of_other_statements_are_refused(self):
        source = paper_map.source
        self.addCleanup(setattr, paper_map, "source", source)
        for old, new in (("// (25) ", "// (26) "), ("    {", "    //{")):
            paper_map.source = lambda name: source(name).replace(old, new, 1 if name.endswith("bounds.hpp") else 0)
            with self.assertRaises(paper_map.Wrong):
                paper_map.page()


class Program(unittest.TestCase):
    maxDiff = 4000

    def setUp(self):
        self.told = [row[:2] for row in paper_map.identities() + paper_map.recursions()]

    def test_every_statement_passes_on_an_arm(self):
        done = paper("puma560.urdf", "--states", 3)
        rows = [row for row in (split(line, 3) for line in done.stdout.splitlines()) if row]
        self.assertEqual([row[:2] for row in rows], self.told)
        self.assertEqual([row for row in rows if row[4] not in ("pass", "n/a")], [])
        self.assertGreater(sum(row[4] == "pass" for row in rows), 90)
        for row in rows:
            if row[4] == "pass":
                self.assertLessEqual(float(row[2]), float(row[3]), row)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_over_fractions_every_statement_is_exact_and_the_wrong_prints_are_not(self):
        done = paper("planar_2r.urdf", "--states", 2, "--exact", "--arms", 1)
        _, _, exact = done.stdout.partition("\nover exact fractions: ")
        proven, _, printed = exact.partition("\nas printed, which is wrong\n")
        rows = [re.fullmatch(r"(.*?) +(\d+) +(exactly 0)", line) for line in proven.splitlines()[4:]]
        self.assertNotIn(None, rows, proven)
        self.assertEqual([split(row[1], 0) for row in rows], self.told)
        self.assertGreater(min(int(row[2]) for row in rows), 0)

        rows = [re.fullmatch(r"(.*?) +(\d+) +not 0 on (\d+) arms", line) for line in printed.splitlines()[1:]]
        self.assertNotIn(None, rows, printed)
        self.assertEqual([split(row[1], 0) for row in rows], paper_map.printed_forms())
        self.assertEqual([int(row[2]) for row in rows], [paper_map.EXACT_ARMS] * len(rows))
        self.assertEqual(tuple(int(row[3]) for row in rows), paper_map.PRINTED_NOT_ZERO)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_model_that_cannot_be_read_is_bad_input(self):
        done = paper("no_such_arm.urdf")
        self.assertEqual(done.returncode, 2)
        self.assertIn("no_such_arm.urdf: no such file", done.stderr)
        self.assertEqual(paper("README.md").returncode, 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
