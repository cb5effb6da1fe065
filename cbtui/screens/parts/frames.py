"""The frame scheduler: how much of a screen each frame draws."""

from collections.abc import Callable
from enum import Enum, auto
from math import inf
from time import monotonic

from textual.screen import Screen

from cbtui.runs.live.live_run import ShownRun
from cbtui.screens.parts.runs import RunController
from cbtui.terminal.processor import cpu_wait, time_off_cpu
from cbtui.terminal.textual_internals import update_now

FRAMES_A_SECOND = 12
"""The least step of a bar, a dot, half a column, is 60 ms in a window of ten seconds."""

_SOONEST = 0.01
"""Least seconds between two frames with all panes that keys cause."""

_TEXTS_AFTER = 0.005
"""Seconds after the other panes until the texts are drawn that a key changes: the picture goes out first."""

_LANES_A_PANE = 3
"""Lane frames per frame of all panes: their words and figures are read slower than lanes move."""

_BEHIND = _LANES_A_PANE / FRAMES_A_SECOND
"""Seconds after which the other panes are drawn with any frame: on a busy machine frames come seldom."""

_SMOOTH = 2.0
"""The highest speed at which lanes move between frames of all panes: else they would be seconds ahead."""

_PAUSE = 0.5
"""Seconds without growth after which a run begins to move."""

_BEGINNING = 1.0
"""Seconds from then on in which each frame draws the other panes, too: nobody waits for what comes first."""

_REST_FACTOR = 2.0
"""Seconds of rest per second that a frame waited for a CPU."""

_MAX_REST = 0.5
"""The longest rest in seconds."""


class FrameContent(Enum):
    """What a frame draws."""

    NOTHING = auto()
    LANES = auto()
    ALL_BUT_TEXTS = auto()
    TEXTS = auto()
    ALL = auto()


class FrameSchedule:
    """Draws lanes often, all panes together less often, and the effects of keys at once.

    ``clock`` tells real time in seconds.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._frames = 0
        self._stale = True
        self._grown = False
        self._grew_at = -inf
        self._began_at = -inf
        self._texts_behind = False
        self._drawn_at = inf  # the timer draws the first frame
        self._rests_until = -inf

    def invalidate(self) -> None:
        """Note that everything must be drawn, not only the growth of the run."""
        self._stale = True

    def grow(self) -> None:
        """Note that the run has grown."""
        now = self._clock()
        if now > self._grew_at + _PAUSE:
            self._began_at = now
        self._grown, self._grew_at = True, now

    def next(self, *, is_smooth: bool = True) -> FrameContent:
        """Count a frame, and return what it draws; ``is_smooth``: lanes may be ahead of the other panes."""
        if self._clock() < self._rests_until and not self._stale:
            return FrameContent.NOTHING
        self._frames += 1
        now = self._clock()
        is_turn = self._frames % _LANES_A_PANE == 0 or now < self._began_at + _BEGINNING
        is_turn = is_turn or now >= self._drawn_at + _BEHIND
        if self._stale or ((self._grown or self._texts_behind) and is_turn):
            return FrameContent.ALL
        return FrameContent.LANES if self._grown and is_smooth else FrameContent.NOTHING

    def due_in(self) -> float | None:
        """Return the seconds until everything is to be drawn, frame or no frame; None if that need not be."""
        if not self._stale or self._drawn_at == inf:
            return None
        return max(0.0, self._drawn_at + _SOONEST - self._clock())

    def drawn(self, extent: FrameContent) -> None:
        """Note what is being drawn: everything, all but the texts, or these."""
        self._texts_behind = extent is FrameContent.ALL_BUT_TEXTS
        if extent is not FrameContent.TEXTS:
            self._stale = self._grown = False
            self._drawn_at = self._clock()

    def rest(self, waited: float) -> None:
        """Rest after a frame by the seconds that it waited for a CPU; key effects are still drawn."""
        self._rests_until = self._clock() + min(_REST_FACTOR * waited, _MAX_REST)


class FrameLoop:
    """Draws the frames of a screen that shows ``runs``: ``draw`` draws a frame.

    While something ``holds`` the picture, or another screen covers all of it, no frame comes by itself.
    """

    def __init__(
        self,
        screen: Screen[None],
        runs: RunController[ShownRun],
        draw: Callable[[FrameContent], None],
        holds: Callable[[], bool],
    ) -> None:
        self._screen = screen
        self._draw = draw
        self._runs = runs
        self._holds = holds
        self._schedule = FrameSchedule()

    def start(self) -> None:
        """Start the timer."""
        self._screen.set_interval(1 / FRAMES_A_SECOND, self._draw_if_due)

    def grow(self) -> None:
        """Note that the run has grown, which the next frames draw."""
        self._schedule.grow()

    def redraw(self) -> None:
        """Draw at once, or soon if all was just drawn; the texts follow the other panes."""
        self._schedule.invalidate()
        if self._screen.is_running:
            self._screen.call_next(self._draw_at_once)

    def draw(self, content: FrameContent) -> None:
        """Draw now."""
        if content is not FrameContent.LANES:
            self._schedule.drawn(content)
        self._draw(content)

    def _draw_at_once(self) -> None:
        due_in = self._schedule.due_in()
        if due_in == 0:
            self.draw(FrameContent.ALL_BUT_TEXTS)
            update_now(self._screen)
            self._screen.set_timer(_TEXTS_AFTER, self._draw_texts)
        elif due_in is not None:
            self._screen.set_timer(due_in, self._draw_at_once)

    def _draw_texts(self) -> None:
        self.draw(FrameContent.TEXTS)

    def _draw_if_due(self) -> None:
        if self._holds() or not self._screen.is_current:
            return
        if self._runs.findings.update_when_due():
            self.redraw()
        speed = self._runs.run.speed
        content = self._schedule.next(is_smooth=speed is not None and speed <= _SMOOTH)
        if content is not FrameContent.NOTHING:
            before = time_off_cpu()
            self.draw(content)
            update_now(self._screen)
            self._schedule.rest(cpu_wait(before))
