"""The source files of a run's programs, attached to its recording to explain it elsewhere."""

from collections.abc import Callable, Mapping
from pathlib import Path

from sim.files.untrusted import read_bytes

_LONGEST = 500_000
"""Bytes of a file at most; longer ones are skipped."""
_MOST = 5_000_000
"""Bytes of all files at most."""


class SourceAttachments:
    """A queue of source files to attach, each once and within a limit of bytes.

    ``texts`` are attached in place of what the files hold, by path.
    """

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = texts
        self._seen = {""}
        self._requested: list[str] = []
        self._room = _MOST

    def request(self, path: str) -> None:
        """Queue a file; it is skipped later if it cannot be read or is too long."""
        if path not in self._seen:
            self._seen.add(path)
            self._requested.append(path)

    def attach(self, attach: Callable[[str, bytes], None]) -> None:
        """Pass path and text of each queued file to ``attach``, and empty the queue."""
        requested, self._requested = self._requested, []
        for path in requested:
            own = self._texts.get(path)
            text = _text_of(Path(path), min(_LONGEST, self._room)) if own is None else own.encode()
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
