"""When a callback or a program came to the line at which it waits is known, however late anybody looks."""

import sys
import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from sim.clock.paced import PacedClock
from sim.clock.paced_stdlib import PacedLock, PacedRLock
from sim.engine.callback_positions import CallbackPositions, wait_began
from sim.engine.own_threads import OwnThreads
from sim.interpreter.function_marks import calls_the_program
from sim.probes.probe import RunningCallback
from sim.trace.events import Doing, ProgramAt
from tests.support.builder import ns

_HOLDER = RunningCallback(entity=2, thread=2, begun=1)
_PATIENCE = 60.0
WAYS = "signal", "sleep", "lock", "lock with a timeout", "reentrant lock"


class SetClock(PacedClock):
    """A clock that shows what a test has set it to."""

    moment = ns(1.0)

    def now(self) -> int:
        return self.moment


def callback(wait: Callable[[], object]) -> None:
    wait()


class Waiter:
    """A thread whose callback, of entity 1, waits since 1 s; ``seen`` is what is recorded of it."""

    def __init__(self, clock: SetClock, wait: Callable[[], object]) -> None:
        self._clock = clock
        self.seen: list[Any] = []
        self.thread = threading.Thread(target=self._call, args=(wait,), daemon=True)
        probe: Any = SimpleNamespace(running=self._running, threads=dict)
        self.positions = CallbackPositions(probe, clock, self.seen.append)
        clock.on_long_wait = self.positions.look_back
        self.thread.start()
        while not wait_began(sys._current_frames().get(self.thread.ident or 0)):
            self.thread.join(0.001)

    @calls_the_program
    def _call(self, wait: Callable[[], object]) -> None:
        callback(wait)

    def _running(self) -> dict[int, RunningCallback]:
        return {self.thread.ident or 0: RunningCallback(entity=1, thread=1, begun=1)}


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SetClock:
    clock = SetClock()
    clock.activity = lambda: _HOLDER
    for kind in (PacedLock, PacedRLock):
        monkeypatch.setattr(kind, "_clock", clock, raising=False)
    return clock


def _waits(clock: SetClock) -> dict[str, tuple[Callable[[], object], Callable[[], object]]]:
    """Ways to wait, each with what ends the wait."""
    signal, lock, again = clock.auto_reset_event(), PacedLock(), PacedRLock()
    lock.__enter__()
    again.__enter__()
    ways = (
        (lambda: signal.wait(None), signal.set),
        (lambda: clock.sleep(ns(4.0)), lambda: next(iter(clock._sleepers)).ring()),
        (lock.__enter__, lock.release),
        (lambda: lock.acquire(timeout=4.5), lock.release),
        (again.acquire, again.release),
    )
    return dict(zip(WAYS, ways, strict=True))


@pytest.mark.parametrize("way", WAYS)
def test_a_wait_that_is_found_late_is_dated_from_when_it_began(clock: SetClock, way: str) -> None:
    wait, end = _waits(clock)[way]
    waiter = Waiter(clock, wait)
    clock.moment = ns(5.0)
    waiter.positions.look()
    end()
    waiter.thread.join(_PATIENCE)
    assert [each.t for each in waiter.seen] == [ns(1.0)]


@pytest.mark.parametrize("way", WAYS)
def test_a_wait_that_nobody_saw_is_recorded_as_it_ends(clock: SetClock, way: str) -> None:
    wait, end = _waits(clock)[way]
    waiter = Waiter(clock, wait)
    clock.moment = ns(5.0)
    end()
    waiter.thread.join(_PATIENCE)
    assert [(each.t, each.doing) for each in waiter.seen][1:] == [(ns(5.0), Doing.COMPUTES)]
    assert waiter.seen[0].t == ns(1.0)
    if "lock" in way:
        (at,) = (each for each in waiter.seen if each.doing is Doing.WAITS)
        assert (at.call, at.holder, at.keeper) == ("Lock.acquire", _HOLDER.thread, 0)


def test_a_callback_that_is_found_elsewhere_late_has_gone_on_when_its_wait_was_over(clock: SetClock) -> None:
    wait, end = _waits(clock)["signal"]
    went_on, over = threading.Event(), threading.Event()

    def wait_and_compute() -> None:
        wait()
        went_on.set()
        over.wait(_PATIENCE)

    waiter = Waiter(clock, wait_and_compute)
    waiter.positions.look()
    clock.moment = ns(2.0)
    end()
    went_on.wait(_PATIENCE)
    clock.moment = ns(5.0)
    waiter.positions.look()
    over.set()
    waiter.thread.join(_PATIENCE)
    assert [each.t for each in waiter.seen] == [ns(1.0), ns(2.0), ns(5.0)]
    assert waiter.seen[1].doing is Doing.COMPUTES


def test_a_wait_of_a_program_that_is_found_late_is_dated_from_when_it_began(clock: SetClock) -> None:
    wait, end = _waits(clock)["signal"]
    waiter, told = Waiter(clock, wait), list[Any]()
    probe: Any = SimpleNamespace(running=dict, threads=dict)
    program: Any = SimpleNamespace(spinning=False, number=0)
    watch = OwnThreads(probe, clock, told.append, lambda: [(waiter.thread.ident or 0, program)])
    clock.moment = ns(5.0)
    watch.look()
    end()
    waiter.thread.join(_PATIENCE)
    assert [(each.t, type(each)) for each in told] == [(ns(1.0), ProgramAt)]
