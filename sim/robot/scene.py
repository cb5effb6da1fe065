"""Builds the bodies of a world in PyBullet: floor, walls, sphere and robot."""

import math
from dataclasses import dataclass
from importlib.resources import as_file, files

from .arena import LIDAR_HEIGHT, Arena, Circle, Segment
from .bullet import BulletClient

WALL_HEIGHT = 0.5
_WALL_THICKNESS = 0.1

_WHEEL_FRICTION = 1.0
_BODY_FRICTION = 0.3

# Collision groups, one bit each; PyBullet's rays are in group 1. A wheel touches only the floor, as the disc
# of the body is wider than the wheels.
_RAY, _FLOOR, _OBSTACLE, _BODY, _WHEEL = 1, 2, 4, 8, 16
_TOUCHES = {_FLOOR: _BODY | _WHEEL, _OBSTACLE: _BODY | _RAY, _BODY: _FLOOR | _OBSTACLE, _WHEEL: _FLOOR}

_BASE = -1


@dataclass(frozen=True, slots=True)
class BulletScene:
    """PyBullet's numbers of the bodies, and of the wheels' joints."""

    floor: int
    walls: tuple[int, ...]
    sphere: int
    robot: int
    wheels: tuple[int, int]


def build(client: BulletClient, arena: Arena) -> BulletScene:
    """Build the arena and a robot, at rest at the start, in an empty client."""
    floor = client.createMultiBody(0, client.createCollisionShape(client.GEOM_PLANE))
    client.changeDynamics(floor, _BASE, lateralFriction=1.0)
    _collide_as(client, floor, _BASE, _FLOOR)
    walls = tuple(_add_wall(client, wall) for wall in arena.walls)
    sphere = _add_sphere(client, arena.sphere)
    for obstacle in (*walls, sphere):
        _collide_as(client, obstacle, _BASE, _OBSTACLE)
    robot = _add_robot(client)
    joints = {client.getJointInfo(robot, i)[1].decode(): i for i in range(client.getNumJoints(robot))}
    wheels = (joints["left_wheel_joint"], joints["right_wheel_joint"])
    _set_surfaces(client, robot, wheels, caster=joints["caster_joint"])
    return BulletScene(floor, walls, sphere, robot, wheels)


def _add_wall(client: BulletClient, wall: Segment) -> int:
    along_x, along_y = wall.x1 - wall.x0, wall.y1 - wall.y0
    length = math.hypot(along_x, along_y)
    half = _WALL_THICKNESS / 2
    shape = client.createCollisionShape(client.GEOM_BOX, halfExtents=(length / 2, half, WALL_HEIGHT / 2))
    centre = (
        (wall.x0 + wall.x1) / 2 + half * along_y / length,
        (wall.y0 + wall.y1) / 2 - half * along_x / length,
        WALL_HEIGHT / 2,
    )
    turned = client.getQuaternionFromEuler((0, 0, math.atan2(along_y, along_x)))
    return int(client.createMultiBody(0, shape, basePosition=centre, baseOrientation=turned))


def _add_sphere(client: BulletClient, sphere: Circle) -> int:
    shape = client.createCollisionShape(client.GEOM_SPHERE, radius=sphere.radius)
    return int(client.createMultiBody(0, shape, basePosition=(sphere.x, sphere.y, LIDAR_HEIGHT)))


def _add_robot(client: BulletClient) -> int:
    flags = client.URDF_USE_IMPLICIT_CYLINDER | client.URDF_USE_INERTIA_FROM_FILE
    with as_file(files(__package__) / "burger.urdf") as urdf:
        return int(client.loadURDF(str(urdf), flags=flags))


def _set_surfaces(client: BulletClient, robot: int, wheels: tuple[int, int], caster: int) -> None:
    frictions = dict.fromkeys(wheels, _WHEEL_FRICTION) | {caster: 0.0}
    for link in range(_BASE, client.getNumJoints(robot)):
        client.changeDynamics(
            robot,
            link,
            lateralFriction=frictions.get(link, _BODY_FRICTION),
            linearDamping=0.0,
            angularDamping=0.0,
            jointDamping=0.0,
        )
        _collide_as(client, robot, link, _WHEEL if link in wheels else _BODY)


def _collide_as(client: BulletClient, body: int, link: int, group: int) -> None:
    client.setCollisionFilterGroupMask(body, link, group, _TOUCHES[group])
