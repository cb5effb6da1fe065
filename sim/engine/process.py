"""The engine process: assembles the parts of a run, runs its programs, and ends.

``run`` is the process from its first line to ``os._exit``. A program ends as under CPython, and its events
are recorded until then; what takes longer than ``ending.GRACE`` does not keep the process alive.
"""

import os
import sys
from collections.abc import Sequence
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import msgspec

from sim.clock import PacedClock, RunClock, VirtualClock
from sim.clock.paced_stdlib import follow
from sim.clock.stdlib import live_on
from sim.clock.strategies import schedule_of
from sim.engine.batches import Batches
from sim.engine.callback_overrides import overrides_of
from sim.engine.callback_positions import CallbackPositions
from sim.engine.command_loop import CommandLoop
from sim.engine.exploration.start import explore
from sim.engine.failures.cause import Cause
from sim.engine.failures.crash_dump import enable_crash_dump, exit_unless_renewed
from sim.engine.failures.failure import breakdown, is_learners
from sim.engine.failures.tracebacks import leave_out_own_frames
from sim.engine.failures.uncaught_exceptions import report_uncaught
from sim.engine.outbox import Outbox
from sim.engine.own_threads import OwnThreads
from sim.engine.programs.children import allow_children, refuse_children
from sim.engine.programs.ending import finalise, set_engine_apart
from sim.engine.programs.exit_functions import share_exit_functions
from sim.engine.programs.program import ProgramOutcome
from sim.engine.programs.programs import ProgramSupervisor
from sim.engine.programs.ros2_lines import Ros2Lines
from sim.engine.programs.set_up_programs import run_programs
from sim.engine.programs.source import run_edited
from sim.engine.programs.starting import ProgramStarter
from sim.engine.programs.workspace_imports import use_workspace
from sim.engine.release import profile_of
from sim.engine.requests import Requests
from sim.engine.robot import provide_robot
from sim.engine.setup import RunSetup
from sim.engine.shutdown import RunShutdown
from sim.engine.stdio.descriptors import Descriptors, leave_terminal
from sim.engine.stdio.redirection import redirect_output
from sim.engine.stdio.terminal import Terminal
from sim.engine.time_control import RealControl, VirtualControl
from sim.engine.watchdogs.endless_waits import EndlessWaits
from sim.engine.watchdogs.hung_callbacks import HungCallbacks
from sim.engine.watchdogs.outside_time import Watchdog
from sim.engine.watchdogs.repeatability import Repeatability
from sim.engine.watchdogs.standstill import StandstillDetector
from sim.interpreter import safe_path
from sim.probes.probe import Probe
from sim.probes.synchronisers import SynchroniserFollower
from sim.robot.bullet import WorldUnavailable
from sim.ros import importing
from sim.ros.middleware.contents import Contents
from sim.ros.middleware.host import Host, install
from sim.ros.middleware.process import simulate_processes
from sim.trace.events import Notice, NoticeKind, Printed, RunStarted, Severity
from sim.trace.events.fields import SourcePlace

if TYPE_CHECKING:
    from sim.shell import OnExit, Running

_SAMPLED_EVERY = 100_000_000
"""Nanoseconds between two samples of the threads' frames on the real clock."""


class Engine:
    """One run of one set-up. ``pipe`` carries events out and commands in."""

    def __init__(self, setup: RunSetup, pipe: Connection, crash_dump: Connection) -> None:
        self._setup = setup
        self._pipe = pipe
        self._crash_dump = crash_dump
        self._pid = os.getpid()
        self._exit_process = os._exit  # from before the crash dump replaces it
        clock = (
            VirtualClock(setup.speed, schedule_of(setup.seed), setup.explored_from)
            if setup.clock == "virtual"
            else PacedClock(setup.speed or 1.0)
        )
        self._clock: RunClock = clock
        virtual = clock if isinstance(clock, VirtualClock) else None
        make_room = None if virtual is None else self._make_room
        self._contents = Contents(wanted=setup.contents, make_room=make_room)
        self._batches = Batches(clock, self._contents, setup.seal)
        self._outbox = Outbox(
            pipe,
            may_wait=virtual is not None,
            before_batch=self._look_at_waits_of_real_time,
            pack=self._batches.pack,
            heartbeat=self._batches.heartbeat,
        )
        record = self._outbox.record
        control: VirtualControl | RealControl = (
            RealControl(clock, record) if isinstance(clock, PacedClock) else VirtualControl(clock, record)
        )
        self._control = control
        self._probe = Probe(clock, control.record, self._contents)
        clock.activity = self._probe.running_here
        self._positions = CallbackPositions(self._probe, clock, record)
        self._sample_due = 0
        profile = profile_of(setup, lambda text: record(Notice(0, Severity.ERROR, text)))
        self._host = Host(
            clock, self._probe, threads=setup.threads, overrides=overrides_of(setup), profile=profile
        )
        self._endless = None if virtual is None else EndlessWaits(virtual, self._host, record)
        self._descriptors = Descriptors(lambda text, error: record(Printed(clock.now(), text, error)))
        self._programs = ProgramSupervisor(self._host, record)
        self._own_threads = OwnThreads(self._probe, clock, record, self._programs.main_threads)
        self._starter = ProgramStarter(self._programs, setup, _launch)
        self._lines = Ros2Lines(self._host, record, self._starter, self._programs.look)
        self._terminal = Terminal(clock, record, setup.keyboard, len(setup.typed))
        self._shutdown = RunShutdown(
            setup.title,
            clock,
            self._host,
            self._outbox,
            control,
            self._programs,
            self._starter,
            self._descriptors,
            self._endless,
        )
        self._commands = CommandLoop(
            pipe,
            clock,
            record,
            control,
            self._shutdown,
            self._contents,
            Requests(self._host, record),
            self._lines,
            self._terminal,
        )
        self._modules = set(sys.modules)

    def run(self) -> NoReturn:
        """Run the programs until they or the run end, and exit the process."""
        try:
            self._prepare()
            outcome = run_programs(self._setup.programs, self._programs, self._starter, self._lines)
            self._end(outcome)
        except KeyboardInterrupt:  # it was stopped before its program began
            self._shutdown.leave()
        except WorldUnavailable as error:
            self._shutdown.conclude(Cause(str(error), failed=True))
            self._shutdown.leave()
        except Exception as error:  # noqa: BLE001 - an error of the engine itself, reported here alone
            self._shutdown.conclude(Cause(breakdown(error), failed=True))
            self._shutdown.leave()

    def _prepare(self) -> None:
        """Prepare everything that a program needs before its first line."""
        setup, clock, record = self._setup, self._clock, self._outbox.record
        self._outbox.start()
        record(RunStarted(0, setup.title, setup.clock, clock.epoch, str(self._host.profile)))
        self._commands.start()
        self._shutdown.start()
        redirect_output(clock, record)
        self._descriptors.detach()
        enable_crash_dump(self._crash_dump, self._outbox.flush)
        if not setup.whole_tracebacks:
            leave_out_own_frames()
        for program in setup.programs[:1]:
            report_uncaught(self._tell_of_error, program.path, str(Path(program.path).resolve().parent))
        install(self._host)
        importing.install()
        self._follow_synchronisers()
        self._starter.add_own_interfaces()
        run_edited(setup.texts)
        use_workspace(self._starter.packages, clock)
        simulate_processes()
        share_exit_functions()
        if isinstance(clock, VirtualClock):
            refuse_children()
        else:
            allow_children(self._host, self._outbox, self._pipe)
        provide_robot(setup, self._host, record, self._shutdown.fail)
        if isinstance(clock, VirtualClock):
            self._live_on(clock)
        elif isinstance(clock, PacedClock):
            follow(clock)
            clock.on_long_wait = self._positions.look_back
            HungCallbacks(clock, record, self._probe.running, self._positions.look).start()
        self._terminal.put_in_place()
        self._probe.usage.watch_coroutines()
        self._commands.schedule(setup)
        self._batches.guard(
            {"outbox": self._outbox, "probe": self._probe, "host": self._host, "clock": clock}
        )
        self._modules = set_engine_apart()

    def _follow_synchronisers(self) -> None:
        from sim.ros_packages.message_filters import following  # needs rclpy, which is the model from now on

        following.follow = partial(SynchroniserFollower, self._probe, self._clock.now, self._control.record)

    def _live_on(self, clock: VirtualClock) -> None:
        """Move Python's waits to the virtual clock, and start the watchdogs.

        A person watches a run that has a speed, and can end it; the watchdogs end any other that hangs.
        """
        record, is_watched = self._outbox.record, self._setup.speed is not None
        assert self._endless is not None
        clock.time.before_jump = self._look_at_waits
        clock.on_lock_wait = self._endless.begins
        end_computation = _ignore if is_watched else partial(self._shutdown.end_computation, clock)
        be_back_in = _ignore if is_watched else partial(exit_unless_renewed, self._crash_dump)
        Watchdog(clock, record, self._positions.callback_on, end_computation, be_back_in).start()
        clock.time.on_recess = StandstillDetector(
            clock, record, _ignore if is_watched else self._shutdown.fail
        ).look
        live_on(clock, Repeatability(clock, record).lose)
        if clock.explores:
            asked = explore(clock, self._host, record)
            if asked is not None and isinstance(self._control, VirtualControl):
                self._control.choose = asked.choose

    def _end(self, outcome: ProgramOutcome) -> NoReturn:
        """Do what CPython does at the end of a script, and exit."""
        folders = {Path(program.path).resolve().parent for program in self._setup.programs}
        finalise(self._modules, lambda file: any(is_learners(file, folder) for folder in folders))
        if os.getpid() != self._pid:
            self._exit_process(outcome.status)  # a program forked, and this is the other one
        self._shutdown.finish(outcome)

    def _tell_of_error(self, sentence: str, error: str, place: SourcePlace, kind: NoticeKind) -> None:
        # What a thread raises as the program ends took nothing away from the run.
        kind = NoticeKind.OTHER if self._shutdown.has_begun else kind
        self._outbox.record(
            Notice(self._clock.now(), Severity.ERROR, sentence, kind=kind, place=place, error=error)
        )

    def _look_at_waits(self) -> int | None:
        assert self._endless is not None
        due = self._endless.look()
        self._positions.look()
        self._own_threads.look()
        if self._shutdown.has_begun:
            return None
        return min((each for each in (due, self._host.explain_waits()) if each is not None), default=None)

    def _look_at_waits_of_real_time(self) -> None:
        if not isinstance(self._clock, VirtualClock) and not self._shutdown.has_begun:
            self._host.explain_waits()
            if (now := self._clock.now()) >= self._sample_due:
                self._sample_due = now + _SAMPLED_EVERY
                self._positions.look()
                self._own_threads.look()

    def _make_room(self) -> None:
        self._outbox.flush()


def _ignore(_what: object) -> None:
    """Take the place of a watchdog's action in a run that a person watches."""


def _launch(
    programs: ProgramSupervisor,
    starter: ProgramStarter,
    path: Path,
    arguments: Sequence[str],
    on_exit: "OnExit",
) -> "Running":
    from sim.engine.programs.launching import ModelLaunch  # most runs launch nothing, and begin the sooner

    return ModelLaunch(programs, starter, path, arguments, on_exit).start()


def run(packed_setup: bytes, pipe: Connection, crash_dump: Connection) -> None:
    """Run one set-up in this process; ``crash_dump`` takes the threads' stacks if it crashes."""
    leave_terminal()
    safe_path.forget()
    setup = msgspec.msgpack.decode(packed_setup, type=RunSetup)
    os.set_inheritable(pipe.fileno(), False)
    Engine(setup, pipe, crash_dump).run()
