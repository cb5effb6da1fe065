"""What programs log and print, written to this process's own output as ROS would."""

import sys

from cbtui.looks.theme import Charset
from cbtui.text.cells import visible, without_tabs
from cbtui.text.output import writing_to_stream
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
from sim.units import SECOND


class ProgramLog:
    """Prints what the program logs as ROS does, and what it prints where it printed it.

    With ``echo`` it also prints what is typed behind a line that was begun, as a terminal would.
    """

    def __init__(self, *, echo: bool = False) -> None:
        self._echo = echo
        self._line_begun = False
        self._epoch = 0
        self._prefixes: dict[ProcessId, str] = {}
        self._processes: dict[ThreadId, ProcessId] = {}

    def print(self, events: list[AnyEvent]) -> None:
        """Print the lines among the events; control characters are shown, not obeyed."""
        for event in events:
            match event:
                case Logged(t=t, severity=severity, logger=logger, text=text, thread=thread):
                    seconds, nanoseconds = divmod(self._epoch + t, SECOND)
                    prefix = self._prefix(self._processes.get(thread, 0))
                    write_line(
                        f"{prefix}[{severity}] [{seconds}.{nanoseconds:09d}] [{logger}]: {text}", error=True
                    )
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
                    write_line(f"cbtui: {text}", error=True)
                case ThreadAppeared(thread=thread, process=process):
                    self._processes[thread] = process
                case ProcessAppeared(process=process, label=label):
                    self._prefixes[process] = f"[{label}] "
                case RunStarted(epoch=epoch):
                    self._epoch = epoch

    def finish(self) -> None:
        """End a line that was begun."""
        if self._line_begun:
            write_line("", error=False)

    def _prefix(self, process: ProcessId) -> str:
        """What ``ros2 launch`` puts before the lines of one of several programs."""
        return self._prefixes.get(process, "")


def write_line(line: str, *, error: bool, ends: bool = True) -> None:
    """Write a line, or without ``ends`` the beginning of one, to standard output or error.

    Control characters are shown, not obeyed.

    Raises BrokenPipeError and CannotSayError, as ``cbtui.text.output.writing_to_stream``.
    """
    stream = sys.stderr if error else sys.stdout
    text = "\n".join(visible(part, Charset.BRAILLE) for part in line.split("\n"))
    with writing_to_stream():
        stream.write(f"{text}\n" if ends else text)
        if not ends:
            stream.flush()
