"""The narrator of a screen: shown on request, and from the first step until the run goes on live."""

from dataclasses import dataclass

from cbtui.runs.live.live_run import LiveRun, RunState, ShownRun
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.code import CodeView, Step
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.rows import NONE_KEPT
from cbtui.widgets.narrator.narration import decided_about, decisions_at
from cbtui.widgets.narrator.narrator import Narrator
from sim.trace.events import EntityId, ThreadId


def was_stepped(run: ShownRun, navigation: TimeNavigation) -> bool:
    """Tell whether the moment on screen is one to which a step of a live run led."""
    at = navigation.playhead.at
    return isinstance(run, LiveRun) and (run.stepped if at is None else at in run.stops)


@dataclass
class Narration(ScreenPart):
    """Shows what the executor decided; the screen lays out its ``widget``."""

    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation
    panes: PaneLayout

    def __post_init__(self) -> None:
        self.widget = Narrator()
        self.widget.charset, self.widget.display = self.host.charset, False
        self._asked_for = False
        self.navigation.stepped = lambda: self._show(True)
        self.navigation.decisions = lambda: decisions_at(self.runs.timeline, self.navigation.now)

    def _show(self, shown: bool) -> None:
        if self.widget.display is not shown:
            self.widget.display = shown
            self.panes.arranged()
        self.host.redraw()

    def draw(self) -> None:
        """Show the moment on screen, if it is shown; hide it where no step led and nobody asked for it."""
        if (
            self.widget.display
            and not self._asked_for
            and self.navigation.playhead.at is None
            and self.runs.run.state is RunState.LIVE
        ):
            self._show(False)
        (step, about), screen = self._step, self.panes.screen
        screen.query_one(CodeView).step = step
        lanes = screen.query_one(Lanes)
        lanes.kept = NONE_KEPT if about is None else {about[0]: 0}
        lanes.kept_thread = None if about is None else about[1]
        if self.widget.display:
            self.widget.stepped = was_stepped(self.runs.run, self.navigation)
            self.widget.place = self.navigation.place
            self.widget.now, self.widget.timeline = self.navigation.now, self.runs.timeline

    @property
    def _step(self) -> tuple[Step | None, tuple[EntityId, ThreadId | None] | None]:
        """The decision to which a step led, while it is told, and the callback and thread that are told of.

        Between two decisions the last one is told.
        """
        was_live = self.navigation.playhead.at is None and was_stepped(self.runs.run, self.navigation)
        if not self.widget.display or not (was_live or self.navigation.playhead.at is not None):
            return None, None
        now, place = self.navigation.now, self.navigation.place
        place = -1 if was_live or place is None else place
        timeline = self.runs.timeline
        about = decided_about(timeline, now, place)
        if about is None and not was_live:
            last = timeline.neighbour(now + 1, -1)
            return None, None if last is None else decided_about(timeline, last, -1)
        return None if about is None else Step(now, place, about[0]), about

    def action_narrate(self) -> None:
        """Show or hide it."""
        self._asked_for = not self.widget.display
        self._show(self._asked_for)
