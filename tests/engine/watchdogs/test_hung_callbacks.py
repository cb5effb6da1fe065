"""A call on the real clock that does not go on is reported, and none that waits for its turn."""

import threading
from collections.abc import Callable
from contextlib import suppress

import pytest

from sim.clock.paced import PacedClock
from sim.clock.paced_stdlib import PacedLock
from sim.engine.watchdogs.hung_callbacks import HungCallbacks
from sim.interpreter.function_marks import calls_the_program
from sim.probes.probe import RunningCallback
from sim.trace.events import AnyEvent, Notice, NoticeKind

LOOKS = 6
"""The looks after which a hung call is reported."""
PATIENCE = 60.0
"""Real seconds in which what was to happen must have happened."""


@calls_the_program
def call(work: Callable[[], object]) -> None:
    work()


class Callers:
    """Two calls that wait for a lock, which the test has; each keeps it until the test is over."""

    def __init__(self) -> None:
        self.lock, self._over = PacedLock(), threading.Event()
        self.lock.__enter__()
        self._threads = [threading.Thread(target=call, args=(self._work,)) for _ in range(2)]
        for thread in self._threads:
            thread.start()
        threading.Event().wait(0.1)

    def hand_on(self) -> None:
        """Let one of them have the lock."""
        taken = self.lock.taken_at
        self.lock.release()
        while self.lock.taken_at is taken:
            threading.Event().wait(0.01)

    def end(self) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join(PATIENCE)

    def _work(self) -> None:
        with self.lock:
            self._over.wait(PATIENCE)


def test_who_waits_for_a_lock_is_reported_once_its_holder_has_kept_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock, told = PacedClock(), list[AnyEvent]()
    monkeypatch.setattr(PacedLock, "_clock", clock, raising=False)
    callers, watch = Callers(), HungCallbacks(clock, told.append, dict, lambda: None)

    def look(times: int) -> int:
        for _ in range(times):
            watch.look()
        return len(told)

    try:
        counts = [look(LOOKS - 1)]
        callers.hand_on()
        counts += [look(1), look(LOOKS - 2), look(1)]
    finally:
        callers.end()
    assert counts == [0, 0, 0, 2]
    assert all(isinstance(each, Notice) and "not come back since 0." in each.problem for each in told)


@pytest.mark.parametrize("is_callback", [False, True])
def test_a_callback_and_a_thread_that_want_each_others_lock_are_a_deadlock_with_both_places(
    is_callback: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock, told = PacedClock(), list[AnyEvent]()
    monkeypatch.setattr(PacedLock, "_clock", clock, raising=False)
    state, io, both = PacedLock(), PacedLock(), threading.Barrier(2)

    def take(first: PacedLock, second: PacedLock) -> None:
        with suppress(RuntimeError), first:  # the test releases a lock in its place
            both.wait(PATIENCE)
            with second:
                pass

    tick = threading.Thread(target=call, args=(lambda: take(state, io),), name="tick")
    reader = threading.Thread(target=take, args=(io, state), name="reader")
    for thread in (tick, reader):
        thread.start()
    threading.Event().wait(0.1)
    callbacks = (tick, reader) if is_callback else (tick,)
    running = {each.ident or 0: RunningCallback(7, 1, 1) for each in callbacks}
    watch = HungCallbacks(clock, told.append, lambda: running, lambda: None)
    for _ in range(LOOKS):
        watch.look()
    state.release()
    for thread in (tick, reader):
        thread.join(PATIENCE)
    [notice] = told
    assert isinstance(notice, Notice)
    if is_callback:
        assert notice.kind is NoticeKind.NO_PROGRESS
        return
    assert (notice.kind, notice.entity) == (NoticeKind.DEADLOCK, 7)
    first, second = notice.problem.split(", and ")
    for clause, who, lock, taker in (
        (first, "tick", "second", "reader"),
        (second, "reader", "second", "tick"),
    ):
        assert clause.startswith(f"{who} (test_hung_callbacks.py:")
        assert f"waits for {lock}, which {taker} took at test_hung_callbacks.py:" in clause
