"""``cbtui ros2 …``: runs a ros2 line in a running engine, or in an engine of its own."""

import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import TypeVar

from cbtui.engines.control_socket import (
    LineOutput,
    LineResult,
    NoEngine,
    RemoteLine,
    connect,
    several_listen,
)
from cbtui.engines.follow import EngineLostError, FollowedRun
from cbtui.engines.listening import ListeningSession
from cbtui.runs.headless.program_log import ProgramLog, write_line
from cbtui.runs.headless.standard_input import StandardInput
from cbtui.runs.setup.lesson_setup import setup_for_line
from cbtui.text.cells import without_tabs
from cbtui.text.output import complain
from sim.engine.commands import InterruptLine, Stop
from sim.trace.events import AnyEvent, LineEnded, LineGiven, LineSaid, RunEnded

ItemT = TypeVar("ItemT")

_ABORTED = 1
_LINE = 1
"""The line's number in an engine of its own."""


def run_line(words: Sequence[str], process: int | None) -> int:
    """Run the line ``ros2 WORDS``; returns its exit status.

    It goes to the run of that process number; for None to the run started last, which says who it is if there
    are others, or, if there is none, to an engine in which nothing else runs.
    """
    text = shlex.join(["ros2", *words])
    try:
        connection = connect(process)
    except NoEngine as error:
        if process is not None:
            complain(str(error))
            return 2
        complain(
            f"{error}, so this line runs in an engine of its own; to reach a run, "
            "give its terminal and this one the same XDG_RUNTIME_DIR, a folder of your own"
        )
        return _StandaloneLine(text).run()
    return _follow_remote(RemoteLine(connection, text, asks_who=process is None and several_listen()))


def _follow_remote(line: RemoteLine) -> int:
    for answer in _interruptible(line.next_answer, line.interrupt):
        match answer:
            case LineOutput(text=said, error=error):
                write_line(without_tabs(said), error=error)
            case LineResult(status=None):
                complain("that run is over; run it again, or open another one")
                return _ABORTED
            case LineResult(status=int() as status):
                return status
    return _ABORTED


class _StandaloneLine:
    """A line in an engine of its own, whose programs print to this terminal."""

    def __init__(self, text: str) -> None:
        self._run = FollowedRun(setup_for_line(text, Path.cwd()), ListeningSession)
        self._input = StandardInput(self._run.session.send)
        self._log = ProgramLog()
        self._status = _ABORTED

    def run(self) -> int:
        """Run the line; the first Ctrl-C interrupts it, the second ends the engine."""
        with self._run, closing(self._input):
            complaint = self._run.start()
            if complaint is not None:
                complain(complaint)
            try:
                for events in _interruptible(self._run.next_batch, self._interrupt):
                    self._take(events)
            except EngineLostError as error:
                complain(str(error))
            except KeyboardInterrupt:
                self._run.session.send(Stop())
        return self._status

    def _interrupt(self) -> None:
        self._run.session.send(InterruptLine(_LINE))

    def _take(self, events: list[AnyEvent]) -> None:
        self._input.follow(events)
        for event in events:
            match event:
                case LineGiven():
                    pass  # the user has just typed it
                case LineSaid(text=text, error=error):
                    write_line(without_tabs(text), error=error)
                case LineEnded(status=status):
                    self._status = status
                case RunEnded(failed=True, reason=reason):
                    complain(reason)
                case _:
                    self._log.print([event])


def _interruptible(take: Callable[[], ItemT | None], interrupt: Callable[[], None]) -> Iterator[ItemT]:
    """Yield the results of ``take`` until None; the first Ctrl-C calls ``interrupt``, the next is raised."""
    interrupted = False
    while True:
        try:
            item = take()
        except KeyboardInterrupt:
            if interrupted:
                raise
            interrupted = True
            interrupt()
            continue
        if item is None:
            return
        yield item
