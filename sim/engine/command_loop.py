"""Carries out commands from the console, and the inputs that the set-up of a run schedules."""

import os
import threading
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import Connection

import msgspec

from sim.clock import RunClock, VirtualClock
from sim.engine import commands
from sim.engine.failures.cause import Cause
from sim.engine.programs.ros2_lines import Ros2Lines
from sim.engine.requests import Requests
from sim.engine.setup import RunSetup
from sim.engine.shutdown import RunShutdown
from sim.engine.stdio.terminal import Terminal
from sim.engine.time_control import RealControl, VirtualControl
from sim.ros.middleware.contents import Contents
from sim.trace.events import AnyEvent, InputGiven, Notice, Severity


class CommandLoop:
    """Reads commands on its own thread; those that change the run are carried out in the run's time."""

    def __init__(
        self,
        pipe: Connection,
        clock: RunClock,
        record: Callable[[AnyEvent], None],
        control: RealControl | VirtualControl,
        shutdown: RunShutdown,
        contents: Contents,
        requests: Requests,
        lines: Ros2Lines,
        terminal: Terminal,
    ) -> None:
        self._pipe = pipe
        self._clock = clock
        self._virtual = clock if isinstance(clock, VirtualClock) else None
        self._record = record
        self._control = control
        self._shutdown = shutdown
        self._contents = contents
        self._requests = requests
        self._lines = lines
        self._terminal = terminal
        self._exit_process = os._exit  # from before the crash dump replaces it

    def start(self) -> None:
        """Start the reading thread."""
        threading.Thread(target=self._read, name="commands", daemon=True).start()

    def schedule(self, setup: RunSetup) -> None:
        """Schedule the inputs of a set-up."""
        service = None if setup.service is None else setup.service.name
        for call in setup.calls:
            self._clock.call_at(call.at, partial(self._requests.set_bool, service, call.data))
        self._lines.schedule(setup.lines)
        for typed in setup.typed:
            self._clock.call_at(typed.at, partial(self._type, typed.text, scheduled=True))
        if setup.until is not None:
            self._clock.call_at(setup.until, self._shutdown.time_is_up)
        for given in setup.inputs:
            carry_out = partial(self._carry_out, commands.input_of(given.command))
            if self._virtual is None:
                self._clock.call_at(given.at, carry_out)
            else:
                self._virtual.time.schedule_input(given.at, carry_out, given.recess)

    def _read(self) -> None:
        while True:
            try:
                command = commands.decode(self._pipe.recv_bytes())
            except (EOFError, OSError):
                self._exit_process(0)  # the console is gone
            except msgspec.DecodeError as error:
                self._record(Notice(self._clock.now(), Severity.ERROR, f"unreadable command: {error}"))
                continue
            if isinstance(command, commands.PaceCommand):
                self._control.obey(command)
            elif self._virtual is not None:
                self._carry_out_on(self._virtual, command)
            else:
                self._carry_out(command)

    def _carry_out_on(self, clock: VirtualClock, command: commands.WorldCommand) -> None:
        """Schedule a command for the end of the current moment of virtual time."""
        if isinstance(command, commands.CompleteLine):
            clock.time.steer(lambda: self._carry_out(command))
            return
        # What the console itself wants is not told of.
        if clock.time.in_moment and not isinstance(command, commands.Stop | commands.KeepContents):
            text = "time stands in the middle of a moment, and this comes at its end: step, or let time go on"
            self._record(Notice(clock.now(), Severity.WARN, text))
        clock.time.give(lambda: self._carry_out(command))
        if isinstance(command, commands.Stop):
            self._shutdown.hurry()

    def _carry_out(self, command: commands.WorldCommand) -> None:
        if not isinstance(command, commands.CompleteLine):
            recess = 0 if self._virtual is None else self._virtual.time.recesses.current
            self._record(InputGiven(self._clock.now(), commands.input_text(command), recess))
        match command:
            case commands.CallService(name=name, data=data):
                self._requests.set_bool(name, data)
            case commands.RunLine(line=line, text=text):
                self._lines.begin(line, text)
            case commands.InterruptLine(line=line):
                self._lines.interrupt(line)
            case commands.CompleteLine(line=line, text=text, cursor=cursor):
                self._lines.complete(line, text, cursor)
            case commands.TerminalInput(text=text, ends=ends):
                self._type(text, ends=ends)
            case commands.ResetWorld():
                self._requests.reset_world()
            case commands.KeepContents(wanted=wanted):
                self._contents.wanted = wanted
            case commands.Stop():
                self._shutdown.stop()

    def _type(self, text: str, *, ends: bool = False, scheduled: bool = False) -> None:
        """Type at the programs' terminal; ctrl+c ends the run, unless a program reads it as a key."""
        if self._terminal.interrupts(text):
            self._shutdown.request(Cause("it was interrupted from the keyboard", failed=False))
        else:
            self._terminal.type(text, ends=ends, scheduled=scheduled)
