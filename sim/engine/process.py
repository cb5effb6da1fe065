"""The engine process: sets up host, robot and clock, runs the program, and ends.

``run`` is what the process does, from its first line to ``os._exit``: whatever a program leaves behind
(threads that never end, exit handlers) must not keep the process alive.
"""

import os
import signal
import sys
import threading
import time
from functools import partial
from itertools import count
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NoReturn

import msgspec

from sim import clean_start
from sim.clock import Clock, PacedClock, VirtualClock
from sim.clock.paced_stdlib import follow
from sim.clock.schedule import schedule_of
from sim.clock.stdlib import live_on
from sim.engine import commands
from sim.engine.children import allow_children, refuse_children
from sim.engine.descriptors import Descriptors, leave_terminal
from sim.engine.endless_waits import EndlessWaits
from sim.engine.failure import breakdown
from sim.engine.held_up import HeldUp
from sim.engine.last_words import keep_last_words
from sim.engine.lines import Lines
from sim.engine.outbox import Outbox
from sim.engine.output import ProcessStream
from sim.engine.own_functions import OwnFunctions
from sim.engine.program import Outcome, script
from sim.engine.programs import Programs
from sim.engine.repeatability import Repeatability
from sim.engine.requests import Requests
from sim.engine.robot import provide_robot
from sim.engine.setup import RunSetup
from sim.engine.sourced import use_workspace
from sim.engine.standstill import Standstill
from sim.engine.starting import Starter, StartError, is_launch_file
from sim.engine.time_control import RealControl, VirtualControl
from sim.engine.tracebacks import leave_out_own_frames
from sim.engine.tuned import tuning_of
from sim.engine.unheard import tell_of_unheard
from sim.engine.watchdog import Watchdog
from sim.robot.bullet import WorldUnavailable
from sim.ros import importing
from sim.ros.contents import Contents
from sim.ros.host import Host, install
from sim.ros.probe import Probe
from sim.ros.process import Process, current_process, share_machine
from sim.trace.events import AnyEvent, InputGiven, Notice, Printed, RunEnded, RunStarted, Severity, TimePassed
from sim.trace.sealing import Seal

_GRACE = 0.5
"""Real seconds that a program gets to wind up once its run is over."""
_BATCHES_A_LOOK = 16
"""Sealed batches to one that is sent with a look at the engine's own functions, which takes milliseconds."""

# Kept from before a clock, a program or the keeping of last words put their own in their place.
_real_sleep = time.sleep
_leave = os._exit


class Engine:
    """One run of one program. ``pipe`` carries events out and commands in."""

    def __init__(self, setup: RunSetup, pipe: Connection, last_words: Connection) -> None:
        self._setup = setup
        self._pipe = pipe
        self._last_words = last_words
        self._pid = os.getpid()
        clock = (
            VirtualClock(setup.speed, schedule_of(setup.seed))
            if setup.clock == "virtual"
            else PacedClock(setup.speed or 1.0)
        )
        self._virtual = clock if isinstance(clock, VirtualClock) else None
        self._clock: Clock = clock
        self._contents = Contents(
            wanted=setup.contents, make_room=None if self._virtual is None else self._make_room
        )
        self._outbox = Outbox(
            pipe,
            may_wait=self._virtual is not None,
            before_batch=self._look_at_waits_of_real_time,
            pack=self._pack,
            heartbeat=self._heartbeat,
        )
        self._seal = Seal(setup.seal) if setup.seal else None
        self._own_functions: OwnFunctions | None = None
        self._batches = count()
        self._control = (
            RealControl(clock, self._outbox.record)
            if isinstance(clock, PacedClock)
            else VirtualControl(clock, self._outbox.record)
        )
        probe = Probe(self._clock, self._control.record, self._contents)
        self._probe = probe
        self._host = Host(self._clock, probe, threads=setup.threads, tuning=tuning_of(setup))
        self._endless: EndlessWaits | None = None
        self._requests = Requests(self._host, self._outbox.record)
        self._programs = Programs(self._host, self._outbox.record)
        self._starter = Starter(self._programs, self._setup)
        self._lines = Lines(self._host, self._outbox.record, self._starter, self._programs.look)
        self._descriptors = Descriptors(self._take_line)
        self._over = False
        self._passed = 0
        self._grace_begins = threading.Lock()
        self._grace_begins.acquire()

    def run(self) -> None:
        """Run the program to its end or the run's, and leave the process."""
        self._outbox.start()
        self._outbox.record(RunStarted(0, self._setup.title, self._setup.clock, self._clock.epoch))
        threading.Thread(target=self._obey, name="commands", daemon=True).start()
        threading.Thread(target=self._leave_after_grace, name="grace", daemon=True).start()
        self._redirect_output()
        keep_last_words(self._last_words, self._outbox.flush)
        if not self._setup.whole_tracebacks:
            leave_out_own_frames()
        for program in self._setup.programs[:1]:
            tell_of_unheard(self._tell_of_error, program.path, str(Path(program.path).parent))
        install(self._host)
        importing.install()
        self._starter.add_own_interfaces()
        use_workspace(self._starter.packages, self._clock)
        share_machine()
        self._settle_children()
        provide_robot(self._setup, self._host, self._outbox.record, self._fail)
        if self._virtual is not None:
            self._endless = endless = EndlessWaits(self._virtual, self._host, self._outbox.record)
            self._virtual.before_jump = self._look_at_waits
            Watchdog(self._virtual, self._outbox.record, self._give_up).start()
            self._virtual.on_recess = Standstill(self._virtual, self._outbox.record, self._give_up).look
            self._virtual.on_lock_wait = endless.begins
            live_on(self._virtual, Repeatability(self._clock, self._outbox.record).lose)
        elif isinstance(self._clock, PacedClock):
            follow(self._clock)
            HeldUp(self._clock, self._outbox.record).start()
        self._schedule()
        if self._seal is not None:
            parts = {"outbox": self._outbox, "probe": self._probe, "host": self._host, "clock": self._clock}
            self._own_functions = OwnFunctions(parts)
        self._end(self._run_programs())

    def _run_programs(self) -> Outcome:
        """Run all programs to their ends; how that went."""
        if len(self._setup.programs) == 1 and not is_launch_file(self._setup.programs[0].path):
            (only,) = self._setup.programs
            return self._programs.run_only(script(only.path, only.arguments))
        try:
            self._start_programs()
            self._programs.wait_until(lambda: not (self._programs.any_run or self._lines.any_left))
        except KeyboardInterrupt:
            self._lines.interrupt_all()
            self._programs.interrupt_all()
            self._programs.wait_until(lambda: not self._programs.any_run)
            return Outcome("it was stopped", failed=False)
        except StartError as error:
            self._programs.interrupt_all()
            return Outcome(str(error), failed=True, status=1)
        return self._programs.joint_outcome()

    def _start_programs(self) -> None:
        for place, program in enumerate(self._setup.programs, start=1):
            if is_launch_file(program.path):
                self._starter.launch(None, program.path, program.arguments, _nobody_waits)
            else:
                label = f"{Path(program.path).stem}-{place}"
                self._programs.start(script(program.path, program.arguments), label, _nobody_waits)

    def _fail(self, sentence: str) -> None:
        self._finish_run(sentence, failed=True)
        self._interrupt()

    def _schedule(self) -> None:
        for call in self._setup.calls:
            self._clock.call_at(call.at, lambda data=call.data: self._call_service(data))  # type: ignore[misc]
        self._lines.schedule(self._setup.lines)
        if self._setup.until is not None:
            self._clock.call_at(self._setup.until, self._time_is_up)
        if self._virtual is not None:
            for given in self._setup.inputs:
                command = commands.input_of(given.command)
                self._virtual.give_at(given.at, partial(self._carry_out, command), given.recess)

    def _call_service(self, data: bool) -> None:
        service = self._setup.service
        self._requests.set_bool(None if service is None else service.name, data)

    def _time_is_up(self) -> None:
        failures = self._programs.failures
        sentence = "; ".join(["its time was up", *failures[:1]])
        self._finish_run(sentence, failed=bool(failures))
        self._interrupt()

    def _finish_run(self, reason: str, *, failed: bool) -> None:
        if not self._over:
            self._over = True
            if self._endless is not None:
                self._endless.finish()
            with self._host.lock:
                if self._host.tuning is not None and not failed:
                    for sentence in self._host.tuning.unmet():
                        self._outbox.record(Notice(self._clock.now(), Severity.WARN, sentence))
                self._outbox.close(RunEnded(self._clock.now(), reason, failed))

    def _interrupt(self) -> None:
        """Have the program end as Ctrl-C would, and the process a little later whatever it does."""
        if self._grace_begins.locked():
            self._grace_begins.release()
        if self._virtual is not None:
            self._virtual.stop()
        else:
            self._control.let_go()
            main = threading.main_thread().ident
            assert main is not None
            signal.pthread_kill(main, signal.SIGINT)

    def _leave_after_grace(self) -> None:
        self._grace_begins.acquire()
        _real_sleep(_GRACE)
        self._starter.close()
        _leave(0)

    def _give_up(self, sentence: str) -> None:
        if self._setup.speed is None:
            self._finish_run(sentence, failed=True)
            _leave(1)

    def _end(self, outcome: Outcome) -> None:
        if os.getpid() != self._pid:
            _leave(outcome.status)  # a program forked, and this is the other one
        self._descriptors.finish()
        self._finish_run(outcome.sentence, failed=outcome.failed)
        self._starter.close()
        _leave(0)

    def _break_down(self, error: Exception) -> NoReturn:
        self._descriptors.finish()
        self._finish_run(breakdown(error), failed=True)
        self._starter.close()
        _leave(1)

    def _redirect_output(self) -> None:
        def stream(error: bool) -> ProcessStream:
            def take(process: Process, text: str) -> None:
                if process.take_output is not None:
                    process.take_output(text, error)
                elif error or process.shows_stdout:
                    self._outbox.record(Printed(self._clock.now(), text, error, process.number))
                else:
                    process.keep(self._tell_of_hidden_output)

            # Python's own logging writes errors while it holds a lock that does not live on the clock.
            return ProcessStream(take) if error else ProcessStream(take, self._clock.switch_point)

        sys.stdout = stream(error=False)
        sys.stderr = stream(error=True)

        self._descriptors.detach()

    def _take_line(self, text: str, error: bool) -> None:
        self._outbox.record(Printed(self._clock.now(), text, error))

    def _tell_of_error(self, sentence: str) -> None:
        self._outbox.record(Notice(self._clock.now(), Severity.ERROR, sentence))

    def _settle_children(self) -> None:
        if self._virtual is None:
            allow_children(self._host, self._outbox, self._pipe)
        else:
            refuse_children()

    def _tell_of_hidden_output(self) -> None:
        text = (
            f"{current_process().label} prints to stdout, which ros2 launch only shows with output='screen'; "
            "its log goes to stderr and is shown"
        )
        self._outbox.record(Notice(self._clock.now(), Severity.INFO, text))

    def _look_at_waits(self) -> int | None:
        if self._endless is not None:
            self._endless.look()
        return self._host.explain_waits()

    def _look_at_waits_of_real_time(self) -> None:
        if self._virtual is None and not self._over:
            self._host.explain_waits()

    def _heartbeat(self) -> list[AnyEvent]:
        """Tell how far time is, if it has gone on since; virtual time goes on with events alone."""
        now = 0 if self._virtual is not None else self._clock.now()
        if now <= self._passed:
            return []
        self._passed = now
        return [TimePassed(now)]

    def _pack(self, events: list[AnyEvent]) -> bytes:
        packed = self._contents.pack(events)
        if self._seal is None:
            return packed
        replaced: tuple[str, ...] = ()
        is_last = bool(events) and isinstance(events[-1], RunEnded)
        if self._own_functions is not None and (is_last or next(self._batches) % _BATCHES_A_LOOK == 0):
            replaced = self._own_functions.replaced()
        return self._seal.close(packed, replaced)

    def _make_room(self) -> None:
        self._outbox.flush()

    # Commands, read on a thread of their own

    def _obey(self) -> None:
        while True:
            try:
                command = commands.decode(self._pipe.recv_bytes())
            except (EOFError, OSError):
                _leave(0)  # the console is gone
            except msgspec.DecodeError as error:
                self._outbox.record(Notice(self._clock.now(), Severity.ERROR, f"unreadable command: {error}"))
                continue
            if isinstance(command, commands.PaceCommand):
                self._control.obey(command)
            elif self._virtual is not None:
                self._bring_in(self._virtual, command)
            else:
                self._carry_out(command)

    def _bring_in(self, clock: VirtualClock, command: commands.WorldCommand) -> None:
        """Have a command carried out at the end of the moment that the run is in."""
        if isinstance(command, commands.CompleteLine):
            clock.steer(lambda: self._carry_out(command))
            return
        if clock.in_moment and not isinstance(command, commands.Stop):
            text = "time stands in the middle of a moment, and this comes at its end: step, or let time go on"
            self._outbox.record(Notice(clock.now(), Severity.WARN, text))
        clock.give(lambda: self._carry_out(command))
        if isinstance(command, commands.Stop):
            self._control.let_go()

    def _carry_out(self, command: commands.WorldCommand) -> None:
        if not isinstance(command, commands.CompleteLine):
            recess = 0 if self._virtual is None else self._virtual.recess
            self._outbox.record(InputGiven(self._clock.now(), commands.input_text(command), recess))
        match command:
            case commands.CallService(name=name, data=data):
                self._requests.set_bool(name, data)
            case commands.RunLine(line=line, text=text):
                self._lines.begin(line, text)
            case commands.InterruptLine(line=line):
                self._lines.interrupt(line)
            case commands.CompleteLine(line=line, text=text, cursor=cursor):
                self._lines.complete(line, text, cursor)
            case commands.ResetWorld():
                self._requests.reset_world()
            case commands.KeepContents(wanted=wanted):
                self._contents.wanted = wanted
            case commands.Stop():
                self._finish_run("it was stopped", failed=False)
                self._interrupt()


def _nobody_waits(_end: object) -> None:
    """Take the end of a program that nobody is told of."""


def run(packed_setup: bytes, pipe: Connection, last_words: Connection) -> None:
    """Be the engine process of one run; where its threads stand as it crashes goes to ``last_words``."""
    leave_terminal()
    clean_start.forget()
    setup = msgspec.msgpack.decode(packed_setup, type=RunSetup)
    os.set_inheritable(pipe.fileno(), False)
    engine = Engine(setup, pipe, last_words)
    try:
        engine.run()
    except KeyboardInterrupt:  # it was stopped before its program began, and has told so
        engine._starter.close()
        _leave(0)
    except WorldUnavailable as error:
        engine._finish_run(str(error), failed=True)
        _leave(1)
    except Exception as error:  # noqa: BLE001 - an error of the engine's own, which nobody else tells of
        engine._break_down(error)
