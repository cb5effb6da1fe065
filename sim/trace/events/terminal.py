"""Output and input of a run: log, output, notices, keyboard, ``ros2`` lines."""

from enum import StrEnum

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import (
    CallbackId,
    LineId,
    LoggerName,
    Maybe,
    ProcessId,
    SourcePlace,
    Text,
    ThreadId,
    WireOnly,
)


class Severity(StrEnum):
    """Severity of a log line, named as ROS prints it."""

    DEBUG = "DEBUG"
    INFO = "INFO"
    WARN = "WARN"
    ERROR = "ERROR"
    FATAL = "FATAL"


class Reading(StrEnum):
    """How a program reads from its terminal."""

    NOTHING = "nothing"
    """It does not wait for the keyboard."""
    LINES = "lines"
    """Line by line; each key is shown as it is typed, and ctrl+c ends the run."""
    SECRET = "secret"
    """Line by line, without echo: a password."""
    KEYS = "keys"
    """Key by key, without enter; ctrl+c ends the run."""
    RAW = "raw"
    """Key by key; ctrl+c is a key like any other."""

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
    """False for the beginning of a line, after which the program waits for the keyboard."""


class NoticeKind(StrEnum):
    """The subject of a notice, if more depends on it than a reader's attention."""

    OTHER = "other"
    """Also in recordings without kinds."""
    ENGINE_SILENT = "engine silent"
    """The engine sends nothing."""
    NO_PROGRESS = "no progress"
    """A thread does not return, or lets no time pass; the run may not continue without help."""
    ENDLESS_WAIT = "endless wait"
    """A callback waits without a timeout for what may still come."""
    DEADLOCK = "deadlock"
    """Threads wait without a timeout for what can no longer come."""
    OVERRULED = "overruled"
    """A parameter callback sets the parameter that is being set; the requested value is stored after that."""
    CANCEL_IGNORED = "cancel ignored"
    """An execute callback goes on after the cancel of its goal was accepted, and has not asked for that."""
    EARLY_RESULT = "early result"
    """A callback asks a future for its result as soon as the request is sent, so it is None."""
    REFUSAL_OVERLOOKED = "refusal overlooked"
    """A parameter is refused, and the program makes nothing of the answer that says so."""
    THREAD_DIED = "thread died"
    """An exception ended a thread that is the program's own."""
    PUBLISHERS_KEPT = "publishers kept"
    """Callbacks have made several publishers at one line, and destroyed none."""
    PROGRAM_RAISED = "program raised"
    """A program ended by an exception; others, or threads of its own, go on."""
    REJECTION_OVERLOOKED = "rejection overlooked"
    """A program asks for the result of a goal that the server has rejected."""
    LATE_BOUND = "late bound"
    """Callbacks made in a loop share its variable, so that all of them see the last value."""
    NEVER_AWAITED = "never awaited"
    """A callback makes a coroutine and drops it, so that nothing of it runs."""
    NEVER_ITERATED = "never iterated"
    """A callback is a generator function, so that nothing of it runs."""
    UNANSWERED = "unanswered"
    """A parameter callback returned no result, so that the parameter is refused."""
    UNMATCHED = "unmatched"
    """The run was asked to change a callback that the program does not have."""
    JOB_DIED = "job died"
    """An exception ended a job that the program gave to a pool of threads, and nobody asks for its result."""
    FORGED = "forged"
    """A program records events that only the run may record."""
    COROUTINE_DIED = "coroutine died"
    """An exception ended a coroutine that was given to a thread's loop, and nobody asks for its result."""
    RAISED_AT_END = "raised at end"
    """A program ended by an exception once the run was over, as in a ``finally`` after Ctrl-C."""
    INACTIVE = "inactive"
    """A lifecycle publisher that was never active has dropped messages for a while."""


class Notice(TraceEvent, frozen=True, tag="notice"):
    """The engine informs the person about the run itself."""

    severity: Severity
    """``INFO``, ``WARN`` or ``ERROR``."""
    text: Text
    """One sentence."""
    entity: CallbackId = 0
    unrepeatable: WireOnly[bool] = False
    """Whether it says why a run on virtual time is not reproducible."""
    kind: WireOnly[NoticeKind] = NoticeKind.OTHER
    """Its subject."""
    problem: WireOnly[str] = ""
    """The part of ``text`` that says what is wrong, if a callback waits or a program raised."""
    advice: WireOnly[str] = ""
    """The part of ``text`` that says what to do about it."""
    place: WireOnly[SourcePlace] = ("", 0)
    """The program's own line that it is about, if it is about one."""
    error: WireOnly[str] = ""
    """The exception that ended a thread or a program, as ``ValueError: no scan``."""
    thread: WireOnly[ThreadId] = 0
    """The thread of the call that makes no progress; 0 if it is not known."""
    topic: WireOnly[str] = ""
    """The topic on which nothing was sent so far."""


class KeyboardAsked(TraceEvent, frozen=True, tag="keyboard"):
    """A program begins to wait for the keyboard, does so in another way, or stops.

    A program that polls for keys again and again is recorded the first time only.
    """

    reads: Reading
    """``lines``, ``secret`` (lines without echo), ``keys``, ``raw`` (ctrl+c is a key, too), or ``nothing``.
    """
    program: str
    """The program's name for people."""


class Typed(TraceEvent, frozen=True, tag="typed"):
    """Text was typed at the terminal of the run's programs."""

    text: Text
    """The text; a password is shown as dots."""


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
    """A ``ros2`` line ended."""

    line: LineId
    status: int
    """Exit code."""


class LineCompleted(TraceEvent, frozen=True, tag="completion"):
    """The answer to a completion request for a ``ros2`` line."""

    line: LineId
    start: int
    """Where in the line the completed word begins."""
    words: tuple[str, ...]
    """Candidates for the text from there to the cursor."""
