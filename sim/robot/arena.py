"""The robot's surroundings as plain data: the room, the sphere and the robot's outline.

In metres; x points straight ahead of the robot at the start, y to its left. The world builds its bodies
from this data, the lidar measures it and the console draws it, without PyBullet.
"""

from dataclasses import dataclass
from itertools import pairwise

ROBOT_RADIUS = 0.105
"""Radius of the upright disc that the robot fills, its centre midway between the wheels."""

LIDAR_HEIGHT = 0.18
"""Height of the lidar's plane above the floor; the lidar sits above the middle of the axle."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Position of the robot's base (metres) and its heading (radians in -pi … pi, 0 along x)."""

    x: float
    y: float
    yaw: float


START = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Segment:
    """The face of a straight wall, from (x0, y0) to (x1, y1), with the room on its left."""

    x0: float
    y0: float
    x1: float
    y1: float


@dataclass(frozen=True, slots=True)
class Circle:
    """The section of a sphere in the lidar's plane, which has the sphere's centre."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class Arena:
    """A room: its walls, and the sphere in it."""

    walls: tuple[Segment, ...]
    sphere: Circle


def outline(*corners: tuple[float, float]) -> tuple[Segment, ...]:
    """Return the walls of a closed room whose corners are listed counter-clockwise."""
    return tuple(Segment(*start, *end) for start, end in pairwise((*corners, corners[0])))


_SPHERE_RADIUS = 0.18
_SPHERE_GAP = 0.75

ARENA = Arena(
    # One corner is cut out, and the start is not in the middle, so that a map shows which way is ahead.
    walls=outline((-7.0, -8.0), (9.0, -8.0), (9.0, 3.0), (6.5, 3.0), (6.5, 6.5), (-7.0, 6.5)),
    sphere=Circle(START.x + _SPHERE_GAP + _SPHERE_RADIUS, START.y, _SPHERE_RADIUS),
)
"""The lessons' arena: a sphere 0.75 m ahead of the lidar; walls are at least 6.5 m away.

In 60 s at the lessons' 0.08 m/s the robot drives less than 5 m, so that it meets only the sphere.
"""
