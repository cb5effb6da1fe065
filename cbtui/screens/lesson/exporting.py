"""Takes the run on screen to other programs, as a file in the current folder."""

import asyncio
from time import monotonic

from cbtui.runs.live.live_export import LiveExport
from cbtui.screens.export import Choice, ExportScreen
from cbtui.screens.lesson.helping import HelpingScreen

_SOON = 1.0
"""Seconds after which it is told how far an export has come."""
_GRACE = 3.0
"""Seconds that an export gets to come to its end when the screen is left."""
_TELL = 0.25
"""Seconds after which it is told anew."""


class ExportingScreen(HelpingScreen):
    """Writes one export at a time, while the run and the screen go on."""

    _export: LiveExport | None = None
    _export_began = 0.0

    @property
    def _exported(self) -> int | None:
        """How many per cent of an export are done; None if there is none that takes its time."""
        export = self._export
        if export is None or export.over or monotonic() - self._export_began < _SOON:
            return None
        return int(100 * export.share)

    def on_mount(self) -> None:
        """Tell from time to time how far an export has come."""
        self.set_interval(_TELL, self._tell_of_export)

    async def on_unmount(self) -> None:
        """Let an export come to its end, but not for long: what is half done then is taken away."""
        if self._export is not None:
            asyncio.get_running_loop().call_later(_GRACE, self._export.give_up)

    def _tell_of_export(self) -> None:
        if self._export is not None:
            if self._export.over:
                self._export = None
            self._stale = True

    def action_export(self) -> None:
        """Ask for the format, and export the run so far."""
        if self._export is None or self._export.over:
            self.app.push_screen(ExportScreen(self._charset), self._begin_export)
        else:
            done = int(100 * self._export.share)
            self._tell(f"An export is being written, {done} % of it so far; the next can begin after it")

    def _begin_export(self, choice: Choice | None) -> None:
        if choice is None:
            return
        run = self._run
        window = self._playhead.window(run.timeline.end) if choice.on_screen else None
        try:
            self._export = LiveExport(run.material(), choice.form, window)
        except FileNotFoundError:
            self._tell("The current folder is gone; start the console in another one.")
            return
        self._export_began = monotonic()
        self._finish(self._export.write)
