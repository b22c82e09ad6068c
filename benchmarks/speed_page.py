"""Writes docs/speed.md from one run of bench_peers.   speed_page.py BENCH_PEERS BENCH_CORE PAGE"""

import json
import math
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import tempfile

import instructions

TASK, DYNAMICS = "task", "forward dynamics"
OURS = {TASK: "four sweeps", DYNAMICS: "sweeps 1, 2, accelerations"}
REPETITIONS = 9


def run(program):
    """(context, {(arm, call, system, route): list of microseconds}); repetitions of all routes take turns."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "times.json")
        subprocess.run([program, f"--benchmark_repetitions={REPETITIONS}", "--benchmark_min_time=0.02",
                        "--benchmark_enable_random_interleaving=true", "--benchmark_format=json",
                        f"--benchmark_out={out}"], check=True, stdout=subprocess.DEVNULL)
        result = json.loads(out.read_text())
    times = {}
    for row in result["benchmarks"]:
        if row["run_type"] == "iteration":
            times.setdefault(tuple(row["run_name"].split("|")), []).append(row["cpu_time"] / 1000)
    return result["context"], times


def number(value):
    """Three digits or more."""
    return f"{value:,.{max(0, 2 - math.floor(math.log10(value)))}f}"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def ratio_table(best, counts, call):
    routes = [(system, route) for arm, c, system, route in best if arm == "random7" and c == call]
    cells = []
    for system, route in routes:
        row = [system, f"`{route}`" if system != "ours" else route]
        for arm in ("random7", "random100"):
            time, ours = best.get((arm, call, system, route)), best[arm, call, "ours", OURS[call]]
            row += [number(time), f"{time / ours:.1f}"] if time else ["-", "-"]
        for arm in ("random7", "random100"):
            count = counts.get((f"{call}|{system}|{route}".replace(" ", "_"), arm))
            row.append(f"{count:,}" if count else "-")
        cells.append(row)
    cells.sort(key=lambda row: (row[0] != "ours", row[0]))
    head = ["system", "calls", "us, n = 7", "ratio", "us, n = 100", "ratio", "instructions, n = 7", "n = 100"]
    return table(head, cells)


def pace(best, counts):
    """Why a ratio of times is not that of instructions."""
    found = {}
    for (arm, call, system, route), time in sorted(best.items(), key=lambda row: -row[1]):
        count = counts.get((f"{call}|{system}|{route}".replace(" ", "_"), arm))
        if (arm, call) == ("random7", TASK) and count and (system != "ours" or route == OURS[TASK]):
            found[system] = count / time / 1000  # of the fastest route
    if "ours" not in found:
        return ""
    peers = ", ".join(f"{system} {found[system]:.1f}" for system in sorted(set(found) - {"ours"}))
    return (f"Instructions in a nanosecond, n = 7: our sweeps {found['ours']:.1f}; {peers}. In a sweep each link waits for\n"
            "the one before it, in a dense loop less: where a peer gets more done at a time, its ratio of times is below that\n"
            "of instructions. Several states at once do not wait: [packets](packets.md).")


def best_of(best, arm, call, system):
    """A system's fastest route; of ours the recursion."""
    if system == "ours":
        return best.get((arm, call, system, OURS[call]))
    return min((t for (a, c, s, _), t in best.items() if (a, c, s) == (arm, call, system)), default=None)


def arms_table(best, systems, call, arms):
    rows = []
    for arm, label in arms:
        ours = best_of(best, arm, call, "ours")
        row = [label, number(ours)]
        for system in systems:
            time = best_of(best, arm, call, system)
            row.append(f"{number(time)} ({time / ours:.1f})" if time else "-")
        rows.append(row)
    return table(["arm", "ours, us"] + [f"{system}, us (ratio)" for system in systems], rows)


def right_side(best, systems):
    ours = best["puma560", "right side", "ours", "reference, law, plant"]
    rows = [["ours", number(ours), "1.0"]]
    for system in systems:
        parts = [best_of(best, "puma560", call, system) for call in (TASK, DYNAMICS)]
        if None in parts:
            continue
        sum_ = sum(parts)
        rows.append([system, number(sum_), f"{sum_ / ours:.1f}"])
    return table(["system", "us", "ratio"], rows)


def agreement(context):
    rows = []
    for key, text in context.items():
        verdict, _, name = key.partition("|")
        if verdict in ("agrees", "refused"):
            arm, call, system, route = name.split("|")
            rows.append([arm, call, system, route, text + (" **refused**" if verdict == "refused" else "")])
    worst = {}
    for arm, call, system, route, text in rows:
        figure = max(float(x) if x != "inf" else math.inf for x in re.findall(r"\d\.\d+e[-+]\d+|inf|nan", text))
        at = worst.setdefault((system, route, call), {})
        at[arm] = f"{figure:.1e}" + (" refused" if "refused" in text else "")
    arms = ["random7", "random100", "puma560", "arm7"]
    return table(["system", "calls", "computes"] + arms,
                 [[s, r, c] + [found.get(arm, "-") for arm in arms] for (s, r, c), found in worst.items()])


def processor():
    flags = set(re.search(r"^flags\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)[1].split())
    level = "AVX-512" if "avx512vl" in flags else "AVX2" if "avx2" in flags else "no AVX2"
    speed = re.search(r"model name.*@ (\S+GHz)", pathlib.Path("/proc/cpuinfo").read_text())
    return f"{platform.machine()} with {level}" + (f", nominally {speed[1]}" if speed else "")


PAGE = """# Speed

Made by `./dev bench`: one program times our calls and those of the peers that are installed, on the same arms, each
peer called as somebody who knows it would: objects made once, no call for what is not asked for, a new state every
time. Every route's answers were compared with ours before it was timed. The repetitions of all routes take turns;
each figure is the best of {repetitions}. Typically the median is {median:.0%} above the best (worst row: {worst:.0%}).

- one core, {processor}
- `{build}`
- the peers are Debian's binaries for any x86-64. The composition around their calls has our flags, but without
  AVX2: some of their interfaces hold Eigen's types
- the arms: `random<n>` has n revolute joints with arbitrary axes, offsets and inertias; `puma560` and `arm7` are in
  `models/`. No rotor inertia, which not every peer has, and moments
  of the PUMA 560 raised to what a solid can have, because MuJoCo and Simbody refuse the published ones

## Omega, F and T

From q, qd and a tip acceleration u: Omega = J M^-1 J^T, F = Lambda u + c + g with gravity, and T = J^T F, all six rows,
inertial axes, about the tip point; cosines and sines included. A ratio is the peer's time over that of our sweeps.
"dense side" is our oracle, written to be plain, not fast.

{task}

{pace}

## Forward dynamics

From q, qd and T: qdd.

{dynamics}

## Other arms

Each peer by its fastest route. Omega, F and T:

{task_arms}

Forward dynamics:

{dynamics_arms}

## One right-hand side of a closed loop

PUMA 560: reference, law and plant, {ours_instructions}. Of the peers the sum of their rows above, without
reference, orientation error and feedback, which their users write.

{right_side}

## Agreement with ours before timing

The largest difference over {states} states, max |a - b| / max |b| of qdd, or of Omega, F (u = 0 too, where F = c + g)
and T. A route that differs by more than 1e-9 is refused and not timed.

{agreement}

## Instructions

Counted by callgrind over a batch of calls, start-up excluded. `benchmarks/instructions.txt` keeps our counts for each
compiler and its flags; the test `instructions` fails when one rises by more than 3 %. After a change that is meant to
cost more, or to keep a gain:

```sh
benchmarks/check_instructions build/dev/bench_core --accept
benchmarks/check_instructions build/fast/bench_core --accept
```

| call | arm | instructions |
|---|---|---|
{core}
"""


def main():
    program, core, page = sys.argv[1:]
    context, times = run(program)
    best = {key: min(values) for key, values in times.items()}
    spread = sorted(statistics.median(values) / min(values) - 1 for values in times.values())
    reason = instructions.why_not()
    counts = {} if reason else instructions.count(program, "--count")
    core_counts = {} if reason else instructions.count(core)
    systems = sorted({system for _, _, system, _ in best} - {"ours"})
    arms = [("puma560", "PUMA 560"), ("arm7", "arm7")] + [(f"random{n}", f"n = {n}") for n in (7, 12, 25, 50, 100)]
    loop = core_counts.get(("right_side", "puma560"))
    pathlib.Path(page).write_text(PAGE.format(
        repetitions=REPETITIONS, median=statistics.median(spread), worst=spread[-1], processor=processor(),
        build=context["build"], states=8, task=ratio_table(best, counts, TASK),
        pace=pace(best, counts),
        dynamics=ratio_table(best, counts, DYNAMICS), task_arms=arms_table(best, systems, TASK, arms),
        dynamics_arms=arms_table(best, systems, DYNAMICS, arms), right_side=right_side(best, systems),
        ours_instructions=f"{loop:,} instructions" if loop else "not counted here", agreement=agreement(context),
        core="\n".join(f"| {call} | {arm} | {n:,} |" for (call, arm), n in core_counts.items())))


if __name__ == "__main__":
    main()
