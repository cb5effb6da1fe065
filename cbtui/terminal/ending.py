"""Orderly shutdown of the console: on exit, signal or fault, after pending mounts."""

import asyncio
import platform
import sys
import traceback
from collections.abc import Coroutine
from functools import partial
from time import monotonic
from typing import Any

from rich.console import RenderableType
from textual.css.query import NoMatches
from textual.widget import MountError
from textual.worker import WorkerFailed

from cbtui.terminal.background import BackgroundTasks
from cbtui.terminal.garbage_collector import collect_closed_screens, survivors_frozen
from cbtui.terminal.interrupts import Interruption, deferred_interrupt, ending_signals_on_loop
from cbtui.terminal.pending_keys import MOUNT_TIMEOUT, PendingKeysApp
from cbtui.terminal.textual_internals import forget_drawn_styles
from cbtui.text.output import shown
from cbtui.version import own_version
from lessons.personal import state_folder

FAULT = "fault.txt"
"""The file in the state folder with the last internal error."""
_MISSED = (NoMatches, MountError)
"""Errors of widgets that start during shutdown, when Textual no longer mounts their children."""
_RETRY = 0.02
"""Seconds between two checks whether all widgets are mounted."""


class EndingApp(PendingKeysApp):
    """An app that shuts down in order on exit, signals and faults, even while widgets are being mounted."""

    def __init__(self) -> None:
        super().__init__()
        self._interruption = Interruption()
        self._exit_requested_at: float | None = None
        self._leaving = False
        self.saved: list[str] = []
        """Sentences on files that were saved as screens closed."""
        self._fault: str | None = None
        self._endings = BackgroundTasks()

    def run(self, *args: Any, **options: Any) -> Any:
        """Run to the end, then print what was saved and the fault that ended the app, if any.

        Raises KeyboardInterrupt if Ctrl-C came before or after the app handled signals.
        """
        with deferred_interrupt() as self._interruption:
            result = super().run(*args, **options)
            said = [*self.saved, *([] if self._fault is None else [self._fault])]
            sys.stderr.writelines(shown(f"{sentence}\n") for sentence in said)
        return result

    async def run_async(self, *args: Any, **options: Any) -> Any:
        """Run with handlers for SIGINT, SIGTERM and SIGHUP, so that the terminal is always restored."""
        with ending_signals_on_loop(lambda number: self.exit(None, 128 + number)), survivors_frozen():
            return None if self._interruption.came else await super().run_async(*args, **options)

    def exit(self, result: None = None, return_code: int = 0, message: RenderableType | None = None) -> None:
        """Exit as soon as all widgets have mounted their children."""
        self._exit_requested_at = self._exit_requested_at or monotonic()
        if self.is_mounting and monotonic() < self._exit_requested_at + MOUNT_TIMEOUT:
            again = partial(self.exit, result, return_code, message)
            asyncio.get_running_loop().call_later(_RETRY, again)
        else:
            self._leaving = True
            super().exit(result, return_code, message)

    def end_later(self, ending: Coroutine[None, None, None]) -> None:
        """End in the background what a closed screen leaves, as Textual takes no key until a screen is gone.

        The app waits for it before it exits.
        """
        self._endings.begin(ending)

    def collect_later(self) -> None:
        """Have what a closed screen leaves in memory collected once nobody types: it holds up a key."""
        forget_drawn_styles()
        self.when_idle(collect_closed_screens)

    async def on_unmount(self) -> None:
        """Wait for what closed screens have left."""
        try:
            await self._endings.wait()
        except Exception as error:  # noqa: BLE001 - told as a fault of the console
            self._handle_exception(error)

    def _handle_exception(self, error: Exception) -> None:
        cause = error.error if isinstance(error, WorkerFailed) else error
        if not (self._leaving and isinstance(cause, _MISSED)):
            super()._handle_exception(error)

    def _fatal_error(self) -> None:
        # Textual's own method would print the whole traceback.
        self._fault = self._fault or _fault_report()
        self._close_messages_no_wait()


def _fault_report() -> str:
    """Write the exception that is being handled to a file; returns a sentence on it."""
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
