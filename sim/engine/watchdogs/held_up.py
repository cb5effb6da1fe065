"""Notices on the real clock a callback that does not come back and does not wait for time, and its place."""

import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from sim.clock import Clock
from sim.engine.stdio.terminal import KEYBOARD_WAITS
from sim.ros.own_code import is_own, outwards, place_of
from sim.trace.events import AnyEvent, Notice, Severity

# Kept from before a clock puts its own in their place.
_Thread = threading.Thread
_sleep = time.sleep

_LOOK = 0.5
"""Real seconds between two looks."""
_PATIENCE = 6
"""Looks at which the same call was found held up before the person is told."""

_MODEL = Path(__file__).parents[2]
_ROS = f"{_MODEL / 'ros'}/"
_CLOCK = f"{_MODEL / 'clock'}/"
_CALLS = f"{_MODEL / 'ros' / 'running.py'}"
_FOR_TIME = {"sleep", "_wait_until", "_within"}
"""Functions of the clock in which a thread waits for time to pass."""


class HeldUp:
    """Looks from outside at what the threads do. Each call is told of once."""

    def __init__(self, clock: Clock, record: Callable[[AnyEvent], None]) -> None:
        self._clock = clock
        self._record = record
        self._seen: dict[int, tuple[int, int]] = {}

    def start(self) -> None:
        """Begin to look."""
        _Thread(target=self._watch, name="held-up", daemon=True).start()

    def _watch(self) -> None:
        while True:
            _sleep(_LOOK)
            self.look()

    def look(self) -> None:
        """Look once."""
        seen = {}
        for thread, top in sys._current_frames().items():
            call = _call_held_up(top)
            if call is not None:
                before, looks = self._seen.get(thread, (0, 0))
                seen[thread] = id(call), looks + 1 if before == id(call) else 1
                if seen[thread][1] == _PATIENCE:
                    self._record(Notice(self._clock.now(), Severity.WARN, _sentence(call, top)))
        self._seen = seen


def _call_held_up(top: FrameType) -> FrameType | None:
    """The learner's call on a thread, if it runs or waits for something other than time; else None."""
    inner: FrameType | None = None
    for frame in outwards(top):
        file = frame.f_code.co_filename
        if file == _CALLS:
            return inner
        if inner is None and file.startswith(_ROS):
            return None  # the model waits, which the trace tells of
        if frame.f_code in KEYBOARD_WAITS:
            return None  # the terminal tells of that itself
        if file.startswith(_CLOCK) and frame.f_code.co_name in _FOR_TIME:
            return None
        if is_own(frame):
            inner = frame
    return None


def _sentence(call: FrameType, top: FrameType) -> str:
    return (
        f"{call.f_code.co_name} has not come back for {_LOOK * _PATIENCE:g} s ({place_of(top)}): it computes "
        "without end, or waits for something that does not come; its thread serves nothing else meanwhile"
    )
