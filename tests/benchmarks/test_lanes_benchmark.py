"""What a frame of lanes costs in an hour-long run."""

from itertools import count

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from cbtui.widgets.lanes import Painter
from sim.trace import events as ev
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import ns

HOUR = 3600
FRAME = ns(1 / 30)


@pytest.fixture(scope="module")
def hour() -> Timeline:
    """Eight threads and eight groups of one: six at 20 Hz, two nearly always busy; one hour."""
    timeline = Timeline()
    timeline.extend([ev.RunStarted(0, "hour", "virtual", 0), ev.NodeAppeared(0, 1, "/node")])
    told_events: list[ev.AnyEvent] = []
    for lane in range(1, 9):
        timeline.extend(
            [
                ev.ThreadAppeared(0, lane, f"ThreadPoolExecutor-0_{lane - 1}"),
                ev.GroupAppeared(0, lane, 1, ev.GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
                ev.EntityAppeared(
                    0,
                    lane,
                    1,
                    lane,
                    ev.EntityKind.SUBSCRIPTION,
                    f"/t{lane}",
                    f"t{lane}_callback",
                    "n.py",
                    1,
                    2,
                    10,
                    0,
                ),
            ]
        )
        every, lasts = (0.05, 0.0004) if lane < 7 else (2.0, 1.5)
        for start in range(ns(lane / 1000), ns(HOUR), ns(every)):
            told_events.append(ev.CallbackStarted(start, lane, lane, 0, 1000, 0))
            told_events.append(ev.CallbackEnded(start + ns(lasts), lane, lane))
    timeline.extend(sorted(told_events, key=lambda event: event.t))
    return timeline


@pytest.mark.parametrize("seconds", [1, 10, 60, 600])
def test_a_following_frame_of_sixteen_lanes(
    benchmark: BenchmarkFixture, hour: Timeline, seconds: int
) -> None:
    painter = Painter()
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
    benchmark(lambda: Painter().paint(hour, window, end, 140, 20))
