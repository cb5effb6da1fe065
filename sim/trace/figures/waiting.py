"""The callbacks that wait for others, and timers that are due: one answer for every pane and sentence."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

from sim.quantities.durations import duration
from sim.trace.events import EntityId, EntityKind, GroupKind, Reason, TimerCancelled
from sim.trace.model import Moment, Nanoseconds, Queue, Wait, Window
from sim.trace.timeline import Timeline

WORTH_TELLING: Nanoseconds = 10_000_000
"""Shorter waits are the usual hand-over between callbacks, and are not reported."""
_EXAMINED = 100
"""Of the waits of a callback that waits for very long, only the first are compared."""


def waits_since(wait: Wait, queue: Queue, timeline: Timeline) -> Nanoseconds:
    """Return since when a callback, or the message that it is to take next from its queue, has waited.

    This is what every pane, figure and export tells of a wait. A message waits from its arrival to the call
    that takes it; one that its queue loses has waited for no call. While only the callback's own last call
    keeps it from running, nothing else waits. While others keep it from running, the callback waits as well:
    since it became ready or its own last call was over, whatever its queue has lost since then.
    """
    return wait_began(wait, _kept_since(wait, timeline), queue.next_arrived)


def wait_began(wait: Wait, kept_since: Nanoseconds, arrived: Nanoseconds | None) -> Nanoseconds:
    """Return when a wait began, as ``waits_since``.

    ``kept_since`` is since when others keep its callback from running, ``arrived`` when its message came.
    """
    if arrived is None:
        return kept_since
    return arrived if wait.is_for_own_call else min(arrived, kept_since)


def _kept_since(wait: Wait, timeline: Timeline) -> Nanoseconds:
    """Since when others keep a callback from running; if its own last call did first, what was next then."""
    if wait.start == wait.since or wait.is_for_own_call:
        return wait.since
    first = timeline.waits_of(wait.entity, Window(wait.since, wait.since + 1))[-1:]
    if not first or first[0].end is None or not first[0].is_for_own_call:
        return wait.since
    arrived = timeline.queue(wait.entity, first[0].end).next_arrived
    return wait.since if arrived is None else min(arrived, first[0].end)


def waited_so_far(wait: Wait, moment: Moment, timeline: Timeline) -> str:
    """Say before the reason of a wait how long a callback, or its next message, has waited.

    If something else kept it before, the reason is not to blame for all of that: ``1.7 s, now``.
    """
    since = waits_since(wait, moment.queues[wait.entity], timeline)
    lasted = duration(max(0, moment.at - since))
    return f"{lasted}, now" if had_other_reasons(wait, since, moment.at, timeline) else lasted


def had_other_reasons(wait: Wait, since: Nanoseconds, at: Nanoseconds, timeline: Timeline) -> bool:
    """Return whether a callback that waits at a moment was kept by anything else since another one."""
    waits = islice(timeline.waits_of(wait.entity, Window(since, max(since, at))), _EXAMINED)
    return any(
        (each.reason, _holder(each)) != (wait.reason, _holder(wait))
        and min(each.end_at(at), at) - max(each.start, since) >= WORTH_TELLING
        for each in waits
    )


def _holder(wait: Wait) -> EntityId:
    """The callback to blame for a wait; 0 if it waits for any thread, whatever runs on them."""
    return wait.holder if wait.reason is Reason.GROUP_HELD else 0


def waited_by(end: Nanoseconds, wait: Wait, timeline: Timeline) -> Nanoseconds:
    """Return for how long a callback, or the message that it took at ``end``, has waited by then."""
    queue = timeline.queue(wait.entity, max(wait.start, end - 1))
    if wait.end == end:
        for call in timeline.calls_begun(wait.entity, Window(end, end + 1))[:1]:
            arrivals = (each.arrived for each in queue.messages if each.id == call.message)
            arrived = next(arrivals, end if queue.messages else None)
            return end - wait_began(wait, _kept_since(wait, timeline), arrived)
    return end - waits_since(wait, queue, timeline)


def waits_at(moment: Moment, timeline: Timeline) -> Iterator[Wait]:
    """Yield the waits of a moment, for what runs then."""
    calls = (span.entity for span in moment.running.values())
    found = (_wait_at(entity, moment, timeline) for entity in dict.fromkeys((*moment.waiting, *calls)))
    return (wait for wait in found if wait is not None)


def _wait_at(entity: EntityId, moment: Moment, timeline: Timeline) -> Wait | None:
    """Return the wait of a callback for what runs at a moment.

    The executor tells of a wait when it looks again: a run that is paused before that knows the calls better.
    """
    wait, known = moment.waiting.get(entity), timeline.entities.get(entity)
    holders = () if known is None else moment.holders.get(known.group, ())
    if wait is None:
        return _beginning(entity, moment, timeline) if entity in holders else None
    if wait.reason is Reason.NO_FREE_WORKER and _has_free_thread(wait, moment, timeline):
        return None
    is_held = wait.reason is Reason.GROUP_HELD or wait.is_for_own_call
    if known is None or not is_held or wait.holder in (0, *holders):
        return wait
    return replace(wait, holder=holders[0]) if holders and wait.reason is Reason.GROUP_HELD else None


def _has_free_thread(wait: Wait, moment: Moment, timeline: Timeline) -> bool:
    """Return whether an executor that had no free thread when a wait was told has one at a moment."""
    ran = timeline.spans_of(wait.holder, Window(wait.start, moment.at + 1))[-1:]
    thread = timeline.threads.get(ran[0].thread) if ran else None
    executor = None if thread is None else timeline.executors.get(thread.executor)
    if thread is None or executor is None:
        return thread is not None and thread.id not in moment.running
    busy = sum(timeline.threads[each].executor == executor.id for each in moment.running)
    return busy < executor.threads


def wait_judged(wait: Wait, moment: Moment, timeline: Timeline) -> Wait:
    """Return a wait as it is told at a moment: it is over once nothing that runs then causes it."""
    if moment.waiting.get(wait.entity) != wait:
        return wait
    return _wait_at(wait.entity, moment, timeline) or replace(wait, end=moment.at)


def _beginning(entity: EntityId, moment: Moment, timeline: Timeline) -> Wait | None:
    """Return the wait for its own call of a callback whose queue still has messages."""
    arrived, kinds = moment.queues[entity].next_arrived, {each.kind for each in timeline.executors.values()}
    is_queue = timeline.entities[entity].kind in _QUEUES
    if arrived is None or not is_queue or not is_held_by_own_call(entity, moment, timeline):
        return None
    calls = [span for span in moment.running.values() if span.entity == entity]
    begun = max((span.start for span in calls), default=arrived)
    end = next((span.end for span in calls), None)
    reason = Reason.EVENT_QUEUE if kinds == {"EventsExecutor"} else Reason.GROUP_HELD
    since = max(arrived, begun)
    return Wait(since, end, since, entity, reason, entity, workers_busy=False)


def waits_for_others(moment: Moment, timeline: Timeline) -> list[Wait]:
    """Return the waits of a moment that are worth telling and not for a callback's own last call.

    The longest is first.
    """
    waits = (wait for wait in waits_at(moment, timeline) if not wait.is_for_own_call)
    ordered = sorted((waits_since(wait, moment.queues[wait.entity], timeline), wait.entity) for wait in waits)
    return [wait for _, entity in ordered if (wait := wait_told(entity, moment, timeline)) is not None]


def wait_told(entity: EntityId, moment: Moment, timeline: Timeline) -> Wait | None:
    """Return the wait of a callback at a moment, its own last call's included, if it is worth telling."""
    wait = _wait_at(entity, moment, timeline)
    return wait if wait is not None and _is_worth_telling(wait, moment, timeline) else None


def _is_worth_telling(wait: Wait, moment: Moment, timeline: Timeline) -> bool:
    """Whether a wait is longer than a hand-over, or turns out so: then it is told from its first moment.

    What lasts at the end of virtual time is told, too: time goes on only for what really waits.
    """
    since = waits_since(wait, moment.queues[wait.entity], timeline)
    if moment.at - since >= WORTH_TELLING:
        return True
    then = timeline.waits_of(wait.entity, Window(moment.at, max(moment.at, since + WORTH_TELLING) + 1))
    end = next((each.end for each in reversed(then) if each.since == wait.since), wait.end)
    return not timeline.is_real if end is None else end - since >= WORTH_TELLING


def next_in_turn(moment: Moment, timeline: Timeline) -> dict[EntityId, Nanoseconds]:
    """Return the callbacks that wait for no other one, and since when they or their next messages wait.

    Their own last calls keep them from running, or what did is just over, and the executor is about to look.
    """
    found = {
        entity: arrived
        for entity in sorted(timeline.active_since(moment.at))
        if entity not in moment.waiting and timeline.entities[entity].kind in (*_QUEUES, EntityKind.CLIENT)
        if (arrived := moment.queues[entity].next_arrived) is not None
    }
    held = {wait.entity for wait in waits_at(moment, timeline) if not wait.is_for_own_call}
    turns = (wait for wait in moment.waiting.values() if wait.entity not in held)
    return found | {wait.entity: waits_since(wait, moment.queues[wait.entity], timeline) for wait in turns}


_QUEUES = (EntityKind.SUBSCRIPTION, EntityKind.SERVICE)


def is_held_by_own_call(entity: EntityId, moment: Moment, timeline: Timeline) -> bool:
    """Return whether a call of a callback runs or awaits, and lets no second one begin."""
    known = timeline.entities.get(entity)
    has_begun = known is not None and entity in moment.holders.get(known.group, ())
    return has_begun and not admits_others(entity, timeline)


def admits_others(entity: EntityId, timeline: Timeline) -> bool:
    """Return whether the group of a callback may admit others beside it: it is not mutually exclusive."""
    known = timeline.entities.get(entity)
    group = None if known is None else timeline.groups.get(known.group)
    return group is not None and group.kind is not GroupKind.EXCLUSIVE


@dataclass(frozen=True, slots=True)
class TimerTick:
    """A timer's time: its next due time, or since when it is due, and the lateness of its last call.

    ``due`` is None if it is unknown.
    """

    due: Nanoseconds | None
    late: Nanoseconds
    is_cancelled: bool = False


def just_due(moment: Moment, timeline: Timeline) -> list[EntityId]:
    """Return the timers that are due at this very moment, and whose calls have not begun."""
    timers = (each.id for each in timeline.entities.values() if each.kind is EntityKind.TIMER)
    free = islice((timer for timer in timers if timer not in moment.waiting), _EXAMINED)
    return [timer for timer in free if tick_of(timer, moment.at, timeline).due == moment.at]


def tick_of(entity: EntityId, at: Nanoseconds, timeline: Timeline) -> TimerTick:
    """Compute a timer's next due time from its last call, as rcl does: missed ticks are dropped."""
    if waits := timeline.moment(at).waiting.get(entity):
        return TimerTick(waits.since, 0)
    timer, ended = timeline.entities[entity], timeline.ended
    spans = timeline.spans_of(entity, Window(at - 2 * timer.period, at + 1))
    begun = spans[-1].start if spans else 0
    cancel = timeline.cancel_since(entity, begun, at)
    if isinstance(cancel, TimerCancelled):
        return TimerTick(None, 0, is_cancelled=True)
    late = spans[-1].age if spans else 0
    due = begun - late + timer.period if spans else timer.first_due if not timeline.begun else None
    due = due if cancel is None else cancel.t + timer.period
    is_over = ended is not None and at >= ended.t and not ended.time_was_up
    if due is None or is_over or timer.period <= 0:
        return TimerTick(None, late)
    if due < begun:
        due += (1 + (begun - due) // timer.period) * timer.period
    return TimerTick(due if due >= at else None, late)
