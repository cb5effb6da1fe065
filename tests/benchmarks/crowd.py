"""A node with many timers, and what the console does to draw it."""

from collections.abc import Callable
from pathlib import Path

from cbtui.runs.live.findings import FindingsMonitor
from cbtui.widgets.code.marks import marks_at
from cbtui.widgets.code.source_files import SourceFiles
from cbtui.widgets.diagnosis import diagnosis_at
from cbtui.widgets.factory.painter import FactoryPainter
from cbtui.widgets.lanes import INTERVALS_PER_FRAME, LanePainter
from sim.trace import events as ev
from sim.trace.figures.concurrency import Concurrency
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import ns

_NODE = Path("/n.py")
_WIDTH, _HEIGHT = 140, 20


def timers(number: int, in_groups: bool) -> list[ev.AnyEvent]:
    """A node with so many timers, all in one group or each in its own; each is called once."""
    told: list[ev.AnyEvent] = [
        ev.RunStarted(0, "many", "real", 0),
        ev.NodeAppeared(0, 1, "/node"),
        ev.ThreadAppeared(0, 1, "MainThread"),
        ev.ExecutorAppeared(0, 1, "SingleThreadedExecutor", 1),
    ]
    for each in range(1, number + 1):
        if each == 1 or in_groups:
            told.append(
                ev.GroupAppeared(0, each, 1, ev.GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup")
            )
        group = each if in_groups else 1
        callback = "tick", str(_NODE), 1, 2, 0, ns(1000)
        told.append(ev.EntityAppeared(0, each, 1, group, ev.EntityKind.TIMER, "", *callback))
    for each in range(1, number + 1):
        told += call(each, each * ns(0.0001))
    return told


def call(timer: int, at: int) -> list[ev.AnyEvent]:
    """One call of a timer."""
    return [ev.CallbackStarted(at, timer, 1, 0, 0, 0), ev.CallbackEnded(at + ns(0.00005), timer, 1)]


class Drawn:
    """A run with many timers, all parts of its picture drawn as it goes on."""

    def __init__(self, number: int, in_groups: bool) -> None:
        self._timeline = Timeline()
        self._timeline.extend(timers(number, in_groups))
        self._lanes = LanePainter(looks=INTERVALS_PER_FRAME)
        self._factory = FactoryPainter()
        self._watch = FindingsMonitor(self._timeline)
        self._concurrency = Concurrency(self._timeline)
        self._files = SourceFiles(_NODE, "def tick():\n    pass\n")

    def go_on(self, at: int) -> None:
        """Have the first timer called once more."""
        self._timeline.extend(call(1, at))

    @property
    def parts(self) -> dict[str, Callable[[], object]]:
        """What draws each part at the end of the run."""
        timeline = self._timeline
        end = timeline.end
        window = Window(end - ns(10), end)
        return {
            "lanes": lambda: self._lanes.paint(timeline, window, end, _WIDTH, _HEIGHT),
            "factory": lambda: self._factory.paint(timeline, end, _WIDTH, _HEIGHT),
            "sentence": lambda: diagnosis_at(timeline, end, self._concurrency),
            "code": lambda: marks_at(timeline, end, self._files),
            "rules": self._watch.update,
        }
