"""What programs log and print, written to this process's own output as ROS would."""

import sys

from cbtui.commands.output import saying
from cbtui.theme import Charset
from cbtui.widgets.cells import visible, without_tabs
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
)

_SECOND = 1_000_000_000


class ProgramLog:
    """Prints what the program logs as ROS does, and what it prints where it printed it."""

    def __init__(self) -> None:
        self._epoch = 0
        self._prefixes: dict[ProcessId, str] = {}
        self._processes: dict[ThreadId, ProcessId] = {}

    def print(self, events: list[AnyEvent]) -> None:
        """Print the lines among the events; control characters are shown, not obeyed."""
        for event in events:
            match event:
                case Logged(t=t, severity=severity, logger=logger, text=text, thread=thread):
                    seconds, nanoseconds = divmod(self._epoch + t, _SECOND)
                    prefix = self._prefix(self._processes.get(thread, 0))
                    write_line(
                        f"{prefix}[{severity}] [{seconds}.{nanoseconds:09d}] [{logger}]: {text}", error=True
                    )
                case Printed(text=text, error=error, process=process):
                    write_line(f"{self._prefix(process)}{text}", error=error)
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

    def _prefix(self, process: ProcessId) -> str:
        """What ``ros2 launch`` puts before the lines of one of several programs."""
        return self._prefixes.get(process, "")


def write_line(line: str, *, error: bool) -> None:
    """Write to standard output or error; control characters are shown, not obeyed.

    Raises BrokenPipeError and CannotSayError, as ``cbtui.commands.output.saying``.
    """
    stream = sys.stderr if error else sys.stdout
    text = "\n".join(visible(part, Charset.BRAILLE) for part in line.split("\n"))
    with saying():
        stream.write(f"{text}\n")
