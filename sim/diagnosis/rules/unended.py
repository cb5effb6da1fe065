"""Waits for what nothing in their file sets, and for locks that nobody may ever release."""

from collections.abc import Iterator
from pathlib import Path

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.flags import never_set, parties_at, set_parties, wait_at_most
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, Weight, by_edit, line_of
from sim.diagnosis.time_limits import time_limit
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, GroupKind, Notice, NoticeKind, OwnThreadAt
from sim.trace.model import Position, Window
from sim.trace.timeline import Timeline

_IN_TURN = (
    "a thread that waits for a lock keeps the locks it has: if each has what the other wants, neither ever "
    "goes on",
    "take locks in the same order everywhere, and let go of one before you take the next",
)
_TAKEN = "a lock stays taken until whoever took it releases it, also when the call is over that took it"
_RELEASES = "which releases it on every way out, and let go of it before anything that takes long"


_OF_WAITS = (NoticeKind.OTHER, NoticeKind.NO_PROGRESS, NoticeKind.ENDLESS_WAIT, NoticeKind.DEADLOCK)


def on_waits(timeline: Timeline) -> Iterator[Notice]:
    """Yield the notices on callbacks that do not go on."""
    return (each for each in timeline.notices if each.entity and each.kind in _OF_WAITS)


def unended(
    entity: EntityId, file: str, line: int, timeline: Timeline
) -> tuple[str, str, tuple[Remedy, ...]]:
    """Say that nothing in a file ends the wait of a line, with the cure and its edits; "" if something may.

    ``entity`` is the callback that waits; 0 for a thread of the program's own.
    """
    place, name = CodeLocation(file, line, line), Path(file).name
    if missing := never_set(file, line):
        waiter = who(entity, timeline) if entity else "the thread"
        cure = f"call {missing} where {waiter} may go on, or wait with a timeout"
        edits = by_edit(place, "wait for 0.1 s at most", wait_at_most)
        return f"nothing in {name} calls {missing}", cure, edits
    gate, parties, functions = parties_at(file, line)
    if not (entity and functions):  # what is asked of threads at each update may not go over all callbacks
        return "", "", ()
    callers = [each for each in timeline.entities.values() if each.spoken_name in functions]
    kinds = {timeline.groups[each.group].kind for each in callers}
    is_all = {each.spoken_name for each in callers} == {*functions} and kinds == {GroupKind.EXCLUSIVE}
    if not is_all or len(callers) >= parties:
        return "", "", ()
    fewer = f"make it a Barrier({len(callers)})"
    edits = by_edit(place, fewer, set_parties, len(callers))
    what = f"{gate} lets go when {parties} wait at it, and only {listed(functions)} do"
    return what, f"{fewer}, or wait at it in more callbacks", edits


class ThreadWaitsForNobody(Rule):
    """A thread that the program started waits without a timeout for what its file never sets, as an event.

    Not said of what the file hands on, for another one may set it then.
    """

    id = "thread-waits-for-nobody"
    summary = "a thread of the program waits for an event that nothing sets"
    weight = Weight.REMARK
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such thread."""
        for at in view.timeline.own_threads_at(view.end):
            file, _, line = at.frames[-1]
            if at.call and view.end - at.t >= self.threshold and unended(0, file, line, view.timeline)[0]:
                yield Finding(self, at.t, view.end, about=at.name, event=at)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        assert isinstance(found.event, OwnThreadAt)
        file, _, line = found.event.frames[-1]
        what, cure, _ = unended(0, file, line, timeline)
        return Explanation(
            f"the thread {found.about} waits in {found.event.call}(), and {what}",
            "without a timeout such a wait ends only if somebody ends it",
            cure,
            CodeLocation(file, line, line),
        )


class WaitsForLock(Rule):
    """On the real clock callbacks have waited long for locks, and wait still.

    On real rclpy the holder of a lock is unknown, and whether it ever releases it; where it is known, other
    rules apply. Callbacks that wait for these are part of the finding.
    """

    id = "waits-for-lock"
    summary = "a callback waits for a lock that nobody releases"
    threshold = 2 * SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield the callback that waits longest, with all that wait."""
        started = view.timeline.started
        waiting = [] if started is None or started.clock == "virtual" else _at_locks(view.timeline)
        if waiting and view.end - waiting[0].start >= self.threshold:
            first, stuck = waiting[0], frozenset(each.entity for each in waiting)
            yield Finding(self, first.start, view.end, first.entity, size=view.end - first.start, stuck=stuck)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        waiting = _at_locks(timeline)
        first, *others = (
            f"{who(each.entity, timeline)} ({Path(each.file).name}:{each.line})"
            f"{'' if each.lock in ('', waiting[0].lock) else f' for {each.lock}'}"
            for each in waiting
        )
        also = f", and so {'does' if len(others) == 1 else 'do'} {listed(others)}" if others else ""
        locks = {(timeline.entities[each.entity].node, each.lock) for each in waiting if each.entity}
        why, cure = _IN_TURN
        own = all(each.lock.startswith("self.") and len(each.frames) == 1 for each in waiting)
        if len(locks) == 1 and own:  # else one name may stand for several locks
            why, cure = _TAKEN, f"take {waiting[0].lock} by with everywhere, {_RELEASES}"
        lock = waiting[0].lock or "a lock"
        return Explanation(
            f"{first} has waited for {lock} for {duration(found.lasted)}{also}",
            why,
            cure,
            line_of(found.subject, Window(found.at, found.at + 1), timeline),
        )


def _at_locks(timeline: Timeline) -> list[Position]:
    """Return where threads wait for locks at the end of a timeline, the longest wait first, one per thread.

    Callbacks with a notice of the engine are left out.
    """
    told = {notice.entity for notice in on_waits(timeline)}
    at_end = Window(timeline.end, timeline.end + 1)
    last = (each for thread in timeline.threads for each in timeline.positions_on(thread, at_end)[-1:])
    waiting = (
        each
        for each in last
        if each.end is None and each.waits_for_lock and not (each.holder or time_limit(each))
    )
    untold = (each for each in waiting if each.entity not in told)
    return sorted(untold, key=lambda each: each.start)
