"""The processes of others that a run watches: found by the sockets of their probes, and left as they are."""

from collections.abc import Callable
from pathlib import Path
from selectors import BaseSelector

from sim.real.launched import Outcome
from sim.real.probe_link import ProbeLink
from sim.real.wire import Hello, ProbeLine
from sim.trace.events import AnyEvent, ProcessAppeared, ProcessEnded


class WatchedProcesses:
    """Listens to all probes of a folder, or to those of some processes, and to those that come later.

    ``take`` gets what they tell, ``record`` the events of their coming and going.
    """

    def __init__(
        self,
        selector: BaseSelector,
        folder: Path,
        processes: tuple[int, ...],
        take: Callable[..., None],
        record: Callable[[AnyEvent], None],
    ) -> None:
        self._selector = selector
        self._folder = folder
        self._processes = processes
        self._take = take
        self._record = record
        self._links: dict[Path, ProbeLink] = {}
        self._gone: set[Path] = set()
        self._left = False

    def start(self) -> None:
        """Begin to look for them."""

    def look(self) -> None:
        """Listen to those that have come, and take note of those that are gone."""
        for path in sorted(self._folder.glob("*.sock")):
            if path in self._links or (self._processes and int(path.stem) not in self._processes):
                continue
            number = len(self._links) + 1
            link = ProbeLink(self._selector, lambda lines, number=number: self._told(number, lines))  # type: ignore[misc]
            if link.connect(path):
                self._links[path] = link
            else:
                path.unlink(missing_ok=True)  # its process was killed
        for number, (path, link) in enumerate(self._links.items(), start=1):
            if not link.is_open and path not in self._gone:
                self._gone.add(path)
                self._record(ProcessEnded(0, number, "its process is gone", 0))

    @property
    def any_run(self) -> bool:
        """Whether they are followed, and one of them is there or none has come yet."""
        return not self._left and (len(self._gone) < len(self._links) or not self._links)

    def outcome(self) -> Outcome:
        """All are gone."""
        return Outcome("every process that was watched is gone", failed=False)

    def interrupt(self) -> None:
        """Follow them no longer."""
        self._left = True

    def kill(self) -> list[str]:
        """Leave them as they are: they are not this run's."""
        return []

    def type(self, text: str, *, ends: bool) -> None:
        """Type nothing: they have terminals of their own."""

    def _told(self, number: int, lines: list[ProbeLine]) -> None:
        for line in lines:
            if isinstance(line, Hello):
                self._record(ProcessAppeared(0, number, label_of(line)))
        self._take(lines, process=number)


def label_of(hello: Hello) -> str:
    """What people call a process: its program's name, and its number."""
    return f"{Path(hello.command[1]).name if len(hello.command) > 1 else 'python'}-{hello.process}"
