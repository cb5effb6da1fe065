"""Event loops of asyncio on a run's clock, and a policy for programs that run on threads."""

import asyncio
import selectors
import sys
import threading
import warnings
from typing import Any

from sim.clock.interface import RunClock
from sim.clock.paced import PacedClock
from sim.clock.virtual import VirtualAutoResetEvent, VirtualClock
from sim.quantities.nanoseconds import wait_ns

_Ready = list[tuple[selectors.SelectorKey, int]]
_MAIN = "MainThread"
_SLICE = 0.02
"""Real seconds between checks of a wait on a paced clock: the pace may have changed."""


with warnings.catch_warnings(action="ignore"):  # deprecated since Python 3.14, to go in 3.16
    _PythonsOwn = asyncio.DefaultEventLoopPolicy


class ProgramLoops(_PythonsOwn):
    """Python's event loop policy for programs whose main threads are threads of one process.

    Before Python 3.14 each of these threads gets a loop on first access. Loops wait on ``clock``: a virtual
    clock's time passes meanwhile, and a paced clock's pace is kept.
    """

    def __init__(self, clock: RunClock) -> None:
        super().__init__()
        self._clock = clock
        self._thread = threading.local()

    def install(self) -> None:
        """Make this the policy of the process."""
        with warnings.catch_warnings(action="ignore"):
            asyncio.set_event_loop_policy(self)

    def get_event_loop(self) -> asyncio.AbstractEventLoop:
        """The calling thread's loop; a program's main thread gets a new one where Python would make one."""
        is_given = sys.version_info < (3, 14) and threading.current_thread().name == _MAIN
        if is_given and not getattr(self._thread, "was_set", False):
            self.set_event_loop(self.new_event_loop())
        return super().get_event_loop()

    def set_event_loop(self, loop: asyncio.AbstractEventLoop | None) -> None:
        """Make ``loop`` the calling thread's loop."""
        self._thread.was_set = True
        super().set_event_loop(loop)

    def new_event_loop(self) -> asyncio.AbstractEventLoop:
        """A new loop that waits on the calling thread's time."""
        if isinstance(self._clock, VirtualClock) and self._clock.owns_current_thread():
            return VirtualEventLoop(self._clock)
        if isinstance(self._clock, PacedClock):
            return asyncio.SelectorEventLoop(_PacedSelector(self._clock))
        return super().new_event_loop()


class VirtualEventLoop(asyncio.SelectorEventLoop):
    """An event loop that waits in virtual time, and in real time while it serves sockets or pipes."""

    def __init__(self, clock: VirtualClock) -> None:
        self._waiting = _VirtualSelector(clock)
        super().__init__(self._waiting)

    def _write_to_self(self) -> None:
        """Called by asyncio when another thread schedules something on this loop."""
        self._waiting.wake()
        if self._waiting.reaches_outside:
            loop: Any = super()
            loop._write_to_self()


class _PacedSelector(selectors.DefaultSelector):
    """Python's selector, with timeouts in seconds of a paced clock."""

    def __init__(self, clock: PacedClock) -> None:
        super().__init__()
        self._clock = clock

    def select(self, timeout: float | None = None) -> _Ready:
        """Wait until something is ready, or ``timeout`` seconds have passed on the clock."""
        if timeout is None or timeout <= 0:
            return super().select(timeout)
        deadline = self._clock.now() + wait_ns(timeout)
        while True:
            seconds = self._clock.wall_seconds_until(deadline)
            ready = super().select(min(max(seconds, 0.0), _SLICE))
            if ready or self._clock.now() >= deadline:
                return ready


class _VirtualSelector(selectors.PollSelector):
    """Waits on the clock only, unless a program's file descriptors are registered."""

    def __init__(self, clock: VirtualClock) -> None:
        super().__init__()
        self._clock = clock
        self._signal: VirtualAutoResetEvent = clock.auto_reset_event()

    def wake(self) -> None:
        """End the current wait, or the next one. Thread-safe."""
        self._signal.set()

    @property
    def reaches_outside(self) -> bool:
        """Whether sockets or pipes of the program are registered, besides the pipe that wakes the loop."""
        return len(self.get_map()) > 1

    def select(self, timeout: float | None = None) -> _Ready:
        """Wait ``timeout`` virtual seconds, until woken, or until something is ready."""
        if self.reaches_outside:
            return super().select(timeout)
        if timeout is None or timeout > 0:
            deadline = None if timeout is None else self._clock.now() + wait_ns(timeout)
            self._signal.wait(deadline)
            self._signal = self._clock.auto_reset_event()
        else:
            self._clock.poll()
        return []
