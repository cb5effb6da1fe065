"""The watchdog: a program that stands still outside virtual time is noticed and its place is named."""

import threading
from queue import Queue

import pytest

from sim.clock import VirtualClock
from sim.engine.watchdogs import outside_time as watchdog
from sim.engine.watchdogs.outside_time import Watchdog
from sim.trace.events import AnyEvent, Notice


def test_a_thread_that_never_comes_to_a_wait_is_named_with_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watchdog, "_LOOK", 0.01)
    told: Queue[AnyEvent] = Queue()
    given_up: Queue[str] = Queue()
    outside = threading.Event()
    Watchdog(VirtualClock(), told.put, lambda _: 0, given_up.put, lambda _: None).start()
    for queue in (told, given_up):
        while queue.empty():
            outside.wait(0.01)
    notice = told.get()
    assert isinstance(notice, Notice)
    assert "MainThread does not come to a wait (test_watchdog.py:" in notice.text
    assert notice.text.endswith("mend it, or run the file by itself with --clock real")
    assert given_up.get().startswith("MainThread does not come to a wait")


def test_a_run_that_rests_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watchdog, "_LOOK", 0.01)
    told: Queue[AnyEvent] = Queue()
    clock = VirtualClock()
    clock.time._inbox.rests = True
    Watchdog(clock, told.put, lambda _: 0, lambda _: None, lambda _: None).start()
    threading.Event().wait(0.2)
    assert told.empty()
