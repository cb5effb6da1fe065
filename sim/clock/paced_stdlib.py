"""Makes Python's waits follow a paced clock: sleep, time, timeouts of locks, threads and queues.

They are replaced once, in the engine process, before the program is imported; the engine's own modules have
kept the real ones. Events, conditions, semaphores, barriers, timers, queues and futures follow by
themselves, since Python builds them on what is replaced here.
"""

import queue
import sys
import threading
import time
from collections.abc import Callable
from threading import get_ident
from types import CodeType, FrameType, TracebackType
from typing import Any

from sim.clock.paced import PacedClock
from sim.interpreter.function_marks import asks_time, notes_begin, waits_for_time
from sim.interpreter.guarding import takes_to_guard
from sim.quantities.nanoseconds import wait_ns

_allocate_lock = threading.Lock
_RLock: Any = type(threading.RLock())
_thread_join = threading.Thread.join
_active_threads: dict[int, threading.Thread] = threading._active  # type: ignore[attr-defined]
_LIBRARY = {threading.__file__, queue.__file__}
_PASSED = {*_LIBRARY, __file__}

_SLICE = 0.02
"""Real seconds between two checks of a timeout: the pace may have changed."""


def follow(clock: PacedClock) -> None:
    """Replace Python's waits with paced ones, for this process and permanently."""
    PacedLock._clock = PacedRLock._clock = clock
    _replace_time(clock)
    threading_module: Any = threading
    threading_module.Lock = PacedLock
    threading_module._allocate_lock = PacedLock
    threading_module.RLock = PacedRLock
    threading_module._CRLock = PacedRLock
    threading_module.Thread.join = _paced_join(clock)
    queues: Any = queue
    queues.SimpleQueue = queues._PySimpleQueue


class PacedLock:
    """``threading.Lock`` whose timeout is seconds of a paced clock."""

    _clock: PacedClock
    __slots__ = (
        "__weakref__",
        "_lock",
        "holder_ident",
        "locked",
        "release",
        "taken_at",
        "taken_by",
        "taken_during",
    )

    def __init__(self) -> None:
        lock = _allocate_lock()
        self._lock = lock
        self.locked = lock.locked
        self.release = lock.release
        self.holder_ident = 0
        """The identifier of the thread that took the lock to guard something; 0 if it may be a signal."""
        self.taken_at: tuple[CodeType, int] | None = None
        self.taken_by: threading.Thread | None = None
        self.taken_during: object = None

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Take the lock; False if it is not available at once (or within ``timeout`` seconds)."""
        taken = _take(self._lock.acquire, blocking, timeout, self._clock)
        if taken:
            taker = sys._getframe(1)
            guards = taker.f_code.co_filename not in _LIBRARY and takes_to_guard(taker)
            _note_taking(self, taker, self._clock)
            if not guards:
                self.holder_ident = 0  # another thread may release it
        return taken

    def __enter__(self) -> bool:
        _take(self._lock.acquire, True, -1, self._clock)
        _note_taking(self, sys._getframe(1), self._clock)
        return True

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._lock.release()

    def _at_fork_reinit(self) -> None:
        lock: Any = self._lock
        lock._at_fork_reinit()  # in place: conditions keep the bound release of this lock


class PacedRLock(_RLock):  # type: ignore[misc]
    """``threading.RLock`` whose timeout is seconds of a paced clock."""

    _clock: PacedClock
    holder_ident = 0
    """The identifier of the thread that last took the lock."""
    taken_at: tuple[CodeType, int] | None = None
    taken_by: threading.Thread | None = None
    taken_during: object = None

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Take the lock once more; False if it is not available at once (or within ``timeout`` seconds)."""
        again = self._is_owned()
        taken = _take(super().acquire, blocking, timeout, self._clock)
        if taken and not again:
            _note_taking(self, sys._getframe(1), self._clock)
        return taken

    def __enter__(self) -> bool:
        return self.acquire()

    def _acquire_restore(self, state: object) -> None:
        super()._acquire_restore(state)
        _note_taking(self, sys._getframe(1), self._clock)


def _note_taking(lock: PacedLock | PacedRLock, frame: FrameType, clock: PacedClock) -> None:
    """Record which thread took a lock, during what, and where: the first frame outside the library."""
    lock.holder_ident = ident = get_ident()
    lock.taken_by = _active_threads.get(ident)
    lock.taken_during = clock.activity()
    while frame.f_code.co_filename in _PASSED and frame.f_back is not None:
        frame = frame.f_back
    lock.taken_at = frame.f_code, frame.f_lasti


@notes_begin
def _take(acquire: Callable[..., bool], blocking: bool, timeout: float, clock: PacedClock) -> bool:
    """Call the ``acquire`` of a lock with a timeout on a clock; nobody waits for a lock that is free."""
    if not blocking or (timeout <= 0 and timeout != -1):
        return acquire(blocking, timeout)
    if acquire(False):
        return True
    since = clock.now()
    taken = acquire() if timeout == -1 else _within(timeout, clock, lambda left: acquire(timeout=left))
    clock.end_wait(since)
    return taken


@waits_for_time
def _within(timeout: float, clock: PacedClock, attempt: Callable[[float], bool]) -> bool:
    """Retry ``attempt``, each time for some real seconds, until it succeeds or the timeout is over."""
    deadline = clock.now() + wait_ns(timeout)
    while not attempt(min(max(clock.wall_seconds_until(deadline), 0.0), _SLICE)):
        if clock.now() >= deadline:
            return False
    return True


def _paced_join(clock: PacedClock) -> Callable[[threading.Thread, float | None], None]:
    @notes_begin
    def join(thread: threading.Thread, timeout: float | None = None) -> None:
        since = clock.now()

        def attempt(seconds: float) -> bool:
            _thread_join(thread, seconds)
            return not thread.is_alive()

        if timeout is None or timeout <= 0:
            _thread_join(thread, timeout)
        else:
            _within(timeout, clock, attempt)
        clock.end_wait(since)

    return join


def _replace_time(clock: PacedClock) -> None:
    @waits_for_time
    def sleep(seconds: float) -> None:
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        clock.sleep(wait_ns(seconds))

    origin = clock.origin
    modules: Any = (time, threading, queue)
    modules[0].sleep = sleep
    modules[0].monotonic = modules[0].perf_counter = asks_time(lambda: (origin + clock.now()) / 1e9)
    modules[0].monotonic_ns = modules[0].perf_counter_ns = asks_time(lambda: origin + clock.now())
    modules[0].time = asks_time(lambda: (clock.epoch + clock.now()) / 1e9)
    modules[0].time_ns = asks_time(lambda: clock.epoch + clock.now())
    modules[1]._time = modules[2].time = time.monotonic
