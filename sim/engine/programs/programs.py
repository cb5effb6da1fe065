"""The programs of a run, each in a modelled process with its own context, executor, loggers and arguments.

A run's only program uses the engine's main thread. Several run on threads of their own, which represent
the main threads of their processes.
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
from sim.engine.programs.program import (
    ProgramOutcome,
    ProgramSpec,
    pooled_threads,
    run_program,
    threads_left_by,
)
from sim.engine.stdio.output import finish_lines
from sim.ros.context.context import end_contexts_by_signal
from sim.ros.context.signals import deliver_sigint, deliver_sigterm
from sim.ros.middleware.host import Host
from sim.ros.middleware.process import Process
from sim.trace.events import AnyEvent, Notice, NoticeKind, ProcessAppeared, ProcessEnded, Severity

# Kept from before a clock replaces it.
_set_handler = signal.signal

OnProgramEnd = Callable[[ProgramOutcome], None]


@dataclass(eq=False)
class RunningProgram:
    """A started program; ``number`` represents its process id."""

    programs: "ProgramSupervisor"
    process: Process
    program: ProgramSpec
    on_exit: OnProgramEnd
    thread: int | None = None
    outcome: ProgramOutcome | None = None

    @property
    def number(self) -> int:
        """The number of its process on the trace."""
        return self.process.number

    def interrupt(self) -> None:
        """End the program as Ctrl-C would; does nothing once it has ended."""
        deliver_sigint(self.process)
        if self.outcome is None and self.thread is not None:
            self.process.host.clock.interrupt(self.thread)

    def terminate(self) -> None:
        """End the program as SIGTERM would: its contexts end, and nothing is raised."""
        if self.outcome is None:
            end_contexts_by_signal(self.process)

    def kill(self) -> None:
        """End the program whatever it does, as SIGKILL would."""
        self.programs.kill(self)


@dataclass(eq=False)
class ProgramSupervisor:
    """Starts programs and keeps track of them. Thread-safe; ``record`` takes events."""

    host: Host
    record: Callable[[AnyEvent], None]
    failures: list[ProgramOutcome] = field(default_factory=list)
    """The outcomes of programs and launches that failed, with their names in the sentences."""
    _running: list[RunningProgram] = field(default_factory=list)
    _only: list[Process] = field(default_factory=list)
    _numbers: "count[int]" = field(default_factory=lambda: count(1))
    _held: int = 0
    _ending: bool = False
    _waiters: list[AutoResetEvent] = field(default_factory=list)

    def run_only(self, program: ProgramSpec) -> ProgramOutcome:
        """Run the run's only program on the calling thread."""
        process = Process(self.host, arguments=[program.path, *program.arguments])
        process.enter()
        self._only.append(process)
        _set_handler(signal.SIGINT, partial(_at_ctrl_c, process))
        _set_handler(signal.SIGTERM, partial(_at_sigterm, process))
        return run_program(program, partial(self._tell_if_others_go_on, process))

    def _tell_if_others_go_on(self, process: Process, raised: ProgramOutcome) -> None:
        """Tell at once what ended the spins of the only program if threads go on for which Python waits."""
        pooled = pooled_threads()
        waits_for_threads = any(each.ident not in pooled for each in threads_left_by(process))
        works_on = waits_for_threads or (process.finish_pools and self.host.probe.running())
        if self._ending or not process.spins or not works_on:
            return
        with self.host.lock:
            self.failures.append(raised)
            self.record(_notice(self.host.clock.now(), raised.sentence, raised))

    def start(
        self,
        program: ProgramSpec,
        label: str,
        on_exit: OnProgramEnd,
        environment: Mapping[str, str] | None = None,
        shows_stdout: bool = True,
        has_keyboard: bool = True,
        output_listener: Callable[[str, bool], None] | None = None,
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
            output_listener=output_listener,
        )
        running = RunningProgram(self, process, program, on_exit)
        with self.host.lock:
            self._running.append(running)
        process.start_thread(lambda: self._run(running), "MainThread")
        return running

    def announce(self, label: str) -> int:
        """Record a new process; return its number."""
        with self.host.lock:
            number = next(self._numbers)
            self.record(ProcessAppeared(self.host.clock.now(), number, label))
        return number

    def _run(self, running: RunningProgram) -> None:
        running.thread = threading.get_ident()
        outcome = run_program(running.program)
        if running.outcome is None:  # a killed program does not clean up
            run_exit_functions()
            finish_lines()
            flush_files()
        self._end(running, outcome)

    def kill(self, running: RunningProgram) -> None:
        """Count a program as ended whatever it does; its threads end as far as an interrupt ends them."""
        running.interrupt()
        self._end(running, ProgramOutcome("it was killed", failed=True, status=-signal.SIGKILL))

    def _end(self, running: RunningProgram, outcome: ProgramOutcome) -> None:
        with self.host.lock:
            if running.outcome is not None:
                return  # the program was killed, and its thread has ended now
            running.outcome = outcome
            self._running.remove(running)
            now = self.host.clock.now()
            self.record(ProcessEnded(now, running.number, outcome.sentence, outcome.status))
            if outcome.failed:
                sentence = f"{running.process.label}: {outcome.sentence}"
                self.failures.append(replace(outcome, sentence=sentence))
                self.record(_notice(now, sentence, outcome))
        running.on_exit(outcome)
        self.look()

    def wait_until(self, condition: Callable[[], bool]) -> None:
        """Wait until ``condition`` holds; it is checked when a program ends and when ``look`` is called."""
        while True:
            signal = self.host.clock.auto_reset_event()
            with self.host.lock:
                if condition():
                    return
                self._waiters.append(signal)
            signal.wait(None)

    def look(self) -> None:
        """Have ``wait_until`` check its condition again."""
        with self.host.lock:
            waiters, self._waiters = self._waiters, []
        for waiter in waiters:
            waiter.set()

    def joint_outcome(self) -> ProgramOutcome:
        """Return one outcome for all ended programs: the first failure, if any."""
        if self.failures:
            return replace(self.failures[0], status=1)
        return ProgramOutcome("every program returned", failed=False)

    def hold(self) -> None:
        """Count one more starter of programs as running, until ``release``."""
        with self.host.lock:
            self._held += 1

    def release(self) -> None:
        """Undo one ``hold``."""
        with self.host.lock:
            self._held -= 1
        self.look()

    @property
    def any_run(self) -> bool:
        """Whether a program runs, or a starter of programs that ``hold`` counts."""
        return bool(self._running) or self._held > 0

    def main_threads(self) -> list[tuple[int, Process]]:
        """Return the running programs, each with the identifier of its main thread."""
        only = ((threading.main_thread().ident, each) for each in self._only)
        several = ((each.thread, each.process) for each in tuple(self._running))
        return [(ident, process) for ident, process in (*only, *several) if ident]

    @property
    def processes(self) -> list[Process]:
        """The processes of running programs; a single program's also while it ends."""
        return [*(running.process for running in self._running), *self._only]

    def interrupt_all(self) -> None:
        """End every running program as Ctrl-C would."""
        for running in tuple(self._running):
            running.interrupt()

    def end_contexts(self) -> None:
        """End the contexts of an only program as Ctrl-C does, before it is raised in the main thread.

        Several programs are interrupted one by one, each in its main thread.
        """
        self._ending = True
        for process in self._only:
            process.finish_pools.clear()  # the run is over, whatever their workers do
            deliver_sigint(process)


def _at_ctrl_c(process: Process, number: int, frame: FrameType | None) -> None:
    """Handle a SIGINT that a program sends to itself: first as rclpy does, then as Python does."""
    deliver_sigint(process)
    signal.default_int_handler(number, frame)


def _at_sigterm(process: Process, number: int, _frame: FrameType | None) -> None:
    """Do what rclpy does at SIGTERM: the contexts end, and nothing is raised; unhandled, it kills."""
    if not deliver_sigterm(process):
        _set_handler(number, signal.SIG_DFL)
        signal.raise_signal(number)


def _notice(now: int, sentence: str, outcome: ProgramOutcome) -> Notice:
    failure = outcome.failure
    if failure is None:
        return Notice(now, Severity.ERROR, sentence)
    return Notice(
        now,
        Severity.ERROR,
        sentence,
        kind=NoticeKind.PROGRAM_RAISED,
        problem=failure.what,
        advice=failure.advice,
        place=(failure.file, failure.line),
        error=outcome.error,
    )
