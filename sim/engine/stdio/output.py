"""What programs print: every line becomes an event, so that it cannot spoil the screen."""

import io
import sys
from codecs import getincrementaldecoder
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

from sim.ros.middleware.process import Process, current_process

if TYPE_CHECKING:
    from typing_extensions import Buffer  # Python has it from 3.12 on

_LONGEST = 4096
"""Characters of a line; a longer one is cut into several."""


class _TextStream(io.TextIOBase):
    """What programs ask of a stream besides writing to it."""

    def writable(self) -> bool:
        """Whether it can be written to: always."""
        return True

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """What a real stream would encode to."""
        return "utf-8"

    @cached_property
    def buffer(self) -> io.RawIOBase:
        """What takes bytes, as a real stream's does."""
        return _ByteStream(self)


class _ByteStream(io.RawIOBase):
    """A stream of bytes that hands them on as text; those that are no text are spelt out."""

    def __init__(self, text: _TextStream) -> None:
        self._text = text
        self._decoder = getincrementaldecoder("utf-8")("backslashreplace")

    def writable(self) -> bool:
        """Whether it can be written to: always."""
        return True

    def write(self, data: "Buffer") -> int:
        """Take bytes; a letter that is cut in two waits for its other half."""
        taken = bytes(data)
        self._text.write(self._decoder.decode(taken))
        return len(taken)


class LineSink(_TextStream):
    """A text stream that passes on whole lines, ended by LF, or by CR and LF as in a raw terminal."""

    def __init__(self, take: Callable[[str], None]) -> None:
        self._take = take
        self._rest = ""

    def write(self, text: str) -> int:
        """Take text; complete lines are handed on."""
        *lines, last = (self._rest + text).split("\n")
        for line in lines:
            for piece in _pieces(line.removesuffix("\r")) or [""]:
                self._take(piece)
        *whole, self._rest = _pieces(last) or [""]
        for piece in whole:
            self._take(piece)
        return len(text)

    def finish(self) -> None:
        """Hand on a last line that was not ended."""
        if rest := self.cut():
            self._take(rest)

    def cut(self) -> str:
        """Return the beginning of a line that has been written so far, and forget it."""
        rest, self._rest = self._rest, ""
        return rest


def _pieces(line: str) -> list[str]:
    return [line[start : start + _LONGEST] for start in range(0, len(line), _LONGEST)]


class ProcessStream(_TextStream):
    """Standard output or error of whichever process writes; their lines do not mix.

    ``take`` gets the process that wrote a line, the line, and whether it ends there; ``after_line`` is called
    on the writing thread once a line is whole.
    """

    def __init__(
        self, take: Callable[[Process, str, bool], None], after_line: Callable[[], None] = lambda: None
    ) -> None:
        self._take = take
        self._after_line = after_line

    def write(self, text: str) -> int:
        """Take text of the calling thread's process."""
        length = current_process().keep(self._sink).write(text)
        if text.endswith("\n"):
            self._after_line()
        return length

    def finish(self) -> None:
        """Hand on the last line of the calling thread's process."""
        current_process().keep(self._sink).finish()

    def show_rest(self) -> None:
        """Hand on what the calling thread's process wrote of a line so far."""
        process = current_process()
        if rest := process.keep(self._sink).cut():
            self._take(process, rest, False)

    def _sink(self) -> LineSink:
        process = current_process()
        return LineSink(lambda line: self._take(process, line, True))


def finish_lines() -> None:
    """Hand on the last lines of the calling thread's process, though they are not ended."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, ProcessStream):
            stream.finish()
