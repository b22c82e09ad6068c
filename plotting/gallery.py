#!/usr/bin/env python3
"""Makes the picture of each experiment: gallery.py [NAME...] [-o DIR]. Runs the program that the variable OSCULATE names.

Each experiment, or each NAME, is run in full into a temporary directory; one panel of one figure becomes DIR/NAME.png,
docs/pictures without -o. experiments/README.md shows them. Exit codes: 0 made, 1 an experiment did not come out as expected
(its picture is made all the same if there is a file), 2 bad input, 4 a picture cannot be written.
"""
import argparse
import io
import os
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path
from typing import NamedTuple

from PIL import Image

import style
from figures import FIGURES, SWEEP_FIGURES, NotApplicable
from result import NotAResult, open_result

ROOT = Path(__file__).resolve().parent.parent
WIDTH, DPI = 480, 120  # pixels; pixels per inch, at which labels of 9 points stay readable
COLOURS = 32           # of the picture; lines and text need few


class Picture(NamedTuple):
    """What to draw: the figure, how its panel begins (`names_of`), pixels of height at most, settings for the run."""

    figure: str
    panel: str
    height: int = 300
    settings: tuple = ()


PATH, SPACE, TALL = 380, 400, 420  # pixels of height: a path in a plane, a path in space, a table
LINEAR, ANGULAR = Picture("departure", "missed linear"), Picture("departure", "missed angular")
SLOPE = Picture("slopes", "missed linear")
PICTURES = {
    "arm7_joint_limits": Picture("joints", "joint3 [rad]"),
    "arm7_lissajous": Picture("tip", "space", SPACE),
    "arm7_manipulability": Picture("manipulability", "smallest scaled"),
    "arm7_missing_terms": Picture("comparison", "position error", TALL),
    "arm7_moving_base": Picture("self_motion", "joint velocity"),
    "arm7_posture": Picture("self_motion", "joint velocity"),
    "arm7_quaternion_cylindrical": Picture("residuals", "coordinates"),
    "arm7_self_motion": Picture("self_motion", "joint velocity"),
    "arm7_zyz_spherical": Picture("tip", "orientation error"),
    "chain60_reach": Picture("self_motion", "energy"),
    "mobile_arm_lissajous": Picture("tip", "y over x", PATH),
    "planar_2r_line": Picture("manipulability", "z over x", PATH),
    "prismatic_arm_waypoints": Picture("tip", "space", SPACE),
    "puma560_ball": Picture("contact", "force on the tip"),
    "puma560_beyond_limits": Picture("joints", "joint5 [rad]"),
    "puma560_circle": Picture("tip", "z over y", PATH),
    "puma560_dense_plant": Picture("residuals", "linearization"),
    "puma560_each_axis": Picture("cross_coupling", "sliding", TALL),
    "puma560_elbow_damped": LINEAR,
    "puma560_encoders": LINEAR,
    "puma560_force": Picture("contact", "normal force"),
    "puma560_free_swing": Picture("energy", "energy"),
    "puma560_frequency": Picture("frequency_response", "gain"),
    "puma560_gimbal_lock": Picture("joints", "joint5 [rad]"),
    "puma560_hybrid": LINEAR,
    "puma560_impedance": Picture("tip", "position error"),
    "puma560_late_torque": LINEAR,
    "puma560_long_horizon": Picture("error_growth", "difference", settings=("duration=200",)),  # s; not 10000
    "puma560_mismatch": SLOPE,
    "puma560_missing_terms": Picture("comparison", "position error", TALL),
    "puma560_obstacle": Picture("tip", "z over y", PATH),
    "puma560_old_force": LINEAR,
    "puma560_old_velocities": LINEAR,
    "puma560_payload": Picture("tip", "position error"),
    "puma560_resolved_acceleration": Picture("tip", "space", SPACE),
    "puma560_roll_pitch_yaw": Picture("residuals", "coordinates"),
    "puma560_sampled": LINEAR,
    "puma560_shoulder_released": LINEAR,
    "puma560_singular": Picture("manipulability", "effective mass"),
    "puma560_slopes_both": SLOPE,
    "puma560_slopes_both_extrapolated": SLOPE,
    "puma560_slopes_force": SLOPE,
    "puma560_slopes_force_extrapolated": SLOPE,
    "puma560_slopes_velocity": SLOPE,
    "puma560_slopes_velocity_extrapolated": SLOPE,
    "puma560_tip_force": Picture("tip", "position error"),
    "puma560_torque_limits": Picture("joints", "joint2 [N m]"),
    "puma560_touch": Picture("contact", "normal force"),
    "puma560_two_sweeps": LINEAR,
    "puma560_wrist_damped": ANGULAR,
    "puma560_wrist_near": Picture("comparison", "orientation error"),
    "puma560_wrist_none": Picture("condition", "cond"),
    "puma560_wrist_released": ANGULAR,
    "puma560_wrist_rest": ANGULAR,
    "puma560_wrist_truncated": ANGULAR,
    "puma560_your_controller": Picture("residuals", "linearization"),
    "satellite_arm_reach": Picture("self_motion", "share"),
    "satellite_arm_tumble": Picture("tip", "space", SPACE),
    "ur5e_circle": Picture("tip", "position error"),
    "ur5e_circle_1e9": Picture("tip", "z over y", PATH),
    "ur5e_circle_long": Picture("error_growth", "difference"),
}


class NoPicture(Exception):
    """There is nothing to draw; the message says why."""


def names_of(axes):
    """What a panel can be called by: its labels, its title, "y over x" for a path, "space" for one in three dimensions."""
    if axes.name == "3d":
        return ("space",)
    x, y = (" ".join(text.split()) for text in (axes.get_xlabel(), axes.get_ylabel()))
    title = axes.get_title() or axes.get_title(loc="left")
    return (y, x, title, f"{y.split(' [')[0]} over {x.split(' [')[0]}")


def alone(figure, panel):
    """Hides all but the panel whose name begins with `panel`, and its colour bar. Labels that neighbours had come to it."""
    chosen = next((axes for axes in figure.axes if any(name.startswith(panel) for name in names_of(axes))), None)
    if chosen is None:
        raise NoPicture(f"no panel begins with {panel!r}")
    if chosen.name != "3d":
        for axis, one_of in (("x", chosen.get_shared_x_axes()), ("y", chosen.get_shared_y_axes())):
            texts = [getattr(axes, f"get_{axis}label")() for axes in one_of.get_siblings(chosen)]
            if not getattr(chosen, f"get_{axis}label")():
                getattr(chosen, f"set_{axis}label")(next(filter(None, texts), ""))
        _wrap(chosen.yaxis.label, 24)
        chosen.tick_params(labelbottom=True, labelleft=True)
    kept = [chosen, *(image.colorbar.ax for image in chosen.images if image.colorbar)]
    for bar in kept[1:]:
        _wrap(bar.xaxis.label, 40)
    for axes in figure.axes:
        axes.set_visible(axes in kept)
        axes.set_in_layout(axes in kept)
    for part in (figure, *figure.subfigs):
        part.suptitle("")
        part.supxlabel("")
        for legend in part.legends:
            legend.set_visible(False)
    return kept


def _wrap(label, width):
    label.set_text("\n".join(textwrap.wrap(label.get_text(), width)))


def _legend(axes):
    """A legend over the panel with as many columns as the picture is wide enough for; a title goes above it."""
    for columns in (4, 3, 2, 1):
        style.legend_above(axes, columns)
        legend = axes.get_legend()
        if legend is None or legend.get_window_extent().width < 0.85 * WIDTH:
            break
    if legend is not None and axes.get_title(loc="left"):
        axes.set_title(axes.get_title(loc="left"), loc="left", pad=18)


def fit(figure, kept, height):
    """Sizes the figure so that its panel takes the width of the picture and at most `height` pixels. Returns its box, inches."""
    width, height, margin = WIDTH / DPI, height / DPI, 0.04
    for _ in range(5):  # room for labels stays as it is, so the size is found step by step
        box = _box(figure, kept)
        across, up = (width - 2 * margin) / box.width, (height - 2 * margin) / box.height
        if kept[0].get_aspect() != "auto" or kept[0].name == "3d":
            across = up = min(across, up)
        figure.set_size_inches(figure.get_size_inches() * (across, up))
    return _box(figure, kept)


def _box(figure, kept):
    figure.draw_without_rendering()
    boxes = [axes.get_tightbbox(figure._get_renderer()) for axes in kept]
    return type(boxes[0]).union(boxes).transformed(figure.dpi_scale_trans.inverted())


def draw(result, picture, path):
    """Writes the picture of an open result. Raises NotApplicable, NoPicture, OSError."""
    known = SWEEP_FIGURES if result.kind == "sweep" else FIGURES
    figure = known[picture.figure](result)
    figure.set_dpi(DPI)
    kept = alone(figure, picture.panel)
    _legend(kept[0])
    box = fit(figure, kept, picture.height)
    if figure.get_layout_engine() is not None:
        figure.set_layout_engine("none")  # nothing moves after it was measured
    height = round(box.height * DPI) + 10
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=DPI, format="png", bbox_inches=box, pad_inches=0)
    drawn = Image.open(buffer).convert("RGB")
    image = Image.new("RGB", (WIDTH, height), "white")
    image.paste(drawn, ((WIDTH - drawn.width) // 2, (height - drawn.height) // 2))
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


def run(name, picture, output):
    """Runs the experiment into `output`. Returns the program's exit code and what it said last."""
    source = ROOT / "experiments" / f"{name}.yaml"
    verb = "sweep" if picture.figure in SWEEP_FIGURES else "run"
    settings = [word for setting in picture.settings for word in ("--set", setting)]
    command = [os.environ["OSCULATE"], verb, str(source), "-o", str(output), "--quiet", *settings]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, (done.stderr or done.stdout).strip().split("\n")[-1]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="gallery.py", description="Make the picture of each experiment.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="make only the pictures of these experiments")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, default=ROOT / "docs" / "pictures")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.names if name not in PICTURES]
    if unknown:
        parser.error(f"no picture is planned for {', '.join(unknown)}")
    if "OSCULATE" not in os.environ:
        parser.error("set OSCULATE to the program, for instance build/release/osculate")
    code = 0
    for name in options.names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            file, path = Path(folder) / f"{name}.h5", options.output / f"{name}.png"
            failed, said = run(name, PICTURES[name], file)
            if failed:
                print(f"gallery.py: {name}: exit code {failed}: {said}", file=sys.stderr)
                code = code or 1
            try:
                options.output.mkdir(parents=True, exist_ok=True)
                with open_result(file) as result:
                    draw(result, PICTURES[name], path)
                print(path)
            except (NotAResult, NotApplicable, NoPicture) as error:
                print(f"gallery.py: {name}: no picture: {error}", file=sys.stderr)
                code = 2
            except OSError as error:
                print(f"gallery.py: {path}: cannot write the picture ({error.strerror or error}). Choose another place with -o.", file=sys.stderr)
                return 4
    return code


if __name__ == "__main__":
    sys.exit(main())
