"""What the page of a report draws: frames of the arm, lines of the plots, thinned so that the page stays small.

Numbers travel in the page as base64 of float32, times of float64; `packed` says how.
"""
import base64
import math

import numpy as np

import experiment_text
import kinematics
import style
from situations import desired_force, in_contact

FRAMES = 1500  # instants of the moving arm, at most
BINS = 1000    # of a plot along time; each keeps the least and the greatest value
BUDGET = 3e6   # bytes of frames, at most: long arms get fewer instants


def packed(values, kind="f4"):
    """An array as the page reads it."""
    data = np.ascontiguousarray(values, dtype="<" + kind)
    return {"type": kind, "data": base64.b64encode(data.tobytes()).decode()}


def thinned(times, columns):
    """At most 2 BINS rows of `columns` (rows, lines) along `times`: of each bin the least and the greatest value, in their order.

    The bins hold equal numbers of rows; their two rows stand at the bin's first and last time.
    """
    rows = len(times)
    if rows <= 2 * BINS:
        return np.asarray(times, dtype=float), np.asarray(columns, dtype=float)
    edges = np.linspace(0, rows, BINS + 1).astype(int)
    kept_times, kept = np.empty(2 * BINS), np.empty((2 * BINS, columns.shape[1]))
    for i, (first, last) in enumerate(zip(edges[:-1], edges[1:])):
        part = columns[first:last]
        least = np.argmin(np.where(np.isnan(part), np.inf, part), axis=0)
        greatest = np.argmax(np.where(np.isnan(part), -np.inf, part), axis=0)
        across = np.arange(part.shape[1])
        kept[2 * i] = part[np.minimum(least, greatest), across]
        kept[2 * i + 1] = part[np.maximum(least, greatest), across]
        kept_times[2 * i : 2 * i + 2] = times[first], times[last - 1]
    return kept_times, kept


class Plots:
    """The plots of a page, in the order in which they are added."""

    def __init__(self, result):
        self.result, self.axes, self.plots, self.thinned = result, {}, [], False
        for name, axis in (("time", "time"), ("step", "step_time")):
            self.axes[name] = result.read(axis)

    def add(self, axis, title, unit, lines, logarithmic=False, group=None, choice=None):
        """A plot of `lines`: pairs (name, values along the axis). Plots of one `group` share a place; `choice` names each."""
        times = self.axes[axis]
        lines = [(name, np.asarray(values, dtype=float)) for name, values in lines if not np.isnan(values).all()]
        if not lines or len(times) == 0:
            return
        columns = np.stack([values for _, values in lines], axis=1)
        if logarithmic:
            columns = style.positive(columns)
            if np.isnan(columns).all():
                return
        with np.errstate(over="ignore"):
            columns = np.where(np.isfinite(columns) & (np.abs(columns) < 3e38), columns, np.nan)
        shown, values = thinned(times, columns)
        self.thinned = self.thinned or len(shown) < len(times)
        self.plots.append({
            "title": title, "unit": style.unit_text(unit), "log": logarithmic, "group": group, "choice": choice,
            "names": [name for name, _ in lines], "x": packed(shown, "f8"), "y": packed(values.T),
        })


def _norm_lines(result, part):
    """Norms of the pose error over the controlled and the other rows."""
    error, names = result.read("trajectory/pose_error"), result.labels("trajectory/pose_error")
    controlled = [i for i in range(6)[part] if names[i] in result.task_rows]
    others = [i for i in range(6)[part] if i not in controlled]
    for rows, text in ((controlled, "controlled rows"), (others, "other rows")):
        if rows:
            yield f"{text} ({', '.join(names[i] for i in rows)})", np.linalg.norm(error[:, rows], axis=1)


def plots(result):
    """All plots that the file has numbers for."""
    out = Plots(result)
    if "trajectory/pose_error" in result:
        units = result.read("spatial_error_unit")
        out.add("time", "position error of the tip", units[3], _norm_lines(result, slice(3, 6)), logarithmic=True)
        out.add("time", "orientation error of the tip", units[0], _norm_lines(result, slice(0, 3)), logarithmic=True)
    verdicts = result.verdicts()
    for claim in result.residuals():
        if claim.judged.any():
            row = verdicts.get(claim.claim)
            out.add("step", f"claim {claim.claim}", "1", [("residual", claim.values), ("bound", claim.bounds)], logarithmic=True,
                    group="claim", choice=f"{claim.claim}: {row.word if row else 'no verdict'}")
    _contact(out, result)
    for variable, unit_path, what in (("joint_position", "position_unit", "joint position"),
                                      ("joint_velocity", "velocity_unit", "joint velocity"),
                                      ("joint_torque", "effort_unit", "joint torque or force")):
        path = f"trajectory/{variable}"
        values, names, units = result.read(path), result.labels(path), result.read(unit_path)
        for unit in dict.fromkeys(units):
            chosen = [i for i, other in enumerate(units) if other == unit]
            title = what if variable != "joint_torque" else {"N": "joint force", "N m": "joint torque"}.get(unit, what)
            out.add("time", title, unit, [(names[i], values[:, i]) for i in chosen])
    _energy(out, result)
    for name, what in (("effective_mass", "effective mass"), ("effective_inertia", "effective inertia")):
        path = f"operational_space/{name}"
        if path in result:
            out.add("time", what, result.unit(path), zip(result.read("principal"), result.read(path).T), logarithmic=True)
    if "operational_space/cond_Omega" in result:
        out.add("time", "condition number of Ω", "1", [("cond(Ω)", result.read("operational_space/cond_Omega"))], logarithmic=True)
    for part in ("linear", "angular"):
        path = f"departure/{part}_acceleration"
        if path in result:
            out.add("step", f"missed {part} acceleration", result.unit(path), [("|tip acceleration - u|", result.read(path))],
                    logarithmic=True)
    out.add("step", "step size of the integrator", "s", [("step size", result.read("solver/step_size"))], logarithmic=True)
    return out


def _contact(out, result):
    if "contact/gap" in result:
        out.add("time", "gap to the surface", result.unit("contact/gap"), [("gap", result.read("contact/gap"))])
        out.add("time", "normal force of the surface", result.unit("contact/pressure"), [("normal force", result.read("contact/pressure"))])
    if "trajectory/tip_force" in result and result.read("trajectory/tip_force").any():
        wrench, units = result.read("trajectory/tip_force"), result.read("spatial_force_unit")
        desired, names = desired_force(result), result.labels("trajectory/tip_force")
        for part, what in ((slice(3, 6), "force on the tip"), (slice(0, 3), "moment on the tip")):
            if wrench[:, part].any():
                lines = [(axis, wrench[:, i]) for axis, i in zip("xyz", range(6)[part])]
                lines += [(f"desired {axis}", np.full(len(wrench), desired[names[i]]))
                          for axis, i in zip("xyz", range(6)[part]) if names[i] in desired]
                out.add("time", what, units[part][0], lines)


def _energy(out, result):
    if "energy/kinetic" not in result:
        return
    potential = result.read("energy/potential")
    lines = [("kinetic", result.read("energy/kinetic")), ("potential, less its start", potential - potential[:1]),
             ("work of the joints", result.read("energy/work")), ("dissipated", result.read("energy/dissipated"))]
    if result.read("energy/external_work").any():
        lines.append(("work of the tip force", result.read("energy/external_work")))
    if "energy/self_motion" in result and len(result.read("velocity_coordinate")) > len(result.task_rows) > 0:
        lines.append(("self-motion", result.read("energy/self_motion")))
    out.add("time", "energy", result.unit("energy/kinetic"), lines)


def _chosen(count, links):
    """Indices of the instants at which the arm is drawn: first, last and evenly between."""
    most = max(2, min(FRAMES, int(BUDGET / (28 * links))))
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)) if count else np.empty(0, int)


def motion(result):
    """The moving arm as the page draws it, and how far its tip is from the recorded one, m (None where it was placed by it).

    Raises kinematics.NoArm. Frames are in the base frame; with a moving base in that of the base at t = 0.
    """
    text = experiment_text.experiment(result)
    arm = kinematics.read_arm(result.read("provenance/model"), *(experiment_text.model_link(text, key) for key in ("base", "tip")))
    time, q, tip = (result.read(name) for name in ("time", "trajectory/joint_position", "trajectory/tip_position"))
    if len(time) == 0:
        raise kinematics.NoArm("no instant was recorded")
    if arm.coordinates != q.shape[1]:
        raise kinematics.NoArm(f"the model has {arm.coordinates} position coordinates, the file {q.shape[1]}")
    chosen = _chosen(len(time), len(arm.links))
    moves = experiment_text.base_moves(text)
    orientation = result.read("trajectory/tip_orientation")[chosen]
    positions, rotations = kinematics.placed(arm, q[chosen], *((tip[chosen], orientation) if moves else ()))
    distance = None if moves else float(np.abs(positions[:, -1] - tip[chosen]).max())
    rods = [float(np.linalg.norm(link.position)) for link in arm.links[1:]]
    reference = result.read("trajectory/reference_position")[chosen]
    points = np.concatenate([positions.reshape(-1, 3), reference[np.isfinite(reference).all(axis=1)]])
    data = {
        "time": packed(time[chosen], "f8"),
        "links": [_link(link, q[chosen], at) for link, at in zip(arm.links, _starts(arm))],
        "positions": packed(positions), "rotations": packed(kinematics.to_quaternions(rotations)),
        "tip": packed(tip[chosen]), "reference": packed(reference),
        "low": points.min(axis=0).tolist(), "high": points.max(axis=0).tolist(),
        "length": max(sum(rods), 1e-3), "rod": float(np.mean([rod for rod in rods if rod > 1e-9] or [0.1])),
        "surface": experiment_text.surface(text), "obstacles": experiment_text.obstacles(text), "baseMoves": moves,
        "meshes": arm.meshes, "recorded": len(time),
    }
    wrench = result.read("trajectory/tip_force")[chosen] if "trajectory/tip_force" in result else np.zeros((len(chosen), 6))
    if wrench[:, 3:].any():
        data["force"] = packed(wrench[:, 3:])
    for name in ("effective_mass", "effective_inertia"):
        path = f"operational_space/{name}"
        if path not in result:
            continue
        values = result.read(path)[chosen]
        finite = np.isfinite(values) & (values > 0)
        if (finite.sum(axis=1) >= 2).any():
            data[name] = {"values": packed(np.where(finite, values, np.nan)), "axes": packed(result.read(path + "_axes")[chosen]),
                          "typical": float(np.median(np.max(values, axis=1, where=finite, initial=0)[finite.any(axis=1)])), "unit": style.unit_text(result.unit(path))}
    return data, distance


def _starts(arm):
    """Index of the first coordinate of each link's joint."""
    return np.cumsum([0] + [kinematics.COORDINATES[link.type] for link in arm.links[:-1]])


def _link(link, q, at):
    data = {"name": link.name, "joint": link.joint, "type": link.type, "position": link.position.tolist(), "axis": link.axis.tolist(),
            "visuals": [{"shape": visual.shape, "size": visual.size, "position": visual.position.tolist(),
                         "rotation": kinematics.to_quaternions(visual.rotation).tolist()} for visual in link.visuals]}
    if link.type == "prismatic":
        data["slide"] = packed(q[:, at])
    return data


def page_data(result):
    """All that the page's program reads, a list of sentences about what was left out, and the tip's distance as in motion()."""
    remarks, drawn, distance = [], None, None
    lines = plots(result)
    time, steps = result.read("time"), result.read("step_time")
    try:
        drawn, distance = motion(result)
        shown = len(np.frombuffer(base64.b64decode(drawn["time"]["data"])))
        if shown < len(time):
            remarks.append(f"The moving arm is drawn at {shown} of {len(time)} recorded instants and moves evenly between them.")
        if drawn["baseMoves"]:
            remarks.append("The base moves as the experiment says. The arm is placed by the recorded pose of its tip.")
        if drawn["meshes"]:
            remarks.append(f"{drawn['meshes']} visuals of the model are meshes, which the result file does not hold; rods stand for them.")
    except kinematics.NoArm as reason:
        remarks.append(f"The arm is not drawn: {reason}.")
    if lines.thinned:
        remarks.append(f"Plots of more than {2 * BINS} values keep the least and the greatest of each of {BINS} stretches. "
                       f"The file has {len(time)} instants and {len(steps)} steps.")
    ends = np.concatenate([time[:1], time[-1:], steps[-1:]])
    low, high = (float(ends.min()), float(ends.max())) if len(ends) else (0.0, 0.0)
    data = {"motion": drawn, "plots": lines.plots, "start": low, "end": high, "touching": [list(span) for span in in_contact(result)]}
    if not math.isfinite(high):
        data["start"] = data["end"] = 0.0
    return data, remarks, distance
