"""The arm of a description in numbers, every link in the frame of its joint.

Standard Denavit-Hartenberg: A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha), and q adds to theta (revolute) or to d (prismatic). The motion of
joint i is about or along z and so trades places with Rz(theta):

    A_i = Rz(theta) J(q) tail_i,    tail_i = Tz(d) Tx(a) Rx(alpha).

The joint frame comes after J(q), as in Pinocchio; tail_(i-1) Rz(theta_i) places it in the joint frame before it, tail_i leads from it to the
link frame, in which the description gives the link's mass, centre of mass and inertia. This is written apart from the generator, so that
a frame misread there shows as a wrong value here.
"""
import math
from dataclasses import dataclass

import numpy as np
import yaml

KEYS = {"name", "convention", "gravity", "parameters", "joints", "regressor"}
JOINT_KEYS = {"name", "type", "a", "alpha", "d", "theta", "link", "limits"}
ELEMENTS = ("xx", "xy", "yy", "xz", "yz", "zz")


@dataclass
class Joint:
    revolute: bool
    placement: np.ndarray        # 4 x 4: the joint frame at q = 0 in the joint frame before
    tail: np.ndarray             # 4 x 4: the link frame in the joint frame
    mass: float
    com: np.ndarray              # centre of mass in the joint frame
    inertia: np.ndarray          # 3 x 3, about the centre of mass, along the axes of the joint frame

    def body(self):
        """Mass, first moment, and inertia about the origin of the joint frame."""
        return self.mass, self.mass * self.com, self.inertia - self.mass * skew(self.com) @ skew(self.com)


@dataclass
class Arm:
    name: str
    gravity: np.ndarray
    joints: list


class Unsuitable(Exception):
    """An arm with more than links: the peers would need its motors, friction, payload or tool, too."""


def skew(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def cos_sin(angle):
    """Cosine and sine, exact for multiples of pi/6: a cosine of 6e-17 would give the peers operations that the arm does not have."""
    exact = (0.0, 0.5, 1.0, -0.5, -1.0)
    return [next((e for e in exact if abs(x - e) < 1e-15), x) for x in (math.cos(angle), math.sin(angle))]


def frame(rotation=np.eye(3), origin=(0, 0, 0)):
    t = np.eye(4)
    t[:3, :3], t[:3, 3] = rotation, origin
    return t


def rotation_z(angle):
    c, s = cos_sin(angle)
    return frame([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def rotation_x(angle):
    c, s = cos_sin(angle)
    return frame([[1, 0, 0], [0, c, -s], [0, s, c]])


class Numbers:
    """Values of the description's numbers and expressions; the project has checked what is in them."""

    def __init__(self, parameters):
        self.names = {"pi": math.pi, "deg": math.radians, "sqrt": math.sqrt}
        for name, value in parameters.items():
            self.names[name] = self(value)

    def __call__(self, value):
        return float(eval(str(value), {"__builtins__": {}}, self.names))

    def vector(self, values):
        return np.array([self(v) for v in values])

    def tensor(self, value):
        if not isinstance(value, dict):
            return self(value) * np.eye(3)
        xx, xy, yy, xz, yz, zz = (self(value.get(e, 0)) for e in ELEMENTS)
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def read_joint(row, before, number):
    extra = set(row) - JOINT_KEYS
    if extra:
        raise Unsuitable(f"joint `{row['name']}` has `{', '.join(sorted(extra))}`")
    link = row["link"]
    tail = frame(origin=(number(row["a"]), 0, number(row["d"]))) @ rotation_x(number(row["alpha"]))
    turn, origin = tail[:3, :3], tail[:3, 3]
    return Joint(
        revolute=row["type"] == "revolute",
        placement=before @ rotation_z(number(row["theta"])),
        tail=tail,
        mass=number(link["mass"]),
        com=turn @ number.vector(link.get("com", (0, 0, 0))) + origin,
        inertia=turn @ number.tensor(link.get("inertia", {})) @ turn.T,
    )


def read_arm(path):
    """The arm of the description in a file; `Unsuitable` if it is more than a chain of links."""
    description = yaml.safe_load(path.read_text())
    extra = set(description) - KEYS
    if extra or description["convention"] != "standard":
        raise Unsuitable(f"it has `{', '.join(sorted(extra))}`" if extra else "its frames are not those of standard Denavit-Hartenberg")
    number = Numbers(description.get("parameters", {}))
    joints, before = [], np.eye(4)
    for row in description["joints"]:
        joints.append(read_joint(row, before, number))
        before = joints[-1].tail
    return Arm(description["name"], number.vector(description["gravity"]), joints)


def joint_from_link(tail):
    """10 x 10: parameters m, m c, Ixx Ixy Iyy Ixz Iyz Izz (about the origin) of a body, from the link frame to the joint frame."""
    rows, columns = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
    turn, p = tail[:3, :3], skew(tail[:3, 3])
    result = np.zeros((10, 10))
    for k, unit in enumerate(np.eye(10)):
        inertia = np.zeros((3, 3))
        inertia[rows, columns] = inertia[columns, rows] = unit[4:]
        h = turn @ unit[1:4]
        moved = turn @ inertia @ turn.T - skew(h) @ p - p @ skew(h) - unit[0] * p @ p
        result[:, k] = [unit[0], *(h + unit[0] * tail[:3, 3]), *moved[rows, columns]]
    return result


def chain_text(arm):
    """The arm for pinocchio_peer.cpp: numbers in the order in which it reads them."""
    line = lambda values: " ".join(repr(float(v)) for v in np.ravel(values))
    place = lambda t: line(t[:3, :3]) + " " + line(t[:3, 3])
    text = [f"{len(arm.joints)} {line(arm.gravity)}"]
    for joint in arm.joints:
        text += ["revolute" if joint.revolute else "prismatic", place(joint.placement)]
        text += [line(joint.mass), line(joint.com), line(joint.inertia), line(joint_from_link(joint.tail))]
    return "\n".join([*text, place(arm.joints[-1].tail), ""])
