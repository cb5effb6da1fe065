"""A run as screens show it, and the run of an engine: its timeline, its session, and what was asked of it."""

from collections.abc import Sequence
from enum import Enum, auto
from itertools import count
from typing import Protocol

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.runs.live.disk_space import DiskSpaceWatch
from cbtui.runs.live.live_export import ExportableRun
from cbtui.runs.live.live_recording import Finish, LiveRecording
from sim.engine.commands import (
    CallService,
    CompleteLine,
    InterruptLine,
    KeepContents,
    Pause,
    ResetWorld,
    Resume,
    RunLine,
    RunUntil,
    SetSpeed,
    Step,
    Type,
)
from sim.engine.setup import RunSetup
from sim.trace.events import (
    AnyEvent,
    CommandGiven,
    CommandKind,
    KeyboardAsked,
    Notice,
    NoticeKind,
    TimeHalted,
)
from sim.trace.model import Nanoseconds
from sim.trace.storage.event_store import EventStore
from sim.trace.timeline import Timeline

SPEEDS: tuple[float | None, ...] = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, None)
"""Seconds of a run per real second that can be chosen; None, virtual only, is as fast as the engine can."""

_LETS_TIME_PASS = (CommandKind.RESUME, CommandKind.RUN_UNTIL)
"""Commands after which time goes on; a halt before them is that of an earlier command."""

_CHANGES_STATE = {Notice, TimeHalted, CommandGiven}
"""Events that say whether time goes on; most batches have none."""


class RunState(Enum):
    """How far a run has come."""

    STARTING = auto()
    LIVE = auto()
    PAUSED = auto()
    SILENT = auto()
    ENDED = auto()
    LOST = auto()
    REPLAY_STANDS = auto()
    REPLAY_PLAYS = auto()


class ShownRun(Protocol):
    """A run as screens show it, whether an engine makes it now or it was recorded.

    It belongs to the UI thread; only ``stop`` may be called from any. ``loss`` says how the engine was lost.
    """

    setup: RunSetup
    timeline: Timeline
    loss: str | None
    paused: bool
    speed: float | None

    @property
    def state(self) -> RunState:
        """How far it has come."""

    @property
    def alive(self) -> bool:
        """Whether an engine can still be told something."""

    @property
    def asked(self) -> KeyboardAsked | None:
        """How a program waits for the keyboard now; None if none does."""

    @property
    def virtual(self) -> bool:
        """Whether it runs on virtual time."""

    @property
    def speeds(self) -> tuple[float | None, ...]:
        """The speeds that can be chosen."""

    @property
    def can_be_paced(self) -> bool:
        """Whether it can be paused, resumed and given another speed."""

    def start(self) -> str | None:
        """Start the source of its events; a sentence if not all of it works."""

    def take(self, events: list[AnyEvent]) -> str | None:
        """Add what the source delivered; a sentence on what goes wrong meanwhile."""

    def over(self, trouble: str | None) -> Finish | None:
        """Note that no more events come; ``trouble`` says why, if that should not be.

        Returns what is left to do and then tells of it, None if there is nothing.
        """

    def stop(self) -> str | None:
        """End the source, and say what was saved. Blocks for up to a second, and for a recording's file."""

    def material(self) -> ExportableRun:
        """What there is to export of the run so far."""

    def pause(self) -> None:
        """Let time stand."""

    def resume(self) -> None:
        """Let time go on."""

    def change_speed(self, steps: int) -> None:
        """Go up (> 0) or down in ``speeds``."""


def neighbouring_speed(speed: float | None, speeds: Sequence[float | None], steps: int) -> float | None:
    """Return the speed so many steps up (> 0) or down; the last one in that direction has none beside it."""
    return speeds[max(0, min(speeds.index(speed) + steps, len(speeds) - 1))]


class LiveRun:
    """A run in progress. It belongs to the UI thread: what the session delivers is handed over there."""

    def __init__(self, setup: RunSetup, open_session: OpenSession, deliver: Deliver, ended: Ended) -> None:
        self.setup = setup
        self.timeline = Timeline(until_ending=setup.until is not None)
        self._room = DiskSpaceWatch(self.timeline)
        self.recording = LiveRecording(setup)
        self._events = EventStore()
        self.speed = setup.speed if self.virtual else setup.speed or 1.0
        self.loss: str | None = None
        self.paused = False
        self._silent = False
        self._goes_on = True
        self._over = False
        self._numbers = count(len(setup.lines) + 1)
        self._line = 0
        self._started = False
        self._session = open_session(setup, deliver, ended)

    @property
    def state(self) -> RunState:
        """How far the run has come; a lost engine outdoes everything else."""
        if self.loss is not None:
            return RunState.LOST
        if self._over or self.timeline.ended is not None:
            return RunState.ENDED
        if self.timeline.started is None:
            return RunState.STARTING
        if self._silent:
            return RunState.SILENT
        return RunState.PAUSED if self.paused else RunState.LIVE

    @property
    def alive(self) -> bool:
        """Whether the engine can still be told something."""
        return self.state in (RunState.STARTING, RunState.LIVE, RunState.PAUSED, RunState.SILENT)

    @property
    def asked(self) -> KeyboardAsked | None:
        """How a program waits for the keyboard now; None if none does."""
        return self.timeline.asked(self.timeline.end) if self.alive else None

    @property
    def virtual(self) -> bool:
        """Whether time stands still for every thread in a pause, and can go on step by step."""
        return self.setup.clock == "virtual"

    @property
    def speeds(self) -> tuple[float | None, ...]:
        """The speeds that can be chosen for this run."""
        return SPEEDS if self.virtual else SPEEDS[:-1]

    @property
    def can_be_paced(self) -> bool:
        """Whether the engine is there to be paced, and is a model's: real ROS 2 goes on by itself."""
        return self.alive and self.setup.real is None

    @property
    def can_step(self) -> bool:
        """Whether time stands, and can go on to the next scheduling decision."""
        return self.virtual and self.state is RunState.PAUSED

    def start(self) -> str | None:
        """Start the engine, one that cannot be started counts as lost; a sentence if not all of it works."""
        try:
            complaint = self._session.start()
        except OSError as error:
            self.loss = f"it could not be started: {error.strerror or error}"
            return None
        self._started = True
        return complaint

    def take(self, events: list[AnyEvent]) -> str | None:
        """Add what the session delivered; a sentence on what it could not be kept in, or soon cannot."""
        self.timeline.extend(events)
        self._events.take(events)
        self._silent = False
        for event in events if not _CHANGES_STATE.isdisjoint(map(type, events)) else ():
            if isinstance(event, Notice):
                self._silent = self._silent or event.kind is NoticeKind.ENGINE_SILENT
            elif isinstance(event, TimeHalted):
                self.paused = True
            elif isinstance(event, CommandGiven) and self._goes_on and event.kind in _LETS_TIME_PASS:
                self.paused = False
        failure = self.recording.take(events)
        if failure is not None:
            self._session.send(KeepContents(wanted=False))
        return failure or self._room.news(self.recording.path, self.recording.size)

    def over(self, trouble: str | None) -> Finish | None:
        """Note that the engine is gone; ``trouble`` says how, if it should not be.

        Returns what finishes a recording and tells of it, None if there is none.
        """
        self._over = True
        self.loss = trouble
        return self.recording.part()

    def stop(self) -> str | None:
        """End the engine and a recording, and say what that holds.

        Blocks for up to a second and until the recording is written; may be called from any thread.
        """
        if self._started:
            self._session.stop()
        return self.recording.end()

    def record(self, key: str = "R") -> str:
        """Begin a recording in the current folder, and say so; ``key`` is what ends it.

        Raises:
            CannotRecordError: it cannot be made.
        """
        sentence = self.recording.begin(key)
        self._session.send(KeepContents(wanted=True))
        return sentence

    def end_recording(self) -> Finish | None:
        """Record no more; return what finishes the recording and tells of it, None if there is none."""
        self._session.send(KeepContents(wanted=False))
        return self.recording.part()

    def material(self) -> ExportableRun:
        """What there is to export of the run so far."""
        return ExportableRun(self.setup.title, self._events, self.timeline.end, self._events.missing)

    def call(self, data: bool) -> None:
        """Call the SetBool service that the run was set up with, or else the program's first."""
        service = self.setup.service
        self._session.send(CallService(None if service is None else service.name, data))

    def give_line(self, text: str) -> None:
        """Have a ``ros2`` line carried out."""
        self._line = next(self._numbers)
        self._session.send(RunLine(self._line, text))

    def type(self, text: str) -> None:
        """Type at the terminal of the programs."""
        self._session.send(Type(text))

    def interrupt_line(self) -> None:
        """End the line that was given last, as Ctrl-C would."""
        self._session.send(InterruptLine(self._line))

    def complete_line(self, text: str, cursor: int) -> None:
        """Ask what could stand at a place of a line; the answer comes with the trace."""
        self._session.send(CompleteLine(next(self._numbers), text, cursor))

    def pause(self) -> None:
        """Stop time."""
        self.paused, self._goes_on = True, False
        self._session.send(Pause())

    def resume(self) -> None:
        """Let time go on."""
        self.paused, self._goes_on = False, True
        self._session.send(Resume())

    def step(self) -> None:
        """Go on to the next scheduling decision; time stands again there."""
        self._session.send(Step())

    def run_until(self, moment: Nanoseconds) -> None:
        """Go on to a moment that has not come yet; time stands again there."""
        self.paused, self._goes_on = False, True
        self._session.send(RunUntil(moment))

    def reset_world(self) -> None:
        """Put the robot back to its start."""
        self._session.send(ResetWorld())

    def change_speed(self, steps: int) -> None:
        """Go up (> 0) or down in ``speeds``."""
        self.speed = neighbouring_speed(self.speed, self.speeds, steps)
        self._session.send(SetSpeed(self.speed))
