"""The way of events out of the engine: in order, bounded, and what is thrown away is counted."""

import multiprocessing

import pytest

from sim.engine import outbox
from sim.engine.outbox import Outbox
from sim.trace.events import AnyEvent, EventsLost, Printed, RunEnded, TimePassed, decode


def _lines(first: int, count: int) -> list[AnyEvent]:
    return [Printed(number, "line", error=False) for number in range(first, first + count)]


def _nothing() -> None:
    """Stand in for what runs before a batch."""


def test_on_the_real_clock_recording_never_waits_and_what_overflows_is_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(outbox, "_BOUND", 10)
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=False, before_batch=_nothing)
    for event in _lines(0, 13):
        box.record(event)
    box.flush()
    assert decode(far.recv_bytes()) == [*_lines(0, 10), EventsLost(9, 3)]
    box.record(_lines(20, 1)[0])
    box.flush()
    assert decode(far.recv_bytes()) == _lines(20, 1)


def test_on_virtual_time_a_full_batch_is_sent_by_whoever_records(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outbox, "_BATCH", 4)
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=True, before_batch=_nothing)
    for event in _lines(0, 6):
        box.record(event)
    assert decode(far.recv_bytes()) == _lines(0, 4)
    assert not far.poll()
    box.close(RunEnded(7, "done", failed=False))
    box.record(_lines(8, 1)[0])
    assert decode(far.recv_bytes()) == [*_lines(4, 2), RunEnded(7, "done", failed=False)]


def test_a_heartbeat_tells_of_time_while_nothing_happens_and_is_the_last_of_nothing() -> None:
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=False, before_batch=_nothing, heartbeat=lambda: [TimePassed(5)])
    box.start()
    assert [decode(far.recv_bytes()) for _ in range(3)] == [[TimePassed(5)]] * 3
    box.record(Printed(6, "line", error=False))
    box.close(RunEnded(7, "done", failed=False))
    while not isinstance((batch := decode(far.recv_bytes()))[-1], RunEnded):
        assert batch in ([TimePassed(5)], [Printed(6, "line", error=False)])
    assert not far.poll(0.3)


def test_a_reader_that_has_gone_away_is_no_error() -> None:
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=True, before_batch=_nothing)
    far.close()
    box.record(_lines(0, 1)[0])
    box.flush()
    box.close(RunEnded(1, "done", failed=False))
