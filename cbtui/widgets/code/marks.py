"""What each callback in a source file is doing at a moment: it runs, waits and why, or ran just now."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from pathlib import Path

from cbtui.theme import GLYPHS, Charset
from cbtui.widgets.durations import duration
from cbtui.widgets.lanes.bars import short_thread
from sim.trace.events import EntityId
from sim.trace.model import Entity, Moment, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline
from sim.trace.words import why_waiting

JUST_NOW: Nanoseconds = 250_000_000
"""How long a callback that has returned stays marked, so that a short one is seen at all."""

_LONG: Nanoseconds = 300_000_000


class Doing(Enum):
    """What a callback is doing; the more telling, the later."""

    IDLE = auto()
    RAN = auto()
    WAITS = auto()
    RUNS = auto()


@dataclass(frozen=True, slots=True)
class Marked:
    """A callback's lines in the source and what it is doing.

    ``texts`` says so, in fewer and fewer words; ``number`` and ``letter`` are those of its group.
    """

    first_line: int
    last_line: int
    doing: Doing
    texts: tuple[str, ...]
    letter: str
    number: int
    running_long: bool = False


class Marks:
    """Finds the callbacks of one source file in a timeline."""

    def __init__(self, path: Path) -> None:
        self._name = path.name
        self._real = path.resolve()
        self._ours: dict[str, bool] = {}

    def at(self, timeline: Timeline, at: Nanoseconds) -> list[Marked]:
        """Return the file's callbacks at a moment; one that several entities share is marked once."""
        moment = timeline.moment(at)
        found: dict[int, Marked] = {}
        for entity in timeline.entities.values():
            if not self._is_ours(entity.file):
                continue
            marked = _marked(entity, timeline, moment)
            known = found.get(entity.first_line)
            if known is None or known.doing.value < marked.doing.value:
                found[entity.first_line] = marked
        return [found[line] for line in sorted(found)]

    def _is_ours(self, file: str) -> bool:
        """Tell whether a file is the one; a name without a folder is taken for it."""
        if file not in self._ours:
            path = Path(file.replace("\0", ""))
            self._ours[file] = file == self._name or (path.is_absolute() and path.resolve() == self._real)
        return self._ours[file]


def _marked(entity: Entity, timeline: Timeline, moment: Moment) -> Marked:
    group = timeline.groups[entity.group]
    doing, texts, since = _doing(entity, timeline, moment)
    return Marked(
        entity.first_line,
        entity.last_line,
        doing,
        texts,
        group.letter,
        list(timeline.groups).index(group.id),
        doing is Doing.RUNS and moment.at - since >= _LONG,
    )


def _doing(entity: Entity, timeline: Timeline, moment: Moment) -> tuple[Doing, tuple[str, ...], Nanoseconds]:
    running = list(_running(entity.id, moment))
    if running:
        threads = _threads(running, timeline)
        lasted = duration(moment.at - running[0].start)
        return Doing.RUNS, (f"▶ {threads} {lasted}", f"▶ {threads}", f"▶ {lasted}"), running[0].start
    wait = moment.waiting.get(entity.id)
    if wait is not None:
        waited = f"{GLYPHS[Charset.BRAILLE].hatch[wait.reason]} waits {duration(moment.at - wait.since)}"
        return Doing.WAITS, (f"{waited}: {why_waiting(wait, timeline)}", waited), wait.since
    recent = timeline.spans_of(entity.id, Window(moment.at - JUST_NOW, moment.at + 1))
    if recent:
        return Doing.RAN, (f"· {_threads(recent[-1:], timeline)}",), recent[-1].start
    return Doing.IDLE, ("",), 0


def _running(entity: EntityId, moment: Moment) -> Iterator[Span]:
    return (span for span in moment.running.values() if span.entity == entity)


def _threads(spans: Sequence[Span], timeline: Timeline) -> str:
    return " ".join(short_thread(timeline.threads[span.thread].name) for span in spans)
