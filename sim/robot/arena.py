"""What stands where: the room, the sphere and the robot's outline, as plain data.

Metres; x points straight ahead of the robot at the start, y to its left. The world builds its
bodies from this data, the lidar measures it and the console draws it; reading it needs no PyBullet.
"""

from dataclasses import dataclass
from itertools import pairwise

ROBOT_RADIUS = 0.105
"""Radius of the upright disc that the robot fills, its centre midway between the wheels."""

LIDAR_HEIGHT = 0.18
"""Height of the lidar's plane above the floor; the lidar sits above the middle of the axle."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the robot's base is (metres) and where it heads (radians in -pi … pi, 0 along x)."""

    x: float
    y: float
    yaw: float


START = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Segment:
    """A straight wall's face, from (x0, y0) to (x1, y1), with the room on the left of that way."""

    x0: float
    y0: float
    x1: float
    y1: float


@dataclass(frozen=True, slots=True)
class Circle:
    """A sphere as the lidar's plane cuts it; the sphere's centre lies in that plane."""

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
    # One corner is cut out, and the start is off the middle: a map shows at once which way is ahead.
    walls=outline((-7.0, -8.0), (9.0, -8.0), (9.0, 3.0), (6.5, 3.0), (6.5, 6.5), (-7.0, 6.5)),
    sphere=Circle(START.x + _SPHERE_GAP + _SPHERE_RADIUS, START.y, _SPHERE_RADIUS),
)
"""The lessons' arena: a sphere 0.75 m ahead of the lidar, every wall 6.5 m off or more.

In 60 s at the lessons' 0.08 m/s the robot covers less than 5 m, so that the sphere is all it meets.
"""
