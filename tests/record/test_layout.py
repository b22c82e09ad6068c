"""The table of variables in docs/result-file.md against files of real runs: every variable that a run writes is in it, with
its axes, type, unit and meaning, and nothing else is. With --write the table is made again.
Usage: test_layout.py [--write], with OSCULATE and OSCULATE_SOURCE_DIR set."""
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py

SOURCE = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
PAGE = SOURCE / "docs/result-file.md"
START, END = "<!-- variables: tests/record/test_layout.py --write -->\n", "<!-- end of variables -->\n"
# Short runs that together write every variable that some experiment writes.
RUNS = {
    "puma560_circle": ["duration=0.3", "output.restart_interval=0.1"],
    "puma560_gimbal_lock": ["duration=0.2"],
    "puma560_frequency": [],
    "puma560_ball": ["duration=0.2"],
    "prismatic_arm_waypoints": ["duration=0.2"],
    "puma560_your_controller": ["duration=0.01"],
}


def type_of(dataset):
    kind = dataset.dtype.kind
    return "text" if kind == "O" else f"{'float' if kind == 'f' else 'int'}{8 * dataset.dtype.itemsize}"


def axes_of(dataset):
    if h5py.h5ds.is_scale(dataset.id):
        return "itself"
    return ", ".join(dimension[0].name.lstrip("/") for dimension in dataset.dims)


def variables_of(file):
    """{path: (axes, type, unit, meaning)} of a result file."""
    found = {}

    def look(path, item):
        if isinstance(item, h5py.Dataset):
            found[path] = (axes_of(item), type_of(item), item.attrs.get("units", ""), item.attrs.get("long_name", ""))

    file.visititems(look)
    return found


def run(name, settings, folder):
    out = f"{folder}/{name}.h5"
    command = [os.environ["OSCULATE"], "run", SOURCE / f"experiments/{name}.yaml", "-o", out, "--quiet", "--force"]
    for setting in settings:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode in (0, 1, 3), (name, done.stderr)
    with h5py.File(out) as file:
        return variables_of(file)


def collect(runs):
    """The variables of all runs; one that two runs describe differently is an error unless only its unit differs."""
    table = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, settings in runs.items():
            for path, what in run(name, settings, folder).items():
                axes, kind, unit, meaning = table.setdefault(path, what)
                assert (axes, kind, meaning) == (what[0], what[1], what[3]), (name, path, what, table[path])
                if what[2] not in unit.split(" or "):
                    table[path] = (axes, kind, f"{unit} or {what[2]}", meaning)
    return table


def markdown(table):
    lines = ["| variable | axes | type | unit | meaning |", "|---|---|---|---|---|"]
    for path, (axes, kind, unit, meaning) in sorted(table.items()):
        meaning = meaning.replace("|", "\\|")
        lines.append(f"| `/{path}` | {axes} | {kind} | {unit} | {meaning} |")
    return "\n".join(lines) + "\n"


def main():
    made = markdown(collect(RUNS))
    page = PAGE.read_text()
    before, rest = page.split(START)
    there, after = rest.split(END)
    if "--write" in sys.argv:
        PAGE.write_text(before + START + made + END + after)
        return
    missing = set(made.splitlines()) - set(there.splitlines())
    stale = set(there.splitlines()) - set(made.splitlines())
    assert not missing and not stale, f"docs/result-file.md is out of date:\nmissing {sorted(missing)}\nstale {sorted(stale)}"
    count = len(made.splitlines()) - 2
    assert count > 100, count
    print(f"{count} variables, as docs/result-file.md has them")


if __name__ == "__main__":
    main()
