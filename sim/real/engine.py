"""The process that runs programs on real rclpy: it starts them, takes what their probes tell, and ends them.

It speaks with the console as the model's engine does. One thread does all; the outbox has another.
"""

import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from typing import NoReturn

import msgspec

from sim.engine import commands
from sim.engine.outbox import Outbox
from sim.engine.setup import RobotUse, RunSetup
from sim.engine.stdio.descriptors import leave_terminal
from sim.real.companions import Companion
from sim.real.programs import PROBE_FOLDER, Program, environment
from sim.real.translation import HOLD, Translation
from sim.real.wire import ProbeLine, Uncaught
from sim.trace.events import (
    AnyEvent,
    CommandGiven,
    CommandKind,
    EntityAppeared,
    EntityKind,
    LineCompleted,
    LineEnded,
    LineGiven,
    LineSaid,
    Notice,
    Printed,
    ProcessAppeared,
    ProcessEnded,
    RunEnded,
    RunEnding,
    RunStarted,
    Severity,
    TimePassed,
)

_PERIOD = 0.01
"""Seconds between two looks at what is due."""
_GRACE = 3.0
"""Seconds that the programs have to end once they were told to."""
_TO_BEGIN = 10.0
"""Seconds after which the run begins though no program has made a node."""
_DOMAINS = range(1, 102)
"""The ROS domains whose ports are free on every system."""
_STOPPED = "it was stopped"


@dataclass(frozen=True, slots=True)
class _Due:
    """Something to be done at a moment of the run's time, in nanoseconds."""

    at: int
    do: Callable[[], None]


class RealEngine:
    """One run of one set-up on real rclpy. ``pipe`` carries events out and commands in."""

    def __init__(self, setup: RunSetup, pipe: Connection) -> None:
        self._setup = setup
        self._pipe = pipe
        self._selector = DefaultSelector()
        self._folder = tempfile.TemporaryDirectory(prefix="cbtui-")
        self._outbox = Outbox(pipe, may_wait=False, before_batch=lambda: None, heartbeat=self._heartbeat)
        self._start = 0
        self._translation = Translation(self._outbox.record, self._begin)
        self._started_at = time.monotonic_ns()
        python = (setup.real.python if setup.real is not None else "") or sys.executable
        self._environment = environment(python, Path(self._folder.name), random.choice(_DOMAINS))
        unprobed = {name: value for name, value in self._environment.items() if name != PROBE_FOLDER}
        caller = [python, "-m", "cbtui_probe.caller"]
        self._caller = Companion(self._selector, caller, unprobed, self._take)
        rate = [] if setup.sensor_rate is None else [str(setup.sensor_rate)]
        robot = [sys.executable, "-m", "sim.real.robot", *rate]
        self._robot = Companion(self._selector, robot, unprobed, self._take)
        self._python = python
        self._programs: list[Program] = []
        self._running: list[Program] = []
        self._services: list[str] = []
        self._failure: str | None = None
        self._error = ""
        self._cause: tuple[str, bool, bool] | None = None
        self._given_up_at = 0
        self._due: list[_Due] = []

    def run(self) -> NoReturn:
        """Run the programs to their ends or the run's, and leave the process."""
        leave_terminal()
        self._outbox.start()
        self._selector.register(self._pipe, EVENT_READ, self._obey)
        try:
            self._start_companions()
            while not self._robot_is_there() and self._cause is None:
                self._turn()
            self._start_programs()
            while self._running:
                self._turn()
            self._finish()
        finally:
            for program in self._running:
                program.signal(signal.SIGKILL)
            self._caller.stop()
            self._robot.stop()
            self._folder.cleanup()
            os._exit(0)

    def _start_companions(self) -> None:
        if self._setup.robot is not RobotUse.NEVER:
            self._robot.start()
        if self._setup.calls:
            self._caller.start()

    def _robot_is_there(self) -> bool:
        """Whether a robot drives already, or need not be waited for."""
        late = time.monotonic_ns() > self._started_at + _TO_BEGIN * 1e9
        return self._setup.robot is RobotUse.NEVER or self._robot.has_spoken or late

    def _start_programs(self) -> None:
        if self._cause is not None:
            return
        self._started_at = time.monotonic_ns()
        several = len(self._setup.programs) > 1
        for place, setup in enumerate(self._setup.programs, start=1):
            number = place if several else 0
            command = [self._python, setup.path, *setup.arguments]
            program = Program(self._selector, command, self._environment, number, self._take, self._print)
            self._programs.append(program)
            if several:
                self._record(ProcessAppeared(0, number, f"{Path(setup.path).stem}-{place}"))
        self._running = list(self._programs)
        name = None if self._setup.service is None else self._setup.service.name
        self._due += [_Due(call.at, partial(self._call, name, call.data)) for call in self._setup.calls]
        if self._setup.until is not None:
            self._due.append(_Due(self._setup.until, self._time_is_up))
        self._due.sort(key=lambda due: due.at)

    def _begin(self, moment: int) -> None:
        self._start = moment
        epoch = time.time_ns() - (time.monotonic_ns() - moment)
        self._outbox.record(RunStarted(0, self._setup.title, "real", epoch))

    def _now(self) -> int:
        return time.monotonic_ns() - self._start if self._start else 0

    def _heartbeat(self) -> list[AnyEvent]:
        now = self._now() - HOLD
        return [TimePassed(now)] if now > 0 else []

    def _record(self, event: AnyEvent) -> None:
        """Put an event of the run's own among those of the probes, at the moment that it is."""
        self._translation.take([msgspec.structs.replace(event, t=time.monotonic_ns())])

    def _tell(self, severity: Severity, text: str) -> None:
        self._record(Notice(0, severity, text))

    def _take(self, lines: list[ProbeLine], process: int = 0) -> None:
        self._services += [
            line.name
            for line in lines
            if isinstance(line, EntityAppeared) and line.kind is EntityKind.SERVICE
        ]
        self._translation.take(lines, process)

    def _print(self, text: str, error: bool, process: int) -> None:
        self._record(Printed(0, text, error, process))

    def _turn(self) -> None:
        for key, _ in self._selector.select(_PERIOD):
            key.data()
        for program in self._running:
            program.connect(Path(self._folder.name) / f"{program.pid}.sock")
        now = time.monotonic_ns()
        if self._programs and now > self._started_at + _TO_BEGIN * 1e9:
            self._translation.begin_at(now)
        self._translation.release(now - HOLD)
        while self._start and self._due and self._due[0].at <= self._now():
            self._due.pop(0).do()
        for program in [each for each in self._running if each.has_ended]:
            self._end(program)
        if self._given_up_at and now > self._given_up_at:
            self._kill()

    def _end(self, program: Program) -> None:
        self._running.remove(program)
        reason, failed = _outcome(program)
        if program.number:
            self._record(ProcessEnded(0, program.number, reason, program.status))
        if failed and self._cause is None:
            self._failure = self._failure or (f"{program.name}: {reason}" if program.number else reason)
            self._error = self._error or ("" if program.uncaught is None else program.uncaught.error)

    def _finish(self) -> None:
        now = time.monotonic_ns()
        self._translation.begin_at(now)
        self._translation.release(now)
        only = self._programs[0] if len(self._programs) == 1 else None
        returned = "every program returned" if only is None else _outcome(only)[0]
        reason, failed, time_was_up = self._cause or (returned, False, False)
        if self._failure is not None:
            reason, failed = self._failure, True
        self._outbox.close(RunEnded(self._now(), reason, failed, time_was_up, self._error))

    def _stop(self, reason: str, *, time_was_up: bool = False) -> None:
        """Have the programs end as by Ctrl-C; by force if that takes too long."""
        if self._cause is None:
            self._cause = (reason, False, time_was_up)
            self._record(RunEnding(0, reason))
            self._given_up_at = time.monotonic_ns() + int(_GRACE * 1e9)
            for program in self._running:
                program.signal(signal.SIGINT)

    def _time_is_up(self) -> None:
        self._stop("its time was up", time_was_up=True)

    def _kill(self) -> None:
        for program in self._running:
            text = f"{program.name} had not ended {_GRACE:g} s after it was told to: it was ended by force"
            self._tell(Severity.WARN, text)
            program.signal(signal.SIGKILL)
        self._given_up_at = 0

    def _obey(self) -> None:
        try:
            command = commands.decode(self._pipe.recv_bytes())
        except (EOFError, OSError):
            sys.exit()  # the console is gone
        match command:
            case commands.Stop():
                self._stop(_STOPPED)
            case commands.CallService(name=name, data=data):
                self._call(name, data)
            case commands.ResetWorld():
                self._record(CommandGiven(0, "reset the world", CommandKind.CALL))
                self._caller.say(["std_srvs/srv/Empty", ["/reset_world"], {}])
            case commands.Type(text=text, ends=ends):
                self._type(text, ends=ends)
            case commands.RunLine(line=line, text=text):
                self._record(LineGiven(0, line, text))
                self._record(
                    LineSaid(0, line, "ros2 lines act on the model only: type them in a terminal", True)
                )
                self._record(LineEnded(0, line, 1))
            case commands.CompleteLine(line=line, cursor=cursor):
                self._record(LineCompleted(0, line, cursor, ()))
            case commands.InterruptLine() | commands.KeepContents():
                pass
            case _:
                self._tell(
                    Severity.WARN, "real ROS 2 goes on by itself: only the model can stop or change time"
                )

    def _call(self, name: str | None, data: bool) -> None:
        names = self._services if name is None else [name]
        if not names:
            self._tell(Severity.WARN, "the program offers no service yet, so the call is lost")
            return
        self._record(CommandGiven(0, f"call {names[0]} {str(data).lower()}", CommandKind.CALL))
        self._caller.say(["std_srvs/srv/SetBool", names, {"data": data}])

    def _type(self, text: str, *, ends: bool) -> None:
        if text == commands.INTERRUPT:
            self._stop("it was interrupted from the keyboard")
        elif len(self._running) == 1:
            self._running[0].type(text, ends=ends)


def _outcome(program: Program) -> tuple[str, bool]:
    """How a program ended, as a sentence, and whether it failed."""
    uncaught, status = program.uncaught, program.status
    if uncaught is not None:
        return f"{_place(uncaught)}: the program raised {uncaught.error}", True
    if status == -signal.SIGINT:
        return _STOPPED, False
    if status < 0:
        return f"the program crashed by {signal.Signals(-status).name}", True
    return (
        ("the program returned", False)
        if status == 0
        else (f"the program ended with exit code {status}", True)
    )


def _place(uncaught: Uncaught) -> str:
    name = Path(uncaught.file).name
    return f"{name}:{uncaught.line}" if uncaught.line else name


def run(packed_setup: bytes, pipe: Connection, crash_dump: Connection) -> None:
    """Be the engine process of one run on real rclpy; programs that crash do so in processes of their own."""
    crash_dump.close()
    setup = msgspec.msgpack.decode(packed_setup, type=RunSetup)
    RealEngine(setup, pipe).run()
