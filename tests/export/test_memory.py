"""What is written while events go by needs no more memory for a longer run."""

import gc
import tracemalloc
from collections.abc import Callable
from io import RawIOBase, TextIOWrapper
from typing import IO, Any, cast

import pytest

from sim.export.chrome import ChromeFile
from sim.export.csv import CallTable
from sim.export.perfetto import PerfettoFile
from sim.export.trace_exporter import TraceExporter
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    EntityReady,
    Published,
    Reason,
    WaitEnded,
    WaitStarted,
)
from tests.support.daily import first_daily
from tests.trace.systems import System

STEP = 20_000_000


class Nowhere(RawIOBase):
    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        return len(data)


def second(first: int) -> list[AnyEvent]:
    events: list[AnyEvent] = []
    for message in range(first, first + 50):
        t = message * STEP
        events += (
            Published(t, message, "/topic1", 0, 0),
            EntityReady(t, 1, 1, message),
            WaitStarted(t, 1, t, Reason.NO_FREE_WORKER, 0, True),
            WaitEnded(t + 10, 1),
            CallbackStarted(t + 10, 1, 1, message, 10, 0),
            CallbackEnded(t + 20, 1, 1),
        )
    return events


def peak(make: Callable[[IO[bytes]], TraceExporter | CallTable], seconds: int) -> int:
    tracemalloc.start()
    export = make(cast("IO[bytes]", Nowhere()))
    export.take(System().events)
    for number in range(seconds):
        export.take(second(number * 50 + 1))
    export.finish()
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return most


@pytest.mark.slow
@pytest.mark.parametrize(
    "make",
    first_daily(
        lambda file: TraceExporter(PerfettoFile(file)),
        lambda file: TraceExporter(ChromeFile(file)),
        lambda file: CallTable(TextIOWrapper(file, "utf-8", newline="")),
    ),
    ids=["perfetto", "chrome", "csv"],
)
def test_memory_does_not_grow_with_the_run(make: Callable[[IO[bytes]], TraceExporter | CallTable]) -> None:
    gc.collect()  # what others left is not to be cleared away in the midst of measuring
    peak(make, 40)  # fills what is kept once and for all
    assert peak(make, 40) < 1.2 * peak(make, 20)
