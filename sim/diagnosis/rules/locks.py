"""The rule on callbacks that wait for locks, where who holds a lock is unknown."""

from collections.abc import Iterator
from pathlib import Path

from sim.diagnosis.rule import Explanation, Finding, Rule, line_of
from sim.diagnosis.rules.endless import moment_of, on_waits
from sim.diagnosis.time_limits import time_limit
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Position, Window
from sim.trace.timeline import Timeline

_IN_TURN = (
    "a thread that waits for a lock keeps the locks it has: if each has what the other wants, neither ever "
    "goes on",
    "take locks in the same order everywhere, and let go of one before you take the next",
)
_TAKEN = "a lock stays taken until whoever took it releases it, also when the call is over that took it"
_RELEASES = "which releases it on every way out, and let go of it before anything that takes long"


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
            line_of(found.subject, moment_of(found), timeline),
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
