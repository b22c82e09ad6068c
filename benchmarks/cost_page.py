"""What checks and the record of a run cost, against its plain simulation. Runs the anchor experiments and writes a page.
Usage: cost_page.py OSCULATE OUT.md"""
import pathlib
import re
import subprocess
import sys
import tempfile

PARTS = ["simulation", "shadow run", "checking", "recording"]
ANCHORS = [("ur5e_circle", 9), ("ur5e_circle_1e9", 9), ("ur5e_circle_long", 3)]  # and how often each is run

PAGE = """# What checks and the record cost

Made by `./dev bench`: the anchor experiments of [work-precision](work-precision.md), every accepted step checked
(`verify.every: step`), with the shadow run that the error estimate needs (`verify.shadow`), and recorded as the
experiments say: 100 rows a second and every step; the long one 10 rows a second and the worst steps. Milliseconds on one
core, build `{build}`, the best of several runs for each part. The last columns are ratios to the simulation alone.

{table}

- A row of the record is one more evaluation of the loop at the output time, Lambda, c and g from its sweeps and two more,
  the eigenvalues of Omega by two scales and of its two blocks, and some 200 numbers of its file.
- A check is the loop at the step's end, the recursions' terms from its sweeps and two more, the dense side (kinematics, M,
  C, G, two factorisations, task terms) and the residuals with their bounds; where there is a shadow run, the tip and the
  energies at its state too.
- The file has about 160 objects and 450 attributes, which HDF5 makes at a fixed cost: it governs runs of milliseconds.
- Cheaper: `verify: {{every: 10}}` checks every tenth step, `verify: {{shadow: false}}` goes without the error estimate and the
  claims that need it, a larger `output.interval` records fewer rows, `osculate verify` writes no file.
"""


def run(program, name, directory):
    """Wall times of the parts in ms, and the numbers of steps and rows."""
    experiment = pathlib.Path(__file__).parent.parent / "experiments" / f"{name}.yaml"
    command = [program, "run", str(experiment), "-o", f"{directory}/{name}.h5", "--force"]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    times = [1000 * float(re.search(rf"wall time:.* {part} ([0-9.]+) s", told)[1]) for part in PARTS]
    steps, seconds = re.search(r"(\d+) steps, .* right-hand sides, ([0-9.]+) s simulated", told).groups()
    return times, int(steps), float(seconds)


def number(ms):
    return f"{ms:.1f}" if ms < 100 else f"{ms:.0f}"


def row(program, name, repetitions, directory):
    runs = [run(program, name, directory) for _ in range(repetitions)]
    simulation, shadow, checking, recording = (min(times) for times in zip(*(r[0] for r in runs)))
    _, steps, seconds = runs[0]
    ratios = [(simulation + x) / simulation for x in (checking, checking + recording, checking + recording + shadow)]
    return [f"`{name}`", f"{seconds:g}", str(steps)] + [number(x) for x in (simulation, shadow, checking, recording)] + [
        f"{x:.1f}" for x in ratios]


def main(program, out):
    head = ["experiment", "s", "steps", "simulation", "shadow run", "checking", "recording", "+ checks", "+ record",
            "+ shadow run"]
    with tempfile.TemporaryDirectory() as directory:
        rows = [row(program, name, repetitions, directory) for name, repetitions in ANCHORS]
    lines = ["| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head)] + rows]
    pathlib.Path(out).write_text(PAGE.format(table="\n".join(lines), build=pathlib.Path(program).resolve().parent.name))


main(*sys.argv[1:])
