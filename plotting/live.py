#!/usr/bin/env python3
"""Watches a run while it goes on: live.py FILE.h5 [--every SECONDS] [--report PAGE.html] [--wait SECONDS]

In a terminal the view refreshes in place; elsewhere each look is one line. It waits for a file that is not there yet, ends with
the run, and says so when the run was killed. With --report the page of report.py is written again and again, and loads itself.
Exit codes: 0 the run came out as expected, 1 a claim fails, 2 bad input, 3 the run stopped early, was interrupted or killed,
4 the page cannot be written, 130 Ctrl-C.
"""
import argparse
import math
import os
import shutil
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import experiment_text
import report
from result import UNDECIDED_BOUND, NotAResult, Result

PAGE_EVERY = 5.0      # s of wall time between two pages
SURE_AFTER = 3        # looks without a writer, after which the run counts as killed
QUIET_AFTER = 20.0    # s of wall time without a new row, after which the view says so


@dataclass
class Claim:
    """What the steps so far say of a claim: the newest residual, and the one nearest to or furthest over its bound."""

    value: float = math.nan
    bound: float = math.nan
    worst: float = math.nan  # residual / bound
    at: float = math.nan     # s
    failing: int = 0
    undecided: int = 0

    def take(self, times, values, bounds):
        judged = ~(np.isnan(values) & np.isnan(bounds))
        decided = judged & (bounds <= UNDECIDED_BOUND)
        self.undecided += int((judged & ~decided).sum())
        if judged.any():
            last = np.flatnonzero(judged)[-1]
            self.value, self.bound = float(values[last]), float(bounds[last])
        if not decided.any():
            return
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(values[decided] == 0, 0.0, values[decided] / bounds[decided])
        ratio = np.where(np.isnan(ratio), np.inf, ratio)
        self.failing += int((ratio > 1).sum())
        most = int(np.argmax(ratio))
        if not ratio[most] <= self.worst:
            self.worst, self.at = float(ratio[most]), float(times[decided][most])


@dataclass
class View:
    """What has been seen of the file so far. Each look reads only what is new."""

    title: str = ""
    status: str = ""
    verdict: str = ""
    duration: float = math.nan
    time: float = math.nan
    steps: int = 0
    error: tuple = (math.nan, math.nan)  # of the tip, m and rad, at the newest instant
    step_size: float = math.nan
    order: int = 0
    local_error: float = math.nan
    claims: dict = field(default_factory=dict)
    file: tuple = ()                     # device and inode
    seen_time: int = 0

    def look(self, result):
        """Takes what is new in an open file."""
        self.title, self.status, self.verdict = result.title, result.status, result.verdict or ""
        self.duration = experiment_text.duration(experiment_text.experiment(result))
        rows, steps = result.file["time"].shape[0], result.file["step"].shape[0]
        if rows:
            self.time = float(result.file["time"][rows - 1])
            error = result.file["trajectory/pose_error"][rows - 1]
            controlled = np.array([name in result.task_rows for name in result.read("spatial")])
            self.error = tuple(float(np.linalg.norm(error[part][controlled[part]])) for part in (slice(3, 6), slice(0, 3)))
        if steps > self.steps:
            new = slice(self.steps, steps)
            times = result.file["step_time"][new]
            group = result.file.get("verification", {})
            for name in group:
                if f"{name}_bound" in group:
                    self.claims.setdefault(name, Claim()).take(times, group[name][new], group[f"{name}_bound"][new])
            self.step_size, self.order, self.local_error = (
                result.file[f"solver/{name}"][steps - 1] for name in ("step_size", "order", "local_error"))
            self.time = max(self.time, float(times[-1])) if self.time == self.time else float(times[-1])
        grown = steps > self.steps or rows > self.seen_time
        self.steps, self.seen_time = steps, rows
        return grown


def being_written(path):
    """Whether a process has the file open for writing; None where the system does not tell."""
    try:
        wanted, told = os.stat(path), False
        for process in Path("/proc").iterdir():
            if not process.name.isdigit():
                continue
            try:
                for handle in (process / "fd").iterdir():
                    stat = handle.stat()
                    told = True
                    if (stat.st_dev, stat.st_ino) == (wanted.st_dev, wanted.st_ino):
                        flags = (process / "fdinfo" / handle.name).read_text().split("flags:")[1].split()[0]
                        if int(flags, 8) & (os.O_WRONLY | os.O_RDWR):
                            return True
            except (OSError, IndexError):  # another user's, or gone meanwhile
                continue
    except OSError:
        return None
    return False if told else None


def number(value, unit=""):
    return "-" if math.isnan(value) else f"{value:.2e}{' ' + unit if unit else ''}"


def clock(seconds):
    seconds = round(seconds)
    return f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}" if seconds >= 3600 else f"{seconds // 60}:{seconds % 60:02d}"


def status_line(view, state):
    worst = max(((claim.worst, name) for name, claim in view.claims.items() if not math.isnan(claim.worst)), default=None)
    nearest = f"{worst[1]} at {worst[0]:.2g} of its bound" if worst else "no claim judged"
    failing = [name for name, claim in view.claims.items() if claim.failing]
    return (f"{state}: t {view.time:.6g} of {view.duration:g} s, {view.steps} steps, tip error {number(view.error[0], 'm')} "
            f"{number(view.error[1], 'rad')}, step {number(view.step_size, 's')}, nearest: {nearest}"
            + (f", FAILING: {', '.join(failing)}" if failing else ""))


def screen(view, state, left, width):
    """The view as lines of a terminal."""
    share = min(1.0, max(0.0, view.time / view.duration)) if view.duration > 0 and not math.isnan(view.time) else 0.0
    room = max(10, min(40, width - 45))
    bar = "█" * round(share * room) + "░" * (room - round(share * room))
    lines = [f"{view.title}: {state}", f"{bar} {100 * share:5.1f} %  {view.time:.6g} of {view.duration:g} s" + (f"  left {clock(left)}" if left else ""), "",
             f"tip error    {number(view.error[0], 'm'):>14} {number(view.error[1], 'rad'):>14}",
             f"step size    {number(view.step_size, 's'):>14} {'order ' + str(view.order):>14}   local error {number(view.local_error)} of its tolerance", "",
             f"{'claim':<19}{'residual':>10}{'bound':>10}{'worst/bound':>13}{'at time':>12}{'failing':>9}{'undecided':>11}"]
    for name, claim in view.claims.items():
        if math.isnan(claim.bound) and math.isnan(claim.value):
            continue
        when = "-" if math.isnan(claim.at) else f"{claim.at:.4g} s"
        lines.append(f"{name:<19}{number(claim.value):>10}{number(claim.bound):>10}{'-' if math.isnan(claim.worst) else format(claim.worst, '.2g'):>13}"
                     f"{when:>12}{claim.failing:>9}{claim.undecided:>11}")
    return [line[:width] for line in lines]


class Watch:
    """Looks at the file until the run ends. `show(view, state, left)` is called after each look."""

    def __init__(self, path, options, show):
        self.path, self.options, self.show = path, options, show
        self.view, self.alone, self.page_at, self.rates = View(), 0, -math.inf, []

    def wait_for_file(self):
        begun, told = time.monotonic(), False
        while not self.path.exists():
            if time.monotonic() - begun > self.options.wait:
                raise NotAResult(f"{self.path}: no such file, after waiting {self.options.wait:g} s. Start the run, or give the right name.")
            if not told:
                print(f"live.py: waiting for {self.path}", file=sys.stderr)
                told = True
            time.sleep(min(self.options.every, 0.2))

    def left(self):
        """Estimate of the wall time left, s, from the last looks; None as long as nothing can be said."""
        self.rates = [*self.rates[-20:], (time.monotonic(), self.view.time)]
        (first, start), (last, end) = self.rates[0], self.rates[-1]
        return (self.view.duration - end) * (last - first) / (end - start) if end > start and last > first else None

    def page(self, result, last=False):
        if self.options.report and (last or time.monotonic() - self.page_at > PAGE_EVERY):
            report.write(self.options.report, report.page(result, refresh=None if last else PAGE_EVERY))
            self.page_at = time.monotonic()

    def run(self):
        """Returns the exit code."""
        self.wait_for_file()
        grown_at, unreadable = time.monotonic(), 0
        while True:
            try:
                stat = os.stat(self.path)
                if (stat.st_dev, stat.st_ino) != self.view.file:  # a new file under the name: all is read again
                    self.view = View(file=(stat.st_dev, stat.st_ino))
                writer = being_written(self.path)
                with Result(self.path) as result:
                    if self.view.look(result):
                        grown_at = time.monotonic()
                    over = result.status != "running"
                    self.alone = 0 if over or writer is not False else self.alone + 1
                    killed = self.alone >= SURE_AFTER
                    quiet = time.monotonic() - grown_at
                    state = ("killed: nothing writes the file any more. `osculate recover` makes a finished one of it" if killed
                             else self.ending() if over
                             else f"running, but no new rows for {quiet:.0f} s" if quiet > QUIET_AFTER else "running")
                    self.show(self.view, state, None if over or killed else self.left())
                    self.page(result, last=over or killed)
                unreadable = 0
                if over or killed:
                    return 3 if killed else self.code()
            except (NotAResult, OSError, KeyError) as error:  # its end is being written, or it is no result
                unreadable += 1
                if unreadable >= 5 or isinstance(error, PermissionError):
                    raise
            time.sleep(self.options.every)

    def ending(self):
        verdict = {"": "no verdict", "as_expected": "verdict as expected"}.get(self.view.verdict, f"verdict {self.view.verdict}")
        return f"{self.view.status}, {verdict}"

    def code(self):
        if self.view.status in ("failed", "interrupted", "recovered") and self.view.verdict != "as_expected":
            return 3
        return 1 if self.view.verdict == "fail" else 0


def terminal(view, state, left):
    columns, rows = shutil.get_terminal_size()
    lines = screen(view, state, left, columns)[: rows - 1]
    sys.stdout.write("\x1b[H" + "".join(line + "\x1b[K\n" for line in lines) + "\x1b[J")
    sys.stdout.flush()


def plain(view, state, left):
    print(status_line(view, state), flush=True)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="live.py", description="Watch a run while it goes on.")
    parser.add_argument("file", metavar="FILE.h5", help="result file of the run, also before it exists")
    parser.add_argument("--every", type=float, default=0.5, metavar="SECONDS", help="wall time between two looks (default: 0.5)")
    parser.add_argument("--report", metavar="PAGE.html", help=f"write the page of report.py every {PAGE_EVERY:g} s; it loads itself")
    parser.add_argument("--wait", type=float, default=math.inf, metavar="SECONDS", help="how long to wait for the file (default: for ever)")
    options = parser.parse_args(arguments)
    if not 0.01 <= options.every <= 3600:
        parser.error(f"--every {options.every:g}: give between 0.01 and 3600 s")
    live = sys.stdout.isatty()
    sys.stdout.reconfigure(errors="replace")  # a terminal without the characters of the bar
    try:
        if live:
            sys.stdout.write("\x1b[2J")
        return Watch(Path(options.file), options, terminal if live else plain).run()
    except KeyboardInterrupt:
        return 130
    except NotAResult as error:
        print(f"live.py: {error}", file=sys.stderr)
        return 2
    except report.NoLibrary as error:
        print(f"live.py: {error}", file=sys.stderr)
        return 4
    except OSError as error:
        print(f"live.py: {error.filename or options.file}: {error.strerror or error}", file=sys.stderr)
        return 4


if __name__ == "__main__":
    sys.exit(main())
