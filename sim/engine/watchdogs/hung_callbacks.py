"""Finds callbacks on the real clock that neither return nor wait for time, and names the line."""

import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from operator import is_
from types import FrameType
from typing import NamedTuple

from sim.clock import RunClock
from sim.engine.callback_positions import LOCK, position_of, wait_began
from sim.engine.waited_lock import decorated, taken_lock, taking
from sim.engine.watchdogs.wait_descriptions import ONE_ORDER, WaitProblem, advice_on_pools, hung_notice
from sim.interpreter.function_marks import calls_the_program, waits_for_keyboard, waits_for_time
from sim.probes.own_code import called_by_own, is_own, outwards, own_frame, place_of, place_text
from sim.probes.probe import RunningCallback
from sim.trace.events import AnyEvent, Doing, Notice

# Kept from before a clock replaces them.
_Thread = threading.Thread
_sleep = time.sleep

_LOOK = 0.25
"""Real seconds between two samples."""
_PATIENCE = 6
"""Samples with the same hung call before it is reported."""

_MODEL = ("sim.ros.", "sim.interfaces.")
_NONE = RunningCallback(0, 0, 0)


class _HungCall(NamedTuple):
    """A call that does not go on; ``takings`` are those of the locks that it waits for.

    It is told after some looks, unless its lock has a new holder meanwhile.
    """

    call: int = 0
    callback: RunningCallback = _NONE
    takings: Sequence[object] = ()
    since: int = 0
    looks: int = 0

    def seen_again(self, later: "_HungCall") -> "_HungCall":
        """Return the thread's next sample, with all looks at it, and when it was seen first."""
        if (self.call, self.callback) != (later.call, later.callback):
            return later
        is_same = len(self.takings) == len(later.takings) and all(map(is_, self.takings, later.takings))
        return later._replace(since=self.since, looks=self.looks + 1 if is_same else 1)


class HungCallbacks:
    """Samples the stacks of all threads, and reports each hung call once."""

    def __init__(
        self,
        clock: RunClock,
        record: Callable[[AnyEvent], None],
        running: Callable[[], Mapping[int, RunningCallback]],
        look_at_positions: Callable[[], None],
    ) -> None:
        """``running`` returns the callbacks that run, by the identifiers of their threads."""
        self._clock = clock
        self._record = record
        self._running = running
        self._look_at_positions = look_at_positions
        self._seen: dict[int, _HungCall] = {}

    def start(self) -> None:
        """Start the sampling thread."""
        _Thread(target=self._watch, name="hung-callbacks", daemon=True).start()

    def _watch(self) -> None:
        while True:
            _sleep(_LOOK)
            self.look()

    def look(self) -> None:
        """Take one sample."""
        seen, running, tops, now = {}, self._running(), sys._current_frames(), self._clock.now()
        for thread, top in tops.items():
            call = _hung_call(top)
            takings = None if call is None else _takings(top, tops)
            if call is None or takings is None:
                continue
            sample = _HungCall(id(call), running.get(thread, _NONE), takings, wait_began(top) or now, 1)
            seen[thread] = hung = self._seen.get(thread, _HungCall()).seen_again(sample)
            if hung.looks == _PATIENCE:
                self._look_at_positions()
                self._record(_deadlock(thread, running, tops, now) or _notice(hung, call, top, now))
        self._seen = seen


def _notice(hung: _HungCall, frame: FrameType, top: FrameType, now: int) -> Notice:
    function, found, (entity, thread, _) = decorated(frame), position_of(top), hung.callback
    call, lock = (found[0][1], found[0][4].lock) if found and found[0][0] is Doing.WAITS else ("", "")
    at = frame.f_code.co_name if function is None else function.__name__, place_of(top), call, lock
    return hung_notice(now, entity, thread, hung.since, at, advice_on_pools())


def _hung_call(top: FrameType) -> FrameType | None:
    """Return the learner's call on a thread if it computes, or waits for something other than time."""
    inner: FrameType | None = None
    for frame in outwards(top):
        if frame in calls_the_program:
            return inner
        if inner is None and str(frame.f_globals.get("__name__")).startswith(_MODEL):
            return None  # the model waits, which the trace shows
        if frame in waits_for_keyboard:
            return None  # the terminal reports that itself
        if frame in waits_for_time:
            return None
        if is_own(frame):
            inner = frame
    return None


def _takings(top: FrameType, tops: Mapping[int, FrameType]) -> list[object] | None:
    """Return the takings of the lock that a thread waits for, of the one that its holder wants, and so on.

    None if the last holder sleeps outside a loop: it will go on by itself.
    """
    takings: list[object] = []
    at: FrameType | None = top
    while (found := position_of(at)) is not None:
        doing, call, _, loop, _ = found[0]
        if takings and doing is Doing.SLEEPS and not loop[0]:
            return None
        lock = taken_lock(called_by_own(at)) if call == LOCK else None
        if lock is None or any(each is lock.taken_at for each in takings):
            break
        takings.append(lock.taken_at)
        at = tops.get(lock.holder_ident)
    return takings


def _deadlock(
    first: int, running: Mapping[int, RunningCallback], tops: Mapping[int, FrameType], now: int
) -> Notice | None:
    """Tell of a cycle of waits for locks; None without one, or if all in it are callbacks."""
    names = {each.ident: each.name for each in threading.enumerate()}
    clauses, ident = dict[int, str](), first
    while ident not in clauses and (found := position_of(top := tops.get(ident))) is not None:
        lock = taken_lock(called_by_own(top)) if found[0][1] == LOCK and not found[1] else None
        if lock is None:
            return None
        clauses[ident] = (
            f"{names.get(ident)} ({place_of(top)}) waits for {found[0][4].lock or 'a lock'}, "
            f"which {names.get(lock.holder_ident)} took at {place_text(*taking(lock, own_frame(top)))}"
        )
        ident = lock.holder_ident
    if ident != first or clauses.keys() <= running.keys():
        return None
    problem = WaitProblem(", and ".join(clauses.values()), ONE_ORDER, is_deadlock=True)
    return problem.notice(now, running.get(first, _NONE).entity)
