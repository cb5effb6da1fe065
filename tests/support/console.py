"""A console on recorded events, for pilot tests and snapshots.

A snapshot of a lesson at a moment is::

    app = RecordedConsole("split-groups", events, seconds=9.4)
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)
"""

import asyncio
from collections.abc import Sequence
from threading import Event

from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.keys.keymap import Keymap
from cbtui.learning.outcome import Observe
from cbtui.looks.colour_themes import STANDARD
from cbtui.runs.judged.checking import ObservedRun
from cbtui.screens.exercise import ExerciseScreen
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.run import RunScreen
from cbtui.widgets.lanes import Lanes
from lessons.catalogue import find
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.fake_session import FakeEngines

NARROW = (80, 24)
WIDE = (140, 40)
TALL = (80, 60)
"""High enough for every lesson and what was opened lately."""


class RecordedConsole(CbtuiApp):
    """The console with a lesson open whose engine has played ``events`` up to ``seconds``.

    Its predictions were answered before, rightly, so that the run begins at once; they are held against those
    events too.
    """

    def __init__(
        self,
        lesson: str,
        events: Sequence[AnyEvent],
        seconds: float,
        charset: str = "braille",
        keys: Keymap | None = None,
        theme: str = STANDARD,
    ) -> None:
        self.engines = FakeEngines(events, ns(seconds))
        super().__init__(
            charset=charset,
            start_lesson=lesson,
            keys=keys,
            theme=theme,
            open_session=self.engines,
            observe=observed(events),
        )
        self.animation_level = "none"
        predict(self, lesson)

    @property
    def lesson_screen(self) -> LessonScreen | ExerciseScreen:
        """The lesson or its exercise on screen; nothing else may lie over it."""
        assert isinstance(self.screen, LessonScreen | ExerciseScreen)
        return self.screen


def predict(app: CbtuiApp, lesson: str) -> None:
    """Let a learner have answered a lesson's predictions rightly."""
    for place, prediction in enumerate(find(lesson).predictions):
        app.progress.answer(lesson, place, prediction.right)


def observed(events: Sequence[AnyEvent]) -> Observe:
    """Return what gives these events as a run that has come to its end, without an engine."""

    def observe(_setup: RunSetup, _name: str, _given_up: Event) -> ObservedRun:
        timeline = Timeline()
        timeline.extend(events)
        return ObservedRun(timeline)

    return observe


_LIMIT = 60.0
"""Seconds after which lanes that are not full count as never to be."""


async def settle(pilot: Pilot[None]) -> None:
    """Let everything that was delivered or pressed reach the screen; to be ``run_before`` of a snapshot."""
    await pilot.pause(0.02)  # after a key, the texts follow the other panes
    for screen in pilot.app.screen_stack:
        if isinstance(screen, RunScreen):
            screen.update_findings()
            screen.draw()
    await pilot.pause()
    await whole_lanes(pilot)


async def whole_lanes(pilot: Pilot[None]) -> None:
    """Wait for the columns that lanes paint in their next frames."""
    async with asyncio.timeout(_LIMIT):
        for lanes in pilot.app.screen.query(Lanes):
            while lanes.picture is not None and not lanes.picture.complete:
                await pilot.pause(0.02)
