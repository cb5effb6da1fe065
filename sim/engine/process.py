"""The engine process: sets up host, robot and clock, runs the program, and ends.

``run`` is what the process does, from its first line to ``os._exit``. A program ends as under CPython, and is
on the trace until it has; what takes longer than ``ending.GRACE`` does not keep the process alive.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
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
from sim.engine.failures.failure import breakdown, is_learners
from sim.engine.failures.last_words import keep_last_words, leave_if_kept
from sim.engine.failures.tracebacks import leave_out_own_frames
from sim.engine.failures.unheard import tell_of_unheard
from sim.engine.outbox import Outbox
from sim.engine.programs.children import allow_children, refuse_children
from sim.engine.programs.ending import (
    GRACE,
    VIRTUAL_GRACE,
    finalise,
    flush_files_soon,
    set_engine_apart,
)
from sim.engine.programs.program import Outcome, script, threads_left_by
from sim.engine.programs.programs import Programs
from sim.engine.programs.ros2_lines import Lines
from sim.engine.programs.sourced import use_workspace
from sim.engine.programs.starting import Starter, StartError, is_launch_file
from sim.engine.requests import Requests
from sim.engine.robot import provide_robot
from sim.engine.setup import RunSetup
from sim.engine.stdio.descriptors import Descriptors, leave_terminal
from sim.engine.stdio.output import ProcessStream, finish_lines
from sim.engine.stdio.terminal import Terminal
from sim.engine.time_control import RealControl, VirtualControl
from sim.engine.tuned import tuning_of
from sim.engine.watchdogs.endless_waits import EndlessWaits
from sim.engine.watchdogs.held_up import HeldUp
from sim.engine.watchdogs.outside_time import Watchdog
from sim.engine.watchdogs.own_functions import OwnFunctions
from sim.engine.watchdogs.repeatability import Repeatability
from sim.engine.watchdogs.standstill import Standstill
from sim.probes import own_code
from sim.probes.probe import Probe
from sim.robot.bullet import WorldUnavailable
from sim.ros import importing
from sim.ros.middleware.contents import Contents
from sim.ros.middleware.host import Host, install
from sim.ros.middleware.process import Process, current_process, share_machine
from sim.trace.events import (
    AnyEvent,
    InputGiven,
    Notice,
    Printed,
    RunEnded,
    RunEnding,
    RunStarted,
    Severity,
    TimePassed,
)
from sim.trace.integrity.sealing import Seal

_SIGNAL_AFTER = 0.5
"""Real seconds after which a program on virtual time that comes to no wait is interrupted by a signal."""
_BATCHES_A_LOOK = 16
"""Sealed batches to one that is sent with a look at the engine's own functions, which takes milliseconds."""
_STOPPED = "it was stopped"

# Kept from before a clock, a program or the keeping of last words put their own in their place.
_real_sleep = time.sleep
_leave = os._exit
_allocate_lock = threading.Lock


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
        self._terminal = Terminal(self._clock, self._outbox.record, setup.keyboard, len(setup.typed))
        self._passed = 0
        self._ending: tuple[str, bool] | None = None
        self._modules = set(sys.modules)
        self._interrupts: list[Callable[[], None]] = []
        self._leaves = _allocate_lock()
        self._grace_begins = threading.Semaphore(0)

    def run(self) -> None:
        """Run the program to its end or the run's, and leave the process."""
        self._outbox.start()
        self._outbox.record(RunStarted(0, self._setup.title, self._setup.clock, self._clock.epoch))
        threading.Thread(target=self._obey, name="commands", daemon=True).start()
        threading.Thread(target=self._end_in_time, name="grace", daemon=True).start()
        self._redirect_output()
        keep_last_words(self._last_words, self._outbox.flush)
        if not self._setup.whole_tracebacks:
            leave_out_own_frames()
        for program in self._setup.programs[:1]:
            tell_of_unheard(self._tell_of_error, program.path, str(Path(program.path).resolve().parent))
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
            give_up = partial(self._give_up_computing, self._virtual)
            Watchdog(self._virtual, self._outbox.record, give_up, self._leave_if_kept).start()
            self._virtual.on_recess = Standstill(self._virtual, self._outbox.record, self._give_up).look
            self._virtual.on_lock_wait = endless.begins
            live_on(self._virtual, Repeatability(self._clock, self._outbox.record).lose)
        elif isinstance(self._clock, PacedClock):
            follow(self._clock)
            HeldUp(self._clock, self._outbox.record).start()
        self._terminal.put_in_place()
        self._schedule()
        if self._seal is not None:
            parts = {"outbox": self._outbox, "probe": self._probe, "host": self._host, "clock": self._clock}
            self._own_functions = OwnFunctions(parts)
        self._modules = set_engine_apart()
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
            for interrupt in self._interrupts:
                interrupt()
            self._programs.wait_until(lambda: not self._programs.any_run)
            return Outcome(_STOPPED, failed=False)
        except StartError as error:
            self._programs.interrupt_all()
            return Outcome(str(error), failed=True, status=1)
        return self._programs.joint_outcome()

    def _start_programs(self) -> None:
        for place, program in enumerate(self._setup.programs, start=1):
            if is_launch_file(program.path):
                launch = self._starter.launch(None, program.path, program.arguments, _nobody_waits)
                self._interrupts.append(launch.interrupt)
            else:
                label = f"{Path(program.path).stem}-{place}"
                started = self._programs.start(script(program.path, program.arguments), label, _nobody_waits)
                self._interrupts.append(started.raise_interrupt)

    def _fail(self, sentence: str) -> None:
        self._have_end(sentence, failed=True)

    def _schedule(self) -> None:
        for call in self._setup.calls:
            self._clock.call_at(call.at, lambda data=call.data: self._call_service(data))  # type: ignore[misc]
        self._lines.schedule(self._setup.lines)
        for typed in self._setup.typed:
            self._clock.call_at(typed.at, partial(self._type, typed.text, scheduled=True))
        if self._setup.until is not None:
            self._clock.call_at(self._setup.until, self._time_is_up)
        if self._virtual is not None:
            for given in self._setup.inputs:
                command = commands.input_of(given.command)
                self._virtual.give_at(given.at, partial(self._carry_out, command), given.recess)

    def _call_service(self, data: bool) -> None:
        service = self._setup.service
        self._requests.set_bool(None if service is None else service.name, data)

    def _type(self, text: str, *, ends: bool = False, scheduled: bool = False) -> None:
        """Type at the programs' terminal; ctrl+c ends the run, unless the program takes it as a key."""
        if self._terminal.interrupts(text):
            self._have_end("it was interrupted from the keyboard", failed=False)
        else:
            self._terminal.type(text, ends=ends, scheduled=scheduled)

    def _time_is_up(self) -> None:
        failures = self._programs.failures
        sentence = "; ".join(["its time was up", *failures[:1]])
        self._have_end(sentence, failed=bool(failures))

    def _have_end(self, reason: str, *, failed: bool) -> None:
        """Have the program end as by Ctrl-C, and the run with it; by force if that takes too long."""
        self._grace_begins.release()
        if self._conclude(reason, failed):
            self._outbox.record(RunEnding(self._clock.now(), reason))
            self._control.let_go()
            if self._virtual is None:
                self._interrupt()
            elif self._virtual.owns_current_thread():
                self._interrupt_on(self._virtual)
            else:
                self._virtual.inject(partial(self._interrupt_on, self._virtual))

    def _conclude(self, reason: str, failed: bool) -> bool:
        """Take the reason that the run ends for, if it is the first; whether it is."""
        if self._ending is not None:
            return False
        self._ending = reason, failed
        if self._endless is not None:
            self._endless.finish()
        if self._host.tuning is not None and not failed:
            with self._host.lock:
                for sentence in self._host.tuning.unmet():
                    self._outbox.record(Notice(self._clock.now(), Severity.WARN, sentence))
        return True

    def _interrupt(self) -> None:
        try:
            self._programs.end_contexts()
        finally:
            _signal_main()

    def _interrupt_on(self, clock: VirtualClock) -> None:
        self._limit_ending(clock)
        self._programs.end_contexts()
        clock.interrupt(threading.main_thread().ident or 0)

    def _limit_ending(self, clock: VirtualClock) -> None:
        clock.resume()
        clock.set_speed(None)
        clock.call_at(clock.now() + VIRTUAL_GRACE, partial(self._end_by_force, VIRTUAL_GRACE / 1e9))

    def _end_in_time(self) -> None:
        """Wait on a thread outside the clock for the run to be over, and see that the process ends then."""
        self._grace_begins.acquire()
        _real_sleep(_SIGNAL_AFTER)
        if self._virtual is not None and self._main_computes_on(self._virtual):
            self._conclude(_STOPPED, failed=False)
            _signal_main()
        _real_sleep(GRACE - _SIGNAL_AFTER)
        self._end_by_force(GRACE)

    def _main_computes_on(self, clock: VirtualClock) -> bool:
        """Whether the main thread has come to no wait since it was to be interrupted there."""
        main = clock.current
        unheard = main.is_main and not clock.rests and (main.knocked or self._ending is None)
        main.knocked = main.knocked and not unheard
        return unheard

    def _end_by_force(self, seconds: float) -> None:
        self._conclude(_STOPPED, failed=False)
        text = (
            f"{self._setup.title} had not ended {seconds:g} s after it was told to{self._where_it_stands()}"
        )
        self._outbox.record(Notice(self._clock.now(), Severity.WARN, f"{text}: it was ended by force"))
        try:
            flush_files_soon()
        finally:
            self._leave()

    def _where_it_stands(self) -> str:
        """What keeps the program from ending, as " (worker: node.py:12, in work)"."""
        frames = sys._current_frames()
        left = [thread for process in self._programs.processes for thread in threads_left_by(process)]
        for thread in (threading.main_thread(), *left):
            place = own_code.place_of(frames.get(thread.ident or 0))
            if place:
                return f" ({thread.name}: {place})"
        return ""

    def _give_up(self, sentence: str) -> None:
        if self._setup.speed is None:
            self._have_end(sentence, failed=True)

    def _leave_if_kept(self, seconds: float) -> None:
        if self._setup.speed is None:
            leave_if_kept(self._last_words, seconds)

    def _give_up_computing(self, clock: VirtualClock, sentence: str) -> None:
        """End a program of which a thread comes to no wait: the main thread by a signal, another by force."""
        if self._setup.speed is not None or not self._conclude(sentence, failed=True):
            return
        self._outbox.record(RunEnding(clock.now(), sentence))
        if not clock.current.is_main:
            flush_files_soon()
            self._leave()
        clock.inject(partial(self._limit_ending, clock))
        clock.inject(self._programs.end_contexts)
        self._grace_begins.release()
        _signal_main()

    def _end(self, outcome: Outcome) -> None:
        """End as CPython does once a script has, and leave."""
        folders = {Path(program.path).resolve().parent for program in self._setup.programs}
        finalise(self._modules, lambda file: any(is_learners(file, folder) for folder in folders))
        if os.getpid() != self._pid:
            _leave(outcome.status)  # a program forked, and this is the other one
        if not self._conclude(outcome.sentence, outcome.failed) and outcome.failed:
            self._tell_of_error(outcome.sentence)  # it failed as it was told to end
        finish_lines()
        self._leave()

    def _break_down(self, error: Exception) -> NoReturn:
        self._conclude(breakdown(error), failed=True)
        self._leave()

    def _leave(self) -> NoReturn:
        """Send what the run ended for as the last of all, and leave the process. For any thread, once."""
        if not self._leaves.acquire(blocking=False):
            while True:
                _real_sleep(GRACE)  # another thread is at it
        self._descriptors.finish()
        reason, failed = self._ending or (_STOPPED, False)
        self._outbox.close(RunEnded(self._clock.now(), reason, failed))
        self._starter.close()
        _leave(0)

    def _redirect_output(self) -> None:
        def stream(error: bool) -> ProcessStream:
            def take(process: Process, text: str, ends: bool) -> None:
                if process.take_output is not None:
                    process.take_output(text, error)
                elif error or process.shows_stdout:
                    self._outbox.record(Printed(self._clock.now(), text, error, process.number, ends))
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
        return None if self._ending else self._host.explain_waits()

    def _look_at_waits_of_real_time(self) -> None:
        if self._virtual is None and self._ending is None:
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
            self._grace_begins.release()
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
            case commands.Type(text=text, ends=ends):
                self._type(text, ends=ends)
            case commands.ResetWorld():
                self._requests.reset_world()
            case commands.KeepContents(wanted=wanted):
                self._contents.wanted = wanted
            case commands.Stop():
                self._have_end(_STOPPED, failed=False)


def _signal_main() -> None:
    main = threading.main_thread().ident
    assert main is not None
    signal.pthread_kill(main, signal.SIGINT)


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
    except KeyboardInterrupt:  # it was stopped before its program began
        engine._leave()
    except WorldUnavailable as error:
        engine._conclude(str(error), failed=True)
        engine._leave()
    except Exception as error:  # noqa: BLE001 - an error of the engine's own, which nobody else tells of
        engine._break_down(error)
