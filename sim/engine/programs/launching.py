"""A launch in an engine: its processes are programs of the run, on the run's time."""

import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from sim.engine.programs.launched_line import LaunchedLine
from sim.engine.programs.program import ProgramOutcome, program_of
from sim.engine.programs.programs import ProgramSupervisor, RunningProgram
from sim.engine.programs.starting import ProgramStarter
from sim.launch import LaunchRun, OnOutput, ProcessSpec, RunningProcess
from sim.quantities.nanoseconds import wait_ns
from sim.shell import OnExit
from sim.trace.events import Printed


class ModelLaunch:
    """Carries out one launch file. It counts as running until the launch is over.

    The launch is single-threaded by a lock: any thread may run it.
    """

    def __init__(
        self,
        programs: ProgramSupervisor,
        starter: ProgramStarter,
        path: Path,
        arguments: Sequence[str],
        on_exit: OnExit,
    ) -> None:
        self._programs = programs
        self._host = programs.host
        self._on_exit = on_exit
        self._lock = threading.RLock()
        self._starter = starter
        packages = starter.packages()
        self._run = LaunchRun(path, arguments, self, packages=packages, on_finish=self._over)

    def start(self) -> "ModelLaunch":
        """Start the launch and return it.

        Raises:
            LaunchError: the launch file cannot be carried out.
        """
        self._programs.hold()
        try:
            with self._lock:
                self._run.start()
        except BaseException:  # a launch that did not begin must not keep the run alive
            self._programs.release()
            raise
        return self

    def interrupt(self) -> None:
        """End the launch as Ctrl-C would; does not wait."""
        self._later(0, self._run.interrupt)

    def _over(self, status: int) -> None:
        if self._run.error is not None:
            self._programs.failures.append(ProgramOutcome(str(self._run.error), failed=True, status=1))
        self._on_exit(status)
        self._programs.release()

    def _later(self, seconds: float, action: Callable[[], None]) -> None:
        """Run an action under the lock, on a thread of its own, which may wait for the lock."""

        def begin() -> None:
            self._host.clock.start_thread(self._locked(action), "launch")

        self._host.clock.call_at(self._host.clock.now() + wait_ns(seconds), begin)

    def _locked(self, action: Callable[[], None]) -> Callable[[], None]:
        def run() -> None:
            with self._lock:
                action()

        return run

    def _under_lock(self, on_exit: OnExit) -> OnExit:
        return lambda status: self._locked(lambda: on_exit(status))()

    # The launch's machine

    def start_process(self, spec: ProcessSpec, on_exit: OnExit, on_output: OnOutput) -> RunningProgram:
        """Start a program."""
        if spec.working_folder is not None:
            raise NotImplementedError("cwd: all programs of a run share one working folder")
        leave = self._under_lock(on_exit)
        return self._programs.start(
            program_of(spec, spec.arguments),
            spec.label,
            lambda outcome: leave(outcome.status),
            environment=spec.environment,
            shows_stdout=spec.output != "log",
            has_keyboard=False,
            output_listener=on_output,
        )

    def run_line(
        self, label: str, words: Sequence[str], on_exit: OnExit, on_output: OnOutput
    ) -> RunningProcess:
        """Start a ``ros2 …`` line."""
        return LaunchedLine(self._programs, self._starter, label, words, self._under_lock(on_exit), on_output)

    def call_at(self, seconds_from_now: float, action: Callable[[], None]) -> None:
        """Call ``action`` that many seconds from now."""
        self._later(seconds_from_now, action)

    def say(self, text: str, severity: str = "INFO", logger: str = "launch") -> None:
        """Print a line of the launch's own log."""
        now = self._host.clock.now()
        self._programs.record(Printed(now, f"[{severity}] [{logger}]: {text}", error=False))
