"""The run itself: its beginning and end, its inputs, its time, and what its trace has lost."""

from enum import StrEnum

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import Nanoseconds, Text, WireOnly


class RunStarted(TraceEvent, frozen=True, tag="run_start"):
    """The run began."""

    target: str
    """The lesson or file that runs."""
    clock: str
    """``virtual`` or ``real``."""
    epoch: Nanoseconds
    """Time since 1970 that ``t`` = 0 has in log lines."""


class CommandKind(StrEnum):
    """What a command does to a run."""

    PAUSE = "pause"
    RESUME = "resume"
    SPEED = "speed"
    STEP = "step"
    RUN_UNTIL = "run until"
    CALL = "call"
    OTHER = "other"
    """Also in recordings that do not tell."""


class RunEnded(TraceEvent, frozen=True, tag="run_end"):
    """The run is over: its time was up, its program returned or failed, or somebody stopped it."""

    reason: str
    """Why the run is over, as a sentence."""
    failed: bool
    """Whether the run ended because something went wrong."""
    time_was_up: WireOnly[bool] = False
    """Whether it had been given so much time, and no more."""
    error: WireOnly[str | None] = None
    """The exception that ended it, as ``CallbackFailed.error`` has it; "" for none, None if not known."""


class RunEnding(TraceEvent, frozen=True, tag="run_ending"):
    """The program was told to end, as by Ctrl-C: what follows is its own ending, and checks leave it out."""

    reason: str
    """Why the run ends, as a sentence."""


class CommandGiven(TraceEvent, frozen=True, tag="command"):
    """The person at the keyboard or the command line did something to the run, such as calling a service."""

    text: Text
    """What was done."""
    kind: WireOnly[CommandKind] = CommandKind.OTHER
    """What it does to the run."""


class InputGiven(TraceEvent, frozen=True, tag="input"):
    """Something was told to the run from outside, and is carried out now: what a repetition has to be told.

    What the set-up of the run foresaw is not among these, nor is what is done to the run's time.
    """

    command: Text
    """A command of the engine as JSON."""
    recess: WireOnly[int] = 0
    """0 at the end of its moment; a moment that does not end takes inputs in recesses, counted from 1."""


class TimeHalted(TraceEvent, frozen=True, tag="halt"):
    """Time stands again: what the run was to go on to has come."""

    text: Text
    """The command that said how far to go."""


class TimePassed(TraceEvent, frozen=True, tag="time"):
    """The run on the real clock has come to ``t``: told while nothing else is, so that time goes on.

    Lines of JSON leave it out.
    """


class EventsLost(TraceEvent, frozen=True, tag="lost"):
    """The trace could not keep up, and events were thrown away."""

    count: int
    """How many were lost since the run began."""


class ContentsLost(TraceEvent, frozen=True, tag="contents_lost"):
    """Messages were published faster than they could be encoded."""

    count: int
    """How many are without contents since the run began."""
