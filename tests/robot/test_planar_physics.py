"""The planar physics, judged by PyBullet's own runs."""

import math

import pytest

from sim.quantities.nanoseconds import SECOND
from sim.robot.arena import ARENA, Arena, Circle, Segment
from sim.robot.physics import PhysicsChoice
from sim.robot.world import World

OPEN_FLOOR = Arena((Segment(100.0, -3.0, 100.0, 3.0),), Circle(0.0, -50.0, 0.1))
WALL = Arena((Segment(0.5, -3.0, 0.5, 3.0),), Circle(0.0, -50.0, 0.1))

Command = tuple[float, float, float]

MINUTES: dict[str, list[Command]] = {
    "ahead": [(0.0, 0.08, 0.0)],
    "a lesson": [(0.0, 0.08, 0.0), (3.3, 0.0, -0.2), (13.3, 0.08, 0.0)],
    "every which way": [
        (0.37 * tick, *((0.2, 0.0), (0.2, 1.3), (-0.1, -2.0), (0.0, -0.2), (0.22, 0.1))[tick % 5])
        for tick in range(160)
    ],
}


def apart(arena: Arena, commands: list[Command], until: float) -> tuple[float, float]:
    """How far apart the two robots come, at a tenth of a second's looks: metres and radians."""
    pytest.importorskip("pybullet")
    worlds = [World(arena, choice) for choice in PhysicsChoice]
    place = heading = 0.0
    left = list(commands)
    for tick in range(round(until * 10) + 1):
        while left and left[0][0] * 10 <= tick:
            _, linear, angular = left.pop(0)
            for world in worlds:
                world.command(linear, angular)
        for world in worlds:
            world.advance_to(tick * SECOND // 10)
        one, other = (world.pose() for world in worlds)
        place = max(place, math.hypot(one.x - other.x, one.y - other.y))
        heading = max(heading, abs(math.remainder(one.yaw - other.yaw, math.tau)))
    for world in worlds:
        world.close()
    return place, heading


@pytest.mark.parametrize(
    "drive",
    [
        "ahead",
        pytest.param("a lesson", marks=pytest.mark.slow),
        pytest.param("every which way", marks=pytest.mark.bulk),
    ],
)
def test_after_a_minute_of_driving_the_two_robots_are_within_five_millimetres(drive: str) -> None:
    place, heading = apart(OPEN_FLOOR, MINUTES[drive], 60.0)
    assert place < 0.005
    assert heading < 0.001


@pytest.mark.parametrize("arena", [WALL, ARENA])
def test_an_obstacle_stops_both_at_the_same_place(arena: Arena) -> None:
    place, _ = apart(arena, [(0.0, 0.1, 0.0)], 9.0)
    assert place < 0.002


def test_both_leave_a_wall_alike() -> None:
    place, heading = apart(WALL, [(0.0, 0.1, 0.0), (5.0, -0.1, 0.0)], 10.0)
    assert place < 0.005
    assert heading < 0.01
