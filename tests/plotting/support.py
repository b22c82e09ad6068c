"""What the tests of the figures share.

Environment: OSCULATE (the program), OSCULATE_SOURCE_DIR (the project's root).
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import weakref
from pathlib import Path

os.environ["MPLBACKEND"] = "Agg"
PROGRAM = os.environ["OSCULATE"]
ROOT = Path(os.environ["OSCULATE_SOURCE_DIR"])
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "plotting"))

import numpy as np  # noqa: E402
from figures import FIGURES, SWEEP_FIGURES, NotApplicable  # noqa: E402
from result import Result  # noqa: E402

LABEL = re.compile(r"\[[^\[\]]+\]$")  # a unit at the end


def run(experiment, output, *settings, verb="run"):
    """Runs an experiment or a sweep. Returns the exit code."""
    more = [word for setting in settings for word in ("--set", setting)]
    command = [PROGRAM, verb, str(experiment), "-o", str(output), "--force", *(["--quiet"] if verb == "run" else []), *more]
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode


def plot(*arguments):
    command = [sys.executable, str(ROOT / "plotting" / "plot.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def report(*arguments, **environment):
    command = [sys.executable, str(ROOT / "plotting" / "report.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **environment})


def make_all(result):
    """The figures of a run or a sweep by name, and the reasons of those that are left out."""
    made, left_out = {}, {}
    for name, make in (SWEEP_FIGURES if result.kind == "sweep" else FIGURES).items():
        try:
            made[name] = make(result)
        except NotApplicable as reason:
            left_out[name] = str(reason)
    return made, left_out


def panels(figure):
    return [axes for axes in figure.axes if axes.axison or axes.name == "3d"]


def legend_texts(axes):
    return axes.get_legend_handles_labels()[1]


def spans(axes):
    """Shaded spans along x: pairs (from, to)."""
    return [tuple(patch.get_xy()[[0, 2], 0]) for patch in axes.patches if hasattr(patch, "get_xy") and patch.get_transform() != axes.transData
            and len(patch.get_xy()) in (4, 5)]


def _texts(axes):
    """Texts of a panel that are seen, ticks included."""
    legend = axes.get_legend()
    yield from (axes.xaxis.label, axes.yaxis.label, axes.title, axes._left_title, *axes.texts, *(legend.get_texts() if legend else ()))
    for axis in (axes.xaxis, axes.yaxis):
        yield axis.get_offset_text()
        low, high = sorted(axis.get_view_interval())
        for tick in axis.get_major_ticks():
            if tick.label1.get_visible() and low - 1e-9 * abs(low) <= tick.get_loc() <= high + 1e-9 * abs(high):
                yield tick.label1


_measured = weakref.WeakKeyDictionary()


def _boxes(figure):
    """Texts of everything written in the figure, but for what 3D axes turn, and their extents: left, bottom, right, top in pixels.

    Measured once: a figure must not change afterwards.
    """
    if figure not in _measured:
        figure.draw_without_rendering()
        renderer = figure._get_renderer()
        seen = [figure._suptitle, figure._supxlabel, figure._supylabel, *figure.texts]
        seen += [text for part in (figure, *figure.subfigs) for legend in part.legends for text in legend.get_texts()]
        seen += [part._suptitle for part in figure.subfigs]
        for axes in panels(figure):
            if axes.name != "3d":
                seen += _texts(axes)
        unique = {id(text): text for text in seen if text is not None and text.get_visible() and text.get_text().strip()}
        extents = [text.get_window_extent(renderer).extents for text in unique.values()]
        _measured[figure] = [text.get_text() for text in unique.values()], np.reshape(extents, (-1, 4))
    return _measured[figure]


def overlaps(figure):
    """Pairs of texts that overlap."""
    texts, boxes = _boxes(figure)
    low, high = boxes[:, :2], boxes[:, 2:]
    meet = np.all((low[:, None] <= high) & (low <= high[:, None]), axis=2)
    return [(texts[i], texts[j]) for i, j in zip(*np.nonzero(np.triu(meet, 1)))]


def outside(figure):
    """Texts that the edge of the figure cuts."""
    texts, boxes = _boxes(figure)
    left, bottom, right, top = figure.bbox.extents
    cut = (boxes[:, 0] < left) | (boxes[:, 1] < bottom) | (boxes[:, 2] > right) | (boxes[:, 3] > top)
    return [texts[i] for i in np.flatnonzero(cut)]


class Files(unittest.TestCase):
    """Runs a few experiments for a short time, once."""

    wanted = {}  # name: settings

    @classmethod
    def setUpClass(cls):
        cls.directory = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.directory)
        cls.files = {}
        for name, settings in cls.wanted.items():
            cls.files[name] = cls.directory / f"{name}.h5"
            assert run(ROOT / "experiments" / f"{name}.yaml", cls.files[name], *settings) == 0, name

    def open(self, name):
        result = Result(self.files[name])
        self.addCleanup(result.close)
        return result
