"""Writes what programs log and print to this process's own output, as ROS does."""

import sys

from cbtui.looks.theme import Charset
from cbtui.text.cells import visible, without_tabs
from cbtui.text.colours import Colour, coloured
from cbtui.text.output import writing_to_stream
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import (
    AnyEvent,
    LineGiven,
    LineSaid,
    Logged,
    Notice,
    Printed,
    ProcessAppeared,
    ProcessId,
    RunStarted,
    ThreadAppeared,
    ThreadId,
    Typed,
)

_COLOURS = {"WARN": Colour.WARNING, "ERROR": Colour.BAD, "FATAL": Colour.BAD}
"""As ROS colours its log."""


class ProgramLog:
    """Prints log lines to stderr in ROS's format, and printed lines to the stream they were printed to.

    With ``echo`` it also prints typed text after an unfinished line, as a terminal would.
    """

    def __init__(self, *, echo: bool = False) -> None:
        self._echo = echo
        self._line_begun = False
        self._epoch = 0
        self._prefixes: dict[ProcessId, str] = {}
        self._processes: dict[ThreadId, ProcessId] = {}

    def print(self, events: list[AnyEvent]) -> None:
        """Print the lines among the events; control characters are made visible."""
        for event in events:
            match event:
                case Logged(t=t, severity=severity, logger=logger, text=text, thread=thread):
                    seconds, nanoseconds = divmod(self._epoch + t, SECOND)
                    prefix = self._prefix(self._processes.get(thread, 0))
                    line = f"{prefix}[{severity}] [{seconds}.{nanoseconds:09d}] [{logger}]: {text}"
                    write_line(line, error=True, colour=_COLOURS.get(severity))
                case Printed(text=text, error=error, process=process, ends=ends):
                    write_line(f"{self._prefix(process)}{text}", error=error, ends=ends)
                    self._line_begun = not ends or (error and self._line_begun)
                case Typed(text=text) if self._line_begun:
                    self._line_begun = False
                    if self._echo:
                        write_line(text.removesuffix("\n"), error=False)
                case LineGiven(text=text):
                    write_line(f"$ {text}", error=False)
                case LineSaid(text=text, error=error):
                    write_line(without_tabs(text), error=error)
                case Notice(severity=severity, text=text):
                    write_line(f"cbtui: {text}", error=True, colour=_COLOURS.get(severity))
                case ThreadAppeared(thread=thread, process=process):
                    self._processes[thread] = process
                case ProcessAppeared(process=process, label=label):
                    self._prefixes[process] = f"[{label}] "
                case RunStarted(epoch=epoch):
                    self._epoch = epoch

    def finish(self) -> None:
        """End an unfinished line."""
        if self._line_begun:
            write_line("", error=False)

    def _prefix(self, process: ProcessId) -> str:
        """The prefix of a program's lines if there are several, as ``ros2 launch`` writes it."""
        return self._prefixes.get(process, "")


def write_line(line: str, *, error: bool, ends: bool = True, colour: Colour | None = None) -> None:
    """Write a line, or without ``ends`` the beginning of one, to standard output or error.

    Control characters are made visible.

    Raises BrokenPipeError and CannotSayError, as ``cbtui.text.output.writing_to_stream``.
    """
    stream = sys.stderr if error else sys.stdout
    text = "\n".join(visible(part, Charset.BRAILLE) for part in line.split("\n"))
    text = coloured(text, colour, stream)
    with writing_to_stream():
        stream.write(f"{text}\n" if ends else text)
        if not ends:
            stream.flush()
