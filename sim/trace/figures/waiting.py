"""The callbacks that wait for others: one answer for every pane and sentence."""

from sim.trace.events import EntityId, EntityKind, GroupKind
from sim.trace.model import Moment, Nanoseconds, Queue, Wait
from sim.trace.timeline import Timeline

WORTH_TELLING: Nanoseconds = 10_000_000
"""Shorter waits are the usual hand-over between callbacks, and are not reported."""


def waits_since(wait: Wait, queue: Queue) -> Nanoseconds:
    """Return since when a callback, or the message that it is to take next from its queue, has waited.

    A callback that took one message while others were queued has waited for less time than they have; if its
    queue loses messages, for longer, which counts unless only its own last call keeps it from running.
    """
    arrived = queue.next_arrived
    if arrived is None:
        return wait.since
    return arrived if wait.is_for_own_call else min(arrived, wait.since)


def waited_by(end: Nanoseconds, wait: Wait, timeline: Timeline) -> Nanoseconds:
    """Return for how long a callback, or its next message, has waited just before ``end``."""
    return end - waits_since(wait, timeline.queue(wait.entity, max(wait.start, end - 1)))


def waits_for_others(moment: Moment) -> list[Wait]:
    """Return the waits of a moment that are worth telling and not for a callback's own last call.

    The longest is first.
    """
    waits = (wait for wait in moment.waiting.values() if not wait.is_for_own_call)
    ordered = sorted((waits_since(wait, moment.queues[wait.entity]), wait.entity) for wait in waits)
    return [wait for _, entity in ordered if (wait := wait_told(entity, moment)) is not None]


def wait_told(entity: EntityId, moment: Moment) -> Wait | None:
    """Return the wait of a callback at a moment, its own last call's included, if it is worth telling."""
    wait = moment.waiting.get(entity)
    if wait is None or moment.at - waits_since(wait, moment.queues[entity]) < WORTH_TELLING:
        return None
    return wait


def next_in_turn(moment: Moment, timeline: Timeline) -> dict[EntityId, Nanoseconds]:
    """Return the callbacks that wait for no other one, and since when they or their next messages wait.

    Their own last calls keep them from running, or are just over, and the executor is about to look again.
    """
    kinds = (EntityKind.SUBSCRIPTION, EntityKind.SERVICE)
    found = {
        entity: arrived
        for entity in sorted(timeline.active_since(moment.at))
        if entity not in moment.waiting and timeline.entities[entity].kind in kinds
        if (arrived := moment.queues[entity].next_arrived) is not None
    }
    own = (wait for wait in moment.waiting.values() if wait.is_for_own_call)
    return found | {wait.entity: waits_since(wait, moment.queues[wait.entity]) for wait in own}


def is_held_by_own_call(entity: EntityId, moment: Moment, timeline: Timeline) -> bool:
    """Return whether a call of a callback runs and lets no second one begin; one that is over does not."""
    is_running = any(span.entity == entity for span in moment.running.values())
    return is_running and not admits_others(entity, timeline)


def admits_others(entity: EntityId, timeline: Timeline) -> bool:
    """Return whether the group of a callback may admit others beside it: it is not mutually exclusive."""
    known = timeline.entities.get(entity)
    group = None if known is None else timeline.groups.get(known.group)
    return group is not None and group.kind is not GroupKind.EXCLUSIVE
