"""What the lidar measures."""

import math
from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.robot.arena import ARENA, LIDAR_HEIGHT, START, Arena, Circle, Pose, Segment, outline
from sim.robot.bullet import BulletClient
from sim.robot.lidar import BEAMS, RANGE_MAX, RANGE_MIN, Lidar
from sim.robot.scene import build

AHEAD, LEFT, BEHIND, RIGHT = 360, 540, 0, 180

OUT_OF_SIGHT = Circle(0.0, -50.0, 0.1)
LEFT_WALL = Arena((Segment(5.0, 1.0, -5.0, 1.0),), OUT_OF_SIGHT)


def wall_ahead(distance: float) -> Arena:
    return Arena((Segment(distance, -3.0, distance, 3.0),), OUT_OF_SIGHT)


def test_the_beams_go_once_round_counter_clockwise_from_straight_behind() -> None:
    room = Arena(outline((-4.0, -3.0), (1.0, -3.0), (1.0, 2.0), (-4.0, 2.0)), OUT_OF_SIGHT)
    ranges = Lidar(room).scan(START)
    assert ranges.shape == (720,)
    assert ranges.dtype == np.float32
    assert ranges[[BEHIND, RIGHT, AHEAD, LEFT]].tolist() == pytest.approx([4.0, 3.0, 1.0, 2.0])


def test_the_scan_turns_with_the_robot() -> None:
    ranges = Lidar(LEFT_WALL).scan(Pose(0.0, 0.0, math.pi / 2))
    assert ranges[AHEAD] == pytest.approx(1.0)
    assert ranges[AHEAD + 120] == pytest.approx(2.0)
    assert ranges[BEHIND] == math.inf


def test_beyond_the_longest_range_is_infinity() -> None:
    assert Lidar(wall_ahead(RANGE_MAX - 0.01)).scan(START)[AHEAD] == pytest.approx(RANGE_MAX - 0.01)
    assert Lidar(wall_ahead(RANGE_MAX + 0.01)).scan(START)[AHEAD] == math.inf


def test_nearer_than_the_shortest_range_reads_the_shortest_range() -> None:
    assert Lidar(wall_ahead(0.05)).scan(START)[AHEAD] == np.float32(RANGE_MIN)


def test_a_wall_along_the_beam_is_no_error() -> None:
    assert Lidar(wall_ahead(1.0)).scan(Pose(0.0, 0.0, math.pi / 2))[AHEAD] == math.inf


def test_a_scan_is_the_callers_own() -> None:
    lidar = Lidar(ARENA)
    lidar.scan(START)[:] = 0.0
    assert lidar.scan(START)[AHEAD] == pytest.approx(0.75)


@given(st.floats(-6.9, 6.4), st.floats(-7.9, 2.9), st.floats(-math.pi, math.pi))
def test_no_beam_leaves_the_room_anywhere(x: float, y: float, yaw: float) -> None:
    assert np.isfinite(Lidar(ARENA).scan(Pose(x, y, yaw))).all()


@pytest.fixture(scope="module")
def physical() -> Iterator[BulletClient]:
    pytest.importorskip("pybullet")
    with closing(BulletClient()) as client:
        build(client, ARENA)
        yield client


@pytest.mark.parametrize(
    "pose", [Pose(2.0, 0.5, 0.0), Pose(0.9, 2.5, -1.8), Pose(-6.5, -7.5, 2.0), Pose(6.0, 6.2, 0.3)]
)
def test_the_lidar_measures_what_stands_in_the_physical_world(physical: BulletClient, pose: Pose) -> None:
    bearings = pose.yaw + (np.arange(BEAMS) - AHEAD) * math.tau / BEAMS
    centre = np.array((pose.x, pose.y, LIDAR_HEIGHT))
    away = np.stack((np.cos(bearings), np.sin(bearings), np.zeros(BEAMS)), axis=1)
    hits = physical.rayTestBatch(np.tile(centre, (BEAMS, 1)), centre + RANGE_MAX * away)
    apart = np.abs(Lidar(ARENA).scan(pose) - np.array([hit[2] for hit in hits]) * RANGE_MAX)
    grazing = 2  # a beam along the sphere's rim may be met by the one and missed by the other
    assert np.sum(apart > 0.005) <= grazing
