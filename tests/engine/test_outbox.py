"""The way of events out of the engine: in order, bounded, and what is thrown away is counted."""

import multiprocessing
import time
from collections import deque
from contextlib import suppress
from signal import SIGINT, pthread_kill
from threading import Thread, main_thread

import pytest

from sim.engine import outbox
from sim.engine.outbox import Outbox
from sim.trace.events import AnyEvent, EventsLost, Notice, Printed, RunEnded, TimePassed, decode


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


def test_on_the_real_clock_a_thread_that_writes_too_many_lines_is_held_up_and_none_is_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(outbox, "_LINES", 10)
    monkeypatch.setattr(outbox, "_PATIENCE", 60.0)
    monkeypatch.setattr(outbox, "_TELL", 1e-9)
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=False, before_batch=_nothing)
    lines = _lines(0, 1000)
    writer = Thread(target=lambda: deque(map(box.record, lines), 0), daemon=True)
    writer.start()
    while len(box._waiting) < 10:
        time.sleep(0.001)
    writer.join(0.05)
    assert writer.is_alive()
    box.record(TimePassed(5))
    box.start()
    told: list[AnyEvent] = []
    while len(told) < len(lines) + 2:
        told += decode(far.recv_bytes())
    writer.join()
    assert told.index(TimePassed(5)) == 10
    assert [event for event in told if isinstance(event, Printed)] == lines
    assert [event.text for event in told if isinstance(event, Notice)] == [
        "the program writes lines faster than they can be taken: what writes them is held up, "
        "as by a slow terminal; write fewer"
    ]


def test_a_line_on_the_real_clock_is_neither_held_up_nor_lost_for_many_other_events(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(outbox, "_LINES", 10)
    monkeypatch.setattr(outbox, "_BOUND", 20)
    monkeypatch.setattr(outbox, "_TELL", 1e-9)
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=False, before_batch=_nothing)
    for moment in range(22):
        box.record(TimePassed(moment))
    box.record(_lines(22, 1)[0])
    box.flush()
    others = [TimePassed(moment) for moment in range(20)]
    assert decode(far.recv_bytes()) == [*others, *_lines(22, 1), EventsLost(22, 2)]


def test_nobody_who_reads_holds_up_a_line_for_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outbox, "_LINES", 10)
    monkeypatch.setattr(outbox, "_BOUND", 12)
    monkeypatch.setattr(outbox, "_PATIENCE", 0.01)
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=False, before_batch=_nothing)
    for line in _lines(0, 14):
        box.record(line)
    box.flush()
    assert decode(far.recv_bytes()) == [*_lines(0, 12), EventsLost(11, 2)]


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


def test_an_interrupt_waits_until_a_batch_is_sent_whole() -> None:
    far, near = multiprocessing.Pipe()
    box = Outbox(near, may_wait=True, before_batch=_nothing, pack=lambda _: bytes(1 << 24))
    box.record(TimePassed(5))
    received: list[int] = []

    def interrupt_and_read() -> None:
        far.poll(None)  # it is being sent, and does not fit into the pipe
        pthread_kill(main_thread().ident or 0, SIGINT)
        with suppress(EOFError):
            received.append(len(far.recv_bytes()))

    reader = Thread(target=interrupt_and_read)
    reader.start()
    with pytest.raises(KeyboardInterrupt):
        box.flush()
    near.close()
    reader.join()
    assert received == [1 << 24]
