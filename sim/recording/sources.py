"""The source files of a run's programs, taken along in its recording to explain it elsewhere."""

from collections.abc import Callable
from pathlib import Path

from sim.foreign_file import read_bytes

_LONGEST = 500_000
"""Bytes of a file; longer ones stay behind."""
_MOST = 5_000_000
"""Bytes of all files."""


class Sources:
    """The files that are wanted, each once, until they are handed over; as far as there is room."""

    def __init__(self) -> None:
        self._seen = {""}
        self._wanted: list[str] = []
        self._room = _MOST

    def want(self, path: str) -> None:
        """Take a file along, if it can be read and is not too long."""
        if path not in self._seen:
            self._seen.add(path)
            self._wanted.append(path)

    def attach(self, attach: Callable[[str, bytes], None]) -> None:
        """Hand over the path and the text of what has been wanted since the last time."""
        wanted, self._wanted = self._wanted, []
        for path in wanted:
            text = _text_of(Path(path), min(_LONGEST, self._room))
            if text is not None:
                self._room -= len(text)
                attach(path, text)


def _text_of(path: Path, longest: int) -> bytes | None:
    try:
        text = read_bytes(path, longest)
        text.decode()
    except (OSError, ValueError):
        return None
    return text
