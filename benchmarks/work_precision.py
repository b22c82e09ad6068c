"""Work-precision study: runs the program work_precision (or reads its CSV), draws the figure and writes the tables.

    work_precision.py PROGRAM                      docs/work-precision.csv, its figure and the tables of docs/work-precision.md
    work_precision.py PROGRAM --csv FILE.csv       the same from a CSV that was made before
"""
import argparse
import csv
import math
import pathlib
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SOURCE / "plotting"))

from matplotlib.figure import Figure  # noqa: E402

from style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION  # noqa: E402

PAGE = SOURCE / "docs/work-precision.md"
DATA = SOURCE / "docs/work-precision.csv"
PICTURE = SOURCE / "docs/work-precision.png"
PROBLEMS = {"ur5e_circle": "UR5e-like arm, circle, 10 s", "puma560_circle": "PUMA 560, circle, 10 s",
            "free_swing": "PUMA 560, free swing, 3 s", "contact": "PUMA 560 on a stiff table, 4 s"}
SETTINGS = {"adams": (BLUE, "o"), "adams, order <= 5": (SKY, "v"), "adams, CVODE's own corrector": (BLACK, "x"),
            "bdf": (VERMILION, "s"), "runge_kutta": (GREEN, "^")}
TARGETS = (1e-4, 1e-6, 1e-8, 1e-9)
PEERS = {"MuJoCo, RK4": (ORANGE, "D"), "Simbody, CPodes Adams": (PURPLE, "P")}
PEERS_PROBLEM = "ur5e_circle"
PEER_TARGETS = (1e-6, 1e-9)


def read(file):
    with open(file, newline="") as f:
        rows = list(csv.DictReader(f))
    for row in rows:
        for key in row:
            if key not in ("problem", "setting"):
                row[key] = float(row[key] or "nan")  # fixed steps have no rtol
    return [row for row in rows if row["error"] > max(10 * row["floor"], 0)]


def at_error(rows, target, of):
    """What `of(row)` is where the error is `target`: a straight line through logarithms within a decade around it.

    Nothing if the runs do not reach both sides of the target."""
    near = [(math.log10(row["error"] / target), math.log(of(row))) for row in rows if 0.1 < row["error"] / target < 10]
    if len(near) < 3 or not min(near)[0] < 0.1 or not max(near)[0] > -0.1:
        return None
    mean_x = sum(x for x, _ in near) / len(near)
    mean_y = sum(y for _, y in near) / len(near)
    spread = sum((x - mean_x) ** 2 for x, _ in near)
    slope = sum((x - mean_x) * (y - mean_y) for x, y in near) / spread if spread else 0
    return math.exp(mean_y - slope * mean_x)


def work(rows, problem, setting, target):
    """Right-hand sides, steps and seconds of a setting at a true error, each None where it is not reached."""
    mine = [row for row in rows if row["problem"] == problem and row["setting"] == setting]
    return tuple(at_error(mine, target, lambda row, key=key: row[key]) for key in ("rhs", "steps", "seconds"))


def peer_table(rows):
    """The integrators of the peers that were there, with the time of each over that of ours."""
    present = [peer for peer in PEERS if any(row["setting"] == peer for row in rows)]
    if not present:
        return ["No peer was installed.", ""]
    lines = ["| system | " + " | ".join(f"{t:.0e} m: laws, steps, ms of processor time | times ours"
                                       for t in PEER_TARGETS) + " |",
             "|---|" + "---|---|" * len(PEER_TARGETS)]
    for name, setting in (("this project, Adams", "adams"), *((peer, peer) for peer in present)):
        cells = []
        for target in PEER_TARGETS:
            rhs, steps, seconds = work(rows, PEERS_PROBLEM, setting, target)
            ours = work(rows, PEERS_PROBLEM, "adams", target)[2]
            cells += (["-", "-"] if rhs is None or ours is None else
                      [f"{rhs:.0f}, {steps:.0f}, {1e3 * seconds:.1f}", f"{seconds / ours:.1f}"])
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return [*lines, ""]


def tables(rows):
    lines = []
    for problem, title in PROBLEMS.items():
        lines += [f"### {title}", "",
                  "| method | " + " | ".join(f"{t:.0e} m: rhs, steps, ms of processor time" for t in TARGETS) + " |",
                  "|---|" + "---|" * len(TARGETS)]
        for setting in dict.fromkeys(row["setting"] for row in rows):
            if setting in PEERS:
                continue
            cells = []
            for target in TARGETS:
                rhs, steps, seconds = work(rows, problem, setting, target)
                cells.append("-" if rhs is None else f"{rhs:.0f}, {steps:.0f}, {1e3 * seconds:.1f}")
            lines.append(f"| {setting.replace('<=', '&le;')} | " + " | ".join(cells) + " |")
        lines.append("")
    return lines


def figure(rows):
    height = 3.0 * len(PROBLEMS) + 0.7
    picture = Figure(figsize=(9.5, height))
    panels = picture.subplots(len(PROBLEMS), 2, sharey="row",
                              gridspec_kw={"left": 0.08, "right": 0.98, "bottom": 0.5 / height, "top": 1 - 0.8 / height,
                                           "hspace": 0.3, "wspace": 0.06})
    for (problem, title), (left, right) in zip(PROBLEMS.items(), panels):
        for setting, (colour, marker) in (SETTINGS | PEERS).items():
            mine = [row for row in rows if row["problem"] == problem and row["setting"] == setting]
            if not mine:
                continue
            for axes, of in ((left, lambda row: row["rhs"]), (right, lambda row: 1e3 * row["seconds"])):
                axes.loglog([of(row) for row in mine], [row["error"] for row in mine], color=colour, marker=marker,
                            markersize=3.5, linewidth=0.8, label=setting)
        left.set_ylabel("true error of the tip [m]")
        left.set_title(title, loc="left")
        for axes in (left, right):
            for target in (1e-6, 1e-9):
                axes.axhline(target, color=GREY, linewidth=0.6, linestyle=":")
    panels[-1][0].set_xlabel("right-hand sides (peers: evaluations of the law)")
    panels[-1][1].set_xlabel("processor time without checks [ms]")
    handles, labels = panels[0][0].get_legend_handles_labels()
    picture.legend(handles, labels, loc="upper center", ncol=4)
    picture.savefig(PICTURE)


def replaced(text, begin, end, lines):
    """`text` with `lines` between its lines `begin` and `end`."""
    head, rest = text.split(begin + "\n")
    tail = rest.split(end + "\n", 1)[1]
    return f"{head}{begin}\n\n" + "\n".join(lines) + f"\n{end}\n{tail}"


def write_page(rows):
    text = replaced(PAGE.read_text(), "<!-- measured -->", "<!-- end -->", tables(rows))
    PAGE.write_text(replaced(text, "<!-- peers -->", "<!-- end of peers -->", peer_table(rows)))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program", nargs="?")
    arguments.add_argument("--csv")
    given = arguments.parse_args()
    if not given.csv:
        with open(DATA, "w") as out:
            subprocess.run([given.program], stdout=out, check=True)
    rows = read(given.csv or DATA)
    figure(rows)
    write_page(rows)


if __name__ == "__main__":
    main()
