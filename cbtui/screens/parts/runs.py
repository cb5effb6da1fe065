"""The run on screen: creating it, and passing its events to the UI thread."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeAlias, TypeVar

from textual.message import Message

from cbtui.engines.session import Deliver, Ended
from cbtui.runs.live.findings import FindingsMonitor
from cbtui.runs.live.live_run import RunState, ShownRun
from cbtui.runs.live.pace import PaceMeter
from cbtui.terminal.processor import cpu_wait, time_off_cpu
from sim.trace.events import AnyEvent
from sim.trace.figures.concurrency import Concurrency
from sim.trace.timeline import Timeline

_MESSAGE_SIZE = 256
"""Events per message, so that keys get their turn in between; of the longest lines, a megabyte."""
_TIMEOUT = 1.0
"""Seconds for which a source waits for the screen, which may be gone."""
_MAX_REST = 0.1
"""The longest rest of a source in seconds."""

RunT_co = TypeVar("RunT_co", bound=ShownRun, covariant=True)
MakeRun: TypeAlias = Callable[[float | None, Deliver, Ended], RunT_co]
"""Creates a run at a speed (None: unlimited)."""


class RunController(Generic[RunT_co]):
    """Creates one run after the other and numbers them, so that late events of earlier runs are ignored.

    ``make`` creates a run; ``post`` posts a message to the screen from any thread. ``deliver`` is called on
    the thread of a run's source, everything else on the UI thread.
    """

    @dataclass
    class Delivered(Message, bubble=False):
        """A batch of events of the run with this number."""

        run: int
        events: list[AnyEvent]
        taken: threading.Event = field(default_factory=threading.Event, init=False)

    @dataclass
    class Over(Message, bubble=False):
        """The run with this number delivers no more; ``trouble`` is a sentence if that was unexpected."""

        run: int
        trouble: str | None

    def __init__(self, make: MakeRun[RunT_co], post: Callable[[Message], None]) -> None:
        self.number = 0
        self._make = make
        self._post = post

    @property
    def timeline(self) -> Timeline:
        """Its timeline."""
        return self.run.timeline

    def begin(self, speed: float | None) -> None:
        """Create another run without starting it."""
        self.disown()
        number = self.number
        self.run = self._make(
            speed,
            lambda events: self.deliver(number, events),
            lambda trouble: self._post(self.Over(number, trouble)),
        )
        self.concurrency = Concurrency(self.run.timeline)
        self.findings = FindingsMonitor(self.run.timeline)
        self.pace = PaceMeter()

    def disown(self) -> None:
        """Ignore further events of the run."""
        self.number += 1

    def deliver(self, run: int, events: list[AnyEvent]) -> None:
        """Post a batch in parts.

        A source on another thread waits until the screen has processed a part, then rests for as long as both
        waited for a CPU: a process that never rests is scheduled late when a key comes.
        """
        for first in range(0, len(events), _MESSAGE_SIZE):
            message = self.Delivered(run, events[first : first + _MESSAGE_SIZE])
            before = time_off_cpu()
            self._post(message)
            if threading.current_thread() is not threading.main_thread():
                message.taken.wait(_TIMEOUT)
                time.sleep(min(cpu_wait(before), _MAX_REST))

    def take(self, message: Delivered) -> str | None:
        """Add events to the run on screen, ignoring those of others; returns a warning, if any."""
        message.taken.set()
        if message.run != self.number:
            return None
        warning = self.run.take(message.events)
        self.pace.note(self.timeline.end, self.run.speed if self.run.state is RunState.LIVE else None)
        return warning
