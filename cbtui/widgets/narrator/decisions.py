"""Tells what an executor decides at a moment, and the reasons."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.narrator.waits import asks_groups, left_waiting, place_in_order
from sim.diagnosis.words import group_of
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import name_of
from sim.trace.events import EntityId, EntityKind, Reason, ThreadId
from sim.trace.figures.waiting import (
    admits_others,
)
from sim.trace.model import Blocked, Deed, EntityInfo, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline

_IN_ORDER = {
    EntityKind.TASK: "tasks come first",
    EntityKind.WAITABLE: "waitables come first",
    EntityKind.TIMER: "timers come first",
    EntityKind.SUBSCRIPTION: "no timer is before it",
    EntityKind.GUARD: "neither timer nor subscription is before it",
    EntityKind.CLIENT: "neither timer nor subscription is before it",
    EntityKind.SERVICE: "services come last",
}


def deeds(timeline: Timeline, at: Nanoseconds) -> Iterator[tuple[EntityId, ThreadId | None, str]]:
    """What was done at a moment, by whom and on which thread; calls without duration and losses once."""
    made = list(timeline.decisions(Window(at, at + 1)))
    at_once = [span for (_, span), then in pairwise(made) if then == (Deed.ENDED, span)]
    losses = iter(_lost(timeline, at))
    for deed, what in made:
        match what:
            case Span() if deed is Deed.SUSPENDED:
                yield what.entity, what.thread, _suspending(what, timeline)
            case Span() if deed is not Deed.ENDED:
                begun = _begun(what, deed, timeline, returns=what in at_once)
                yield from ((what.entity, what.thread, told) for told in begun)
            case Span() if what not in at_once:
                yield what.entity, what.thread, returning(what, timeline)
            case Blocked():
                yield what.entity, what.thread, _blocked(what, deed, timeline)
            case int():
                yield from ((what, None, told) for told in losses)


def returning(span: Span, timeline: Timeline) -> str:
    """Return the sentence on the end of a call, and what that frees."""
    name, group = name_of(span.entity, timeline), _exclusive_group(span.entity, timeline)
    lasted = duration(span.end_at(timeline.end) - span.start)
    if timeline.processes_ended.get(timeline.threads[span.thread].process) == span.end:
        return f"{name} does not return: its process ends, {lasted} after it began"
    freed = group or ("" if _around(span, timeline) else short_thread(timeline.threads[span.thread].name))
    if span.error:
        return f"{name} raises after {lasted}: {span.error}"
    return f"{name} returns after {lasted}{f', {freed} is free' if freed else ''}"


def _suspending(span: Span, timeline: Timeline) -> str:
    kept = _exclusive_group(span.entity, timeline)
    keeps = f", and keeps {kept} meanwhile" if kept else ""
    return f"{name_of(span.entity, timeline)} awaits, on no thread{keeps}"


def _exclusive_group(entity: EntityId, timeline: Timeline) -> str:
    """The group that a call of an entity holds; "" for one that admits others meanwhile, or is not asked."""
    is_held = asks_groups(timeline) and not admits_others(entity, timeline)
    return group_of(entity, timeline) if is_held else ""


def _around(span: Span, timeline: Timeline) -> str:
    """The callback inside which a call runs, as by a nested spin; "" for none."""
    if not timeline.has_nested(span.thread):
        return ""
    made = list(timeline.decisions(Window(span.start, span.start + 1)))
    before = made[: [what for _, what in made].index(span)]
    over = [what for deed, what in before if deed in (Deed.ENDED, Deed.SUSPENDED)]
    beside = timeline.spans_on(span.thread, Window(max(0, span.start - 1), span.start + 1))
    around = [each for each in beside if each.number < span.number and each not in over]
    return name_of(around[-1].entity, timeline) if around else ""


def _blocked(blocked: Blocked, deed: Deed, timeline: Timeline) -> str:
    caller = name_of(blocked.entity, timeline) if blocked.entity else "the program"
    if deed is Deed.UNBLOCKED:
        return f"{caller} goes on after its call of {blocked.service}"
    group = " and its group" if blocked.entity and _exclusive_group(blocked.entity, timeline) else ""
    return f"{caller} calls {blocked.service}, and keeps its thread{group} until the reply"


def _lost(timeline: Timeline, at: Nanoseconds) -> Sequence[str]:
    """What was lost at a moment, and before it since anything else happened."""
    before = timeline.neighbour(at + 1, -1, losses=False)
    since = at if before == at else 0 if before is None else before + 1
    losses = []
    for entity in timeline.entities.values():
        lost = timeline.losses_of(entity.id, Window(since, at + 1))
        if len(lost) == 1:
            losses.append(f"the full queue of {entity.spoken_name} loses its oldest message")
        elif lost:
            many, in_all = len(lost), timeline.drops_of(entity.id, Window(0, at + 1))
            more = f", {in_all} in all" if in_all > many else ""
            begun = timestamp(lost[0])
            losses.append(f"the full queue of {entity.spoken_name} has lost {many} since {begun}{more}")
    return ["; ".join(losses)] if losses else []


def _begun(span: Span, deed: Deed, timeline: Timeline, *, returns: bool) -> Iterator[str]:
    entity = timeline.entities.get(span.entity)
    if entity is None:
        return
    thread, around = short_thread(timeline.threads[span.thread].name), _around(span, timeline)
    is_free = f"{thread} spins inside {around}" if around else f"{thread} is free"
    end = f", and {f'raises at once: {span.error}' if span.error else 'returns at once'}" if returns else ""
    if deed is Deed.RESUMED:
        yield f"{is_free}: {entity.spoken_name} goes on after its await{end}"
        return
    reasons = [
        f"{is_free}: {entity.spoken_name} {_readiness(entity, span)}",
        *_why_first(entity, span, timeline),
    ]
    if asks_groups(timeline):
        reasons.append(f"{group_of(entity.id, timeline)} lets it in")
    yield f"{', '.join(reasons)} → runs{end}"


def _readiness(entity: EntityInfo, span: Span) -> str:
    match entity.kind:
        case EntityKind.TIMER:
            return f"is due, {duration(span.age)} late" if span.age > 0 else "is due"
        case EntityKind.SUBSCRIPTION:
            return f"has a message, {duration(span.age)} old" if span.age > 0 else "has a message"
        case EntityKind.SERVICE:
            return "has a request"
        case EntityKind.CLIENT:
            return "is there"
    return "is ready"


def _why_first(entity: EntityInfo, span: Span, timeline: Timeline) -> Iterator[str]:
    """Why an entity was chosen: the others lack a thread, or come after it in the order."""
    left = left_waiting(timeline, span.start)
    if any(wait.reason is Reason.EVENT_QUEUE for wait in left):
        yield "it came first"
    others = {wait.entity for wait in left if wait.reason is Reason.NO_FREE_WORKER}
    for wait in left:  # its group was free for all whom it lets in one after the other
        if timeline.entities[wait.entity].group == entity.group and wait.since < span.start:
            others.add(wait.entity)
    others |= _next_in_turn(span, timeline)
    if others := others - {entity.id}:
        place, places = place_in_order(entity), [place_in_order(timeline.entities[each]) for each in others]
        yield _IN_ORDER[entity.kind] if place < min(places) else "it was ready when the executor last looked"


def _next_in_turn(span: Span, timeline: Timeline) -> set[EntityId]:
    """Those that were ready before a call began, and whose turn on its thread came in the same moment.

    A group that kept them was free by then: of the calls of a thread one follows the other.
    """
    at = Window(max(0, span.start - 1), span.start + 1)
    calls = (each for each in timeline.spans_on(span.thread, at) if each.start == span.start)
    later = {each.entity for each in calls if each.number > span.number}
    return {each for each in later if any(wait.end == span.start for wait in timeline.waits_of(each, at))}
