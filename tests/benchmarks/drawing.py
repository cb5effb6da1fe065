"""What drawing takes of the processor: of a live console, and of the lanes in an hour's run."""

import time
from functools import lru_cache
from statistics import median

from cbtui.widgets.lanes import INTERVALS_PER_FRAME, LanePainter
from sim.trace import events as ev
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.benchmarks.console import lesson_opened
from tests.support.runs import ns

FRAME = ns(1 / 30)
WIDTH, HEIGHT = 140, 20

_SETTLED = 3.0
_FILLING = 52
"""The frames in which the lanes of an hour and their overview fill."""
_CAMERA = "c"


def live(seconds: int, lesson: str = "split-groups", keys: str = "") -> float:
    """The share of a core that the console takes to draw so many seconds of a lesson."""
    with lesson_opened(lesson) as console:
        console.press(keys + "s")
        console.watch(min(_SETTLED, seconds))
        return console.share_of_a_core(seconds)


def with_camera(seconds: int) -> float:
    """That share with the camera's pictures beside the lanes."""
    return live(seconds, "shared-group", _CAMERA)


def filling_frame(seconds: int) -> float:
    """The seconds of processor that a frame takes as the lanes fill after zooming out on so long a run."""
    return median(_frames(seconds, range(_FILLING)))


def following_frame(seconds: int) -> float:
    """The seconds of processor that a frame takes once they are full and follow the run."""
    return median(_frames(seconds, range(_FILLING, _FILLING + 30)))


def _frames(seconds: int, counted: range) -> list[float]:
    timeline, painter = long_run(seconds), LanePainter(looks=INTERVALS_PER_FRAME)
    length = ns(min(600, seconds / 2))
    took = []
    for number in range(counted.stop):
        now = ns(seconds * 0.9) + number * FRAME
        began = time.process_time()
        painter.paint(timeline, Window(max(0, now - length), now), now, WIDTH, HEIGHT)
        took.append(time.process_time() - began)
    return took[counted.start :]


@lru_cache(maxsize=2)
def long_run(seconds: int, hertz: float = 20) -> Timeline:
    """Eight threads and eight groups of one: six called that often, two nearly always busy."""
    timeline = Timeline()
    timeline.extend([ev.RunStarted(0, "long", "virtual", 0), ev.NodeAppeared(0, 1, "/node")])
    told: list[ev.AnyEvent] = []
    for lane in range(1, 9):
        timeline.extend(_cast(lane))
        every, lasts = (1 / hertz, 0.0004) if lane < 7 else (2.0, 1.5)
        for start in range(ns(lane / 1000), ns(seconds), ns(every)):
            told.append(ev.CallbackStarted(start, lane, lane, 0, 1000, 0))
            told.append(ev.CallbackEnded(start + ns(lasts), lane, lane))
    timeline.extend(sorted(told, key=lambda event: event.t))
    return timeline


def _cast(lane: int) -> list[ev.AnyEvent]:
    """A thread, and a group with its subscription."""
    callback = f"t{lane}_callback", "n.py", 1, 2, 10, 0
    return [
        ev.ThreadAppeared(0, lane, f"ThreadPoolExecutor-0_{lane - 1}"),
        ev.GroupAppeared(0, lane, 1, ev.GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
        ev.EntityAppeared(0, lane, 1, lane, ev.EntityKind.SUBSCRIPTION, f"/t{lane}", *callback),
    ]
