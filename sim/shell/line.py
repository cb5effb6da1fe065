"""Carries out one line, on a thread of its own, in a process of its own."""

from __future__ import annotations

import signal
from collections.abc import Callable

from sim.shell.command_names import ELSEWHERE, listed
from sim.shell.commands import parse
from sim.shell.ground import Ground, TakeOutput
from sim.shell.parser import HelpAsked, UsageError
from sim.shell.session import CommandFailed, CommandInterrupted, LineExit, ShellSession
from sim.shell.splitting import LineError, split
from sim.shell.starter import LineStarter

_USAGE_STATUS = 2
_INTERRUPTED = int(signal.SIGINT)
"""What ros2 ends with after Ctrl-C."""


class ShellLine:
    """A ``ros2`` line, whose node is hidden; ``starter`` starts its programs.

    ``take`` gets what it prints and ``end``, last of all, its exit status, both on the line's thread. A line
    that the end of the run cuts off has no status.
    """

    def __init__(
        self, ground: Ground, text: str, starter: LineStarter, take: TakeOutput, end: Callable[[int], None]
    ) -> None:
        self._text = text
        self._end = end
        self._session = ShellSession(ground, starter, take)

    def start(self) -> None:
        """Begin. Does not wait; call it on a thread that has the ground's time."""
        self._session.process.start_thread(self._run)

    def interrupt(self) -> None:
        """End the line as Ctrl-C would. Any thread may call it, again if a started program does not end."""
        self._session.process.on_own_time(self._session.interrupt)

    def _run(self) -> None:
        try:
            status = self._status()
        finally:
            self._session.close()
        self._end(status)

    def _status(self) -> int:
        """Carry the line out, print the message of its end if there is one, and return the exit status."""
        try:
            self._carry_out()
        except HelpAsked as asked:
            self._session.say(str(asked).rstrip("\n"))
            return 0
        except CommandInterrupted:
            return _INTERRUPTED
        except LineExit as ended:
            return ended.status
        except Exception as error:  # noqa: BLE001 -- ros2 ends with a traceback; this is its last line
            text, status = _complaint(error)
            self._session.complain(text)
            return status
        return 0

    def _carry_out(self) -> None:
        words = split(self._text)
        if words and words[0] in ELSEWHERE:
            raise CommandFailed(f"ros2 {words[0]} is not carried out here; {listed()} are")
        arguments = parse(words)
        self._session.check()
        arguments.verb.carry_out(self._session, arguments)


def _complaint(error: Exception) -> tuple[str, int]:
    """Return the message of an error, and the exit status."""
    if isinstance(error, UsageError):
        return str(error), _USAGE_STATUS
    if isinstance(error, LineError):
        return str(error), error.status
    # Errors of the model and of the shell are sentences; Python's need their names.
    is_sentence = isinstance(error, NotImplementedError) or type(error).__module__.startswith(
        ("sim.", "rclpy.")
    )
    return str(error) if is_sentence else f"{type(error).__name__}: {error}", 1
