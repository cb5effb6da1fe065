"""Rules on callbacks that wait for replies which cannot come while they wait."""

from collections.abc import Iterator, Sequence

from sim.diagnosis.rule import Explanation, Finding, Rule, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.wait_for_graph import StuckCallback, WaitForGraph
from sim.diagnosis.words import listed, often, threads_for, who, with_threads
from sim.trace.events import EntityKind, Reason
from sim.trace.model import Blocked, Nanoseconds
from sim.trace.timeline import Timeline

_SETTLES: Nanoseconds = 100_000_000
"""Shorter waits for a reply are the ordinary time that a call takes."""


class SelfMadeDeadlock(Rule):
    """Callbacks wait for each other in a cycle, often one for itself.

    The usual case is ``Client.call`` inside a callback of the client's own exclusive group, or with the only
    thread there is. Source: the ROS 2 how-to guide "Synchronous vs. asynchronous service clients".
    """

    id = "self-made-deadlock"
    summary = "a callback waits for a reply that it keeps from coming"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each cycle."""
        return (
            _found(self, deadlock, until)
            for deadlock, until in _deadlocks(view)
            if not _lacks_worker(deadlock)
        )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Name the callbacks of the cycle."""
        subject = who(found.subject, timeline)
        cure = (
            f"use call_async() and return from {subject}, "
            f"or give client and service of {found.about} callback groups of their own"
        )
        if threads_for([found.subject], found.until, timeline) == 1:
            cure += f", and spin with {with_threads(found.size + 1)}"
        return Explanation(
            f"{subject} {_waiting(found, timeline)}: {found.detail}{often(found.count)}",
            "the reply is brought by the executor, and needs a group that lets it in and a thread",
            cure,
            place_of(found.subject, timeline),
            for_ever=_lasts(found, timeline),
        )


class NeedsOneMoreWorker(Rule):
    """Every worker of an executor is blocked in a call, and the reply needs one more.

    With K callbacks in ``Client.call`` at once, an executor needs at least K + 1 threads.
    """

    id = "needs-one-more-worker"
    summary = "all threads stand still in calls whose answers need a thread"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each set of callbacks that block all threads of an executor."""
        return (
            _found(self, deadlock, until) for deadlock, until in _deadlocks(view) if _lacks_worker(deadlock)
        )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Name the number of threads that would do."""
        subject = who(found.subject, timeline)
        return Explanation(
            f"{subject} {_waiting(found, timeline)}: {found.detail}{often(found.count)}",
            f"{found.size} callbacks in call() at once need at least {found.size + 1} threads",
            f"spin with MultiThreadedExecutor(num_threads={found.size + 1}), or use call_async()",
            place_of(found.subject, timeline),
            for_ever=_lasts(found, timeline),
        )


def _deadlocks(view: TimelineView) -> Iterator[tuple[Sequence[StuckCallback], Nanoseconds]]:
    """The sets of callbacks that wait for each other, and the end of their waiting."""
    seen: set[tuple[Nanoseconds, ...]] = set()
    for moment, until in _moments(view):
        for deadlock in WaitForGraph(view.timeline, moment).deadlocks():
            key = tuple(each.since for each in deadlock)
            if key not in seen:
                seen.add(key)
                yield deadlock, until


def _moments(view: TimelineView) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
    """The moments to check: now, and just before a blocked call ended; each with the end of the wait.

    The latest comes first, since it tells how long a cycle lasted.
    """
    if any(each.end is None and _is_long(each, view.end) for each in view.blocked) or _call_waits_for_group(
        view
    ):
        yield view.end, view.end
    ended = {each.end for each in view.blocked if each.end is not None and _is_long(each, each.end)}
    yield from ((end - 1, end) for end in sorted(ended, reverse=True))


def _is_long(blocked: Blocked, until: Nanoseconds) -> bool:
    return until - blocked.start >= _SETTLES


def _call_waits_for_group(view: TimelineView) -> bool:
    """Whether a request or reply waits for a group, as behind a callback of that group that awaits it."""
    for entity in view.entities(EntityKind.CLIENT, EntityKind.SERVICE):
        for wait in view.waits(entity.id)[-1:]:
            held = wait.parts[-1].reason is Reason.GROUP_HELD
            if wait.is_open and held and wait.until - wait.since >= _SETTLES:
                return True
    return False


def _lacks_worker(deadlock: Sequence[StuckCallback]) -> bool:
    return any(each.obstacle.needs_worker and len(each.obstacle.by) > 1 for each in deadlock)


def _found(rule: Rule, deadlock: Sequence[StuckCallback], until: Nanoseconds) -> Finding:
    closing = deadlock[0]
    detail = "; ".join(dict.fromkeys(each.obstacle.text for each in deadlock))
    others = [each.entity for each in deadlock if each.entity != closing.entity]
    culprit = others[0] if others else closing.entity
    about = listed(each.obstacle.service for each in deadlock)
    return Finding(
        rule, closing.since, until, closing.entity, culprit, about=about, size=len(deadlock), detail=detail
    )


def _lasts(found: Finding, timeline: Timeline) -> bool:
    return found.until >= timeline.end


def _waiting(found: Finding, timeline: Timeline) -> str:
    if _lasts(found, timeline):
        return f"waits for {found.about} for ever"
    return f"waited in vain for {found.about}"
