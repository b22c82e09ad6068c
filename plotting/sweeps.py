"""Figures of a sweep: variants beside one another, or errors against the swept number."""
import numpy as np

import style
from style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, NotApplicable, label

# Units of keys that are swept often; the experiment file is in SI units and radians throughout.
KEY_UNITS = {
    "controller.sampling.period": "s",
    "controller.sampling.computation_time": "s",
    "controller.sensors.resolution": "rad, m",
    "controller.sensors.velocity_cutoff": "Hz",
    "integrator.rtol": "1",
    "integrator.max_step": "s",
    "plant.payload.mass": "kg",
    "plant.mass_scale": "1",
    "plant.inertia_scale": "1",
    "plant.environment.stiffness": "N/m",
    "duration": "s",
    "reference.period": "s",
    "reference.radius": "m",
}
MARKS = ((BLUE, "o"), (ORANGE, "s"), (GREEN, "^"), (PURPLE, "D"))
PANELS = (
    ("position error", ("tip_error_position", "tip_error_position_rms", "closed_form_position", "global_error_position")),
    ("orientation error", ("tip_error_orientation", "tip_error_orientation_rms", "closed_form_orientation", "global_error_orientation")),
    ("missed linear acceleration", ("missed_acceleration_linear",)),
    ("missed angular acceleration", ("missed_acceleration_angular",)),
)
WORDS = {
    "tip_error": "tracking, largest", "tip_error_rms": "tracking, rms", "closed_form": "from closed form",
    "global_error": "integration, estimate", "missed_acceleration": "missed, largest",
}


def _words(quantity):
    for part in ("_position", "_orientation", "_linear", "_angular"):
        quantity = quantity.replace(part, "")
    return WORDS[quantity]


def _finished(sweep):
    if "tip_error_position" not in sweep:
        raise NotApplicable("the sweep was not finished: it has no numbers")


def comparison(sweep):
    """Tracking error of each named variant as bars, in mm and mrad."""
    _finished(sweep)
    if "value" in sweep:
        raise NotApplicable(f"the variants are values of {sweep.key}: see slopes")
    names, status, end = sweep.read("variant"), sweep.read("status"), sweep.read("end_time")
    shown = []
    for part, factor, unit in (("position", 1e3, "mm"), ("orientation", 1e3, "mrad")):
        worst, rms = (factor * sweep.read(f"tip_error_{part}{kind}") for kind in ("", "_rms"))
        if np.isfinite(worst).any():
            shown.append((part, worst, rms, unit))
    if not shown:
        raise NotApplicable("no variant has a tracking error")
    figure = style.new_figure(sweep, "tracking error of each variant", (3.0 + 4.2 * len(shown), 1.8 + 0.42 * len(names)))
    panels = figure.subplots(1, len(shown), sharey=True, squeeze=False)[0]
    places = np.arange(len(names))
    complete = np.array([word == "complete" for word in status])
    for axes, (part, worst, rms, unit) in zip(panels, shown):
        sure = complete if np.isfinite(worst[complete]).any() else ~complete  # a run that stops soon may have errors near 0
        drawable = np.concatenate([worst[sure], rms[sure], [np.nanmax(worst)]])
        drawable = drawable[np.isfinite(drawable) & (drawable > 0)]
        low, high = (drawable.min(), drawable.max()) if drawable.size else (0.1, 1.0)
        left = low / max(3, (high / low) ** 0.1)
        right = high * (high / left) ** (0.2 if complete.all() else 0.6)
        axes.set_xscale("log")
        axes.set_xlim(left, right)
        for chosen, colour, text in ((complete, BLUE, "largest"), (~complete, VERMILION, "largest, until the run stopped")):
            some = chosen & (worst > left)
            if some.any():
                axes.barh(places[some], np.maximum(worst[some], left) - left, left=left, height=0.62, color=colour, label=text)
        axes.plot(style.positive(rms), places, "|", color=BLACK, markersize=13, markeredgewidth=1.8, label="root mean square")
        for place, value in zip(places, worst):
            if np.isfinite(value):
                text = f"{value:.3g}" + ("" if complete[place] else f", {status[place]} at {end[place]:.3g} s")
            else:
                text = status[place].replace("_", " ") if not complete[place] else "not measured"
            axes.text(np.clip(value, left, right) if np.isfinite(value) else left, place, "  " + text, va="center", fontsize=8,
                      color=BLACK if np.isfinite(value) else GREY)
        axes.set_xlabel(label(f"{part} error of the tip", unit))
        axes.grid(False, axis="y")
        style.legend_above(axes, 3)
    panels[0].set_yticks(places, names)
    panels[0].set_ylim(len(names) - 0.4, -0.6)
    return figure


def _usable(sweep, value, quantity):
    """Points of a quantity that the fit could use: of complete runs, finite and above 0."""
    complete = np.array([word == "complete" for word in sweep.read("status")])
    return complete & np.isfinite(quantity) & (quantity > 0) & (value > 0)


def slopes(sweep):
    """Errors against the swept number, both logarithmic, with the fitted powers."""
    _finished(sweep)
    if "value" not in sweep:
        raise NotApplicable("the variants have names: see comparison")
    value = sweep.read("value")
    fitted = dict(zip(sweep.read("slopes/quantity"), sweep.read("slopes/slope"))) if "slopes/slope" in sweep else {}
    panels = []
    for title, quantities in PANELS:
        some = [name for name in quantities if name in sweep and np.nanmax(np.append(sweep.read(name), 0)) > 0]
        if some:
            panels.append((title, some))
    if not panels:
        raise NotApplicable("no variant has an error above 0")
    figure = style.new_figure(sweep, f"errors over {sweep.key}", (11, 4.6 * ((len(panels) + 1) // 2)))
    places = figure.subplots((len(panels) + 1) // 2, min(2, len(panels)), squeeze=False).ravel()
    key_unit = KEY_UNITS.get(sweep.key, "SI")
    for axes in places[len(panels):]:
        axes.set_axis_off()
    for axes, (title, quantities) in zip(places, panels):
        shown = []
        for name, (colour, mark) in zip(quantities, MARKS):
            quantity, slope = sweep.read(name), fitted.get(name, np.nan)
            some = _usable(sweep, value, quantity)
            text = _words(name) + (f": slope {slope:.2f}" if np.isfinite(slope) else "")
            axes.plot(value, style.positive(quantity), mark, color=colour, markersize=5, label=text)
            if np.isfinite(slope) and some.any():
                ends = np.array([value[some].min(), value[some].max()])
                level = np.mean(np.log(quantity[some])) - slope * np.mean(np.log(value[some]))
                axes.plot(ends, np.exp(level) * ends**slope, "--", color=colour, linewidth=1)
            shown.append(quantity)
        if (value > 0).all():
            style.logarithmic_x(axes, value)
        axes.set_xlabel(label(sweep.key, key_unit))
        axes.set_ylabel(label(title, sweep.unit(quantities[0])))
        style.logarithmic(axes, *shown)
        style.legend_above(axes, 2)
    return figure
