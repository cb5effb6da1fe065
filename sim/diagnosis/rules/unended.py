"""Waits for what nothing in their file sets, and for locks that nobody may ever release."""

from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path

from sim.diagnosis.awaits import awaits_in_vain, let_complete
from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.flags import (
    event_setters,
    never_completed,
    never_set,
    parties_at,
    set_parties,
    wait_at_most,
)
from sim.diagnosis.lasting_waits import lasting_awaits
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    entity_of,
    line_of,
)
from sim.diagnosis.time_limits import time_limit
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import group_of, listed, often, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, EntityKind, GroupKind, Notice, NoticeKind, OwnThreadAt
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


class ReplyAwaitsInVain(Rule):
    """The callback of a service that is called has awaited for long what is no reply to a call of its own.

    Whether that ever comes is unknown, unless nothing completes it, or only what its own group keeps out.
    """

    id = "reply-awaits-in-vain"
    summary = "a service's callback awaits what does not come, and its caller has no reply"
    is_effect = True
    threshold = 3 * SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such callback, since its oldest await."""
        calls = view.now.pending_calls
        for entity in view.few_entities if calls else ():
            asked = sum(each.service == entity.name for each in calls)
            if entity.kind is not EntityKind.SERVICE or not asked or entity.id in (e.caller for e in calls):
                continue
            at = min(
                lasting_awaits(entity.id, view.end, view.timeline), key=attrgetter("start"), default=None
            )
            if at is not None and at.end is None and view.end - at.start >= self.threshold:
                yield Finding(self, at.start, view.end, entity.id, entity.id, size=asked)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, service = who(found.subject, timeline), entity_of(found, timeline).name
        place, kept = _awaits_at(found, timeline), _kept_out(found, timeline)
        keeps, cure, remedies = "", let_complete(place), tuple[Remedy, ...]()
        if kept:
            group, room = group_of(found.subject, timeline), Remedy((found.subject,))
            keeps = f", and keeps {group} meanwhile, in which {listed(kept)} would complete it"
            cure, remedies = f"{room.words(timeline)}, so that {listed(kept)} can run", (room,)
        calls = often(found.size, "calls")
        return Explanation(
            f"{awaits_in_vain(subject, place, found.at)}{keeps}: {service} has not answered{calls}",
            "a service's reply is sent when its callback returns, also that of an async one",
            cure,
            place,
            remedies=remedies,
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if it came, or where others wait for it, which is told; a remark if it may come."""
        waits = timeline.moment(found.until).waiting.values()
        if found.until < timeline.end or any(each.holder == found.subject != each.entity for each in waits):
            return None
        place = _awaits_at(found, timeline)
        is_sure = _kept_out(found, timeline) or (place and never_completed(place.file, place.first_line)[0])
        return self.weight if is_sure else Weight.REMARK


def _awaits_at(found: Finding, timeline: Timeline) -> CodeLocation | None:
    return line_of(found.subject, Window(found.at, found.until + 1), timeline)


def _kept_out(found: Finding, timeline: Timeline) -> list[str]:
    """Return what would complete the future that a callback awaits, if its own group keeps all of it out."""
    place, group = _awaits_at(found, timeline), timeline.entities[found.subject].group
    enders = event_setters(place.file, place.first_line) if place else ()
    mates = {each.spoken_name for each in timeline.group_members(group)}
    is_exclusive = timeline.groups[group].kind is GroupKind.EXCLUSIVE
    return [*enders] if is_exclusive and mates.issuperset(enders) else []


class WaitsForLock(Rule):
    """On the real clock callbacks have waited long for locks, and wait still.

    On real rclpy the holder of a lock may be unknown, and whether it ever releases it; where a callback is
    known to hold it, other rules apply. Callbacks that wait for these are part of the finding.
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
        first, *others = dict.fromkeys(
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
        if each.end is None and each.waits_for_lock and not (each.holder or each.keeper or time_limit(each))
    )
    untold = (each for each in waiting if each.entity not in told)
    return sorted(untold, key=lambda each: each.start)
