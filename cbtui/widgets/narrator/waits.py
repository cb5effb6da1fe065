"""Tells who waits at a moment, and why, in the order in which an executor examines who is ready."""

from collections.abc import Iterator, Sequence

from sim.diagnosis.words import group_of, late_reply, thread_count
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import name_of, why_waiting
from sim.trace.events import EntityId, EntityKind, Reason
from sim.trace.figures.waiting import (
    WORTH_TELLING,
    admits_others,
    had_other_reasons,
    is_held_by_own_call,
    just_due,
    next_in_turn,
    waits_at,
    waits_since,
)
from sim.trace.model import Blocked, EntityInfo, Moment, Nanoseconds, Wait
from sim.trace.timeline import Timeline

_ORDER = (
    EntityKind.TASK,
    EntityKind.WAITABLE,
    EntityKind.TIMER,
    EntityKind.SUBSCRIPTION,
    EntityKind.GUARD,
    EntityKind.CLIENT,
    EntityKind.SERVICE,
)
"""The order in which rclpy's executors examine the entities of a node."""


def waits_told(timeline: Timeline, at: Nanoseconds, since: Nanoseconds) -> Sequence[str]:
    """Who waits at a moment, and why; for its own last call only if nobody else waits, or from ``since``."""
    left = left_waiting(timeline, at)
    moment = timeline.moment(at)
    turns = {**next_in_turn(moment, timeline), **dict.fromkeys(just_due(moment, timeline), at)}.items()
    told_too = [_turn(each, begun, timeline, at) for each, begun in turns if not left or begun >= since]
    calls = [
        late_reply(each, moment, timeline) or _in_its_call(each, timeline)
        for each in moment.blocked.values()
        if each.start < since
    ]
    told = (*_by_cause(left, timeline, at), "; ".join(told_too), *calls)
    return tuple(filter(None, told)) or (_at_rest(timeline, at),)


def left_waiting(timeline: Timeline, at: Nanoseconds) -> list[Wait]:
    """The waits of a moment that others cause, in the order in which an executor examines who waits."""
    waits = (wait for wait in waits_at(timeline.moment(at), timeline) if not wait.is_for_own_call)
    return sorted(waits, key=lambda wait: place_in_order(timeline.entities[wait.entity]))


def place_in_order(entity: EntityInfo) -> tuple[int, int, EntityId]:
    """The place of an entity in the order in which an executor examines it."""
    return entity.node, _ORDER.index(entity.kind), entity.id


def asks_groups(timeline: Timeline) -> bool:
    """Whether not every executor is an EventsExecutor, which asks no group."""
    kinds = {each.kind for each in timeline.executors.values()}
    return kinds != {"EventsExecutor"}


def _in_its_call(blocked: Blocked, timeline: Timeline) -> str:
    caller = name_of(blocked.entity, timeline) if blocked.entity else "the program"
    return f"{caller} has waited in its call of {blocked.service} since {timestamp(blocked.start)}"


def _by_cause(left: Sequence[Wait], timeline: Timeline, at: Nanoseconds) -> Iterator[str]:
    """Say of each cause who waits for it."""
    causes: dict[str, list[Wait]] = {}
    for wait in left:
        causes.setdefault(_why(wait, timeline), []).append(wait)
    for why, waits in causes.items():
        if len(waits) == 1:
            yield waiting(waits[0], timeline, at)
        else:
            now = "now " if any(_had_others(wait, timeline, at) for wait in waits) else ""
            yield f"{now}{why}: {'; '.join(_how_long(wait, timeline, at) for wait in waits)}"


def waiting(wait: Wait, timeline: Timeline, at: Nanoseconds, begins: str = "is ready") -> str:
    """Return why a callback that is ready does not run at a moment; ``begins`` is said of a short wait."""
    now = ", now" if _had_others(wait, timeline, at) else ""
    return f"{_how_long(wait, timeline, at, begins)}{now}: {_why(wait, timeline)}"


def _had_others(wait: Wait, timeline: Timeline, at: Nanoseconds) -> bool:
    since = waits_since(wait, timeline.queue(wait.entity, at), timeline)
    return had_other_reasons(wait, since, at, timeline)


def _how_long(wait: Wait, timeline: Timeline, at: Nanoseconds, begins: str = "is ready") -> str:
    entity = timeline.entities[wait.entity]
    queue = timeline.queue(entity.id, at)
    since = waits_since(wait, queue, timeline)
    waits = begins if at - since < WORTH_TELLING else f"has waited since {timestamp(since)}"
    ready = f", {queue.depth} queued" if queue.depth else ", due" if entity.kind is EntityKind.TIMER else ""
    return f"{entity.spoken_name} {waits}{ready}"


def _why(wait: Wait, timeline: Timeline) -> str:
    match wait.reason:
        case Reason.GROUP_HELD:
            return why_waiting(wait, timeline)
        case Reason.NO_FREE_WORKER:
            return f"{group_of(wait.entity, timeline)} would let it in, but no thread is free"
        case Reason.EVENT_QUEUE:
            return "others came before it, and its EventsExecutor asks no group"
        case Reason.NOBODY_SPINS:
            return "nobody spins its node"


def readied(wait: Wait, timeline: Timeline) -> str:
    """Say how a callback has become ready: ``is ready``, or again, as its last call still runs."""
    if not wait.is_for_own_call:
        return "is ready"
    return "is due again" if timeline.entities[wait.entity].kind is EntityKind.TIMER else "is ready again"


def _turn(each: EntityId, since: Nanoseconds, timeline: Timeline, at: Nanoseconds) -> str:
    """Say what a callback that waits for no other one is to take, and when."""
    entity, moment = timeline.entities[each], timeline.moment(at)
    queued, waited = moment.queues[entity.id].depth, moment.at - since
    is_own = is_held_by_own_call(each, moment, timeline)
    is_ready = f"has {queued} queued" if queued else f"is due{' again' if is_own else ''}"
    if each in moment.waiting and not queued:
        is_ready = readied(moment.waiting[each], timeline)
    is_ready = "is there" if entity.kind is EntityKind.CLIENT and queued == 1 else is_ready
    lasted = f"{', the next' if queued else ''} for {duration(waited)}" if waited else ""
    holders = () if admits_others(each, timeline) else moment.holders.get(entity.group, ())
    when = "it is free to run"
    if is_own:
        when = "its last call still runs"
    elif holders and asks_groups(timeline):
        when = f"{group_of(each, timeline)} held by {name_of(holders[0], timeline)}"
    elif moment.running and not _idle(moment, timeline):
        when = "no thread is free"
    return f"{entity.spoken_name} {is_ready}{lasted}: {when}"


def _idle(moment: Moment, timeline: Timeline) -> int:
    """The number of the executors' threads that run nothing at a moment."""
    return max(0, thread_count(timeline) - len(moment.running))


def _at_rest(timeline: Timeline, at: Nanoseconds) -> str:
    moment = timeline.moment(at)
    idle, busy = _idle(moment, timeline), len(moment.running)
    if not idle:
        return "nothing else is ready"
    threads, verb = idle + busy, "is" if idle == 1 else "are"
    everybody = {1: "the only thread", 2: "both threads"}.get(threads, f"all {threads} threads")
    if busy:
        return f"nothing else is ready: {idle} of {threads} threads {verb} idle"
    return f"nothing is ready: {everybody} {verb} idle"
