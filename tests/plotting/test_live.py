"""The live view of real runs: it waits, advances, ends with the run, and says when the run was killed.

Environment: as support.py says.
"""
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

from support import PROGRAM, ROOT, run

import h5py
import numpy as np
from live import Claim, View, being_written, screen
from result import Result

LOOK = re.compile(r"^(.*?): t (\S+) of (\S+) s, (\d+) steps, tip error (\S+) (?:m )?(\S+)")


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.directory)

    def watch(self, file, *options):
        """Starts live.py. Returns the process and the list that its lines arrive in, each with the time of its arrival."""
        command = [sys.executable, str(ROOT / "plotting" / "live.py"), str(file), "--every", "0.1", *map(str, options)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        lines = []
        reader = threading.Thread(target=lambda: lines.extend(line.rstrip("\n") for line in process.stdout))

        def stop():
            process.kill()
            process.wait()
            reader.join()
            process.stdout.close()

        self.addCleanup(stop)
        reader.start()
        return process, lines

    def start(self, file, seconds):
        command = [PROGRAM, "run", str(ROOT / "experiments" / "puma560_circle.yaml"), "-o", str(file), "--quiet", "--set", f"duration={seconds}"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def wait_until(self, what, message):
        for _ in range(1200):
            if what():
                return
            time.sleep(0.05)
        self.fail(message)

    def times(self, lines):
        return [float(LOOK.match(line).group(2)) for line in lines if LOOK.match(line)]

    def test_it_waits_advances_and_ends_with_the_run(self):
        file, page = self.directory / "run.h5", self.directory / "run.html"
        process, lines = self.watch(file, "--report", page)
        self.assertEqual(process.stderr.readline(), f"live.py: waiting for {file}\n")
        self.assertEqual(lines, [])
        self.assertIsNone(process.poll())
        run_process = self.start(file, 100000)
        self.wait_until(lambda: len(set(self.times(lines))) >= 4, "the view does not advance")
        seen = [t for t in self.times(lines) if t == t]
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(LOOK.match(lines[-1]).group(1), "running")
        self.wait_until(page.exists, "no page was made")
        self.assertIn('http-equiv="refresh"', page.read_text())
        run_process.send_signal(signal.SIGTERM)  # it stops in an orderly way and finishes its file
        self.assertEqual(run_process.wait(), 143)
        self.assertEqual(process.wait(timeout=60), 3)
        self.wait_until(lambda: lines and lines[-1].startswith("interrupted"), "the end is not told")
        with h5py.File(file) as data:  # what it told last is what the file ends with
            last, steps = max(data["time"][-1], data["step_time"][-1]), len(data["step"])
        told = LOOK.match(lines[-1])
        self.assertEqual((float(told.group(2)), int(told.group(4))), (float(f"{last:.6g}"), steps))
        self.assertNotIn('http-equiv="refresh"', page.read_text())  # the last page stays as it is

    def test_a_killed_run(self):
        file = self.directory / "killed.h5"
        run_process = self.start(file, 100000)
        process, lines = self.watch(file)
        self.wait_until(lambda: any(t > 0 for t in self.times(lines)), "the view does not advance")
        self.assertIs(being_written(file), True)
        run_process.kill()
        run_process.wait()
        self.assertIs(being_written(file), False)
        self.assertEqual(process.wait(timeout=60), 3)
        self.wait_until(lambda: lines[-1].startswith("killed: nothing writes the file any more. `osculate recover`"), "the kill is not told")

    def test_finished_runs(self):
        file = self.directory / "short.h5"
        self.assertEqual(run(ROOT / "experiments" / "puma560_circle.yaml", file, "duration=0.3"), 0)
        process, lines = self.watch(file)
        self.assertEqual(process.wait(timeout=60), 0)
        self.wait_until(lambda: lines, "nothing is told")
        self.assertTrue(lines[0].startswith("complete, verdict pass: t 0.3 of 0.3 s"))
        self.assertEqual(len(lines), 1)
        failing = self.directory / "failing.h5"  # a claim that is said to fail, and does not
        self.assertEqual(run(ROOT / "experiments" / "puma560_circle.yaml", failing, "duration=0.3", "expect.fails=[omega]"), 1)
        process, lines = self.watch(failing)
        self.assertEqual(process.wait(timeout=60), 1)
        stopped = self.directory / "stopped.h5"
        self.assertEqual(run(ROOT / "experiments" / "puma560_circle.yaml", stopped, "initial.q=[0, 0, 0, 0, 0, 0]"), 3)
        process, lines = self.watch(stopped)
        self.assertEqual(process.wait(timeout=60), 3)

    def test_what_is_refused(self):
        process, lines = self.watch(self.directory / "absent.h5", "--wait", "0.2")
        self.assertEqual(process.wait(timeout=60), 2)
        self.assertIn("no such file, after waiting 0.2 s", process.stderr.read())
        text = self.directory / "text.h5"
        text.write_text("no result")
        process, lines = self.watch(text)
        self.assertEqual(process.wait(timeout=60), 2)
        self.assertIn("cannot be read as HDF5", process.stderr.read())

    def test_the_view_shows_the_numbers_of_the_file(self):
        file = self.directory / "viewed.h5"
        self.assertEqual(run(ROOT / "experiments" / "puma560_circle.yaml", file, "duration=0.5"), 0)
        view = View()
        with Result(file) as result:
            self.assertTrue(view.look(result))
            self.assertFalse(view.look(result))  # nothing new
            for claim in result.residuals():
                shown = view.claims[claim.claim]
                decided = claim.judged & ~claim.undecided
                self.assertEqual((shown.failing, shown.undecided), (claim.failing.sum(), claim.undecided.sum()))
                if decided.any():
                    self.assertEqual(shown.worst, np.max(claim.values[decided] / claim.bounds[decided]))
            error = result.read("trajectory/pose_error")[-1]
            self.assertEqual(view.error, (np.linalg.norm(error[3:]), np.linalg.norm(error[:3])))
        text = screen(view, "running", 61.0, 100)
        self.assertIn("100.0 %  0.5 of 0.5 s  left 1:01", text[1])
        judged = [name for name, claim in view.claims.items() if not np.isnan(claim.value)]
        self.assertEqual([line.split()[0] for line in text[7:]], judged)
        self.assertLessEqual(max(map(len, text)), 100)

    def test_claims_are_followed_over_several_looks(self):
        """Parts and the whole say the same; undecided steps and failing ones are counted once."""
        times, nan = np.arange(6.0), np.nan
        values, bounds = np.array([nan, 1e-9, 3e-6, 0, 1e-8, 2e-9]), np.array([nan, 1e-8, 1e-6, 1e-8, 2e-3, 1e-8])
        whole, parts = Claim(), Claim()
        whole.take(times, values, bounds)
        for i in range(6):
            parts.take(times[i : i + 1], values[i : i + 1], bounds[i : i + 1])
        self.assertEqual(whole, parts)
        self.assertEqual((whole.failing, whole.undecided, whole.at, whole.value), (1, 1, 2.0, 2e-9))
        self.assertAlmostEqual(whole.worst, 3, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
