"""Runs of lessons with set-ups and inputs at random, each twice: what came of it, and what of its engine."""

import hashlib
import re
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from queue import Empty, Queue
from random import Random
from typing import NamedTuple

import msgspec

from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.changes import GROUP_CHOICES
from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import lessons
from lessons.lesson import Lesson
from sim.engine.setup import GroupChange, PeriodChange, RunSetup, TimedCall, TimedLine
from sim.export.jsonl import JsonLines
from sim.trace.events import AnyEvent, EventsLost, RunEnded
from sim.trace.integrity.message_counts import MessageCounts
from tests.soak.footprint import Footprint, footprint, growth

SECOND = 1_000_000_000
_LENGTHS = (30.0, 120.0, 600.0, 1800.0)
_LOOK = 5 * SECOND
"""Nanoseconds of a run from one look at its engine to the next."""
_PATIENCE = 60.0
"""Real seconds without a word from an engine after which it is said to hang."""
_MEMORY = 24_000_000
_FILES = 3
_THREADS = 8
"""By how much an engine's memory, files and threads may grow from the middle of a run to its end."""
_LINES = (
    "ros2 node list",
    "ros2 topic list -t",
    "ros2 topic info /odom",
    "ros2 topic echo /odom --once",
    "ros2 topic hz /scan",
    "ros2 service list",
    "ros2 service call /motor_power std_srvs/srv/SetBool '{data: true}'",
    "ros2 service call /reset_world std_srvs/srv/Empty",
    "ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.1}}'",
    "ros2 topic pub -r 20 /chatter std_msgs/msg/String '{data: hello}'",
    "ros2 param list",
    "ros2 interface show std_srvs/srv/SetBool",
    "ros2 nonsense",
)


class Choice(NamedTuple):
    """A run that was chosen; ``repeats`` tells whether the same comes of it each time.

    A lesson of the real clock shows how fast the machine computes, and says so in its log.
    """

    setup: RunSetup
    repeats: bool


@dataclass
class Came:
    """What came of one run: its length (nanoseconds), its events' digest, and sentences on what is wrong."""

    title: str
    length: int = 0
    events: int = 0
    messages: int = 0
    digest: str = ""
    troubles: list[str] = field(default_factory=list)
    footprints: list[Footprint] = field(default_factory=list)


def choose(seed: int, number: int, longest: float) -> Choice:
    """Choose a run: the lessons in turn, all else at random; the same seed and number choose the same."""
    chance = Random(f"{seed}/{number}")
    every = lessons()
    lesson = every[number % len(every)]
    repeats = lesson.setup.clock == "virtual"
    seconds = min(chance.choice(_LENGTHS if repeats else _LENGTHS[:1]), longest)
    chosen = msgspec.structs.replace(
        setup_for(lesson, threads=chance.choice((None, 1, 2, 4, 8)), speed=None),
        clock="virtual",
        until=round(seconds * SECOND),
        seed=chance.choice((None, chance.randrange(1, 1000))),
        sensor_rate=chance.choice((None, None, 1.0, 5.0, 50.0)),
        contents=chance.random() < 0.2,
        groups=_groups(chance, lesson),
        periods=_periods(chance, lesson),
        calls=tuple(TimedCall(at, chance.random() < 0.6) for at in _moments(chance, seconds, 12)),
        lines=tuple(TimedLine(at, chance.choice(_LINES)) for at in _moments(chance, seconds, 6)),
    )
    return Choice(chosen, repeats)


def _moments(chance: Random, seconds: float, most: int) -> Sequence[int]:
    return sorted(round(chance.uniform(0.1, seconds) * SECOND) for _ in range(chance.randrange(most)))


def _callbacks(lesson: Lesson) -> list[str]:
    return re.findall(r"def (\w*callback\w*)\(", lesson.node_path.read_text(encoding="utf-8"))


def _groups(chance: Random, lesson: Lesson) -> tuple[GroupChange, ...]:
    changed = [each for each in _callbacks(lesson) if chance.random() < 0.2]
    return tuple(GroupChange("", each, chance.choice(GROUP_CHOICES)) for each in changed)


def _periods(chance: Random, lesson: Lesson) -> tuple[PeriodChange, ...]:
    changed = [each for each in _callbacks(lesson) if "timer" in each and chance.random() < 0.3]
    return tuple(PeriodChange("", each, round(chance.uniform(0.05, 3) * SECOND)) for each in changed)


def run_twice(chosen: Choice) -> Came:
    """Run what was chosen in two engines at once; the second has to give the same bytes, if it can."""
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(_Run.whole, [_Run(chosen.setup) for _ in range(2)])
    if chosen.repeats and first.digest != second.digest:
        first.troubles.append(f"the second run differs: {first.events} events, then {second.events}")
    first.troubles += [each for each in second.troubles if each not in first.troubles]
    return first


class _Run:
    """One run, followed on the session's reader thread."""

    def __init__(self, chosen: RunSetup) -> None:
        self._came = Came(chosen.title)
        self._lines = JsonLines()
        self._digest = hashlib.sha256()
        self._counts = MessageCounts()
        self._news: Queue[list[AnyEvent] | str | None] = Queue(64)
        self._session = ProcessSession(chosen, self._news.put, self._news.put)
        self._next_look = 0
        self._lost = 0

    def whole(self) -> Came:
        came = self._came
        self._session.start()
        try:
            self._follow()
        except Empty:
            came.troubles.append(f"no word for {_PATIENCE:g} s at {came.length / SECOND:.3f} s")
        finally:
            self._session.stop()
        self._counts.finish()
        came.troubles += self._counts.faults
        if self._lost:
            came.troubles.append(f"{self._lost} events were lost")
        came.troubles += _grown(came.footprints)
        came.messages, came.digest = self._counts.messages, self._digest.hexdigest()
        return came

    def _follow(self) -> None:
        while isinstance(events := self._news.get(timeout=_PATIENCE), list):
            self._take(events)
        if events is not None:
            self._came.troubles.append(events)

    def _take(self, events: list[AnyEvent]) -> None:
        came = self._came
        for line in self._lines.lines(events):
            self._digest.update(line)
        self._counts.take(events)
        came.events += len(events)
        came.length = events[-1].t
        self._lost = max([self._lost, *(event.count for event in events if isinstance(event, EventsLost))])
        if came.length >= self._next_look and not isinstance(events[-1], RunEnded):
            self._next_look = came.length + _LOOK
            now = footprint(self._session._tree.pid)
            if now is not None and now.memory:  # one that has ended has none
                came.footprints.append(now)


def _grown(footprints: Sequence[Footprint]) -> list[str]:
    allowed = {"memory": _MEMORY, "threads": _THREADS, "files": _FILES}
    grown = {name: growth([getattr(each, name) for each in footprints]) for name in allowed}
    return [f"the engine's {name} grew by {by:g}" for name, by in grown.items() if by > allowed[name]]
