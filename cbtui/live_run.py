"""A run as the console holds it: its timeline, its session, and what the person has asked of it."""

from collections.abc import Callable
from enum import Enum, auto
from itertools import count
from typing import Protocol, TypeAlias

from sim.engine.commands import (
    CallService,
    Command,
    CompleteLine,
    InterruptLine,
    Pause,
    ResetWorld,
    Resume,
    RunLine,
    SetSpeed,
)
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent
from sim.trace.timeline import Timeline

SPEEDS: tuple[float | None, ...] = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, None)
"""Virtual seconds per real second that can be chosen; None is as fast as the engine can."""

Deliver: TypeAlias = Callable[[list[AnyEvent]], None]
Ended: TypeAlias = Callable[[str | None], None]


class Session(Protocol):
    """One engine process. ``deliver`` and ``ended`` are called on a thread of the session's own."""

    def start(self) -> None:
        """Start the process."""

    def send(self, command: Command) -> None:
        """Tell the engine something; ignored once it has ended."""

    def stop(self) -> None:
        """End the process, within a second; may be called again."""


OpenSession: TypeAlias = Callable[[RunSetup, Deliver, Ended], Session]


class State(Enum):
    """How far a run has come."""

    STARTING = auto()
    LIVE = auto()
    PAUSED = auto()
    ENDED = auto()
    LOST = auto()


class LiveRun:
    """A run in progress. It belongs to the UI thread: what the session delivers is handed over there."""

    def __init__(self, setup: RunSetup, open_session: OpenSession, deliver: Deliver, ended: Ended) -> None:
        self.setup = setup
        self.timeline = Timeline()
        self.speed = setup.speed
        self.loss: str | None = None
        self.paused = False
        self._over = False
        self._numbers = count(len(setup.lines) + 1)
        self._line = 0
        self._started = False
        self._session = open_session(setup, deliver, ended)

    @property
    def state(self) -> State:
        """How far the run has come; a lost engine outdoes everything else."""
        if self.loss is not None:
            return State.LOST
        if self._over or self.timeline.ended is not None:
            return State.ENDED
        if self.timeline.started is None:
            return State.STARTING
        return State.PAUSED if self.paused else State.LIVE

    @property
    def alive(self) -> bool:
        """Whether the engine can still be told something."""
        return self.state not in (State.ENDED, State.LOST)

    @property
    def virtual(self) -> bool:
        """Whether time can be made faster and slower."""
        return self.setup.clock == "virtual"

    def start(self) -> None:
        """Start the engine; one that cannot be started counts as lost."""
        try:
            self._session.start()
            self._started = True
        except OSError as error:
            self.loss = f"it could not be started: {error.strerror or error}"

    def take(self, events: list[AnyEvent]) -> None:
        """Add what the session delivered."""
        self.timeline.extend(events)

    def over(self, loss: str | None) -> None:
        """Note that the engine is gone; ``loss`` says how, if it should not be."""
        self._over = True
        self.loss = loss

    def stop(self) -> None:
        """End the engine. Blocks for up to a second; may be called from any thread."""
        if self._started:
            self._session.stop()

    def call(self, data: bool) -> None:
        """Call the SetBool service that the run was set up with, or else the program's first."""
        service = self.setup.service
        self._session.send(CallService(None if service is None else service.name, data))

    def give_line(self, text: str) -> None:
        """Have a ``ros2`` line carried out."""
        self._line = next(self._numbers)
        self._session.send(RunLine(self._line, text))

    def interrupt_line(self) -> None:
        """End the line that was given last, as Ctrl-C would."""
        self._session.send(InterruptLine(self._line))

    def complete_line(self, text: str, cursor: int) -> None:
        """Ask what could stand at a place of a line; the answer comes with the trace."""
        self._session.send(CompleteLine(next(self._numbers), text, cursor))

    def pause(self) -> None:
        """Stop time."""
        self.paused = True
        self._session.send(Pause())

    def resume(self) -> None:
        """Let time go on."""
        self.paused = False
        self._session.send(Resume())

    def reset_world(self) -> None:
        """Put the robot back to its start."""
        self._session.send(ResetWorld())

    def change_speed(self, steps: int) -> None:
        """Go up (> 0) or down in ``SPEEDS``."""
        place = max(0, min(SPEEDS.index(self.speed) + steps, len(SPEEDS) - 1))
        self.speed = SPEEDS[place]
        self._session.send(SetSpeed(self.speed))
