"""What it costs to go to any moment of a long run: all that the panes ask of it."""

import random
import time
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

from msgspec.structs import replace

from sim.trace import events as ev
from sim.trace.events import AnyEvent
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline
from tests.support.engine_runs import SECOND, run_lesson

_LESSON = "split-groups"
_ROUND = 60
"""Seconds of the lesson that are run; a longer run repeats them."""
_BATCH = 2000
_SEEKS = 300
_ON_SCREEN = 10 * SECOND
_LOG_LINES = 40

_ONCE = (
    ev.RunStarted,
    ev.RunEnded,
    ev.ThreadAppeared,
    ev.ExecutorAppeared,
    ev.NodeAppeared,
    ev.GroupAppeared,
    ev.EntityAppeared,
    ev.ArenaShown,
)
_NUMBERS = ("message", "call")


def seeking(seconds: int) -> float:
    """The seconds of processor that 99 of 100 seeks stay within, in so many seconds of the lesson."""
    timeline = _long_run(seconds)
    chance = random.Random(seconds)
    took = sorted(_seek(timeline, chance.randint(0, timeline.end)) for _ in range(_SEEKS))
    return took[round(0.99 * (len(took) - 1))]


def _seek(timeline: Timeline, at: Nanoseconds) -> float:
    began = time.process_time()
    _look(timeline, at)
    return time.process_time() - began


def _look(timeline: Timeline, at: Nanoseconds) -> None:
    """Ask what a screen shows that was moved to ``at``, and look at every part of the answers."""
    window = Window(max(0, at - _ON_SCREEN), at + 1)
    moment = timeline.moment(at)
    for queue in moment.queues.values():
        _all(queue.messages)
    for thread in timeline.threads:
        _all(timeline.spans_on(thread, window))
        _all(timeline.blocks_on(thread, window))
        timeline.busy(thread, window)
    for group in timeline.groups:
        _all(timeline.spans_in(group, window))
    for entity in timeline.entities:
        _all(timeline.waits_of(entity, window))
        timeline.drops_of(entity, window)
    _all(timeline.marks(window))
    _all(timeline.trail(window))
    written = timeline.logs_until(at)
    _all(timeline.logs[max(0, written - _LOG_LINES) : written])
    timeline.robot(at), timeline.command(at), timeline.scan(at), timeline.scan_seen(at)
    timeline.dropped(at)
    timeline.neighbour(at, 1), timeline.neighbour(at, -1)


def _all(answer: Sequence[object]) -> None:
    for _ in answer:
        pass


@lru_cache(maxsize=1)
def _long_run(seconds: int) -> Timeline:
    timeline = Timeline()
    batch: list[AnyEvent] = []
    for event in events(seconds):
        batch.append(event)
        if len(batch) == _BATCH:
            timeline.extend(batch)
            batch = []
    timeline.extend(batch)
    return timeline


def events(seconds: int) -> Iterator[AnyEvent]:
    """The lesson's events, again and again with times and numbers that go on."""
    first = run_lesson(_LESSON, min(seconds, _ROUND), 2.0).events
    repeated = [event for event in first if not isinstance(event, _ONCE)]
    step = 1 + max(number for event in first for number in _numbers(event).values())
    yield from (event for event in first if not isinstance(event, ev.RunEnded))
    for number in range(1, seconds // _ROUND):
        for event in repeated:
            yield _moved(event, number * _ROUND * SECOND, number * step)


def _moved(event: AnyEvent, by: Nanoseconds, step: int) -> AnyEvent:
    changes: dict[str, Any] = {name: number + step for name, number in _numbers(event).items() if number}
    if isinstance(event, ev.WaitStarted):
        changes["since"] = event.since + by
    return replace(event, t=event.t + by, **changes)


def _numbers(event: AnyEvent) -> dict[str, int]:
    """The numbers of messages and calls in an event; a field of that name may be a function's name, too."""
    found = {name: getattr(event, name, 0) for name in _NUMBERS}
    return {name: number for name, number in found.items() if isinstance(number, int)}
