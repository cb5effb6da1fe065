"""The narrator of a screen: shown on request, and from the first step on."""

from dataclasses import dataclass

from cbtui.runs.live.live_run import LiveRun, ShownRun
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.narrator import Narrator


def was_stepped(run: ShownRun, navigation: TimeNavigation) -> bool:
    """Tell whether the moment on screen is the one to which a step led."""
    return navigation.playhead.at is None and isinstance(run, LiveRun) and run.stepped


@dataclass
class Narration(ScreenPart):
    """Shows what the executor decided; the screen lays out its ``widget``."""

    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation

    def __post_init__(self) -> None:
        self.widget = Narrator()
        self.widget.charset, self.widget.display = self.host.charset, False

    def show(self, shown: bool = True) -> None:
        """Show or hide it."""
        self.widget.display = shown
        self.host.redraw()

    def draw(self) -> None:
        """Show the moment on screen, if it is shown."""
        if self.widget.display:
            self.widget.stepped = was_stepped(self.runs.run, self.navigation)
            self.widget.now, self.widget.timeline = self.navigation.now, self.runs.timeline

    def action_narrate(self) -> None:
        """Show or hide it."""
        self.show(not self.widget.display)
