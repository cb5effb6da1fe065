"""A console on an exercise in the current folder, for pilot tests: on recorded runs, or real engines."""

import asyncio
from collections.abc import Callable
from pathlib import Path

from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.engines.session import OpenSession
from cbtui.runs.setup.lesson_setup import setup_to_judge
from cbtui.screens.exercise import ExerciseScreen
from lessons.catalogue import find
from sim.trace.events import AnyEvent
from tests.support.engine_runs import run_to_end
from tests.support.fake_session import FakeEngines, FakeSession

LESSON = find("split-groups")
FILE = LESSON.file_name
assert LESSON.starter_path is not None
assert LESSON.solution_path is not None
STARTER, SOLUTION = LESSON.starter_path, LESSON.solution_path
_LIMIT = 60.0
_FOREVER = 10**18


def is_judged(screen: ExerciseScreen) -> bool:
    """Whether the run on screen has been judged."""
    return screen._judging.sheet is not None


def judged_run(file: Path) -> list[AnyEvent]:
    """The events of the run that a file for the exercise is judged by."""
    return run_to_end(setup_to_judge(LESSON, file)).events


class ExerciseConsole(CbtuiApp):
    """The console on the exercise; ``open_session`` None starts real engines."""

    def __init__(self, open_session: OpenSession | None = None) -> None:
        super().__init__(start_exercise=LESSON.id, open_session=open_session)
        self.animation_level = "none"

    @property
    def exercise(self) -> ExerciseScreen:
        """The exercise's screen, which must be on top."""
        assert isinstance(self.screen, ExerciseScreen)
        return self.screen


class Engines(FakeEngines):
    """Play the same events to their end, and then tell that they are over."""

    def __init__(self, events: list[AnyEvent]) -> None:
        super().__init__(events, until=_FOREVER)

    def finish(self) -> FakeSession:
        """End the latest session as it should."""
        self.latest.end()
        return self.latest


async def until(pilot: Pilot[None], condition: Callable[[], bool]) -> None:
    """Let the console work until something is so; fails when that takes too long."""
    async with asyncio.timeout(_LIMIT):
        while not condition():
            await pilot.pause(0.01)
