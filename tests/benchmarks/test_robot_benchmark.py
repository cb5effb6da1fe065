"""What the robot pane costs: a frame of its maps, drawing a picture, and making cells of it."""

from collections.abc import Iterator

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from cbtui.widgets.robot import RobotViewMode
from cbtui.widgets.robot.camera_picture import half_blocks
from cbtui.widgets.robot.painter import RobotPainter
from sim.camera import Picture
from sim.camera.renderer import Renderer
from tests.camera.shots import SPHERE, WALLS, shot
from tests.support.runs import ns, shared_group_run
from tests.widgets.pictures import told

SIZES = [(42, 20), (76, 12), (96, 54), (136, 52)]
"""Pixels of pictures that the pane asks for: beside the other panes, in a small terminal, enlarged."""


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    renderer = Renderer(WALLS, SPHERE)
    yield renderer
    renderer.close()


@pytest.mark.parametrize(("width", "height"), [(44, 18), (78, 9), (138, 30)])
@pytest.mark.parametrize("look", RobotViewMode)
def test_a_frame_of_the_robot_pane(
    benchmark: BenchmarkFixture, width: int, height: int, look: RobotViewMode
) -> None:
    timeline = told(shared_group_run())
    painter = RobotPainter()
    benchmark(lambda: painter.paint(timeline, ns(29.25), width, height, look))


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_a_picture_of_the_camera(
    benchmark: BenchmarkFixture, renderer: Renderer, width: int, height: int
) -> None:
    benchmark(lambda: renderer.take(shot(0.28, 0.0, -0.5, width, height)))


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_the_cells_of_a_picture(
    benchmark: BenchmarkFixture, renderer: Renderer, width: int, height: int
) -> None:
    pixels = renderer.take(shot(0.28, 0.0, -0.5, width, height))
    picture = Picture(width, height, pixels.tobytes())
    benchmark(lambda: half_blocks(picture))
