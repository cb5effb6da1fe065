"""Ends the console in order: by exit, signal or fault, after pending mounts, with one sentence on a fault."""

import asyncio
import platform
import sys
import traceback
from functools import partial
from time import monotonic
from typing import Any

from rich.console import RenderableType
from textual.css.query import NoMatches
from textual.widget import MountError
from textual.worker import WorkerFailed

from cbtui.terminal.garbage_collector import survivors_frozen
from cbtui.terminal.interrupts import Interruption, deferred_interrupt, ending_signals_on_loop
from cbtui.terminal.pending_keys import MOUNT_TIMEOUT, PatientApp
from cbtui.text.output import shown
from cbtui.version import own_version
from lessons.personal import state_folder

FAULT = "fault.txt"
"""The file in the state folder that a fault of the console itself is written to."""
_MISSED = (NoMatches, MountError)
"""Errors of widgets that start while an app ends: Textual no longer mounts their children."""
_RETRY = 0.02
"""Seconds between two checks whether everything is mounted."""


class EndingApp(PatientApp):
    """An app that ends in order on exit, signals and faults, even while widgets are being mounted."""

    def __init__(self) -> None:
        super().__init__()
        self._interruption = Interruption()
        self._told_at: float | None = None
        self._leaving = False
        self.saved: list[str] = []
        """Sentences on what was saved as screens were left."""
        self._fault: str | None = None

    def run(self, *args: Any, **options: Any) -> Any:
        """Run to the end, and say then what was saved as screens were left, and what ended it, if a fault.

        Raises KeyboardInterrupt where Ctrl-C came before the app hears it, or after.
        """
        with deferred_interrupt() as self._interruption:
            result = super().run(*args, **options)
            said = [*self.saved, *([] if self._fault is None else [self._fault])]
            sys.stderr.writelines(shown(f"{sentence}\n") for sentence in said)
        return result

    async def run_async(self, *args: Any, **options: Any) -> Any:
        """Run in a terminal, which gets back what it lent when the app is told to end.

        It is by Ctrl-C from elsewhere, by ``kill``, and by the terminal itself when its window is closed.
        """
        with ending_signals_on_loop(lambda number: self.exit(None, 128 + number)), survivors_frozen():
            return None if self._interruption.came else await super().run_async(*args, **options)

    def exit(self, result: None = None, return_code: int = 0, message: RenderableType | None = None) -> None:
        """End as soon as all widgets have mounted their children."""
        self._told_at = self._told_at or monotonic()
        if self.is_mounting and monotonic() < self._told_at + MOUNT_TIMEOUT:
            again = partial(self.exit, result, return_code, message)
            asyncio.get_running_loop().call_later(_RETRY, again)
        else:
            self._leaving = True
            super().exit(result, return_code, message)

    def _handle_exception(self, error: Exception) -> None:
        cause = error.error if isinstance(error, WorkerFailed) else error
        if not (self._leaving and isinstance(cause, _MISSED)):
            super()._handle_exception(error)

    def _fatal_error(self) -> None:
        # Of Textual: the exception that is being handled ends the app, which prints all of it.
        self._fault = self._fault or _told_of_fault()
        self._close_messages_no_wait()


def _told_of_fault() -> str:
    """Say what exception is being handled, and write what a developer wants to know of it into a file."""
    kind, error, _ = sys.exc_info()
    said = f"cbtui: a fault of its own ended the console ({getattr(kind, '__name__', kind)}: {error})."
    details = f"cbtui {own_version()}, Python {platform.python_version()}\n{traceback.format_exc()}"
    file = state_folder() / FAULT
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(details, encoding="utf-8")
    except OSError:
        return f"{said}\n{details}"
    return f"{said} What a report of it needs is in {file}"
