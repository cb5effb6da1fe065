"""Keeps the last seconds of a command's run on real ROS 2, and records them when a problem occurs."""

import signal
import subprocess
import time
from collections import deque
from collections.abc import Iterator, Sequence
from threading import Event, Thread

from cbtui.engines.follow import EngineLostError, FollowedRun, GivenUpError
from cbtui.engines.session import ProcessSession
from cbtui.runs.headless.deadlock_news import told_in_a_line
from cbtui.runs.live.findings import FindingsMonitor
from cbtui.runs.live.live_recording import unused_name
from cbtui.runs.recorded.recording_file import CannotRecordError, start_recording
from cbtui.terminal.interrupts import ending_signals
from cbtui.text.output import complain
from sim.engine.setup import RunSetup
from sim.quantities.nanoseconds import SECOND
from sim.recording import RunSnapshot
from sim.trace.events import AnyEvent, ProcessEnded
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_RECORDED_RULES = (
    "group-starvation",
    "no-free-worker",
    "behind-others",
    "self-made-deadlock",
    "needs-one-more-worker",
    "endless-wait",
    "waits-for-lock",
    "still-computing",
    "service-never-comes",
)
"""Ids of the rules whose problems are recorded: a callback starves, or waits for ever."""
_REDUCE_AFTER: Nanoseconds = 600 * SECOND
"""After this time the examined timeline is reduced to the kept events: a command may run for days."""

_LAST_EVENTS = 1.0
"""Seconds after the command's end for which the end of its processes is waited for."""


class KeptEvents:
    """The last ``seconds`` of a run, and a snapshot of the state before them. Not thread-safe."""

    def __init__(self, seconds: float) -> None:
        self._length = round(seconds * SECOND)
        self._before = RunSnapshot()
        self._batches: deque[list[AnyEvent]] = deque()

    def take(self, events: list[AnyEvent]) -> None:
        """Add a batch of events, and drop those that are too old."""
        self._batches.append(events)
        while self._batches[0][-1].t < events[-1].t - self._length:
            self._before.take(self._batches.popleft())

    def events(self) -> list[AnyEvent]:
        """The snapshot and the kept events, in order."""
        return [*self._before.events(), *(event for batch in self._batches for event in batch)]


class Keeper:
    """Follows one run, and writes a recording at each new problem."""

    def __init__(self, setup: RunSetup, seconds: float) -> None:
        self._setup = setup
        self._seconds = seconds
        self._kept = KeptEvents(seconds)
        self._known: set[tuple[str, int]] = set()
        self._reduce_timeline()

    def take(self, events: list[AnyEvent]) -> None:
        """Take a batch of the run's events."""
        self._kept.take(events)
        self._timeline.extend(events)
        troubles = list(self._troubles(events))
        if troubles:
            complain(f"{'; '.join(troubles)} ({self._write()})")
        if self._timeline.end > self._begun + _REDUCE_AFTER:
            self._reduce_timeline()

    def _reduce_timeline(self) -> None:
        self._timeline = Timeline()
        self._timeline.extend(self._kept.events())
        self._begun = self._timeline.end
        self._monitor = FindingsMonitor(self._timeline)

    def _troubles(self, events: Sequence[AnyEvent]) -> Iterator[str]:
        yield from (event.reason for event in events if isinstance(event, ProcessEnded) and event.status)
        if self._monitor.update_when_due():
            for each in self._monitor.findings:
                key = each.finding.rule.id, each.finding.subject
                if each.is_problem and each.finding.rule.id in _RECORDED_RULES and key not in self._known:
                    self._known.add(key)
                    yield told_in_a_line(each)

    def _write(self) -> str:
        """Write what is kept to a new file in the current folder; returns a clause that names it."""
        try:
            recorder = start_recording(unused_name(self._setup.title), self._setup)
        except CannotRecordError as error:
            return str(error)
        recorder.take(self._kept.events())
        recorder.close()
        if recorder.failure is not None:
            return f"{recorder.path} is not whole: {recorder.failure}"
        return f"the last {self._seconds:g} s: cbtui replay {recorder.path}"


def run_and_keep(command: Sequence[str], environment: dict[str, str], setup: RunSetup, seconds: float) -> int:
    """Run a command to its end, and follow its processes by ``setup``.

    Returns its exit status as a shell does. Ctrl-C reaches the command through the terminal; other signals
    are forwarded to it.
    """
    with subprocess.Popen(command, env=environment) as child:
        over = Event()

        def wait() -> None:
            child.wait()
            time.sleep(_LAST_EVENTS)
            over.set()

        def forward(number: signal.Signals) -> None:
            if number != signal.SIGINT:
                child.send_signal(number)

        Thread(target=wait, name="wait-for-command", daemon=True).start()
        with ending_signals(forward):
            while child.poll() is None:
                _follow(setup, seconds, over)
    return child.returncode if child.returncode >= 0 else 128 - child.returncode


def _follow(setup: RunSetup, seconds: float, over: Event) -> None:
    """Follow the command's processes until all are gone, or until ``over``."""
    keeper = Keeper(setup, seconds)
    try:
        with FollowedRun(setup, ProcessSession, over) as run:
            run.start()
            for events in run:
                if events:
                    keeper.take(events)
    except GivenUpError:
        pass
    except (EngineLostError, OSError) as error:
        complain(f"{error}; the command goes on, and is not watched any more")
        over.wait()
