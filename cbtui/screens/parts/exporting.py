"""The key that exports the run on screen to a file in the current folder."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

from cbtui.runs.live.live_export import LiveExport
from cbtui.runs.live.live_run import ShownRun
from cbtui.screens.parts.finishing import FileFinisher
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.windows.export import CHOICES, ExportScreen

PROGRESS_INTERVAL = 0.25
"""Seconds between two updates of an export's progress."""
_PROGRESS_AFTER = 1.0
"""Seconds after which an export's progress is shown."""
_EXIT_TIMEOUT = 3.0
"""Seconds that a running export has when the screen is left."""


@dataclass
class Exports(ScreenPart):
    """Writes one export at a time, while the run and the screen go on."""

    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation
    finisher: FileFinisher
    clock: Callable[[], float] = monotonic
    _export: LiveExport | None = None
    _began: float = 0.0

    @property
    def percent(self) -> int | None:
        """The progress of an export in per cent; None if there is none or it has just begun."""
        export = self._export
        if export is None or export.over or self.clock() - self._began < _PROGRESS_AFTER:
            return None
        return int(100 * export.share)

    def show_progress(self) -> None:
        """Show the progress of an export."""
        if self._export is not None:
            if self._export.over:
                self._export = None
            self.host.redraw()

    def leave(self) -> None:
        """Abort a running export after a timeout; its partial file is removed."""
        if self._export is not None:
            asyncio.get_running_loop().call_later(_EXIT_TIMEOUT, self._export.give_up)

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer an export once there are events."""
        return self.runs.timeline.end > 0

    def action_export(self) -> None:
        """Ask for the format, and export the run so far."""
        if self._export is None or self._export.over:
            self.host.ask(ExportScreen(self.host.charset), self._begin)
        else:
            done = int(100 * self._export.share)
            self.host.tell(f"An export is being written, {done} % so far; the next can begin when it is done")

    def _begin(self, name: str | None) -> None:
        if name is None:
            return
        choice = CHOICES[name]
        window = self.navigation.window if choice.on_screen else None
        try:
            self._export = LiveExport(self.runs.run.material(), choice.form, window)
        except FileNotFoundError:
            self.host.tell("The current folder is gone; start the console in another one.")
            return
        self._began = self.clock()
        self.finisher.finish(self._export.write)
