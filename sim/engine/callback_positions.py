"""Records at which line of the learner's code each running callback is, and what it does there."""

import ast
import linecache
import sys
import threading
from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import takewhile
from types import FrameType, MappingProxyType
from typing import TypeAlias

from sim.clock import RunClock
from sim.engine.waited_lock import WaitedLock, decorated, first_line, taken_lock, waited_lock
from sim.interpreter.function_marks import asks_time, calls_the_program, notes_begin, waits_for_keyboard
from sim.probes.own_code import called_by_own, is_library, is_own, outwards
from sim.probes.probe import Probe, RunningCallback
from sim.trace.events import AnyEvent, CallbackAt, Doing, EntityId, ThreadId
from sim.trace.events.fields import SourcePlace
from sim.trace.model import RESULT

_WAITING = ("sim.clock.", "threading", "queue")
"""Modules in which threads wait for each other."""

LOCK = "Lock.acquire"
"""The name that a position gives to every way of taking a lock."""
_JOIN = "Thread.join"
JOB = "_WorkItem.run"
"""The function in which a thread of a pool runs its job."""
_NAMES = {"acquire": LOCK, "__enter__": LOCK, "join": _JOIN}

_TIMEOUTS = ("timeout_sec", "timeout", "time_to_wait")
"""The parameters that limit a wait, in seconds; negative numbers, infinity and None do not."""
_LONGEST = 1_000_000_000
"""Seconds of the longest timeout that is recorded."""

PositionFields: TypeAlias = tuple[Doing, str, tuple[tuple[str, str, int], ...], SourcePlace, WaitedLock]
_Found: TypeAlias = tuple[PositionFields, int]
"""A position, and the timeout of its wait."""


class CallbackPositions:
    """Samples the threads' frames, and records the position of each running callback if it has changed.

    A position in which a thread waits is dated from when the wait began, if the thread has noted that.
    """

    def __init__(self, probe: Probe, clock: RunClock, record: Callable[[AnyEvent], None]) -> None:
        self._probe = probe
        self._clock = clock
        self._record = record
        self._latest: dict[int, tuple[RunningCallback, PositionFields]] = {}
        self._seen: dict[int, int] = {}
        """When each thread was looked at last."""
        self._went_on: dict[int, tuple[RunningCallback, int]] = {}
        """When the last long wait of each thread was over, and the callback that it was in."""

    def look(self) -> None:
        """Take one sample; one thread at a time may call this."""
        running = self._probe.running()
        if not running:
            return
        tops, now = sys._current_frames(), self._clock.now()
        threads = self._probe.threads()
        for ident, callback in running.items():
            found = position_of(tops.get(ident), running, threads)
            known = self._latest.get(ident)
            if found is not None and known != (callback, found[0]):
                who, went_on = self._went_on.get(ident, (None, 0))
                if known is not None and who == known[0] and went_on > self._seen.get(ident, 0):
                    self._tell_of_end(ident, *known, went_on)
                self._tell(ident, callback, found, tops.get(ident), now)
            self._seen[ident] = now

    def look_back(self) -> None:
        """Record where the calling thread has waited, if no sample has found that; it is about to go on.

        Thread-safe: a sample that is taken meanwhile may show the wait until the next one or the call's end.
        """
        ident, top, now = threading.get_ident(), sys._getframe(1), self._clock.now()
        running = self._probe.running()
        callback = running.get(ident)
        if callback is None:
            return
        self._went_on[ident] = callback, now
        lock = taken_lock(called_by_own(top))
        if lock is not None and isinstance(lock.taken_during, tuple) and lock.taken_during[0]:
            running[lock.holder_ident] = RunningCallback(*lock.taken_during)  # which may be over by now
        known = self._latest.get(ident)
        found = position_of(top, running, self._probe.threads())
        if found is None or (known is not None and (known[0], known[1][:3]) == (callback, found[0][:3])):
            return
        self._tell(ident, callback, found, top, now)
        self._seen[ident] = now
        self._tell_of_end(ident, callback, found[0], now)

    def _tell_of_end(self, ident: int, callback: RunningCallback, waited: PositionFields, at: int) -> None:
        _, _, frames, loop, _ = waited
        self._tell(ident, callback, ((Doing.COMPUTES, "", frames, loop, WaitedLock()), 0), None, at)

    def _tell(
        self, ident: int, callback: RunningCallback, found: _Found, top: FrameType | None, now: int
    ) -> None:
        position, timeout = found
        since, seen = wait_began(top) or now, self._seen.get(ident, 0)
        self._latest[ident] = callback, position
        doing, call, frames, loop, lock = position
        until = (now if call in (_JOIN, RESULT) else since) + timeout if timeout else 0
        where = doing, call, frames, loop, lock.holder, until
        t = since if since > seen else now
        self._record(CallbackAt(t, callback.entity, callback.thread, *where, *lock[1:]))

    def callback_on(self, ident: int) -> EntityId:
        """Take a sample, and return the callback that runs on a thread (0: none)."""
        self.look()
        callback = self._probe.running().get(ident)
        return 0 if callback is None else callback.entity


def position_of(
    top: FrameType | None,
    running: Mapping[int, RunningCallback] = MappingProxyType({}),
    threads: Mapping[int, ThreadId] = MappingProxyType({}),
) -> _Found | None:
    """Return where a thread is, inside its callback if it runs one, and the timeout of its wait.

    The timeout is in nanoseconds, 0 for none; who waits for a thread's end or job waits no longer than that
    does now. None: the thread is outside the program's code. ``threads`` are the recorded ones by identifier.
    """
    stack = list(takewhile(lambda frame: frame not in calls_the_program, outwards(top)))
    own = [place for place, frame in enumerate(stack) if is_own(frame) and _is_written(frame)]
    if not own:
        return None
    inside = stack[: own[0]]
    doing, call = _activity(inside)
    lock = waited_lock(stack[own[0]], inside, running) if call == LOCK else WaitedLock()
    lines = [(stack[place].f_code, stack[place].f_lineno) for place in reversed(own)]
    loops = (loop_around(code.co_filename, line) for code, line in reversed(lines))
    frames = tuple((code.co_filename, code.co_name, line) for code, line in lines)
    if call == LOCK and (function := decorated(stack[own[0]])) is not None:
        frames = *frames, first_line(function)
    timeout = _timeout(inside[-1]) if inside and doing is not Doing.SLEEPS else 0
    ends = {_JOIN: _joined, RESULT: _thread_of_job}.get(call)
    ident = None if ends is None else ends(inside[-1])
    if ident is not None:
        lock = WaitedLock(threads.get(ident, 0))
        there = called_by_own(sys._current_frames().get(ident))
        timeout = timeout or (_timeout(there[-1]) if there else 0)
    return (doing, call, frames, next(filter(None, loops), ("", 0)), lock), timeout


def wait_began(top: FrameType | None) -> int:
    """Return since when a thread waits in what the program has called, if it has noted that, else 0."""
    return next((each.f_locals.get("since", 0) for each in called_by_own(top) if each in notes_begin), 0)


def _is_written(frame: FrameType) -> bool:
    """Return whether a frame runs code of a file, but not of an installed package."""
    return not is_library(frame) and not frame.f_code.co_filename.startswith("<")


def _activity(inside: list[FrameType]) -> tuple[Doing, str]:
    """Return what the frames do that the program's innermost line has called; the outermost is last."""
    if any(frame in waits_for_keyboard for frame in inside):
        return Doing.READS, "input"
    if not inside or inside[-1] in asks_time:
        return Doing.COMPUTES, ""
    code, module = inside[-1].f_code, str(inside[-1].f_globals.get("__name__"))
    name, own = code.co_name, code.co_qualname
    if name.startswith("sleep") and not own.startswith("Rate."):
        # simulated time comes as messages, which somebody has to take in
        doing = Doing.WAITS if _is_simulated(inside[-1].f_locals.get("self")) else Doing.SLEEPS
        return doing, own if module.startswith("sim.ros.") else "time.sleep"
    if module.startswith("sim.ros."):
        return Doing.CALLS_ROS, own
    if any(str(frame.f_globals.get("__name__")).startswith(_WAITING) for frame in inside):
        known = {} if own.startswith("Semaphore.") else _NAMES
        return Doing.WAITS, known.get(name, own)
    return Doing.COMPUTES, ""


def _is_simulated(clock: object) -> bool:
    return getattr(clock, "ros_time_is_active", False) is True


def _timeout(function: FrameType) -> int:
    """Return the nanoseconds to which a function's arguments limit its wait; 0 for no limit."""
    values = function.f_locals
    seconds = next((values[name] for name in _TIMEOUTS if name in values), None)
    return int(seconds * 1e9) if isinstance(seconds, int | float) and 0 < seconds <= _LONGEST else 0


def _joined(function: FrameType) -> int | None:
    """Return the identifier of the thread for whose end a function waits."""
    values = (function.f_locals.get(name) for name in ("self", "thread"))
    return next((each.ident for each in values if isinstance(each, threading.Thread)), None)


def _thread_of_job(function: FrameType) -> int | None:
    """Return the identifier of a pool's thread that runs the job for whose result a function waits."""
    wanted = function.f_locals.get("self")
    for ident, top in sys._current_frames().items():
        runs = (frame for frame in outwards(top) if frame.f_code.co_qualname == JOB)
        items = (frame.f_locals.get("self") for frame in runs)
        if any(item is not None and getattr(item, "future", None) is wanted for item in items):
            return ident
    return None


def loop_around(file: str, line: int) -> SourcePlace | None:
    """Return file and line of the innermost ``while`` around a line; None for none."""
    found = [(first, last) for first, last in _loops(file) if first <= line <= last]
    return (file, max(found)[0]) if found else None


@lru_cache(maxsize=64)
def _loops(file: str) -> tuple[tuple[int, int], ...]:
    try:
        tree = ast.parse("".join(linecache.getlines(file)))
    except (SyntaxError, ValueError):
        return ()
    return tuple(
        (node.lineno, node.end_lineno or node.lineno)
        for node in ast.walk(tree)
        if isinstance(node, ast.While)
    )
