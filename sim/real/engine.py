"""The engine process of a run on real rclpy: it reads the probes and carries out the console's commands.

It has the same connection to the console as the model's engine. One thread does all work but the outbox's.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import count
from multiprocessing.connection import Connection
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from typing import NoReturn

import msgspec

from sim.engine import commands
from sim.engine.failures.cause import Cause
from sim.engine.failures.failure import breakdown
from sim.engine.outbox import Outbox
from sim.engine.setup import RunSetup
from sim.engine.stdio.descriptors import leave_terminal
from sim.probes.on_path.cbtui_probe import FOLDER
from sim.real.companions import RunRobot, ServiceCaller
from sim.real.keyboard import RealKeyboard
from sim.real.launched import LaunchedPrograms
from sim.real.programs import STOPPED, OnExit, claimed_domain, environment, raised_by, unbootstrapped
from sim.real.ros2_lines import Ros2Lines
from sim.real.translation import HOLD, Translation
from sim.real.watched import WatchedProcesses
from sim.real.wire import OF_THE_RUN, Hello, ProbeLine, Uncaught
from sim.trace.events import (
    AnyEvent,
    CommandGiven,
    CommandKind,
    Notice,
    NoticeKind,
    Printed,
    RunEnding,
    RunStarted,
    Severity,
    TimePassed,
    encode,
)
from sim.trace.integrity.sealing import Seal

_PERIOD = 0.01
"""Seconds between two turns of the loop."""
_LONGEST_HOLD = 500_000_000
"""The longest time, in nanoseconds, for which events are held back to be put in order."""
_HOLD_DECAY = 0.995
_GRACE = 3.0
"""Seconds that the programs have to exit once they were asked to."""
_TO_GATHER = 500_000_000
"""Nanoseconds for which a watched run waits at first, so that the pasts of all processes are put in order."""
_TO_BEGIN = 10_000_000_000
"""Nanoseconds to wait for the robot, and for the first node, before the run begins without."""
_TO_IMPORT = 5_000_000_000
"""Nanoseconds to wait for a program to import rclpy before the run begins without."""
_AFTER_OUTPUT = 1_000_000_000
"""The same once it has printed something, which most programs do only after their imports."""


_NO_RCLPY = "the program has not imported rclpy"


@dataclass(frozen=True, slots=True)
class _Due:
    """An action at a moment of the run's time, in nanoseconds."""

    at: int
    do: Callable[[], None]


class RealEngine:
    """One run of one set-up on real rclpy. ``pipe`` carries events out and commands in."""

    def __init__(self, setup: RunSetup, pipe: Connection) -> None:
        assert setup.real is not None
        self._setup = setup
        self._pipe = pipe
        self._selector = DefaultSelector()
        self._folder = tempfile.TemporaryDirectory(prefix="cbtui-")
        self._outbox = Outbox(
            pipe,
            may_wait=False,
            before_batch=_nothing,
            pack=_sealed_with(setup.seal) if setup.seal else encode,
            heartbeat=self._heartbeat,
        )
        self._start = 0
        self._translation = Translation(self._outbox.record, self._begin)
        self._began_to_wait = time.monotonic_ns()
        self._printed_at: int | None = None
        self._rclpy_is_awaited = False
        """Whether no program has imported rclpy, and nothing was said of that."""
        self._python = setup.real.python or sys.executable
        folder = Path(self._folder.name)
        self._programs: LaunchedPrograms | WatchedProcesses
        self._keyboard: RealKeyboard | None
        lines: tuple[Mapping[str, str], list[Path], LaunchedPrograms | None]
        if setup.real.is_watched:
            graph = unbootstrapped(self._python)
            self._programs = WatchedProcesses(
                self._selector, setup.real, self._take, self._record, count(1), lambda _process: False
            )
            self._keyboard = None
            lines = {**graph, FOLDER: setup.real.watched}, [Path.cwd()], None
        else:
            domain, self._claim = claimed_domain()
            probed = environment(setup, self._python, folder, domain)
            graph = {name: value for name, value in probed.items() if name != FOLDER}
            self._keyboard = RealKeyboard(self._record_keys, setup.keyboard, len(setup.typed))
            launched = self._programs = LaunchedPrograms(
                self._selector,
                folder,
                setup.programs,
                self._python,
                probed,
                self._keyboard,
                self._take_untrusted if setup.seal else self._take,
                self._record,
                self._print,
                self._carry_out,
            )
            lines = probed, launched.folders, launched
        self._lines = Ros2Lines(self._selector, *lines[:2], self._take, self._record, lines[2])
        self._caller = ServiceCaller(self._selector, self._python, graph, self._take)
        self._robot = RunRobot(
            setup.robot, setup.sensor_rate, setup.physics, self._selector, graph, self._translation.take
        )
        self._hold = HOLD
        self._cause: Cause | None = None
        self._failed_before = False
        self._given_up_at: int | None = None
        self._due: list[_Due] = []

    def run(self) -> NoReturn:
        """Run the programs to their ends or the run's, and leave the process."""
        leave_terminal()
        self._outbox.start()
        self._selector.register(self._pipe, EVENT_READ, self._obey)
        try:
            self._run()
        except Exception as error:  # noqa: BLE001 - an error of the engine's own, which nobody else tells of
            self._outbox.close(Cause(breakdown(error), failed=True).event(self._now()))
        finally:
            self._programs.kill()
            self._lines.stop()
            self._caller.stop()
            self._robot.process.stop()
            self._folder.cleanup()
            os._exit(0)

    def _run(self) -> None:
        self._start_companions()
        while self._robot_is_awaited():
            self._turn()
        if self._robot.process.is_over:
            text = f"there is no robot: cbtui's own Python has no rclpy ({sys.executable})"
            self._tell(Severity.WARN, f"{text}; install cbtui[ros] there, or give --no-robot")
        if self._robot.process.has_spoken and self._keyboard is None:  # who only watches may wait for long
            self._translation.begin_at(time.monotonic_ns())
        if self._cause is None:
            self._programs.start()
            self._rclpy_is_awaited = self._keyboard is not None
        self._began_to_wait = time.monotonic_ns()
        self._schedule()
        while self._programs.any_run or self._robot_is_all():
            self._turn()
        self._finish()

    def _start_companions(self) -> None:
        self._robot.start()
        if self._setup.calls:
            self._caller.start()
        if self._setup.lines:
            self._lines.prepare()

    def _robot_is_awaited(self) -> bool:
        """Whether the run has a robot that is not ready yet."""
        is_late = time.monotonic_ns() > self._began_to_wait + _TO_BEGIN
        return self._robot.process.is_awaited and not is_late and self._cause is None

    def _robot_is_all(self) -> bool:
        """Whether the run goes on for its robot alone, as programs come and go."""
        return self._keyboard is None and self._robot.process.is_running and self._cause is None

    def _schedule(self) -> None:
        name = None if self._setup.service is None else self._setup.service.name
        self._due += [_Due(call.at, partial(self._call, name, call.data)) for call in self._setup.calls]
        self._due += [
            _Due(line.at, partial(self._lines.begin, number, line.text))
            for number, line in enumerate(self._setup.lines, start=1)
        ]
        if self._keyboard is not None:
            type_scheduled = partial(self._keyboard.type, scheduled=True)
            self._due += [_Due(text.at, partial(type_scheduled, text.text)) for text in self._setup.typed]
        if self._setup.until is not None:
            self._due.append(_Due(self._setup.until, self._time_is_up))
        self._due.sort(key=lambda due: due.at)

    def _turn(self) -> None:
        for key, _ in self._selector.select(_PERIOD):
            key.data()
        self._programs.look()
        self._lines.look()
        now = time.monotonic_ns()
        if self._rclpy_is_awaited and now > self._without_rclpy_at:
            self._rclpy_is_awaited = False
            self._tell(Severity.WARN, f"{_NO_RCLPY} so far; until then there is only its output to show")
            self._translation.begin_at(now)
        if now > self._began_to_wait + _TO_BEGIN and self._due:
            self._translation.begin_at(now)
        if self._keyboard is not None or now > self._began_to_wait + _TO_GATHER:
            self._translation.release(now - self._hold)
        while self._start and self._due and self._due[0].at <= self._now():
            self._due.pop(0).do()
        if self._given_up_at is not None and now > self._given_up_at:
            self._given_up_at = None
            self._kill()

    @property
    def _without_rclpy_at(self) -> int:
        """When a run begins in which nothing has imported rclpy."""
        started = self._began_to_wait + _TO_IMPORT
        return started if self._printed_at is None else min(started, self._printed_at + _AFTER_OUTPUT)

    def _finish(self) -> None:
        outcome = self._programs.outcome()
        if self._rclpy_is_awaited and self._cause is None and not outcome.failed:
            self._tell(Severity.WARN, f"{_NO_RCLPY}: there was only its output to show")
        if self._cause is not None:
            if outcome.failed and not self._failed_before:
                self._tell(Severity.ERROR, outcome.reason)
            failed = replace(outcome, time_was_up=self._cause.time_was_up)
            outcome = failed if self._failed_before else self._cause
        now = time.monotonic_ns()
        self._translation.begin_at(now)
        self._translation.release(now)
        self._outbox.close(outcome.event(self._now()))

    # the run's time

    def _begin(self, moment: int) -> None:
        self._start = moment
        epoch = time.time_ns() - (time.monotonic_ns() - moment)
        self._outbox.record(RunStarted(0, self._setup.title, "real", epoch))

    def _now(self) -> int:
        return time.monotonic_ns() - self._start if self._start else 0

    def _heartbeat(self) -> list[AnyEvent]:
        now = self._now() - self._hold
        return [TimePassed(now)] if now > 0 else []

    # what happens

    def _record(self, event: AnyEvent) -> None:
        """Record one of the run's own events at the present time, in order with those of the probes."""
        self._translation.take([msgspec.structs.replace(event, t=time.monotonic_ns())])

    def _record_keys(self, event: AnyEvent) -> None:
        """Record an event about the keyboard; a program that reads before the first node begins the run."""
        self._record(event)
        self._translation.begin_at(time.monotonic_ns())

    def _tell(self, severity: Severity, text: str) -> None:
        self._record(Notice(0, severity, text))

    def _take(self, lines: list[ProbeLine], process: int = 0) -> None:
        if any(isinstance(line, Hello) for line in lines):
            self._rclpy_is_awaited = False
        raised = (each for each in lines if isinstance(each, Uncaught) and each.goes_on)
        self._translation.take(map(raised_by, raised))
        self._hold_for(lines)
        self._caller.hear(lines)
        self._lines.hear(lines)
        self._translation.take(lines, process)
        self._robot.hear(lines)

    def _hold_for(self, lines: list[ProbeLine]) -> None:
        """Hold events back for longer while a busy machine delivers them late, so that all stay in order."""
        late = max((time.monotonic_ns() - line.t for line in lines[:1]), default=0)
        self._hold = min(max(HOLD, late, round(self._hold * _HOLD_DECAY)), _LONGEST_HOLD)

    def _take_untrusted(self, lines: list[ProbeLine], process: int = 0) -> None:
        """Take events from a program, without those that only the run or its robot may record."""
        told = [line for line in lines if not isinstance(line, OF_THE_RUN)]
        if len(told) < len(lines):
            text = "the program tells, as if it were the run, of the run or of the robot"
            self._record(Notice(0, Severity.ERROR, text, kind=NoticeKind.FORGED))
        self._take(told, process)

    def _print(self, text: str, error: bool, process: int) -> None:
        self._printed_at = self._printed_at or time.monotonic_ns()
        self._record(Printed(0, text, error, process))

    # the end

    def _stop(self, cause: Cause, at: int | None = None) -> None:
        """Interrupt the programs, and kill them if they take too long; watched programs go on.

        What fails from then on is told, and is no failure of the run, as on the model.

        The trace shows this at the monotonic time ``at``, or now.
        """
        if self._cause is None:
            self._cause = cause
            self._failed_before = self._programs.has_failed
            self._translation.take([RunEnding(time.monotonic_ns() if at is None else at, cause.reason)])
            self._given_up_at = time.monotonic_ns() + int(_GRACE * 1e9)
            self._programs.interrupt()

    def _time_is_up(self) -> None:
        """End the run exactly at its time limit: what began later is not part of it."""
        assert self._setup.until is not None
        cause = Cause("its time was up", failed=False, time_was_up=True)
        self._stop(cause, self._start + self._setup.until)

    def _kill(self) -> None:
        for name in self._programs.kill():
            text = f"{name} had not ended {_GRACE:g} s after it was told to: it was ended by force"
            self._tell(Severity.WARN, text)

    # commands

    def _carry_out(
        self, words: Sequence[str], show: Callable[[str, bool], None], on_exit: OnExit
    ) -> Callable[[], None]:
        return self._lines.begin_launched(words, show, on_exit)

    def _obey(self) -> None:
        try:
            command = commands.decode(self._pipe.recv_bytes())
        except (EOFError, OSError):
            sys.exit()  # the console is gone
        match command:
            case commands.Stop():
                self._stop(Cause(STOPPED, failed=False))
            case commands.CallService(name=name, data=data):
                self._call(name, data)
            case commands.ResetWorld():
                self._record(CommandGiven(0, "reset the world", CommandKind.CALL))
                self._caller.reset_world()
            case commands.TerminalInput(text=text, ends=ends):
                self._type(text, ends=ends)
            case commands.RunLine(line=line, text=text):
                self._lines.begin(line, text)
            case commands.CompleteLine(line=line, text=text, cursor=cursor):
                self._lines.complete(line, text, cursor)
            case commands.InterruptLine(line=line):
                self._lines.interrupt(line)
            case commands.KeepContents():
                pass
            case _:
                self._tell(
                    Severity.WARN, "real ROS 2 goes on by itself: only the model can stop or change time"
                )

    def _call(self, name: str | None, data: bool) -> None:
        called = self._caller.set_bool(name, data)
        if called is None:
            self._tell(Severity.WARN, "the program offers no service yet, so the call is lost")
        else:
            self._record(CommandGiven(0, f"call {called} {str(data).lower()}", CommandKind.CALL))

    def _type(self, text: str, *, ends: bool) -> None:
        if self._keyboard is None:
            return
        if self._keyboard.interrupts(text):
            self._stop(Cause("it was interrupted from the keyboard", failed=False))
        else:
            self._keyboard.type(text, ends=ends)


def _sealed_with(key: bytes) -> Callable[[list[AnyEvent]], bytes]:
    """The encoder of batches, which lets a second writer be noticed."""
    seal = Seal(key)
    return lambda events: seal.close(encode(events))


def _nothing() -> None:
    """Do nothing before a batch: the probes find waiting callbacks."""


def run(packed_setup: bytes, pipe: Connection, crash_dump: Connection) -> None:
    """Run one set-up on real rclpy in this process; programs run, and crash, in processes of their own."""
    crash_dump.close()
    RealEngine(msgspec.msgpack.decode(packed_setup, type=RunSetup), pipe).run()
