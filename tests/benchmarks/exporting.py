"""What taking a run to other programs costs: events as a busy lesson has them, through each exporter."""

import time
from collections.abc import Callable, Sequence
from functools import lru_cache
from io import TextIOWrapper
from tempfile import TemporaryFile
from typing import IO, Protocol

from sim.export.chrome import ChromeFile
from sim.export.csv import CallTable
from sim.export.markdown import report
from sim.export.perfetto import PerfettoFile
from sim.export.svg import svg
from sim.export.trace_exporter import TraceExporter
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    EntityAppeared,
    EntityKind,
    EntityReady,
    GroupAppeared,
    GroupKind,
    Logged,
    NodeAppeared,
    Published,
    Reason,
    RobotMoved,
    RunStarted,
    Severity,
    ThreadAppeared,
    WaitEnded,
    WaitStarted,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

_MILLION = 1_000_000
_BATCH = 200
_SUBSCRIPTIONS = 5
_STEP = 2_000_000
"""Nanoseconds between messages."""

Batches = Sequence[list[AnyEvent]]


class _Export(Protocol):
    def take(self, events: Sequence[AnyEvent]) -> None: ...
    def finish(self) -> None: ...


def perfetto(events: int) -> float:
    """The seconds of processor that a million events take into a Perfetto trace."""
    return _through(lambda file: TraceExporter(PerfettoFile(file)), events)


def chrome(events: int) -> float:
    """The seconds of processor that a million events take into Chrome's format."""
    return _through(lambda file: TraceExporter(ChromeFile(file)), events)


def csv(events: int) -> float:
    """The seconds of processor that a million events take into a table."""
    return _through(lambda file: CallTable(TextIOWrapper(file, "utf-8", newline="")), events)


def pages(events: int) -> float:
    """The seconds of processor that a timeline of a million events, its picture and its report take."""
    batches = _batches(events)
    began = time.process_time()
    timeline = Timeline()
    for batch in batches:
        timeline.extend(batch)
    svg(timeline, Window(0, timeline.end + 1))
    report(timeline)
    return (time.process_time() - began) / events * _MILLION


def _through(make: Callable[[IO[bytes]], _Export], events: int) -> float:
    batches = _batches(events)
    with TemporaryFile() as file:
        began = time.process_time()
        export = make(file)
        for batch in batches:
            export.take(batch)
        export.finish()
        return (time.process_time() - began) / events * _MILLION


@lru_cache(maxsize=2)
def _batches(events: int) -> Batches:
    """So many events in batches as the engine sends them."""
    made = _cast()
    message = 0
    while len(made) < events:
        message += 1
        made += _delivery(message * _STEP, message, message % _SUBSCRIPTIONS + 1)
    return [made[start : min(start + _BATCH, events)] for start in range(0, events, _BATCH)]


def _cast() -> list[AnyEvent]:
    entities = [
        EntityAppeared(
            0, entity, 1, 1, EntityKind.SUBSCRIPTION, f"/t{entity}", f"on_{entity}", "node.py", 1, 2, 10, 0
        )
        for entity in range(1, _SUBSCRIPTIONS + 1)
    ]
    return [
        RunStarted(0, "busy", "virtual", 0),
        NodeAppeared(0, 1, "/node"),
        ThreadAppeared(0, 1, "MainThread"),
        GroupAppeared(0, 1, 1, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
        *entities,
    ]


def _delivery(t: int, message: int, entity: int) -> list[AnyEvent]:
    """A message comes, waits a little, and is taken by a callback; now and then the robot moves and logs."""
    events: list[AnyEvent] = [
        Published(t, message, f"/t{entity}", 0, 0),
        EntityReady(t, entity, 1, message),
        WaitStarted(t, entity, t, Reason.GROUP_HELD, 1, False),
        WaitEnded(t + 5_000, entity),
        CallbackStarted(t + 5_000, entity, 1, message, 5_000, 0),
        CallbackEnded(t + 50_000, entity, 1),
    ]
    if message % 10 == 0:
        x = t * 1e-10
        events.append(Logged(t + 50_000, Severity.INFO, "node", f"at {x:.2f} m", 1, entity))
        events.append(RobotMoved(t + 60_000, x, 0.0, 0.0, 1.0, 0.1, 0.0, True, False, 0.0, x))
    return events
