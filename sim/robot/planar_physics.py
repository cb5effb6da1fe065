"""The robot's physics without PyBullet: a rigid body on two driven wheels, in the plane.

Masses and sizes are those of ``burger.urdf``. Motors, the wheels' grip and obstacles are constraints with
limits on their impulses, solved together in each step. As in PyBullet, obstacles have no friction. A robot
that pushes against one keeps its heading, within half a degree; PyBullet's turns slowly, by 40° in half a
minute head-on at a wall, and drives along a wall that it met at an angle.
"""

import math
from collections.abc import Iterator
from importlib.resources import files
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from .arena import ROBOT_RADIUS, START, Arena, Pose
from .drive import STEP_RATE, WHEEL_RADIUS, WHEEL_SEPARATION, Velocity, WheelPair

_STEP = 1 / STEP_RATE
_GRAVITY = 9.81
_HALF = WHEEL_SEPARATION / 2
_NEAR = 0.002
"""Metres from an obstacle at which it is a constraint; no step is as long."""
_TOUCH = 1e-4
"""Metres from an obstacle at which the robot touches it."""
_RECOVERY = 0.2
"""The share of a penetration that one step removes."""
_SOFTNESS = 1e-9
"""Compliance of every constraint, which keeps their matrix regular."""
_ATTEMPTS = 100

_Array = NDArray[np.float64]

# Over forward, sideways and turning speed (m/s, rad/s) and the wheels' speeds (rad/s): the wheels' motors,
# their contacts with the floor along their way, and across it, which is one on a common axle.
_WHEEL_ROWS = np.array(
    [
        [0, 0, 0, 1, 0],
        [0, 0, 0, 0, 1],
        [1, 0, -_HALF, -WHEEL_RADIUS, 0],
        [1, 0, _HALF, 0, -WHEEL_RADIUS],
        [0, 1, 0, 0, 0],
    ]
)


class PlanarPhysics:
    """`Physics` in numpy."""

    def __init__(self, arena: Arena) -> None:
        self._arena = arena
        mass, lever, inertia, wheel, caster = _described()
        self._lever = lever
        self._mobility = np.linalg.inv(
            np.array(
                [
                    [mass, 0, 0, 0, 0],
                    [0, mass, mass * lever, 0, 0],
                    [0, mass * lever, inertia, 0, 0],
                    [0, 0, 0, wheel, 0],
                    [0, 0, 0, 0, wheel],
                ]
            )
        )
        self._free_motion = np.linalg.inv(_WHEEL_ROWS @ self._mobility @ _WHEEL_ROWS.T)
        # The caster, without friction, bears its share of the weight.
        self._grip = mass * _GRAVITY * (1 - lever / caster) / 2 * _STEP
        self.reset()
        self.turn_wheels(WheelPair(0.0, 0.0), 0.0)

    def reset(self) -> None:
        self._x, self._y, self._yaw = START.x, START.y, START.yaw
        self._angles = np.zeros(2)
        self._motion = np.zeros(5)
        self._touching = False

    def turn_wheels(self, speeds: WheelPair, torque: float) -> None:
        self._wanted = np.array([*speeds, 0.0, 0.0, 0.0])
        self._limits = np.array([torque * _STEP] * 2 + [self._grip, self._grip, 2 * self._grip])

    def pose(self) -> Pose:
        return Pose(self._x, self._y, math.remainder(self._yaw, math.tau))

    def velocity(self) -> Velocity:
        return Velocity(float(self._motion[0]), float(self._motion[2]))

    def wheel_angles(self) -> WheelPair:
        return WheelPair(*self._angles.tolist())

    def touching(self) -> bool:
        return self._touching

    def close(self) -> None:
        pass

    def step(self) -> None:
        contacts = list(self._contacts())
        self._touching = any(gap < _TOUCH for gap, _, _ in contacts)
        rows, wanted = _WHEEL_ROWS, self._wanted
        impulses = self._free_motion @ (wanted - rows @ self._motion)
        if contacts or (np.abs(impulses) > self._limits).any():
            cos, sin = math.cos(self._yaw), math.sin(self._yaw)
            apart = [(x * cos + y * sin, y * cos - x * sin, 0, 0, 0) for _, x, y in contacts]
            speeds = [-gap * (STEP_RATE if gap > 0 else _RECOVERY * STEP_RATE) for gap, _, _ in contacts]
            rows, wanted = np.vstack([rows, *apart]), np.concatenate([wanted, speeds])
            impulses = self._limited(rows, wanted - rows @ self._motion)
        self._move(self._motion + self._mobility @ rows.T @ impulses)

    def _contacts(self) -> Iterator[tuple[float, float, float]]:
        """Yield the gap to each obstacle nearby, and the direction away from it."""
        for wall in self._arena.walls:
            along_x, along_y = wall.x1 - wall.x0, wall.y1 - wall.y0
            from_x, from_y = self._x - wall.x0, self._y - wall.y0
            place = (from_x * along_x + from_y * along_y) / (along_x * along_x + along_y * along_y)
            place = min(1.0, max(0.0, place))
            yield from _contact(from_x - place * along_x, from_y - place * along_y, ROBOT_RADIUS)
        sphere = self._arena.sphere
        yield from _contact(self._x - sphere.x, self._y - sphere.y, ROBOT_RADIUS + sphere.radius)

    def _limited(self, rows: _Array, missing: _Array) -> _Array:
        """Return the impulses of all constraints within their limits, for the speeds that are missing."""
        obstacles = len(rows) - len(_WHEEL_ROWS)
        low = np.concatenate([-self._limits, np.zeros(obstacles)])
        high = np.concatenate([self._limits, np.full(obstacles, np.inf)])
        matrix = rows @ self._mobility @ rows.T + _SOFTNESS * np.eye(len(rows))
        impulses = np.zeros(len(rows))
        yielding = np.zeros(len(rows), bool)
        for attempt in range(_ATTEMPTS):
            holding = ~yielding
            rest = missing[holding] - matrix[np.ix_(holding, yielding)] @ impulses[yielding]
            impulses[holding] = np.linalg.solve(matrix[np.ix_(holding, holding)], rest)
            left = missing - matrix @ impulses
            beyond = holding & ((impulses > high + 1e-12) | (impulses < low - 1e-12))
            back = yielding & np.where(impulses >= high, left < -1e-9, left > 1e-9)
            changed = beyond | back
            if not changed.any():
                break
            if attempt > _ATTEMPTS // 10:  # one change at a time cannot cycle
                changed &= np.arange(len(rows)) == changed.argmax()
            yielding ^= changed
            impulses[yielding] = np.clip(impulses, low, high)[yielding]
        return np.clip(impulses, low, high)

    def _move(self, motion: _Array) -> None:
        forward, sideways, turning, left, right = motion.tolist()
        turn = turning * _STEP
        cos, sin = math.cos(self._yaw + turn / 2), math.sin(self._yaw + turn / 2)
        self._x += (forward * cos - sideways * sin) * _STEP
        self._y += (forward * sin + sideways * cos) * _STEP
        self._yaw += turn
        self._angles += (left * _STEP, right * _STEP)
        # The centre of mass keeps its velocity, in a frame that has turned.
        swing = sideways + self._lever * turning
        cos, sin = math.cos(turn), math.sin(turn)
        ahead, aside = cos * forward + sin * swing, cos * swing - sin * forward
        self._motion = np.array([ahead, aside - self._lever * turning, turning, left, right])


def _contact(x: float, y: float, reach: float) -> Iterator[tuple[float, float, float]]:
    distance = math.hypot(x, y)
    if 0 < distance < reach + _NEAR:
        yield distance - reach, x / distance, y / distance


def _described() -> tuple[float, float, float, float, float]:
    """Read the robot's description.

    Returns its mass, how far the centre of mass and the caster are ahead of the axle (the latter last), its
    inertia about the axle's middle, and a wheel's about the axle: in kilograms and metres.
    """
    robot = ElementTree.fromstring((files(__package__) / "burger.urdf").read_bytes())
    joints = {
        _child(joint, "child").attrib["link"]: _place(joint.find("origin")) for joint in robot.iter("joint")
    }
    mass = moment = inertia = wheel = 0.0
    for link in robot.iter("link"):
        inertial = _child(link, "inertial")
        weight = float(_child(inertial, "mass").attrib["value"])
        at = joints.get(link.attrib["name"], (0.0, 0.0))
        own = _place(inertial.find("origin"))
        x, y = at[0] + own[0], at[1] + own[1]
        figures = _child(inertial, "inertia").attrib
        mass += weight
        moment += weight * x
        inertia += float(figures["izz"]) + weight * (x * x + y * y)
        if link.attrib["name"] == "left_wheel":
            wheel = float(figures["iyy"])
    return mass, moment / mass, inertia, wheel, joints["caster"][0]


def _child(element: ElementTree.Element, name: str) -> ElementTree.Element:
    found = element.find(name)
    assert found is not None, f"burger.urdf: {element.tag} has no {name}"
    return found


def _place(origin: ElementTree.Element | None) -> tuple[float, float]:
    x, y, _ = ("0 0 0" if origin is None else origin.attrib["xyz"]).split()
    return float(x), float(y)
