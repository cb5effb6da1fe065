"""The run on screen: it is begun, and what its source delivers is brought to the UI thread."""

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeAlias, TypeVar

from textual.message import Message

from cbtui.engines.session import Deliver, Ended
from cbtui.runs.live.findings import FindingsMonitor
from cbtui.runs.live.live_run import ShownRun
from cbtui.terminal.processor import cpu_wait, time_off_cpu
from sim.trace.events import AnyEvent
from sim.trace.figures.concurrency import Concurrency
from sim.trace.timeline import Timeline

_MESSAGE_SIZE = 256
"""Events that the screen takes before keys have their turn: of lines as long as they come, a megabyte."""
_TIMEOUT = 1.0
"""Seconds for which a source waits for a screen that takes nothing: it may be gone."""
_MAX_REST = 0.1
"""Seconds after which more is handed over, however short of processors the machine is."""

RunT_co = TypeVar("RunT_co", bound=ShownRun, covariant=True)
MakeRun: TypeAlias = Callable[[float | None, Deliver, Ended], RunT_co]
"""Makes a run at a speed (None: as fast as it can)."""


class RunController(Generic[RunT_co]):
    """Begins one run after the other, and numbers them: what an earlier one still delivers no longer counts.

    ``make`` makes a run, ``post`` brings messages from any thread to the screen's, where one
    that is closing lets them drop. ``deliver`` is called on
    the thread of a run's source, everything else on the screen's.
    """

    class Delivered(Message):
        """A batch of events of the run with this number."""

        def __init__(self, run: int, events: list[AnyEvent]) -> None:
            super().__init__()
            self.run = run
            self.events = events
            self.taken = threading.Event()

    class Over(Message):
        """Nothing more comes of the run with this number; ``trouble`` says why, if that should not be."""

        def __init__(self, run: int, trouble: str | None) -> None:
            super().__init__()
            self.run = run
            self.trouble = trouble

    def __init__(self, make: MakeRun[RunT_co], post: Callable[[Message], None]) -> None:
        self.number = 0
        self._make = make
        self._post = post

    @property
    def run(self) -> RunT_co:
        """The run on screen."""
        return self._run

    @property
    def timeline(self) -> Timeline:
        """Its timeline."""
        return self._run.timeline

    def begin(self, speed: float | None) -> None:
        """Make another run, which is not started yet."""
        self.disown()
        number = self.number
        self._run = self._make(
            speed,
            lambda events: self.deliver(number, events),
            lambda trouble: self._post(self.Over(number, trouble)),
        )
        self.concurrency = Concurrency(self._run.timeline)
        self.findings = FindingsMonitor(self._run.timeline)

    def disown(self) -> None:
        """Take nothing more that the run delivers."""
        self.number += 1

    def deliver(self, run: int, events: list[AnyEvent]) -> None:
        """Hand a batch over, in parts.

        Another thread is held up until the screen has taken a part, and then rests for as long as both had
        to wait for a processor: a process that always wants one gets it late when a key comes.
        """
        for first in range(0, len(events), _MESSAGE_SIZE):
            message = self.Delivered(run, events[first : first + _MESSAGE_SIZE])
            before = time_off_cpu()
            self._post(message)
            if threading.current_thread() is not threading.main_thread():
                message.taken.wait(_TIMEOUT)
                time.sleep(min(cpu_wait(before), _MAX_REST))

    def take(self, message: Delivered) -> str | None:
        """Add events to the run, if they are of the one on screen; a sentence on what goes wrong."""
        message.taken.set()
        return self._run.take(message.events) if message.run == self.number else None
