"""The programs that a run starts on real rclpy, until all have ended.

Launch files are run by ``ros2 launch`` if there is a ``ros2``, else by ``sim.launch``.
"""

from __future__ import annotations

import heapq
import os
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import count
from pathlib import Path
from selectors import BaseSelector
from typing import TYPE_CHECKING, TypeAlias

from sim.engine.failures.cause import Cause
from sim.engine.setup import ProgramSetup, RealRos
from sim.real.keyboard import RealKeyboard
from sim.real.programs import ON_PATH, OnExit, Program, Start
from sim.real.watched import WatchedProcesses
from sim.trace.events import AnyEvent, ProcessAppeared, ProcessEnded

if TYPE_CHECKING:
    from sim.launch import LaunchRun, OnOutput, ProcessSpec
    from sim.packages import Executable, Packages


RunLine: TypeAlias = Callable[[Sequence[str], Callable[[str, bool], None], OnExit], Callable[[], None]]
"""Carries out the words of a ``ros2`` line; gets what takes its output and its exit status.

Returns what interrupts the line.
"""


class LaunchedPrograms:
    """Starts programs as processes, and follows which of them run.

    Their probes, and those of their child processes, listen in ``folder``. ``take`` gets the probes' lines,
    ``record`` the events about starts and ends, ``show`` what programs print. ``carry_out`` carries out the
    ``ros2`` lines of launch files. It is the machine on which ``sim.launch`` starts things.
    """

    def __init__(
        self,
        selector: BaseSelector,
        folder: Path,
        programs: Sequence[ProgramSetup],
        python: str,
        environment: Mapping[str, str],
        keyboard: RealKeyboard,
        take: Callable[..., None],
        record: Callable[[AnyEvent], None],
        show: Callable[[str, bool, int], None],
        carry_out: RunLine,
    ) -> None:
        self._selector = selector
        self._folder = folder
        self._setup = programs
        self._python = python
        self._environment = environment
        self._keyboard = keyboard
        self._take = take
        self.record = record
        self.show = show
        self.carry_out = carry_out
        self._programs: list[Program] = []
        self._running: dict[Program, OnExit] = {}
        self._launches: list[LaunchRun] = []
        self._due: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = count(1)
        self._order = count()
        self._failure: Cause | None = None
        self._children = WatchedProcesses(
            selector, RealRos(watched=str(folder)), take, record, self._numbers, self._is_own
        )

    def start(self) -> None:
        """Start the programs and launch files that the run was set up with."""
        first = self._setup[0]
        if len(self._setup) == 1 and not first.is_launch_file:
            command = [self._python, first.path, *first.arguments]
            name, terminal = Path(first.path).name, self._keyboard.near
            start = Start(command, self.environment(), terminal=terminal, owns_terminal=True)
            self._begin(Program(self._selector, start, name, 0, self._take, self.show), _ignore)
            return
        for place, program in enumerate(self._setup, start=1):
            path = Path(program.path)
            if program.is_launch_file:
                self._launch_or_fail(path, program.arguments)
            else:
                command = [self._python, program.path, *program.arguments]
                start = Start(command, self.environment(), terminal=self._keyboard.near)
                self.begin(start, f"{path.stem}-{place}", _ignore)

    def begin(
        self,
        start: Start,
        label: str,
        on_exit: OnExit,
        *,
        shows_stdout: bool = True,
        output_listener: Callable[[str, bool], None] | None = None,
    ) -> Program:
        """Start a program, which the trace shows as a process.

        A launch file passes ``output_listener``, and ends the programs that it started.
        """
        number = self.announce(label)

        def show(text: str, error: bool, process: int) -> None:
            if error or shows_stdout:
                self.show(text, error, process)

        program = Program(self._selector, start, label, number, self._take, show)
        program.output_listener = output_listener
        return self._begin(program, on_exit)

    def _begin(self, program: Program, on_exit: OnExit) -> Program:
        self._programs.append(program)
        self._running[program] = on_exit
        return program

    def announce(self, label: str) -> int:
        """Record a process; returns its number."""
        number = next(self._numbers)
        self.record(ProcessAppeared(0, number, label))
        return number

    # programs of packages

    @cached_property
    def packages(self) -> Packages:
        """The packages around the programs."""
        from sim.packages import find_packages, use_packages

        found = find_packages(self.folders)
        use_packages(found)
        return found

    @property
    def folders(self) -> list[Path]:
        """The folders in which packages are searched."""
        return [Path(each.path) for each in self._setup] or [Path.cwd()]

    def environment(self, changes: Mapping[str, str] | None = None, *folders: Path) -> dict[str, str]:
        """The environment of a program, with changes, and with folders at the front of Python's path."""
        changed = {**self._environment, **(changes or {})}
        path = [str(ON_PATH), *map(str, folders), *filter(None, [changed.get("PYTHONPATH")])]
        return {**changed, "PYTHONPATH": os.pathsep.join(path)}

    def command_of(self, executable: Executable, arguments: Sequence[str]) -> list[str]:
        """The command that runs an executable of a package, which need not be installed."""
        if not executable.module:
            return [self._python, str(executable.path), *arguments]
        begin = f"import sys; sys.argv[0] = {str(executable.path)!r}; from {executable.module} import "
        function = executable.function
        return [
            self._python,
            "-c",
            f"{begin}{function.partition('.')[0]}; sys.exit({function}())",
            *arguments,
        ]

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Program:
        """Start a program of a package; raises PackageError."""
        found = self.packages.package(package).executable(executable)
        environment = self.environment(None, found.folder)
        start = Start(self.command_of(found, arguments), environment, terminal=self._keyboard.near)
        return self.begin(start, f"{executable}-{next(self._order) + 1}", on_exit)

    def launch(self, path: Path, arguments: Sequence[str], on_exit: OnExit) -> Program | LaunchRun:
        """Start a launch file: with ROS's own launch where a ``ros2`` can be found, else with cbtui's.

        Raises:
            LaunchError: the launch file cannot be carried out.
        """
        ros2 = ros2_command(self._environment)
        if ros2 is not None:
            start = Start([ros2, "launch", str(path), *arguments], self.environment())
            return self.begin(start, path.name, on_exit)
        from sim.launch import LaunchError, LaunchRun

        launching = LaunchRun(path, arguments, self, packages=self.packages, on_finish=on_exit)
        self._launches.append(launching)
        try:
            launching.start()
        except LaunchError:
            self._launches.remove(launching)
            raise
        return launching

    def launch_of(
        self, package: str, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Program | LaunchRun:
        """Start a launch file of a package, or by its path; raises LaunchError and PackageError."""
        known = self.packages
        path = known.package(package).launch_file(launch_file) if package else Path(launch_file)
        return self.launch(path, arguments, on_exit)

    def _launch_or_fail(self, path: Path, arguments: Sequence[str]) -> None:
        from sim.launch import LaunchError

        try:
            self.launch(path, arguments, _ignore)
        except LaunchError as error:
            self._fail(Cause(str(error), failed=True))

    # the machine of sim.launch

    def start_process(self, spec: ProcessSpec, on_exit: OnExit, on_output: OnOutput) -> Program:
        """Start a program of a launch file."""
        from sim.packages import Executable

        executable = Executable(spec.executable, spec.path, spec.folder, spec.module, spec.function)
        command = self.command_of(executable, spec.arguments)
        environment = self.environment(spec.environment, spec.folder)
        start = Start(command, environment, spec.working_folder)
        shows_stdout = spec.output != "log"
        return self.begin(start, spec.label, on_exit, shows_stdout=shows_stdout, output_listener=on_output)

    def run_line(
        self, label: str, words: Sequence[str], on_exit: OnExit, on_output: OnOutput
    ) -> _LaunchedLine:
        """Start a ``ros2 …`` line of a launch file."""
        return _LaunchedLine(self, label, words, on_exit, on_output)

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        """Print a line of a launch's own log."""
        self.show(f"[{severity}] [{logger}]: {text}", False, 0)

    def call_at(self, seconds_from_now: float, action: Callable[[], None]) -> None:
        """Call ``action`` that many seconds from now."""
        heapq.heappush(self._due, (time.monotonic() + seconds_from_now, next(self._order), action))

    # following them

    def look(self) -> None:
        """Connect to probes that have begun to listen, and notice programs that have ended."""
        while self._due and self._due[0][0] <= time.monotonic():
            heapq.heappop(self._due)[2]()
        for program in self._running:
            program.look(self._folder)
        self._children.look()
        for program in [each for each in self._running if each.has_ended]:
            self._end(program)
        for launching in [each for each in self._launches if each.finished]:
            self._launches.remove(launching)
            if launching.error is not None:
                self._fail(Cause(str(launching.error), failed=True))
        readers = {each.process: each.name for each in self._running if each.reads}
        waiting = self._keyboard.look(readers)
        for program in self._running:
            if program.process == waiting:
                program.show_rest()

    def _end(self, program: Program) -> None:
        on_exit = self._running.pop(program)
        program.show_rest()
        outcome = program.outcome()
        if program.number:
            self.record(ProcessEnded(0, program.number, outcome.reason, program.status))
        if outcome.failed:
            named = f"{program.name}: {outcome.reason}" if program.number else outcome.reason
            self._fail(replace(outcome, reason=named))
        on_exit(program.status)

    def _fail(self, outcome: Cause) -> None:
        self._failure = self._failure or outcome

    def _is_own(self, process: int) -> bool:
        return any(each.process == process for each in self._programs)

    @property
    def has_failed(self) -> bool:
        """Whether one of them has failed so far."""
        return self._failure is not None or any(each.link.uncaught for each in self._running)

    @property
    def any_run(self) -> bool:
        """Whether one of them has not ended."""
        return bool(self._running or self._launches)

    def outcome(self) -> Cause:
        """How they ended, taken together."""
        if self._failure is not None:
            return self._failure
        if len(self._programs) == 1:
            return self._programs[0].outcome()
        return Cause("every program returned", failed=False)

    def interrupt(self) -> None:
        """Interrupt all programs as Ctrl-C would; launch files interrupt their own."""
        for launching in self._launches:
            launching.interrupt()
        for program in self._running:
            if program.output_listener is None:
                program.interrupt()

    def kill(self) -> list[str]:
        """Kill all that run; returns their names."""
        for program in self._running:
            program.kill()
        return [program.name for program in self._running]


def ros2_command(environment: Mapping[str, str]) -> str | None:
    """The ``ros2`` command of a sourced ROS installation, if there is one."""
    return shutil.which("ros2", path=environment.get("PATH"))


def _ignore(_status: int) -> None:
    """Drop an exit status."""


class _LaunchedLine:
    """A ``ros2`` line of a launch file: one more process of the launch."""

    def __init__(
        self,
        programs: LaunchedPrograms,
        label: str,
        words: Sequence[str],
        on_exit: OnExit,
        on_output: OnOutput,
    ) -> None:
        self.number = programs.announce(label)

        def show(text: str, error: bool) -> None:
            programs.show(text, error, self.number)
            on_output(text, error)

        def end(status: int) -> None:
            programs.record(ProcessEnded(0, self.number, "the line is done", status))
            on_exit(status)

        self.interrupt = self.terminate = self.kill = programs.carry_out(words, show, end)
