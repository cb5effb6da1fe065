"""Finds callbacks on the real clock that neither return nor wait for time, and names the line."""

import sys
import threading
import time
from collections.abc import Callable
from types import FrameType

from sim.clock import RunClock
from sim.engine.callback_positions import LOCK, position_of
from sim.engine.waited_lock import decorated
from sim.engine.watchdogs.wait_descriptions import advice_on_pools
from sim.interpreter.function_marks import calls_the_program, waits_for_keyboard, waits_for_time
from sim.probes.own_code import is_own, outwards, place_of
from sim.trace.events import AnyEvent, Doing, EntityId, Notice, NoticeKind, Severity

# Kept from before a clock replaces them.
_Thread = threading.Thread
_sleep = time.sleep

_LOOK = 0.25
"""Real seconds between two samples."""
_PATIENCE = 6
"""Samples with the same hung call before it is reported."""

_PROBLEM = f"has not come back for {_LOOK * _PATIENCE:g} s"

_MODEL = ("sim.ros.", "sim.interfaces.")


class HungCallbacks:
    """Samples the stacks of all threads, and reports each hung call once."""

    def __init__(
        self, clock: RunClock, record: Callable[[AnyEvent], None], callback_on: Callable[[int], EntityId]
    ) -> None:
        """``callback_on`` returns the callback that runs on a thread, by its identifier (0: none)."""
        self._clock = clock
        self._record = record
        self._callback_on = callback_on
        self._seen: dict[int, tuple[int, int]] = {}

    def start(self) -> None:
        """Start the sampling thread."""
        _Thread(target=self._watch, name="hung-callbacks", daemon=True).start()

    def _watch(self) -> None:
        while True:
            _sleep(_LOOK)
            self.look()

    def look(self) -> None:
        """Take one sample."""
        seen = {}
        for thread, top in sys._current_frames().items():
            call = _hung_call(top)
            if call is not None:
                before, looks = self._seen.get(thread, (0, 0))
                seen[thread] = id(call), looks + 1 if before == id(call) else 1
                if seen[thread][1] == _PATIENCE:
                    entity, kind = self._callback_on(thread), NoticeKind.NO_PROGRESS
                    advice = advice_on_pools()
                    now, text = self._clock.now(), "; ".join(filter(None, (_sentence(call, top), advice)))
                    told = Notice(
                        now, Severity.WARN, text, entity, kind=kind, problem=_PROBLEM, advice=advice
                    )
                    self._record(told)
        self._seen = seen


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


def _sentence(call: FrameType, top: FrameType) -> str:
    what, function, found = (
        "computes, or waits for something that does not come",
        decorated(call),
        position_of(top),
    )
    if found is not None and found[0][0] is Doing.WAITS:
        _, inside, _, _, lock = found[0]
        what = f"waits for {lock.lock or 'a lock'}" if inside == LOCK else f"waits in {inside}()"
    name = call.f_code.co_name if function is None else function.__name__
    return f"{name} {_PROBLEM} ({place_of(top)}): it {what}; its thread serves nothing else meanwhile"
