"""Is the global error that each run states the error it has? On problems whose solution is known in closed form, for
every integrator, over five tolerances and more.

    test_global_error.py                          the test
    test_global_error.py --write PAGE.md          every problem at every tolerance, as a page of the documentation
"""
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py

SOURCE = pathlib.Path(os.environ.get("OSCULATE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[2]))
PROGRAM = os.environ.get("OSCULATE", str(SOURCE / "build/dev/osculate"))
METHODS = ("adams", "bdf", "runge_kutta")
EPS = 2.0**-52

# name -> experiment, duration in s, joints, reach in m, overrides. With zero gains nothing pulls an error back.
PROBLEMS = {
    "PUMA 560, circle": ("puma560_circle", 2.5, 6, 1.5, []),
    "seven joints, Lissajous figure": ("arm7_lissajous", 1.5, 7, 1.5, []),
    "planar arm, line": ("planar_2r_line", 2.0, 2, 2.0, []),
    "planar arm, line, no feedback": ("planar_2r_line", 2.0, 2, 2.0,
                                      ["controller.gains={stiffness: 0, damping: 0}"]),
}
TESTED = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
ALL = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
# What the claim is: within this factor, wherever the true error is 1,000 times what rounding makes of it.
FACTOR = 5
ABOVE_ROUNDING = 1000


def floor_of(problem):
    """Rounding of the tip position, m: as the verdict has it."""
    _, _, joints, reach, _ = PROBLEMS[problem]
    return 16 * (joints + 1) * EPS * reach


def measure(problem, method, rtol, more=()):
    """Estimate and true error of the tip position, m; exit code; claims that failed."""
    name, duration, _, _, overrides = PROBLEMS[problem]
    with tempfile.TemporaryDirectory() as directory:
        file = os.path.join(directory, "run.h5")
        settings = [f"integrator.method={method}", f"integrator.rtol={rtol}", f"integrator.atol={rtol / 100}",
                    f"duration={duration}", "output.interval=1", *overrides, *more]
        command = [PROGRAM, "run", str(SOURCE / f"experiments/{name}.yaml"), "-o", file, "--quiet"]
        for setting in settings:
            command += ["--set", setting]
        done = subprocess.run(command, capture_output=True, text=True)
        with h5py.File(file) as f:
            failed = [c.decode() if isinstance(c, bytes) else c
                      for c, r in zip(f["verdict/claim"][:], f["verdict/result"][:]) if r == 0]
            return {"estimate": float(f["global_error/position"][()]),
                    "truth": float(f["analytic_response/position"][()]), "exit": done.returncode, "failed": failed,
                    "rhs": int(f["solver/rhs_evaluations"][-1])}


def study(tolerances, problems=PROBLEMS):
    cases = [(p, m, r) for p in problems for m in METHODS for r in tolerances]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        return dict(zip(cases, pool.map(lambda case: measure(*case), cases)))


class GlobalError(unittest.TestCase):
    def test_the_estimate_is_the_error(self):
        """Within a factor of five on every problem, integrator and tolerance; and no claim fails on the way."""
        results = study(TESTED)
        worst = 1.0
        judged = 0
        for (problem, method, rtol), got in results.items():
            with self.subTest(problem=problem, method=method, rtol=rtol):
                self.assertEqual(got["failed"], [])
                self.assertGreater(got["truth"], 0)
                if got["truth"] < ABOVE_ROUNDING * floor_of(problem):
                    continue
                judged += 1
                ratio = got["estimate"] / got["truth"]
                worst = max(worst, ratio, 1 / ratio)
                self.assertLess(ratio, FACTOR)
                self.assertGreater(ratio, 1 / FACTOR)
        self.assertGreater(judged, 0.8 * len(results))
        print(f"{judged} of {len(results)} runs judged, estimate within a factor {worst:.2f} of the error", flush=True)

    def test_an_error_follows_the_tolerance(self):
        """The check above has something to see: the true errors span decades."""
        for method in METHODS:
            loose = measure("planar arm, line", method, 1e-4)["truth"]
            tight = measure("planar arm, line", method, 1e-8)["truth"]
            self.assertGreater(loose, 100 * tight)


def page(results):
    lines = ["# The global error estimate",
             "",
             "Each run is followed by its shadow, the same problem at a hundredth of the tolerances; their largest",
             "distance so far is the run's estimate of its own error. Here it is held against the truth: operational space",
             "control makes the tip's error linear, so the solution is known in closed form. The bar is a factor of five",
             f"wherever the true error exceeds {ABOVE_ROUNDING:,} times the rounding of the tip position. With zero gains",
             "(no feedback) nothing pulls an error back.",
             "",
             "Made by `./dev errors`, tested in short form by `tests/experiments/test_global_error.py`. Tip position, m;",
             "rhs: evaluations of the right-hand side.",
             ""]
    worst = 1.0
    for problem in PROBLEMS:
        lines += [f"## {problem}", "", "| rtol | " + " | ".join(f"{m}: true error | estimate / true | rhs" for m in METHODS) + " |",
                  "|---|" + "---|---|---|" * len(METHODS)]
        for rtol in ALL:
            cells = []
            for method in METHODS:
                got = results[problem, method, rtol]
                above = got["truth"] >= ABOVE_ROUNDING * floor_of(problem)
                ratio = got["estimate"] / got["truth"] if got["truth"] > 0 else float("nan")
                if above:
                    worst = max(worst, ratio, 1 / ratio)
                cells += [f"{got['truth']:.1e}", f"{ratio:.2f}" if above else f"({ratio:.2f})", str(got["rhs"])]
            lines.append(f"| {rtol:.0e} | " + " | ".join(cells) + " |")
        lines.append("")
    lines += [f"Largest factor between estimate and truth: {worst:.2f}. In brackets: errors below the bar.", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--write":
        pathlib.Path(sys.argv[2]).write_text(page(study(ALL)))
    else:
        unittest.main()
