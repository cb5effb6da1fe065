"""The run itself: its beginning and end, its inputs, its time, and losses of its trace."""

from enum import StrEnum

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import Nanoseconds, SourcePlace, Text, WireOnly


class RunStarted(TraceEvent, frozen=True, tag="run_start"):
    """The run began."""

    target: str
    """The lesson or file that runs."""
    clock: str
    """``virtual`` or ``real``."""
    epoch: Nanoseconds
    """Time since 1970 at ``t`` = 0, as in log lines."""
    distro: str = ""
    """The release of rclpy that the model is like: ``jazzy@7.1.9``; "" on real ROS 2."""
    known_from: WireOnly[Nanoseconds] = 0
    """Where a trace begins that was begun during the run: of earlier events it has what lasts."""


class CommandKind(StrEnum):
    """What a command does to a run."""

    PAUSE = "pause"
    RESUME = "resume"
    SPEED = "speed"
    STEP = "step"
    RUN_UNTIL = "run until"
    CHOOSE = "choose"
    CALL = "call"
    OTHER = "other"
    """Also in recordings without kinds."""


class RunEnded(TraceEvent, frozen=True, tag="run_end"):
    """The run is over: its time was up, its program returned or failed, or it was stopped."""

    reason: str
    """Why the run ended, as a sentence."""
    failed: bool
    """Whether the run ended because something went wrong."""
    time_was_up: WireOnly[bool] = False
    """Whether the run ended because its time was up."""
    error: WireOnly[str | None] = None
    """The exception that ended it, as ``CallbackFailed.error`` has it; "" for none, None if not known."""
    place: WireOnly[SourcePlace] = ("", 0)
    """The line of the program's code that raised the exception, or has to be changed."""
    problem: WireOnly[str] = ""
    """The part of ``reason`` that says what went wrong."""
    advice: WireOnly[str] = ""
    """The part of ``reason`` that says what to do about it."""
    exception: WireOnly[str] = ""
    """The class of the exception that ended it; "" if not known."""


class RunEnding(TraceEvent, frozen=True, tag="run_ending"):
    """The program was asked to end, as by Ctrl-C. Checks ignore its own ending that follows."""

    reason: str
    """Why the run ends, as a sentence."""


class CommandGiven(TraceEvent, frozen=True, tag="command"):
    """The person at the keyboard or the command line did something to the run, such as calling a service."""

    text: Text
    """What was done."""
    kind: WireOnly[CommandKind] = CommandKind.OTHER
    """What it does to the run."""


class InputGiven(TraceEvent, frozen=True, tag="input"):
    """An input from outside takes effect; a repetition needs the same.

    Inputs of the run's set-up are not among these, nor are commands for the run's time.
    """

    command: Text
    """A command of the engine as JSON."""
    recess: WireOnly[int] = 0
    """0 at the end of its moment; a moment without end takes inputs in recesses, counted from 1."""


class TimeHalted(TraceEvent, frozen=True, tag="halt"):
    """Time is paused again: the goal of the run is reached."""

    text: Text
    """The command that set the goal."""


class TimePassed(TraceEvent, frozen=True, tag="time"):
    """The time of a run, sent when there is no other event for a while, so that the display is updated.

    A virtual run sends it only at a pace, between two of its moments.

    Lines of JSON leave it out.
    """


class EventsLost(TraceEvent, frozen=True, tag="lost"):
    """The trace could not keep up, and events were dropped."""

    count: int
    """Events dropped since the run began."""


class ContentsLost(TraceEvent, frozen=True, tag="contents_lost"):
    """Messages were published faster than they could be encoded."""

    count: int
    """Messages without contents since the run began."""
