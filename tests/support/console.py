"""A console on recorded events, for pilot tests and snapshots.

A snapshot of a lesson at a moment is::

    app = RecordedConsole("split-groups", events, seconds=9.4)
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)
"""

from collections.abc import Sequence

from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.colour_themes import STANDARD
from cbtui.keymap import Keymap
from cbtui.screens.lesson import LessonScreen
from sim.trace.events import AnyEvent
from tests.support.builder import ns
from tests.support.fake_session import FakeEngines

NARROW = (80, 24)
WIDE = (140, 40)
TALL = (80, 60)
"""High enough for every lesson and what was opened lately."""


class RecordedConsole(CbtuiApp):
    """The console with a lesson open whose engine has played ``events`` up to ``seconds``."""

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
            charset=charset, start_lesson=lesson, keys=keys, theme=theme, open_session=self.engines
        )
        self.animation_level = "none"

    @property
    def lesson_screen(self) -> LessonScreen:
        """The lesson on screen; nothing else may lie over it."""
        assert isinstance(self.screen, LessonScreen)
        return self.screen


async def settle(pilot: Pilot[None]) -> None:
    """Let everything that was delivered or pressed reach the screen; to be ``run_before`` of a snapshot."""
    await pilot.pause()
    if isinstance(pilot.app.screen, LessonScreen):
        pilot.app.screen.look_for_findings()
        pilot.app.screen.draw()
    await pilot.pause()
