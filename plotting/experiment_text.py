"""What pictures need from the experiment that a result file holds: the text of /provenance/experiment, YAML as osculate writes it.

Only the forms that the program writes are understood: two blanks for each level, flow maps and lists on one line.
"""
import re


def experiment(result):
    """The resolved experiment as text; empty where the file has none."""
    return result.read("provenance/experiment") if "provenance/experiment" in result else ""


def model_link(text, key):
    """Name of the link that `model.base` or `model.tip` gives; None where it is absent or empty."""
    found = re.search(rf'(?m)^model:\n(?:  .*\n)*?  {key}: "?(.*?)"?$', text)
    return found.group(1) or None if found else None


def numbers(text, key):
    """The list of numbers that follows `key:` in a flow map; [] if there is none."""
    found = re.search(rf"\b{key}: \[([^\]]*)\]", text)
    return [float(word) for word in found.group(1).split(",")] if found else []


def number(text, key):
    found = re.search(rf"\b{key}: ([^,}}]+)", text)
    return float(found.group(1)) if found else float("nan")


def surface(text):
    """What the tip may touch: {"type": "plane", "point", "normal"} or {"type": "ball", "centre", "radius"}, m; None without."""
    found = re.search(r"(?m)^  environment: (\{type: (plane|ball).*\})$", text)
    if not found:
        return None
    line, kind = found.groups()
    if kind == "plane":
        return {"type": kind, "point": numbers(line, "point"), "normal": numbers(line, "normal")}
    return {"type": kind, "centre": numbers(line, "centre"), "radius": number(line, "radius")}


def obstacles(text):
    """Balls that the law keeps away from: maps with centre and radius, m."""
    found = re.search(r"(?m)^  obstacles: \[(.*)\]$", text)
    balls = re.findall(r"\{[^}]*\}", found.group(1)) if found else []
    return [{"centre": numbers(ball, "centre"), "radius": number(ball, "radius")} for ball in balls]


def base_moves(text):
    return re.search(r"(?m)^base_motion:", text) is not None


def duration(text):
    """Simulated time that the run is meant to reach, s; NaN where the text does not say."""
    found = re.search(r"(?m)^duration: (\S+)$", text)
    return float(found.group(1)) if found else float("nan")
