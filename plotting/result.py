"""A result file of osculate, read without loss: every number as it is stored, with its axes, labels and unit.

docs/result-file.md says what such a file holds.
"""
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

UNDECIDED_BOUND = 1e-3  # a claim whose bound is above this is not decided at that step


class NotAResult(Exception):
    """The file is not there, or is not a result file of osculate, or lacks something. The message says which."""


@dataclass(frozen=True)
class Verdict:
    """One row of /verdict. worst, bound and at_time [s] are NaN where the claim does not apply."""

    claim: str
    equation: str
    worst: float
    bound: float
    at_time: float
    result: int  # 1 pass, 0 fail, -1 not applicable
    undecided_steps: int
    reason: str

    @property
    def word(self):
        return {1: "pass", 0: "FAIL", -1: "not applicable"}[self.result]


@dataclass(frozen=True)
class Residual:
    """A claim at every recorded step. `values` and `bounds` have one element for each step; NaN: not judged there."""

    claim: str
    values: np.ndarray
    bounds: np.ndarray

    @property
    def judged(self):
        return ~(np.isnan(self.values) & np.isnan(self.bounds))

    @property
    def undecided(self):
        return self.judged & ~(self.bounds <= UNDECIDED_BOUND)

    @property
    def failing(self):
        return self.judged & ~self.undecided & ~(self.values <= self.bounds)


class Stored:
    """An open file of osculate. Use as a context manager. Also opens what a killed or running program has left so far.

    Rows along /time and /step are cut to the length that the axis has when the file is opened: a running program writes the
    axis last and goes on meanwhile. Raises NotAResult with a message that names the file.
    """

    maker, kind, required = "", "", ()  # the command, "run" or "sweep", variables that must be there

    def __init__(self, path):
        self.path = Path(path)
        self.file = _open(self.path, self.maker)
        missing = [name for name in self.required if name not in self.file]
        missing += [f"attribute {name}" for name in ("title", "status") if name not in self.file.attrs]
        if missing:
            self.close()
            raise NotAResult(
                f"{self.path}: HDF5, but not a result file of osculate: it has no {', '.join(missing)}. "
                f"Give a file made by {self.maker}."
            )
        self._rows = {name: self.file[name].shape[0] for name in ("time", "step") if name in self.file}

    def close(self):
        self.file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __contains__(self, name):
        return name in self.file

    def _dataset(self, name):
        if name not in self.file:
            raise NotAResult(f"{self.path}: has no variable /{name}. Was it made by another version of osculate?")
        return self.file[name]

    def read(self, name):
        """The values of a variable: numbers as stored, texts as str."""
        data = self._dataset(name)
        if h5py.check_string_dtype(data.dtype):
            text = data.asstr()[()]
            return text if data.shape == () else [str(item) for item in text]
        if data.shape == ():
            return data[()]
        return data[: self._rows.get(self.axes(name)[0])]

    def number(self, name):
        """A scalar, NaN where the file does not have it."""
        return float(self.file[name][()]) if name in self.file else float("nan")

    def axes(self, name):
        """Names of the axes of a variable, for instance ("time", "spatial"). An axis lies along itself."""
        data = self._dataset(name)
        if h5py.h5ds.is_scale(data.id):
            return (name,)
        return tuple(dimension[0].name.lstrip("/") for dimension in data.dims)

    def labels(self, name):
        """Labels of the last axis of a variable, for instance the joints."""
        return self.read(self.axes(name)[-1])

    def unit(self, name):
        """The unit of a variable; None where one unit does not fit all its elements."""
        return _text(self._dataset(name).attrs.get("units"))

    def long_name(self, name):
        return _text(self._dataset(name).attrs.get("long_name"))

    @property
    def title(self):
        return _text(self.file.attrs["title"])

    @property
    def status(self):
        """complete, failed, interrupted, recovered or running"""
        return _text(self.file.attrs["status"])

    @property
    def verdict(self):
        """pass, fail or as_expected; None if the run was not finished"""
        return _text(self.file.attrs.get("verdict"))


class Result(Stored):
    """The file of one run."""

    maker, kind, required = "`osculate run`", "run", ("time", "step", "step_time")

    @property
    def task_rows(self):
        """Names of the rows that the task controls."""
        return self.read("task_row") if "task_row" in self.file else []

    def verdicts(self):
        """Rows of /verdict by claim, in the order of the file. Empty if there is no verdict."""
        if "verdict/claim" not in self.file:
            return {}
        columns = {name: self.read(f"verdict/{name}") for name in Verdict.__dataclass_fields__}
        rows = [Verdict(**dict(zip(columns, row))) for row in zip(*columns.values())]
        return {row.claim: row for row in rows}

    def residuals(self):
        """The recorded residuals of all claims, in the order of the verdict or, without one, of the file."""
        group = self.file.get("verification", {})
        names = [name for name in group if f"{name}_bound" in group]
        order = [name for name in self.verdicts() if name in names]
        order += [name for name in names if name not in order]
        return [
            Residual(name, self.read(f"verification/{name}"), self.read(f"verification/{name}_bound")) for name in order
        ]


class Sweep(Stored):
    """The file of a sweep: one number for each variant."""

    maker, kind, required = "`osculate sweep`", "sweep", ("variant", "changes")

    @property
    def key(self):
        """The key path that changes from variant to variant; empty where more than one may."""
        return self.read("provenance/swept_key") if "provenance/swept_key" in self.file else ""


def open_result(path):
    """A Result or a Sweep, by what is in the file. Raises NotAResult."""
    with _open(Path(path), "`osculate run` or `osculate sweep`") as file:
        kind = Sweep if "variant" in file and "time" not in file else Result
    return kind(path)


def _open(path, maker):
    if not path.is_file():
        raise NotAResult(f"{path}: no such file. Give a result file made by {maker}.")
    try:
        return h5py.File(path, "r")
    except OSError as first:
        try:  # a run that goes on or was killed
            return h5py.File(path, "r", libver="latest", swmr=True)
        except OSError:
            raise NotAResult(
                f"{path}: cannot be read as HDF5 ({first}). Give a result file made by {maker}."
            ) from None


def _text(value):
    return value.decode() if isinstance(value, bytes) else value
