"""A launch file on real rclpy, carried out by cbtui's model of ROS's launch: what it starts are processes."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from sim.launch import LaunchRun, OnOutput, ProcessSpec, RunningProcess
from sim.packages import Executable, Packages
from sim.real.programs import OnExit, Start
from sim.trace.events import ProcessEnded

if TYPE_CHECKING:
    from sim.real.launched import LaunchedPrograms


class RunLaunchedLine(Protocol):
    """Carries out a ``ros2`` line; ``show`` gets what it prints."""

    def __call__(
        self, words: Sequence[str], show: Callable[[str, bool], None], on_exit: OnExit
    ) -> Callable[[], None]:
        """Begin; returns what interrupts the line."""


class Launching:
    """Carries out one launch file. All of it happens on the run's thread."""

    def __init__(
        self,
        programs: "LaunchedPrograms",
        path: Path,
        arguments: Sequence[str],
        packages: Packages,
        on_exit: OnExit,
    ) -> None:
        self._programs = programs
        self._run = LaunchRun(path, arguments, self, packages=packages, on_finish=on_exit)

    def start(self) -> None:
        """Begin; raises LaunchError if the launch file cannot be carried out."""
        self._run.start()

    def interrupt(self) -> None:
        """End it as Ctrl-C would; does not wait."""
        self._run.interrupt()

    @property
    def is_over(self) -> bool:
        """Whether nothing runs, and nothing is to come."""
        return self._run.finished

    @property
    def error(self) -> str:
        """What went wrong with the launch itself."""
        return "" if self._run.error is None else str(self._run.error)

    # What a launch needs of the machine

    def start_process(self, spec: ProcessSpec, on_exit: OnExit, on_output: OnOutput) -> RunningProcess:
        """Start a program."""
        programs = self._programs
        executable = Executable(spec.executable, spec.path, spec.folder, spec.module, spec.function)
        start = Start(
            programs.command_of(executable, spec.arguments),
            programs.environment(spec.environment, spec.folder),
            spec.working_folder,
        )
        return programs.begin(
            start, spec.label, on_exit, shows_stdout=spec.output != "log", hear_output=on_output
        )

    def run_line(
        self, label: str, words: Sequence[str], on_exit: OnExit, on_output: OnOutput
    ) -> RunningProcess:
        """Start a ``ros2 …`` line."""
        return _LaunchedLine(self._programs, label, words, on_exit, on_output)

    def call_at(self, seconds_from_now: float, action: Callable[[], None]) -> None:
        """Call ``action`` that many seconds from now."""
        self._programs.call_at(seconds_from_now, action)

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        """Print a line of the launch's own log."""
        self._programs.show(f"[{severity}] [{logger}]: {text}", False, 0)


class _LaunchedLine:
    """A ``ros2`` line of a launch file: one more process of the launch."""

    def __init__(
        self,
        programs: "LaunchedPrograms",
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

        self.interrupt = self.terminate = self.kill = programs.run_line(words, show, end)
