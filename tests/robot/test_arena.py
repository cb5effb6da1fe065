"""What the arena promises to the lessons."""

import math
import subprocess
import sys
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

import sim.robot
from sim.robot.arena import ARENA, LIDAR_HEIGHT, ROBOT_RADIUS, START, Pose
from sim.robot.drive import WHEEL_RADIUS, WHEEL_SEPARATION
from sim.robot.lidar import BEAMS, Lidar

LESSON_SPEED = 0.08
CLOCKWISE_TURNS = (2.0, 4.0)
TURNING_PLACES = (0.25, 0.30)
"""How far from the start the lessons' node, stopping at 0.5 m from the sphere, may stand when it turns."""


def test_importing_the_arena_needs_neither_pybullet_nor_numpy() -> None:
    asked = "import sys, sim.robot.arena; print(*sorted({'pybullet', 'numpy'} & set(sys.modules)))"
    answer = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert answer.stdout.split() == []


def test_the_walls_close_a_room() -> None:
    ring = (*ARENA.walls, ARENA.walls[0])
    assert all((one.x1, one.y1) == (other.x0, other.y0) for one, other in pairwise(ring))


def test_the_room_lies_on_the_left_of_every_wall() -> None:
    enclosed = sum(wall.x0 * wall.y1 - wall.x1 * wall.y0 for wall in ARENA.walls) / 2
    assert enclosed > 0


def test_the_sphere_is_three_quarters_of_a_metre_ahead_of_the_lidar_at_the_start() -> None:
    assert Lidar(ARENA).scan(START)[BEAMS // 2] == pytest.approx(0.75)


def test_every_wall_is_six_metres_off_or_more() -> None:
    sphere_free = Lidar(ARENA).scan(Pose(START.x, START.y, math.pi))
    away_from_sphere = np.abs(np.arange(BEAMS) - BEAMS // 2) < BEAMS // 4
    assert sphere_free[away_from_sphere].min() >= 6.0
    distances = [math.hypot(wall.x0, wall.y0) for wall in ARENA.walls]
    assert min(distances) >= 6.0


@pytest.mark.parametrize("turn", CLOCKWISE_TURNS)
@pytest.mark.parametrize("place", TURNING_PLACES)
def test_after_the_lessons_turns_the_way_is_free_for_a_minute(turn: float, place: float) -> None:
    lidar = Lidar(ARENA)
    assert lidar.scan(Pose(place, 0.0, -turn))[BEAMS // 2] > 5.5
    gone = LESSON_SPEED * 60
    there = Pose(place + gone * math.cos(-turn), gone * math.sin(-turn), -turn)
    assert lidar.scan(there).min() > 0.5 + ROBOT_RADIUS


def test_the_robot_description_has_the_sizes_that_the_code_reckons_with() -> None:
    robot = ElementTree.parse(f"{sim.robot.__path__[0]}/burger.urdf").getroot()

    def origin(joint: str) -> list[float]:
        found = robot.find(f"./joint[@name='{joint}']/origin")
        assert found is not None
        return [float(part) for part in found.attrib["xyz"].split()]

    def size(path: str) -> float:
        found = robot.find(path)
        assert found is not None
        return float(found.attrib["radius"])

    assert origin("left_wheel_joint") == [0, WHEEL_SEPARATION / 2, WHEEL_RADIUS]
    assert origin("right_wheel_joint") == [0, -WHEEL_SEPARATION / 2, WHEEL_RADIUS]
    assert origin("lidar_joint") == [0, 0, LIDAR_HEIGHT]
    assert size("./link[@name='left_wheel']/collision/geometry/sphere") == WHEEL_RADIUS
    assert size("./link[@name='base_link']/collision/geometry/cylinder") == ROBOT_RADIUS
