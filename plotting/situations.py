"""Figures of what the arm meets: its manipulability, a surface, what the law misses, motion that the tip does not see."""
import re

import numpy as np
from matplotlib.patches import Ellipse

import style
from style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, NotApplicable, label

LINES = ((BLUE, "-"), (ORANGE, "--"), (GREEN, "-."), (PURPLE, ":"), (SKY, "-"), (VERMILION, "--"), (BLACK, "-."), (GREY, ":"))
ELLIPSES = 12  # at most so many along the path


def _lines(axes, time, values, names):
    """One line for each column that has numbers. Returns the names of those that have none."""
    absent = []
    for column, (name, (colour, line)) in enumerate(zip(names, LINES)):
        if np.isnan(values[:, column]).all():
            absent.append(name)
            continue
        axes.plot(time, values[:, column], line, color=colour, label=name, marker=style.marker_for(time))
    return absent


def manipulability(result):
    """Principal effective masses and inertias, nearness of a singularity, and the effective mass along the path."""
    space = "operational_space/"
    style.require(result, *(space + name for name in ("effective_mass", "effective_inertia", "sigma_min")))
    time = result.read("time")
    figure = style.new_figure(result, "manipulability", (12.5, 8.2))
    left, right = figure.subfigures(1, 2, width_ratios=(1.1, 1))
    panels = left.subplots(4, 1, sharex=True, height_ratios=(1.4, 1.4, 1, 1))
    for axes, name, quantity in zip(panels, ("effective_mass", "effective_inertia"), ("effective mass", "effective inertia")):
        values = result.read(space + name)
        infinite = _lines(axes, time, style.positive(values), result.read("principal"))
        for text in infinite if len(time) else ():
            axes.plot([], [], " ", label=f"{text}: infinite")
        axes.set_ylabel(label(quantity, result.unit(space + name)))
        style.logarithmic(axes, values)
        style.legend_above(axes)
    for axes, name, text in zip(panels[2:], ("sigma_min", "cond_Omega"), ("smallest scaled\neigenvalue of Ω", "cond(Ω)")):
        values = result.read(space + name)
        axes.plot(time, style.positive(values), color=BLUE, marker=style.marker_for(time))
        axes.set_ylabel(label(text, result.unit(space + name)))
        style.logarithmic(axes, values)
    for axes in panels:
        style.time_axis(axes, time, text=axes is panels[-1])
    _mass_along_path(right.subplots(), result)
    return figure


def _apart(points, distance):
    """Indices of points of which each is further than `distance` from those before it."""
    chosen = []
    for i, point in enumerate(points):
        if len(chosen) < ELLIPSES and all(np.hypot(*(point - points[j])) > distance for j in chosen):
            chosen.append(i)
    return chosen


def _mass_along_path(axes, result):
    """The tip's path in the two coordinates in which it moves most, and ellipses whose half axes are effective masses."""
    position, names = result.read("trajectory/tip_position"), result.read("xyz")
    unit = result.unit("trajectory/tip_position")
    if len(position) == 0:
        axes.set(xticks=[], yticks=[], xlabel=label("position", unit), ylabel=label("position", unit))
        style.note(axes, "no data")
        return
    extent = np.ptp(position, axis=0)
    plane = np.sort(np.argsort(-extent, kind="stable")[:2])
    path, span = position[:, plane], max(extent.max(), 1e-3)
    axes.plot(*path.T, color=GREY, label="path of the tip")
    axes.plot(*path[0], "o", color=BLACK, markersize=4, label="start of the tip")

    masses = result.read("operational_space/effective_mass")
    principal = result.read("operational_space/effective_mass_axes")
    shapes = [(i, _projected(masses[i], principal[i][:, plane])) for i in _apart(path, span / 4)]
    known = [(i, shape) for i, shape in shapes if shape is not None]
    typical = np.median([half[0] for _, (half, _) in known]) if known else np.nan
    known = [(i, shape) for i, shape in known if shape[0][0] <= 4 * typical]
    scale = 0.12 * span / typical
    for count, (i, (half, direction)) in enumerate(known):
        axes.add_patch(Ellipse(path[i], *(2 * scale * half), angle=np.degrees(np.arctan2(*direction[::-1])), edgecolor=BLUE,
                               facecolor=SKY, alpha=0.45, label="effective mass" if count == 0 else None))
    low, high = path.min(axis=0), path.max(axis=0)
    middle, half_width = (low + high) / 2, 0.5 * span + 0.22 * span
    axes.set_aspect("equal")
    axes.set(xlim=middle[0] + half_width * np.array([-1, 1]), ylim=middle[1] + half_width * np.array([-1.12, 1]),
             xlabel=label(names[plane[0]], unit), ylabel=label(names[plane[1]], unit))
    if known:  # a bar below the path
        bar = _round_number(typical)
        start = middle - half_width * np.array([0.93, 1.04])
        axes.plot(start[0] + np.array([0, scale * bar]), start[[1, 1]], color=BLUE, linewidth=2.5)
        axes.text(start[0] + scale * bar + 0.03 * span, start[1], f"half axis of {bar:g} kg", va="center", fontsize=8)
    if len(known) < len(shapes):
        axes.plot([], [], " ", label=f"{len(shapes) - len(known)} of {len(shapes)} left out: too large")
    axes.locator_params(nbins=6)
    style.legend_above(axes, 3)


def _projected(masses, directions):
    """Shadow on a plane of the ellipsoid with these half axes: half axes, larger first, and the larger one's direction.

    `directions`: for each principal direction its two components in the plane. None where the shadow is unbounded.
    """
    across = np.hypot(*directions.T) < 1e-6  # a mass across the plane casts no shadow
    sizes = np.where(across, 0, masses)
    if not np.isfinite(sizes).all():
        return None
    values, vectors = np.linalg.eigh((directions.T * sizes**2) @ directions)
    half = np.sqrt(np.maximum(values, 0))[::-1]
    return (half, vectors[:, 1]) if half[0] > 0 else None


def _round_number(x):
    """1, 2 or 5 times a power of ten, the largest that is at most x."""
    power = 10.0 ** np.floor(np.log10(x))
    return power * max(digit for digit in (1, 2, 5) if digit * power <= x * (1 + 1e-9))


def in_contact(result):
    """Spans in which the tip touches, by the recorded steps."""
    return style.spans(result.read("step_time"), result.read("solver/contact") > 0)


def _list_after(text, start):
    """Words of the list in brackets that follows the pattern `start`; [] if there is none."""
    found = re.search(start + r"\[([^\]]*)\]", text)
    return [word.strip() for word in found.group(1).split(",")] if found else []


def desired_force(result):
    """Force of the surroundings on the tip that the law asks for, N m or N by task row. Empty without force control."""
    text = result.read("provenance/experiment") if "provenance/experiment" in result else ""
    section = r"(?m)^  force: \{rows: "
    rows = _list_after(text, section)
    desired = _list_after(text, section + r"\[[^\]]*\], desired: ")
    return {row: -float(force) for row, force in zip(rows, desired)}


def _desired_pressure(result):
    """Normal force that the law asks for, N; None where no single controlled row lies along the normal of a plane."""
    text = result.read("provenance/experiment") if "provenance/experiment" in result else ""
    normal = np.array(_list_after(text, r"(?m)^  environment: \{type: plane, .*normal: "), dtype=float)
    along = [(row, n) for row, n in zip(("vx", "vy", "vz"), normal) if n != 0]
    if len(along) != 1 or along[0][0] not in desired_force(result):
        return None
    return desired_force(result)[along[0][0]] * np.sign(along[0][1])


def contact(result):
    """Gap and normal force of the surface that the tip may touch, and the wrench on the tip."""
    if "contact/gap" not in result:
        raise NotApplicable("the experiment has no surface to touch")
    time, touching = result.read("time"), in_contact(result)
    wrench, names, units = result.read("trajectory/tip_force"), result.labels("trajectory/tip_force"), result.read("spatial_force_unit")
    parts = [(slice(3, 6), "force on the tip"), (slice(0, 3), "moment on the tip")][: 2 if wrench[:, :3].any() else 1]
    figure = style.new_figure(result, "contact", (8.5, 4.8 + 2.3 * len(parts)))
    gap, pressure, *below = panels = figure.subplots(2 + len(parts), 1, sharex=True)
    dot = style.marker_for(time)
    gap.plot(time, result.read("contact/gap"), color=BLUE, marker=dot)
    gap.axhline(0, color=BLACK, linewidth=0.8)
    gap.set_ylabel(label("gap", result.unit("contact/gap")))

    pressure.plot(time, result.read("contact/pressure"), color=BLUE, label="normal force", marker=dot)
    wanted = _desired_pressure(result)
    if wanted is not None:
        pressure.axhline(wanted, color=VERMILION, linestyle="--", label="desired")
    pressure.set_ylabel(label("normal force", result.unit("contact/pressure")))

    desired = desired_force(result)
    for axes, (part, quantity) in zip(below, parts):
        for i, component, (colour, line) in zip(range(6)[part], "xyz", LINES):
            axes.plot(time, wrench[:, i], line, color=colour, label=component, marker=dot)
            if names[i] in desired:
                axes.axhline(desired[names[i]], color=colour, linestyle=(0, (1, 3)), label=f"desired {component}")
        axes.set_ylabel(label(quantity, units[part][0]))
    for axes in panels:
        style.shade(axes, touching, GREY, "tip in contact")
        style.legend_above(axes, 7)
        style.time_axis(axes, time, text=axes is panels[-1])
    return figure


def departure(result):
    """How far the tip's acceleration is from the commanded one, where a policy or a contact acts, and the tracking error."""
    parts = ("angular", "linear")
    style.require(result, *(f"departure/{part}_acceleration" for part in parts))
    missed = [result.read(f"departure/{part}_acceleration") for part in parts]
    steps, time = result.read("step_time"), result.read("time")
    if len(steps) and all(np.isnan(values).all() for values in missed):
        raise NotApplicable("the law commands no acceleration of the tip")
    figure = style.new_figure(result, "departure from the commanded acceleration", (8.5, 9))
    panels = figure.subplots(4, 1, sharex=True)
    for axes, part, values in zip(panels, parts, missed):
        axes.plot(steps, style.positive(values), color=BLUE, label="|tip acceleration - u|", marker=style.marker_for(steps), linewidth=0.8)
        axes.set_ylabel(label(f"missed {part}\nacceleration", result.unit(f"departure/{part}_acceleration")))
        style.logarithmic(axes, values, times=steps, decades=16)

    error, unit = result.read("trajectory/pose_error"), result.read("spatial_error_unit")
    names, by_force = result.labels("trajectory/pose_error"), desired_force(result)
    for axes, quantity, part in zip(panels[2:], ("orientation", "position"), (range(3), range(3, 6))):
        rows = [i for i in part if names[i] in result.task_rows and names[i] not in by_force]
        size = np.linalg.norm(error[:, rows], axis=1)
        axes.plot(time, style.positive(size), color=GREEN, label=f"tracking error ({', '.join(names[i] for i in rows) or 'no rows'})",
                  marker=style.marker_for(time))
        axes.set_ylabel(label(f"{quantity} error", unit[part[0]]))
        style.logarithmic(axes, size, decades=16)
    for axes in panels:
        for where, colour, text in _special(result, steps):
            style.shade(axes, where, colour, text)
        style.legend_above(axes)
    whole = np.sort(np.concatenate([time, steps]))  # a stopped run ends between two recorded instants
    for axes in panels:
        style.time_axis(axes, whole, text=axes is panels[-1])
    return figure


def _special(result, steps):
    """Spans in which the law cannot do what was commanded, with colour and name."""
    truncated = style.spans(steps, result.read("solver/truncated") > 0)
    if truncated:
        yield truncated, ORANGE, "directions truncated"
    elif result.number("measured/policy_seconds") > 0:
        first, last = (result.number(f"measured/policy_{end}") for end in ("first", "last"))
        yield [(first, last)], ORANGE, "from first to last act of the singularity policy"
    touching = in_contact(result)
    if touching:
        yield touching, GREY, "tip in contact"


def self_motion(result):
    """Kinetic energy of motion that the tip does not see, its share, and the velocities of the joints."""
    style.require(result, "energy/self_motion")
    joints, rows = len(result.read("velocity_coordinate")), len(result.task_rows)
    if joints <= rows:
        raise NotApplicable(f"the arm is not redundant: {joints} velocity coordinates, {rows} task rows")
    time, own, kinetic = result.read("time"), result.read("energy/self_motion"), result.read("energy/kinetic")
    if len(time) and np.isnan(own).all():
        raise NotApplicable("Lambda does not exist at any recorded instant")
    velocity, names = result.read("trajectory/joint_velocity"), result.labels("trajectory/joint_velocity")
    units = result.read("velocity_unit")
    kinds = [unit for unit in ("rad/s", "m/s") if unit in units]
    figure = style.new_figure(result, "self-motion", (9, 6.5 + 1.9 * len(kinds)))
    top, middle, *lower = figure.subplots(2 + len(kinds), 1, sharex=True)
    dot = style.marker_for(time)
    top.plot(time, style.positive(kinetic), color=GREY, label="kinetic energy", marker=dot)
    top.plot(time, style.positive(own), color=BLUE, label="of it self-motion, which the tip does not see", marker=dot)
    top.set_ylabel(label("energy", result.unit("energy/kinetic")))
    style.logarithmic(top, kinetic, own, times=time, decades=16)
    style.legend_above(top)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(kinetic > 0, own / kinetic, np.nan)
    middle.plot(time, share, color=BLUE, marker=dot)
    middle.set(ylabel=label("share of self-motion", "1"), ylim=(-0.03, 1.03))
    for axes, unit in zip(lower, kinds):
        chosen = [i for i, other in enumerate(units) if other == unit]
        for count, i in enumerate(chosen):
            colour, line = LINES[count % len(LINES)][0], ("-", "--", ":")[count // len(LINES) % 3]
            axes.plot(time, velocity[:, i], line, color=colour, label=names[i], marker=dot)
        axes.set_ylabel(label("joint velocity", unit))
        if len(chosen) <= 16:
            style.legend_above(axes, 7)
    for axes in figure.axes:
        style.time_axis(axes, time, text=axes is figure.axes[-1])
    return figure
