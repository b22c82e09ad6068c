"""How all figures look: colours, labels, legends, limits."""
import matplotlib
import mpl_toolkits.mplot3d  # noqa: F401  registers the 3D projection
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter, NullLocator, StrMethodFormatter

# M. Okabe and K. Ito, "Color Universal Design", 2008: distinct for all common kinds of colour vision.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE = (
    "#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7",
)
GREY = "#808080"

SETTINGS = {
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9,
    "figure.dpi": 120,
    "font.size": 9,
    "grid.alpha": 0.35,
    "grid.linewidth": 0.5,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
    "pdf.fonttype": 42,
    "savefig.dpi": 150,
    "svg.fonttype": "none",
    "svg.hashsalt": "osculate",
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
}
matplotlib.rcParams.update(SETTINGS)


class NotApplicable(Exception):
    """There is nothing that the figure could show. The message says why, in half a sentence."""


def unit_text(unit):
    """A unit as it is printed: rad/s^2 becomes rad/s²."""
    return unit.replace("^2", "²")


def label(quantity, unit):
    return f"{quantity} [{unit_text(unit)}]"


def outcome(result):
    """What became of the run, in words."""
    verdict = {None: "no verdict", "as_expected": "verdict as expected"}.get(result.verdict, f"verdict {result.verdict}")
    if result.status == "complete":
        return verdict
    what = result.kind
    return f"{f'unfinished {what}' if result.status == 'running' else f'{what} {result.status}'}, {verdict}"


def new_figure(result, what, size):
    """An empty figure of `size` inches, titled with the experiment, its verdict and what is shown."""
    figure = Figure(figsize=size, layout="constrained")
    figure.suptitle(f"{result.title}: {what}\n{outcome(result)}", fontsize=11)
    return figure


def new_grid(result, what, shape, panel, gap, footer=0.0):
    """A figure with a grid of rows x columns = `shape` for panels of equal size, laid out by numbers: quick for many panels.

    `panel`: width, height; `gap`: space left of and below each panel for its labels; `footer`: space below all. In inches.
    Returns the figure and its GridSpec.
    """
    rows, columns = shape
    head, right, last = 0.85, 0.2, 0.25
    width = columns * (panel[0] + gap[0]) + right
    height = head + rows * (panel[1] + gap[1]) + last + footer
    figure = Figure(figsize=(width, height))
    figure.suptitle(f"{result.title}: {what}\n{outcome(result)}", fontsize=11, y=1 - 0.08 / height, va="top")
    grid = figure.add_gridspec(
        rows, columns, left=gap[0] / width, right=1 - right / width, top=1 - head / height,
        bottom=(gap[1] + last + footer) / height, wspace=gap[0] / panel[0], hspace=gap[1] / panel[1],
    )
    return figure, grid


def require(result, *names):
    """Leaves the figure out where a variable is absent that runs and sweeps have had since they measure it."""
    absent = [name for name in names if name not in result]
    if absent:
        raise NotApplicable(f"the file has no /{absent[0]}: the {result.kind} did not measure it")


def legend_above(axes, columns=4):
    """A legend over the panel, where it covers no data; none where there is nothing to name."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncol=columns, borderaxespad=0.2, handlelength=1.6, columnspacing=1.2)


def note(axes, text):
    """A remark in the middle of a panel that has nothing to draw."""
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=GREY)


def spans(times, holds, start=0.0):
    """Where a condition holds that was found at the ends of steps: pairs (from, to), neighbours joined."""
    edges = np.concatenate([[start], times])
    changes = np.flatnonzero(np.diff(np.concatenate([[False], np.asarray(holds, dtype=bool), [False]])))
    return [(edges[first], edges[last]) for first, last in zip(changes[::2], changes[1::2])]


def shade(axes, where, colour, text):
    """Shades spans along x, behind everything; `text` names them once in the legend."""
    for i, (first, last) in enumerate(where):
        axes.axvspan(first, last, color=colour, alpha=0.3, linewidth=0, zorder=0, label=text if i == 0 else None)


def marker_for(values):
    """A dot for each value where there are few."""
    return "." if len(values) < 40 else None


def positive(values):
    """What a logarithmic axis can show: zeros and negative numbers become NaN."""
    values = np.asarray(values, dtype=float)
    with np.errstate(invalid="ignore"):
        return np.where(values > 0, values, np.nan)


def logarithmic(axes, *shown, times=None, decades=None, absent="no data"):
    """Scales y for the positive, finite numbers of the arrays `shown`. If there are none the panel says so: `absent`.

    What lies low may leave the panel below: what is lower than `decades` decades, and arrays along `times` during the
    first hundredth of the run, where an integrator starts with tiny steps and errors.
    """
    arrays = [np.ravel(np.asarray(array, dtype=float)) for array in shown]
    known = np.concatenate([array[~np.isnan(array)] for array in arrays] or [np.empty(0)])
    drawable = known[np.isfinite(known) & (known > 0)]
    if drawable.size == 0:
        axes.set_yticks([])
        note(axes, "exactly 0 throughout" if known.size else absent)
        return
    high, low = drawable.max(), drawable.min()
    if times is not None and len(times):
        late = times > times[0] + 0.01 * (times[-1] - times[0])
        settled = np.concatenate([array[late] if len(array) == len(times) else array for array in arrays])
        low = np.min(settled, where=np.isfinite(settled) & (settled > 0), initial=high)
    if decades is not None:
        low = max(low, high * 10.0**-decades)
    axes.set_yscale("log")
    if high / low < 30:
        axes.set_ylim(low / 1.3, high * 1.3)
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 3, 5)))
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:.3g}"))
    else:
        axes.set_ylim(low / 2, high * 2)
        decade = np.arange(np.ceil(np.log10(low / 2)), np.floor(np.log10(high * 2)) + 1)
        axes.yaxis.set_major_locator(FixedLocator(10.0 ** decade[:: len(decade) // 7 + 1]))
        axes.yaxis.set_minor_locator(LogLocator(subs=range(2, 10)) if len(decade) < 5 else NullLocator())
    axes.yaxis.set_minor_formatter(NullFormatter())


def logarithmic_x(axes, values):
    """A logarithmic x axis whose ticks are the values themselves where they are few and far between."""
    values = np.sort(values)
    apart = np.min(values[1:] / values[:-1], initial=np.inf) > 1.3
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator(values) if len(values) <= 10 and apart else LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_locator(NullLocator())


def time_axis(axes, times, text=True):
    """The whole run along x, also where a panel shows a part of it."""
    if len(times) and times[-1] > times[0]:
        axes.set_xlim(times[0], times[-1])
    elif not len(times):
        axes.set_xticks([])
    if text:
        axes.set_xlabel("time [s]")
