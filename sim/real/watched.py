"""Processes that a run only watches: it finds their probes' sockets, and never ends them."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from selectors import BaseSelector

from sim.engine.failures.cause import Cause
from sim.engine.setup import RealRos
from sim.real.probe_link import Place, ProbeLink, sockets_in
from sim.real.programs import ended_by
from sim.real.wire import Hello, ProbeLine
from sim.trace.events import AnyEvent, Notice, ProcessAppeared, ProcessEnded, Severity


class WatchedProcesses:
    """Listens to the probes that ``wanted`` names, and to those that come later.

    ``take`` gets their lines, ``record`` the events about their start and end; ``numbers`` gives their
    numbers on the trace. A process id that ``is_known`` is left out.
    """

    def __init__(
        self,
        selector: BaseSelector,
        wanted: RealRos,
        take: Callable[..., None],
        record: Callable[[AnyEvent], None],
        numbers: Iterator[int],
        is_known: Callable[[int], bool],
    ) -> None:
        self._selector = selector
        self._wanted = wanted
        self._take = take
        self._record = record
        self._numbers = numbers
        self._is_known = is_known
        self._links: dict[Place, tuple[int, ProbeLink]] = {}
        self._unnamed: dict[int, str] = {}
        """The labels of processes that have not told anything yet, by their numbers on the trace."""
        self._outcomes: dict[Place, Cause] = {}
        self._left = False

    def start(self) -> None:
        """Connect to the probes given by host and port, which no folder lists."""
        for address in self._wanted.addresses:
            self._listen_to(address)

    def look(self) -> None:
        """Connect to new probes, and notice processes that are gone."""
        for path in self._new_sockets():
            if not self._listen_to(path):
                path.unlink(missing_ok=True)  # its process was killed
        for place, (number, link) in self._links.items():
            if not link.is_open and place not in self._outcomes:
                outcome = self._outcomes[place] = _outcome(link)
                self._record(ProcessEnded(0, number, outcome.reason, int(outcome.failed)))
                if self.any_run:
                    severity = Severity.WARN if outcome.failed else Severity.INFO
                    self._record(Notice(0, severity, outcome.reason))

    def _new_sockets(self) -> Iterator[Path]:
        chosen = self._wanted.processes
        if self._wanted.watched:
            for path in sockets_in(Path(self._wanted.watched)):
                process = int(path.stem)
                is_wanted = not chosen or process in chosen
                if is_wanted and path not in self._links and not self._is_known(process):
                    yield path

    def _listen_to(self, place: Place) -> bool:
        number = next(self._numbers)
        link = ProbeLink(self._selector, partial(self._told, number))
        if link.connect(place):
            self._links[place] = number, link
        return link.is_open

    @property
    def has_failed(self) -> bool:
        """Whether one of them did not exit by itself so far."""
        return any(each.failed for each in self._outcomes.values())

    @property
    def any_run(self) -> bool:
        """Whether to go on: a process is there, or none has come yet."""
        return not self._left and (len(self._outcomes) < len(self._links) or not self._links)

    def outcome(self) -> Cause:
        """The outcome once all are gone; a process that did not exit by itself takes precedence."""
        usual = Cause("every process that was watched is gone", failed=False)
        return next((each for each in self._outcomes.values() if each.failed), usual)

    def interrupt(self) -> None:
        """Stop following them."""
        self._left = True

    def kill(self) -> list[str]:
        """Do nothing: watched processes are not ended."""
        return []

    def _told(self, number: int, lines: list[ProbeLine]) -> None:
        """Take lines of a process, which appears at the time of its first event; that may be long ago."""
        for line in lines:
            if isinstance(line, Hello):
                self._unnamed[number] = label_of(line)
            elif number in self._unnamed:
                self._take([ProcessAppeared(line.t, number, self._unnamed.pop(number))])
        self._take(lines, process=number)


def _outcome(link: ProbeLink) -> Cause:
    name = "a process" if link.hello is None else label_of(link.hello)
    if link.uncaught is not None:
        return ended_by(link.uncaught, name)
    if link.has_left:
        return Cause(f"{name} ended", failed=False)
    return Cause(f"{name} was killed, or its connection is gone", failed=True)


def label_of(hello: Hello) -> str:
    """The label of a process: its program's name and its process id."""
    return f"{Path(hello.command[1]).name if len(hello.command) > 1 else 'python'}-{hello.process}"
