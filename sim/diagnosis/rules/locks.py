"""A lock that is held long while callbacks wait for it, and released later."""

from collections.abc import Iterable, Iterator

from sim.diagnosis.edits.locks import locks_in_turn
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    line_location,
    place_of,
    positions_of_call,
)
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, lock_keeper, lock_taker, often, threads_for, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import doing_of
from sim.trace.events import Doing, EntityId
from sim.trace.model import Nanoseconds, Position, Window
from sim.trace.timeline import Timeline

LET_GO = "keep the lock only while you read or write what it guards; sleep, wait and compute outside"
_LONG = SECOND // 2


class LockHeldLong(Rule):
    """Callbacks waited long for a lock that another callback, or a thread of the program, held meanwhile.

    Other rules tell of locks that nobody releases, and of callbacks that wait for calls of their own.
    """

    id = "lock-held-long"
    summary = "callbacks wait long for a lock that another one holds"
    is_effect = by_culprit = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such wait."""
        for thread in view.timeline.threads:
            for each in _long_waits(view.timeline.positions_on(thread, view.window), view.timeline):
                until, keeper = each.end_at(view.end), lock_keeper(each, view.timeline)
                by, size = "" if keeper else each.taken_by, until - each.start
                yield Finding(self, each.start, until, each.entity, keeper, about=by, size=size)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        during = Window(found.at, found.until)
        known = (each for thread in timeline.threads for each in timeline.positions_on(thread, during))
        waits = list(_long_waits(known, timeline))
        own = (each for each in timeline.positions_of(found.subject, during) if each.waits_for_lock)
        lock = max(own, key=lambda each: _length(each, found.until))
        taker, held = lock_taker(lock, timeline), _holder_at(lock, timeline)
        place, does = line_location(*lock.taken_at), "it took it"
        threads = timeline.own_threads_at((found.at + found.until) // 2)
        if held is not None:
            place, does = CodeLocation(held.file, held.line, held.line), f"it {doing_of(held)}"
        elif at := next((each for each in threads if not found.culprit and each.name == lock.taken_by), None):
            file, _, line = at.frames[-1]
            place, does = line_location(file, line), "it sleeps" if at.doing is Doing.SLEEPS else "it waits"
        where = f": {does} at line {place.first_line}" if place else ""
        waiting = [each.entity for each in waits if lock_taker(each, timeline) == taker]
        up_to = "up to " if len({*waiting}) > 1 or found.count > 1 else ""
        return Explanation(
            f"{listed(who(each, timeline) for each in (found.subject, *waiting))} waited {up_to}"
            f"{duration(found.lasted)} for {lock.lock or 'a lock'}, which {taker} held{where}"
            f"{often(found.count)}",
            "whoever wants a lock waits as long as it is held, and keeps thread and group meanwhile",
            LET_GO,
            place or place_of(found.culprit or found.subject, timeline),
        )


class LocksInTurn(Rule):
    """Two callbacks that may run at once take the same two locks in opposite orders.

    As long as each has both before the other begins, nothing happens. Once they wait for each other, that is
    told instead.
    """

    id = "locks-in-turn"
    summary = "two callbacks take two locks in opposite orders"
    weight = Weight.REMARK
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such pair of callbacks that have both run."""
        timeline, called = view.timeline, Window(0, view.end + 1)
        known = {(each.file, each.first_line): each for each in view.few_entities if each.callback}
        for file in {file for file, _ in known if file}:
            for one, _, two, line, *locks in locks_in_turn(file):
                pair = [known[file, each] for each in (one, two) if (file, each) in known]
                beside = len({each.group for each in pair}) == 2 or timeline.groups[pair[0].group].is_open
                ran = [each for each in pair if timeline.calls_of(each.id, called)]
                is_alone = threads_for((each.id for each in ran), view.end, timeline) == 1
                if len(ran) == 2 and beside and not is_alone and ran[0].node == ran[1].node:
                    about = f"{file}:{line} {' '.join(locks)}"
                    yield Finding(self, 0, view.end, pair[0].id, pair[1].id, about, detail=file, size=line)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        *_, outer, inner = found.about.split()
        one, two = who(found.subject, timeline), who(found.culprit, timeline)
        return Explanation(
            f"{one} takes {outer} and then {inner}, {two} first {inner} and then {outer}: run at "
            "once, they may wait for each other for ever",
            "whoever waits for a lock keeps the ones it has; that it went well so far says nothing",
            "take locks in the same order everywhere, or let go of one before you take the next",
            line_location(found.detail, found.size),
        )


def lock_that_kept(entity: EntityId, during: Window, timeline: Timeline) -> Position | None:
    """Return the longest wait of a callback for a lock that others held, if it waited so most of a time."""
    waits = list(_long_waits(positions_of_call(entity, during, timeline), timeline))
    lasted = (min(each.end_at(timeline.end), during.end) - max(each.start, during.start) for each in waits)
    is_most = bool(waits) and 2 * sum(lasted) > during.end - during.start
    return max(waits, key=lambda each: each.end_at(timeline.end) - each.start) if is_most else None


def let_return(entity: EntityId, during: Window, timeline: Timeline) -> str:
    """Return what to do about a callback that is slow: if it waits for a lock, about who holds that."""
    lock = lock_that_kept(entity, during, timeline)
    if lock is None:
        return f"let {who(entity, timeline)} return sooner"
    taker = lock_taker(lock, timeline)
    return f"let {taker} keep {lock.lock or 'the lock'} only while it uses what that guards"


def weight_beside_lock(entity: EntityId, during: Window, timeline: Timeline) -> Weight:
    """Return the weight of an effect of a callback's slowness: a remark if a lock made it slow."""
    return Weight.REMARK if lock_that_kept(entity, during, timeline) else Weight.PROBLEM


def _long_waits(known: Iterable[Position], timeline: Timeline) -> Iterator[Position]:
    for each in known:
        is_long = each.waits_for_lock and _length(each, timeline.end) >= _LONG
        if not is_long or each.keeper or each.is_left or not lock_taker(each, timeline):
            continue
        held = _holder_at(each, timeline)
        waits = held is not None and held.waits and (each.until or held.until)
        goes_on = each.end is None and (held is None or held.doing is not Doing.SLEEPS or held.loop[0])
        if not waits and not goes_on and lock_keeper(each, timeline) != each.entity:
            yield each


def _holder_at(wait: Position, timeline: Timeline) -> Position | None:
    """Return where the holder of a lock was longest while a callback waited for it; None if unknown."""
    during = Window(wait.start, wait.end_at(timeline.end))
    known = timeline.positions_on(wait.holder, during) if wait.holder else ()
    longest = max(known, key=lambda at: _length(at, during.end), default=None)
    return longest if longest and longest.entity == lock_keeper(wait, timeline) else None


def _length(position: Position, until: Nanoseconds) -> Nanoseconds:
    return min(position.end_at(until), until) - position.start
