"""Draws the robot's world with PyBullet's software renderer, from behind and above the robot."""

import math

import numpy as np
from numpy.typing import NDArray

from sim.camera.wire import Shot
from sim.robot.arena import Arena, Circle, Segment
from sim.robot.bullet import BulletClient
from sim.robot.scene import build

Pixels = NDArray[np.uint8]
_Point = tuple[float, float, float]

_BEHIND, _ABOVE, _AHEAD, _AT_HEIGHT = 0.60, 0.42, 0.30, 0.13
"""The camera's position relative to the robot, and the point that it looks at, in metres."""
_HIGH, _NARROWEST, _WIDEST = math.radians(52), math.radians(66), math.radians(100)
"""The vertical angle of view, changed where the horizontal one would be outside these limits."""
_NEAR, _FAR = 0.03, 60.0
_EMPTY = 0.9999
"""The depth from which on a pixel shows nothing."""
_WALL_GAP = 0.8
"""The camera's position before a wall behind it, as a part of the distance to the wall."""

_FLOOR = (0.25, 0.38, 0.50, 1.0)
_WALLS = ((1.00, 0.52, 0.40, 1.0), (0.40, 0.82, 0.76, 1.0))
"""Neighbouring walls differ, so that corners and turns are visible."""
_SPHERE = (1.0, 0.86, 0.16, 1.0)
_BODY = (0.95, 0.95, 0.95, 1.0)
_SHADE = (0.05, 0.07, 0.12, 1.0)
_SKY = (36.0, 36.0, 73.0)
_LIGHT: _Point = (-0.5, 0.7, 1.6)

_SMOOTH_UP_TO = 8000
"""Pixels up to which a picture is drawn twice as large and reduced, for smooth edges."""


class Renderer:
    """Takes shots of one arena, in a PyBullet client of its own. Not thread-safe."""

    def __init__(
        self, walls: tuple[tuple[float, float, float, float], ...], sphere: tuple[float, float, float]
    ) -> None:
        """Build the arena.

        Raises:
            WorldUnavailable: PyBullet cannot be used here; the text says what to do.
        """
        client = self._client = BulletClient()
        self._scene = build(client, Arena(tuple(Segment(*wall) for wall in walls), Circle(*sphere)))
        self._base_in_inertial = client.getDynamicsInfo(self._scene.robot, -1)[3:5]
        self._robot_shade = self._shade(0.115, 0.0, 0.0)
        self._shade(0.75 * sphere[2], sphere[0], sphere[1])
        self._paint()

    def take(self, shot: Shot) -> Pixels:
        """Return the picture, shape (height, width, 3), red, green and blue."""
        self._place(shot)
        fine = 2 if shot.width * shot.height <= _SMOOTH_UP_TO else 1
        picture = self._look(shot, shot.width * fine, shot.height * fine)
        smooth = picture.reshape(shot.height, fine, shot.width, fine, 3).mean(axis=(1, 3))
        rounded: Pixels = np.rint(smooth).astype(np.uint8)
        return rounded

    def close(self) -> None:
        """Release PyBullet's client."""
        self._client.close()

    def _paint(self) -> None:
        colour = self._client.changeVisualShape
        colour(self._scene.floor, -1, rgbaColor=_FLOOR)
        for number, wall in enumerate(self._scene.walls):
            colour(wall, -1, rgbaColor=_WALLS[number % len(_WALLS)])
        colour(self._scene.sphere, -1, rgbaColor=_SPHERE)
        colour(self._scene.robot, -1, rgbaColor=_BODY)

    def _shade(self, radius: float, x: float, y: float) -> int:
        """Add a dark disc on the floor in place of a shadow, which the renderer draws with artefacts."""
        disc = self._client.createVisualShape(
            self._client.GEOM_CYLINDER, radius=radius, length=0.002, rgbaColor=_SHADE
        )
        return int(self._client.createMultiBody(0, baseVisualShapeIndex=disc, basePosition=(x, y, 0.002)))

    def _place(self, shot: Shot) -> None:
        client = self._client
        heading = client.getQuaternionFromEuler((0, 0, shot.yaw))
        inertial = client.multiplyTransforms((shot.x, shot.y, 0), heading, *self._base_in_inertial)
        client.resetBasePositionAndOrientation(self._scene.robot, *inertial)
        client.resetBasePositionAndOrientation(self._robot_shade, (shot.x, shot.y, 0.002), heading)

    def _look(self, shot: Shot, width: int, height: int) -> NDArray[np.float64]:
        client = self._client
        eye, target = self._aim(shot)
        aspect = width / height
        least, most = (2 * math.atan(math.tan(angle / 2) / aspect) for angle in (_NARROWEST, _WIDEST))
        high = max(least, min(_HIGH, most))
        _, _, colours, depths, _ = client.getCameraImage(
            width,
            height,
            client.computeViewMatrix(eye, target, (0, 0, 1)),
            client.computeProjectionMatrixFOV(math.degrees(high), aspect, _NEAR, _FAR),
            renderer=client.ER_TINY_RENDERER,
            flags=client.ER_NO_SEGMENTATION_MASK,
            shadow=0,
            lightDirection=_LIGHT,
            lightAmbientCoeff=0.6,
            lightDiffuseCoeff=0.45,
            lightSpecularCoeff=0.1,
        )
        empty = np.reshape(depths, (height, width, 1)) >= _EMPTY
        return np.where(empty, _SKY, np.reshape(colours, (height, width, 4))[:, :, :3])

    def _aim(self, shot: Shot) -> tuple[_Point, _Point]:
        """Return the camera's position and target, both nearer to the robot if a wall is in the way."""
        cos, sin = math.cos(shot.yaw), math.sin(shot.yaw)
        behind = (shot.x - _BEHIND * cos, shot.y - _BEHIND * sin, _ABOVE)
        body, _, way, *_ = self._client.rayTest((shot.x, shot.y, _ABOVE), behind)[0]
        share = way * _WALL_GAP if body >= 0 else 1.0
        back, ahead = share * _BEHIND, share * _AHEAD
        return (
            (shot.x - back * cos, shot.y - back * sin, _ABOVE),
            (shot.x + ahead * cos, shot.y + ahead * sin, _AT_HEIGHT),
        )
