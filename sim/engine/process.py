"""The engine process: sets up host, robot and clock, runs the program, and ends.

``run`` is what the process does, from its first line to ``os._exit``: whatever a program leaves behind
(threads that never end, exit handlers) must not keep the process alive.
"""

import os
import random
import signal
import sys
import threading
import time
from multiprocessing.connection import Connection

import msgspec

from sim.clock import Clock, RealClock, VirtualClock
from sim.clock.stdlib import live_on
from sim.engine import commands
from sim.engine.outbox import Outbox
from sim.engine.output import LineSink
from sim.engine.program import Outcome, run_program
from sim.engine.requests import Requests
from sim.engine.setup import RunSetup
from sim.engine.watchdog import Watchdog
from sim.robot.bullet import WorldUnavailable
from sim.ros import importing
from sim.ros.host import Host, install
from sim.ros.probe import Probe
from sim.trace.events import CommandGiven, Notice, Printed, RunEnded, RunStarted, Severity

_GRACE = 0.5
"""Real seconds that a program gets to wind up once its run is over."""

_real_sleep = time.sleep


class Engine:
    """One run of one program. ``pipe`` carries events out and commands in."""

    def __init__(self, setup: RunSetup, pipe: Connection) -> None:
        self._setup = setup
        self._pipe = pipe
        self._virtual = VirtualClock(setup.speed) if setup.clock == "virtual" else None
        self._clock: Clock = self._virtual or RealClock()
        self._outbox = Outbox(
            pipe, may_wait=self._virtual is not None, before_batch=self._look_at_waits_of_real_time
        )
        self._host = Host(self._clock, Probe(self._clock, self._outbox.record), threads=setup.threads)
        self._requests = Requests(self._host, self._outbox.record)
        self._over = False
        self._grace_begins = threading.Lock()
        self._grace_begins.acquire()

    def run(self) -> None:
        """Run the program to its end or the run's, and leave the process."""
        self._outbox.start()
        self._outbox.record(RunStarted(0, self._setup.title, self._setup.clock, self._clock.epoch))
        threading.Thread(target=self._obey, name="commands", daemon=True).start()
        threading.Thread(target=self._leave_after_grace, name="grace", daemon=True).start()
        self._redirect_output()
        install(self._host)
        importing.install()
        if self._setup.robot:
            self._start_robot()
        if self._virtual is not None:
            self._virtual.before_jump = self._host.explain_waits
            Watchdog(self._virtual, self._outbox.record, self._give_up).start()
            live_on(self._virtual)
            random.seed(0)
        self._schedule()
        outcome = run_program(self._setup.node_path, self._setup.arguments)
        self._end(outcome)

    def _start_robot(self) -> None:
        from sim.robot.driver import Driver

        Driver(self._host, self._outbox.record).start()

    def _schedule(self) -> None:
        for call in self._setup.calls:
            self._clock.call_at(call.at, lambda data=call.data: self._call_service(data))  # type: ignore[misc]
        if self._setup.until is not None:
            self._clock.call_at(self._setup.until, self._time_is_up)

    def _call_service(self, data: bool) -> None:
        service = self._setup.service
        self._requests.set_bool(None if service is None else service.name, data)

    def _time_is_up(self) -> None:
        self._finish_run("its time was up", failed=False)
        self._interrupt()

    def _finish_run(self, reason: str, *, failed: bool) -> None:
        if not self._over:
            self._over = True
            with self._host.lock:
                self._outbox.close(RunEnded(self._clock.now(), reason, failed))

    def _interrupt(self) -> None:
        """Have the program end as Ctrl-C would, and the process a little later whatever it does."""
        if self._grace_begins.locked():
            self._grace_begins.release()
        if self._virtual is not None:
            self._virtual.stop()
        else:
            signal.raise_signal(signal.SIGINT)

    def _leave_after_grace(self) -> None:
        self._grace_begins.acquire()
        _real_sleep(_GRACE)
        os._exit(0)

    def _give_up(self, sentence: str) -> None:
        if self._setup.speed is None:
            self._finish_run(sentence, failed=True)
            os._exit(1)

    def _end(self, outcome: Outcome) -> None:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, LineSink):
                stream.finish()
        self._finish_run(outcome.sentence, failed=outcome.failed)
        os._exit(0)

    def _redirect_output(self) -> None:
        def take(error: bool) -> LineSink:
            return LineSink(lambda text: self._outbox.record(Printed(self._clock.now(), text, error)))

        sys.stdout = take(False)
        sys.stderr = take(True)

    def _look_at_waits_of_real_time(self) -> None:
        if self._virtual is None and not self._over:
            self._host.explain_waits()

    # Commands, read on a thread of their own

    def _obey(self) -> None:
        while True:
            try:
                command = commands.decode(self._pipe.recv_bytes())
            except (EOFError, OSError):
                os._exit(0)  # the console is gone
            except msgspec.DecodeError as error:
                self._outbox.record(Notice(self._clock.now(), Severity.ERROR, f"unreadable command: {error}"))
                continue
            if self._virtual is not None:
                self._virtual.inject(lambda command=command: self._carry_out(command))  # type: ignore[misc]
            else:
                self._carry_out(command)

    def _carry_out(self, command: commands.Command) -> None:
        match command:
            case commands.CallService(name=name, data=data):
                self._requests.set_bool(name, data)
            case commands.ResetWorld():
                self._requests.reset_world()
            case commands.Stop():
                self._finish_run("it was stopped", failed=False)
                self._interrupt()
            case _:
                self._change_pace(command)

    def _change_pace(self, command: commands.Pause | commands.Resume | commands.SetSpeed) -> None:
        if self._virtual is None:
            text = "the real clock can be neither paused nor slowed; run with the virtual clock for that"
            self._outbox.record(Notice(self._clock.now(), Severity.WARN, text))
            return
        match command:
            case commands.Pause():
                self._virtual.pause()
                text = "pause"
            case commands.Resume():
                self._virtual.resume()
                text = "resume"
            case commands.SetSpeed(speed=speed):
                self._virtual.set_speed(speed)
                text = "speed max" if speed is None else f"speed x{speed:g}"
        self._outbox.record(CommandGiven(self._clock.now(), text))


def run(packed_setup: bytes, pipe: Connection) -> None:
    """Be the engine process of one run."""
    setup = msgspec.msgpack.decode(packed_setup, type=RunSetup)
    if setup.clock == "virtual":
        # Ctrl-C in the terminal reaches every process of it; the console decides what it means.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    engine = Engine(setup, pipe)
    try:
        engine.run()
    except WorldUnavailable as error:
        engine._finish_run(str(error), failed=True)
        os._exit(1)
