"""The ``ros2`` lines of a run: the shell model carries them out, the trace has their output."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from sim.engine.programs.starting import ProgramStarter
from sim.engine.setup import TimedLine
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent, LineCompleted, LineEnded, LineGiven, LineId, LineSaid

if TYPE_CHECKING:
    from sim.shell import ShellLine


class Ros2Lines:
    """All ``ros2`` lines of a run. Call it on threads that have the run's time (see ``Clock.call_at``).

    ``changed`` is called after the end of each line.
    """

    def __init__(
        self,
        host: Host,
        record: Callable[[AnyEvent], None],
        starter: ProgramStarter,
        changed: Callable[[], None],
    ) -> None:
        self._host = host
        self._record = record
        self._starter = starter
        self._changed = changed
        self._running: dict[LineId, ShellLine] = {}
        self._scheduled = 0

    def schedule(self, lines: Sequence[TimedLine]) -> None:
        """Carry lines out at their moments, numbered 1, 2, … in this order."""
        for number, line in enumerate(lines, start=1):
            self._scheduled += 1
            self._host.clock.call_at(line.at, lambda n=number, t=line.text: self._begin_scheduled(n, t))  # type: ignore[misc]

    @property
    def any_left(self) -> bool:
        """Whether a line is running or scheduled."""
        return self._scheduled > 0 or bool(self._running)

    def _begin_scheduled(self, number: LineId, text: str) -> None:
        with self._host.lock:
            self._scheduled -= 1
            self.begin(number, text)

    def begin(self, number: LineId, text: str) -> None:
        """Carry out a line."""
        from sim.shell import ShellLine  # only for runs that are given lines
        from sim.shell.model_ground import ModelGround

        def take(said: str, error: bool) -> None:
            self._record(LineSaid(self._host.clock.now(), number, said, error))

        def end(status: int) -> None:
            self._record(LineEnded(self._host.clock.now(), number, status))
            self._end(number)

        with self._host.lock:
            self._record(LineGiven(self._host.clock.now(), number, text))
            line = ShellLine(ModelGround(self._host), text, self._starter, take, end)
            self._running[number] = line
        line.start()

    def _end(self, number: LineId) -> None:
        with self._host.lock:
            self._running.pop(number, None)
        self._changed()

    def interrupt(self, number: LineId) -> None:
        """End a line as Ctrl-C would; does nothing for one that has ended."""
        line = self._running.get(number)
        if line is not None:
            line.interrupt()

    def interrupt_all(self) -> None:
        """Interrupt every running line."""
        for line in tuple(self._running.values()):
            line.interrupt()

    def complete(self, number: LineId, text: str, cursor: int) -> None:
        """Record the candidates for the word at ``cursor``."""
        from sim.shell import complete, word_start
        from sim.shell.model_ground import ModelGround

        words = complete(ModelGround(self._host), self._starter.packages(), text, cursor)
        start = word_start(text, cursor)
        self._record(LineCompleted(self._host.clock.now(), number, start, tuple(words)))
