"""Figures of the motion: joints, tip, energy, condition."""
import math

import numpy as np

import style
from style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, label

JOINT_ROWS = 15  # joints below one another; more go into further blocks of three columns


def short(name, length=16):
    return name if len(name) <= length else f"{name[: length // 2]}…{name[-(length - length // 2 - 1):]}"


def joints(result):
    """Position, velocity and torque of each joint coordinate."""
    time = result.read("time")
    columns = (
        ("position", "trajectory/joint_position", "position_unit", BLUE),
        ("velocity", "trajectory/joint_velocity", "velocity_unit", GREEN),
        ("torque", "trajectory/joint_torque", "effort_unit", VERMILION),
    )
    count = max(len(result.labels(path)) for _, path, _, _ in columns)
    blocks = math.ceil(count / JOINT_ROWS)
    rows = math.ceil(count / blocks)
    panel = (2.7, 1.15) if blocks == 1 else (2.0, 1.15)
    figure, grid = style.new_grid(result, "joint motion", (rows, 3 * blocks), panel, gap=(1.05, 0.2))
    for column, (quantity, path, unit_path, colour) in enumerate(columns):
        values, names, units = result.read(path), result.labels(path), result.read(unit_path)
        shared = None
        for joint, (name, unit) in enumerate(zip(names, units)):
            row = joint % rows
            axes = figure.add_subplot(grid[row, 3 * (joint // rows) + column], sharex=shared)
            shared = shared or axes
            axes.plot(time, values[:, joint], color=colour, marker=style.marker_for(time))
            axes.set_ylabel(f"{short(name)}\n[{style.unit_text(unit)}]")
            axes.yaxis.set_label_coords(-0.58 / panel[0], 0.5)
            axes.locator_params(axis="y", nbins=4)
            if row == 0:
                force = quantity == "torque" and any("m" not in u.split() for u in units)
                axes.set_title("torque or force" if force else quantity)
            last = row == rows - 1 or joint == len(names) - 1
            axes.tick_params(labelbottom=last)
            style.time_axis(axes, time, text=last)
    return figure


def _square_limits(points):
    """Equal lengths along all three axes, so that a circle is round; a still tip gets a window of 1 mm."""
    known = points[np.isfinite(points).all(axis=1)]
    if len(known) == 0:
        return np.array([[-1.0, 1.0]] * 3)
    low, high = known.min(axis=0), known.max(axis=0)
    half = max(0.54 * (high - low).max(), 5e-4)
    middle = (low + high) / 2
    return np.stack([middle - half, middle + half], axis=1)


def _path(axes, columns, tip, reference):
    """Draws the tip's path and the reference's in two or three coordinates."""
    axes.plot(*(reference[:, i] for i in columns), color=ORANGE, linewidth=2.6, label="reference")
    axes.plot(*(tip[:, i] for i in columns), color=BLUE, label="tip")
    if len(tip):
        axes.plot(*(tip[:1, i] for i in columns), "o", color=BLACK, markersize=4, label="start of the tip")


def tip(result):
    """The tip's path against the reference, and the tracking error."""
    time = result.read("time")
    position, reference = result.read("trajectory/tip_position"), result.read("trajectory/reference_position")
    unit, names = result.unit("trajectory/tip_position"), result.read("xyz")
    limits = _square_limits(np.concatenate([position, reference]))

    figure = style.new_figure(result, "tip path and tracking error", (11.5, 6.6))
    left, right = figure.subfigures(1, 2, width_ratios=(1.25, 1))
    grid = left.add_gridspec(2, 2)
    for place, (across, up) in zip(((0, 0), (1, 0), (1, 1)), ((1, 2), (0, 1), (0, 2))):
        axes = left.add_subplot(grid[place])
        _path(axes, (across, up), position, reference)
        axes.set(xlim=limits[across], ylim=limits[up], xlabel=label(names[across], unit), ylabel=label(names[up], unit))
        axes.set_aspect("equal")
        axes.locator_params(nbins=5)
    axes = left.add_subplot(grid[0, 1], projection="3d")
    _path(axes, (0, 1, 2), position, reference)
    axes.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
    axes.set_box_aspect((1, 1, 1), zoom=0.84)
    axes.locator_params(nbins=3)
    axes.tick_params(labelsize=7, pad=-1)
    for axis, name in zip((axes.xaxis, axes.yaxis, axes.zaxis), names):
        axis.set_label_text(label(name, unit))
        axis.labelpad = -3
    handles, texts = left.axes[0].get_legend_handles_labels()
    left.suptitle(" ", fontsize=9)  # room for the legend
    left.legend(handles, texts, loc="upper center", ncol=3)

    error, error_unit = result.read("trajectory/pose_error"), result.read("spatial_error_unit")
    controlled = np.array([name in result.task_rows for name in result.labels("trajectory/pose_error")])
    panels = right.subplots(2, 1, sharex=True)
    for axes, part, quantity in zip(panels, (slice(3, 6), slice(0, 3)), ("position error", "orientation error")):
        shown = []
        for rows, colour, text in ((controlled, BLUE, "controlled rows"), (~controlled, GREY, "other rows")):
            chosen = [i for i in range(6)[part] if rows[i]]
            if not chosen:
                continue
            size = np.linalg.norm(error[:, chosen], axis=1)
            names_here = ", ".join(result.labels("trajectory/pose_error")[i] for i in chosen)
            axes.plot(time, style.positive(size), color=colour, label=f"{text} ({names_here})", marker=style.marker_for(time))
            shown.append(size)
        axes.set_ylabel(label(quantity, error_unit[part][0]))
        style.logarithmic(axes, *shown)
        style.legend_above(axes, 2)
        style.time_axis(axes, time, text=axes is panels[-1])
    return figure


def energy(result):
    """Energies and work, the imbalance between them in joules, and the claim's residual against its bound."""
    time, steps = result.read("time"), result.read("step_time")
    parts = {name: result.read(f"energy/{name}") for name in ("kinetic", "potential", "work", "dissipated", "external_work")}
    unit = result.unit("energy/kinetic")
    figure = style.new_figure(result, "energy", (8.5, 8.2))
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(1.5, 1, 1))

    drawn = (
        ("kinetic", "kinetic", BLUE, "-"),
        ("potential", "potential, less its start", ORANGE, "-"),
        ("work", "work of the joints", GREEN, "-"),
        ("dissipated", "dissipated", VERMILION, "--"),
        ("external_work", "work of the tip force", PURPLE, ":"),
    )
    for name, text, colour, line in drawn:
        if name == "external_work" and not parts[name].any():
            continue
        values = parts[name] - parts[name][:1] if name == "potential" else parts[name]
        top.plot(time, values, line, color=colour, label=text, marker=style.marker_for(time))
    top.set_ylabel(label("energy", unit))
    style.legend_above(top, 3)

    total = parts["kinetic"] + parts["potential"]
    imbalance = np.abs(total - total[:1] - (parts["work"] - parts["dissipated"] + parts["external_work"]))
    middle.plot(time, style.positive(imbalance), color=BLUE, label="change of energy less work supplied", marker=style.marker_for(time))
    shown = [imbalance]
    estimate = result.number("global_error/energy")
    if estimate > 0:
        middle.axhline(estimate, color=VERMILION, linestyle="--", label="global error estimate of the run")
        shown.append([estimate])
    middle.set_ylabel(label("imbalance", unit))
    style.logarithmic(middle, *shown)
    style.legend_above(middle, 2)

    claim = next((r for r in result.residuals() if r.claim == "energy" and r.judged.any()), None)
    if claim is None:
        bottom.set_yticks([])
        style.note(bottom, "claim not judged: " + (result.verdicts()["energy"].reason if result.verdicts() else "no data"))
    else:
        draw_residual(bottom, steps, claim)
        style.legend_above(bottom, 4)
    bottom.set_ylabel(label("relative imbalance", "1"))
    style.time_axis(bottom, np.sort(np.concatenate([time, steps])))  # a stopped run ends between two recorded instants
    return figure


def draw_residual(axes, steps, claim):
    """A claim's residual and bound against the time of the step; failing and undecided steps are marked."""
    decided = claim.judged & ~claim.undecided
    axes.plot(steps, style.positive(claim.values), color=BLUE, label="residual", marker=style.marker_for(steps))
    axes.plot(steps, style.positive(claim.bounds), "--", color=BLACK, label="bound", marker=style.marker_for(steps))
    values, bounds = np.where(decided, claim.values, np.nan), np.where(decided, claim.bounds, np.nan)
    style.logarithmic(axes, values, bounds, times=steps, decades=20)
    if claim.failing.any():
        axes.plot(steps[claim.failing], claim.values[claim.failing], "x", color=VERMILION, markersize=4, rasterized=True, label="failing")
    if claim.undecided.any():  # their bounds may be huge: marked along the upper edge
        edge = axes.get_xaxis_transform()
        axes.plot(steps[claim.undecided], np.ones(claim.undecided.sum()), "v", color=PURPLE, markersize=5,
                  transform=edge, clip_on=False, rasterized=True, label="undecided")


def condition(result):
    """Condition of Omega, and how much of the tip force is Coriolis and centrifugal force."""
    time = result.read("time")
    number = result.read("operational_space/cond_Omega")
    figure = style.new_figure(result, "condition and Coriolis share", (8.5, 6))
    top, bottom = figure.subplots(2, 1, sharex=True)
    top.plot(time, style.positive(number), color=BLUE, marker=style.marker_for(time))
    top.set_ylabel(label("cond(Ω)", result.unit("operational_space/cond_Omega")))
    style.logarithmic(top, number)
    lost = ~np.isfinite(number)
    if lost.any():
        top.plot(time[lost], np.ones(lost.sum()), "v", color=VERMILION, transform=top.get_xaxis_transform(),
                 clip_on=False, rasterized=True, label="rank lost")
        style.legend_above(top)

    coriolis, force = result.read("operational_space/c"), result.read("operational_space/F")
    units = result.read("spatial_force_unit")
    ratios = []
    for part, text, colour, line in ((slice(0, 3), "moments", ORANGE, "-"), (slice(3, 6), "forces", SKY, "-")):
        ratio = _ratio(coriolis[:, part], force[:, part])
        if not np.isnan(ratio).all():
            bottom.plot(time, style.positive(ratio), line, color=colour, label=f"{text} ({units[part][0]} / {units[part][0]})",
                        marker=style.marker_for(time))
            ratios.append(ratio)
    bottom.set_ylabel(label("|c| / |F|", "1"))
    style.logarithmic(bottom, *ratios, times=time, decades=8, absent="no tip force was commanded" if len(time) else "no data")
    if ratios and bottom.get_legend_handles_labels()[0]:
        style.legend_above(bottom)
    style.time_axis(bottom, time)
    return figure


def _ratio(coriolis, force):
    """Norms over the components that exist; NaN where none does or the force is 0."""
    known = ~(np.isnan(coriolis) | np.isnan(force))
    above = np.sqrt(np.where(known, coriolis, 0) ** 2 @ np.ones(3))
    below = np.sqrt(np.where(known, force, 0) ** 2 @ np.ones(3))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(known.any(axis=1) & (below > 0), above / below, np.nan)
