"""What reaches a run on virtual time from outside: actions that other threads hand in, and inputs."""

import threading
from collections import deque
from collections.abc import Callable

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_allocate_lock = threading.Lock


class Inbox:
    """Actions for the thread that has the baton. Any thread may ``put``; the rest is for that one."""

    def __init__(self) -> None:
        self.waiting: deque[Callable[[], None]] = deque()
        """What has been handed in and not been done."""
        self._bell = _allocate_lock()
        self._bell.acquire()
        self.rests = False
        """Whether the run waits for its pace, for the end of a pause, or for something from outside."""

    def put(self, action: Callable[[], None], *, steers: bool = False) -> None:
        """Hand in an action; one that ``steers`` is done even where time stands in the middle of a moment."""
        self.waiting.append(_Steering(action) if steers else action)
        self.ring()

    def ring(self) -> None:
        """Have a run that rests look again."""
        if self._bell.locked():
            try:
                self._bell.release()
            except RuntimeError:  # another thread rang it between the question and the answer
                return

    def rest(self, nanoseconds: float | None) -> None:
        """Wait for something from outside, at most so long."""
        self.rests = True
        self._bell.acquire(timeout=-1 if nanoseconds is None else nanoseconds / 1e9)
        self.rests = False

    def empty(self) -> None:
        """Do all that was handed in."""
        while self.waiting:
            self.waiting.popleft()()

    def steer(self, still: Callable[[], bool]) -> None:
        """Do what steers, as long as ``still`` holds; the rest stays in its order."""
        others = []
        while self.waiting and still():
            action = self.waiting.popleft()
            if isinstance(action, _Steering):
                action()
            else:
                others.append(action)
        self.waiting.extendleft(reversed(others))


class Inputs:
    """Inputs of a run: those given while it goes on, and those scheduled for a moment or a recess of it."""

    def __init__(self) -> None:
        self.given: deque[Callable[[], None]] = deque()
        """For the end of the moment that the run has reached, or its recess; any thread may add one."""
        self.scheduled: deque[tuple[int, int, Callable[[], None]]] = deque()
        """With the moment, and the recess in it (0: its end), in their order."""

    def take(self, now: int, recess: int) -> Callable[[], None] | None:
        """Take the one that is due at the end of the moment, or in its recess; None if none is."""
        if self.scheduled:
            moment, wanted, action = self.scheduled[0]
            if moment <= now and (not recess or 0 < wanted <= recess):
                self.scheduled.popleft()
                return action
        return self.given.popleft() if self.given else None


class _Steering:
    """An action for which a run does not have to come to the end of a moment."""

    def __init__(self, action: Callable[[], None]) -> None:
        self._action = action

    def __call__(self) -> None:
        self._action()
