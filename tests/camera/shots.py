"""Shots that the tests of the camera share."""

from sim.camera import Shot
from sim.robot.arena import ARENA

WALLS = tuple((wall.x0, wall.y0, wall.x1, wall.y1) for wall in ARENA.walls)
SPHERE = (ARENA.sphere.x, ARENA.sphere.y, ARENA.sphere.radius)


def shot(x: float = 0.0, y: float = 0.0, yaw: float = 0.0, width: int = 40, height: int = 24) -> Shot:
    """A shot of the lessons' arena."""
    return Shot(WALLS, SPHERE, x, y, yaw, width, height)
