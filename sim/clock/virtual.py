"""Virtual time: real threads of which one runs at a time, and time that jumps when none of them can.

The threads pass a baton. A thread that waits hands it to the next one that can run, first come, first
served; when nobody can, time jumps to the earliest deadline (ties: the one that began to wait first).
Computing takes no virtual time, so the same inputs give the same run, whatever the machine does.

Paced to a speed, a jump takes as long as the pace says, and what comes from outside (a key pressed in the
console) takes effect at the moment that the pace has reached.
"""

import threading
import time
from collections import deque
from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count
from typing import Any

from sim.clock.interface import Stopped

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_allocate_lock = threading.Lock
_get_ident = threading.get_ident
_monotonic_ns = time.monotonic_ns
_Thread = threading.Thread
_start_thread = threading.Thread.start

VIRTUAL_EPOCH = 1_700_000_000 * 1_000_000_000
"""Every virtual run begins at this moment (14 November 2023), so its stamps are the same each time."""

_LAG_FORGIVEN = 250_000_000
"""Nanoseconds that a paced run may fall behind the wall before it gives up catching up."""


class VirtualThread:
    """A thread that lives on virtual time: it runs while it has the baton and stands at its gate else."""

    __slots__ = (
        "current_wait",
        "gate",
        "ident",
        "interrupted",
        "is_main",
        "knocked",
        "name",
        "waiting",
        "woken",
    )

    def __init__(self, name: str) -> None:
        self.name = name
        self.is_main = False
        self.ident = 0
        self.interrupted = False
        self.knocked = False
        self.gate = _allocate_lock()
        self.gate.acquire()
        self.waiting = False
        self.woken = False
        self.current_wait = 0


class VirtualSignal:
    """A signal between threads on virtual time; others may set it through ``VirtualClock.inject``."""

    __slots__ = ("_clock", "_set", "_waiter")

    def __init__(self, clock: "VirtualClock") -> None:
        self._clock = clock
        self._set = False
        self._waiter: VirtualThread | None = None

    def wait(self, deadline: int | None) -> bool:
        """Wait until set, or until virtual time reaches ``deadline``; True if it was set."""
        if not self._set and (deadline is None or deadline > self._clock.now()):
            self._waiter = self._clock.current
            try:
                self._clock.park(deadline)
            finally:
                self._waiter = None
        was_set, self._set = self._set, False
        return was_set

    def set(self) -> None:
        """Set the flag; the waiting thread becomes able to run."""
        self._set = True
        if self._waiter is not None:
            self._clock.unpark(self._waiter)


class VirtualClock:
    """A deterministic clock and the scheduler of the threads that live on it.

    The thread that makes it becomes its main thread. Only threads started through the clock (or adopted
    by it) may wait on it; any other thread reaches into the run with ``inject``.
    """

    epoch = VIRTUAL_EPOCH

    def __init__(self, speed: float | None = None) -> None:
        self._now = 0
        self._order = count(1)
        self._ready: deque[VirtualThread] = deque()
        self._deadlines: list[tuple[int, int, VirtualThread | Callable[[], None]]] = []
        self._inbox: deque[Callable[[], None]] = deque()
        self._bell = _allocate_lock()
        self._bell.acquire()
        self._speed = speed
        self._paused = False
        self._anchor_virtual = 0
        self._anchor_real = _monotonic_ns()
        self._stopping = False
        self._threads: set[VirtualThread] = set()
        self.before_jump: Callable[[], int | None] = _nothing
        """Called whenever time is about to pass, on whichever thread is at hand; it must not wait.

        It may return a moment at which time is to stop over, so that it is called there too.
        """
        self.steps = 0
        """How often a thread came to a wait; a run that neither takes steps nor rests is stuck."""
        self.rests = False
        """Whether the run waits for its pace, for the end of a pause, or for something from outside."""
        self.current = VirtualThread("MainThread")
        self.current.is_main = True
        self.current.ident = _get_ident()
        self._threads.add(self.current)

    def now(self) -> int:
        """Virtual nanoseconds since the run began."""
        return self._now

    def sleep(self, duration: int) -> None:
        """Let ``duration`` virtual nanoseconds pass; 0 lets every other thread that can run go first."""
        self.park(self._now + max(duration, 0))

    def signal(self) -> VirtualSignal:
        """A new signal, not set."""
        return VirtualSignal(self)

    def owns_current_thread(self) -> bool:
        """Whether the calling thread lives on this clock and has the baton."""
        return self.current.ident == _get_ident()

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Run ``target`` on a new daemon thread; it comes after those that can run already."""
        thread = _Thread(target=self.adopt(target, name), name=name, daemon=True)
        start_outside(thread)

    def adopt(self, target: Callable[[], None], name: str) -> Callable[[], None]:
        """Make room for one more thread and return what that thread has to run."""
        virtual = VirtualThread(name)
        self._threads.add(virtual)
        self._ready.append(virtual)

        def run() -> None:
            virtual.ident = _get_ident()
            virtual.gate.acquire()
            try:
                if not self._stopping:
                    target()
            except Stopped:
                pass  # the run is over, and this thread with it
            finally:
                self._retire(virtual)

        return run

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` when virtual time reaches ``time``, on whichever thread is at hand."""
        heappush(self._deadlines, (max(time, self._now), next(self._order), action))

    def park(self, deadline: int | None) -> bool:
        """Hand the baton on until unparked or until ``deadline``; True if unparked.

        Raises:
            KeyboardInterrupt: the thread was interrupted, or the run was stopped and this is its main thread.
                Raised once, as by Ctrl-C; later waits of the main thread of a stopped run let the others end
                and return at once.
            Stopped: the run was stopped, and this is another thread.
        """
        me = self.current
        if self._stopped():
            return self._wind_up(me)
        self._raise_knock(me)
        me.waiting = True
        me.woken = False
        me.current_wait = next(self._order)
        if deadline is not None:
            heappush(self._deadlines, (deadline, me.current_wait, me))
        self._hand_on(me)
        self._raise_knock(me)
        return self._wind_up(me) if self._stopped() else me.woken

    def unpark(self, thread: VirtualThread) -> None:
        """Let a parked thread run again, after those that can run already; else nothing happens."""
        if thread.waiting:
            thread.waiting = False
            thread.woken = True
            self._ready.append(thread)

    def inject(self, action: Callable[[], None]) -> None:
        """Have ``action`` run at the moment the run has reached; it must not wait. Any thread may call it."""
        self._inbox.append(action)
        if self._bell.locked():
            try:
                self._bell.release()
            except RuntimeError:  # another thread rang it between the question and the answer
                return

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt out of a thread's wait, its present or its next one."""

        def knock() -> None:
            for each in self._threads:
                if each.ident == thread:
                    each.knocked = True
                    self.unpark(each)

        if self.owns_current_thread():
            knock()
        else:
            self.inject(knock)

    def set_speed(self, speed: float | None) -> None:
        """Pass ``speed`` virtual seconds per real second, None: all it can. Call it through ``inject``."""
        self._anchor_at(self._now)
        self._speed = speed

    def pause(self) -> None:
        """Stop time at the moment the run has reached; call through ``inject``."""
        self._paused = True

    def resume(self) -> None:
        """Let time go on after ``pause``; call through ``inject``."""
        self._anchor_at(self._now)
        self._paused = False

    def stop(self) -> None:
        """End the run: every wait, now and later, raises. Call it from ``call_at`` or ``inject``."""
        self._stopping = True
        for thread in sorted(self._threads, key=lambda each: (not each.is_main, each.current_wait)):
            self.unpark(thread)

    def _stopped(self) -> bool:
        return self._stopping

    def _raise_knock(self, me: VirtualThread) -> None:
        if me.knocked:
            me.knocked = False
            raise KeyboardInterrupt

    def _wind_up(self, me: VirtualThread) -> bool:
        if not me.is_main:
            raise Stopped
        if not me.interrupted:
            me.interrupted = True
            raise KeyboardInterrupt
        self._ready.append(me)
        self._hand_on(me)
        return False

    def _retire(self, thread: VirtualThread) -> None:
        self._threads.discard(thread)
        if self._threads:
            self._pass_baton(self._next_thread())

    def _hand_on(self, me: VirtualThread) -> None:
        self.steps += 1
        following = self._next_thread()
        if following is not me:
            self._pass_baton(following)
            me.gate.acquire()

    def _pass_baton(self, following: VirtualThread) -> None:
        self.current = following
        following.gate.release()

    def _next_thread(self) -> VirtualThread:
        while not self._ready:
            self._jump()
        return self._ready.popleft()

    def _jump(self) -> None:
        """Bring time to the next deadline, or to where something from outside makes a thread able to run."""
        target = self._earliest_deadline()
        stopover = self.before_jump() if target is None or target > self._now else None
        if stopover is not None and self._now < stopover and (target is None or stopover < target):
            if self._pass_time(stopover):
                self._now = stopover
            return
        if not self._pass_time(target):
            return
        assert target is not None
        self._now = max(self._now, target)
        _, _, due = heappop(self._deadlines)
        if isinstance(due, VirtualThread):
            due.waiting = False
            self._ready.append(due)
        else:
            due()

    def _earliest_deadline(self) -> int | None:
        while self._deadlines:
            deadline, order, due = self._deadlines[0]
            if not isinstance(due, VirtualThread) or (due.waiting and due.current_wait == order):
                return deadline
            heappop(self._deadlines)
        return None

    def _pass_time(self, target: int | None) -> bool:
        """Wait as long as the pace wants; False if something from outside came first and was done."""
        while not self._inbox:
            delay = self._delay_until(target)
            if delay is not None and delay <= 0:
                return True
            self.rests = True
            self._bell.acquire(timeout=-1 if delay is None else delay / 1e9)
            self.rests = False
        self._now = self._paced_now(target)
        actions = [self._inbox.popleft() for _ in range(len(self._inbox))]
        for action in actions:
            action()
        return False

    def _delay_until(self, target: int | None) -> float | None:
        """Real nanoseconds to wait before ``target`` may come; None: until something happens outside."""
        if target is None or self._paused:
            return None
        if self._speed is None:
            return 0
        delay = self._anchor_real + (target - self._anchor_virtual) / self._speed - _monotonic_ns()
        if delay < -_LAG_FORGIVEN:
            self._anchor_at(target)
        return delay

    def _paced_now(self, limit: int | None) -> int:
        """Where the pace has brought the run between two jumps, at most to ``limit``."""
        if self._speed is None or self._paused:
            return self._now
        paced = self._anchor_virtual + int((_monotonic_ns() - self._anchor_real) * self._speed)
        return max(self._now, paced if limit is None else min(paced, limit))

    def _anchor_at(self, moment: int) -> None:
        self._anchor_virtual = moment
        self._anchor_real = _monotonic_ns()


class _Started:
    """Stands in for a thread's own "has started" event, which is set before the thread lives on the clock."""

    def __init__(self) -> None:
        self._gate = _allocate_lock()
        self._gate.acquire()

    def set(self) -> None:
        self._gate.release()

    def is_set(self) -> bool:
        return not self._gate.locked()

    def wait(self, timeout: float = -1) -> bool:
        in_time = self._gate.acquire(timeout=timeout)
        if in_time:
            self._gate.release()
        return in_time


def start_outside(thread: threading.Thread) -> None:
    """Start a thread without waiting in virtual time for the moment at which it has started."""
    inner: Any = thread
    inner._started = _Started()
    _start_thread(thread)


def _nothing() -> int | None:
    """Stand in for a hook that nobody set."""
