"""Finds callbacks on the real clock that neither return nor wait for time, and names the line."""

import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import takewhile
from operator import is_
from types import FrameType
from typing import NamedTuple

from sim.clock import RunClock
from sim.engine.callback_positions import LOCK, position_of, wait_began
from sim.engine.waited_lock import decorated, taken_lock
from sim.engine.watchdogs.wait_descriptions import advice_on_pools
from sim.interpreter.function_marks import calls_the_program, waits_for_keyboard, waits_for_time
from sim.probes.own_code import is_own, outwards, place_of
from sim.probes.probe import RunningCallback
from sim.quantities.durations import timestamp
from sim.trace.events import AnyEvent, Doing, Notice, NoticeKind, Severity

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
                self._record(_notice(hung, call, top, now))
        self._seen = seen


def _notice(hung: _HungCall, call: FrameType, top: FrameType, now: int) -> Notice:
    problem, advice = f"has not come back since {timestamp(hung.since)}", advice_on_pools()
    text = "; ".join(filter(None, (_sentence(problem, call, top), advice)))
    return Notice(
        now,
        Severity.WARN,
        text,
        hung.callback.entity,
        kind=NoticeKind.NO_PROGRESS,
        problem=problem,
        advice=advice,
        thread=hung.callback.thread,
    )


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
        inside = takewhile(lambda frame: not is_own(frame), outwards(at))
        lock = taken_lock(inside) if call == LOCK else None
        if lock is None or any(each is lock.taken_at for each in takings):
            break
        takings.append(lock.taken_at)
        at = tops.get(lock.holder_ident)
    return takings


def _sentence(problem: str, call: FrameType, top: FrameType) -> str:
    what, function, found = (
        "computes, or waits for something that does not come",
        decorated(call),
        position_of(top),
    )
    if found is not None and found[0][0] is Doing.WAITS:
        _, inside, _, _, lock = found[0]
        what = f"waits for {lock.lock or 'a lock'}" if inside == LOCK else f"waits in {inside}()"
    name = call.f_code.co_name if function is None else function.__name__
    return f"{name} {problem} ({place_of(top)}): it {what}; its thread serves nothing else meanwhile"
