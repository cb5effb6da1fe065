"""The terminal driver: it tolerates a terminal that closes, and a process that is stopped at any moment."""

import os
import signal
from asyncio import TimerHandle
from collections.abc import Callable
from typing import IO, Any, cast

from textual.drivers.linux_driver import LinuxDriver

_CHECK_INTERVAL = 1.0
"""Seconds between two checks whether the terminal is still there."""


class TerminalDriver(LinuxDriver):
    """Ends the app once the terminal is gone, and discards its output, so that it can shut down."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        terminal: Any = self._file
        self._file = cast("Any", _SurvivingFile(terminal))
        self._next_look: TimerHandle | None = None

    def start_application_mode(self) -> None:
        """Take the terminal, and check that it stays: without job control (``su -c``) no SIGHUP comes."""
        super().start_application_mode()  # type: ignore[no-untyped-call]
        self._check_terminal()

    def _check_terminal(self) -> None:
        if self._next_look is not None:
            self._next_look.cancel()
        if os.isatty(self.fileno):
            self._next_look = self._loop.call_later(_CHECK_INTERVAL, self._check_terminal)
        else:
            self._app.exit(None, 128 + signal.SIGHUP)

    def stop_application_mode(self) -> None:
        """Give the terminal back; from now on SIGCONT, which a closing terminal sends as well, is ignored.

        Otherwise the driver would take the terminal again, with an input thread that nobody ends.
        """
        signal.signal(signal.SIGCONT, signal.SIG_DFL)
        super().stop_application_mode()

    def suspend_application_mode(self) -> None:
        """Give the terminal back until SIGCONT or ``resume_application_mode``."""
        super().suspend_application_mode()
        signal.signal(signal.SIGCONT, self._sigcont_application)

    def _sigcont_application(self, *signal_and_frame: Any) -> None:
        """Continue after SIGCONT; after SIGSTOP, which has no handler, the terminal is first released.

        Otherwise the driver would save its own settings as the terminal's, and start a second input thread.
        A process that was started in the background has stopped before it took the terminal.
        """
        if self._is_writing():
            self._loop.call_soon_threadsafe(self._sigcont_application)
            return
        if signal.getsignal(signal.SIGCONT) is signal.SIG_DFL:  # the terminal was given back meanwhile
            return
        if self._auto_restart and self._writer_thread is not None and not self._must_signal_resume:
            self.suspend_application_mode()
            self._must_signal_resume = True
        super()._sigcont_application(*signal_and_frame)

    def _sigtstp_application(self, *signal_and_frame: Any) -> None:
        """Stop on SIGTSTP."""
        if self._is_writing():
            self._loop.call_soon_threadsafe(self._sigtstp_application)
        else:
            super()._sigtstp_application(*signal_and_frame)

    def _is_writing(self) -> bool:
        """Whether a signal may have come while the main thread writes.

        Then a handler that writes would wait for ever for the lock of Textual's queue of output, which the
        main thread holds.
        """
        return self._writer_thread is not None and self._writer_thread._queue.mutex.locked()


class _SurvivingFile:
    """A terminal's file; once the terminal is gone, output is discarded."""

    def __init__(self, file: IO[str]) -> None:
        self._file = file

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    def write(self, text: str) -> int:
        """Write, to the null device if the terminal is gone."""
        self._without_failing(lambda: self._file.write(text))
        return len(text)

    def flush(self) -> None:
        """Flush the file."""
        self._without_failing(self._file.flush)

    def _without_failing(self, step: Callable[[], object]) -> None:
        try:
            step()
        except OSError:
            # The rest of Python's buffer is written at exit, and must not fail either.
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._file.fileno())
            os.close(nowhere)
            step()
