"""The events of a run in a file, a line of JSON each, for programs that read them."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from sim.export.jsonl import JsonLines
from sim.recording.growing_file import GrowingFile
from sim.trace.events import AnyEvent


class EventsFile:
    """Writes events. After a failed write the file keeps its complete lines, and ``failure`` says why.

    An existing file keeps its content until ``begin``. Raises OSError if it cannot be opened, BrokenPipeError
    if it is a pipe whose reader has closed it.
    """

    def __init__(self, path: Path) -> None:
        self._new = None if path.exists() else path
        self._file = GrowingFile(path.open("ab", buffering=0), end=b"\n")
        self._lines = JsonLines()
        self.failure: str | None = None

    def begin(self) -> None:
        """Empty the file."""
        self._file.clear()

    def take(self, events: Sequence[AnyEvent]) -> None:
        """Write events."""
        if self.failure is None:
            self._try(lambda: self._file.write(b"".join(self._lines.lines(events))))

    def close(self) -> None:
        """Write buffered events and close, once. A new file without events is removed."""
        self._try(self._file.close)
        if self._new is not None and self._file.tell() == 0:
            with suppress(OSError):
                self._new.unlink()

    def _try(self, write: Callable[[], object]) -> None:
        try:
            write()
        except BrokenPipeError:
            raise
        except OSError as error:
            self.failure = self.failure or str(error.strerror)
