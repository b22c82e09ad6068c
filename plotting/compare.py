"""Figures of several runs side by side: the same quantities as the figures of one run, one line for each file.

Each figure is a grid of panels. What a file does not have is missing from its panels; panels that no file has are left out.
"""
import math
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

import style
from motion import _ratio, short
from situations import LINES
from style import NotApplicable, label, outcome

MOST = len(LINES)  # files in one figure


class Line(NamedTuple):
    """One quantity of one file: `y` over `x`. A panel has the lines of all files with the same quantity and unit."""

    quantity: str
    unit: str
    x: np.ndarray
    y: np.ndarray
    logarithmic: bool = False
    across: str = "time [s]"  # label of x


def names_of(results):
    """Short names that tell the files apart."""
    stems = [result.path.stem for result in results]
    if len(set(stems)) < len(stems):
        stems = [f"{result.path.parent.name}/{result.path.stem}" for result in results]
    return [stem if stems.count(stem) == 1 else f"{stem} ({i + 1})" for i, stem in enumerate(stems)]


def _drawn(results, what, lines, columns=1, panel=(7.4, 1.75), by_column=False):
    """The figure of `lines`: for each file its Lines. Raises NotApplicable where there are none."""
    keys = list(dict.fromkeys((line.quantity, line.unit) for of_file in lines for line in of_file))
    if not keys:
        raise NotApplicable("none of the files has what it shows")
    columns = min(columns, len(keys))
    rows = math.ceil(len(keys) / columns)
    names = names_of(results)
    texts = [f"{name}: {outcome(result)}" for name, result in zip(names, results)]
    beside = max(1, int(columns * (panel[0] + 0.9) / (0.085 * max(map(len, texts)) + 0.6)))
    head = 0.75 + 0.2 * math.ceil(len(texts) / beside)
    gap = (1.05, 0.4 if columns > 1 else 0.25)
    width, height = columns * (panel[0] + gap[0]) + 0.25, head + rows * (panel[1] + gap[1]) + 0.3
    figure = Figure(figsize=(width, height))
    figure.suptitle(f"comparison of {len(results)} runs: {what}", fontsize=11, y=1 - 0.08 / height, va="top")
    grid = figure.add_gridspec(rows, columns, left=gap[0] / width, right=1 - 0.25 / width, top=1 - head / height,
                               bottom=(gap[1] + 0.3) / height, wspace=gap[0] / panel[0], hspace=gap[1] / panel[1])
    handles = {}
    for place, key in enumerate(keys):
        at = (place % rows, place // rows) if by_column else divmod(place, columns)
        axes = figure.add_subplot(grid[at])
        shown = []
        for i, (of_file, (colour, dash)) in enumerate(zip(lines, LINES)):
            line = next((line for line in of_file if (line.quantity, line.unit) == key), None)
            if line is None:
                continue
            values = style.positive(line.y) if line.logarithmic else line.y
            handles[i], = axes.plot(line.x, values, dash, color=colour, label=names[i], marker=style.marker_for(line.x))
            shown.append(line)
        if shown[0].logarithmic:
            times = shown[0].x if len(shown) == 1 else None
            style.logarithmic(axes, *(line.y for line in shown), times=times, decades=20)
        axes.set_ylabel(label(shown[0].quantity.replace(": ", "\n", 1), shown[0].unit))
        axes.yaxis.set_label_coords(-0.74 / panel[0], 0.5)
        if not shown[0].logarithmic:
            axes.locator_params(axis="y", nbins=5)
        _across(axes, shown, last=place + (1 if by_column else columns) >= len(keys) or (by_column and at[0] == rows - 1))
    order = sorted(handles)
    figure.legend([handles[i] for i in order], [texts[i] for i in order], loc="upper center", ncol=beside,
                  bbox_to_anchor=(0.5, 1 - 0.38 / height), borderaxespad=0)
    return figure


def _across(axes, lines, last):
    """Limits and label of x."""
    everything = np.concatenate([line.x for line in lines])
    everything = everything[np.isfinite(everything)]
    if lines[0].across != "time [s]":
        axes.set_xscale("log")
        axes.set_xlabel(lines[0].across)
        return
    if everything.size and everything.max() > everything.min():
        axes.set_xlim(everything.min(), everything.max())
    axes.tick_params(labelbottom=last)
    if last:
        axes.set_xlabel("time [s]")


def _along(result, path, quantity, logarithmic=False):
    """The Line of a variable of one column along /time or /step; [] where the file does not have it."""
    if path not in result:
        return []
    axis = result.axes(path)[0]
    values = np.asarray(result.read(path), dtype=float)
    if np.isnan(values).all():
        return []
    return [Line(quantity, result.unit(path), result.read("step_time" if axis == "step" else axis), values, logarithmic)]


def joints(results):
    """Position, velocity and torque of each joint coordinate."""
    parts = (("position", "joint_position", "position_unit"), ("velocity", "joint_velocity", "velocity_unit"),
             ("effort", "joint_torque", "effort_unit"))
    lines = []
    for result in results:
        of_file, time = [], result.read("time")
        for what, variable, unit_path in parts:
            path = f"trajectory/{variable}"
            values, units = result.read(path), result.read(unit_path)
            of_file += [Line(f"{what}: {short(name)}", unit, time, values[:, i]) for i, (name, unit) in enumerate(zip(result.labels(path), units))]
        lines.append(of_file)
    return _drawn(results, "joint motion", lines, columns=3, panel=(3.0, 1.2), by_column=True)


def _errors(result):
    error, names, units = result.read("trajectory/pose_error"), result.labels("trajectory/pose_error"), result.read("spatial_error_unit")
    for part, what in ((range(3, 6), "position"), (range(3), "orientation")):
        rows = [i for i in part if names[i] in result.task_rows]
        if rows:
            yield Line(f"{what} error of the tip", units[part[0]], result.read("time"), np.linalg.norm(error[:, rows], axis=1), True)


def tip(results):
    """The tip's position, and the tracking error on the controlled rows."""
    lines = []
    for result in results:
        position, unit = result.read("trajectory/tip_position"), result.unit("trajectory/tip_position")
        where = [Line(f"tip: {name}", unit, result.read("time"), position[:, i]) for i, name in enumerate(result.read("xyz"))]
        lines.append(where + list(_errors(result)))
    return _drawn(results, "tip position and tracking error", lines)


def residuals(results):
    """Each claim's residual over its bound: above 1 the claim fails."""
    lines = []
    for result in results:
        steps, of_file = result.read("step_time"), []
        for claim in result.residuals():
            if claim.judged.any():
                with np.errstate(divide="ignore", invalid="ignore"):
                    share = np.where(claim.values == 0, 0.0, claim.values / claim.bounds)
                of_file.append(Line(f"{claim.claim}: residual / bound", "1", steps, share, True))
        lines.append(of_file)
    return _drawn(results, "residual of each claim over its bound", lines, columns=3, panel=(3.0, 1.35))


def energy(results):
    """Energies and work, and what is missing between them."""
    lines = []
    for result in results:
        time, unit = result.read("time"), result.unit("energy/kinetic")
        parts = {name: result.read(f"energy/{name}") for name in ("kinetic", "potential", "work", "dissipated", "external_work")}
        total = parts["kinetic"] + parts["potential"]
        missing = np.abs(total - total[:1] - (parts["work"] - parts["dissipated"] + parts["external_work"]))
        lines.append([Line("kinetic energy", unit, time, parts["kinetic"]),
                      Line("potential energy: less its start", unit, time, parts["potential"] - parts["potential"][:1]),
                      Line("work of the joints", unit, time, parts["work"]), Line("dissipated", unit, time, parts["dissipated"]),
                      Line("imbalance", unit, time, missing, True)])
    return _drawn(results, "energy", lines)


def solver(results):
    """Step size, order and local error of the integrator."""
    lines = [_along(result, "solver/step_size", "step size", True) + _along(result, "solver/order", "order of the method")
             + _along(result, "solver/local_error", "local error: / tolerance", True) for result in results]
    return _drawn(results, "integrator", lines)


def condition(results):
    """Condition of Omega, and how much of the tip force is Coriolis and centrifugal force."""
    lines = []
    for result in results:
        c, force, of_file = result.read("operational_space/c"), result.read("operational_space/F"), _along(result, "operational_space/cond_Omega", "cond(Ω)", True)
        for part, what in ((slice(0, 3), "moments"), (slice(3, 6), "forces")):
            ratio = _ratio(c[:, part], force[:, part])
            if not np.isnan(ratio).all():
                of_file.append(Line(f"|c| / |F|: {what}", "1", result.read("time"), ratio, True))
        lines.append(of_file)
    return _drawn(results, "condition and Coriolis share", lines)


def global_error(results):
    """Estimates of the tip's true error so far."""
    lines = [_along(result, "solver/global_error_position", "estimate of the: position error", True)
             + _along(result, "solver/global_error_orientation", "estimate of the: orientation error", True) for result in results]
    return _drawn(results, "global error of the tip", lines)


def manipulability(results):
    """Principal effective masses and inertias, and nearness of a singularity."""
    lines = []
    for result in results:
        of_file = []
        for name, what in (("effective_mass", "effective mass"), ("effective_inertia", "effective inertia")):
            path = f"operational_space/{name}"
            if path not in result:
                continue
            for i, principal in enumerate(result.read("principal")):
                values = result.read(path)[:, i]
                if np.isfinite(values).any():
                    of_file.append(Line(f"{principal}: {what}", result.unit(path), result.read("time"), values, True))
        lines.append(of_file + _along(result, "operational_space/sigma_min", "smallest scaled: eigenvalue of Ω", True))
    return _drawn(results, "manipulability", lines, panel=(7.4, 1.3))


def departure(results):
    """How far the tip's acceleration is from the commanded one."""
    lines = [[line for part in ("angular", "linear")
              for line in _along(result, f"departure/{part}_acceleration", f"missed {part}: acceleration", True)] for result in results]
    return _drawn(results, "departure from the commanded acceleration", lines)


def contact(results):
    """Gap and normal force of the surface that the tip may touch, and the force on the tip."""
    lines = []
    for result in results:
        of_file = _along(result, "contact/gap", "gap") + _along(result, "contact/pressure", "normal force")
        if of_file:
            wrench, unit = result.read("trajectory/tip_force"), result.read("spatial_force_unit")[3]
            of_file.append(Line("force on the tip: magnitude", unit, result.read("time"), np.linalg.norm(wrench[:, 3:], axis=1)))
        lines.append(of_file)
    return _drawn(results, "contact", lines)


def self_motion(results):
    """Kinetic energy of motion that the tip does not see, of redundant arms."""
    lines = [_along(result, "energy/self_motion", "kinetic energy: of self-motion", True) + _along(result, "energy/kinetic", "kinetic energy", True)
             if len(result.read("velocity_coordinate")) > len(result.task_rows) else [] for result in results]
    return _drawn(results, "self-motion", lines)


def error_growth(results):
    """Largest difference of run and shadow run in each stretch of time."""
    path, lines = "measured/error_growth", []
    for result in results:
        time, error = (result.read(result.axes(path)[0]), result.read(path)) if path in result else (np.empty(0), np.empty(0))
        known = np.isfinite(error) & (error > 0)
        lines.append([Line("difference of: run and shadow, tip", result.unit(path) or "m", time, error, True, "time since the start [s]")] if known.any() else [])
    return _drawn(results, "growth of the integration error", lines, panel=(7.4, 3.6))


def frequency_response(results):
    """Gain and phase of the tip against the reference, and the error against the design."""
    lines = []
    for result in results:
        of_file = []
        if "frequency_response/gain" in result:
            frequency = result.read(result.axes("frequency_response/gain")[0])
            order = np.argsort(frequency)
            for name, what, unit, logarithmic in (("gain", "gain", "1", True), ("phase", "phase", "rad", False), ("error", "error of the: complex gain", "1", True)):
                of_file.append(Line(what, unit, frequency[order], result.read(f"frequency_response/{name}")[order], logarithmic, "frequency [Hz]"))
        lines.append(of_file)
    return _drawn(results, "frequency response, reference to tip", lines)


COMPARISONS = {make.__name__: make for make in (
    joints, tip, residuals, energy, solver, condition, global_error, manipulability, departure, contact, self_motion, error_growth,
    frequency_response)}
