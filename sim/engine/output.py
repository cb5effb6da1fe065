"""What the program prints: every line becomes an event, so that it cannot spoil the screen."""

import io
from collections.abc import Callable

_LONGEST = 4096
"""Characters of a line; a longer one is cut into several."""


class LineSink(io.TextIOBase):
    """A text stream that hands on whole lines."""

    def __init__(self, take: Callable[[str], None]) -> None:
        self._take = take
        self._rest = ""

    def writable(self) -> bool:
        """Whether it can be written to: always."""
        return True

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """What a real stream would encode to."""
        return "utf-8"

    def write(self, text: str) -> int:
        """Take text; complete lines are handed on."""
        *lines, self._rest = (self._rest + text).split("\n")
        while len(self._rest) > _LONGEST:
            lines.append(self._rest[:_LONGEST])
            self._rest = self._rest[_LONGEST:]
        for line in lines:
            self._take(line)
        return len(text)

    def finish(self) -> None:
        """Hand on a last line that was not ended."""
        if self._rest:
            rest, self._rest = self._rest, ""
            self._take(rest)
