"""Queues of what comes from outside a run: actions of other threads, and inputs."""

import threading
from collections import deque
from collections.abc import Callable

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_allocate_lock = threading.Lock


class Inbox:
    """A queue of actions for the thread with the baton. Any thread may call ``put`` and ``ring``."""

    def __init__(self) -> None:
        self.waiting: deque[tuple[Callable[[], None], bool]] = deque()
        """The queued actions, each with whether it steers."""
        self._bell = _allocate_lock()
        self._bell.acquire()
        self.rests = False
        """Whether the run waits for its pace, for the end of a pause, or for something from outside."""

    def put(self, action: Callable[[], None], *, steers: bool = False) -> None:
        """Queue an action; an action that ``steers`` also runs while time is stopped within a moment."""
        self.waiting.append((action, steers))
        self.ring()

    def ring(self) -> None:
        """Wake a resting run."""
        if self._bell.locked():
            try:
                self._bell.release()
            except RuntimeError:  # another thread rang it in between
                return

    def rest(self, nanoseconds: float | None) -> None:
        """Wait for something from outside, with a timeout."""
        self.rests = True
        self._bell.acquire(timeout=-1 if nanoseconds is None else nanoseconds / 1e9)
        self.rests = False

    def run_all(self) -> None:
        """Run all queued actions."""
        while self.waiting:
            action, _ = self.waiting.popleft()
            action()

    def run_steering(self, still: Callable[[], bool]) -> None:
        """Run the steering actions while ``still`` holds; the others keep their order."""
        others = []
        while self.waiting and still():
            action, steers = self.waiting.popleft()
            if steers:
                action()
            else:
                others.append((action, steers))
        self.waiting.extendleft(reversed(others))


class Inputs:
    """Inputs of a run: live inputs, and inputs scheduled for a moment or for one of its recesses."""

    def __init__(self) -> None:
        self.given: deque[Callable[[], None]] = deque()
        """Live inputs for the end of the current moment, or for its recess. Any thread may append one."""
        self.scheduled: deque[tuple[int, int, Callable[[], None]]] = deque()
        """Scheduled inputs in order: the moment, the recess in the moment (0: its end), and the action."""

    def take(self, now: int, recess: int) -> Callable[[], None] | None:
        """Remove and return the input due at the end of this moment, or in this recess; None without one."""
        if self.scheduled:
            moment, wanted, action = self.scheduled[0]
            if moment <= now and (not recess or 0 < wanted <= recess):
                self.scheduled.popleft()
                return action
        return self.given.popleft() if self.given else None
