"""How all figures look: colours, labels, legends, limits."""
import matplotlib
import mpl_toolkits.mplot3d  # noqa: F401  registers the 3D projection
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

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


def unit_text(unit):
    """A unit as it is printed: rad/s^2 becomes rad/s²."""
    return unit.replace("^2", "²")


def label(quantity, unit):
    return f"{quantity} [{unit_text(unit)}]"


def outcome(result):
    """What became of the run, in words."""
    verdict = {None: "no verdict", "as_expected": "verdict as expected"}.get(result.verdict, f"verdict {result.verdict}")
    return verdict if result.status == "complete" else f"run {result.status}, {verdict}"


def new_figure(result, what, size):
    """An empty figure of `size` inches, titled with the experiment, its verdict and what is shown."""
    figure = Figure(figsize=size, layout="constrained")
    figure.suptitle(f"{result.title}: {what}\n{outcome(result)}", fontsize=11)
    return figure


def legend_above(axes, columns=4):
    """A legend over the panel, where it covers no data."""
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncol=columns, borderaxespad=0.2, handlelength=1.6, columnspacing=1.2)


def note(axes, text):
    """A remark in the middle of a panel that has nothing to draw."""
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=GREY)


def marker_for(values):
    """A dot for each value where there are few."""
    return "." if len(values) < 40 else None


def positive(values):
    """What a logarithmic axis can show: zeros and negative numbers become NaN."""
    values = np.asarray(values, dtype=float)
    with np.errstate(invalid="ignore"):
        return np.where(values > 0, values, np.nan)


def logarithmic(axes, *shown, decades=None):
    """Scales y for the positive, finite numbers of the arrays `shown`; the lowest of more than `decades` decades are cut
    off. Says so in the panel if there is nothing to show."""
    values = np.concatenate([np.ravel(np.asarray(x, dtype=float)) for x in shown] or [np.empty(0)])
    known = values[~np.isnan(values)]
    values = known[np.isfinite(known) & (known > 0)]
    if values.size == 0:
        axes.set_yticks([])
        note(axes, "exactly 0 throughout" if known.size else "no data")
        return
    low, high = values.min(), values.max()
    if decades is not None:
        low = max(low, high * 10.0**-decades)
    axes.set_yscale("log")
    axes.set_ylim(low / 2, high * 3)
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_minor_formatter(NullFormatter())


def time_axis(axes, times, text=True):
    """The whole run along x, also where a panel shows a part of it."""
    if len(times) and times[-1] > times[0]:
        axes.set_xlim(times[0], times[-1])
    if text:
        axes.set_xlabel("time [s]")
