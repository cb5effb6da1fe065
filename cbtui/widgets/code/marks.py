"""The activity of each callback in the source files at a moment: running, waiting and why, or just run."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from operator import attrgetter, itemgetter
from pathlib import Path
from typing import NamedTuple, TypeAlias

from cbtui.looks.theme import GLYPHS, Charset
from cbtui.text.cells import fit
from cbtui.widgets.code.signs import CODE_SIGNS
from cbtui.widgets.code.source_files import SourceFile, SourceFiles
from cbtui.widgets.lanes.names import short_thread
from sim.quantities.durations import duration
from sim.trace.descriptions import doing_of, why_waiting
from sim.trace.events import Doing, EntityId, Reason
from sim.trace.figures.waiting import wait_told, waited_so_far, waits_since
from sim.trace.model import AWAIT, EntityInfo, Frame, Moment, Nanoseconds, Position, Span, Window
from sim.trace.roster import roster_of
from sim.trace.timeline import NOBODY, Timeline

JUST_NOW: Nanoseconds = 250_000_000
"""How long a callback stays marked after it has returned, so that short ones are visible."""

_SAMPLED: Nanoseconds = 250_000_000
"""On the real clock lines are sampled, so a callback may have come to its line by so much earlier."""

_LEAST_CUT = 14  # columns below which a text that does not fit is left out
_SIGN = 3  # columns of a sign alone
_LONG: Nanoseconds = 300_000_000


class CallbackActivity(Enum):
    """The activity of a callback, in ascending relevance."""

    IDLE = auto()
    RAN = auto()
    WAITS = auto()
    AWAITS = auto()
    RUNS = auto()


@dataclass(frozen=True, slots=True)
class CallbackMark:
    """A callback's lines in the source and its activity.

    ``texts`` describe it, from the longest to the shortest; ``number`` and ``letter`` are those of its group.
    """

    entity: EntityId
    first_line: int
    last_line: int
    doing: CallbackActivity
    texts: tuple[str, ...]
    letter: str
    number: int
    running_long: bool = False
    reason: Reason | None = None
    """Why it waits, if it does."""


@dataclass(frozen=True, slots=True)
class LineMark:
    """A line at which a callback is, with texts on its activity there, the longest first.

    A line that called another one has no text. ``number`` is that of the callback's group, -1 for none. A
    ``fault`` ended the program.
    """

    texts: tuple[str, ...]
    number: int = 0
    fault: bool = False


class StandingThread(NamedTuple):
    """A thread that may go on, and its next line; 0 outside of the program."""

    thread: str
    file: str
    line: int


LineMarks: TypeAlias = dict[int, LineMark]
"""By line, counted from 1."""


def lines_at(timeline: Timeline, at: Nanoseconds, files: SourceFiles) -> dict[SourceFile, LineMarks]:
    """Return the lines at which callbacks are or await at a moment, or the program or a thread of it waits.

    Also returned are the calls to there.

    Sleeps that follow each other at one line are one position, and a sample between them makes several: of a
    sleep in a loop the text tells when its call began. Of several threads at one line it tells how many they
    are, and what the first one does.
    """
    found: defaultdict[SourceFile, LineMarks] = defaultdict(dict)
    groups, running = list(timeline.groups), timeline.moment(at).running
    positions = [each for thread in running if (each := timeline.position_on(thread, at)) is not None]
    for thread in timeline.threads:
        positions += timeline.program_waits_on(thread, Window(at, at + 1))
    for entity in timeline.entities.keys() & timeline.ever_suspended:
        here = timeline.positions_of(entity, Window(at, at + 1))
        positions += (each for each in here if each.call == AWAIT)
    together = Counter((position.file, position.line) for position in positions)
    since = [(_there_since(position, timeline), position) for position in positions]
    for start, position in sorted(since, key=itemgetter(0)):
        number = groups.index(timeline.entities[position.entity].group) if position.entity else -1
        file = files.of(position.file)
        texts = () if file is None else tuple(_at_line(position, at, start, timeline, file))
        if texts and (many := together[position.file, position.line]) > 1:
            which = "calls" if position.call == AWAIT else "threads"
            texts = (f"▶ {many} {which}, the first{texts[0].removeprefix('▶')}", *texts)
        _mark(found, files, position.frames, number, texts)
    for own in timeline.own_threads_at(at):
        frames, name = tuple(Frame(*frame) for frame in own.frames), short_thread(own.name)
        there = Position(own.t, None, 0, NOBODY, own.doing, own.call, frames, lock=own.lock)
        _mark(found, files, frames, -1, (f"▶ {name} {doing_of(there)}", f"▶ {name}", "▶"))
    return dict(found)


def _mark(
    found: dict[SourceFile, LineMarks],
    files: SourceFiles,
    frames: Sequence[Frame],
    number: int,
    texts: tuple[str, ...],
) -> None:
    """Mark the lines of a stack; ``texts`` are for its innermost one."""
    *calls, here = frames
    for frame in (*calls, here):
        file = files.of(frame.file)
        known = None if file is None else found[file].get(frame.line)
        if file is not None and (known is None or (frame is here and not known.texts)):
            found[file][frame.line] = LineMark(texts if frame is here else (), number)


def _there_since(position: Position, timeline: Timeline) -> Nanoseconds:
    """Return when a thread came to its line; while it waits for a lock each new holder makes a position."""
    while position.waits_for_lock:
        before = timeline.position_on(position.thread, position.start - 1)
        if before is None or before.frames != position.frames:
            break
        position = before
    return position.start


def _at_line(
    position: Position, at: Nanoseconds, start: Nanoseconds, timeline: Timeline, file: SourceFile
) -> Iterator[str]:
    """Yield the texts of the innermost line; how long it has been there only if that is known."""
    doing, lasted = f"▶ {doing_of(position)}", at - start
    call = timeline.moment(at).running.get(position.thread)
    if position.doing is Doing.SLEEPS and position.line in file.looped and call is not None:
        ran = duration(at - call.start)
        yield from (f"{doing} in a loop, called {ran} ago", f"▶ {ran}", "▶")
        return
    if timeline.is_real and lasted < _SAMPLED:
        yield from (doing, "▶")
        return
    full = f"{doing}, {'here for ' if position.doing is Doing.SLEEPS else ''}{duration(lasted)}"
    taken, line = position.taken_at
    if taken:
        where = f"line {line}" if taken == position.file else f"{Path(taken).name}:{line}"
        yield f"{doing}, taken at {where}, {duration(lasted)}"
    yield from (full, f"▶ {duration(lasted)}", "▶")


def standing_at(options: Sequence[StandingThread], files: SourceFiles) -> dict[SourceFile, LineMarks]:
    """Return the lines in front of which the threads stand that may be chosen, with their numbers, from 1."""
    found: defaultdict[SourceFile, defaultdict[int, dict[str, str]]] = defaultdict(lambda: defaultdict(dict))
    for number, option in enumerate(options, start=1):
        file = files.of(option.file) if option.line else None
        if file is not None:
            found[file][option.line][str(number)] = f"{number} {option.thread}"
    return {
        file: {
            line: LineMark((f"▶ {', '.join(each.values())}", f"▶ {', '.join(each)}"), -1)
            for line, each in lines.items()
        }
        for file, lines in found.items()
    }


def fault_at(timeline: Timeline, at: Nanoseconds, files: SourceFiles) -> dict[SourceFile, LineMarks]:
    """Return the line at which something ended the program by a moment, such as an error of syntax."""
    ended = timeline.ended
    if ended is None or not ended.problem or ended.t > at:
        return {}
    path, line = ended.place
    file = files.of(path) if line else None
    return (
        {} if file is None else {file: {line: LineMark((f"{CODE_SIGNS.fault} {ended.problem}",), fault=True)}}
    )


def marks_at(timeline: Timeline, at: Nanoseconds, files: SourceFiles) -> dict[SourceFile, list[CallbackMark]]:
    """Return the callbacks of each file at a moment, in the order of their lines.

    A callback that several entities share is marked once, with the most relevant activity.
    """
    moment = timeline.moment(at)
    found: defaultdict[SourceFile, dict[int, CallbackMark]] = defaultdict(dict)
    active = timeline.active_since(at - JUST_NOW)
    for number in sorted(active.union(roster_of(timeline).places.values())):
        entity = timeline.entities[number]
        file = files.of(entity.file)
        if file is None:
            continue
        marked = _marked(entity, timeline, moment)
        known = found[file].get(entity.first_line)
        if known is None or known.doing.value < marked.doing.value:
            found[file][entity.first_line] = marked
    return {file: [marks[line] for line in sorted(marks)] for file, marks in found.items()}


def _marked(entity: EntityInfo, timeline: Timeline, moment: Moment) -> CallbackMark:
    group = timeline.groups[entity.group]
    doing, texts, since = _doing(entity, timeline, moment)
    waits = wait_told(entity.id, moment, timeline) if doing is CallbackActivity.WAITS else None
    return CallbackMark(
        entity.id,
        entity.first_line,
        entity.last_line,
        doing,
        texts,
        group.letter,
        group.place,
        doing is CallbackActivity.RUNS and moment.at - since >= _LONG,
        None if waits is None else waits.reason,
    )


def _doing(
    entity: EntityInfo, timeline: Timeline, moment: Moment
) -> tuple[CallbackActivity, tuple[str, ...], Nanoseconds]:
    running = (span for span in moment.running.values() if span.entity == entity.id)
    if calls := sorted(running, key=attrgetter("start")):
        times = [duration(moment.at - call.start) for call in calls]
        each = ", ".join(f"{_thread(call, timeline)} {took}" for call, took in zip(calls, times, strict=True))
        several = [f"▶ {len(calls)} calls, longest {times[0]}"] if calls[1:] else []
        texts = (*_blocked_text(calls, moment), f"▶ {each}", *several, f"▶ {times[0]}")
        return CallbackActivity.RUNS, texts, calls[0].start
    wait, awaits = wait_told(entity.id, moment, timeline), _awaits_since(entity, moment, timeline)
    if awaits is not None and (wait is None or wait.is_for_own_call):
        lasted = duration(moment.at - awaits)
        return CallbackActivity.AWAITS, (f"▶ awaits {lasted}", f"▶ {lasted}"), awaits
    if wait is not None:
        since = waits_since(wait, moment.queues[entity.id], timeline)
        hatch, lasted = GLYPHS[Charset.BRAILLE].hatch[wait.reason], duration(moment.at - since)
        waited = f"{hatch} waits {waited_so_far(wait, moment, timeline)}"
        whys = (f"{waited}: {why_waiting(wait, timeline)}", f"{hatch} waits {lasted}", f"{hatch} {lasted}")
        return CallbackActivity.WAITS, whys, since
    recent = timeline.spans_of(entity.id, Window(moment.at - JUST_NOW, moment.at + 1))
    if recent:
        return CallbackActivity.RAN, (f"{CODE_SIGNS.ran} {_thread(recent[-1], timeline)}",), recent[-1].start
    return CallbackActivity.IDLE, ("",), 0


def _awaits_since(entity: EntityInfo, moment: Moment, timeline: Timeline) -> Nanoseconds | None:
    """Return since when the longest of a callback's suspended calls awaits; None if none does."""
    suspended = timeline.suspended(entity.id, Window(moment.at, moment.at + 1))
    return min((each.start for each in suspended), default=None)


def _blocked_text(calls: Sequence[Span], moment: Moment) -> Iterator[str]:
    """Yield the text of a callback that is blocked in ``Client.call``."""
    for call in calls:
        blocked = moment.blocked.get(call.thread)
        if blocked is not None and blocked.entity == call.entity:
            yield f"▶ {duration(moment.at - call.start)}: blocked in the call of {blocked.service}"
            return


def _thread(span: Span, timeline: Timeline) -> str:
    return short_thread(timeline.threads[span.thread].name)


def text_beside(texts: Sequence[str], room: int) -> str:
    """Return the longest text that fits beside code, or a part of the last; a shorter one in place of a sign.

    Code gives way to that: it may be longer than the room.
    """
    padded = [f" {text} " if text else "" for text in texts]
    cut = fit(padded[-1], room, Charset.BRAILLE) if room >= _LEAST_CUT else ""
    text = next((text for text in padded if len(text) <= room), cut)
    short = (each for each in reversed(padded[1:]) if _SIGN < len(each) < _LEAST_CUT)
    return text if len(text) > _SIGN else next(short, text)


def _edge(marked: CallbackMark) -> tuple[CallbackActivity, int, Reason | None]:
    """What the margin beside a callback's lines shows."""
    return marked.doing, marked.number, marked.reason


def changed_lines(before: Sequence[CallbackMark], after: Sequence[CallbackMark]) -> Iterator[tuple[int, int]]:
    """Yield the first line and the length of each range of lines that must be redrawn."""
    known = {marked.first_line: marked for marked in before}
    for marked in after:
        old = known.pop(marked.first_line, None)
        if old == marked:
            continue
        alike = old is not None and _edge(old) == _edge(marked)
        yield marked.first_line, 1 if alike else marked.last_line - marked.first_line + 1
    for gone in known.values():
        yield gone.first_line, gone.last_line - gone.first_line + 1
