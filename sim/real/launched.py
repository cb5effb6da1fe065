"""The programs that a run starts on real rclpy: from their start until all have ended."""

import signal
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from selectors import BaseSelector
from typing import NamedTuple

from sim.real.programs import Program
from sim.real.wire import Uncaught
from sim.trace.events import AnyEvent, ProcessAppeared, ProcessEnded

STOPPED = "it was stopped"
"""What is said of a program that ended because somebody wanted that."""


class Outcome(NamedTuple):
    """How programs ended, as a sentence, whether they failed, and the exception that ended one."""

    reason: str
    failed: bool
    error: str = ""


class LaunchedPrograms:
    """Starts programs, each with a command of its own, and knows which of them run.

    Their probes listen in ``folder``. ``take`` gets what they tell, ``record`` the events of their beginnings
    and ends, ``show`` what they print.
    """

    def __init__(
        self,
        selector: BaseSelector,
        folder: Path,
        commands: Sequence[Sequence[str]],
        environment: Mapping[str, str],
        take: Callable[..., None],
        record: Callable[[AnyEvent], None],
        show: Callable[[str, bool, int], None],
    ) -> None:
        self._selector = selector
        self._folder = folder
        self._commands = commands
        self._environment = environment
        self._take = take
        self._record = record
        self._show = show
        self._programs: list[Program] = []
        self._running: list[Program] = []
        self._failure: Outcome | None = None

    def start(self) -> None:
        """Start the programs, each in a process of its own."""
        several = len(self._commands) > 1
        for place, command in enumerate(self._commands, start=1):
            number = place if several else 0
            if several:
                self._record(ProcessAppeared(0, number, f"{Path(command[1]).stem}-{place}"))
            self._programs.append(
                Program(self._selector, command, self._environment, number, self._take, self._show)
            )
        self._running = list(self._programs)

    def look(self) -> None:
        """Listen to the probes that can be listened to, and take note of the programs that have ended."""
        for program in self._running:
            program.look(self._folder)
        for program in [each for each in self._running if each.has_ended]:
            self._running.remove(program)
            outcome = _outcome(program)
            if program.number:
                self._record(ProcessEnded(0, program.number, outcome.reason, program.status))
            if outcome.failed and self._failure is None:
                reason = f"{program.name}: {outcome.reason}" if program.number else outcome.reason
                self._failure = outcome._replace(reason=reason)

    @property
    def any_run(self) -> bool:
        """Whether one of them has not ended."""
        return bool(self._running)

    def outcome(self) -> Outcome:
        """How they ended, taken together."""
        if self._failure is not None:
            return self._failure
        if not self._programs:
            return Outcome(STOPPED, failed=False)
        if len(self._programs) == 1:
            return _outcome(self._programs[0])
        return Outcome("every program returned", failed=False)

    def interrupt(self) -> None:
        """Have all end as Ctrl-C would."""
        for program in self._running:
            program.signal(signal.SIGINT)

    def kill(self) -> list[str]:
        """End all that run by force; returns their names."""
        for program in self._running:
            program.signal(signal.SIGKILL)
        return [program.name for program in self._running]

    def type(self, text: str, *, ends: bool) -> None:
        """Have an only program read a text from its standard input; with ``ends``, no more will come."""
        if len(self._running) == 1:
            self._running[0].type(text, ends=ends)


def _outcome(program: Program) -> Outcome:
    uncaught, status = program.link.uncaught, program.status
    if uncaught is not None:
        return Outcome(f"{place_of(uncaught)}: the program raised {uncaught.error}", True, uncaught.error)
    if status == -signal.SIGINT or program.was_ended:
        return Outcome(STOPPED, failed=False)
    if status < 0:
        return Outcome(f"the program crashed by {signal.Signals(-status).name}", failed=True)
    reason = "the program returned" if status == 0 else f"the program ended with exit code {status}"
    return Outcome(reason, failed=status != 0)


def place_of(uncaught: Uncaught) -> str:
    """File and line at which the exception was raised that ended a program."""
    name = Path(uncaught.file).name
    return f"{name}:{uncaught.line}" if uncaught.line else name
