"""The programs of a run, each in a process of its own: its context, executor, loggers and arguments.

A run's only program has the engine's main thread; several run on threads of their own, which stand for the
main threads of their processes.
"""

import signal
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from types import FrameType

from sim.clock import AutoResetEvent
from sim.engine.programs.ending import flush_files
from sim.engine.programs.exit_functions import run_exit_functions
from sim.engine.programs.program import ProgramOutcome, ProgramSpec, run_program
from sim.engine.stdio.output import finish_lines
from sim.ros.context.context import end_contexts_by_signal
from sim.ros.context.signals import deliver_sigint
from sim.ros.middleware.host import Host
from sim.ros.middleware.process import Process
from sim.trace.events import AnyEvent, Notice, ProcessAppeared, ProcessEnded, Severity

# Kept from before a clock puts its own in its place.
_set_handler = signal.signal

Ended = Callable[[ProgramOutcome], None]


@dataclass(eq=False)
class RunningProgram:
    """A program that was started; ``number`` stands for the process id."""

    programs: "ProgramSupervisor"
    process: Process
    program: ProgramSpec
    on_exit: Ended
    thread: int | None = None
    outcome: ProgramOutcome | None = None

    @property
    def number(self) -> int:
        """What tells its process from others on the trace."""
        return self.process.number

    def interrupt(self) -> None:
        """Have it end as Ctrl-C would; nothing happens once it has ended."""
        deliver_sigint(self.process)
        if self.outcome is None and self.thread is not None:
            self.process.host.clock.interrupt(self.thread)

    def terminate(self) -> None:
        """Have it end as SIGTERM would: its contexts end, and nothing is raised."""
        if self.outcome is None:
            end_contexts_by_signal(self.process)

    def kill(self) -> None:
        """Have it be over whatever it does."""
        self.programs.kill(self)


@dataclass(eq=False)
class ProgramSupervisor:
    """Starts programs and knows which of them run. Thread-safe; ``record`` takes events."""

    host: Host
    record: Callable[[AnyEvent], None]
    failures: list[ProgramOutcome] = field(default_factory=list)
    """Of the programs, and of what started programs, those that failed, with their names in the sentences."""
    _running: list[RunningProgram] = field(default_factory=list)
    _only: list[Process] = field(default_factory=list)
    _numbers: "count[int]" = field(default_factory=lambda: count(1))
    _held: int = 0
    _waiters: list[AutoResetEvent] = field(default_factory=list)

    def run_only(self, program: ProgramSpec) -> ProgramOutcome:
        """Run the run's only program on the calling thread."""
        process = Process(self.host, arguments=[program.path, *program.arguments])
        process.enter()
        self._only.append(process)
        _set_handler(signal.SIGINT, partial(_at_ctrl_c, process))
        return run_program(program)

    def start(
        self,
        program: ProgramSpec,
        label: str,
        on_exit: Ended,
        environment: Mapping[str, str] | None = None,
        shows_stdout: bool = True,
        has_keyboard: bool = True,
        hear_output: Callable[[str, bool], None] | None = None,
    ) -> RunningProgram:
        """Start a program as one of several; ``on_exit`` is called on its thread when it has ended."""
        process = Process(
            self.host,
            number=self.announce(label),
            label=label,
            arguments=[program.path, *program.arguments],
            environment=dict(environment or {}),
            shows_stdout=shows_stdout,
            has_keyboard=has_keyboard,
            hear_output=hear_output,
        )
        running = RunningProgram(self, process, program, on_exit)
        with self.host.lock:
            self._running.append(running)
        process.start_thread(lambda: self._run(running), "MainThread")
        return running

    def announce(self, label: str) -> int:
        """Put one more process on the trace; returns its number."""
        with self.host.lock:
            number = next(self._numbers)
            self.record(ProcessAppeared(self.host.clock.now(), number, label))
        return number

    def _run(self, running: RunningProgram) -> None:
        running.thread = threading.get_ident()
        outcome = run_program(running.program)
        if running.outcome is None:  # a program that was killed leaves what it has undone
            run_exit_functions()
            finish_lines()
            flush_files()
        self._end(running, outcome)

    def kill(self, running: RunningProgram) -> None:
        """Have a program be over whatever it does: it ends as far as it lets itself be ended."""
        running.interrupt()
        self._end(running, ProgramOutcome("it was killed", failed=True, status=-signal.SIGKILL))

    def _end(self, running: RunningProgram, outcome: ProgramOutcome) -> None:
        with self.host.lock:
            if running.outcome is not None:
                return  # it was killed, and its thread has ended only now
            running.outcome = outcome
            self._running.remove(running)
            now = self.host.clock.now()
            self.record(ProcessEnded(now, running.number, outcome.sentence, outcome.status))
            if outcome.failed:
                sentence = f"{running.process.label}: {outcome.sentence}"
                self.failures.append(replace(outcome, sentence=sentence))
                self.record(Notice(now, Severity.ERROR, sentence))
        running.on_exit(outcome)
        self.look()

    def wait_until(self, condition: Callable[[], bool]) -> None:
        """Wait until ``condition`` holds; it is asked whenever a program has ended or ``look`` is called."""
        while True:
            signal = self.host.clock.auto_reset_event()
            with self.host.lock:
                if condition():
                    return
                self._waiters.append(signal)
            signal.wait(None)

    def look(self) -> None:
        """Have ``wait_until`` ask again."""
        with self.host.lock:
            waiters, self._waiters = self._waiters, []
        for waiter in waiters:
            waiter.set()

    def joint_outcome(self) -> ProgramOutcome:
        """How the programs that ended did, taken together: the first failure speaks for all."""
        if self.failures:
            return replace(self.failures[0], status=1)
        return ProgramOutcome("every program returned", failed=False)

    def hold(self) -> None:
        """Count something as running that starts programs, until ``release``."""
        with self.host.lock:
            self._held += 1

    def release(self) -> None:
        """End what ``hold`` began."""
        with self.host.lock:
            self._held -= 1
        self.look()

    @property
    def any_run(self) -> bool:
        """Whether a program runs, or something that starts programs."""
        return bool(self._running) or self._held > 0

    @property
    def processes(self) -> list[Process]:
        """The processes of running programs; a single program's also while it ends."""
        return [*(running.process for running in self._running), *self._only]

    def interrupt_all(self) -> None:
        """Have every program that runs end as Ctrl-C would."""
        for running in tuple(self._running):
            running.interrupt()

    def end_contexts(self) -> None:
        """End the contexts of an only program as Ctrl-C does, which is raised in the main thread after that.

        Several programs are interrupted one by one, in their own main threads.
        """
        for process in self._only:
            process.finish_pools.clear()  # the run is over, whatever their workers are at
            deliver_sigint(process)


def _at_ctrl_c(process: Process, number: int, frame: FrameType | None) -> None:
    """Do what rclpy does at a SIGINT that a program sends itself, then what Python does."""
    deliver_sigint(process)
    signal.default_int_handler(number, frame)
