"""How much of a screen each frame draws."""

from collections.abc import Callable
from enum import Enum, auto
from math import inf
from time import monotonic

FRAMES_A_SECOND = 30

_LANES_A_PANE = 6
"""Frames of the lanes for each of the other panes while a run goes on: those tell in words and figures, which
nobody reads as fast as lanes are seen to move."""

_LANES_A_TEXT = 12
"""Frames of the lanes for each of log and code: lines that scroll past are read no faster."""

_REST_FACTOR = 2.0
"""Seconds of rest for each second that a frame had to wait for a processor."""

_MAX_REST = 0.5
"""Seconds after which a frame is drawn however short of processors the machine is."""


class FrameContent(Enum):
    """What a frame draws."""

    NOTHING = auto()
    LANES = auto()
    ALL_BUT_TEXTS = auto()
    ALL = auto()


class FrameSchedule:
    """Draws often what moves, seldom what is read, and at once what the person did.

    ``clock`` tells real time in seconds.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._frames = 0
        self._stale = True
        self._grown = False
        self._texts_behind = False
        self._drawn_at = inf  # the first time is the timer's
        self._rests_until = -inf

    def invalidate(self) -> None:
        """Note that there is more to draw than that the run has gone on."""
        self._stale = True

    def grow(self) -> None:
        """Note that the run has gone on."""
        self._grown = True

    def next(self) -> FrameContent:
        """Count a frame, and return what it draws."""
        if self._clock() < self._rests_until and not self._stale:
            return FrameContent.NOTHING
        self._frames += 1
        if self._stale or ((self._grown or self._texts_behind) and self._frames % _LANES_A_TEXT == 0):
            return FrameContent.ALL
        if not self._grown:
            return FrameContent.NOTHING
        return FrameContent.ALL_BUT_TEXTS if self._frames % _LANES_A_PANE == 0 else FrameContent.LANES

    def is_due_before_next(self) -> bool:
        """Tell whether to draw without waiting for a frame: not if that was just done."""
        return self._stale and self._clock() - self._drawn_at >= 1 / FRAMES_A_SECOND

    def drawn(self, extent: FrameContent) -> None:
        """Note that everything, or all but the texts, is being drawn."""
        self._stale = self._grown = False
        self._texts_behind = extent is not FrameContent.ALL
        self._drawn_at = self._clock()

    def rest(self, waited: float) -> None:
        """Draw nothing unasked for a while: the last frame waited so many seconds for a processor."""
        self._rests_until = self._clock() + min(_REST_FACTOR * waited, _MAX_REST)
