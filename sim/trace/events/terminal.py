"""What a run says, and what is typed into it: log, output, notices, keyboard, ``ros2`` lines."""

from enum import StrEnum

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import CallbackId, LineId, LoggerName, Maybe, ProcessId, Text, ThreadId, WireOnly


class Severity(StrEnum):
    """Severities of a log line, named as ROS prints them."""

    DEBUG = "DEBUG"
    INFO = "INFO"
    WARN = "WARN"
    ERROR = "ERROR"
    FATAL = "FATAL"


class Reading(StrEnum):
    """How a program reads from its terminal."""

    NOTHING = "nothing"
    """It does not wait for the keyboard any more."""
    LINES = "lines"
    """Line by line; each key is shown as it is typed, and ctrl+c ends the run."""
    SECRET = "secret"
    """Line by line, and nothing is shown: a password."""
    KEYS = "keys"
    """Key by key, without enter; ctrl+c ends the run."""
    RAW = "raw"
    """Key by key, and ctrl+c is a key like any other."""

    @property
    def takes_keys(self) -> bool:
        """Whether it takes each key as it is typed."""
        return self in (Reading.KEYS, Reading.RAW)


class Logged(TraceEvent, frozen=True, tag="log"):
    """A program wrote a line to its log."""

    severity: Severity
    """``DEBUG``, ``INFO``, ``WARN``, ``ERROR`` or ``FATAL``."""
    logger: LoggerName
    """Name of the logger."""
    text: Text
    """The line, without its prefix."""
    thread: Maybe[ThreadId]
    entity: CallbackId


class Printed(TraceEvent, frozen=True, tag="print"):
    """A program wrote a line to standard output or error."""

    text: Text
    """The line."""
    error: bool
    """Whether it went to standard error."""
    process: Maybe[ProcessId] = 0
    ends: WireOnly[bool] = True
    """False for the beginning of a line behind which the program waits for the keyboard."""


class NoticeKind(StrEnum):
    """What a notice is about, where more than a reader's eye depends on it."""

    OTHER = "other"
    """Also in recordings that do not tell."""
    ENGINE_SILENT = "engine silent"
    """Nothing comes from the engine."""
    NO_PROGRESS = "no progress"
    """A thread does not come back, or lets no time pass; the run may not go on by itself."""
    ENDLESS_WAIT = "endless wait"
    """A callback waits without a timeout for what may still come."""
    DEADLOCK = "deadlock"
    """Threads wait without a timeout for what cannot come any more."""


class Notice(TraceEvent, frozen=True, tag="notice"):
    """The engine has something to say to the person about the run itself."""

    severity: Severity
    """``INFO``, ``WARN`` or ``ERROR``."""
    text: Text
    """One sentence."""
    entity: CallbackId = 0
    unrepeatable: WireOnly[bool] = False
    """Whether it says why a run on virtual time cannot be repeated exactly."""
    kind: WireOnly[NoticeKind] = NoticeKind.OTHER
    """What it is about."""
    problem: WireOnly[str] = ""
    """The part of ``text`` that says what is wrong, where the notice is about a callback that waits."""
    advice: WireOnly[str] = ""
    """The part of ``text`` that says what to do about it."""


class KeyboardAsked(TraceEvent, frozen=True, tag="keyboard"):
    """A program waits for the keyboard; recorded where it begins to, does so in another way, or stops.

    A program that looks for keys again and again, each time for a moment, is recorded the first time only.
    """

    reads: Reading
    """``lines``, ``secret`` (lines that are not shown), ``keys``, ``raw`` (ctrl+c is a key, too), or
    ``nothing`` any more."""
    program: str
    """What people call the program."""


class Typed(TraceEvent, frozen=True, tag="typed"):
    """Text was typed at the terminal of the run's programs."""

    text: Text
    """What was typed; a password is spelt in dots."""


class LineGiven(TraceEvent, frozen=True, tag="line"):
    """A ``ros2`` line was given, at the prompt, on the command line or by the run's set-up."""

    line: LineId
    text: Text
    """The line."""


class LineSaid(TraceEvent, frozen=True, tag="line_text"):
    """A ``ros2`` line wrote a line of text."""

    line: LineId
    text: Text
    """What it wrote."""
    error: bool
    """Whether it went to standard error."""


class LineEnded(TraceEvent, frozen=True, tag="line_end"):
    """A ``ros2`` line is done."""

    line: LineId
    status: int
    """Exit code."""


class LineCompleted(TraceEvent, frozen=True, tag="completion"):
    """The answer to a request for completion in a ``ros2`` line."""

    line: LineId
    start: int
    """Where in the line the word begins that was to be completed."""
    words: tuple[str, ...]
    """What could stand from there to where completion was asked for."""
