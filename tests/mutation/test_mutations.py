"""Every seeded fault is caught by the claims named in advance, and nothing is caught without a fault."""
import pathlib
import sys
import time
import unittest

import matrix


class Table(unittest.TestCase):
    def test_it_names_every_fault_and_no_other(self):
        names = [fault.name for fault in matrix.faults()]
        self.assertGreaterEqual(len(names), 60)
        self.assertEqual(sorted(set(fault for fault, _, _ in matrix.NAMED) | set(matrix.EQUIVALENT)), sorted(names))
        self.assertEqual(len(set((fault, experiment) for fault, experiment, _ in matrix.NAMED)), len(matrix.NAMED))

    def test_every_fault_says_what_is_wrong_and_is_seeded(self):
        for fault in matrix.faults():
            self.assertTrue(fault.wrong, fault.name)
            self.assertTrue(fault.group, fault.name)
            self.assertTrue(matrix.places(fault.name), f"{fault.name} is seeded nowhere")

    def test_it_names_experiments_and_claims_that_exist(self):
        judged = set((matrix.ROOT / "docs" / "claims.md").read_text().split())
        for fault, experiment, claims in matrix.NAMED:
            self.assertIn(experiment, matrix.experiments(), fault)
            self.assertTrue(claims, fault)
            self.assertLessEqual(set(claims.split()), judged, fault)

    def test_the_page_lists_every_fault(self):
        page = (matrix.ROOT / "docs" / "mutations.md").read_text()
        for fault, experiment, claims in matrix.NAMED:
            rows = [line for line in page.splitlines() if line.startswith(f"| `{fault}` |") and f"| {experiment} |" in line]
            self.assertEqual(len(rows), 1, f"{fault}, {experiment}: run ./dev mutations")
            for claim in claims.split():
                self.assertIn(f"**{claim}**", rows[0], f"{fault}: run ./dev mutations")
        self.assertNotIn("NOT AS NAMED", page)


class Runs(unittest.TestCase):
    def test_every_fault_is_caught_as_named(self):
        jobs = [(matrix.FAULTY, experiment, fault) for fault, experiment, _ in matrix.NAMED]
        for (fault, experiment, claims), outcome in zip(matrix.NAMED, matrix.run_all(jobs)):
            with self.subTest(fault=fault, experiment=experiment):
                self.assertEqual(matrix.complaint(outcome, claims), "", outcome.text)

    def test_without_a_fault_the_copy_passes_wherever_a_fault_was_seeded(self):
        used = sorted(set(experiment for _, experiment, _ in matrix.NAMED))
        for experiment, outcome in zip(used, matrix.run_all([(matrix.FAULTY, experiment) for experiment in used])):
            with self.subTest(experiment=experiment):
                self.assertEqual((outcome.code, outcome.failed), (0, []), outcome.text)

    def test_the_program_passes_these_experiments_in_full(self):
        names = matrix.experiments()
        outcomes = matrix.run_all([(matrix.PROGRAM, experiment, "", False) for experiment in names])
        for experiment, outcome in zip(names, outcomes):
            with self.subTest(experiment=experiment):
                self.assertEqual((outcome.code, outcome.failed), (0, []), outcome.text)

    def test_an_unknown_fault_is_bad_input(self):
        outcome = matrix.run(matrix.FAULTY, "puma560_circle", "no_such_fault")
        self.assertEqual(outcome.code, 2, outcome.text)

    def test_the_real_program_has_no_faults_to_seed(self):
        outcome = matrix.run(matrix.PROGRAM, "puma560_circle", "shift_force")
        self.assertEqual((outcome.code, outcome.executed), (0, 0), outcome.text)
        for program, selects in ((matrix.PROGRAM, False), (matrix.FAULTY, True)):
            self.assertEqual(b"OSCULATE_FAULT" in pathlib.Path(program).read_bytes(), selects, program)


if __name__ == "__main__":
    start = time.monotonic()
    result = unittest.main(verbosity=2, exit=False).result
    print(f"{time.monotonic() - start:.0f} s", file=sys.stderr)
    sys.exit(0 if result.wasSuccessful() else 1)
