"""Where the links of an arm are, from the URDF text and the joint coordinates that a result file holds.

Positions in m, rotations as 3 x 3 matrices whose columns are a link's axes. docs/joints.md says what the coordinates mean.
"""
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field

import numpy as np

COORDINATES = {"revolute": 1, "continuous": 1, "prismatic": 1, "fixed": 0, "planar": 3, "floating": 7}


class NoArm(Exception):
    """The text holds no arm between these links. The message says what is missing."""


@dataclass(frozen=True)
class Visual:
    """A box, cylinder or sphere fixed in a link. `size` in m: box x, y, z; cylinder radius, length; sphere radius."""

    shape: str
    size: tuple
    position: np.ndarray
    rotation: np.ndarray


@dataclass(frozen=True)
class Link:
    """A link of the chain and the joint that carries it; the base has neither joint nor origin.

    `position`, `rotation`: the joint's frame in the link before. `axis`: unit vector in the joint's frame.
    """

    name: str
    joint: str = ""
    type: str = "fixed"
    position: np.ndarray = field(default_factory=lambda: np.zeros(3))
    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))
    axis: np.ndarray = field(default_factory=lambda: np.array([1.0, 0, 0]))
    visuals: tuple = ()


@dataclass(frozen=True)
class Arm:
    """The links from base to tip, fixed joints included. `meshes`: how many visuals are meshes, which are not in the file."""

    links: tuple
    meshes: int

    @property
    def coordinates(self):
        return sum(COORDINATES[link.type] for link in self.links)

    def frames(self, q):
        """Frames of all links in the base frame for coordinates q, (times, coordinates), base to tip.

        Returns positions (times, links, 3) and rotations (times, links, 3, 3).
        """
        q = np.asarray(q, dtype=float)
        times = len(q)
        positions, rotations = np.zeros((times, len(self.links), 3)), np.zeros((times, len(self.links), 3, 3))
        R, p, at = np.broadcast_to(np.eye(3), (times, 3, 3)), np.zeros((times, 3)), 0
        for i, link in enumerate(self.links):
            count = COORDINATES[link.type]
            turn, slide = _motion(link, q[:, at : at + count])
            p = p + R @ link.position
            R = R @ link.rotation
            p = p + np.einsum("tij,tj->ti", R, slide)
            R = R @ turn
            positions[:, i], rotations[:, i] = p, R
            at += count
        return positions, rotations


def read_arm(urdf, base=None, tip=None):
    """The arm between two links of a URDF text; without names the root link and the only leaf. Raises NoArm."""
    try:
        robot = ElementTree.fromstring(urdf.encode())
    except ElementTree.ParseError as error:
        raise NoArm(f"the model is not XML ({error})") from None
    links = {link.get("name"): link for link in robot.findall("link")}
    above = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    parents = {joint.find("parent").get("link") for joint in above.values()}
    base = base or next((name for name in links if name not in above), None)
    leaves = [name for name in links if name not in parents]
    tip = tip or (leaves[0] if len(leaves) == 1 else None)
    if base not in links or tip not in links:
        raise NoArm(f"the model has no link {base if base not in links else tip!r}")
    path, at = [], tip
    while at != base:
        if at not in above or len(path) > len(links):
            raise NoArm(f"link {tip!r} does not hang on link {base!r}")
        path.append(above[at])
        at = above[at].find("parent").get("link")
    meshes = 0
    chain = []
    for joint in [None, *reversed(path)]:
        name = base if joint is None else joint.find("child").get("link")
        visuals, left_out = _visuals(links[name])
        meshes += left_out
        chain.append(Link(name, visuals=visuals) if joint is None else _link(joint, name, visuals))
    return Arm(tuple(chain), meshes)


def _link(joint, name, visuals):
    kind = joint.get("type")
    if kind not in COORDINATES:
        raise NoArm(f"joint {joint.get('name')!r} is of the unknown type {kind!r}")
    axis = _vector(joint.find("axis"), "xyz", (1, 0, 0))
    length = np.linalg.norm(axis)
    position, rotation = _origin(joint)
    return Link(name, joint.get("name"), kind, position, rotation, axis / length if length > 0 else axis, visuals)


def _vector(element, key, otherwise):
    text = element.get(key) if element is not None else None
    return np.array([float(word) for word in text.split()] if text else otherwise, dtype=float)


def _origin(element):
    """Position and rotation of <origin>: roll, pitch and yaw about the fixed axes x, y, z."""
    origin = element.find("origin")
    roll, pitch, yaw = _vector(origin, "rpy", (0, 0, 0))
    axes = np.eye(3)
    turns = [_turn(axis, np.array([angle]))[0] for axis, angle in zip(axes, (roll, pitch, yaw))]
    return _vector(origin, "xyz", (0, 0, 0)), turns[2] @ turns[1] @ turns[0]


def _visuals(link):
    """Shapes that can be drawn from the text alone, and how many meshes cannot."""
    shapes, meshes = [], 0
    for visual in link.findall("visual"):
        geometry = visual.find("geometry")
        shape = geometry[0] if geometry is not None and len(geometry) else None
        if shape is None or shape.tag not in ("box", "cylinder", "sphere"):
            meshes += shape is not None and shape.tag == "mesh"
            continue
        keys = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}[shape.tag]
        size = tuple(float(word) for key in keys for word in shape.get(key, "0").split())
        shapes.append(Visual(shape.tag, size, *_origin(visual)))
    return tuple(shapes), meshes


def _turn(axis, angles):
    """Rotations about a unit axis: (times, 3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return cosine * np.eye(3) + sine * cross + (1 - cosine) * np.outer(axis, axis)


def _motion(link, q):
    """Turn (times, 3, 3) and slide (times, 3) of a joint in its own frame."""
    none = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
    if link.type in ("revolute", "continuous"):
        return _turn(link.axis, q[:, 0]), none[1]
    if link.type == "prismatic":
        return none[0], q * link.axis
    if link.type == "planar":
        first = np.array([1.0, 0, 0]) if abs(link.axis[0]) < 0.9 else np.array([0, 1.0, 0])
        first = first - link.axis * (link.axis @ first)
        first = first / np.linalg.norm(first)
        return _turn(link.axis, q[:, 2]), q[:, :1] * first + q[:, 1:2] * np.cross(link.axis, first)
    if link.type == "floating":
        return from_quaternions(q[:, :4]), q[:, 4:]
    return none


def from_quaternions(e):
    """Rotations of quaternions w x y z of any length but 0: (times, 3, 3)."""
    w, x, y, z = np.asarray(e).T / np.linalg.norm(e, axis=1)
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1),
        np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1),
        np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1),
    ], axis=1)


def to_quaternions(R):
    """Unit quaternions w x y z of rotations (..., 3, 3), by the largest of the four numbers."""
    R = np.asarray(R)
    flat = R.reshape(-1, 3, 3)
    xx, yy, zz = flat[:, 0, 0], flat[:, 1, 1], flat[:, 2, 2]
    a, b, c = flat[:, 2, 1], flat[:, 0, 2], flat[:, 1, 0]
    d, e, f = flat[:, 1, 2], flat[:, 2, 0], flat[:, 0, 1]
    candidates = np.stack([  # row k is 4 times the quaternion times its own number k
        np.stack([1 + xx + yy + zz, a - d, b - e, c - f], axis=1),
        np.stack([a - d, 1 + xx - yy - zz, c + f, b + e], axis=1),
        np.stack([b - e, c + f, 1 - xx + yy - zz, a + d], axis=1),
        np.stack([c - f, b + e, a + d, 1 - xx - yy + zz], axis=1),
    ], axis=1)
    best = np.argmax(np.einsum("tkk->tk", candidates), axis=1)
    chosen = candidates[np.arange(len(flat)), best]
    return (chosen / np.linalg.norm(chosen, axis=1, keepdims=True)).reshape(*R.shape[:-2], 4)


def placed(arm, q, tip_position=None, tip_orientation=None):
    """Frames as arm.frames gives them, the whole arm moved so that its tip has the given positions and quaternions w x y z.

    For arms on a moving base, whose pose a result file does not hold.
    """
    positions, rotations = arm.frames(q)
    if tip_position is None:
        return positions, rotations
    turn = from_quaternions(tip_orientation) @ np.swapaxes(rotations[:, -1], 1, 2)
    base = np.asarray(tip_position) - np.einsum("tij,tj->ti", turn, positions[:, -1])
    return base[:, None] + np.einsum("tij,tkj->tki", turn, positions), turn[:, None] @ rotations
