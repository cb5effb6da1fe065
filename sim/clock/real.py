"""Wall time: callbacks take what they take, and threads run at once where the machine lets them."""

import ctypes
import threading
import time
from collections.abc import Callable

from sim.marks import waits_for_time

# Kept from before anything could put its own functions in their place.
_monotonic_ns = time.monotonic_ns
_allocate_lock = threading.Lock
_Thread = threading.Thread
_Timer = threading.Timer


class RealSignal:
    """A signal on the machine's own locks."""

    __slots__ = ("_clock", "_lock")

    def __init__(self, clock: "RealClock") -> None:
        self._clock = clock
        self._lock = _allocate_lock()
        self._lock.acquire()

    def wait(self, deadline: int | None) -> bool:
        """Wait until set, or until the clock shows ``deadline``; True if it was set."""
        if deadline is None:
            return self._lock.acquire()
        seconds = (deadline - self._clock.now()) / 1e9
        return self._lock.acquire(timeout=min(max(seconds, 0.0), threading.TIMEOUT_MAX))

    def set(self) -> None:
        """Set the flag; setting it twice is setting it once."""
        if self._lock.locked():
            try:
                self._lock.release()
            except RuntimeError:  # another thread set it between the question and the answer
                return


class RealClock:
    """The machine's monotonic clock, counted from the moment of making. Thread-safe."""

    def __init__(self) -> None:
        self.epoch = time.time_ns()
        self._began = _monotonic_ns()

    def now(self) -> int:
        """Nanoseconds since this clock was made."""
        return _monotonic_ns() - self._began

    @waits_for_time
    def sleep(self, duration: int) -> None:
        """Sleep ``duration`` nanoseconds of wall time."""
        time.sleep(max(duration, 0) / 1e9)

    def signal(self) -> RealSignal:
        """A new signal, not set."""
        return RealSignal(self)

    def choose(self, number: int) -> int:
        """The first of some equals."""
        return 0

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Start an ordinary daemon thread."""
        _Thread(target=target, name=name, daemon=True).start()

    def switch_point(self) -> None:
        """Nothing: the machine switches where it likes."""

    def poll(self) -> None:
        """Nothing: asking takes time."""

    def end_thread(self) -> None:
        """Nothing: whoever joins a thread waits while it ends."""

    def interrupt(self, thread: int) -> None:
        """Have the interpreter raise it there; a sleep or a wait for a lock is finished first."""
        ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(thread), ctypes.py_object(KeyboardInterrupt)
        )

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` on a timer thread of its own once ``time`` has come."""
        timer = _Timer(max(time - self.now(), 0) / 1e9, action)
        timer.daemon = True
        timer.start()
