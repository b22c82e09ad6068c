"""Figures of the checks and of the integration: residuals, solver, global error."""
import math
import textwrap

import numpy as np

import style
from motion import draw_residual
from style import BLACK, BLUE, GREEN, GREY, ORANGE, VERMILION, label


def residuals(result):
    """Each claim's residual against its bound, one panel for each claim that applies."""
    steps, verdicts = result.read("step_time"), result.verdicts()
    claims = result.residuals()
    shown = [claim for claim in claims if claim.judged.any()]
    absent = [claim.claim for claim in claims if not claim.judged.any()]
    columns = min(3, max(1, len(shown)))
    rows = max(1, math.ceil(len(shown) / columns))
    reasons = _why_absent(absent, verdicts)
    figure, grid = style.new_grid(result, "residual of each claim against its bound", (rows, columns),
                                  (max(3.2, 6 / columns), 1.45), gap=(0.85, 0.38), footer=0.05 + 0.17 * len(reasons))
    panels = grid.subplots(squeeze=False, sharex=True).ravel()
    handles = {}
    for axes, claim in zip(panels, shown):
        draw_residual(axes, steps, claim)
        axes.set_title(_headline(claim.claim, verdicts.get(claim.claim)), loc="left", color=_colour(verdicts.get(claim.claim)))
        handles.update({text: handle for handle, text in zip(*axes.get_legend_handles_labels())})
    for place, axes in enumerate(panels):
        if place >= len(shown):
            axes.set_axis_off()
            continue
        last = place + columns >= len(shown)
        axes.tick_params(labelbottom=last)
        style.time_axis(axes, steps, text=last)
        if place % columns == 0:
            axes.set_ylabel(label("residual", "1"))
    if not shown:
        style.note(panels[0], "no step was checked")
    if handles:
        order = [text for text in ("residual", "bound", "failing", "undecided") if text in handles]
        figure.legend([handles[text] for text in order], order, loc="upper right", ncol=2)
    figure.supxlabel("\n".join(reasons), fontsize=8, color=GREY, y=0.1 / figure.get_size_inches()[1])
    return figure


def _headline(name, verdict):
    if verdict is None:
        return name
    if verdict.result == -1:
        return f"{name}: not applicable"
    if verdict.result == 0 and verdict.undecided_steps and verdict.worst <= verdict.bound:
        return f"{name}: FAIL, {verdict.undecided_steps} steps undecided"
    return f"{name}: {verdict.word}, worst {verdict.worst:.1e} of {verdict.bound:.1e}"


def _colour(verdict):
    return VERMILION if verdict is not None and verdict.result == 0 else BLACK


def _why_absent(names, verdicts):
    """Lines that name the claims without a residual, each reason on a new one."""
    by_reason = {}
    for name in names:
        by_reason.setdefault(verdicts[name].reason if name in verdicts else "never judged", []).append(name)
    sentences = [f"not applicable: {', '.join(group)} ({reason})" for reason, group in by_reason.items()]
    return [line for sentence in sentences for line in textwrap.wrap(sentence, 85)]


def solver(result):
    """Step size, order and local error of the integrator."""
    steps = result.read("step_time")
    figure = style.new_figure(result, "integrator", (8.5, 7))
    top, middle, bottom = figure.subplots(3, 1, sharex=True)
    size, order, error = (result.read(f"solver/{name}") for name in ("step_size", "order", "local_error"))
    dot = style.marker_for(steps)
    top.plot(steps, style.positive(size), color=BLUE, marker=dot)
    top.set_ylabel(label("step size", result.unit("solver/step_size")))
    style.logarithmic(top, size, times=steps)
    middle.plot(steps, order, color=GREEN, drawstyle="steps-pre", marker=dot)
    middle.set_ylabel(label("order of the method", result.unit("solver/order")))
    middle.set_ylim(0, max(5, *order, 0) + 0.5 if len(order) else 5.5)
    middle.yaxis.get_major_locator().set_params(integer=True)
    bottom.plot(steps, style.positive(error), color=ORANGE, marker=dot, linewidth=0.7)
    bottom.set_ylabel(label("local error / tolerance", result.unit("solver/local_error")))
    style.logarithmic(bottom, error, times=steps, decades=8)
    if len(steps):
        bottom.axhline(1, color=BLACK, linestyle="--", linewidth=0.9, label="tolerance of a state")
        style.legend_above(bottom)
    style.time_axis(bottom, steps)
    return figure


def global_error(result):
    """Estimates of the true error so far, and the distance from the closed-form solution where there is one."""
    steps = result.read("step_time")
    figure = style.new_figure(result, "global error of the tip", (8.5, 6))
    panels = figure.subplots(2, 1, sharex=True)
    for axes, name in zip(panels, ("position", "orientation")):
        path = f"solver/global_error_{name}"
        values = result.read(path)
        axes.set_ylabel(label(f"{name} error", result.unit(path)))
        if len(values) and np.isnan(values).all():
            axes.set_yticks([])
            style.note(axes, "not estimated: the experiment has no shadow run")
            continue
        axes.plot(steps, style.positive(values), color=BLUE, label="estimate so far", marker=style.marker_for(steps))
        shown = [values]
        distance = result.number(f"analytic_response/{name}")
        if distance > 0:
            axes.axhline(distance, color=VERMILION, linestyle="--", label="largest distance from the closed-form solution")
            shown.append([distance])
        style.logarithmic(axes, *shown, times=steps, decades=10)
        style.legend_above(axes, 2)
    style.time_axis(panels[0], steps, text=False)
    style.time_axis(panels[1], steps)
    return figure
