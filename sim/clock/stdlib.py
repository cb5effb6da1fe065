"""Makes Python's waits use a virtual clock: sleep, time, locks, threads and queues.

A program uses ``time`` and ``threading`` as usual. Their functions are
replaced once, in the engine process, before the program is imported; a thread that does not live on the
clock (such as the engine's own) gets the real ones. Events, conditions, semaphores, barriers, timers and
queues follow by themselves, since Python builds them on the locks replaced here.
"""

import queue
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from types import CodeType, FrameType, TracebackType
from typing import Any, TypeVar

from sim.clock.alarms import ProcessSignals
from sim.clock.child_processes import ChildProcesses
from sim.clock.dates import replace_dates
from sim.clock.descriptors import replace_descriptors
from sim.clock.entropy import replace_entropy
from sim.clock.hashes import number_threads
from sim.clock.imports import replace_imports
from sim.clock.outside_work import OutsideWork
from sim.clock.replacing import Replacements
from sim.clock.schedule import NO_ACCESSES
from sim.clock.virtual import VirtualAutoResetEvent, VirtualClock
from sim.clock.virtual_threads import VirtualThread, start_outside
from sim.interpreter.function_marks import asks_time
from sim.interpreter.guarding import takes_to_guard
from sim.quantities.nanoseconds import wait_ns

_allocate_lock = threading.Lock
_thread_start = threading.Thread.start
_thread_join = threading.Thread.join
_thread_is_alive = threading.Thread.is_alive
_active_threads: dict[int, threading.Thread] = threading._active  # type: ignore[attr-defined]
_RLock: Any = threading._PyRLock  # type: ignore[attr-defined]
_RLOCK_TAKES = _RLock.acquire.__code__
_RLOCK_TAKES_AGAIN = _RLock._acquire_restore.__code__

Number = TypeVar("Number", int, float)


class VirtualLock:
    """``threading.Lock`` on virtual time: handed over in the order in which threads asked for it.

    With a seed, any waiting thread may get the lock, or it stays free for the next thread that asks; and
    threads switch before and after each use. Threads outside the clock may share it; they wait in real time.
    """

    _clock: VirtualClock

    def __init__(self) -> None:
        self._real = _allocate_lock()
        self._waiters: deque[VirtualThread] = deque()
        self._granted: VirtualThread | None = None
        self.holder: VirtualThread | None = None
        self.guards = False
        self.taken_at: tuple[CodeType, int] | None = None
        self.taken_by: threading.Thread | None = None
        self.taken_during: object = None
        self._clock.record_use(self)

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Take the lock; False if it is not available at once (or within ``timeout`` seconds)."""
        limit = None if timeout == -1 else self._limit(blocking, timeout)
        self._clock.switch_point({self: True} if self._clock.explores else NO_ACCESSES)
        if self._real.acquire(blocking=False):
            if self._clock.owns_current_thread():
                self._note_taking(sys._getframe(1))
            return True
        if not blocking:
            self._clock.poll()
            return False
        if not self._clock.owns_current_thread():
            return self._real.acquire(timeout=timeout)
        taken = self._wait_in_line(None if limit is None else self._clock.now() + limit)
        if taken:
            self._note_taking(sys._getframe(1))
        return taken

    @staticmethod
    def _limit(blocking: bool, timeout: float) -> int:
        if not blocking:
            raise ValueError("can't specify a timeout for a non-blocking call")
        if timeout < 0:
            raise ValueError("timeout value must be positive")
        return wait_ns(timeout)

    def _wait_in_line(self, deadline: int | None) -> bool:
        me = self._clock.current
        self._waiters.append(me)
        if self._real.acquire(blocking=False):  # a thread outside released it before it saw this waiter
            self._waiters.remove(me)
            return True
        if deadline is None:
            me.wants = self
            self._clock.on_lock_wait(me)
        taken = False
        try:
            while not taken and self._clock.park(deadline) and self._granted is not me:
                taken = self._real.acquire(blocking=False)  # it is free for the first thread that asks
        except BaseException:  # the wait was interrupted, or the run is over
            self._give_up_place(me)
            raise
        finally:
            me.wants = None
        if self._granted is me:
            self._granted = None
            return True
        self._waiters.remove(me)
        return taken

    def _give_up_place(self, me: VirtualThread) -> None:
        """Remove a thread from the queue, even if the lock was handed to it."""
        if self._granted is me:
            self._granted = self.holder = None
            self._real.release()
        else:
            self._waiters.remove(me)
        self._serve_waiters()

    def release(self) -> None:
        """Release the lock, or hand it to the thread that has waited longest."""
        if not self._real.locked():
            raise RuntimeError("release unlocked lock")
        self.holder = None
        self._clock.record_use(self)
        if not self._clock.owns_current_thread():
            self._real.release()
            if self._waiters:
                self._clock.time.inject(self._serve_waiters)
        elif self._waiters and self._granted is None:
            self._pass_on()
        else:
            self._real.release()
        self._clock.switch_point()

    def _serve_waiters(self) -> None:
        if self._waiters and self._granted is None and self._real.acquire(blocking=False):
            self._pass_on()

    def _pass_on(self) -> None:
        """Hand the held lock to a waiting thread, or wake one and let it try."""
        following = self._waiters[self._clock.choose(len(self._waiters))]
        if self._clock.hands_over():
            self._waiters.remove(following)
            self._granted = self.holder = following
        else:
            self._real.release()
        self._clock.unpark(following)

    def _note_taking(self, frame: FrameType) -> None:
        """Record which thread took the lock, and where: the first frame outside the library."""
        self._clock.record_use(self)
        self.holder = self._clock.current
        self.taken_by = _active_threads.get(self.holder.ident)
        self.taken_during = self._clock.activity()
        code = frame.f_code
        self.guards = code is _ENTERS or code is _RLOCK_TAKES or code is _RLOCK_TAKES_AGAIN
        if code.co_filename not in _LIBRARY:
            self.guards = takes_to_guard(frame)
        while code.co_filename in _LIBRARY and frame.f_back is not None:
            frame = frame.f_back
            code = frame.f_code
        self.taken_at = code, frame.f_lasti

    @property
    def holder_ident(self) -> int:
        """The identifier of the only thread that can release the lock; 0 if any thread can."""
        return self.holder.ident if self.holder is not None and self.guards else 0

    def _is_owned(self) -> bool:
        """Whether the lock is held, as conditions ask; this does not count as a poll."""
        self._clock.switch_point()
        return self._real.locked()

    def locked(self) -> bool:
        """Whether a thread holds the lock."""
        return self._real.locked()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._real = _allocate_lock()
        self._waiters.clear()
        self.holder = None


_ENTERS = VirtualLock.__enter__.__code__
_LIBRARY = {__file__, _RLOCK_TAKES.co_filename, queue.Queue.get.__code__.co_filename}


def live_on(clock: VirtualClock, tell: Callable[[str], None] = lambda _what: None) -> None:
    """Replace Python's waits, clocks and random numbers in this process, permanently.

    Call this on the clock's main thread. ``tell`` is called on a program's thread with a clause about each
    action that is not reproducible.
    """
    VirtualLock._clock = clock
    replacements = Replacements(clock)
    kept = dict(vars(time))
    _replace_time(clock)
    for name, real in kept.items():
        if getattr(time, name) is not real:
            replacements.note(real, getattr(time, name))
    _replace_locks()
    _replace_threads(clock)
    outside = OutsideWork(clock, tell)
    replace_dates(replacements, outside)
    replace_entropy(replacements, outside)
    replace_descriptors(replacements, outside)
    ChildProcesses(outside).replace(replacements)
    ProcessSignals(outside).replace(replacements)
    replace_imports(replacements)
    number_threads(clock)
    replacements.hand_on()


def _replace_time(clock: VirtualClock) -> None:
    real_sleep = time.sleep

    def sleep(seconds: float) -> None:
        if not clock.owns_current_thread():
            real_sleep(seconds)
        elif seconds < 0:
            raise ValueError("sleep length must be non-negative")
        else:
            clock.sleep(wait_ns(seconds))

    def here(virtual: Callable[[], Number], real: Callable[[], Number]) -> Callable[[], Number]:
        @asks_time
        def ask() -> Number:
            if not clock.owns_current_thread():
                return real()
            clock.switch_point()
            return virtual()

        return ask

    module: Any = time
    module.sleep = sleep
    module.monotonic = here(lambda: clock.now() / 1e9, time.monotonic)
    module.perf_counter = here(lambda: clock.now() / 1e9, time.perf_counter)
    module.time = here(lambda: (clock.epoch + clock.now()) / 1e9, time.time)
    module.monotonic_ns = here(clock.now, time.monotonic_ns)
    module.perf_counter_ns = here(clock.now, time.perf_counter_ns)
    module.time_ns = here(lambda: clock.epoch + clock.now(), time.time_ns)


def _replace_locks() -> None:
    module: Any = threading
    module.Lock = VirtualLock
    module._allocate_lock = VirtualLock
    module.RLock = module._PyRLock
    queues: Any = queue
    queues.SimpleQueue = queues._PySimpleQueue
    pools: Any = sys.modules.get("concurrent.futures.thread")
    if pools is not None:  # the module made its lock when it was imported
        pools._global_shutdown_lock = VirtualLock()


def _replace_threads(clock: VirtualClock) -> None:
    def start(thread: threading.Thread) -> None:
        inner: Any = thread
        if clock.owns_current_thread() and not inner._started.is_set():
            inner._virtual_end = _End(clock)
            inner.run = clock.adopt(_ending(thread.run, inner._virtual_end, clock), thread.name)
            start_outside(thread)
        else:
            _thread_start(thread)

    def join(thread: threading.Thread, timeout: float | None = None) -> None:
        end: _End | None = getattr(thread, "_virtual_end", None)
        if end is None or not clock.owns_current_thread() or thread is threading.current_thread():
            _thread_join(thread, timeout)
        elif end.wait(None if timeout is None else clock.now() + wait_ns(max(timeout, 0))):
            _thread_join(thread)

    def is_alive(thread: threading.Thread) -> bool:
        end: _End | None = getattr(thread, "_virtual_end", None)
        return _thread_is_alive(thread) if end is None else not end.reached

    thread_class: Any = threading.Thread
    thread_class.start = start
    thread_class.join = join
    thread_class.is_alive = is_alive


class _End:
    """The end of a thread on virtual time; any number of threads may wait for it."""

    guards: bool = True
    taken_at: tuple[CodeType, int] | None = None

    def __init__(self, clock: VirtualClock) -> None:
        self.reached = False
        self.holder: VirtualThread | None = None
        self._clock = clock
        self._waiters: list[VirtualAutoResetEvent] = []

    def reach(self) -> None:
        self.reached = True
        for waiter in self._waiters:
            waiter.set()

    def wait(self, deadline: int | None) -> bool:
        if not self.reached:
            me = self._clock.current
            waiter = self._clock.auto_reset_event()
            self._waiters.append(waiter)
            if deadline is None:
                me.wants = self
                self._clock.on_lock_wait(me)
            try:
                waiter.wait(deadline)
            finally:
                me.wants = None
            self._waiters.remove(waiter)
        return self.reached


def _ending(body: Callable[[], None], end: _End, clock: VirtualClock) -> Callable[[], None]:
    def run() -> None:
        end.holder = clock.current
        try:
            body()
        except Exception as error:  # noqa: BLE001 - Python would hand it over when time has gone on
            threading.excepthook(
                threading.ExceptHookArgs(
                    (type(error), error, error.__traceback__, threading.current_thread())
                )
            )
        finally:
            end.reach()

    return run
