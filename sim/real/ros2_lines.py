"""The ``ros2`` lines of a run on real rclpy.

The command ``ros2`` runs them if it is found, as in a terminal where ROS is sourced. Otherwise a process of
cbtui's own Python does, which needs rclpy there.
"""

import shlex
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import count
from pathlib import Path
from selectors import BaseSelector
from typing import TYPE_CHECKING, NamedTuple

from sim.engine import commands
from sim.probes.on_path.cbtui_probe import FOLDER
from sim.real.companions import Companion
from sim.real.launched import LaunchedPrograms, ros2_command
from sim.real.programs import OnExit, Program, Start
from sim.real.wire import Interrupted, NodesKnown, ProbeLine, ProgramEnded, ProgramWanted
from sim.trace.events import AnyEvent, LineCompleted, LineEnded, LineGiven, LineSaid, NodeAppeared

if TYPE_CHECKING:
    from sim.launch import LaunchRun

_STARTING = ("run", "launch")
"""Commands whose programs are watched."""
_FIRST_LAUNCHED = 1 << 40
"""The first number of the lines of launch files, which the trace does not show as lines."""


class _Line(NamedTuple):
    """The receivers of a line's output and exit status."""

    show: Callable[[str, bool], None]
    end: OnExit


class Ros2Lines:
    """All ``ros2`` lines. ``take`` gets what the lines send, ``record`` the events of the lines."""

    def __init__(
        self,
        selector: BaseSelector,
        environment: Mapping[str, str],
        folders: Sequence[Path],
        take: Callable[[list[ProbeLine]], None],
        record: Callable[[AnyEvent], None],
        starter: LaunchedPrograms | None,
    ) -> None:
        self._selector = selector
        self._environment = environment
        self._take = take
        self._record = record
        self._starter = starter
        self._ros2 = ros2_command(environment)
        command = [sys.executable, "-m", "sim.real.line_process", *map(str, folders)]
        quiet = {name: value for name, value in environment.items() if name != FOLDER}
        self._companion = Companion(selector, command, quiet, self._told)
        self._lines: dict[int, _Line] = {}
        self._processes: dict[int, Program] = {}
        self._started: dict[int, Program | LaunchRun] = {}
        self._launched = count(_FIRST_LAUNCHED)
        self._nodes: list[str] = []
        """The nodes that the line process does not know yet."""

    def prepare(self) -> None:
        """Start the line process, so that it knows the graph before the first line."""
        if self._ros2 is None:
            self._companion.start()

    def hear(self, lines: Iterable[ProbeLine]) -> None:
        """Note the nodes of the programs."""
        self._nodes += [line.name for line in lines if isinstance(line, NodeAppeared)]

    def begin(self, number: int, text: str) -> None:
        """Run a line."""

        def show(said: str, error: bool) -> None:
            self._record(LineSaid(0, number, said, error))

        def end(status: int) -> None:
            self._record(LineEnded(0, number, status))

        self._record(LineGiven(0, number, text))
        self._begin(number, text, _Line(show, end))

    def begin_launched(
        self, words: Sequence[str], show: Callable[[str, bool], None], on_exit: OnExit
    ) -> Callable[[], None]:
        """Run a line of a launch file; returns a function that interrupts it."""
        number = next(self._launched)
        self._begin(number, shlex.join(words), _Line(show, on_exit))
        return lambda: self.interrupt(number)

    def _begin(self, number: int, text: str, line: _Line) -> None:
        self._lines[number] = line
        if self._ros2 is None:
            self._companion.say(NodesKnown(tuple(self._nodes)))
            self._companion.say(commands.RunLine(number, text))
            self._nodes.clear()
            return
        from sim.shell.splitting import LineError, split

        try:
            words = split(text)
        except LineError as error:
            self._say_and_end(number, str(error), error.status)
            return
        environment = dict(self._environment)
        if words[:1] not in ([each] for each in _STARTING):
            environment.pop(FOLDER, None)

        def show(said: str, error: bool, _process: int) -> None:
            line.show(said, error)

        start = Start([self._ros2, *words], environment)
        self._processes[number] = Program(self._selector, start, "ros2", 0, _ignore, show)

    def interrupt(self, number: int) -> None:
        """Interrupt a line as Ctrl-C would, if it still runs."""
        if number in self._processes:
            self._processes[number].interrupt()
        elif number in self._lines:
            self._companion.say(commands.InterruptLine(number))

    def complete(self, number: int, text: str, cursor: int) -> None:
        """Report the completions at ``cursor``; none with the command ``ros2``, which takes too long."""
        if self._ros2 is not None or self._companion.is_over:
            self._record(LineCompleted(0, number, cursor, ()))
        else:
            self._companion.say(commands.CompleteLine(number, text, cursor))

    def look(self) -> None:
        """Notice lines that have ended, and the end of the line process."""
        for number, process in [*self._processes.items()]:
            if process.has_ended:
                del self._processes[number]
                self._end(number, process.status)
        if self._companion.is_over:
            for number in [each for each in self._lines if each not in self._processes]:
                self._say_and_end(number, self._why_not(), 1)

    def stop(self) -> None:
        """Kill all lines."""
        for process in self._processes.values():
            process.kill()
        self._companion.stop()

    def _why_not(self) -> str:
        if self._companion.has_spoken:
            return "the process that carries out ros2 lines has ended; run again to give more of them"
        needs = f"ros2 lines need rclpy beside cbtui ({sys.executable}), or the command ros2 of a sourced ROS"
        return f"{needs}: pip install 'cbtui[ros]' there, or source ROS before cbtui starts"

    def _say_and_end(self, number: int, text: str, status: int) -> None:
        self._lines[number].show(text, True)
        self._end(number, status)

    def _end(self, number: int, status: int) -> None:
        self._started.pop(number, None)
        self._lines.pop(number).end(status)

    def _told(self, told: list[ProbeLine]) -> None:
        rest: list[ProbeLine] = []
        for each in told:
            match each:
                case LineSaid(line=number) if number in self._lines:
                    self._lines[number].show(each.text, each.error)
                case LineEnded(line=number) if number in self._lines:
                    self._end(number, each.status)
                case ProgramWanted():
                    self._start(each)
                case Interrupted(line=number) if number in self._started:
                    self._started[number].interrupt()
                case LineSaid() | LineEnded() | Interrupted():
                    pass
                case _:
                    rest.append(each)
        self._take(rest)

    def _start(self, wanted: ProgramWanted) -> None:
        """Start what a line asks for, and report its end to the line."""
        from sim.launch import LaunchError
        from sim.packages import PackageError

        def ended(status: int) -> None:
            self._companion.say(ProgramEnded(wanted.line, status))

        if self._starter is None:
            self._lines[wanted.line].show(_WATCHED, True)
            ended(1)
            return
        start = self._starter.launch_of if wanted.is_launch else self._starter.start_executable
        try:
            started = start(wanted.package, wanted.file, wanted.arguments, ended)
        except (LaunchError, PackageError) as error:
            self._lines[wanted.line].show(str(error), True)
            ended(1)
        else:
            self._started[wanted.line] = started


_WATCHED = "programs that others started are watched here: start more with cbtui probe -- COMMAND"


def _ignore(_lines: object, process: int = 0) -> None:
    """Drop what a probe sends."""
