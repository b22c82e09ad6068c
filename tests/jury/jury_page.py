"""Runs `osculate jury` on every arm of models/ and writes docs/jury.md: python3 jury_page.py docs/jury.md

Environment: OSCULATE, the program; OSCULATE_SOURCE_DIR. Exit code 77 where a library is missing."""
import json
import os
import pathlib
import subprocess
import sys

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
TERMS = ("M", "C", "G", "J", "Jdot_qd", "qdd", "Omega", "Lambda", "c", "g")
LIBRARIES = ("KDL", "MuJoCo", "Simbody", "DART")
# Arm, options: task rows where the arm has fewer than six coordinates; --solid for arms with numbers that no body has.
RUNS = [("puma560", ["--solid"]), ("puma560", []), ("puma560_akb86", ["--solid"]), ("arm7", []), ("ur5e_like", []),
        ("prismatic_arm", []), ("planar_2r", ["--rows", "vx,vz"]), ("mobile_arm", []), ("chain60", []), ("satellite_arm", [])]


def hear(arm, options=(), states=100, program=PROGRAM, env=None):
    """What the jury found, and the program's exit code."""
    model = ROOT / "models" / f"{arm}.urdf"
    done = subprocess.run([program, "jury", str(model), "--json", "--states", str(states), *options],
                          capture_output=True, text=True, timeout=500, env=dict(os.environ, **(env or {})))
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{arm}: exit code {done.returncode}: {done.stderr}")
    return json.loads(done.stdout), done.returncode


def short(ratio):
    if ratio is None:
        return "-"
    return f"{ratio:.1e}" if ratio >= 1000 or 0 < ratio < 1e-3 else f"{ratio:.2g}"


def worst(found, term, member=None):
    ratios = [p["ratio"] for p in found["terms"][term]["pairs"]
              if p["state"] >= 0 and member in (None, p["a"], p["b"])]
    if not ratios:
        return "-"
    return "not finite" if None in ratios else short(max(ratios))


def table(head, rows):
    return "\n".join(["| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]])


def page():
    runs = [(arm, options, hear(arm, options)[0]) for arm, options in RUNS]
    reference = runs[0][2]
    overview, absent, remarks = [], [], []
    for arm, options, found in runs:
        name = f"`{arm}`" + (" " + " ".join(options) if options else "")
        overview.append([name, str(len(found["members"])), *(worst(found, term) for term in TERMS)])
        absent += [f"- {name}: {library}: {reason.splitlines()[0][:200]}" for library, reason in found["absent"].items()]
        remarks += [f"- {name}: {found['terms'][term]['remark']}" for term in TERMS if found["terms"][term]["remark"]]
    pairs = []
    for p in reference["terms"]["Omega"]["pairs"]:
        cells = []
        for term in TERMS:
            same = [x for x in reference["terms"][term]["pairs"] if (x["a"], x["b"]) == (p["a"], p["b"])]
            cells.append(short(same[0]["ratio"]) if same else "-")
        pairs.append([p["a"] + ", " + p["b"], *cells])
    solid = [f"- `{arm}`: {note}" for arm, _, found in runs for note in found["made_solid"]]
    return (table(["arm", "members", *TERMS], overview), table(["pair", *TERMS], pairs),
            "\n".join(remarks) or "None.", "\n".join(absent) or "None.", "\n".join(solid) or "None.",
            ", ".join(m for m in reference["members"][2:]))


def write(path):
    text = path.read_text()
    for name, content in zip(("arms", "pairs", "remarks", "absent", "solid", "versions"), page()):
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        before, rest = text.split(begin)
        text = before + begin + content + "\n" + end + rest.split(end)[1]
    path.write_text(text)


if __name__ == "__main__":
    missing = [name for name in LIBRARIES if name in hear("arm7", states=1)[0]["absent"]]
    if missing:
        print("not there:", ", ".join(missing))
        sys.exit(77)
    write(pathlib.Path(sys.argv[1]))
