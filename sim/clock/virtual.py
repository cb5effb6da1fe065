"""Virtual time: real threads of which one runs at a time, and a time that jumps when none can run.

The threads pass a baton. A thread that waits hands the baton to the next thread that can run, first come,
first served. When no thread can run, time jumps to the earliest deadline (ties: the first that waited).
Computing takes no virtual time, so the same inputs give the same run on every machine.

A schedule may choose other orders that are possible on a real machine: any thread that can run continues,
and the running thread may be preempted at a switch point, before or after it uses a lock or reads the time.
"""

import threading
from collections import deque
from collections.abc import Callable, Generator, Hashable
from contextlib import contextmanager

from sim.clock.schedule import NO_ACCESSES, Accesses, Schedule
from sim.clock.virtual_threads import VirtualThread, start_outside
from sim.clock.virtual_time import VirtualTime
from sim.quantities.nanoseconds import SECOND

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_get_ident = threading.get_ident
_Thread = threading.Thread

VIRTUAL_EPOCH = 1_700_000_000 * SECOND
"""The date at which every virtual run begins (14 November 2023), so that stamps are the same in every run."""


class VirtualClock:
    """A deterministic clock and the scheduler of the threads that live on it.

    The thread that creates the clock becomes its main thread. Only threads that the clock started or adopted
    may wait on it; any other thread acts on the run through ``time.inject``. Up to ``explored_from``
    (nanoseconds) threads run first come, first served; then the schedule decides.
    """

    epoch = VIRTUAL_EPOCH

    def __init__(
        self, speed: float | None = None, schedule: Schedule | None = None, explored_from: int = 0
    ) -> None:
        self.schedule = self._schedule = schedule or Schedule()
        self.explores = self.schedule.explores
        """Whether the schedule explores other orders than first come, first served."""
        self.turn = 0
        """How often a running thread has waited or was preempted."""
        self.no_switching = 0
        """How many callers have disabled thread switches at switch points."""
        self._ready: deque[VirtualThread] = deque()
        self.time = VirtualTime(speed, self._ready.append)
        self._deadlines = self.time.deadlines
        self._recesses = self.time.recesses
        self.threads: set[VirtualThread] = set()
        """The threads that live on the clock. Only the thread that has the baton may use the set."""
        self.on_lock_wait: Callable[[VirtualThread], None] = lambda _thread: None
        """Called when a thread starts to wait without a timeout for a lock or for the end of a thread.

        It is called on the waiting thread and must not wait.
        """
        self.on_stall: Callable[[VirtualThread, int], None] = lambda _thread, _duration: None
        """Called when so many nanoseconds have passed although a thread could go on; it must not wait."""
        self.activity: Callable[[], object] = lambda: None
        self.handle_signals: Callable[[], None] = lambda: None
        """Called on the main thread when it continues after a wait."""
        self.current = VirtualThread("MainThread")
        self.current.is_main = True
        self.current.ident = _get_ident()
        self.threads.add(self.current)
        if explored_from:
            self._schedule = Schedule()
            self.call_at(explored_from, self._explore)

    def now(self) -> int:
        """Virtual nanoseconds since the run began."""
        return self.time.now

    @property
    def runnable(self) -> int:
        """How many threads can run as soon as the running thread waits."""
        return len(self._ready)

    def sleep(self, duration: int) -> None:
        """Let ``duration`` virtual nanoseconds pass; 0 lets every other thread that can run go first."""
        deadline = self.time.now + max(duration, 0)
        while self.park(deadline) and self.time.now < deadline:
            continue  # the thread handled a signal

    def auto_reset_event(self) -> "VirtualAutoResetEvent":
        """A new event, not set."""
        return VirtualAutoResetEvent(self)

    def owns_current_thread(self) -> bool:
        """Whether the calling thread lives on this clock and has the baton. Thread-safe."""
        return self.current.ident == _get_ident()

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Run ``target`` on a new daemon thread, after the threads that can run already."""
        thread = _Thread(target=self.adopt(target, name), name=name, daemon=True)
        start_outside(thread)

    def adopt(self, target: Callable[[], None], name: str) -> Callable[[], None]:
        """Register one more thread, and return the function that this thread has to run."""
        virtual = VirtualThread(name)
        self.threads.add(virtual)
        self._ready.append(virtual)
        self.record_use(virtual)

        def run() -> None:
            virtual.ident = _get_ident()
            virtual.gate.acquire()
            try:
                target()
            finally:
                self._retire(virtual)

        return run

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` when virtual time reaches ``time``, on any thread of the clock."""
        self._deadlines.add((max(time, self.time.now), self._deadlines.number(), action))

    def park(self, deadline: int | None) -> bool:
        """Wait until ``unpark`` or ``deadline``; True if unparked. A signal ends the main thread's wait, too.

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
            if deadline > self.time.now:
                deadline += self._schedule.lateness()
            self._deadlines.add((deadline, me.current_wait, me))
        self._hand_on(me)
        if me.interrupted:
            self._raise_interrupt(me)
        woken = me.woken
        if me.is_main:
            self.handle_signals()
        return woken

    def poll(self) -> None:
        """Count a poll as a wait of length 0; if a recess is due, the thread does wait.

        The calling thread must hold nothing that other threads wait for outside this clock.
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
        """Let a parked thread run, after the threads that can run already. Any other thread is left alone."""
        if thread.waiting:
            thread.waiting = False
            thread.woken = True
            self._ready.append(thread)
            self.record_use(thread)

    def record_use(self, what: Hashable) -> None:
        """Tell the schedule that the running thread has used ``what``, which other threads depend on."""
        if self.explores and self.owns_current_thread():
            self._schedule.record_use(self.current, what)

    def hands_over(self) -> bool:
        """Whether a released lock goes to a waiting thread; otherwise it stays free."""
        return self._schedule.hands_over()

    def races(self) -> bool:
        """Whether the threads of a pool race, or go on as they mostly do."""
        return self._schedule.races()

    def choose(self, number: int) -> int:
        """The index of the one of ``number`` equal waiters that is served: 0, the oldest, unless explored."""
        return self._schedule.choose(number)

    def switch_point(self, accesses: Accesses = NO_ACCESSES) -> None:
        """Let another thread that can run go first, if the schedule decides so. Thread-safe.

        Call it where a real machine could switch threads, and where the calling thread holds nothing that
        another one would wait for outside this clock. ``accesses`` is what the next step touches, if it is a
        step of the program.
        """
        if not self.explores or self.no_switching or not self.owns_current_thread():
            return
        me = self.current
        if me.stays:
            return
        self._stall(me)
        if (self._ready or accesses) and self._schedule.yields(me, self._ready, accesses):
            self._ready.append(me)
            self._hand_on(me)

    def end_thread(self) -> None:
        """Disable switch points for the calling thread, which ends now: others may join it in real time."""
        self.current.stays = True

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt in a thread's present or next wait. Thread-safe."""

        def interrupt() -> None:
            for each in self.threads:
                if each.ident == thread:
                    each.interrupted = True
                    self.unpark(each)

        if self.owns_current_thread():
            interrupt()
        else:
            self.time.inject(interrupt)

    def halt(self) -> None:
        """Pause time in the middle of this moment, until an action of ``time.steer`` resumes it.

        Call it on the thread that has the baton. The thread may hold locks: no other thread of the run runs.
        """
        with self._without_switching():
            self.time.pause_in_moment()

    def _explore(self) -> None:
        self._schedule = self.schedule

    def _raise_interrupt(self, me: VirtualThread) -> None:
        me.interrupted = False
        raise KeyboardInterrupt

    def _retire(self, thread: VirtualThread) -> None:
        self.threads.discard(thread)
        self._schedule.forget(thread)
        if self.threads:
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
        elif self.explores:
            self._stall(self._ready[0])
        place = self._schedule.next(self._ready)
        following = self._ready[place]
        del self._ready[place]
        return following

    def _await_ready(self) -> None:
        while not self._ready:
            self._jump()

    def _jump(self, limit: int | None = None) -> None:
        self.time.jump(limit)
        if self._schedule.explores:
            self.time.serve_equals()

    def _stall(self, thread: VirtualThread) -> None:
        """Let time pass, as far as the schedule has it, although a thread could go on."""
        now, deadline = self.time.now, self._deadlines.first()
        if (deadline is None or deadline > now) and (longest := self._schedule.stall()):
            with self._without_switching():
                self._jump(now + longest)
                if self.time.now > now:
                    self.on_stall(thread, self.time.now - now)

    @contextmanager
    def _without_switching(self) -> Generator[None, None, None]:
        """Disable switch points while the thread with the baton works on the clock itself."""
        self.no_switching += 1
        try:
            yield
        finally:
            self.no_switching -= 1


class VirtualAutoResetEvent:
    """An auto-reset event on virtual time; other threads may set it through ``VirtualTime.inject``."""

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
        """Set the flag, and let the waiting thread run."""
        self._set = True
        if self._waiter is not None:
            self._clock.unpark(self._waiter)
