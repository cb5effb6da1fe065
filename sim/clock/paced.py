"""Wall time that can be paused, slowed down and sped up. Threads run freely; their waits are scaled."""

import math
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from sim.interpreter.function_marks import notes_begin, waits_for_time

# Kept from before sim.clock.paced_stdlib puts its own in their place.
_monotonic_ns = time.monotonic_ns
_sleep = time.sleep
_allocate_lock = threading.Lock
_Thread = threading.Thread

_LONG_WAIT = 100_000_000
"""Nanoseconds of a wait that is told of as it ends."""
_ASIDE = 20e-6
"""Seconds between two attempts to read the time while another thread changes the pace."""


class PacedAutoResetEvent:
    """An auto-reset event on the machine's own locks, whose deadline is a moment of a paced clock."""

    __slots__ = ("_bell", "_clock", "_is_set")

    def __init__(self, clock: "PacedClock") -> None:
        self._clock = clock
        self._is_set = False
        self._bell = _allocate_lock()
        self._bell.acquire()

    @notes_begin
    def wait(self, deadline: int | None) -> bool:
        """Wait until set, or until the clock shows ``deadline``; True if it was set."""
        since = self._clock.now()
        is_set = self._wait_for_ever() if deadline is None else self._wait_until(deadline)
        self._clock.end_wait(since)
        if is_set:
            self._is_set = False
        return is_set

    def _wait_for_ever(self) -> bool:
        self._bell.acquire()
        while not self._is_set:
            self._bell.acquire()
        return True

    @waits_for_time
    def _wait_until(self, deadline: int) -> bool:
        clock, bell = self._clock, self._bell
        clock._sleepers.add(self)
        try:
            while True:
                seconds = clock.wall_seconds_until(deadline)
                bell.acquire(timeout=min(max(seconds, 0.0), threading.TIMEOUT_MAX))
                if self._is_set:
                    return True
                if seconds <= 0:
                    return False
        finally:
            clock._sleepers.discard(self)

    def set(self) -> None:
        """Set the flag; setting it twice has the effect of once."""
        self._is_set = True
        bell = self._bell
        if bell.locked():
            try:
                bell.release()
            except RuntimeError:  # another thread released it after locked() was read
                return

    def ring(self) -> None:
        """Make a waiting thread read the clock again."""
        with suppress(RuntimeError):  # it is released already
            self._bell.release()


class _Rate(NamedTuple):
    """From wall time ``wall`` on, when the clock shows ``run``, it advances ``speed`` seconds per second."""

    run: int
    wall: int
    speed: float


class PacedClock:
    """The machine's monotonic clock, counted from its creation, at a speed. Thread-safe.

    A thread that computes cannot be stopped: it continues while the clock is paused, and sees no time pass.
    """

    def __init__(self, speed: float = 1.0) -> None:
        self.epoch = time.time_ns()
        self.origin = _monotonic_ns()
        """The machine's monotonic time at which the run began."""
        self.activity: Callable[[], object] = lambda: None
        self.on_long_wait: Callable[[], None] = lambda: None
        """Called on a thread whose long wait ends."""
        self._sleepers: set[PacedAutoResetEvent] = set()
        self._changing = _allocate_lock()
        self._paused = False
        self._speed = speed
        self._rate: _Rate | None = _Rate(0, self.origin, speed)
        self._began: Any = self.origin if speed == 1 else None
        """``origin`` as long as the clock has always had the machine's pace; None after the first change.
        """

    def now(self) -> int:
        """Nanoseconds of this clock since its creation."""
        try:
            now: int = _monotonic_ns() - self._began
        except TypeError:  # every callback reads the time several times, and a test for None would be slower
            return self._scaled_now()
        return now

    def _scaled_now(self) -> int:
        while True:
            rate = self._rate
            if rate is None:
                _sleep(_ASIDE)
                continue
            now = _at(rate, _monotonic_ns())
            if self._rate is rate:  # otherwise the clock may have been paused before that reading
                return now

    def end_wait(self, since: int) -> None:
        """The calling thread, which has waited since then, is about to go on."""
        if self.now() - since >= _LONG_WAIT:
            self.on_long_wait()

    def wall_seconds_until(self, moment: int) -> float:
        """Real seconds until the clock shows ``moment`` at its present pace; infinite while it is paused."""
        left = moment - self.now()
        if self._began is not None or left <= 0:
            return left / 1e9
        return math.inf if self._paused else left / self._speed / 1e9

    @waits_for_time
    def sleep(self, duration: int) -> None:
        """Let ``duration`` nanoseconds of this clock pass."""
        if duration > 0:
            PacedAutoResetEvent(self).wait(self.now() + duration)
        else:
            _sleep(0)

    def auto_reset_event(self) -> PacedAutoResetEvent:
        """A new event, not set."""
        return PacedAutoResetEvent(self)

    def races(self) -> bool:
        """Whether the threads of a pool race: False, for real ones do."""
        return False

    def choose(self, number: int) -> int:
        """0, the first."""
        return 0

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Start an ordinary daemon thread."""
        _Thread(target=target, name=name, daemon=True).start()

    def switch_point(self) -> None:
        """Do nothing: the operating system switches threads at any time."""

    @property
    def turn(self) -> int:
        """The milliseconds so far: after a few of them Python switches to another thread."""
        return _monotonic_ns() // 1_000_000

    @property
    def runnable(self) -> int:
        """0: threads do not take turns."""
        return 0

    def poll(self) -> None:
        """Do nothing: on this clock a poll takes time."""

    def end_thread(self) -> None:
        """Do nothing: a join waits until the thread has ended."""

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt in the thread; a wait with a deadline ends first."""
        import ctypes  # rarely needed, and the console imports this module as it starts

        ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(thread), ctypes.py_object(KeyboardInterrupt)
        )
        self._wake_sleepers()

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` on a thread of its own at ``time``."""

        def wait() -> None:
            PacedAutoResetEvent(self).wait(time)
            action()

        self.start_thread(wait, "timer")

    def pause(self) -> None:
        """Pause the clock."""
        with self._changing:
            self._paused = True
            self._change_rate()

    def resume(self) -> None:
        """Resume the clock."""
        with self._changing:
            self._paused = False
            self._change_rate()

    def set_speed(self, speed: float) -> None:
        """Advance ``speed`` seconds per second; a paused clock does so once it is resumed."""
        with self._changing:
            self._speed = speed
            self._change_rate()

    def _change_rate(self) -> None:
        before = self._rate
        assert before is not None
        self._began = self._rate = None  # from here on readers of the time wait for the new rate
        wall = _monotonic_ns()
        run = _at(before, wall)
        speed = 0.0 if self._paused else self._speed
        self._rate = _Rate(run, wall, speed)
        self._wake_sleepers()

    def _wake_sleepers(self) -> None:
        for each in tuple(self._sleepers):
            each.ring()


def _at(rate: _Rate, wall: int) -> int:
    """The clock's reading at a wall time."""
    return rate.run + int((wall - rate.wall) * rate.speed)
