"""The terminal driver: it survives a terminal that is closed or a process that is stopped at any moment."""

import os
from collections.abc import Callable
from typing import IO, Any, cast

from textual.drivers.linux_driver import LinuxDriver


class TerminalDriver(LinuxDriver):
    """Discards output once the terminal is gone, so that the console can still shut down."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        terminal: Any = self._file
        self._file = cast("Any", _SurvivingFile(terminal))

    def _sigcont_application(self, *signal_and_frame: Any) -> None:
        """Go on; what was stopped without notice (SIGSTOP) has to give the terminal back before it takes it.

        Else it would remember its own settings as the terminal's, and have two threads read the same keys, of
        which one waits for ever.
        """
        if self._auto_restart and not self._must_signal_resume:
            self.suspend_application_mode()
            self._must_signal_resume = True
        super()._sigcont_application(*signal_and_frame)


class _SurvivingFile:
    """A file of a terminal that takes what is written even when the terminal is gone."""

    def __init__(self, file: IO[str]) -> None:
        self._file = file

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    def write(self, text: str) -> int:
        """Write, to nowhere if need be."""
        self._surely(lambda: self._file.write(text))
        return len(text)

    def flush(self) -> None:
        """Send what was written."""
        self._surely(self._file.flush)

    def _surely(self, step: Callable[[], object]) -> None:
        try:
            step()
        except OSError:
            # What Python still holds back is written as it ends, and must find a place too.
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._file.fileno())
            os.close(nowhere)
            step()
