"""Controls a run's time: stops it, changes its speed, continues to a step, a moment or an event.

A control receives the probe's events, and stops time at one that it waits for. All commands for time are
recorded, so that a trace shows why it took as long as it did.
"""

from collections.abc import Callable
from typing import TypeAlias

from sim.clock import VirtualClock
from sim.clock.paced import PacedClock
from sim.engine import commands
from sim.engine.commands import PaceCommand
from sim.quantities.durations import timestamp
from sim.trace.events import (
    ROBOT_THREAD,
    AnyEvent,
    CallbackEnded,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CommandGiven,
    CommandKind,
    EntityReady,
    Notice,
    Severity,
    TimeHalted,
)

Sink: TypeAlias = Callable[[AnyEvent], None]
Wanted: TypeAlias = Callable[[AnyEvent], bool]

_DECISIONS = (CallbackStarted, CallbackEnded, CallbackSuspended, CallbackResumed, EntityReady)


def is_decision(event: AnyEvent) -> bool:
    """Return whether a step ends with this event."""
    return isinstance(event, _DECISIONS)


class VirtualControl:
    """Controls a virtual clock. ``record`` takes the probe's events and passes them to ``sink``."""

    def __init__(self, clock: VirtualClock, sink: Sink) -> None:
        self._clock = clock
        self._sink = sink
        self._wanted: Wanted | None = None
        self._goal = ""
        self.choose: Callable[[int], None] = _ignore
        """Takes the answer when the run asks which thread continues."""
        clock.time.pace.on_halt = self._note_halt
        clock.time.is_background = lambda thread: thread.name == ROBOT_THREAD

    def record(self, event: AnyEvent) -> None:
        """Take an event; stop time before this returns if the run continued up to such an event."""
        self._sink(event)
        wanted = self._wanted
        if wanted is not None and wanted(event) and self._clock.owns_current_thread():
            self._clock.halt()

    def obey(self, command: PaceCommand) -> None:
        """Carry out a command as soon as the run's threads allow it; any thread may call this."""
        self._clock.time.steer(lambda: self._carry_out(command))

    def let_go(self) -> None:
        """Let the run complete the moment in which it stands; any thread may call this."""
        self._clock.time.steer(self._leave_moment)

    def _leave_moment(self) -> None:
        if self._clock.time.in_moment:
            self._wanted = None
            self._clock.time.resume()

    def _carry_out(self, command: PaceCommand) -> None:
        clock, wanted = self._clock, None
        match command:
            case commands.Pause():
                clock.time.pause()
            case commands.Resume():
                clock.time.resume()
            case commands.SetSpeed(speed=speed):
                clock.time.set_speed(speed)
                wanted = self._wanted
            case commands.Step():
                clock.time.step()
                wanted = is_decision
            case commands.Choose(option=option):
                self.choose(option)
            case commands.RunUntil(moment=moment):
                if moment <= clock.now():
                    self._sink(_too_late(clock.now(), moment))
                    return
                clock.time.run_until(moment)
        self._wanted = wanted
        if not isinstance(command, commands.SetSpeed):
            self._goal = in_words(command)
        self._sink(given(clock.now(), command))

    def _note_halt(self) -> None:
        if self._clock.time.pace.paused:
            self._wanted = None
        self._sink(TimeHalted(self._clock.now(), self._goal))


class RealControl:
    """Controls a paced clock. ``record`` passes the probe's events to ``sink``. Thread-safe.

    A pause stops waits only: a callback that computes continues, with its effects.
    """

    def __init__(self, clock: PacedClock, sink: Sink) -> None:
        self._clock = clock
        self._sink = self.record = sink
        self._goal: PaceCommand = commands.Resume()

    def obey(self, command: PaceCommand) -> None:
        """Carry out a command."""
        match command:
            case commands.SetSpeed(speed=speed):
                self._change_speed(speed)
                return
            case commands.Choose():
                self._say("on the real clock the machine chooses who goes on; use the virtual clock")
                return
            case commands.Step():
                self._say("the real clock cannot go step by step: threads run at once; use the virtual clock")
                return
            case commands.RunUntil(moment=moment) if moment <= self._clock.now():
                self._sink(_too_late(self._clock.now(), moment))
                return
        self._sink(given(self._clock.now(), command))
        self._goal = command
        match command:
            case commands.Pause():
                self._clock.pause()
                self._say(
                    "time is stopped for whatever waits; a callback that computes goes on", Severity.INFO
                )
            case commands.Resume():
                self._clock.resume()
            case commands.RunUntil(moment=moment):
                self._clock.call_at(moment, lambda: self._halt(command))
                self._clock.resume()

    def let_go(self) -> None:
        """Let time pass at real speed, so that the run can end."""
        self._clock.resume()
        self._clock.set_speed(1.0)

    def _change_speed(self, speed: float | None) -> None:
        if speed is None:
            self._say("the real clock cannot go as fast as it can: computing takes its time; give it a speed")
            return
        self._clock.set_speed(speed)
        self._sink(given(self._clock.now(), commands.SetSpeed(speed)))

    def _halt(self, goal: PaceCommand) -> None:
        if goal is self._goal:  # else another command has replaced it
            self._goal = commands.Pause()
            self._clock.pause()
            self._sink(TimeHalted(self._clock.now(), in_words(goal)))

    def _say(self, text: str, severity: Severity = Severity.WARN) -> None:
        self._sink(Notice(self._clock.now(), severity, text))


_KINDS = {
    commands.Pause: CommandKind.PAUSE,
    commands.Resume: CommandKind.RESUME,
    commands.SetSpeed: CommandKind.SPEED,
    commands.Step: CommandKind.STEP,
    commands.RunUntil: CommandKind.RUN_UNTIL,
    commands.Choose: CommandKind.CHOOSE,
}


def given(now: int, command: PaceCommand) -> CommandGiven:
    """Return the event of a command."""
    return CommandGiven(now, in_words(command), _KINDS[type(command)])


def in_words(command: PaceCommand) -> str:
    """Return a command as text."""
    match command:
        case commands.Pause():
            return "pause"
        case commands.Resume():
            return "resume"
        case commands.Step():
            return "step"
        case commands.SetSpeed(speed=speed):
            return "speed max" if speed is None else f"speed x{speed:g}"
        case commands.Choose(option=option):
            return f"choose {option + 1}"
        case commands.RunUntil(moment=moment):
            return f"run until {moment / 1e9:.9g} s"


def _too_late(now: int, moment: int) -> Notice:
    text = f"the run has come to {timestamp(now)}, so it cannot go on until {moment / 1e9:.9g} s"
    return Notice(now, Severity.WARN, text)


def _ignore(_option: int) -> None:
    """Take the place of ``choose`` in a run that does not ask."""
