"""Searches a run for deadlocks: at which moments the wait-for graph is asked, and what calls itself."""

from collections.abc import Iterator, Sequence

from sim.diagnosis.lasting_waits import SETTLES, lasting_awaits, stands
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.wait_for_graph import WaitForGraph
from sim.diagnosis.waiters import StuckCallback
from sim.trace.events import EntityId, EntityKind, Reason
from sim.trace.model import Blocked, Nanoseconds
from sim.trace.timeline import Timeline


def deadlocks(
    view: TimelineView,
) -> Iterator[tuple[Sequence[StuckCallback], Nanoseconds, frozenset[EntityId]]]:
    """Yield the sets of callbacks that wait for each other, the ends of their waits, and all stuck ones."""
    seen: set[tuple[tuple[EntityId, Nanoseconds], ...]] = set()
    for moment, until in _moments(view):
        graph = WaitForGraph(view.timeline, moment)
        stuck = frozenset(each.entity for each in graph.stuck.values() if each.entity)
        for deadlock in graph.deadlocks():
            key = tuple((each.entity, each.since) for each in deadlock)
            if key not in seen:
                seen.add(key)
                yield deadlock, until, stuck


def _moments(view: TimelineView) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
    """Yield the moments to check, with the ends of the waits: now, and just before a blocked call ended.

    The latest comes first, since it shows how long a cycle lasted.
    """
    blocked = any(each.end is None and _is_long(each, view.end) for each in view.blocked)
    still = any(stands(each, view.timeline, view.end) for each in view.positions)
    if blocked or still or _call_waits_for_group(view) or _awaits(view):
        yield view.end, view.end
    ended = {each.end for each in view.blocked if each.end is not None and _is_long(each, each.end)}
    yield from ((end - 1, end) for end in sorted(ended, reverse=True))


def _is_long(blocked: Blocked, until: Nanoseconds) -> bool:
    return until - blocked.start >= SETTLES


def _call_waits_for_group(view: TimelineView) -> bool:
    """Whether a request or reply waits for a group, as behind a callback of that group that awaits it."""
    for entity in view.entities(EntityKind.CLIENT, EntityKind.SERVICE, EntityKind.WAITABLE):
        for wait in view.waits(entity.id)[-1:]:
            held = wait.parts[-1].reason is Reason.GROUP_HELD
            if wait.is_open and held and wait.until - wait.since >= SETTLES:
                return True
    return False


def _awaits(view: TimelineView) -> bool:
    """Whether a callback has awaited something for long while it keeps its group."""
    suspended = view.timeline.ever_suspended
    holders = (entity for holding in view.now.holders.values() for entity in holding)
    return any(any(lasting_awaits(each, view.end, view.timeline)) for each in holders if each in suspended)


def recursive_services(subject: EntityId, until: Nanoseconds, timeline: Timeline) -> Sequence[EntityId]:
    """Return the services of which each waits in a call of the next, up to a stuck one; empty if none do."""
    known = timeline.entities.values()
    services = {each.name: each.id for each in known if each.kind is EntityKind.SERVICE}
    waits = timeline.moment(until - 1).blocked.values()
    asked = {each.entity: services.get(each.service, 0) for each in waits}
    ring = list[EntityId]()
    while (following := asked.get((ring or [subject])[-1], 0)) not in (0, *ring):
        ring.append(following)
    return ring if subject in ring else ()
