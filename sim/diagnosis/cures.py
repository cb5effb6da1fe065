"""Remedies that can be tried: callback groups, more threads, edits of the source, or several of these."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from sim.diagnosis.edits.code_edit import CodeEdit
from sim.diagnosis.words import thread_of, threads_for, who, with_threads
from sim.trace.events import EntityId, ExecutorId, Reason, ThreadId
from sim.trace.model import Nanoseconds, Wait, Window
from sim.trace.timeline import Timeline

_LONG: Nanoseconds = 200_000_000
_LOOKED_AT = 100
"""Calls of a callback that are checked for a long one."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """Changes of a program: an edit, callbacks that get a group of their own, threads (0: unchanged).

    ``again``: the edit leaves the callback's work to its further calls.
    """

    own_groups: tuple[EntityId, ...] = ()
    threads: int = 0
    edit: CodeEdit | None = None
    again: bool = False

    def __bool__(self) -> bool:
        """Whether there is anything to try."""
        return self != Remedy()

    def words(self, timeline: Timeline) -> str:
        """Return the changes as a clause; empty for none."""
        advice = [] if self.edit is None else [self.edit.words]
        advice += [f"give {who(each, timeline)} a callback group of its own" for each in self.own_groups]
        if self.threads:
            advice.append(f"spin with {with_threads(self.threads)}")
        return ", and ".join(advice)


def remedy_for_waits(
    waited: Sequence[EntityId], mover: EntityId, window: Window, timeline: Timeline
) -> Remedy:
    """Return the remedy for callbacks that waited in a window; empty if groups and threads do not help.

    A group of its own for ``mover`` helps if another callback held the group; more threads help if no worker
    was free, as always with one thread: for long at a time, or for half of the waits, however short.
    """
    waits = [wait for each in waited for wait in _waits(each, window, timeline)]
    crowded = [wait for wait in waits if wait.workers_busy]
    is_crowded = any(_length([wait], window) >= _LONG for wait in crowded) or (
        _length(crowded, window) >= _length(waits, window) / 2 > 0
    )
    return Remedy(
        (mover,) if any(wait.reason is Reason.GROUP_HELD for wait in waits) else (),
        _threads_needed(crowded, window, timeline) if is_crowded else 0,
    )


def who_moves(waited: Sequence[EntityId], culprit: EntityId, timeline: Timeline) -> EntityId:
    """Return who is to leave a group that ``culprit`` held: it, unless nobody else would wait for it then."""
    run, group = Window(0, timeline.end + 1), timeline.entities[waited[0]].group
    others = {each.id for each in timeline.group_members(group)} - {waited[0], culprit}
    return culprit if waited[1:] or any(timeline.calls_of(each, run) for each in others) else waited[0]


def _waits(entity: EntityId, window: Window, timeline: Timeline) -> Iterator[Wait]:
    """Yield the waits of an entity that another entity caused."""
    for wait in timeline.waits_of(entity, window):
        if wait.holder != entity and wait.reason is not Reason.NOBODY_SPINS:
            yield wait


def _length(waits: Sequence[Wait], window: Window) -> Nanoseconds:
    """Return the total length of waits within a window."""
    return sum(min(wait.end_at(window.end), window.end) - max(wait.start, window.start) for wait in waits)


def _threads_needed(crowded: Sequence[Wait], window: Window, timeline: Timeline) -> int:
    """Return one more than the executor's threads, or than its groups with long calls, if these are more.

    Of those that waited, none counts against itself.
    """
    waited = {wait.entity for wait in crowded}
    involved = [*(wait.holder for wait in crowded), *waited]
    executors = {_executor_of(each, window.end, timeline) for each in involved}
    occupying = [
        each
        for each in timeline.entities.values()
        if (timeline.spans_of(each.id, window) or timeline.waits_of(each.id, window))
        and _is_long(each.id, timeline)
        and _executor_of(each.id, window.end, timeline) in executors
    ]
    occupied = max(len({each.group for each in occupying if each.id != one}) for one in waited)
    return max(threads_for(involved, window.end, timeline), occupied) + 1


def _executor_of(entity: EntityId, at: Nanoseconds, timeline: Timeline) -> tuple[ExecutorId, ThreadId]:
    """The executor that ran an entity's callback last; without workers, by its thread."""
    thread = thread_of(entity, at, timeline)
    if thread is None:
        return 0, 0
    return thread.executor, 0 if thread.executor else thread.id


def _is_long(entity: EntityId, timeline: Timeline) -> bool:
    calls = timeline.spans_of(entity, Window(0, timeline.end + 1))
    return any(span.end_at(timeline.end) - span.start >= _LONG for span in islice(calls, _LOOKED_AT))
