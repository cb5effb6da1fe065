"""The run that screens show: its protocol, and the live run of an engine."""

from collections import deque
from collections.abc import Sequence
from enum import Enum, auto
from itertools import count
from typing import Protocol

from cbtui.engines.session import Deliver, Ended, OpenSession
from cbtui.runs.live.disk_space import DiskSpaceWatch
from cbtui.runs.live.live_export import ExportableRun
from cbtui.runs.live.live_recording import FinishFile, LiveRecording
from sim.engine.commands import (
    CallService,
    Choose,
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
    TerminalInput,
)
from sim.engine.setup import RobotUse, RunSetup
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
"""Available speeds in seconds of the run per real second; None, virtual only, is unlimited."""

_STARTS_TIME = (CommandKind.RESUME, CommandKind.RUN_UNTIL)
"""Commands that let time pass; a halt that was reported before them belongs to an earlier command."""

_CHANGES_STATE = {Notice, TimeHalted, CommandGiven}
"""Events that tell whether time passes; most batches have none."""


class RunState(Enum):
    """The state of a run."""

    STARTING = auto()
    LIVE = auto()
    PAUSED = auto()
    SILENT = auto()
    ENDED = auto()
    LOST = auto()
    REPLAY_STANDS = auto()
    REPLAY_PLAYS = auto()


class ShownRun(Protocol):
    """A run that a screen shows, live or recorded.

    Used on the UI thread; only ``stop`` may be called from any. ``loss`` says how the engine was lost.
    """

    setup: RunSetup
    timeline: Timeline
    loss: str | None
    paused: bool
    speed: float | None

    @property
    def recording(self) -> LiveRecording | None:
        """The recording of the run; None if it cannot be recorded."""

    @property
    def state(self) -> RunState:
        """The state of the run."""

    @property
    def alive(self) -> bool:
        """Whether an engine still takes commands."""

    @property
    def asked(self) -> KeyboardAsked | None:
        """The current request for keyboard input; None if no program reads."""

    @property
    def virtual(self) -> bool:
        """Whether it runs on virtual time."""

    @property
    def speeds(self) -> tuple[float | None, ...]:
        """The available speeds."""

    @property
    def can_be_paced(self) -> bool:
        """Whether it can be paused, resumed and given another speed."""

    def start(self) -> str | None:
        """Start the source of events; returns a sentence if part of it does not work."""

    def take(self, events: list[AnyEvent]) -> str | None:
        """Add delivered events; returns a warning, None if there is none."""

    def over(self, trouble: str | None) -> FinishFile | None:
        """Note the end of the events; ``trouble`` is a sentence if it came unexpectedly.

        Returns the function that finishes a file, None if there is none.
        """

    def stop(self) -> str | None:
        """End the source; returns a sentence on what was saved. Blocks until the recording is written."""

    def material(self) -> ExportableRun:
        """The run so far, for an export."""

    def pause(self) -> None:
        """Stop time."""

    def resume(self) -> None:
        """Let time pass again."""

    def change_speed(self, steps: int) -> None:
        """Change the speed by steps of ``speeds``."""


def has_robot(run: ShownRun) -> bool:
    """Tell whether a run has the robot, or will have it as soon as its engine has started."""
    return run.setup.robot is RobotUse.ALWAYS or run.timeline.arena is not None


def neighbouring_speed(speed: float | None, speeds: Sequence[float | None], steps: int) -> float | None:
    """Return the speed some steps up (> 0) or down, up to the last one."""
    return speeds[max(0, min(speeds.index(speed) + steps, len(speeds) - 1))]


_STOPS = 1000


class LiveRun:
    """A run of an engine. Used on the UI thread, to which the session's batches are posted."""

    def __init__(self, setup: RunSetup, open_session: OpenSession, deliver: Deliver, ended: Ended) -> None:
        self.setup = setup
        self.timeline = Timeline(until_ending=setup.until is not None)
        self._disk_space = DiskSpaceWatch(self.timeline)
        self.recording = LiveRecording(setup)
        self._events = EventStore()
        self.speed = setup.speed if self.virtual else setup.speed or 1.0
        self.loss: str | None = None
        self.paused = False
        self.stepped = False
        """Whether the last command that concerned time was a step."""
        self.goal: Nanoseconds | None = None
        """The moment to which the run was last sent; None if it goes on without an end, or was stopped."""
        self.stops: deque[Nanoseconds] = deque(maxlen=_STOPS)
        """The moments from which the latest steps began: looking back goes through them, too."""
        self._silent = False
        self._time_passes = True
        self._over = False
        self._line_numbers = count(len(setup.lines) + 1)
        self._line = 0
        self._started = False
        self._session = open_session(setup, deliver, ended)

    @property
    def state(self) -> RunState:
        """The state of the run; a lost engine takes precedence."""
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
        """Whether the engine still takes commands."""
        return self.state in (RunState.STARTING, RunState.LIVE, RunState.PAUSED, RunState.SILENT)

    @property
    def asked(self) -> KeyboardAsked | None:
        """The current request for keyboard input; None if no program reads."""
        return self.timeline.asked(self.timeline.end) if self.alive else None

    @property
    def virtual(self) -> bool:
        """Whether it runs on virtual time, which can be paused and stepped."""
        return self.setup.clock == "virtual"

    @property
    def speeds(self) -> tuple[float | None, ...]:
        """The available speeds."""
        return SPEEDS if self.virtual else SPEEDS[:-1]

    @property
    def can_be_paced(self) -> bool:
        """Whether it can be paused, resumed and given another speed; real ROS 2 goes on by itself."""
        return self.alive and self.setup.real is None

    @property
    def can_step(self) -> bool:
        """Whether time is paused and can be stepped."""
        return self.virtual and self.state is RunState.PAUSED

    def start(self) -> str | None:
        """Start the engine; if that fails it counts as lost. Returns a sentence if a part does not work."""
        try:
            complaint = self._session.start()
        except OSError as error:
            self.loss = f"it could not be started: {error.strerror or error}"
            return None
        self._started = True
        return complaint

    def take(self, events: list[AnyEvent]) -> str | None:
        """Add delivered events; returns a warning about the recording or the disk, None if there is none."""
        self.timeline.extend(events)
        self._events.take(events)
        self._silent = False
        for event in events if not _CHANGES_STATE.isdisjoint(map(type, events)) else ():
            if isinstance(event, Notice):
                self._silent = self._silent or event.kind is NoticeKind.ENGINE_SILENT
            elif isinstance(event, TimeHalted):
                self.paused = True
            elif isinstance(event, CommandGiven) and self._time_passes and event.kind in _STARTS_TIME:
                self.paused = False
        failure = self.recording.take(events)
        if failure is not None:
            self._session.send(KeepContents(wanted=False))
        return failure or self._disk_space.news(self.recording.path, self.recording.size)

    def over(self, trouble: str | None) -> FinishFile | None:
        """Note that the engine is gone; ``trouble`` is a sentence if that was unexpected.

        Returns the function that finishes the recording, None if there is none.
        """
        self._over = True
        self.loss = trouble
        return self.recording.detach()

    def stop(self) -> str | None:
        """End the engine and the recording; returns a sentence on the recording, None if there is none.

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

    def end_recording(self) -> FinishFile | None:
        """Stop recording; returns the function that finishes the file, None if there is none."""
        self._session.send(KeepContents(wanted=False))
        return self.recording.detach()

    def material(self) -> ExportableRun:
        """The run so far, for an export."""
        return ExportableRun(self.setup.title, self._events.batches, self.timeline.end, self._events.missing)

    def call(self, data: bool) -> None:
        """Call the SetBool service that the run was set up with, or else the program's first."""
        service = self.setup.service
        self._session.send(CallService(None if service is None else service.name, data))

    def give_line(self, text: str) -> None:
        """Run a ``ros2`` line."""
        self._line = next(self._line_numbers)
        self._session.send(RunLine(self._line, text))

    def type(self, text: str) -> None:
        """Type at the terminal of the programs."""
        self._session.send(TerminalInput(text))

    def interrupt_line(self) -> None:
        """Interrupt the last line, as Ctrl-C would."""
        self._session.send(InterruptLine(self._line))

    def complete_line(self, text: str, cursor: int) -> None:
        """Request completions at a cursor position; they arrive with the trace."""
        self._session.send(CompleteLine(next(self._line_numbers), text, cursor))

    def pause(self) -> None:
        """Stop time."""
        self.paused, self.stepped, self._time_passes, self.goal = True, False, False, None
        self._session.send(Pause())

    def resume(self) -> None:
        """Let time pass again."""
        self.paused, self.stepped, self._time_passes, self.goal = False, False, True, None
        self._session.send(Resume())

    def choose(self, option: int) -> None:
        """Let the thread with this number in the run's question go on; numbers begin with 0."""
        self._session.send(Choose(option))

    def step(self) -> None:
        """Run to the next scheduling decision, and pause there."""
        if self.paused:
            self.stops.append(self.timeline.end)
        self.stepped, self.goal = True, None
        self._session.send(Step())

    def run_until(self, moment: Nanoseconds) -> None:
        """Run to a future moment, and pause there."""
        self.paused, self.stepped, self._time_passes, self.goal = False, False, True, moment
        self._session.send(RunUntil(moment))

    def reset_world(self) -> None:
        """Put the robot back to its start."""
        self._session.send(ResetWorld())

    def change_speed(self, steps: int) -> None:
        """Change the speed by steps of ``speeds``."""
        self.speed = neighbouring_speed(self.speed, self.speeds, steps)
        self._session.send(SetSpeed(self.speed))
