"""What a frame of lanes costs in an hour-long run."""

from itertools import count

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from cbtui.widgets.lanes import LanePainter
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.benchmarks.drawing import FRAME, long_run
from tests.support.runs import ns

HOUR = 3600


@pytest.fixture(scope="module")
def hour() -> Timeline:
    return long_run(HOUR)


@pytest.mark.parametrize("seconds", [1, 10, 60, 600])
def test_a_following_frame_of_sixteen_lanes(
    benchmark: BenchmarkFixture, hour: Timeline, seconds: int
) -> None:
    painter = LanePainter()
    frames = count()

    def frame() -> None:
        now = ns(HOUR - 60) + next(frames) * FRAME
        painter.paint(hour, Window(now - ns(seconds), now), now, 140, 20)

    frame()
    benchmark(frame)


@pytest.mark.parametrize("seconds", [1, 10, 60, 600])
def test_the_first_frame_after_zooming(benchmark: BenchmarkFixture, hour: Timeline, seconds: int) -> None:
    end = ns(HOUR - 60)
    window = Window(end - ns(seconds), end)
    benchmark(lambda: LanePainter().paint(hour, window, end, 140, 20))
