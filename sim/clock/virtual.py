"""Virtual time: real threads of which one runs at a time, and time that jumps when none of them can.

The threads pass a baton. A thread that waits hands it to the next one that can run, first come, first
served; when nobody can, time jumps to the earliest deadline (ties: the one that began to wait first).
Computing takes no virtual time, so the same inputs give the same run, whatever the machine does.

A schedule may choose other orders, those that a real machine could come to: any thread that can run goes on,
and one that runs is left at a switch point, in front of or behind a lock or a question for the time.
"""

import threading
from collections import deque
from collections.abc import Callable, Generator, Hashable, Set
from contextlib import contextmanager

from sim.clock.outside import start_outside
from sim.clock.played import NO_ACCESSES, Accesses
from sim.clock.schedule import FirstCome, Schedule
from sim.clock.virtual_threads import VirtualThread
from sim.clock.virtual_time import VirtualTime
from sim.quantities.nanoseconds import SECOND

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_get_ident = threading.get_ident
_Thread = threading.Thread

VIRTUAL_EPOCH = 1_700_000_000 * SECOND
"""Every virtual run begins at this moment (14 November 2023), so its stamps are the same each time."""


class VirtualClock:
    """A deterministic clock and the scheduler of the threads that live on it.

    The thread that makes it becomes its main thread. Only threads started through the clock (or adopted
    by it) may wait on it; any other thread reaches into the run with ``time.inject``. Up to ``explored_from``
    (nanoseconds) threads run first come, first served, from then on as the schedule says.
    """

    epoch = VIRTUAL_EPOCH

    def __init__(
        self, speed: float | None = None, schedule: Schedule | None = None, explored_from: int = 0
    ) -> None:
        self.schedule = self._schedule = schedule or FirstCome()
        self.explores = self.schedule.explores
        """Whether its schedule chooses among the orders that are possible."""
        self.turn = 0
        """How often the running thread has waited, or was left for another one."""
        self.no_switching = 0
        """How many callers have disabled thread switches at switch points."""
        self._ready: deque[VirtualThread] = deque()
        self.time = VirtualTime(speed, self._ready.append)
        self._deadlines = self.time.deadlines
        self._recesses = self.time.recesses
        self._threads: set[VirtualThread] = set()
        self.on_lock_wait: Callable[[VirtualThread], None] = _ignore
        """Called when a thread begins to wait without an end for a lock, or for another thread to end.

        It is called on that thread, and must not wait.
        """
        self.handle_signals: Callable[[], None] = _ignore
        """Called on the main thread when it goes on after a wait."""
        self.current = VirtualThread("MainThread")
        self.current.is_main = True
        self.current.ident = _get_ident()
        self._threads.add(self.current)
        if explored_from:
            self._schedule = FirstCome()
            self.call_at(explored_from, self._explore)

    def now(self) -> int:
        """Virtual nanoseconds since the run began."""
        return self.time.now

    @property
    def able(self) -> int:
        """How many threads can run as soon as the running one lets them."""
        return len(self._ready)

    @property
    def threads(self) -> Set[VirtualThread]:
        """The threads that live on it; to be asked for by the one that has the baton."""
        return self._threads

    def sleep(self, duration: int) -> None:
        """Let ``duration`` virtual nanoseconds pass; 0 lets every other thread that can run go first."""
        deadline = self.time.now + max(duration, 0)
        while self.park(deadline) and self.time.now < deadline:
            continue  # it handled a signal

    def auto_reset_event(self) -> "VirtualAutoResetEvent":
        """A new signal, not set."""
        return VirtualAutoResetEvent(self)

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
        self.did(virtual)

        def run() -> None:
            virtual.ident = _get_ident()
            virtual.gate.acquire()
            try:
                target()
            finally:
                self._retire(virtual)

        return run

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` when virtual time reaches ``time``, on whichever thread is at hand."""
        self._deadlines.add((max(time, self.time.now), self._deadlines.number(), action))

    def park(self, deadline: int | None) -> bool:
        """Hand the baton on until unparked or until ``deadline``; True if unparked, which a signal does, too.

        Raises:
            KeyboardInterrupt: the thread was interrupted.
        """
        me = self.current
        if me.interrupted:
            self._raise_interrupt(me)
        me.waiting = True
        me.woken = False
        me.current_wait = self._deadlines.number()
        if deadline is not None:
            self._recesses.idle_waits += deadline <= self.time.now
            self._deadlines.add((deadline, me.current_wait, me))
        self._hand_on(me)
        if me.interrupted:
            self._raise_interrupt(me)
        woken = me.woken
        if me.is_main:
            self.handle_signals()
        return woken

    def poll(self) -> None:
        """Count a question that was answered at once as a wait for no time; it is one if a recess is due.

        The calling thread must hold nothing that others wait for outside this clock.
        """
        if self.no_switching or not self.owns_current_thread():
            return
        recesses = self._recesses
        if recesses.steps >= recesses.due:
            self.park(self.time.now)
        else:
            recesses.idle_waits += 1
            recesses.steps += 1

    def unpark(self, thread: VirtualThread) -> None:
        """Let a parked thread run again, after those that can run already; else nothing happens."""
        if thread.waiting:
            thread.waiting = False
            thread.woken = True
            self._ready.append(thread)
            self.did(thread)

    def did(self, what: Hashable) -> None:
        """Tell the schedule that the running thread has done something with what others depend on."""
        if self.explores and self.owns_current_thread():
            self._schedule.did(self.current, what)

    def hands_over(self) -> bool:
        """Whether a released lock goes to a thread that waits for it, and is not left free."""
        return self._schedule.hands_over()

    def choose(self, number: int) -> int:
        """Which of ``number`` equals that wait for something gets it, from 0: the oldest, unless explored."""
        return self._schedule.choose(number)

    def switch_point(self, accesses: Accesses = NO_ACCESSES) -> None:
        """Let another thread go first that can run, if the schedule wants it. Any thread may call this.

        Put it where a real machine could switch, and where the calling thread holds nothing that another one
        would wait for outside this clock. ``accesses`` is what the next step touches, if it is one of the
        program's own.
        """
        if not self.explores or self.no_switching or not self.owns_current_thread():
            return
        me = self.current
        if (self._ready or accesses) and not me.stays and self._schedule.leaves(me, self._ready, accesses):
            self._ready.append(me)
            self._hand_on(me)

    def end_thread(self) -> None:
        """Have the calling thread run to its end from here, which it is near: others may join it for real."""
        self.current.stays = True

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt out of a thread's wait, its present or its next one."""

        def interrupt() -> None:
            for each in self._threads:
                if each.ident == thread:
                    each.interrupted = True
                    self.unpark(each)

        if self.owns_current_thread():
            interrupt()
        else:
            self.time.inject(interrupt)

    def halt(self) -> None:
        """Let time stand right here, in the middle of this moment, until it is steered on.

        Call it on the thread that has the baton. It may hold locks: no other thread of the run goes on.
        """
        with self._without_switching():
            self.time.stand_in_moment()

    def _explore(self) -> None:
        self._schedule = self.schedule

    def _raise_interrupt(self, me: VirtualThread) -> None:
        me.interrupted = False
        raise KeyboardInterrupt

    def _retire(self, thread: VirtualThread) -> None:
        self._threads.discard(thread)
        self._schedule.forget(thread)
        if self._threads:
            self._pass_baton(self._next_thread())

    def _hand_on(self, me: VirtualThread) -> None:
        self.turn += 1
        recesses = self._recesses
        recesses.steps += 1
        if recesses.steps >= recesses.due:
            with self._without_switching():
                self.time.take_recess()
        following = self._next_thread()
        if following is not me:
            self._pass_baton(following)
            me.gate.acquire()

    def _pass_baton(self, following: VirtualThread) -> None:
        self.current = following
        following.gate.release()

    def _next_thread(self) -> VirtualThread:
        if not self._ready:
            with self._without_switching():
                self._await_ready()
        place = self._schedule.next(self._ready)
        following = self._ready[place]
        del self._ready[place]
        return following

    def _await_ready(self) -> None:
        while not self._ready:
            self.time.jump()
            if self._schedule.explores:
                self.time.serve_equals()

    @contextmanager
    def _without_switching(self) -> Generator[None, None, None]:
        """Disable switch points while the thread with the baton works on the clock itself."""
        self.no_switching += 1
        try:
            yield
        finally:
            self.no_switching -= 1


def _ignore(*_what: object) -> None:
    """The default listener, which does nothing."""


class VirtualAutoResetEvent:
    """A signal between threads on virtual time; others may set it through ``VirtualTime.inject``."""

    __slots__ = ("_clock", "_set", "_waiter")

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self._set = False
        self._waiter: VirtualThread | None = None

    def wait(self, deadline: int | None) -> bool:
        """Wait until set, or until virtual time reaches ``deadline``; True if it was set."""
        if deadline is not None and deadline <= self._clock.now():
            self._clock.poll()
        while not self._set and (deadline is None or deadline > self._clock.now()):
            self._waiter = self._clock.current
            try:
                if not self._clock.park(deadline):
                    break
            finally:
                self._waiter = None
        was_set, self._set = self._set, False
        return was_set

    def set(self) -> None:
        """Set the flag; the waiting thread becomes able to run."""
        self._set = True
        if self._waiter is not None:
            self._clock.unpark(self._waiter)
