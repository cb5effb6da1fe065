"""Waits for events outside virtual time: processes, sockets, pipes, signals, file locks.

The waiting thread polls in small steps of virtual time, which passes as real time meanwhile. So outside work
takes its real duration, rounded up to a step, and the other threads run at their times.
"""

import math
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, TypeVar

from sim.clock.virtual import VirtualClock
from sim.clock.virtual_threads import start_outside
from sim.quantities.nanoseconds import wait_ns

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_Thread = threading.Thread

_FIRST_STEP = 1_000_000
_LONGEST_STEP = 16_000_000
"""Virtual nanoseconds between two polls; the step doubles up to the longest."""

_GLANCE = 1_000
"""Virtual nanoseconds that a failed poll takes, so that a polling loop ends."""

Found = TypeVar("Found")


class OutsideWork:
    """Work outside a virtual clock, during which its time passes as real time."""

    def __init__(self, clock: VirtualClock, tell: Callable[[str], None]) -> None:
        self.clock = clock
        self.tell = tell
        """Called on the thread that works outside, with a clause on what is not repeatable."""
        self._waits = 0
        self._others: list[Callable[[], bool]] = []
        clock.time.outside_works = self._goes_on

    def also(self, goes_on: Callable[[], bool]) -> None:
        """Let time also pass as real time while ``goes_on`` returns true; ``goes_on`` must not wait."""
        self._others.append(goes_on)

    def begin(self) -> None:
        """Start outside work: time passes as real time from now on."""
        self.clock.time.pace.keep_real(True, self.clock.now())

    def glance(self) -> None:
        """Let the duration of one failed poll pass."""
        self._pass(_GLANCE, math.inf)

    def wait(self, look: Callable[[], Found], timeout: float | None, what: str) -> Found:
        """Poll until ``look`` returns something true, or for ``timeout`` seconds; return the last result.

        ``what`` is the waiting function, such as ``select.select``.
        """
        found = look()
        if found:
            return found
        if timeout is not None and timeout <= 0:
            self.glance()
            return found
        self.tell(f"{what} waits for something outside virtual time, which takes as long as it takes")
        left: float = math.inf if timeout is None else wait_ns(timeout)
        step = _FIRST_STEP
        with self._waiting():
            self.begin()
            while not found and left > 0:
                left -= self._pass(step, left)
                step = min(2 * step, _LONGEST_STEP)
                found = look()
        return found

    def call(self, function: Callable[..., Found], *args: Any, what: str, **named: Any) -> Found:
        """Call a blocking function on a thread outside the clock, and return or raise its result."""
        self.tell(f"{what} works outside virtual time, and takes as long as it takes")
        result: list[Found] = []
        error: list[BaseException] = []

        def work() -> None:
            try:
                result.append(function(*args, **named))
            except BaseException as raised:  # noqa: BLE001 -- the waiting thread raises it
                error.append(raised)

        start_outside(_Thread(target=work, name=what, daemon=True))
        self.wait(lambda: result or error, None, what)
        if error:
            raise error[0]
        return result[0]

    def _pass(self, step: int, limit: float) -> int:
        """Let time pass by a step, or by the lag behind real time; return the nanoseconds that passed.

        The step is at most ``limit``. It ends early if a signal comes.
        """
        before = self.clock.now()
        step = int(min(max(step, self.clock.time.pace.lag(before)), limit))
        self.clock.park(before + step)
        return self.clock.now() - before

    @contextmanager
    def _waiting(self) -> Generator[None, None, None]:
        self._waits += 1
        try:
            yield
        finally:
            self._waits -= 1

    def _goes_on(self) -> bool:
        return self._waits > 0 or any(goes_on() for goes_on in self._others)
