"""Carries out one line, on a thread of its own, in a process of its own."""

from __future__ import annotations

import signal

from sim.shell.command_names import ELSEWHERE, listed
from sim.shell.commands import parse
from sim.shell.ground import Ground
from sim.shell.parser import HelpAsked, UsageError
from sim.shell.session import CommandFailed, CommandInterrupted, Ended, ShellSession
from sim.shell.splitting import LineError, split
from sim.shell.tools import Tools

_USAGE_STATUS = 2
_INTERRUPTED = int(signal.SIGINT)
"""What ros2 ends with after Ctrl-C."""


class ShellLine:
    """A ``ros2`` line. What it prints and how it ends goes to ``tools``; its node is hidden."""

    def __init__(self, ground: Ground, text: str, tools: Tools) -> None:
        self._text = text
        self._session = ShellSession(ground, tools)

    def start(self) -> None:
        """Begin. It does not wait; call it on a thread that has the ground's time."""
        self._session.process.start_thread(self._run)

    def interrupt(self) -> None:
        """End the line as Ctrl-C would; again if what it started does not end. Any thread may call it."""
        self._session.process.on_own_time(self._session.interrupt)

    def _run(self) -> None:
        try:
            status = self._status()
        finally:
            self._session.close()
        self._session.tools.ended(status)

    def _status(self) -> int:
        """Carry the line out, say what is to be said of its end, and return the exit status."""
        try:
            self._carry_out()
        except HelpAsked as asked:
            self._session.say(str(asked).rstrip("\n"))
            return 0
        except CommandInterrupted:
            return _INTERRUPTED
        except Ended as ended:
            return ended.status
        except Exception as error:  # noqa: BLE001 -- as ros2, which ends with a traceback: the last line of it
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
    """What to say of an error, and the exit status."""
    if isinstance(error, UsageError):
        return str(error), _USAGE_STATUS
    if isinstance(error, CommandFailed | LineError):
        return str(error), error.status
    # The model's own errors are sentences; Python's say little without their names.
    is_sentence = isinstance(error, NotImplementedError) or type(error).__module__.startswith(
        ("sim.", "rclpy.")
    )
    return str(error) if is_sentence else f"{type(error).__name__}: {error}", 1
