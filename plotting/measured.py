"""Figures of what a whole run measures: cross coupling, growth of the error, frequency response, poles."""
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle

import style
from style import BLACK, BLUE, GREY, ORANGE, VERMILION, NotApplicable, label

ROUNDING = 64 * np.finfo(float).eps  # m; below it the fitted error counts as constant


def _verdict(result, claim):
    """The claim's row, if it was judged."""
    row = result.verdicts().get(claim)
    return row if row is not None and row.result != -1 else None


def _why_not(result, claim, otherwise):
    row = result.verdicts().get(claim)
    return row.reason if row is not None and row.result == -1 and row.reason else otherwise


def cross_coupling(result):
    """What a motion that is commanded along one axis does along each axis, as two heat maps: turning and sliding."""
    if "measured" in result and "measured/cross_coupling" not in result:
        raise NotApplicable("no axis was commanded alone, as reference each_axis does, or the law promises no response")
    style.require(result, "measured/cross_coupling")
    worst = result.read("measured/cross_coupling")
    if np.isnan(worst).all():
        raise NotApplicable("no axis was commanded alone, as reference each_axis does")
    when = result.read("measured/cross_coupling_time") if "measured/cross_coupling_time" in result else np.full((6, 6), np.nan)
    rows, units = result.read("spatial"), result.read("spatial_error_unit")
    figure = style.new_figure(result, "motion along each axis while one is commanded", (9.5, 6.2))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, part, colours in zip(panels, (slice(0, 3), slice(3, 6)), ("cividis", "viridis")):
        _heat_map(figure, axes, worst[:, part], when[:, part], colours, units[part][0])
        axes.set_xticks(range(3), rows[part])
        for i in range(6)[part]:
            axes.add_patch(Rectangle((i - part.start - 0.47, i - 0.45), 0.94, 0.9, fill=False, edgecolor=VERMILION, linewidth=1.8))
        axes.set_title(f"{'turning' if part.start == 0 else 'sliding'}; framed: the commanded axis itself", fontsize=9)
        axes.set_xlabel(label("responding axis", units[part][0]))
    panels[0].set_yticks(range(6), rows)
    panels[0].set_ylabel(label("commanded axis", f"{units[0]}; {units[3]}"))
    return figure


def _heat_map(figure, axes, values, when, colours, unit):
    """Logarithmic colours, numbers and times in the cells; what is absent is grey."""
    drawable = values[np.isfinite(values) & (values > 0)]
    low, high = (drawable.min(), drawable.max()) if drawable.size else (1e-16, 1.0)
    norm = LogNorm(low / 1.5, high * 1.5)
    shown = np.clip(np.where(np.isnan(values), np.nan, values), norm.vmin, norm.vmax)
    image = axes.imshow(np.ma.masked_invalid(shown), norm=norm, cmap=colours, aspect="auto")
    axes.set_facecolor("#dddddd")
    axes.grid(False)
    axes.axhline(2.5, color="white", linewidth=3)  # between turning and sliding commands
    for (row, column), value in np.ndenumerate(values):
        if np.isnan(value):
            axes.text(column, row, "not alone", ha="center", va="center", color=GREY, fontsize=8)
            continue
        light = np.array(image.cmap(norm(shown[row, column]))[:3]) ** 2.2 @ np.array([0.2126, 0.7152, 0.0722])
        time = f"\n{when[row, column]:.3g} s" if np.isfinite(when[row, column]) and value > 0 else ""
        axes.text(column, row, f"{value:.1e}{time}" if value > 0 else "0", ha="center", va="center",
                  color=BLACK if light > 0.18 else "white", fontsize=8)
    bar = figure.colorbar(image, ax=axes, location="bottom", shrink=0.9, aspect=30)
    bar.set_label(label("largest distance from the closed-form solution, and when", unit))


def error_growth(result):
    """Largest difference of run and shadow in each stretch of time, with the fitted power of time."""
    if "measured/error_growth" not in result:
        raise NotApplicable("there was no shadow run beside it" if "measured" in result else "the run was not finished, or did not measure it")
    time, error = result.read(result.axes("measured/error_growth")[0]), result.read("measured/error_growth")
    if not (np.isfinite(error) & (error > 0)).any():
        raise NotApplicable("run and shadow never differed")
    figure = style.new_figure(result, "growth of the integration error", (7.5, 5.2))
    axes = figure.subplots()
    peak = np.maximum.accumulate(np.maximum(np.where(np.isnan(error), 0, error), ROUNDING))
    axes.plot(time, style.positive(error), color=BLUE, marker=".", linewidth=0.7, label="largest in each stretch of time")
    axes.plot(time, peak, color=GREY, linewidth=1, drawstyle="steps-post", label="largest so far, at least rounding")
    shown = [error, peak]
    exponent = result.number("measured/growth_exponent")
    if np.isfinite(exponent):  # over the later half of log time, as the run fits it
        later = time >= np.sqrt(time[0] * time[-1])
        level = np.mean(np.log(peak[later])) - exponent * np.mean(np.log(time[later]))
        fit = np.exp(level) * time[later] ** exponent
        axes.plot(time[later], fit, color=VERMILION, linestyle="--", linewidth=1.8, label=f"fit: time to the {exponent:.2f}")
        shown.append(fit)
    estimate = result.number("global_error/position")
    if estimate > 0:
        axes.axhline(estimate, color=ORANGE, linestyle=":", label="estimate of the run")
        shown.append([estimate])
    axes.set_xscale("log")
    axes.set_xlabel(label("time", "s"))
    axes.set_ylabel(label("difference of run and shadow, tip", result.unit("measured/error_growth") or "m"))
    style.logarithmic(axes, *shown)
    style.legend_above(axes, 2)
    return figure


def _design(frequency, gain, phase):
    """The curve K / (K - w^2 + j D w) through the designed points on a fine grid, Hz; None if they lie on none."""
    w, inverse = 2 * np.pi * frequency, np.exp(-1j * phase) / gain
    # 1 / response = 1 + a w^2 + j b w with a = -1/K, b = D/K, by least squares
    a, b = np.sum((inverse.real - 1) * w**2) / np.sum(w**4), np.sum(inverse.imag * w) / np.sum(w**2)
    if not np.allclose(1 / (1 + a * w**2 + 1j * b * w), 1 / inverse, rtol=1e-9, atol=0):
        return None
    fine = np.geomspace(frequency.min() / 1.5, frequency.max() * 1.5, 400)
    return fine, 1 / (1 + a * (2 * np.pi * fine) ** 2 + 2j * np.pi * b * fine)


def frequency_response(result):
    """Gain and phase of the tip against the reference over the design's, and the error between them with its bound."""
    if "frequency_response/gain" not in result:
        raise NotApplicable(_why_not(result, "frequency_response", "the reference is no sum of sines"))
    frequency = result.read(result.axes("frequency_response/gain")[0])
    order = np.argsort(frequency)
    frequency = frequency[order]
    gain, phase, designed_gain, designed_phase, error, bound = (
        result.read(f"frequency_response/{name}")[order] for name in ("gain", "phase", "designed_gain", "designed_phase", "error", "bound")
    )
    figure = style.new_figure(result, "frequency response, reference to tip", (7.5, 7.6))
    top, middle, bottom = figure.subplots(3, 1, sharex=True)
    curve = _design(frequency, designed_gain, designed_phase)
    shown = [gain, designed_gain]
    if curve is not None:
        fine, response = curve
        top.plot(fine, np.abs(response), color=ORANGE, label="design")
        middle.plot(fine, np.unwrap(np.angle(response)), color=ORANGE, label="design")
        shown.append(np.abs(response))
    else:
        top.plot(frequency, designed_gain, "s", color=ORANGE, markersize=8, label="design")
        middle.plot(frequency, designed_phase, "s", color=ORANGE, markersize=8, label="design")
    top.plot(frequency, gain, "o", color=BLUE, markersize=5, label="measured")
    top.set_ylabel(label("gain", "1"))
    style.logarithmic(top, *shown)
    style.legend_above(top)
    near = designed_phase + np.angle(np.exp(1j * (phase - designed_phase)))  # -pi and pi are the same phase
    middle.plot(frequency, near, "o", color=BLUE, markersize=5, label="measured")
    middle.set_ylabel(label("phase", "rad"))
    bottom.plot(frequency, style.positive(error), "o", color=BLUE, markersize=5, label="|measured - design|")
    bottom.plot(frequency, style.positive(bound), "--", color=BLACK, marker="_", markersize=10, label="bound")
    bottom.set_ylabel(label("error of the complex gain", "1"))
    style.logarithmic(bottom, error, bound)
    style.legend_above(bottom)
    for axes in (top, middle, bottom):
        style.logarithmic_x(axes, frequency)
    bottom.set_xlim(frequency[0] / 1.6, frequency[-1] * 1.6)
    bottom.set_xlabel(label("frequency", "Hz"))
    return figure


def _groups(poles, distance):
    """Poles that lie together: pairs (centre, how many)."""
    groups = []
    for pole in poles:
        near = next((group for group in groups if abs(np.mean(group) - pole) <= distance), None)
        if near is None:
            groups.append([pole])
        else:
            near.append(pole)
    return [(np.mean(group), len(group)) for group in groups]


def poles(result):
    """Poles of the linearised closed loop over those that the gains place, and their distances."""
    if "poles/found_real" not in result:
        raise NotApplicable(_why_not(result, "poles", "verify.poles is false"))
    found, designed = (result.read(f"poles/{kind}_real") + 1j * result.read(f"poles/{kind}_imag") for kind in ("found", "designed"))
    unit = result.unit("poles/found_real") or "1/s"
    figure = style.new_figure(result, "poles of the closed loop at the start", (10.5, 5))
    plane, distances = figure.subplots(1, 2, width_ratios=(1.35, 1))
    plane.plot(designed.real, designed.imag, "o", color=ORANGE, markersize=11, markerfacecolor="none", markeredgewidth=1.6, label="designed")
    plane.plot(found.real, found.imag, "x", markersize=7, markeredgewidth=1.4, color=BLUE, label="found")
    plane.axvline(0, color=BLACK, linewidth=0.8)
    both = np.concatenate([found, designed])
    size = np.abs(both).max() or 1.0
    for centre, count in (group for group in _groups(designed, 0.05 * size) if group[1] > 1):
        plane.annotate(f"×{count}", (centre.real, centre.imag), xytext=(0, 12), textcoords="offset points", ha="center", fontsize=8)
    alone = [pole for pole in found if np.abs(designed - pole).min(initial=np.inf) > 0.02 * size]
    for centre, count in _groups(alone, 0.05 * size):
        plane.annotate("not designed" + (f" ×{count}" if count > 1 else ""), (centre.real, centre.imag), xytext=(0, -16), color=BLUE,
                       textcoords="offset points", ha="center", fontsize=8, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1})
    low, high = min(both.real.min(), 0), max(both.real.max(), 0)
    margin = 0.12 * max(high - low, 1e-9)
    height = max(1.3 * np.abs(both.imag).max(), 0.35 * (high - low))
    plane.set(xlim=(low - margin, high + margin), ylim=(-height, height))
    plane.set(xlabel=label("real part", unit), ylabel=label("imaginary part", unit))
    style.legend_above(plane)

    off = np.array([np.abs(found - pole).min() / (abs(pole) or 1) for pole in designed])
    number = np.arange(1, len(designed) + 1)
    distances.plot(number, style.positive(off), "x", color=BLUE, markeredgewidth=1.4, label="to the nearest found pole")
    shown, verdict = [off], _verdict(result, "poles")
    if verdict is not None:
        distances.axhline(verdict.bound, linestyle="--", color=BLACK, label="bound of the pole that decides")
        shown.append([verdict.bound])
    distances.set(xlim=(0.5, len(designed) + 0.5), xlabel=label("designed pole, number", "1"), ylabel=label("distance / magnitude", "1"))
    distances.xaxis.get_major_locator().set_params(integer=True)
    style.logarithmic(distances, *shown)
    style.legend_above(distances, 2)
    return figure
