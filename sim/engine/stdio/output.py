"""Output of programs: every line becomes an event, so that it cannot disturb the screen."""

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
"""Limit for the characters of a line; a longer one is split."""


class _TextStream(io.TextIOBase):
    """The interface of a text stream that programs use besides ``write``."""

    def writable(self) -> bool:
        return True

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return "utf-8"

    @cached_property
    def buffer(self) -> io.RawIOBase:
        return _ByteStream(self)


class _ByteStream(io.RawIOBase):
    """A byte stream that passes its data on as text; bytes that are not UTF-8 become escapes."""

    def __init__(self, text: _TextStream) -> None:
        self._text = text
        self._decoder = getincrementaldecoder("utf-8")("backslashreplace")

    def writable(self) -> bool:
        return True

    def write(self, data: "Buffer") -> int:
        """Take bytes; an incomplete character waits for its rest."""
        taken = bytes(data)
        self._text.write(self._decoder.decode(taken))
        return len(taken)


class LineSink(_TextStream):
    """A text stream that passes on whole lines, ended by LF, or by CR and LF as in a raw terminal."""

    def __init__(self, take: Callable[[str], None]) -> None:
        self._take = take
        self._rest = ""

    def write(self, text: str) -> int:
        """Take text; pass complete lines on."""
        *lines, last = (self._rest + text).split("\n")
        for line in lines:
            for piece in _pieces(line.removesuffix("\r")) or [""]:
                self._take(piece)
        *whole, self._rest = _pieces(last) or [""]
        for piece in whole:
            self._take(piece)
        return len(text)

    def finish(self) -> None:
        """Pass on a last, unfinished line."""
        if rest := self.cut():
            self._take(rest)

    def cut(self) -> str:
        """Return and forget the unfinished part of the current line."""
        rest, self._rest = self._rest, ""
        return rest


def _pieces(line: str) -> list[str]:
    return [line[start : start + _LONGEST] for start in range(0, len(line), _LONGEST)]


class ProcessStream(_TextStream):
    """Standard output or error of all processes; their lines do not mix.

    ``take`` gets the writing process, a line, and whether the line ends there; ``after_line`` is called on
    the writing thread after each complete line.
    """

    def __init__(
        self, take: Callable[[Process, str, bool], None], after_line: Callable[[], None] = lambda: None
    ) -> None:
        self._take = take
        self._after_line = after_line

    def write(self, text: str) -> int:
        """Take text of the calling thread's process."""
        length = current_process().local(self._sink).write(text)
        if text.endswith("\n"):
            self._after_line()
        return length

    def finish(self) -> None:
        """Pass on the last line of the calling thread's process."""
        current_process().local(self._sink).finish()

    def show_rest(self) -> None:
        """Pass on the unfinished line of the calling thread's process."""
        process = current_process()
        if rest := process.local(self._sink).cut():
            self._take(process, rest, False)

    def _sink(self) -> LineSink:
        process = current_process()
        return LineSink(lambda line: self._take(process, line, True))


def finish_lines() -> None:
    """Pass on the unfinished lines of the calling thread's process."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, ProcessStream):
            stream.finish()
