"""What is on a picture of the robot's world."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.camera.renderer import Pixels, Renderer
from tests.camera.shots import SPHERE, WALLS, shot
from tests.support.physics import with_pybullet


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    pytest.importorskip("pybullet")
    renderer = Renderer(WALLS, SPHERE)
    yield renderer
    renderer.close()


def yellow(picture: Pixels) -> NDArray[np.bool_]:
    """Which pixels are the sphere's."""
    red, green, blue = (picture[:, :, channel].astype(int) for channel in range(3))
    found: NDArray[np.bool_] = (red > blue + 80) & (green > blue + 80)
    return found


def white(picture: Pixels) -> NDArray[np.bool_]:
    """Which pixels are the robot's."""
    found: NDArray[np.bool_] = picture.min(axis=2) > 190
    return found


def floor(picture: Pixels) -> NDArray[np.bool_]:
    """Which pixels are the floor's."""
    red, green, blue = (picture[:, :, channel].astype(int) for channel in range(3))
    found: NDArray[np.bool_] = (blue > green + 15) & (green > red + 15)
    return found


def test_a_picture_has_the_size_that_was_asked_for(renderer: Renderer) -> None:
    assert renderer.take(shot(width=44, height=18)).shape == (18, 44, 3)
    assert renderer.take(shot(width=250, height=120)).shape == (120, 250, 3)


def test_the_robot_is_before_the_camera_whatever_its_pose(renderer: Renderer) -> None:
    for x, y, yaw in ((0.0, 0.0, 0.0), (4.0, -3.0, 2.0), (-6.0, 5.0, -1.0)):
        columns = np.nonzero(white(renderer.take(shot(x, y, yaw))))[1]
        assert 15 < columns.mean() < 25


def test_the_sphere_is_ahead_and_above_the_robot_that_heads_for_it(renderer: Renderer) -> None:
    picture = renderer.take(shot())
    rows, columns = np.nonzero(yellow(picture))
    assert 17 < columns.mean() < 23
    assert rows.mean() < np.nonzero(white(picture))[0].mean()


def test_the_sphere_grows_as_the_robot_comes_near(renderer: Renderer) -> None:
    far, near = (yellow(renderer.take(shot(x))).sum() for x in (0.0, 0.5))
    assert near > 1.5 * far > 0


def test_the_sphere_goes_to_the_left_as_the_robot_turns_to_the_right(renderer: Renderer) -> None:
    columns = np.nonzero(yellow(renderer.take(shot(yaw=-0.4))))[1]
    assert columns.mean() < 14


def test_nothing_is_seen_of_the_sphere_behind_the_robot(renderer: Renderer) -> None:
    assert not yellow(renderer.take(shot(1.6, 0.0, 0.0))).any()


def test_the_same_pose_gives_the_same_picture(renderer: Renderer) -> None:
    before = renderer.take(shot(1.0, 2.0, 0.5))
    renderer.take(shot(-3.0, 1.0, 2.0))
    assert np.array_equal(before, renderer.take(shot(1.0, 2.0, 0.5)))


def test_a_wall_at_the_robots_back_does_not_hide_it(renderer: Renderer) -> None:
    picture = renderer.take(shot(-6.85, 0.0, 0.0))
    assert white(picture).any()
    assert floor(picture).mean() > 0.3


@with_pybullet
def test_the_room_is_the_traces_own() -> None:
    walls = ((-2.0, -2.0, 2.0, -2.0), (2.0, -2.0, 2.0, 2.0), (2.0, 2.0, -2.0, 2.0), (-2.0, 2.0, -2.0, -2.0))
    renderer = Renderer(walls, (0.0, 1.0, 0.3))
    picture = renderer.take(shot(0.0, 0.0, math.pi / 2))
    renderer.close()
    assert yellow(picture)[:, 18:22].any()
